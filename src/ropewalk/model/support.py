"""Supports: what holds the end of a line."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, Variants, report
from ropewalk.model.history import DisplacementHistory, rows
from ropewalk.model.joint import Joined
from ropewalk.model.quantity import (
    Direction,
    Force,
    Mass,
    PositiveForce,
    PositiveSpeed,
    Stiffness,
    Stiffnesses,
    Viscosities,
    Viscosity,
)


class Fixed(Declaration):
    """A point that does not move."""

    kind: Literal["fixed"] = "fixed"
    clamped: bool = Field(default=False, description="the line cannot rotate there either; requires bending_stiffness")


class Elastic(Declaration):
    """A soft support: springs and dampers between the end of the line and its place, without force at that place.

    In a scenario that leaves the x-z plane two values are refused: what springs do sideways is for the user to say.
    """

    kind: Literal["elastic"] = "elastic"
    stiffness: Stiffnesses = Field(
        description="of the spring, one value for all directions or [kx, kz], in space [kx, ky, kz]"
    )
    damping: Viscosities = Field(default=0.0, description="of the damper, one value or [cx, cz], in space [cx, cy, cz]")
    mass: Mass = Field(default=0.0, description="that moves with the end of the line; its weight counts")
    displacement: DisplacementHistory = Field(
        default=(0.0, 0.0), description="of the far end of springs and dampers: constant, or a table {time, value}"
    )


class Winch(Declaration):
    """A winch that keeps the tension of a line: `force` of the rail is what it is set to.

    It takes in or pays out the faster, the further the line is from that tension: `damping` of the rail is by how much
    for each m/s.
    """

    speed_limit: PositiveSpeed = Field(description="at which it takes in and pays out at most, whatever the tension")
    dead_band: PositiveForce | None = Field(
        default=None, description="tension above and below that does not move it (default: none)"
    )


class Guided(Declaration):
    """A slider on a straight rail: free along it but for a spring, a damper and a constant force.

    With a force alone it is the end of a line that a weight keeps taut.
    """

    kind: Literal["guided"] = "guided"
    along: Direction = Field(description="direction of the rail, [x, z] or [x, y, z], of any length")
    stiffness: Stiffness = Field(default=0.0, description="of the spring along the rail")
    damping: Viscosity = Field(default=0.0, description="of the damper along the rail")
    force: Force = Field(default=0.0, description="constant force along the rail on the end of the line")
    mass: Mass = Field(default=0.0, description="that moves with the end of the line; its weight counts")
    winch: Winch | None = Field(
        default=None, description="that pulls there, with `force` as it is set; at an end of a line"
    )

    @model_validator(mode="after")
    def _points_somewhere(self) -> Self:
        findings = []
        if not any(self.along):
            findings.append(Finding(("along",), "has no direction", str(list(self.along)), "write for example [1, 0]"))
        if self.winch is not None and not self.force:
            findings.append(Finding(("force",), "is required: tension that the winch maintains", remedy="give force"))
        if self.winch is not None and self.stiffness:
            wrong, remedy = "a winch has no spring", "leave stiffness out, or winch"
            findings.append(Finding(("stiffness",), wrong, f"{self.stiffness:g} N/m", remedy))
        report("guided", findings)
        return self


class Moving(Declaration):
    """A point that moves as prescribed."""

    kind: Literal["moving"] = "moving"
    displacement: DisplacementHistory = Field(description="from its place: a constant, or a table {time, value}")


Support = Annotated[Fixed | Elastic | Guided | Moving | Joined, Variants("support")]
"""Any support."""


def stands_still(support: Support) -> bool:
    """Whether the end that it holds neither yields nor moves."""
    if isinstance(support, Moving):
        return not callable(support.displacement) and len(rows(support.displacement)) == 1
    return isinstance(support, Fixed)
