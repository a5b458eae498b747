"""What the linear theory supports."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ropewalk.model._base import Finding
from ropewalk.model.capabilities import LAWS_OF_STRAIN, OF_LINEAR_THEORY, WITHOUT_KIND, Capabilities
from ropewalk.model.history import SpeedTable, rows
from ropewalk.model.line import Line
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices
from ropewalk.model.missing import missing
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.parts import Parts
from ropewalk.model.places import reach
from ropewalk.model.run import Linear
from ropewalk.model.support import stands_still
from ropewalk.model.travel import FreeTravel
from ropewalk.model.vehicle import Vehicle

_LINEAR, _DYNAMIC = "kind: linear", "ask for kind: dynamic"
_Body = MovingMass | Oscillator | Vehicle | Matrices
_Lack = tuple[tuple[str, ...], str, str, str]
"""Key, what of it is not implemented, what was given, remedy."""


def _overhead_lines(parts: Parts) -> Iterator[Finding]:
    if parts.overhead:
        yield missing(("run", "kind"), "overhead lines", "linear", f"{_DYNAMIC} with geometry: linearised")


def _supports(parts: Parts) -> Iterator[Finding]:
    for name, line in parts.lines.items():
        for key, support in line.ends() if line is not None else ():
            if not stands_still(support):
                feature, remedy = "a support that yields or moves", f"write kind: fixed, or {_DYNAMIC}"
                yield missing(("lines", name, key), _LINEAR, support.kind, remedy, feature=feature)


def _bodies(parts: Parts) -> Iterator[Finding]:
    """Loads with a mass."""
    for name, load in parts.loads.items():
        if not isinstance(load, _Body):
            continue
        if others := [other for other in parts.loads_on(load.on) if other != name]:
            feature, given = "a load with a mass together with other loads on its line", f"with {', '.join(others)}"
            remedy = f"give it a line of its own, make one vehicle of all, or {_DYNAMIC}"
            yield missing(("loads", name, "on"), _LINEAR, given, remedy, feature=feature)
        line = parts.lines.get(load.on)
        if line is not None and line.beta:
            feature = "a load with a mass on a line with stiffness-proportional damping"
            yield missing(("loads", name, "on"), _LINEAR, load.on, f"use drag, or {_DYNAMIC}", feature=feature)
        for key, feature, given, remedy in (*_own(load), *(_on(load, line, parts.run) if line is not None else ())):
            yield missing(("loads", name, *key), _LINEAR, given, remedy, feature=feature)


def _own(load: _Body) -> Iterator[_Lack]:
    """What is not implemented of a load by itself."""
    travel = load.travel
    if isinstance(travel, FreeTravel):
        return
    if callable(travel.speed) or isinstance(travel.speed, SpeedTable):
        remedy = f"write one number, or {_DYNAMIC}"
        yield ("travel", "speed"), "a mass at variable speed", "a speed that varies", remedy
    elif travel.speed == 0.0:
        yield ("travel", "speed"), "a mass that stands still", "0 m/s", f"write a speed, or {_DYNAMIC}"
    if travel.measured in ("slip", "arc"):
        remedy = "write material or horizontal: with a constant tension the difference is a factor"
        yield ("travel", "measured"), "this measure for a mass", travel.measured, remedy
    if travel.at_end == "stay":
        yield ("travel", "at_end"), "a mass that stays on the line", "stay", "write leave, or end the run before"
    if any(place.start < 0.0 for place in load.starts()) and travel.at_end == "refuse":
        yield ("travel", "at_end"), "a vehicle that starts before its line", "refuse", "write at_end: leave"
    if load.lift_off and load.side == "below":
        yield ("side",), "lift_off from below", "below", f"write above, or {_DYNAMIC}"
    if isinstance(load, Matrices) and load.has_gyroscopic_damping:
        remedy = f"make it symmetric, or {_DYNAMIC}"
        yield ("damping",), "gyroscopic damping", "a matrix that is not symmetric", remedy
    if isinstance(load, MovingMass):
        force = load.force
        if callable(force) or len(set(rows(force))) > 1 or any(any(row[:-1]) for row in rows(force)):
            remedy = f"write [0, Fz], or {_DYNAMIC}"
            yield ("force",), "a force on a mass that is not constant and vertical", "another force", remedy
    for wheel, its in load.wheels.items() if isinstance(load, Vehicle) else ():
        if its.contact_stiffness is not None:
            given, remedy = f"{its.contact_stiffness:g} N/m", f"leave it out, or {_DYNAMIC}"
            yield ("wheels", wheel, "contact_stiffness"), "", given, remedy


def _on(load: _Body, line: Line, run: object) -> Iterator[_Lack]:
    """What is not implemented of a load on this line."""
    if abs(line.end[-1] - line.start[-1]) > 1e-9 * line.distance:
        given = f"heights {line.start[-1]:g} and {line.end[-1]:g} m"
        yield ("on",), "a mass on a line with ends at different heights", given, f"level the line, or {_DYNAMIC}"
    if line.bending_stiffness or not isinstance(run, Linear) or run.modes is not None:
        return
    otherwise, on_string = f"give the line a bending_stiffness, or {_DYNAMIC}", "on a line without bending stiffness"
    if isinstance(load, Vehicle | Matrices):
        yield ("kind",), f"a load other than a mass or an oscillator {on_string}", load.kind, otherwise
        return
    if load.lift_off:
        remedy = f"leave it out to be warned where contact would be lost, or {otherwise}"
        yield ("lift_off",), f"lift-off {on_string}", "true", remedy
    if isinstance(load.travel, FreeTravel) or callable(load.travel.speed) or isinstance(load.travel.speed, SpeedTable):
        return
    start = load.travel.start
    if (load.travel.speed > 0.0 and start != 0.0) or (load.travel.speed < 0.0 and not _is_at_end(load, line)):
        yield ("travel", "from"), _INSIDE, f"{start:g} m", otherwise


def _is_at_end(load: _Body, line: Line) -> bool:
    """Whether a load starts at the end of its line, as far as that is known: a length by tension follows from sag."""
    assert not isinstance(load.travel, FreeTravel)
    limit, off = reach(line, load.travel.measured), 1e-9
    if limit is None:
        limit, off = line.distance, 0.01 + (line.tension or 0.0) / (line.axial_stiffness or math.inf)
    return abs(load.travel.start - limit) <= off * limit


_INSIDE = "a mass that starts between the ends of a line without bending stiffness"


def mass_inside(name: str, start: float) -> Finding:
    """A mass on a string that does not run over all of it."""
    remedy = f"let it start at an end, give the line a bending_stiffness, or {_DYNAMIC}"
    return missing(("loads", name, "travel", "from"), _LINEAR, f"{start:g} m", remedy, feature=_INSIDE)


CAPABILITIES = Capabilities(
    _LINEAR,
    only={
        "lines.law.kind": LAWS_OF_STRAIN,
        "lines.start_support.clamped": (False,),
        "lines.end_support.clamped": (False,),
        **OF_LINEAR_THEORY,
    },
    instead={
        "lines.law.kind": "ask for kind: quasistatic or equilibrium, or give an axial_stiffness with law hooke",
        "lines.start_support.clamped": f"leave clamped out, or {_DYNAMIC}",
        "lines.end_support.clamped": f"leave clamped out, or {_DYNAMIC}",
        "loads.kind": WITHOUT_KIND,
        "loads.travel.kind": f"{_DYNAMIC}, or give the speed",
        "loads.contact": "ask for kind: quasistatic or dynamic, or write clamped or frictionless",
        "loads.contact_stiffness": f"leave it out, or {_DYNAMIC}",
        "loads.air_drag": f"leave it out, or {_DYNAMIC}",
    },
    more=(_overhead_lines, _supports, _bodies),
)
