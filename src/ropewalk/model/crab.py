"""Crabs: trolleys on several lines, and what cannot be of them."""

from __future__ import annotations

from collections.abc import Iterator

from ropewalk.errors import did_you_mean
from ropewalk.model._base import Finding
from ropewalk.model.line import Line, spatial
from ropewalk.model.parts import Parts
from ropewalk.model.travel import FreeTravel
from ropewalk.model.trolley import Trolley

LEVEL = 0.05
"""Difference of the levels of lines over their length, beyond which none of what lies above sags down to the others."""


def check_crabs(parts: Parts) -> Iterator[Finding]:
    """Find loads on several lines that could not stand level on all of them, or not go on together."""
    for name, load in parts.loads.items():
        if not isinstance(load, Trolley) or not load.also_on:
            continue
        yield from _going(name, load)
        unknown = list(_unknown(name, load, parts))
        yield from unknown
        lines = {key: line for key in load.lines if (line := parts.lines.get(key)) is not None}
        if not unknown and len(lines) == len(load.lines):
            yield from _beside(name, load, lines)


def _going(name: str, load: Trolley) -> Iterator[Finding]:
    path, travel = ("loads", name, "travel"), load.travel
    if isinstance(travel, FreeTravel):
        if travel.driver is not None:
            wrong = "a driver acts along one line, and would pull at that one alone"
            remedy = "write a travel with its speed and measured: horizontal, or a drive, which acts along all"
            yield Finding((*path, "driver"), wrong, remedy=remedy)
        allowed = ["refuse", "stay"]
    else:
        if travel.measured != "horizontal":
            wrong = "lines that stretch differently do not have one x at equal arc lengths"
            yield Finding((*path, "measured"), wrong, travel.measured, "write measured: horizontal")
        allowed = ["refuse"]
    if travel.at_end not in allowed:
        wrong = "all of its lines carry it, and end at different instants"
        if travel.at_end == "stay":
            wrong = "its drive would pull it over the ends of its lines"
        remedy = f"write {' or '.join(allowed)}, and end the run before, or let its speed end"
        yield Finding((*path, "at_end"), wrong, travel.at_end, remedy)


def _unknown(name: str, load: Trolley, parts: Parts) -> Iterator[Finding]:
    for i, key in enumerate(load.also_on):
        path = ("loads", name, "also_on", i)
        if key in load.lines[: i + 1]:
            yield Finding(path, "it stands on that line already", repr(key), "name each line once")
        elif key not in parts.lines:
            remedy = did_you_mean(key, parts.lines, otherwise=f"lines here: {', '.join(parts.lines)}")
            yield Finding(path, "no such line", repr(key), remedy)
    if load.on in parts.nets or load.on in parts.overhead:
        yield Finding(("loads", name, "on"), "a load on several lines rolls on lines", load.on, "name one of lines")


def _beside(name: str, load: Trolley, lines: dict[str, Line]) -> Iterator[Finding]:
    first = lines[load.on]
    for i, (key, line) in enumerate(lines.items(), start=-1):
        path = ("loads", name, "also_on", i) if i >= 0 else ("loads", name, "on")
        (x0, y0, z0), (x1, y1, z1) = spatial(line.start), spatial(line.end)
        if x1 <= x0 or abs(y1 - y0) > 1e-9 * line.distance:
            wrong = "a load on several lines keeps its direction, and this one does not run in that of x"
            yield Finding(path, wrong, key, "turn the axes so that all of its lines extend along x, from start to end")
            return
        if isinstance(load.travel, FreeTravel):
            continue  # where it begins is a length, along the first one
        x = first.start[0] + load.travel.start
        if not x0 < x < x1:
            wrong = f"it would begin at x = {x:g} m, and {key} runs from {x0:g} to {x1:g} m"
            remedy = "let it start elsewhere (from)"
            yield Finding(("loads", name, "travel", "from"), wrong, f"{load.travel.start:g} m", remedy)
            return
        a, b = spatial(first.start), spatial(first.end)
        level = a[2] + (b[2] - a[2]) * (x - a[0]) / (b[0] - a[0])
        here = z0 + (z1 - z0) * (x - x0) / (x1 - x0)
        if abs(here - level) > LEVEL * min(line.distance, first.distance):
            wrong = f"a load on several lines stands level: there {key} is {here - level:+.4g} m above {load.on}"
            yield Finding(path, wrong, key, "name parallel lines")
