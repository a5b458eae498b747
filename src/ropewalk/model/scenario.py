"""A scenario: lines, the loads on them, and what is asked."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, report
from ropewalk.model.consistency import check
from ropewalk.model.line import Line, spatial
from ropewalk.model.load import Load
from ropewalk.model.overhead import OverheadLine
from ropewalk.model.parts import Parts
from ropewalk.model.quantity import Acceleration, Name
from ropewalk.model.run import Dynamic, Run


class Scenario(Declaration):
    """Everything needed to compute one result."""

    title: str = Field(default="untitled", description="a line of text for figures and results")
    gravity: Acceleration = Field(default=9.81, description="acts along -z")
    lines: dict[Name, Line] = Field(default_factory=dict, description="the lines, by name")
    overhead_lines: dict[Name, OverheadLine] = Field(
        default_factory=dict, description="sections of overhead line, by name; instead of lines or beside them"
    )
    loads: dict[Name, Load] = Field(default_factory=dict, description="what travels on them, by name")
    run: Run = Field(default=Dynamic(until=1.0), description="what is asked")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        on = {name: load.on for name, load in self.loads.items()}
        report("scenario", check(Parts(self.lines, self.loads, self.run, self.gravity, on, self.overhead_lines)))
        return self

    @property
    def is_stiff(self) -> bool:
        """Whether lines have bending stiffness or a bed, or there are overhead lines: they move as wires do."""
        return bool(self.overhead_lines) or any(line.is_stiff for line in self.lines.values())

    @property
    def is_plane(self) -> bool:
        """Whether nothing leaves the x-z plane."""
        vectors = [vector for line in self.lines.values() for vector in line.vectors()]
        vectors += [vector for line in self.overhead_lines.values() for vector in line.vectors()]
        vectors += [vector for load in self.loads.values() for vector in load.vectors()]
        return all(spatial(vector)[1] == 0.0 for vector in vectors)
