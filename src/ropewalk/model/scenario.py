"""A scenario: lines, the loads on them, and the analysis."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, report
from ropewalk.model.consistency import check
from ropewalk.model.crossing import crossed
from ropewalk.model.hangers import Hangers, check_hangers, guessed
from ropewalk.model.joint import Joint
from ropewalk.model.line import Line
from ropewalk.model.load import AnyLoad, Load, assembled
from ropewalk.model.mesh import is_asked_for
from ropewalk.model.missing import missing
from ropewalk.model.net import AnyNet
from ropewalk.model.outputs import Outputs
from ropewalk.model.overhead import CONTACT_WIRE, OverheadLine
from ropewalk.model.parts import Parts
from ropewalk.model.people import with_people
from ropewalk.model.position import estimated
from ropewalk.model.quantity import Acceleration, Name
from ropewalk.model.run import Dynamic, Run
from ropewalk.model.space import leaving
from ropewalk.model.sweep import Sweep
from ropewalk.model.track import Track
from ropewalk.model.wind import Wind


class Scenario(Declaration):
    """Everything needed to compute one result."""

    title: str = Field(default="untitled", description="a line of text for figures and results")
    gravity: Acceleration = Field(default=9.81, description="acts along -z")
    lines: dict[Name, Line] = Field(default_factory=dict, description="the lines, by name")
    overhead_lines: dict[Name, OverheadLine] = Field(
        default_factory=dict, description="sections of overhead line, by name; instead of lines or in addition"
    )
    hangers: dict[Name, Hangers] = Field(
        default_factory=dict, description="rows of hangers between two of the lines, by name"
    )
    tracks: dict[Name, Track] = Field(
        default_factory=dict, description="rails of the lines on pads, sleepers and ballast, by name"
    )
    joints: dict[Name, Joint] = Field(default_factory=dict, description="connection points of lines, by name")
    nets: dict[Name, AnyNet] = Field(default_factory=dict, description="nets and membranes, by name")
    wind: Wind | None = Field(default=None, description="moving air")
    loads: dict[Name, Load] = Field(default_factory=dict, description="the loads, by name")
    outputs: Outputs = Field(default=Outputs(), description="recorded quantities of lines beyond shapes and forces")
    run: Run = Field(default=Dynamic(until=1.0), description="the analysis")
    sweep: Sweep | None = Field(default=None, description="varied values of `ropewalk sweep`")

    @cached_property
    def source_text(self) -> str:
        """The text that this scenario was read from, with its comments; empty after changes."""
        return ""

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy with some fields replaced, which has no text."""
        copy = super().model_copy(update=update, deep=deep)
        if update:
            copy.__dict__.pop("source_text", None)
        return copy

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = list(check_hangers(self.hangers, self.lines, self.gravity))
        if findings:
            report("scenario", findings)
        object.__setattr__(self, "loads", estimated(self.loads, self.lines))
        parts = crossed(self.parts)
        object.__setattr__(self, "run", parts.run)
        report("scenario", [*self._refined(), *map(self._in_its_row, check(parts))])
        return self

    def _refined(self) -> Iterator[Finding]:
        """What changes meshes, of which hangers keep theirs."""
        if self.hangers and is_asked_for(self.parts):
            remedy = "write the hangers as lines, or leave it out"
            yield missing(
                ("run",), "rows of hangers", remedy=remedy, feature="the error of the mesh, or elements: auto,"
            )

    def _in_its_row(self, finding: Finding) -> Finding:
        """A finding about a hanger, which is the row's."""
        path = finding.path
        if path[:1] != ("lines",) or len(path) < 2 or path[1] in self.lines:
            return finding
        row = next((name for name in self.hangers if str(path[1]) in self.hung(name)), None)
        return finding if row is None else replace(finding, path=("hangers", row))

    def hung(self, row: str) -> dict[str, Line]:
        """Hangers of a row as lines of about the right length, by their names."""
        found = guessed(row, self.hangers[row], self.lines, self.gravity)
        return {name: line for name, line in found.items() if line is not None}

    @property
    def parts(self) -> Parts:
        """The same in parts, as checks see it."""
        loads = with_people(assembled(self.loads, self.run), self.lines, self.overhead_lines, self.nets)
        on = {name: (load or self.loads[name]).on for name, load in loads.items()}
        lines: dict[str, Line | None] = {**self.lines}
        for row in self.hangers:
            lines |= self.hung(row)
        return Parts(
            lines,
            loads,
            self.run,
            self.gravity,
            on,
            self.overhead_lines,
            self.nets,
            self.joints,
            self.wind,
            self.outputs,
            tracks=self.tracks,
        )

    def carrier_of(self, load: AnyLoad) -> str:
        """Name in results of the line that a load travels on: of an overhead line, that of its contact wire."""
        return f"{load.on}.{CONTACT_WIRE}" if load.on in self.overhead_lines else load.on

    @property
    def is_network(self) -> bool:
        """Whether it is a network of lines and nets, or its lines are in wind, see `Parts.is_web`."""
        return self.parts.is_network

    @property
    def has_bending_stiffness(self) -> bool:
        """Whether lines have bending stiffness or a bed, or there are overhead lines: they move as wires do."""
        return bool(self.overhead_lines) or any(line.has_bending_stiffness for line in self.lines.values())

    @property
    def is_plane(self) -> bool:
        """Whether nothing leaves the x-z plane."""
        return not leaving(self.parts)
