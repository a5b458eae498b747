"""Trolleys: a mass on the line with a payload that swings below."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.contact import LIFT_OFF, SIDE, Side, one_sided
from ropewalk.model.history import ForceHistory, SpeedHistory, rows
from ropewalk.model.quantity import (
    AirDrag,
    Angle,
    Displacement,
    Name,
    PositiveLength,
    PositiveMass,
    PositiveStiffness,
    Viscosity,
)
from ropewalk.model.travel import AnyTravel, Place

LARGEST_STRETCH = 2.0
"""A rope that would begin longer than this times its length is taken for a slip of the pen."""


class Payload(Declaration):
    """A mass on a rope of its own, which can only pull; where it is slack the mass flies."""

    mass: PositiveMass = Field(description="of the payload")
    length: PositiveLength = Field(description="of its rope, unstrained")
    stiffness: PositiveStiffness | None = Field(
        default=None, description="of its rope (default: elongation of 1 mm under the weight)"
    )
    damping: Viscosity = Field(default=0.0, description="of its rope, while it pulls")
    hoist: SpeedHistory = Field(
        default=0.0,
        description="speed at which its rope is taken in, in unstrained length, a constant or a table {time, value}; "
        "negative: let out; its stiffness is inversely proportional to its length",
    )
    swing: Angle = Field(default=0.0, description="angle from the vertical at the start, towards +x")
    at: Displacement | None = Field(
        default=None, description="position at the start relative to the trolley, [x, z] or [x, y, z], instead of swing"
    )
    air_drag: AirDrag = Field(default=0.0, description="force air_drag |v| v, v: relative velocity of the air")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        if self.at is not None and self.swing:
            wrong, remedy = "swing and at exclude each other", "give the angle of the taut rope or the place, not both"
            findings.append(Finding(("swing",), wrong, f"{self.swing:g} rad", remedy))
        if self.at is not None and math.hypot(*self.at) > LARGEST_STRETCH * self.length:
            wrong = f"the rope of {self.length:g} m would begin stretched to {math.hypot(*self.at):.3g} m"
            findings.append(Finding(("at",), wrong, str(list(self.at)), "check length and at"))
        report("payload", findings)
        return self


class Trolley(Declaration):
    """A mass on the line from which a payload hangs, free to swing wide.

    On several lines, as the crab of a cable crane on its track ropes, it is one rigid body that stays level: all lines
    carry it at one place, and what each of them bears follows from how they yield. Its wheels roll; with a speed it is
    moved from outside, as by a stiff hauling rope, and the pull of that is told.
    """

    kind: Literal["trolley"] = "trolley"
    on: str = Field(description="name of the line")
    also_on: tuple[Name, ...] = Field(default=(), description="names of further lines that also carry it")
    mass: PositiveMass = Field(description="of the trolley without its payload")
    payload: Payload = Field(description="payload below it")
    travel: AnyTravel = Field(description="motion along the line, prescribed or free")
    force: ForceHistory = Field(
        default=(0.0, 0.0), description="further force on the trolley, or a table {time, value}"
    )
    air_drag: AirDrag = Field(default=0.0, description="force air_drag |v| v, v: velocity of the air to the trolley")
    lift_off: bool = Field(default=False, description=LIFT_OFF)
    side: Side = Field(default="above", description=SIDE)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        report("trolley", one_sided(self.side, lift_off=self.lift_off))
        return self

    @property
    def lines(self) -> tuple[str, ...]:
        """Names of all lines that carry it."""
        return (self.on, *self.also_on)

    def starts(self) -> list[Place]:
        """List where it stands at the beginning."""
        return [Place("", self.travel.measured, self.travel.start)]

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by."""
        yield from rows(self.force)
        if self.payload.at is not None:
            yield self.payload.at
