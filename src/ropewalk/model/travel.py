"""Travel: how a load advances along its line."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ropewalk.model._base import Declaration
from ropewalk.model.history import SpeedHistory
from ropewalk.units import Length

Measure = Literal["material", "slip", "arc", "horizontal"]
"""What the speed counts: dxi/dt, (1 + mean eps) dxi/dt, arc length from the start, or x."""


class Travel(Declaration):
    """A prescribed advance: speed, how it is measured, where it begins and what happens at the end of the line."""

    speed: SpeedHistory = Field(description="constant, table {time, value}, or a callable of t")
    measured: Measure = Field(default="material", description="what the speed counts")
    start: Length = Field(
        default=0.0,
        ge=0.0,
        alias="from",
        description="distance from the start of the line: material length for `material`, "
        "arc length at rest for `slip` and `arc`, horizontal distance for `horizontal`",
    )
    at_end: Literal["refuse", "leave", "stay"] = Field(
        default="refuse",
        description="a load that would pass an end of the line is refused, leaves the line, or stays there",
    )
