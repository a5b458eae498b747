"""Joints, nets and wind: what does not fit together of them, in whichever way it is computed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

from ropewalk.errors import did_you_mean
from ropewalk.model._base import Finding
from ropewalk.model.axles import Axles
from ropewalk.model.history import SpeedTable
from ropewalk.model.joint import Joined
from ropewalk.model.load import AnyLoad, Travelling
from ropewalk.model.parts import Parts
from ropewalk.model.run import Dynamic
from ropewalk.model.train import TrainSection
from ropewalk.model.travel import Travel

_Lack = tuple[tuple[str, ...], str, str, str]


def check_joints(parts: Parts) -> Iterator[Finding]:
    """Find what does not fit together of joints, nets and wind."""
    yield from _names(parts)
    yield from _joints(parts)
    for name, load in parts.loads.items():
        if load is not None and load.on in parts.lines and _way(load) is not None:
            remedy = "leave it out, or name a net"
            yield Finding(("loads", name, *_way_key(load)), "a path is for nets", repr(load.on), remedy)
        if load is not None and load.on in parts.nets:
            yield from _on_net(name, load, parts)
    blows = parts.wind is not None and not parts.wind.is_calm
    if blows and not parts.is_airy and all(line is not None for line in parts.lines.values()):
        remedy = "give a line wind_drag (its drag coefficient times its width) or a load air_drag, or leave wind out"
        yield Finding(("wind",), "wind acts on nothing: no line has wind_drag, no load air_drag", remedy=remedy)


def _names(parts: Parts) -> Iterator[Finding]:
    """Names that stand for two things."""
    taken = dict.fromkeys([*parts.lines, *parts.overhead], "line")
    for block, names in (("nets", parts.nets), ("joints", parts.joints)):
        for name in names:
            if name in taken:
                yield Finding((block, name), f"a {taken[name]} has the same name", remedy="give each its own name")
            taken[name] = block[:-1]


def _joints(parts: Parts) -> Iterator[Finding]:
    """What ends of lines and sheaves are joined to."""
    used: set[str] = set()
    for name, line in parts.lines.items():
        if line is None:
            continue
        for key, support in line.ends():
            if isinstance(support, Joined):
                used.add(support.to)
                for inner, wrong, given, remedy in _joined(name, support, parts):
                    yield Finding(("lines", name, key, *inner), wrong, given, remedy)
                other = parts.lines.get(support.to)
                if other is not None and other.cut is not None and support.at == other.cut.at:
                    wrong, remedy = f"{support.to} is cut just there", "join it at another position"
                    yield Finding(("lines", name, key, "at"), wrong, f"{support.at:g} m", remedy)
        for sheave, wheel in line.sheaves.items():
            if wheel.to is not None:
                used.add(wheel.to)
                if wheel.to not in parts.joints:
                    remedy = did_you_mean(wheel.to, [*parts.joints], otherwise="leave it out, or add joints")
                    yield Finding(("lines", name, "sheaves", sheave, "to"), "no such joint", repr(wheel.to), remedy)
    for name in parts.joints:
        if name not in used and all(line is not None for line in parts.lines.values()):
            remedy = f"write start_support: {{kind: joined, to: {name}}} in a line, or leave it out"
            yield Finding(("joints", name), "no line is joined to it", remedy=remedy)


def _joined(name: str, support: Joined, parts: Parts) -> Iterator[_Lack]:
    known = [*parts.joints, *(line for line in parts.lines if line != name), *parts.nets]
    if support.to not in known:
        if support.to == name:
            yield ("to",), "a line cannot be joined to itself", repr(name), "name a joint, another line or a net"
            return
        remedy = did_you_mean(support.to, known, otherwise=f"joints, lines and nets here: {', '.join(known)}")
        yield ("to",), "no such joint, line or net", repr(support.to), remedy
    elif support.to in parts.joints:
        if support.at is not None:
            yield ("at",), "a joint is a single point", str(support.at), "leave at out"
    elif support.to in parts.nets:
        if not isinstance(support.at, tuple) or len(support.at) != 2:
            yield ("at",), "is required: position on the net", str(support.at), "write at: [u, v] in m"
    elif not isinstance(support.at, float):
        yield ("at",), "is required: position along that line", str(support.at), "write at: its distance from the start"
    else:
        line = parts.lines[support.to]
        if support.at < 0.0 or (line is not None and line.length is not None and support.at > line.length):
            end = f" ({line.length:g} m long)" if line is not None and line.length is not None else ""
            yield ("at",), f"is off the line {support.to}{end}", f"{support.at:g} m", "stay within its length"


def _way_key(load: AnyLoad) -> tuple[str, ...]:
    return ("travel", "path") if hasattr(load, "travel") else ("path",)


def _way(load: AnyLoad | None) -> tuple[tuple[float, ...], ...] | None:
    travel = getattr(load, "travel", load)
    way: tuple[tuple[float, ...], ...] | None = getattr(travel, "path", None)
    return way


def _on_net(name: str, load: AnyLoad, parts: Parts) -> Iterator[Finding]:
    if isinstance(load, Axles | TrainSection):
        wrong, remedy = "a train needs a line, and a net has none", "let it run on a line"
        yield Finding(("loads", name, "on"), wrong, load.on, remedy)
        return
    key, way = ("loads", name, *_way_key(load)), _way(load)
    if way is None:
        remedy = "write the points of the path, for example path: [[0, 1.5], [4, 1.5]] in m"
        yield Finding(key, "is required for a load on a net", remedy=remedy)
        return
    if any(not isinstance(place, tuple) or len(place) != 2 for place in way):
        yield Finding(key, "a position on a net has two coordinates", remedy="write [u, v] for each place")
        return
    length = sum(math.dist(a, b) for a, b in pairwise(way))
    begin = max(place.start for place in load.starts())
    if begin > length * (1.0 + 1e-9):
        where = (*key[2:-1], "from")
        wrong, remedy = f"the load would start beyond the end of its path of {length:.4g} m", "start on it"
        yield Finding(("loads", name, *where), wrong, f"{begin:g} m", remedy)
        return
    travel = getattr(load, "travel", None)
    clearance = getattr(travel, "margin", None) or 0.0
    if clearance and clearance >= 0.5 * length:
        wrong, remedy = "is longer than half of the path", f"stay below {0.5 * length:g} m, half the length of the path"
        yield Finding(("loads", name, "travel", "margin"), wrong, f"{clearance:g} m", remedy)
    elif length == 0.0 and not (isinstance(travel, Travel) and travel.speed == 0.0 and len(load.starts()) == 1):
        yield Finding(key, "the path has no length", remedy="give two or more different places")
    elif isinstance(travel, Travel) and isinstance(load, Travelling) and isinstance(parts.run, Dynamic):
        speed, start = travel.speed, begin
        if travel.at_end != "refuse" or callable(speed) or isinstance(speed, SpeedTable):
            return
        last = start + speed * parts.run.until
        if not -1e-9 * length <= min(start, last) or max(start, last) > length * (1.0 + 1e-9):
            wrong = f"the load would be {last:.4g} m along its path of {length:.4g} m when the run ends"
            remedy = "change speed, from or run.until, or write at_end: leave"
            yield Finding(("loads", name, "travel", "speed"), wrong, f"{speed:g} m/s", remedy)
