"""Where the loads of a scenario stand, when they would pass an end of their line, and whether they meet."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations, product

from ropewalk.model._base import Finding
from ropewalk.model.axles import Axles, TrainTravel
from ropewalk.model.course import Piece, between, course, first_at_most, place_at
from ropewalk.model.crowd import Crowd, is_one_of_many
from ropewalk.model.fmu import Fmu, FmuTravel
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.history import SpeedTable
from ropewalk.model.line import Line
from ropewalk.model.load import AnyLoad, MovingForce, Travelling
from ropewalk.model.matrices import Matrices
from ropewalk.model.overhead import OverheadLine
from ropewalk.model.overlap import reach_of
from ropewalk.model.pantograph import Pantograph, PantographTravel
from ropewalk.model.parts import Parts
from ropewalk.model.run import Dynamic, Linear
from ropewalk.model.train import Train, TrainSection
from ropewalk.model.travel import FreeTravel, Measure, Place, Travel
from ropewalk.model.vehicle import Vehicle

_Prescribed = Travel | TrainTravel | PantographTravel | FmuTravel
_COARSEST = 20
"""Number of elements that a line has at least where it is found from an accuracy."""


def reach(line: Line | OverheadLine, measured: Measure) -> float | None:
    """Find how far in m a load can be from the start of the line, None where that is not known exactly."""
    if isinstance(line, OverheadLine):
        return line.length
    if measured == "material":
        return line.distance if line.length is None and line.has_bending_stiffness else line.length
    if measured == "horizontal":  # under gravity alone x never turns back between the ends
        return abs(line.end[0] - line.start[0])
    return None


def margin(load: AnyLoad, line: Line | OverheadLine) -> float:
    """Find the unstrained length in m at which the line ends for a load before its support, 0 where not known."""
    if isinstance(line, OverheadLine):
        return 0.0
    if not isinstance(load, Travelling) or isinstance(load, MovingForce | Axles | Train):
        return (load.travel.margin or 0.0) if isinstance(load, MovingForce) else 0.0
    quarter = 0.25 * line.length / line.elements if line.length is not None else 0.0
    return quarter if load.travel.margin is None else load.travel.margin


def _exchange(on: str) -> str:
    return f"exchange start and end of {on}, with their supports, or write slip or material"


def travels(parts: Parts) -> Iterator[Finding]:
    """Find loads that start off their line, or that would pass an end of it and are to be refused there."""
    for name, load in parts.loads.items():
        overhead = parts.overhead.get(load.on) if load is not None else None
        if load is None or overhead is None:
            continue
        if (wrong_start := _off_the_line(load, load.on, overhead, parts.gravity)) is not None:
            wrong, given, remedy = wrong_start
            yield Finding(("loads", name, *_start_key(load)), wrong, given, remedy)
        elif isinstance(parts.run, Dynamic):
            ends = reach_of(parts.overhead, load.on) if isinstance(load, Pantograph) else (0.0, overhead.length)
            yield from _passing(name, load, load.on, overhead, parts.run.until, ends)
    for name, load, on, line in parts.complete():
        places = load.starts()
        measured = places[0].measured
        limit = reach(line, measured)
        if measured == "horizontal" and limit == 0.0:
            remedy = "measure the speed as material, slip or arc"
            wrong = f"{on} has no horizontal extent"
            yield Finding(("loads", name, "travel", "measured"), wrong, "horizontal", remedy)
            continue
        if measured == "horizontal" and line.end[0] < line.start[0]:  # dx/dt and "towards its end" would be at odds
            wrong, remedy = f"horizontal counts along x, and {on} runs towards -x", _exchange(on)
            yield Finding(("loads", name, "travel", "measured"), wrong, "horizontal", remedy)
            continue
        clearance = margin(load, line)
        half = 0.5 * (line.length or line.distance)
        if clearance >= half:
            remedy = f"stay below {half:g} m, half the length of the line"
            yield Finding(
                ("loads", name, "travel", "margin"), f"is longer than half of {on}", f"{clearance:g} m", remedy
            )
            continue
        wrong_start = _off_the_line(load, on, line, parts.gravity)
        if wrong_start is not None:
            wrong, given, remedy = wrong_start
            yield Finding(("loads", name, *_start_key(load)), wrong, given, remedy)
        elif isinstance(parts.run, Dynamic | Linear):
            yield from _passing(name, load, on, line, parts.run.until)


def meetings(parts: Parts) -> Iterator[Finding]:
    """Find loads that start at one place, and those with a prescribed travel that meet later."""
    everybody: list[tuple[str, AnyLoad, str, Line | OverheadLine]] = list(parts.complete())
    for name, its, _, _ in tuple(everybody):  # loads on several lines meet others on each of these
        also = ((key, parts.lines.get(key)) for key in getattr(its, "also_on", ()))
        everybody += [(name, its, key, line) for key, line in also if line is not None]
    for name, load in parts.loads.items():
        wire = parts.overhead.get(load.on) if load is not None else None
        if load is not None and wire is not None and not isinstance(load, Pantograph):
            everybody.append((name, load, load.on, wire))
    found = set[str]()  # each pair is reported once
    # People pass one another.
    alone = [
        load for load in everybody if not (is_one_of_many(load[0]) and isinstance(load[1], Footsteps))
    ]  # people pass one another
    for (one, first, on, line), (two, second, other, _) in combinations(alone, 2):
        if on != other or two in found:
            continue
        pairs = list(product(first.starts(), second.starts()))
        same = next((b for a, b in pairs if _coincide(a, b)), None)
        if same is not None:
            what = f"wheel {same.label} starts" if same.label else "starts"
            remedy = "let it start elsewhere (from), or add the forces up in one load"
            wrong = f"{what} at the same place as load {one}"
            found.add(two)
            yield Finding(("loads", two, *_start_key(second)), wrong, f"{same.start:g} m", remedy)
        elif isinstance(parts.run, Dynamic) and not (_only_presses(first) and _only_presses(second)):
            a, b = _prescribed(first), _prescribed(second)
            if a is None or b is None or a.measured != b.measured:
                continue
            met = [_meeting((a, p.start), (b, q.start), line, parts.run.until) for p, q in pairs]
            known = [meeting for meeting in met if meeting is not None]
            if known:
                time, place = min(known)
                wrong = f"the load meets load {one} at {time:.4g} s, {place:.4g} m along {on}"
                remedy = (
                    f"change speed or from, end the run before {time:.4g} s, or write kind: force (contact: clamped) "
                )
                remedy += "with its weight for both: only such forces pass each other"
                found.add(two)
                yield Finding(("loads", two, "travel", "speed"), wrong, remedy=remedy)


def _only_presses(load: AnyLoad) -> bool:
    """Whether a load consists of given forces, which pass others of that kind."""
    return isinstance(load, Axles) or (isinstance(load, MovingForce) and load.contact == "clamped")


def _start_key(load: AnyLoad) -> tuple[str, ...]:
    return ("travel", "from") if isinstance(load, Travelling | Pantograph | Fmu) else ("from",)


def _prescribed(load: AnyLoad) -> _Prescribed | None:
    travel = load.travel if isinstance(load, Travelling | Pantograph | Fmu) else None
    return None if isinstance(travel, FreeTravel) else travel


def _coincide(a: Place, b: Place) -> bool:
    if a.start == b.start == 0.0:
        return True
    return a.measured == b.measured and math.isclose(a.start, b.start, rel_tol=1e-12)


def _off_the_line(
    load: AnyLoad, on: str, line: Line | OverheadLine, gravity: float | None
) -> tuple[str, str, str] | None:
    """Say which place is off the line at the start, what was given and what to do."""
    if isinstance(load, Axles | TrainSection):
        return _never_comes(load, on, line)
    assert not isinstance(load, Crowd)  # its people stand here instead
    start = load.travel.start if isinstance(load, Travelling | Pantograph | Fmu) else load.start
    for place in load.starts():
        part = "the strip" if isinstance(load, Pantograph) else "wheel"
        what = f"{part} {place.label}" if place.label else "the load"
        ahead = place.start - start
        if place.start < -1e-9 * max(start, 1.0) and not _comes_by_itself(load):
            remedy = f"start at least {max(0.0, -ahead):g} m from the start of the line"
            remedy += ", or write at_end: leave" if isinstance(load, Vehicle | Matrices) else ""
            return f"{what} would start before the start of {on}", f"{start:g} m", remedy
        beyond = None if _steps_on(load, -1.0) else _beyond(line, place, gravity)
        if beyond is not None:
            remedy = f"start at most {beyond - ahead:g} m from the start of the line"
            if ahead > beyond:
                remedy = f"the line is only {beyond:g} m long: check the places (at) of the wheels"
            return f"{what} would start beyond the end of {on}", f"{start:g} m", remedy
    return None


def _never_comes(load: Axles | TrainSection, on: str, line: Line | OverheadLine) -> tuple[str, str, str] | None:
    """Say that a train has passed its line before it begins."""
    last = load.starts()[-1].start
    limit = reach(line, load.travel.measured)
    gone = last < 0.0 if load.onward < 0.0 else limit is not None and last > limit
    if not gone or callable(load.travel.speed):
        return None
    ahead = load.travel.start - last
    remedy = f"start at more than {ahead:g} m" if load.onward < 0.0 else f"start at most {(limit or 0.0) + ahead:g} m"
    what = "the train" if isinstance(load, Axles) else "a vehicle of the train"
    return f"{what} has left {on} before it begins", f"{load.travel.start:g} m", f"{remedy} from the start of {on}"


def _comes_by_itself(load: AnyLoad) -> bool:
    """Whether wheels of the load may begin before the start of the line: on level ground, from which they roll on."""
    travel = _prescribed(load)
    leaves = travel is not None and travel.at_end == "leave"
    rolls = not isinstance(travel, Travel) or travel.start >= 0.0 or isinstance(load, Vehicle | Matrices)
    return (leaves and rolls) or _steps_on(load, 1.0)


def _steps_on(load: AnyLoad, onward: float) -> bool:
    """Whether a load steps in that direction along its line, to which it may come late."""
    return isinstance(load, Footsteps) and load.at_end == "leave" and load.onward == onward


def _beyond(line: Line | OverheadLine, place: Place, gravity: float | None) -> float | None:
    """The length in m that a start exceeds for certain, None if it may be on the line."""
    limit = reach(line, place.measured)
    if limit is not None or isinstance(line, OverheadLine):
        return limit if limit is not None and place.start > limit * (1.0 + 1e-9) else None
    if line.tension is not None and gravity is not None and place.measured == "material" and line.is_restrained_fast:
        hangs = line.mass * gravity * line.distance / line.tension
        most = line.distance * (1.0 + hangs**2 / 12.0)  # twice what the sag adds to the chord
        return most if hangs < 1.0 and place.start > 1.02 * most else None
    if line.length is None or line.axial_stiffness is None or gravity is None:
        return None
    if line.mass * gravity * line.length > 0.1 * line.axial_stiffness:
        return None  # soft enough for its own weight to stretch it far: the arc length at rest is not known here
    longest = max(line.length, line.distance)
    return longest if place.start > 1.5 * longest else None


def _passing(
    name: str,
    load: AnyLoad,
    on: str,
    line: Line | OverheadLine,
    until: float,
    between: tuple[float, float] | None = None,
) -> Iterator[Finding]:
    """What passes an end of its line; `between`: stations in m, if not its own."""
    travel = _prescribed(load)
    if isinstance(load, Footsteps) and isinstance(line, Line):
        yield from _stepping_off(name, load, on, line, until)
    if travel is None or callable(travel.speed) or travel.at_end != "refuse":
        return
    begin, limit = between or (0.0, reach(line, travel.measured))
    clearance = margin(load, line) if travel.measured == "material" else 0.0  # elsewhere its size is not known
    slack = 1e-9 * (limit or 1.0)
    ends: list[tuple[str, float | None]] = []
    for place in load.starts():
        way = course(travel.speed, place.start, until)
        ends.append(("start", first_at_most(way, begin + min(clearance, place.start) - slack)))
        if limit is not None:
            last = max(limit - clearance, place.start) if clearance else limit
            ends.append(("end", first_at_most([p.mirrored() for p in way], -last - slack)))
    times = [(time, end) for end, time in ends if time is not None]
    if not times:
        return
    time, end = min(times)
    given = "a table" if isinstance(travel.speed, SpeedTable) else f"{travel.speed:g} m/s"
    wrong = f"the load passes the {end} of {on} at {_floor(time):g} s and the run ends at {until:g} s"
    remedy = f"write run.until: {_floor(time):g} s, change speed or from, or write at_end: leave"
    if _floor(time) == 0.0:
        wrong = f"the load stands at the {end} of {on} and would move off it"
        remedy = "let it start elsewhere (from), turn the sign of speed, or write at_end: leave"
    yield Finding(("loads", name, "travel", "speed"), wrong, given, remedy)


def _stepping_off(name: str, load: Footsteps, on: str, line: Line, until: float) -> Iterator[Finding]:
    clearance = load.start if load.towards == "start" else None if line.length is None else line.length - load.start
    if clearance is None or load.at_end != "refuse":
        return
    steps = math.floor(clearance / load.step_length * (1.0 + 1e-9)) + 1.0 - load.phase  # to the first foot beyond it
    time = steps / load.frequency
    if time < until:
        wrong = f"a foot lands beyond the {load.towards} of {on} at {time:.4g} s and the run ends at {until:g} s"
        remedy = f"write run.until: {_floor(time):g} s, change from or towards, or write at_end: leave"
        yield Finding(("loads", name, "from"), wrong, f"{load.start:g} m", remedy)


def _floor(time: float) -> float:
    """Round a time down to four digits, so that it is safe to write into a scenario."""
    if time < 1e-9:
        return 0.0
    scale = 10.0 ** (3 - math.floor(math.log10(time)))
    return math.floor(time * scale * (1.0 + 1e-12)) / scale


def forces_come_close(parts: Parts) -> bool:
    """Whether given forces on one line pass each other, or come within two elements of each other, in a motion.

    Then the nodes that they share would have to be exchanged, which excites waves of a wavelength of a few elements.
    """
    forces = list[tuple[str, _Prescribed, Line]]()
    for _, load, on, line in parts.complete():
        travel = _prescribed(load)
        if isinstance(load, MovingForce) and travel is not None:
            forces.append((on, travel, line))
    until = parts.run.until if isinstance(parts.run, Dynamic) else 0.0
    return any(_come_close(a, b, line, until) for (on, a, line), (at, b, _) in combinations(forces, 2) if on == at)


def _come_close(a: _Prescribed, b: _Prescribed, line: Line, until: float) -> bool:
    if a.measured != b.measured or callable(a.speed) or callable(b.speed):
        return True
    elements = line.elements if isinstance(line.elements, int) else _COARSEST
    distance = 2.0 * (line.length or line.distance) / elements
    return _meeting((a, a.start), (b, b.start), line, until, distance) is not None


def _meeting(
    a: tuple[_Prescribed, float],
    b: tuple[_Prescribed, float],
    line: Line | OverheadLine,
    until: float,
    distance: float = 0.0,
) -> tuple[float, float] | None:
    """Time in s and place in m where two places come within a distance in m for certain while both are on the line."""
    ahead, behind = (a, b) if a[1] > b[1] else (b, a)
    ways: list[list[Piece]] = []
    for travel, start in (ahead, behind):
        if callable(travel.speed):
            return None
        ways.append(course(travel.speed, start, until))
    time = first_at_most(between(*ways), distance)
    if time is None:
        return None
    for (travel, _), way in zip((ahead, behind), ways, strict=True):
        limit = reach(line, travel.measured)
        if limit is None:  # not known exactly; a load that would be refused there does not matter
            limit = math.inf
            if travel.at_end != "refuse" and isinstance(line, Line):
                limit = 0.5 * line.distance
        if _leaves(way, limit, time):
            return None
    return time, place_at(ways[0], time)


def _leaves(way: list[Piece], limit: float, before: float) -> bool:
    slack = 1e-9 * (limit if math.isfinite(limit) else 1.0)
    times = [first_at_most(way, -slack), first_at_most([p.mirrored() for p in way], -limit - slack)]
    return any(time is not None and time < before for time in times)
