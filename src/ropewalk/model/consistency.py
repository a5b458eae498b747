"""What does not fit together in a scenario although every part of it is fine by itself."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from ropewalk import hooks
from ropewalk.errors import did_you_mean
from ropewalk.model._base import Finding
from ropewalk.model.axles import Axles
from ropewalk.model.beginning import check_beginning
from ropewalk.model.carriage import Carriage, check_carriages
from ropewalk.model.course import course
from ropewalk.model.crab import check_crabs
from ropewalk.model.crossing import check_crossing, crossed
from ropewalk.model.crowd import is_one_of_many
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.history import SpeedTable
from ropewalk.model.joints import check_joints
from ropewalk.model.line import spatial
from ropewalk.model.load import AnyLoad, MovingForce, Travelling
from ropewalk.model.magnitudes import check_magnitudes
from ropewalk.model.mass import MovingMass
from ropewalk.model.matrices import Matrices
from ropewalk.model.mesh import check_mesh
from ropewalk.model.oscillator import Oscillator
from ropewalk.model.outputs import check_outputs
from ropewalk.model.overlap import check_overlaps
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.parts import Parts
from ropewalk.model.people import of_crowds
from ropewalk.model.places import meetings, reach, travels
from ropewalk.model.position import check_positions
from ropewalk.model.run import Dynamic, Linear, Quasistatic, every_of
from ropewalk.model.settings import check_settings
from ropewalk.model.small import check_overhead
from ropewalk.model.space import check_space
from ropewalk.model.strips import check_strips
from ropewalk.model.support import Guided
from ropewalk.model.track import check_tracks
from ropewalk.model.travel import FreeTravel
from ropewalk.model.trolley import Trolley
from ropewalk.model.vehicle import Vehicle
from ropewalk.model.walker import Walker

_Loaded = MovingForce | MovingMass | Oscillator | Trolley | Vehicle | Matrices | Pantograph
LARGEST_RESULT, LARGEST_IN_MEMORY = 2e9, 5e7
"""Nodes times output frames: beyond what is wanted on purpose, and about 10 GB of what is not written to a file."""

LEAST_ROPE = 0.99
"""Part of the rope of a payload that may be taken in."""
_MOST_FRAMES = 1e7
_ACROSS = 0.1  # cosine between line and rail: what moves further across the line than this does not set its tension


def check(parts: Parts) -> list[Finding]:
    """Find everything that does not fit together, or that the engine for it does not support."""
    parts = crossed(parts)
    people = {name for name, load in parts.loads.items() if is_one_of_many(name) and isinstance(load, Footsteps)}
    found = (
        finding
        for examine in (
            _something,
            _unknown_lines,
            check_overhead,
            check_overlaps,
            check_strips,
            check_joints,
            check_tracks,
            check_settings,
            check_magnitudes,
            check_mesh,
            check_space,
            check_beginning,
            check_positions,
            _travels,
            meetings,
            check_crossing,
            check_outputs,
            check_carriages,
            check_crabs,
            _steered,
            _unfelt,
            _weights,
            _hoists,
            _counterweights,
            _path,
            _static_part,
            _rest,
            _size,
            hooks.unsupported,
        )
        for finding in examine(parts)
    )
    # One vehicle of a train may be like the next one.
    return list(dict.fromkeys(_of_train(finding) for finding in of_crowds(found, people)))


def _of_train(finding: Finding) -> Finding:
    """A finding about a vehicle of a train, which is the train's; no other name of a load has a dot."""
    path = finding.path
    if path[:1] != ("loads",) or len(path) < 2 or "." not in str(path[1]):
        return finding
    return replace(finding, path=("loads", str(path[1]).partition(".")[0], *path[2:]))


def _something(parts: Parts) -> Iterator[Finding]:
    if parts.is_complete and not parts.lines and not parts.overhead and not parts.nets:
        remedy = "add lines, overhead_lines or nets"
        yield Finding(("lines",), "is required and not empty: there is no line", remedy=remedy)
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


def _steered(parts: Parts) -> Iterator[Finding]:
    """Masses that the line which they stretch would steer."""
    for name, load in parts.loads.items():
        if isinstance(parts.run, Dynamic) and isinstance(load, _Massive) and load.travel.measured == "arc":
            wrong = "a mass that follows the arc length is unstable: it stretches the line that determines its place"
            remedy = "write slip, which differs by how fast the line behind gets longer, or material or horizontal"
            yield Finding(("loads", name, "travel", "measured"), wrong, "arc", remedy)


def _unfelt(parts: Parts) -> Iterator[Finding]:
    """Keys of lines that nothing asks for."""
    for name, line in parts.lines.items():
        if line is None:
            continue
        if line.wind_drag and parts.wind is None and parts.is_complete:
            wrong, remedy = "there is no wind", "add wind (speed: 0 m/s is still air, which damps), or leave it out"
            yield Finding(("lines", name, "wind_drag"), wrong, f"{line.wind_drag:g} m", remedy)


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


_Massive = MovingMass | Oscillator | Trolley | Vehicle | Matrices


def _weights(parts: Parts) -> Iterator[Finding]:
    """What cannot be without gravity."""
    if parts.gravity != 0.0:
        return
    for name, load in parts.loads.items():
        if isinstance(load, Footsteps | Walker):
            yield Finding(("loads", name, "kind"), "a walker needs gravity", load.kind, "give gravity")
        if isinstance(load, Trolley) and load.payload.stiffness is None:
            wrong = "is required without gravity, there is no default"
            remedy = "add stiffness (of the payload's rope, in N/m), or give gravity"
            yield Finding(("loads", name, "payload", "stiffness"), wrong, remedy=remedy)


def _hoists(parts: Parts) -> Iterator[Finding]:
    """Ropes of payloads that would be taken in to nothing, or where nothing moves."""
    for name, load in parts.loads.items():
        if not isinstance(load, Trolley) or callable(load.payload.hoist) or load.payload.hoist == 0.0:
            continue
        path = ("loads", name, "payload", "hoist")
        if isinstance(parts.run, Dynamic):
            stretches = course(load.payload.hoist, 0.0, parts.run.until)
            most = max(piece.place(piece.begin + piece.duration) for piece in stretches)
            if most >= LEAST_ROPE * load.payload.length:
                wrong = f"takes in {most:.4g} m of a rope of {load.payload.length:g} m until {parts.run.until:g} s"
                yield Finding(path, wrong, remedy="let it stop before, give more length, or end the run before")
        elif parts.run is not None:
            yield Finding(
                path, "a rope of variable length needs a time", remedy="ask for kind: dynamic, or leave it out"
            )


def _counterweights(parts: Parts) -> Iterator[Finding]:
    """Lines whose tension is given, and is set by what pulls at a free end besides."""
    for name, line in parts.lines.items():
        if line is None or line.tension is None or line.sheaves:
            continue
        chord = [b - a for a, b in zip(spatial(line.start), spatial(line.end), strict=True)]
        for key, support in line.ends():
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


def _moves(load: AnyLoad | None) -> bool:
    """Whether a prescribed travel has a speed at some time."""
    speed = load.travel.speed if isinstance(load, Travelling) else 0.0
    return callable(speed) or any(speed.value if isinstance(speed, SpeedTable) else (speed,))


def _static_part(parts: Parts) -> Iterator[Finding]:
    """Find loads that stand still, of whose crossing there is no static part."""
    if parts.outputs.impact and isinstance(parts.run, Dynamic | Linear) and parts.loads:
        for found in _path(replace(parts, run=Quasistatic())):
            where, remedy = ".".join(map(str, found.path)), "let the load move, or leave impact out"
            yield Finding(
                ("outputs", "impact"), f"there is no static part: {where}: {found.wrong}", found.given, remedy
            )
            return


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
            if any(_moves(other) for other in parts.loads.values()):
                continue
            remedy = "write a speed (its sign is the direction of the path), or ask for kind: equilibrium"
            yield Finding(key, "a load that stands still has no path", "0 m/s", remedy)
            continue
        limit, start = reach(line, load.travel.measured), load.travel.start
        if isinstance(load, Vehicle | Matrices | Axles):
            continue  # wheels of theirs stand elsewhere
        if (max(values) <= 0.0 and start == 0.0) or (min(values) >= 0.0 and start == limit):
            end = "start" if start == 0.0 else "end"
            remedy = "let it start elsewhere (from), or turn the sign of speed"
            yield Finding(key, f"the load stands at the {end} of {on} and would move off it", remedy=remedy)


def _rest(parts: Parts) -> Iterator[Finding]:
    if parts.gravity != 0.0 or parts.run is None or parts.is_network:  # joints, nets and wind give lines a shape, too
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
        if not line.is_restrained_fast:
            continue
        if with_loads and parts.loads_on(name):
            continue
        wrong = "without gravity the equilibrium of a line longer than the distance of its ends is not determined"
        remedy = f"give gravity, a length of at most {line.distance:g} m, or tension instead of length"
        yield Finding(("lines", name, "length"), wrong, f"{line.length:g} m", remedy)


def _size(parts: Parts) -> Iterator[Finding]:
    run = parts.run
    if isinstance(run, Dynamic | Linear) and run.every is not None and run.every > run.until:
        remedy = f"write at most {run.until:g} s (run.until)"
        yield Finding(("run", "every"), "longer than the run", f"{run.every:g} s", remedy)
        return
    yield from too_large(parts, LARGEST_RESULT)


def nodes_of(parts: Parts) -> int:
    """Return the number of nodes and contacts of all lines and nets, about."""
    contacts = sum(
        len(load.starts()) if isinstance(load, Axles | Carriage | Vehicle) else 1 for load in parts.loads.values()
    )
    nodes = contacts + sum(net.nodes for net in parts.nets.values() if net is not None)
    window = parts.run.window if isinstance(parts.run, Dynamic) else None
    for line in parts.lines.values():
        if line is not None:
            nodes += line.elements + 1
            if isinstance(window, float) and (length := line.length or line.distance):
                nodes += int(min(line.elements * window / length, 1e15))
    return nodes + sum(int(2.0 * line.length / line.element) for line in parts.overhead.values() if line is not None)


def too_large(parts: Parts, most: float, otherwise: str = "") -> Iterator[Finding]:
    """Find whether a result would hold more than so many places of nodes.

    Args:
        parts: of the scenario.
        most: nodes times frames.
        otherwise: what else may be done about it.
    """
    run = parts.run
    if isinstance(run, Dynamic | Linear):
        frames = 1.0 + run.until / every_of(run)
        key = ("run", "every" if run.every is not None else "until")
    elif isinstance(run, Quasistatic):
        frames, key = float(run.positions), ("run", "positions")
    else:
        return
    nodes, verb = nodes_of(parts), "lower" if isinstance(run, Quasistatic) else "raise"
    if frames * nodes > most:
        number = f"{frames * nodes:.3g} node positions ({frames:.4g} frames of {nodes} nodes)"
        action = "positions" if isinstance(run, Quasistatic) else "every"
        finer = "elements or cells of nets" if parts.nets else "elements"
        remedy = f"{otherwise}{verb} run.{action} or lower {finer}: at most {most:g} are kept"
        yield Finding(key, f"the result would hold {number}", remedy=remedy)
    elif frames > _MOST_FRAMES:
        remedy = f"{verb} {'.'.join(key)}: at most {_MOST_FRAMES:g} are kept"
        yield Finding(key, f"the result would have {frames:.2g} frames", remedy=remedy)
