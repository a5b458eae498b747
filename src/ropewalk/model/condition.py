"""What has become of an overhead line since it was fitted."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Annotated

from pydantic import Field

from ropewalk.model._base import Declaration, Finding
from ropewalk.model.dropper_cut import SpanAndNumber, not_there
from ropewalk.model.quantity import Number, Share

MOST_WORN = 0.5
"""Part of the cross-section: what is worn further is no round wire with a flat any more."""


class Condition(Declaration):
    """What has changed since a line was fitted as wanted: its droppers keep the lengths that they were given then.

    Where weights keep the tension, neither wear nor temperature changes it. Between anchored ends it changes: a worn
    wire at the same strain pulls less, a warm wire is longer.
    """

    missing_droppers: Annotated[tuple[tuple[int, int], ...], SpanAndNumber()] = Field(
        default=(), description="droppers that have failed and fallen off with their clamps: pairs [span, number in it]"
    )
    wear: Share = Field(
        default=0.0,
        description="part of the cross-section of the contact wire that is worn off, by which mass and EA are less; EI "
        "is that of a round wire with a flat",
    )
    temperature_rise: Number = Field(default=0.0, description="since fitting, in K; negative: it is colder")
    expansion: Share = Field(default=1.7e-5, description="thermal expansion of wires and droppers, in 1/K")

    def findings(self, droppers: Sequence[int], *, fixed_aside: bool) -> Iterator[Finding]:
        """Find what cannot be, and what is not computed.

        Args:
            droppers: how many there are in each span.
            fixed_aside: whether the wires have a stagger and their ends are anchored.
        """
        yield from not_there(("condition", "missing_droppers"), self.missing_droppers, droppers)
        if self.wear > MOST_WORN:
            remedy = f"write at most {MOST_WORN:g}, part of the cross-section"
            yield Finding(
                ("condition", "wear"), "the wear is larger than that of any contact wire", f"{self.wear:g}", remedy
            )
        if self.expansion != type(self).model_fields["expansion"].default and not self.temperature_rise:
            wrong, remedy = "there is no change of temperature", "add temperature_rise, or leave expansion out"
            yield Finding(("condition", "expansion"), wrong, f"{self.expansion:g} 1/K", remedy)
        for name in ("wear", "temperature_rise") if fixed_aside else ():
            if value := getattr(self, name):
                wrong = "requires ends: weights, or steady arms without stagger"
                remedy = f"write ends: weights, or leave stagger or {name} out"
                yield Finding(("condition", name), wrong, f"{value:g}", remedy)
