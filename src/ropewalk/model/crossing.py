"""Crossings: when all loads are at the ends of their lines, which a run may end with."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from ropewalk.model._base import Finding
from ropewalk.model.course import course, first_at_most
from ropewalk.model.history import SpeedTable
from ropewalk.model.overlap import reach_of
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.parts import Parts
from ropewalk.model.places import margin, reach
from ropewalk.model.travel import FreeTravel
from ropewalk.model.until import CROSSING, Crossing


def crossed(parts: Parts) -> Parts:
    """The parts of a scenario with the end of its run found, if it is that of a crossing and can be found."""
    run, until = parts.run, getattr(parts.run, "until", None)
    if run is None or not isinstance(until, Crossing):
        return parts
    times = [time for _, time in _arrivals(parts) if time is not None]
    if not times:
        return parts
    return replace(parts, run=run.model_copy(update={"until": Crossing.of(max(times), until.more)}))


def check_crossing(parts: Parts) -> Iterator[Finding]:
    """Find why it is not known how long a crossing takes."""
    if not isinstance(getattr(parts.run, "until", None), Crossing):
        return
    known = {name for kind in (parts.lines, parts.overhead, parts.nets) for name, value in kind.items() if value}
    if not parts.is_complete or not all(load is not None and load.on in known for load in parts.loads.values()):
        return  # what is wrong there says more
    arrivals = list(_arrivals(parts))
    late = [name for name, time in arrivals if time is None]
    if arrivals and not late:
        return
    wrong, given = "no load crosses its line as prescribed", CROSSING
    if late:
        wrong = f"the crossing of load {late[0]} has an end that only the run finds"
    remedy = "write a time, or measure its travel as material or horizontal on a line of given length"
    yield Finding(("run", "until"), wrong, given, remedy)


def _arrivals(parts: Parts) -> Iterator[tuple[str, float | None]]:
    """Name of each load that travels as prescribed, and when all of it is at the end of its line or beyond, s."""
    for name, load in parts.loads.items():
        travel: Any = getattr(load, "travel", None)
        if load is None or travel is None or isinstance(travel, FreeTravel) or callable(travel.speed):
            continue
        starts, ends = [place.start for place in load.starts()], _ends(parts, load)
        ways = [  # of those between: who has more of the same way before it comes later
            None if ends is None else _time(travel.speed, start, *ends) for start in {min(starts), max(starts)}
        ]
        yield name, None if None in ways else max(way for way in ways if way is not None)


def _ends(parts: Parts, load: Any) -> tuple[float, float] | None:
    """Return the positions in m between which a load crosses its line, None where they are not known exactly."""
    if (overhead := parts.overhead.get(load.on)) is not None:
        return reach_of(parts.overhead, load.on) if isinstance(load, Pantograph) else (0.0, overhead.length)
    line = parts.lines.get(load.on)
    limit = None if line is None else reach(line, load.travel.measured)
    if line is None or limit is None:
        return None
    clearance = margin(load, line) if load.travel.at_end == "refuse" else 0.0
    return clearance, limit - clearance


def _time(speed: float | SpeedTable, start: float, low: float, high: float) -> float | None:
    """When what starts at a place comes to be as low or as high as said, whichever it goes to, s; None: never."""
    last = speed.value[-1] if isinstance(speed, SpeedTable) else speed
    if last == 0.0:
        return None
    known = max(speed.time[-1], 0.0) if isinstance(speed, SpeedTable) else 0.0
    fastest = max(map(abs, speed.value)) if isinstance(speed, SpeedTable) else abs(speed)
    horizon = known + (abs(start) + abs(high) + fastest * known) / abs(last) + 1.0
    way = course(speed, start, horizon)
    found = first_at_most(way, low) if last < 0.0 else first_at_most([piece.mirrored() for piece in way], -high)
    return found if found is not None and math.isfinite(found) else None
