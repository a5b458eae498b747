"""Masses: what travels with a weight and an inertia of its own."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.contact import LIFT_OFF, SIDE, Side, one_sided
from ropewalk.model.history import ForceHistory, rows
from ropewalk.model.quantity import AirDrag, PositiveMass
from ropewalk.model.travel import AnyTravel, FreeTravel, Place


class MovingMass(Declaration):
    """A mass that travels along a line; the line feels its weight and its inertia."""

    kind: Literal["mass"] = "mass"
    on: str = Field(description="name of the line")
    mass: PositiveMass = Field(description="of the load; its weight acts by itself")
    travel: AnyTravel = Field(description="motion along the line, prescribed or free")
    contact: Literal["clamped", "frictionless"] = Field(
        default="clamped",
        description="of a prescribed travel: clamped: held along the line, its tension jumps at the load; "
        "frictionless: equal tension on both sides",
    )
    force: ForceHistory = Field(default=(0.0, 0.0), description="further force on it, or a table {time, value}")
    air_drag: AirDrag = Field(default=0.0, description="force air_drag |v| v, v: relative velocity of the air")
    lift_off: bool = Field(default=False, description=LIFT_OFF)
    side: Side = Field(default="above", description=SIDE)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = one_sided(self.side, lift_off=self.lift_off)
        if isinstance(self.travel, FreeTravel) and self.contact != "clamped":
            wrong = "contact is for a prescribed travel"
            remedy = "leave contact out: a free travel slides with travel.friction, which is 0 by default"
            findings.append(Finding(("contact",), wrong, self.contact, remedy))
        report("mass", findings)
        return self

    def starts(self) -> list[Place]:
        """List where it stands at the beginning."""
        return [Place("", self.travel.measured, self.travel.start)]

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by."""
        yield from rows(self.force)
