"""Cuts: a line fails at a place of it, at a time or where it pulls too much."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.quantity import PositiveForce, PositiveLength, PositiveTime


class Cut(Declaration):
    """A line fails: from a time on its tension ends at a place, and both parts fly as they are pulled.

    It does so at a time, or where tension there first passes a strength (a knot, a splice, a link made to fail), within
    a step; of both, what comes first. Nothing is lost in the cut itself. What of the line is joined to others continues
    to hang there.
    """

    at: PositiveLength = Field(description="unstrained length from the start of the line to where it is cut")
    time: PositiveTime | None = Field(default=None, description="when; or give `strength`")
    strength: PositiveForce | None = Field(default=None, description="tension there beyond which it fails")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.time is None and self.strength is None:
            report("cut", [Finding(("time",), "has no time", remedy="write time, or strength, or both")])
        return self


def check_cut(cut: Cut, length: float | None, distance: float, supports: Mapping[str, float]) -> Iterator[Finding]:
    """Find what does not fit of the cut of a line to the rest of it.

    Args:
        cut: of the line.
        length: of the line, unstrained, in m; None: it follows from a tension.
        distance: of its ends in m.
        supports: where inner supports hold it, in m from its start, by name.
    """
    if length is not None and cut.at >= length * (1.0 - 1e-9):
        wrong = f"is not between the ends of the line ({length:g} m long)"
        yield Finding(("cut", "at"), wrong, f"{cut.at:g} m", "stay within its length")
    for name, at in supports.items():
        if abs(cut.at - at) <= 1e-9 * (length or distance):
            yield Finding(("cut", "at"), f"is at inner support {name}", f"{cut.at:g} m", "cut at another position")
