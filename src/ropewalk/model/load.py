"""Loads: what travels."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ropewalk.model._base import Declaration, Variants
from ropewalk.model.history import ForceHistory
from ropewalk.model.travel import Travel


class MovingForce(Declaration):
    """A given force that travels along a line.

    With contact `clamped` the line feels the given force alone and its tension jumps at the load. With
    `frictionless` a horizontal hold force is added that keeps the tension equal on both sides.
    """

    kind: Literal["force"] = "force"
    on: str = Field(description="name of the line")
    force: ForceHistory = Field(description="[Fx, Fz] or [Fx, Fy, Fz], or a table {time, value} of them")
    travel: Travel = Field(description="how it advances along the line")
    contact: Literal["clamped", "frictionless"] = Field(
        default="clamped",
        description="clamped: the line feels the force alone; frictionless: equal tension on both sides",
    )


Load = Annotated[MovingForce, Variants("load")]
"""Any load."""
