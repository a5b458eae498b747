"""Segments: parts of a line whose stiffness, mass or bed is another one than that of the rest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.quantity import BedStiffness, BendingStiffness, MassPerLength, Offset, PositiveLength, Share

_GIVEN = ("mass", "bending_stiffness", "foundation", "damage")


class Segment(Declaration):
    """A part of a line that differs: a step of stiffness or mass, a stiffer bed behind a bridge, damage.

    Deflection and slope go on across its ends, and so do moment and shear; curvature jumps with bending stiffness.
    """

    start: Offset = Field(alias="from", description="unstrained length from the start of the line to where it begins")
    end: PositiveLength = Field(alias="to", description="unstrained length from the start of the line to where it ends")
    mass: MassPerLength | None = Field(default=None, description="there, instead of that of the line")
    bending_stiffness: BendingStiffness | None = Field(default=None, description="EI there, instead of the line's")
    damage: Share = Field(default=0.0, description="part of the bending stiffness of the line that is lost there")
    foundation: BedStiffness | None = Field(default=None, description="of the bed there, instead of that of the line")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        report("segment", self._contradictions())
        return self

    def _contradictions(self) -> Iterator[Finding]:
        if not self.start < self.end:
            remedy = "write the smaller one in from"
            yield Finding(("to",), f"is not behind from ({self.start:g} m)", f"{self.end:g} m", remedy)
        if not any(getattr(self, key) not in (None, 0.0) for key in _GIVEN) and self.foundation is None:
            yield Finding((), "the segment is like the rest of the line", remedy=f"add one of {', '.join(_GIVEN)}")
        if self.damage and self.bending_stiffness is not None:
            remedy = "give the bending stiffness that is there, or the part of it that is lost"
            yield Finding(("damage",), "bending_stiffness and damage exclude each other", f"{self.damage:g}", remedy)
        if self.damage >= 1.0:
            wrong, remedy = "nothing would be left of the bending stiffness", "write less than 1, for example 30 %"
            yield Finding(("damage",), wrong, f"{self.damage:g}", remedy)
        if self.bending_stiffness == 0.0:
            wrong, remedy = "a segment without it would be a hinge", "write a small one, or leave it out"
            yield Finding(("bending_stiffness",), wrong, "0 N*m^2", remedy)

    def value(self, key: str, usual: float) -> float:
        """What it has, with what the line has otherwise."""
        if key == "bending_stiffness" and self.damage:
            return (1.0 - self.damage) * usual
        own: float | None = getattr(self, key)
        return usual if own is None else own


def check_segments(segments: Mapping[str, Segment], length: float, *, bends: bool) -> Iterator[Finding]:
    """Find what does not fit together of the segments of a line of a length in m that bends or not."""
    near, taken = 1e-9 * length, sorted(segments.items(), key=lambda item: item[1].start)
    for name, segment in taken:
        path = ("segments", name)
        if segment.end > length + near:
            wrong, remedy = f"is beyond the end of the line ({length:g} m long)", "stay within its length"
            yield Finding((*path, "to"), wrong, f"{segment.end:g} m", remedy)
        if not bends and (segment.damage or segment.bending_stiffness is not None):
            key = "damage" if segment.damage else "bending_stiffness"
            wrong, remedy = "the line has no bending stiffness", "give the line bending_stiffness, too"
            yield Finding((*path, key), wrong, f"{getattr(segment, key):g}", remedy)
    for (one, first), (other, second) in pairwise(taken):
        if second.start < first.end - near:
            wrong, remedy = f"begins within segment {one}", "let it begin where that one ends, or later"
            yield Finding(("segments", other, "from"), wrong, f"{second.start:g} m", remedy)
