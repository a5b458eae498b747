"""What does not fit together in a scenario although every part of it is fine by itself."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import combinations

from ropewalk.errors import did_you_mean
from ropewalk.model._base import Finding
from ropewalk.model.course import Piece, between, course, first_at_most, place_at
from ropewalk.model.history import SpeedTable
from ropewalk.model.law import Inextensible
from ropewalk.model.line import Line
from ropewalk.model.load import MovingForce
from ropewalk.model.run import Dynamic, Equilibrium, Linear, Quasistatic
from ropewalk.model.travel import Travel

LARGEST_RESULT = 5e7
"""Nodes times output frames: about 10 GB of result, beyond what is wanted on purpose."""


@dataclass(frozen=True)
class Parts:
    """A scenario in parts; a part that is itself wrong is None, and checks that need it are left out."""

    lines: Mapping[str, Line | None]
    loads: Mapping[str, MovingForce | None]
    run: Dynamic | Quasistatic | Equilibrium | Linear | None
    gravity: float | None
    on: Mapping[str, str] = field(default_factory=dict)  # line named by each load, also by those that are None

    def loads_on(self, line: str) -> list[str]:
        """Names of the loads on a line."""
        return [load for load, name in self.on.items() if name == line]


def check(parts: Parts) -> list[Finding]:
    """Find everything that does not fit together."""
    return [
        finding
        for examine in (_unknown_lines, _travels, _meetings, _known_to_the_run, _path, _rest, _size)
        for finding in examine(parts)
    ]


def reach(line: Line, travel: Travel) -> float | None:
    """Find how far in m a load can be from the start of the line, None where that is not known exactly."""
    if travel.measured == "material":
        return line.length
    if travel.measured == "horizontal":  # under gravity alone x never turns back between the ends
        return abs(line.end[0] - line.start[0])
    return None


def _unknown_lines(parts: Parts) -> Iterator[Finding]:
    for load, line in parts.on.items():
        if line not in parts.lines:
            remedy = did_you_mean(line, parts.lines, otherwise=f"lines here: {', '.join(parts.lines)}")
            yield Finding(("loads", load, "on"), "no such line", repr(line), remedy)


def _complete(parts: Parts) -> Iterator[tuple[str, MovingForce, str, Line]]:
    for name, load in parts.loads.items():
        line = parts.lines.get(load.on) if load is not None else None
        if load is not None and line is not None:
            yield name, load, load.on, line


def _travels(parts: Parts) -> Iterator[Finding]:
    for name, load, on, line in _complete(parts):
        travel = load.travel
        limit = reach(line, travel)
        if travel.measured == "horizontal" and limit == 0.0:
            remedy = "measure the speed as material, slip or arc"
            wrong = f"{on} has no horizontal extent"
            yield Finding(("loads", name, "travel", "measured"), wrong, "horizontal", remedy)
            continue
        beyond = _beyond(line, travel, limit, parts.gravity)
        if beyond is not None:
            remedy = f"start at most {beyond:g} m from the start of the line"
            wrong = f"the load would start beyond the end of {on}"
            yield Finding(("loads", name, "travel", "from"), wrong, f"{travel.start:g} m", remedy)
        elif isinstance(parts.run, Dynamic | Linear) and travel.at_end == "refuse":
            yield from _passing(name, on, travel, limit, parts.run.until)


def _beyond(line: Line, travel: Travel, limit: float | None, gravity: float | None) -> float | None:
    """The length in m that `from` exceeds for certain, None if it may be on the line."""
    if limit is not None:
        return limit if travel.start > limit * (1.0 + 1e-9) else None
    if line.length is None or line.axial_stiffness is None or gravity is None:
        return None
    if line.mass * gravity * line.length > 0.1 * line.axial_stiffness:
        return None  # soft enough for its own weight to stretch it far: the arc length at rest is not known here
    longest = max(line.length, line.distance)
    return longest if travel.start > 1.5 * longest else None


def _passing(name: str, on: str, travel: Travel, limit: float | None, until: float) -> Iterator[Finding]:
    if callable(travel.speed):
        return
    way = course(travel.speed, travel.start, until)
    slack = 1e-9 * (limit or 1.0)
    ends: list[tuple[str, float | None]] = [("start", first_at_most(way, -slack))]
    if limit is not None:
        ends.append(("end", first_at_most([p.mirrored() for p in way], -limit - slack)))
    times = [(time, end) for end, time in ends if time is not None]
    if not times:
        return
    time, end = min(times)
    given = "a table" if isinstance(travel.speed, SpeedTable) else f"{travel.speed:g} m/s"
    wrong = f"the load passes the {end} of {on} at {_floor(time):g} s and the run goes on until {until:g} s"
    remedy = f"write run.until: {_floor(time):g} s, change speed or from, or write at_end: leave"
    if _floor(time) == 0.0:
        wrong = f"the load stands at the {end} of {on} and would move off it"
        remedy = "let it start elsewhere (from), turn the sign of speed, or write at_end: leave"
    yield Finding(("loads", name, "travel", "speed"), wrong, given, remedy)


def _floor(time: float) -> float:
    """Round a time down to four digits, so that it is safe to write into a scenario."""
    if time < 1e-9:
        return 0.0
    scale = 10.0 ** (3 - math.floor(math.log10(time)))
    return math.floor(time * scale * (1.0 + 1e-12)) / scale


def _meetings(parts: Parts) -> Iterator[Finding]:
    for (one, first, on, line), (two, second, other, _) in combinations(_complete(parts), 2):
        a, b = first.travel, second.travel
        same = a.measured == b.measured
        if on != other:
            continue
        if (a.start == b.start == 0.0) or (same and math.isclose(a.start, b.start, rel_tol=1e-12)):
            remedy = "let it start elsewhere (from), or add the forces up in one load"
            wrong = f"starts at the same place as load {one}"
            yield Finding(("loads", two, "travel", "from"), wrong, f"{b.start:g} m", remedy)
        elif same and isinstance(parts.run, Dynamic):  # in the linear theory they do not notice each other
            met = _meeting(a, b, line, parts.run.until)
            if met is not None:
                time, place = met
                wrong = f"the load meets load {one} at {time:.4g} s, {place:.4g} m along {on}"
                remedy = f"loads cannot pass each other: change speed or from, or end the run before {time:.4g} s"
                yield Finding(("loads", two, "travel", "speed"), wrong, remedy=remedy)


def _meeting(a: Travel, b: Travel, line: Line, until: float) -> tuple[float, float] | None:
    """Time in s and place in m where two loads meet for certain while both are on the line."""
    if callable(a.speed) or callable(b.speed):
        return None
    ahead, behind = (a, b) if a.start > b.start else (b, a)
    ways = [course(travel.speed, travel.start, until) for travel in (ahead, behind) if not callable(travel.speed)]
    time = first_at_most(between(*ways), 0.0)
    if time is None:
        return None
    for travel, way in zip((ahead, behind), ways, strict=True):
        limit = reach(line, travel)
        if limit is None:  # not known exactly; a load that would be refused there does not matter
            limit = math.inf if travel.at_end == "refuse" else 0.5 * line.distance
        if _leaves(way, limit, time):
            return None
    return time, place_at(ways[0], time)


def _leaves(way: list[Piece], limit: float, before: float) -> bool:
    slack = 1e-9 * (limit if math.isfinite(limit) else 1.0)
    times = [first_at_most(way, -slack), first_at_most([p.mirrored() for p in way], -limit - slack)]
    return any(time is not None and time < before for time in times)


def _known_to_the_run(parts: Parts) -> Iterator[Finding]:
    """What only some kinds of run know."""
    if parts.run is not None and not isinstance(parts.run, Linear):
        for name, line in parts.lines.items():
            for key in ("bending_stiffness", "foundation") if line is not None else ():
                if getattr(line, key):
                    remedy = "ask for kind: linear, or leave it out"
                    yield Finding(("lines", name, key), f"kind: {parts.run.kind} does not know it yet", remedy=remedy)
    if not isinstance(parts.run, Dynamic | Linear):
        return
    for name, line in parts.lines.items():
        if line is not None and isinstance(line.law, Inextensible):
            remedy = "ask for kind: quasistatic or equilibrium, or give an axial_stiffness with law hooke"
            yield Finding(("lines", name, "law"), "an inextensible line cannot move in time", remedy=remedy)
    for name, load in parts.loads.items():
        if load is not None and load.contact in ("coulomb", "dragged"):
            wrong, remedy = "friction of a prescribed travel is for slow motion", "ask for kind: quasistatic"
            yield Finding(
                ("loads", name, "contact"), wrong, load.contact, f"{remedy}, or write clamped or frictionless"
            )


def _path(parts: Parts) -> Iterator[Finding]:
    if not isinstance(parts.run, Quasistatic):
        return
    if not parts.loads:
        remedy = "add a load, or write kind: equilibrium"
        yield Finding(("run", "kind"), "no load moves along a path", "quasistatic", remedy)
    for name, load, on, line in _complete(parts):
        speed = load.travel.speed
        if callable(speed):
            continue
        values = speed.value if isinstance(speed, SpeedTable) else (speed,)
        key = ("loads", name, "travel", "speed")
        if not any(values):
            remedy = "write a speed (its sign is the direction of the path), or ask for kind: equilibrium"
            yield Finding(key, "a load that stands still has no path", "0 m/s", remedy)
            continue
        limit, start = reach(line, load.travel), load.travel.start
        if (max(values) <= 0.0 and start == 0.0) or (min(values) >= 0.0 and start == limit):
            end = "start" if start == 0.0 else "end"
            remedy = "let it start elsewhere (from), or turn the sign of speed"
            yield Finding(key, f"the load stands at the {end} of {on} and would move off it", remedy=remedy)


def _rest(parts: Parts) -> Iterator[Finding]:
    if parts.gravity != 0.0 or parts.run is None:
        return
    if isinstance(parts.run, Dynamic):
        if parts.run.start.kind != "rest":
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
        frames = 1.0 + run.until / (run.every or run.until / 100.0)
        key = ("run", "every" if run.every is not None else "until")
    elif isinstance(run, Quasistatic):
        frames, key = float(run.positions), ("run", "positions")
    else:
        return
    nodes = len(parts.loads) + sum(line.elements + 1 for line in parts.lines.values() if line is not None)
    if frames * nodes > LARGEST_RESULT:
        number = f"{frames * nodes:.3g} node positions ({frames:.4g} frames of {nodes} nodes)"
        action = "positions" if isinstance(run, Quasistatic) else "every"
        verb = "lower" if isinstance(run, Quasistatic) else "raise"
        remedy = f"{verb} run.{action} or lower elements: at most {LARGEST_RESULT:g} are kept"
        yield Finding(key, f"the result would hold {number}", remedy=remedy)
