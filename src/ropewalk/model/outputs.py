"""Outputs: what results tell of lines beyond shapes and forces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from typing import Any

from pydantic import Field

from ropewalk import hooks
from ropewalk.errors import did_you_mean
from ropewalk.model._base import Declaration, Finding
from ropewalk.model.quantity import Frequency, Name, Offset, Way
from ropewalk.model.run import Dynamic, Linear, Quasistatic


class LinePlace(Declaration):
    """A place along a line that results tell of by name."""

    on: str = Field(description="name of the line")
    at: Offset = Field(description="unstrained length from the start of that line")


class Outputs(Declaration):
    """What a bridge engineer reads: deflection, acceleration, bending moment and shear of lines and at places.

    Summaries, tables and sweeps have them of each line with bending stiffness, and of each place. Deflection is
    downwards from where the line is at first, acceleration vertical and low-pass filtered, a sagging moment positive;
    lateral ones, in space, are level and across the chord of the line, to the left of its way.
    """

    cut_off: Frequency = Field(
        default=30.0, description="of the filter of accelerations (Butterworth, fourth order, forwards and backwards)"
    )
    places: dict[Name, LinePlace] = Field(default_factory=dict, description="places along lines, by name")
    ground: Way | None = Field(
        default=None,
        description="points [x, z] of the ground, by rising x; the clearance above them is recorded",
    )
    impact: bool = Field(
        default=False,
        description="also let the loads cross without inertia (kind: quasistatic), and give the static part of each "
        "quantity and the impact factor: its largest value over that of the static part",
    )


def _ground(parts: Any) -> Iterator[Finding]:
    path, points = ("outputs", "ground"), parts.outputs.ground
    if points is None:
        return
    if any(len(point) != 2 for point in points):
        yield Finding(path, "has points that are not [x, z]", remedy="write two numbers for each point")
    elif len(points) == 1:
        yield Finding(path, "is a single point", remedy="write two or more")
    elif any(b[0] <= a[0] for a, b in pairwise(points)):
        yield Finding(path, "has points with falling x", remedy="sort its points by x, each once")
    else:
        ends = [end[0] for line in parts.lines.values() if line is not None for end in (line.start, line.end)]
        if ends and (points[-1][0] < min(ends) or points[0][0] > max(ends)):
            reach = f"from {points[0][0]:g} m to {points[-1][0]:g} m"
            wrong = f"no part of it lies below the lines, which reach from x = {min(ends):g} m to {max(ends):g} m"
            yield Finding(path, wrong, reach, "write x in m as of the ends of lines (divide values in mm by 1000)")


def check_outputs(parts: Any) -> Iterator[Finding]:
    """Find places that are on no line, ground that goes back, and static parts that cannot be had."""
    yield from _ground(parts)
    for name, place in parts.outputs.places.items():
        path: tuple[str, ...] = ("outputs", "places", name)
        if place.on not in parts.lines:
            remedy = did_you_mean(place.on, parts.lines, otherwise=f"lines here: {', '.join(parts.lines)}")
            yield Finding((*path, "on"), "no such line", repr(place.on), remedy)
        elif (line := parts.lines[place.on]) is not None and place.at > (line.length or line.distance) * (1.0 + 1e-9):
            longest = line.length or line.distance
            yield Finding(
                (*path, "at"), f"is beyond the end of {place.on}", f"{place.at:g} m", f"at most {longest:g} m"
            )
        if name in parts.lines:
            yield Finding(path, "a line has the same name", remedy="give it another name")
    if not parts.outputs.impact or parts.run is None:
        return
    path = ("outputs", "impact")
    if not isinstance(parts.run, Dynamic | Linear):
        wrong, remedy = "an impact factor compares a motion with rest", "ask for kind: dynamic or linear"
        yield Finding(path, wrong, f"kind: {parts.run.kind}", remedy)
    elif not parts.loads and parts.is_complete:
        yield Finding(path, "no load crosses", "true", "add a load, or leave impact out")
    else:
        for found in hooks.unsupported(replace(parts, run=Quasistatic())):
            where, remedy = ".".join(map(str, found.path)), "leave impact out"
            wrong = f"the static part cannot be had: {where} {found.wrong}".strip()
            yield Finding(path, wrong, found.given, remedy)
            break
