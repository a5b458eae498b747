"""Wind: moving air that pushes at lines and loads."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import Field

from ropewalk.model._base import Declaration
from ropewalk.model.history import SpeedHistory, SpeedTable
from ropewalk.model.quantity import Direction, Quantity

Density = Annotated[float, Quantity("kg/m^3", "positive")]


class Wind(Declaration):
    """Air that moves as prescribed, everywhere alike.

    A line feels the force rho/2 * wind_drag * |v_n| v_n per length, where v_n is the part across the line of the
    velocity of the air relative to it (the cross-flow principle), and wind_drag of the line is its drag coefficient
    times its width. A load, payload or cabin with air_drag feels air_drag * |v| v, v that velocity. Air that stands
    still damps both, too; what has neither key feels nothing.
    """

    direction: Direction = Field(description="in which it blows, [x, z] or [x, y, z], of any length")
    speed: SpeedHistory = Field(description="a constant, or a table {time, value}")
    air_density: Density = Field(default=1.225, description="of the air")

    @property
    def is_calm(self) -> bool:
        """Whether it never blows."""
        speed = self.speed.value if isinstance(self.speed, SpeedTable) else (self.speed,)
        return not any(callable(value) or value != 0.0 for value in speed)

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List all vectors that it is given by."""
        yield self.direction
