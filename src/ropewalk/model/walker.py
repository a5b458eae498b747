"""Walkers: a person who responds to the line."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.balance import SIDEWAYS, Balance
from ropewalk.model.footsteps import FirstFoot
from ropewalk.model.position import StartOffset
from ropewalk.model.quantity import (
    Angle,
    Mass,
    PositiveLength,
    PositiveMass,
    PositiveSpeed,
    PositiveStiffness,
    Share,
    Viscosity,
    Way,
)
from ropewalk.model.travel import ON_NETS, AtEnd, Place


class Walker(Declaration):
    """A person on two springs: the body bounces on its legs, a foot that stands is clamped to the line.

    A leg lands where it touches the line at the angle of attack and leaves when it no longer pushes, so the gait
    follows the motion of the line, and the line feels the body's inertia (Geyer, Seyfarth and Blickhan, Proc. R. Soc.
    B 273, 2861, 2006). With `balance` the feet stand apart, and the line feels
    how the body keeps upright between them.
    """

    kind: Literal["walker"] = "walker"
    on: str = Field(description="name of the line")
    mass: PositiveMass = Field(default=80.0, description="of the body")
    leg_length: PositiveLength = Field(default=1.0, description="of a leg without load, from foot to hip")
    leg_stiffness: PositiveStiffness = Field(default=14e3, description="of a leg")
    leg_damping: Viscosity = Field(default=0.0, description="of a leg that stands")
    angle_of_attack: Angle = Field(
        default=math.radians(69.0), description="between the horizontal and the leg that is about to land, below 90 deg"
    )
    speed: PositiveSpeed = Field(default=1.1, description="of the body at the start, forwards")
    foot_mass: Mass = Field(default=0.0, description="of a foot that stands, carried by the line")
    push_off: Share = Field(default=1.0, description="fraction of lost energy that is replaced: 0 none, 1 all")
    balance: Balance | None = Field(
        default=None, description="lateral foot placement (default: all feet on the line itself)"
    )
    first_foot: FirstFoot = Field(default="left", description="the foot that stands at the beginning: left or right")
    start: StartOffset = Field(
        default=0.0,
        alias="from",
        description="unstrained length from the start to the first foot; {x: 5 m} or middle: as of prescribed travel",
    )
    towards: Literal["end", "start"] = Field(default="end", description="end of the line towards which it walks")
    at_end: AtEnd = Field(
        default="leave",
        description="at an end of the line a walker leaves it, stops there, or is refused",
    )
    path: Way | None = Field(default=None, description=ON_NETS)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if not 0.0 < self.angle_of_attack < 0.5 * math.pi:
            wrong, given = "a leg lands ahead of the body", f"{math.degrees(self.angle_of_attack):g} deg"
            remedy = "write an angle above 0 deg and below 90 deg, for example 69 deg"
            report("walker", [Finding(("angle_of_attack",), wrong, given, remedy)])
        return self

    def starts(self) -> list[Place]:
        """List where the first foot stands at the beginning."""
        return [Place("", "material", self.start)]

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by: a direction out of the plane where it balances."""
        if self.balance is not None:
            yield SIDEWAYS
