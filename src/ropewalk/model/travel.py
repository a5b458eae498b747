"""Travel: how a load advances along its line."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ropewalk.model._base import Declaration
from ropewalk.model.history import SpeedHistory
from ropewalk.model.quantity import Offset

Measure = Literal["material", "slip", "arc", "horizontal"]
"""What the speed counts: dxi/dt, (1 + mean eps) dxi/dt, arc length from the start, or x."""


class Travel(Declaration):
    """A prescribed advance: speed, its measure, where it begins, what happens at the end of the line."""

    speed: SpeedHistory = Field(description="a constant, or a table {time, value}; negative: towards the start")
    measured: Measure = Field(default="material", description="what the speed counts")
    start: Offset = Field(
        default=0.0,
        alias="from",
        description="distance from the start of the line: material length for `material`, "
        "arc length at rest for `slip` and `arc`, horizontal distance for `horizontal`",
    )
    at_end: Literal["refuse", "leave", "stay"] = Field(
        default="refuse",
        description="a load that would pass an end of the line is refused, leaves the line, or stays there",
    )
