"""What does not fit together in a scenario although every part of it is fine by itself."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from ropewalk.errors import did_you_mean
from ropewalk.model._base import Finding
from ropewalk.model.beginning import check_beginning
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.history import SpeedTable, rows
from ropewalk.model.law import Inextensible
from ropewalk.model.line import Line, spatial
from ropewalk.model.load import MovingForce, Travelling
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.parts import Parts
from ropewalk.model.places import meetings, reach, travels
from ropewalk.model.run import Dynamic, Equilibrium, Linear, Quasistatic, every_of
from ropewalk.model.settings import check_settings
from ropewalk.model.space import check_space
from ropewalk.model.stiff import check_stiff
from ropewalk.model.support import Fixed, Guided
from ropewalk.model.travel import FreeTravel
from ropewalk.model.trolley import Trolley
from ropewalk.model.vehicle import Vehicle
from ropewalk.model.walker import Walker
from ropewalk.model.webs import check_webs

_Standing = MovingForce | MovingMass | Oscillator | Trolley | Vehicle | Matrices | Pantograph
LARGEST_RESULT = 5e7
"""Nodes times output frames: about 10 GB of result, beyond what is wanted on purpose."""

_ACROSS = 0.1  # cosine between line and rail: what moves further across the line than this does not set its tension


def check(parts: Parts) -> list[Finding]:
    """Find everything that does not fit together."""
    return [
        finding
        for examine in (
            _something,
            _unknown_lines,
            check_stiff,
            check_webs,
            check_settings,
            check_space,
            check_beginning,
            _travels,
            meetings,
            _known_to_the_run,
            _unfelt,
            _friction,
            _weights,
            _counterweights,
            _path,
            _rest,
            _size,
        )
        for finding in examine(parts)
    ]


def _something(parts: Parts) -> Iterator[Finding]:
    if parts.is_complete and not parts.lines and not parts.overhead and not parts.nets:
        remedy = "add lines, overhead_lines or nets"
        yield Finding(("lines",), "is missing or empty: there is no line", remedy=remedy)
    for name in parts.overhead:
        if name in parts.lines:
            remedy = "give every line its own name"
            yield Finding(("overhead_lines", name), "a line has the same name", remedy=remedy)


def _unknown_lines(parts: Parts) -> Iterator[Finding]:
    for load, line in parts.on.items():
        known = [*parts.lines, *parts.overhead, *parts.nets]
        if line not in known:
            remedy = did_you_mean(line, known, otherwise=f"lines here: {', '.join(known)}")
            yield Finding(("loads", load, "on"), "no such line", repr(line), remedy)


def _known_to_the_run(parts: Parts) -> Iterator[Finding]:
    """What only some kinds of run know."""
    if isinstance(parts.run, Linear):
        yield from _bodies_in_linear_theory(parts, parts.run)
    elif parts.run is not None and not isinstance(parts.run, Dynamic):
        for name, load in parts.loads.items():
            if load is not None and not isinstance(load, _standing(parts)):
                remedy = "ask for kind: dynamic, or write kind: force with its weight as force"
                where = " on stiff lines" if parts.is_stiff else " on joined lines and nets" if parts.is_web else ""
                known = ", ".join(str(kind.model_fields["kind"].default) for kind in _standing(parts))
                wrong = f"kind: {parts.run.kind} supports{where} loads of kind {known}"
                yield Finding(("loads", name, "kind"), wrong, load.kind, remedy)
    yield from _margins(parts)
    if not isinstance(parts.run, Dynamic | Linear):
        return
    for name, line in parts.lines.items():
        if line is not None and isinstance(line.law, Inextensible):
            remedy = "ask for kind: quasistatic or equilibrium, or give an axial_stiffness with law hooke"
            yield Finding(("lines", name, "law"), "an inextensible line cannot move in time", remedy=remedy)
    for name, load in parts.loads.items():
        if isinstance(load, MovingForce) and load.contact in ("coulomb", "dragged"):
            wrong, remedy = "friction of a prescribed travel is for slow motion", "ask for kind: quasistatic"
            yield Finding(
                ("loads", name, "contact"), wrong, load.contact, f"{remedy}, or write clamped or frictionless"
            )
        if isinstance(parts.run, Dynamic) and isinstance(load, _Massive) and load.travel.measured == "arc":
            wrong = "a mass that follows the arc length is unstable: the line that it stretches steers it"
            remedy = "write slip, which differs by how fast the line behind gets longer, or material or horizontal"
            yield Finding(("loads", name, "travel", "measured"), wrong, "arc", remedy)


def _standing(parts: Parts) -> tuple[type[_Standing], ...]:
    """Kinds of loads that can stand on lines at rest."""
    if parts.is_stiff:
        return MovingForce, MovingMass, Oscillator, Vehicle, Matrices, Pantograph
    return (
        (MovingForce, MovingMass) if parts.is_web else (MovingForce, MovingMass, Oscillator, Trolley, Vehicle, Matrices)
    )


def _margins(parts: Parts) -> Iterator[Finding]:
    """Ends of lines for loads before their supports."""
    for name, load in parts.loads.items():
        if not isinstance(load, Travelling) or load.travel.margin is None:
            continue
        wrong = ""
        if isinstance(parts.run, Linear | Quasistatic | Equilibrium):
            wrong = f"with kind: {parts.run.kind} loads come to the supports themselves"
        elif parts.is_stiff and not parts.is_web:
            wrong = "lines with bending stiffness or a bed end at their supports for all loads"
        if wrong:
            yield Finding(("loads", name, "travel", "margin"), wrong, f"{load.travel.margin:g} m", "leave margin out")


def _unfelt(parts: Parts) -> Iterator[Finding]:
    """Keys of lines that nothing asks for."""
    for name, line in parts.lines.items():
        if line is None:
            continue
        if line.wind_drag and parts.wind is None and parts.is_complete:
            wrong, remedy = "there is no wind", "add wind (speed: 0 m/s is still air, which damps), or leave it out"
            yield Finding(("lines", name, "wind_drag"), wrong, f"{line.wind_drag:g} m", remedy)
        if not isinstance(parts.run, Linear):
            continue
        for key, support in (("start_support", line.start_support), ("end_support", line.end_support)):
            if isinstance(support, Fixed) and support.clamped:
                wrong, remedy = (
                    "kind: linear knows ends that turn freely",
                    "leave clamped out, or ask for kind: dynamic",
                )
                yield Finding(("lines", name, key, "clamped"), wrong, "true", remedy)


def _friction(parts: Parts) -> Iterator[Finding]:
    """Coefficients of friction that given forces are not held against: tensions beside them are looked at on ropes."""
    for name, load in parts.loads.items():
        if not isinstance(load, MovingForce) or load.contact in ("coulomb", "dragged"):
            continue
        if not (isinstance(parts.run, Linear) or parts.is_web or parts.is_stiff):
            continue
        wrong = "whether it holds a load is looked at on ropes alone, and not by kind: linear"
        if load.friction is not None:
            yield Finding(("loads", name, "friction"), wrong, f"{load.friction:g}", "leave it out")
        if load.friction_model != "capstan":
            yield Finding(("loads", name, "friction_model"), wrong, load.friction_model, "leave it out")


def _travels(parts: Parts) -> Iterator[Finding]:
    """Travels; in the linear theory wheels may come from level ground before the line."""
    coming = {
        name
        for name, load in parts.loads.items()
        if isinstance(parts.run, Linear)
        and isinstance(load, Vehicle | Matrices)
        and min(place.start for place in load.starts()) < 0.0
    }
    yield from travels(replace(parts, loads={k: None if k in coming else load for k, load in parts.loads.items()}))
    for name in coming:
        load = parts.loads[name]
        assert isinstance(load, Vehicle | Matrices)
        if load.travel.at_end != "leave":
            wrong = "a vehicle that comes onto the line from before its start goes over it"
            yield Finding(("loads", name, "travel", "at_end"), wrong, load.travel.at_end, "write at_end: leave")


_Massive = MovingMass | Oscillator | Trolley | Vehicle | Matrices
_LinearBody = MovingMass | Oscillator | Vehicle | Matrices


def _bodies_in_linear_theory(parts: Parts, run: Linear) -> Iterator[Finding]:
    """What of loads with a mass the linear theory does not know."""
    for name, load in parts.loads.items():
        if load is None or isinstance(load, MovingForce):
            continue
        if not isinstance(load, _LinearBody):
            wrong = "kind: linear knows forces, masses, oscillators and vehicles only"
            remedy = "ask for kind: dynamic, or write kind: force with its weight as force"
            yield Finding(("loads", name, "kind"), wrong, load.kind, remedy)
            continue
        others = [other for other in parts.loads_on(load.on) if other != name]
        if others:
            wrong, given = "kind: linear knows a load with a mass alone on its line", f"with {', '.join(others)}"
            remedy = "give it a line of its own, make one vehicle of all, or ask for kind: dynamic"
            yield Finding(("loads", name, "on"), wrong, given, remedy)
        for key, wrong, given, remedy in _not_linear(load):
            yield Finding(("loads", name, *key), f"kind: linear knows {wrong}", given, remedy)
        line = parts.lines.get(load.on)
        if line is not None:
            for key, wrong, given, remedy in _on_its_line(load, line, run):
                yield Finding(("loads", name, *key), f"kind: linear knows {wrong}", given, remedy)


_Lack = tuple[tuple[str, ...], str, str, str]
"""Key, what is known only, what was given, remedy."""


def _not_linear(load: _LinearBody) -> Iterator[_Lack]:
    """What of a load by itself is not known."""
    dynamic, travel = "ask for kind: dynamic", load.travel
    if isinstance(travel, FreeTravel):
        yield ("travel", "kind"), "masses that travel as prescribed", "free", f"{dynamic}, or give the speed"
        return
    if callable(travel.speed) or isinstance(travel.speed, SpeedTable):
        remedy = f"write one number, or {dynamic}"
        yield ("travel", "speed"), "masses that travel with constant speed", "a speed that varies", remedy
    elif travel.speed == 0.0:
        yield ("travel", "speed"), "masses that travel", "0 m/s", f"write a speed, or {dynamic}"
    if travel.measured in ("slip", "arc"):
        remedy = "write material or horizontal: with a constant tension the difference is a factor"
        yield ("travel", "measured"), "masses measured as material or horizontal", travel.measured, remedy
    if travel.at_end == "stay":
        yield ("travel", "at_end"), "masses that go over the line", "stay", "write leave, or end the run before"
    if load.lift_off and load.side == "below":
        yield ("side",), "lift_off of what runs above", "below", f"write above, or {dynamic}"
    if isinstance(load, Matrices) and load.has_gyroscopic_damping:
        yield ("damping",), "symmetric damping", "a matrix that is not symmetric", f"make it symmetric, or {dynamic}"
    if isinstance(load, MovingMass | Oscillator) and load.air_drag:
        yield ("air_drag",), "no drag of the air", f"{load.air_drag:g} kg/m", f"leave it out, or {dynamic}"
    if isinstance(load, MovingMass):
        force = load.force
        if callable(force) or len(set(rows(force))) > 1 or any(any(row[:-1]) for row in rows(force)):
            remedy = f"write [0, Fz], or {dynamic}"
            yield ("force",), "a constant vertical force on a mass", "another force", remedy
    soft: list[tuple[tuple[str, ...], float | None]] = []
    if isinstance(load, Oscillator):
        soft = [(("contact_stiffness",), load.contact_stiffness)]
    elif isinstance(load, Vehicle):
        soft = [(("wheels", name, "contact_stiffness"), wheel.contact_stiffness) for name, wheel in load.wheels.items()]
    for key, stiffness in soft:
        if stiffness is not None:
            yield key, "rigid contact", f"{stiffness:g} N/m", f"leave it out, or {dynamic}"


def _on_its_line(load: _LinearBody, line: Line, run: Linear) -> Iterator[_Lack]:
    """What of a load on this line is not known."""
    if abs(line.end[-1] - line.start[-1]) > 1e-9 * line.distance:
        given = f"heights {line.start[-1]:g} and {line.end[-1]:g} m"
        yield ("on",), "masses on lines whose ends have one height", given, "level the line, or ask for kind: dynamic"
    if line.bending_stiffness or run.modes is not None:
        return
    otherwise = "give the line a bending_stiffness, or ask for kind: dynamic"
    if isinstance(load, Vehicle | Matrices):
        wrong = "a mass or an oscillator, no more, on a line without bending stiffness"
        yield ("kind",), wrong, load.kind, otherwise
        return
    if load.lift_off:
        wrong = "no lift-off from a line without bending stiffness"
        yield ("lift_off",), wrong, "true", f"leave it out to be warned where contact would be lost, or {otherwise}"
    if isinstance(load.travel, FreeTravel) or callable(load.travel.speed) or isinstance(load.travel.speed, SpeedTable):
        return
    limit, start = reach(line, load.travel.measured), load.travel.start
    if (load.travel.speed > 0.0 and start != 0.0) or (
        load.travel.speed < 0.0 and limit is not None and abs(start - limit) > 1e-9 * limit
    ):
        wrong = "masses that enter at an end, on a line without bending stiffness"
        yield ("travel", "from"), wrong, f"{start:g} m", otherwise


def _weights(parts: Parts) -> Iterator[Finding]:
    """What cannot be without gravity."""
    if parts.gravity != 0.0:
        return
    for name, load in parts.loads.items():
        if isinstance(load, Footsteps | Walker):
            yield Finding(("loads", name, "kind"), "nobody walks without gravity", load.kind, "give gravity")
        if isinstance(load, Trolley) and load.payload.stiffness is None:
            wrong = "is missing, without a weight there is no default"
            remedy = "add stiffness (of the payload's rope, in N/m), or give gravity"
            yield Finding(("loads", name, "payload", "stiffness"), wrong, remedy=remedy)


def _counterweights(parts: Parts) -> Iterator[Finding]:
    """Lines whose tension is given, and is set by what pulls at a free end besides."""
    for name, line in parts.lines.items():
        if line is None or line.tension is None or line.sheaves:
            continue
        chord = [b - a for a, b in zip(spatial(line.start), spatial(line.end), strict=True)]
        for key, support in (("start_support", line.start_support), ("end_support", line.end_support)):
            if not isinstance(support, Guided) or not support.force or support.stiffness:
                continue
            size = math.hypot(*support.along) * math.hypot(*chord)
            along = sum(a * b for a, b in zip(_flat(support.along), chord, strict=True)) / size
            if abs(along) < _ACROSS:
                continue
            pull = abs(support.force / along)
            wrong = f"lines.{name}.{key}.force pulls with {pull:.4g} N along the line: both set its tension"
            remedy = "give length instead of tension, or leave force out"
            yield Finding(("lines", name, "tension"), wrong, f"{line.tension:g} N", remedy)


def _flat(vector: Sequence[float]) -> tuple[float, float, float]:
    """A direction in space: those of two numbers lie in the x-z plane."""
    return vector[0], vector[1] if len(vector) == 3 else 0.0, vector[-1]


def _path(parts: Parts) -> Iterator[Finding]:
    if not isinstance(parts.run, Quasistatic):
        return
    if not parts.loads:
        remedy = "add a load, or write kind: equilibrium"
        yield Finding(("run", "kind"), "no load moves along a path", "quasistatic", remedy)
    for name, load, on, line in parts.complete():
        if not isinstance(load, Travelling) or isinstance(load.travel, FreeTravel):
            continue
        speed = load.travel.speed
        if callable(speed):
            continue
        values = speed.value if isinstance(speed, SpeedTable) else (speed,)
        key = ("loads", name, "travel", "speed")
        if not any(values):
            remedy = "write a speed (its sign is the direction of the path), or ask for kind: equilibrium"
            yield Finding(key, "a load that stands still has no path", "0 m/s", remedy)
            continue
        limit, start = reach(line, load.travel.measured), load.travel.start
        if isinstance(load, Vehicle | Matrices):
            continue  # wheels of theirs stand elsewhere
        if (max(values) <= 0.0 and start == 0.0) or (min(values) >= 0.0 and start == limit):
            end = "start" if start == 0.0 else "end"
            remedy = "let it start elsewhere (from), or turn the sign of speed"
            yield Finding(key, f"the load stands at the {end} of {on} and would move off it", remedy=remedy)


def _rest(parts: Parts) -> Iterator[Finding]:
    if parts.gravity != 0.0 or parts.run is None or parts.is_web:  # joints, nets and wind give lines a shape, too
        return
    if isinstance(parts.run, Dynamic):
        if parts.run.start.kind == "result":
            return
        with_loads = parts.run.start.with_loads
    else:
        with_loads = True
    for name, line in parts.lines.items():
        if line is None or line.length is None or line.length <= line.distance * (1.0 + 1e-12):
            continue
        if not line.is_held_fast:
            continue
        if with_loads and parts.loads_on(name):
            continue
        wrong = "without gravity the rest shape of a line longer than the distance of its ends is not determined"
        remedy = f"give gravity, a length of at most {line.distance:g} m, or tension instead of length"
        yield Finding(("lines", name, "length"), wrong, f"{line.length:g} m", remedy)


def _size(parts: Parts) -> Iterator[Finding]:
    run = parts.run
    if isinstance(run, Dynamic | Linear):
        if run.every is not None and run.every > run.until:
            remedy = f"write at most {run.until:g} s (run.until)"
            yield Finding(("run", "every"), "longer than the run", f"{run.every:g} s", remedy)
            return
        frames = 1.0 + run.until / every_of(run)
        key = ("run", "every" if run.every is not None else "until")
    elif isinstance(run, Quasistatic):
        frames, key = float(run.positions), ("run", "positions")
    else:
        return
    nodes = len(parts.loads) + sum(line.elements + 1 for line in parts.lines.values() if line is not None)
    nodes += sum(int(2.0 * line.length / line.element) for line in parts.overhead.values() if line is not None)
    if frames * nodes > LARGEST_RESULT:
        number = f"{frames * nodes:.3g} node positions ({frames:.4g} frames of {nodes} nodes)"
        action = "positions" if isinstance(run, Quasistatic) else "every"
        verb = "lower" if isinstance(run, Quasistatic) else "raise"
        remedy = f"{verb} run.{action} or lower elements: at most {LARGEST_RESULT:g} are kept"
        yield Finding(key, f"the result would hold {number}", remedy=remedy)
