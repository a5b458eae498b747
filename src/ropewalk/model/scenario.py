"""A scenario: lines, the loads on them, and what is asked."""

from __future__ import annotations

from pydantic import Field

from ropewalk.model._base import Declaration
from ropewalk.model.line import Line, spatial
from ropewalk.model.load import Load
from ropewalk.model.run import Dynamic, Run
from ropewalk.units import Acceleration


class Scenario(Declaration):
    """Everything needed to compute one result."""

    title: str = "untitled"
    gravity: Acceleration = Field(default=9.81, ge=0.0, description="acts along -z")
    lines: dict[str, Line] = Field(min_length=1)
    loads: dict[str, Load] = Field(default_factory=dict)
    run: Run = Field(default=Dynamic(until=1.0))

    @property
    def is_plane(self) -> bool:
        """Whether nothing leaves the x-z plane."""
        points = [p for line in self.lines.values() for p in (line.start, line.end)]
        return all(spatial(p)[1] == 0.0 for p in points) and not any(_sideways(load) for load in self.loads.values())


def _sideways(load: Load) -> bool:
    if callable(load.force):
        return False
    vectors = load.force if isinstance(load.force, tuple) else load.force.value
    rows = [vectors] if isinstance(load.force, tuple) else vectors
    return any(spatial(row)[1] != 0.0 for row in rows)  # type: ignore[arg-type]
