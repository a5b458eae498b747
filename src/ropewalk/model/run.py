"""Runs: the question asked of a structure."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from ropewalk.model._base import Declaration, Finding, Variants, report
from ropewalk.model.quantity import (
    AUTO,
    AutoLength,
    Count,
    Direction,
    Factor,
    PositiveLength,
    PositiveLengthOrAuto,
    PositiveTime,
    TableTime,
    TurnAngle,
)
from ropewalk.model.until import Until

Geometry = Literal["nonlinear", "linearised"]
Method = Literal["auto", "explicit", "verlet", "rkn6", "implicit"]
HIGH_ORDER = ("rkn6", "implicit")
"""Methods of a higher order than the second, which need forces that are smooth."""
ACCURACY = 1e-3
"""Accuracy in time of the positions where none is asked for, m."""


class Start(Declaration):
    """What a motion begins with: rest under gravity with or without the loads, a stored result, or a mode.

    A mode of a rope is the state of rest and, on top of it, `amplitude * sin(number pi xi / L)` across the line:
    released from there, or whirling about the straight line through the supports, in a circle if it is taut. Along that
    line the particles stand so that all links are longer by the same part than at rest.

    Lines with bending stiffness, overhead lines, joined lines and nets are released from a mode of their spectrum at
    rest without loads: the one of this number among those that move in the direction rather than across it. Each stiff
    line and each overhead line has its own; of joined lines, a name counts the modes that move that line. Where they
    whirl, they have the velocity that the mode of this number at right angles to it has as it passes rest.
    """

    kind: Literal["rest", "result", "mode"] = Field(default="rest", description="initial state")
    with_loads: bool = Field(default=False, description="rest: let the loads rest on the line at their start, too")
    in_wind: bool = Field(
        default=False, description="rest: equilibrium in the wind as it blows at t = 0 (default: in calm air)"
    )
    file: str | None = Field(default=None, description="result: a NetCDF file written by an earlier run")
    time: TableTime | None = Field(default=None, description="result: the instant to start from (default: the last)")
    number: Annotated[int, Count(1, 1_000_000)] | None = Field(
        default=None, description="mode: number of half waves, or of the mode (default: 1)"
    )
    amplitude: PositiveLength | None = Field(default=None, description="mode: the largest deflection")
    direction: Direction | None = Field(
        default=None,
        description="mode: [x, z] or [x, y, z], of any length; its part across the line counts (default: [0, 1], up)",
    )
    whirl: bool = Field(
        default=False,
        description="mode: rotate from the start about the line through the supports (in three dimensions), from "
        "start to end right-handed, as fast as the tension holds a circle",
    )
    line: str | None = Field(default=None, description="mode: name of the only line that has it (default: all have)")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        findings = []
        own: dict[str, tuple[str, ...]] = {"rest": ("with_loads", "in_wind"), "result": ("file", "time")}
        own["mode"] = ("number", "amplitude", "direction", "whirl", "line")
        for kind, keys in own.items():
            for key in keys:
                value = getattr(self, key)
                if kind != self.kind and value is not None and value is not False:
                    remedy = f"leave it out{_INSTEAD[self.kind]}, or write kind: {kind}"
                    findings.append(Finding((key,), f"is for kind: {kind} only", remedy=remedy))
        if self.kind == "result" and not self.file:
            remedy = "add file: the NetCDF file of an earlier run"
            findings.append(Finding(("file",), "is required for a start from a result", remedy=remedy))
        if self.kind == "mode" and self.amplitude is None:
            remedy = "add amplitude: the largest deflection, for example 10 mm"
            findings.append(Finding(("amplitude",), "is required for a start from a mode", remedy=remedy))
        if self.direction is not None and not any(self.direction):
            remedy = "write for example [0, 1]"
            findings.append(Finding(("direction",), "has no direction", str(list(self.direction)), remedy))
        report("start", findings)
        return self

    def vectors(self) -> Iterator[tuple[float, ...]]:
        """List the directions in which lines are deflected; a whirl leaves the x-z plane."""
        if self.direction is not None:
            yield self.direction
        if self.whirl:
            yield (0.0, 1.0, 0.0)


_INSTEAD = {"rest": "", "result": ": all positions are read from the result", "mode": ""}


_MESH_ERROR = Field(
    default=False,
    description="also compute with a quarter and half of the elements, and estimate how far positions are from those "
    "of the continuum",
)
_OF_AUTO = Field(
    default=None, description="with elements: auto, target accuracy of the positions, compared with the continuum"
)


class Dynamic(Declaration):
    """Motion in time."""

    kind: Literal["dynamic"] = "dynamic"
    until: Until = Field(
        description="end of the run, which begins at 0 s; crossing: when all loads have crossed their lines; "
        "crossing + 2 s: so much later"
    )
    every: PositiveTime | None = Field(default=None, description="interval of output (default: until / 100)")
    method: Method = Field(default="auto", description="auto: chosen from the spectrum; the summary names the choice")
    step: PositiveTime | None = Field(default=None, description="largest time step (default: from accuracy)")
    accuracy: PositiveLength | None = Field(
        default=None,
        description="of ropes, and elsewhere with rkn6 and implicit: target accuracy in time of the positions "
        "(default: 1 mm, and with Verlet's method the largest stable step); with elements: auto, of "
        "anything: that of the positions against the continuum; with window: auto, of heights under "
        "contacts compared with the whole line, root mean square",
    )
    mesh_error: bool = _MESH_ERROR
    start: Start = Field(default=Start(), description="the state at the beginning")
    geometry: Geometry = Field(
        default="nonlinear",
        description="geometrically nonlinear, or linearised about equilibrium; of overhead lines, and of straight "
        "lines with bending stiffness without longitudinal or lateral forces, the linearised motion is vertical with "
        "constant tensions; droppers still slacken",
    )
    sample: PositiveTime | None = Field(
        default=None, description="interval at which contact forces on them are recorded (default: 1 ms)"
    )
    window: PositiveLengthOrAuto | None = Field(
        default=None,
        description="half-width of the moving part around the contacts, along lines and parts joined to them; with "
        "linearised geometry, on overhead lines also with nonlinear geometry; auto: chosen there for "
        "accuracy",
    )
    axial_inertia: Factor = Field(
        default=1.0,
        description="with nonlinear geometry, factor on the mass for motion along the lines (of overhead lines and "
        "lines with bending stiffness: along x), because longitudinal waves limit the step: 4 doubles the "
        "step, with some error",
    )

    @property
    def precision(self) -> float:
        """Accuracy in time of the positions as given, or its default, m."""
        return ACCURACY if self.accuracy is None else self.accuracy

    @property
    def finds_window(self) -> bool:
        """Whether the width of the window is yet to be found."""
        return isinstance(self.window, AutoLength)

    @property
    def written_window(self) -> str:
        """The window as it is given."""
        return AUTO if self.finds_window else f"{self.window:g} m"

    @model_validator(mode="after")
    def _goes_together(self) -> Self:
        findings = []
        if self.axial_inertia < 1.0:
            wrong, remedy = "below 1 the step would shrink", "write 1 or more, or leave it out"
            findings.append(Finding(("axial_inertia",), wrong, f"{self.axial_inertia:g}", remedy))
        elif self.axial_inertia != 1.0 and self.geometry != "nonlinear":
            remedy = "leave it out, or write geometry: nonlinear"
            findings.append(
                Finding(("axial_inertia",), "is for nonlinear geometry only", f"{self.axial_inertia:g}", remedy)
            )
        if self.finds_window and self.mesh_error:
            remedy = "write mesh_error: false, or the width of the window"
            findings.append(Finding(("mesh_error",), "needs the same window on all meshes", "true", remedy))
        report("dynamic", findings)
        return self


class Quasistatic(Declaration):
    """Quasi-static motion: the equilibrium for positions of the loads at equal steps of the load path.

    The run ends when the last load has left its line or has stopped; on plain ropes also where a load with `at_end:
    refuse` comes to the end of its line. The load path is the distance covered by the load
    that is fastest at each time, among those still on their way.
    """

    kind: Literal["quasistatic"] = "quasistatic"
    positions: Annotated[int, Count(2, 1_000_000)] = Field(
        default=201, description="number of positions, both ends of the path included"
    )
    turn: TurnAngle | None = Field(
        default=None,
        description="largest angle by which the path of a load turns between two positions; positions are added "
        "where it is exceeded",
    )
    accuracy: PositiveLength | None = _OF_AUTO
    mesh_error: bool = _MESH_ERROR


class Equilibrium(Declaration):
    """The rest shape under gravity and the loads at their start."""

    kind: Literal["equilibrium"] = "equilibrium"
    accuracy: PositiveLength | None = _OF_AUTO
    mesh_error: bool = _MESH_ERROR


class Linear(Declaration):
    """The classical linear theory: small deflections that add up.

    Every line by itself is a taut string, or a beam, along its chord, and moves across that. Of joined lines, of lines
    on inner supports, of lines in wind, of nets and of membranes, and under loads with a mass for which a string or
    beam has no answer, it is small motion about rest in all directions, by superposition of modes. So it is of overhead
    lines, whose droppers that are taut at rest stay taut, and pantographs on the wire. In wind the rest is that in its
    mean over the run, where air damps, and gusts push in proportion to their speed; it begins in calm air, too.
    """

    kind: Literal["linear"] = "linear"
    until: Until = Field(
        description="end of the run, which begins at 0 s; crossing: when all loads have crossed their lines; "
        "crossing + 2 s: so much later"
    )
    every: PositiveTime | None = Field(default=None, description="interval of output (default: until / 100)")
    modes: Annotated[int, Count(1, 100_000)] | None = Field(
        default=None,
        description="terms of the modal series (default: exact for strings, converged for beams; of joined lines, "
        "nets, overhead lines and lines on inner supports all modes of the mesh, or 400; the remaining "
        "modes follow the forces quasi-statically)",
    )


Run = Annotated[Dynamic | Quasistatic | Equilibrium | Linear, Variants("run")]
"""Any run."""


_TICK = 1e-9  # s
_SMALLEST_PART = 1000  # of the shortest interval


def every_of(run: Dynamic | Linear) -> float:
    """Interval of output, s."""
    return run.every if run.every is not None else run.until / 100.0


def common_interval(intervals: Sequence[float]) -> float | None:
    """The longest interval in s of which all are whole multiples, None if that is next to nothing."""
    if len(set(intervals)) == 1:  # which may be shorter than a tick
        return intervals[0]
    ticks = [round(interval / _TICK) for interval in intervals]
    shared = math.gcd(*ticks)
    return shared * _TICK if shared and shared * _SMALLEST_PART >= min(ticks) else None
