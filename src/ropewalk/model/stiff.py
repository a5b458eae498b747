"""What lines with bending stiffness, lines on beds and overhead lines do not know of, yet."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ropewalk.model._base import Finding
from ropewalk.model.history import rows
from ropewalk.model.law import Hooke
from ropewalk.model.line import Line
from ropewalk.model.load import Foreign, MovingForce
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.parts import Parts
from ropewalk.model.run import Dynamic, Linear, common_interval, every_of
from ropewalk.model.support import Fixed, Guided
from ropewalk.model.travel import FreeTravel
from ropewalk.model.vehicle import Vehicle

# Euler's load of a strut over that on hinges, with none, one and both of its ends clamped.
_BUCKLES = (1.0, 2.0457, 4.0)
_LEVEL = 1e-9  # slope of a line that is level
_Known = MovingForce | MovingMass | Oscillator | Vehicle | Matrices
_Lack = tuple[tuple[str, ...], str, str, str]


def check_stiff(parts: Parts) -> Iterator[Finding]:
    """Find what does not go together with stiff lines, and pantographs off overhead lines."""
    stiff = [name for name, line in parts.lines.items() if line is not None and line.is_stiff]
    for name, load in parts.loads.items():
        on_overhead = parts.on.get(name) in parts.overhead
        if isinstance(load, Pantograph) and not on_overhead and load.on in parts.lines:
            remedy = f"name one of overhead_lines: {', '.join(parts.overhead) or 'there are none'}"
            yield Finding(("loads", name, "on"), "a pantograph runs under an overhead line", repr(load.on), remedy)
        if load is not None and on_overhead and not isinstance(load, Pantograph | Foreign | MovingForce):
            wrong = "only pantographs run under overhead lines, forces and models of your own"
            remedy = "write kind: pantograph"
            yield Finding(("loads", name, "kind"), wrong, load.kind, remedy)
    if isinstance(parts.run, Linear) and parts.overhead:
        remedy = "ask for kind: dynamic with geometry: linearised"
        yield Finding(("run", "kind"), "kind: linear does not know overhead lines", "linear", remedy)
    if not (stiff or parts.overhead) or parts.run is None or isinstance(parts.run, Linear):
        return
    if isinstance(parts.run, Dynamic):
        yield from _run(parts.run)
        yield from _intervals(parts, parts.run)
        for name, overhead in parts.overhead.items():
            if overhead is not None and overhead.stitch_wire is not None and parts.run.geometry == "nonlinear":
                wrong, remedy = "the nonlinear motion does not know stitch wires", "write run.geometry: linearised"
                yield Finding(("overhead_lines", name, "stitch_wire"), wrong, remedy=remedy)
    if parts.gravity == 0.0 and parts.overhead:
        yield Finding(("gravity",), "an overhead line hangs by its weight", "0 m/s^2", "leave gravity out")
    small = isinstance(parts.run, Dynamic) and parts.run.geometry == "linearised"
    for name, line in parts.lines.items():
        if line is not None:
            for key, wrong, given, remedy in _slack(line) if small else ():
                yield Finding(("lines", name, *key), f"in small motion {wrong}", given, remedy)
            for key, wrong, given, remedy in _line(line):
                yield Finding(("lines", name, *key), f"beside stiff lines {wrong}", given, remedy)
    for name, load in parts.loads.items():
        if load is None or isinstance(load, Pantograph | Foreign):
            continue
        if not isinstance(load, _Known):
            wrong = "stiff lines know forces, masses, oscillators, vehicles and models of your own only"
            yield Finding(("loads", name, "kind"), wrong, load.kind, "write one of these")
            continue
        for key, wrong, given, remedy in _load(load):
            yield Finding(("loads", name, *key), f"on stiff lines {wrong}", given, remedy)


def _intervals(parts: Parts, run: Dynamic) -> Iterator[Finding]:
    """Foreign models that are asked at instants which do not go together."""
    if common_interval([every_of(run), *(f.every for f in parts.loads.values() if isinstance(f, Foreign))]) is None:
        name, load = next((n, f) for n, f in parts.loads.items() if isinstance(f, Foreign))
        wrong = f"stiff lines need intervals with a common part, and run.every is {every_of(run):g} s"
        remedy = "let run.every be a whole multiple of it"
        yield Finding(("loads", name, "every"), wrong, f"{load.every:g} s", remedy)


def _run(run: Dynamic) -> Iterator[Finding]:
    if run.method not in ("auto", "explicit"):
        remedy = "write auto, or leave it out"
        yield Finding(("run", "method"), "stiff lines and overhead lines move explicitly", run.method, remedy)
    if run.start.whirl:
        wrong, remedy = "stiff lines and overhead lines do not whirl, they move up and down", "leave it out"
        yield Finding(("run", "start", "whirl"), wrong, "true", remedy)
    if run.window is not None and run.start.kind != "rest":
        wrong = "with a window only what is near the contacts moves, and a mode or a stored instant moves all"
        yield Finding(("run", "window"), wrong, f"{run.window:g} m", "leave window out, or start at rest")
    if run.start.direction is not None and len(run.start.direction) == 3 and run.start.direction[1] != 0.0:
        wrong = "modes of stiff lines and overhead lines lie in the x-z plane"
        given = str([float(value) for value in run.start.direction])
        yield Finding(("run", "start", "direction"), wrong, given, "write [x, z], or leave it out")


def _line(line: Line) -> Iterator[_Lack]:
    if not isinstance(line.law, Hooke):
        yield ("law",), "only law hooke is known", line.law.kind, "leave law out"
    if line.axial_damping:
        yield ("axial_damping",), "it is not known", f"{line.axial_damping:g} N*s", "leave it out, or use drag"
    if any(len(point) == 3 and point[1] != 0.0 for point in (line.start, line.end)):
        yield ("start",), "lines in the x-z plane are known", "a point with y", "write [x, z]"


def _slack(line: Line) -> Iterator[_Lack]:
    """What small motion about a straight line cannot be about: a line that is slack, or buckles."""
    supports = line.start_support, line.end_support
    yield from _constant(line)
    if line.length is None or not line.axial_stiffness or not all(isinstance(support, Fixed) for support in supports):
        return
    push = line.axial_stiffness * (1.0 - line.distance / line.length)
    clamped = sum(isinstance(support, Fixed) and support.clamped for support in supports)
    limit = _BUCKLES[clamped] * line.bending_stiffness * (math.pi / line.distance) ** 2
    given, remedy = f"{line.length:g} m over {line.distance:g} m", "write run.geometry: nonlinear, or give tension"
    if not line.bending_stiffness and push >= 0.0:
        yield ("length",), "a line without bending_stiffness needs a tension", given, f"{remedy}, or less length"
    elif line.bending_stiffness and not line.foundation and push >= limit:
        wrong = f"a line longer than its chord is a strut, and this one buckles at {limit:.4g} N; it bears {push:.4g} N"
        yield ("length",), wrong, given, remedy


def _constant(line: Line) -> Iterator[_Lack]:
    """Supports that would change the tension to the first order, which small motion has constant."""
    level, constant = abs(line.start[-1] - line.end[-1]) <= _LEVEL * line.distance, "tensions are constant"
    for key, support in (("start_support", line.start_support), ("end_support", line.end_support)):
        slides = isinstance(support, Guided) and not support.along[-1]
        if isinstance(support, Guided) and support.along[0] and support.along[-1]:
            wrong = f"{constant}, and an end on an inclined rail changes them"
            yield (key, "along"), wrong, str(list(support.along)), "write [1, 0] or [0, 1], or geometry: nonlinear"
        elif not (level or slides or isinstance(support, Fixed)):
            wrong = f"{constant}, and an end of an inclined line that moves up and down stretches it"
            yield (key,), wrong, support.kind, "write run.geometry: nonlinear, or kind: fixed"
        history = getattr(support, "displacement", (0.0, 0.0))
        if len({row[0] for row in rows(history)}) > 1:  # callables are looked at when they are tabulated
            remedy = "write a table whose x does not change, or geometry: nonlinear"
            yield (key, "displacement"), f"{constant}, and a support that moves along x changes them", "", remedy


def _load(load: _Known) -> Iterator[_Lack]:
    travel = load.travel
    if isinstance(travel, FreeTravel):
        yield ("travel", "kind"), "loads travel as prescribed", "free", "give a speed"
        return
    if travel.measured in ("slip", "arc"):
        remedy = "write material or horizontal"
        yield ("travel", "measured"), "travel is measured as material or horizontal", travel.measured, remedy
    if travel.at_end == "stay":
        yield ("travel", "at_end"), "loads run over the line", "stay", "write leave, or end the run before"
    if isinstance(load, MovingForce | MovingMass):
        if load.contact != "clamped":
            yield ("contact",), "contacts press vertically, no more", load.contact, "leave contact out"
        force = load.force
        if callable(force) or any(any(row[:-1]) for row in rows(force)):
            yield ("force",), "forces are vertical", "another force", "write [0, Fz], or a table of such"
    if isinstance(load, Oscillator):
        for one in ("stiffness", "damping"):
            values = getattr(load, one)
            if isinstance(values, tuple):
                yield (one,), "springs act up and down only", str(list(values)), f"write {values[-1]:g}"
    if isinstance(load, Matrices) and load.has_gyroscopic_damping:
        yield ("damping",), "damping is symmetric", "a matrix that is not", "make it symmetric"
    if isinstance(load, MovingMass | Oscillator) and load.air_drag:
        yield ("air_drag",), "drag of the air is not known", f"{load.air_drag:g} kg/m", "leave it out"
