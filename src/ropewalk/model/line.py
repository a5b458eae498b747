"""Lines: slender bodies described along their unstrained arc length."""

from __future__ import annotations

import math
from typing import Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration
from ropewalk.model.law import LAWS_WITH_OWN_STIFFNESS, Hooke, Law
from ropewalk.units import AxialDamping, Force, Length, MassPerLength, Rate

Point = tuple[Length, Length] | tuple[Length, Length, Length]
"""A place [x, z] or [x, y, z]: x along the span, z up, y sideways."""


def spatial(point: tuple[float, ...]) -> tuple[float, float, float]:
    """Write a point or vector given as (x, z) or (x, y, z) with all three components."""
    return (point[0], 0.0, point[1]) if len(point) == 2 else (point[0], point[1], point[2])


class Line(Declaration):
    """A string, rope or wire between two fixed points."""

    start: Point = Field(description="where the line begins (material coordinate 0)")
    end: Point = Field(description="where the line ends")
    length: Length | None = Field(default=None, gt=0.0, description="unstrained length; or give tension")
    tension: Force | None = Field(default=None, gt=0.0, description="mean tension at rest, instead of length")
    mass: MassPerLength = Field(gt=0.0, description="mass per unstrained length")
    axial_stiffness: Force | None = Field(default=None, gt=0.0, description="EA")
    law: Law = Field(default=Hooke(), description="tension as a function of strain")
    axial_damping: AxialDamping = Field(default=0.0, ge=0.0, description="Kelvin-Voigt c: T = T(eps) + c eps_t")
    drag: Rate = Field(default=0.0, ge=0.0, description="mass-proportional damping: force -drag * mass * velocity")
    elements: int = Field(default=100, ge=1, le=10_000_000, description="number of links")

    @model_validator(mode="after")
    def _determined(self) -> Self:
        if (self.length is None) == (self.tension is None):
            raise ValueError("give exactly one of length (unstrained) and tension (mean tension at rest)")
        own = isinstance(self.law, LAWS_WITH_OWN_STIFFNESS)
        if own and self.axial_stiffness is not None:
            raise ValueError(f"law {self.law.kind} has a stiffness of its own: leave axial_stiffness out")
        if not own and self.axial_stiffness is None:
            raise ValueError(f"law {self.law.kind} needs axial_stiffness (EA, in N)")
        if self.tension is not None and self.distance == 0.0:
            raise ValueError("start and end coincide: give length, a tension cannot be reached")
        return self

    @property
    def distance(self) -> float:
        """Distance between the ends in m."""
        return math.dist(spatial(self.start), spatial(self.end))
