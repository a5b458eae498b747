"""Overlaps: tension sections of overhead line beside each other; pantographs press on the contact wires of both."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from ropewalk.errors import did_you_mean
from ropewalk.model._base import Finding
from ropewalk.model.overhead import OverheadLine, stations_of
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.parts import Parts

CLEAR = 0.2
"""m, at least, by which a contact wire ends above the other one: pantographs raise the wire by about half of that."""


def course_of(lines: Mapping[str, OverheadLine | None], name: str) -> dict[str, float]:
    """Find the lines along which pantographs of a line run, by how far ahead of it each begins.

    Args:
        lines: all overhead lines.
        name: of one of them.

    Returns:
        Distances along x in m by name, in the order of the overlaps; that of the line itself is 0.
    """
    before = {line.overlap: own for own, line in lines.items() if line is not None and line.overlap is not None}
    order, own = [name], lines[name]
    while (one := before.get(order[0])) is not None and one not in order:
        order.insert(0, one)
    after = {own: line.overlap for own, line in lines.items() if line is not None and line.overlap in lines}
    while (then := after.get(order[-1])) is not None and then not in order:
        order.append(then)
    there = {key: line for key in order if (line := lines[key]) is not None}
    return {key: 0.0 if own is None else line.start[0] - own.start[0] for key, line in there.items()}


def reach_of(lines: Mapping[str, OverheadLine | None], name: str) -> tuple[float, float]:
    """Find the stations of a line, in m, between which its pantographs are below a contact wire."""
    course = course_of(lines, name)
    ends = [offset + line.length for key, offset in course.items() if (line := lines[key]) is not None]
    return min(course.values(), default=0.0), max(ends, default=0.0)


def analysed_of(lines: Mapping[str, OverheadLine], name: str) -> tuple[float, float]:
    """Find the stations of a line, in m, between which statistics of its pantographs are made.

    With overlaps, from the first analysed span of the first line to the last analysed span of the last one.
    """
    course = course_of(lines, name)
    (first, begin), *_, (last, end) = course.items() if len(course) > 1 else [*course.items()] * 2
    low, high = lines[first].analysed[0], lines[last].analysed[1]
    return begin + stations_of(lines[first])[low - 1], end + stations_of(lines[last])[high]


def height_at(line: OverheadLine, x: float) -> float:
    """Height of registration of a contact wire at x, evenly between supports, m."""
    stations, rise, at = stations_of(line), line.registered, x - line.start[0]
    span = max(sum(station <= at for station in stations[1:-1]), 0)
    share = (at - stations[span]) / (stations[span + 1] - stations[span])
    return float(line.start[-1] + rise[span] + share * (rise[span + 1] - rise[span]))


def check_overlaps(parts: Parts) -> Iterator[Finding]:
    """Find overlaps with no line, with one that is elsewhere, and wires that end within reach of pantographs."""
    taken = dict[str, str]()
    for name, line in parts.overhead.items():
        if line is None or line.overlap is None:
            continue
        path, other = ("overhead_lines", name, "overlap"), parts.overhead.get(line.overlap)
        if line.overlap not in parts.overhead or line.overlap == name:
            known = [key for key in parts.overhead if key != name]
            others = ", ".join(known) or "there are none"
            remedy = did_you_mean(line.overlap, known, otherwise=f"other overhead lines here: {others}")
            yield Finding(path, "unknown overhead line", repr(line.overlap), remedy)
        elif line.overlap in taken:
            remedy = "name each line as overlap once: the path of pantographs must be unique"
            yield Finding(path, f"{taken[line.overlap]} overlaps with it, too", repr(line.overlap), remedy)
        elif other is not None:
            yield from _beside(name, line, line.overlap, other)
        taken.setdefault(line.overlap, name)
    for name, load in parts.loads.items():
        if not isinstance(load, Pantograph) or load.irregularity is None or load.on not in parts.overhead:
            continue
        course, path = course_of(parts.overhead, load.on), ("loads", name, "irregularity")
        if isinstance(load.irregularity, str) and len(course) > 1:
            each = ", ".join(f"{key}: {load.irregularity}" for key in course)
            wrong = f"the contact wire is ambiguous, the pantograph passes over several: {', '.join(course)}"
            yield Finding(path, wrong, load.irregularity, f"write one file for each line, or for some: {{{each}}}")
        for key in load.irregularities:
            if key not in course:
                remedy = did_you_mean(key, course) or "leave irregularity out"
                yield Finding((*path, key), "the pantograph does not reach this line", key, remedy)


def _beside(name: str, line: OverheadLine, follower: str, other: OverheadLine) -> Iterator[Finding]:
    """Find problems of two adjacent lines."""
    end, begin, last = line.start[0] + line.length, other.start[0], other.start[0] + other.length
    if not line.start[0] < begin < end < last:
        given = f"x = {line.start[0]:g} to {end:g} m, and {begin:g} to {last:g} m"
        wrong = f"the line does not overlap with {follower} at its end"
        remedy = f"let {follower} start between {line.start[0]:g} and {end:g} m, and end beyond {end:g} m"
        yield Finding(("overhead_lines", name, "overlap"), wrong, given, remedy)
        return
    for own, x, above in (
        (name, end, height_at(line, end) - height_at(other, end)),
        (follower, begin, height_at(other, begin) - height_at(line, begin)),
    ):
        if above < CLEAR * (1.0 - 1e-9):
            where = "last" if own == name else "first"
            wrong = f"the contact wire ends at x = {x:g} m within reach of pantographs"
            given = f"{above:.3g} m above the other one"
            remedy = f"raise its {where} support (heights) to {CLEAR:g} m above the other wire, or more"
            yield Finding(("overhead_lines", own, "heights"), wrong, given, remedy)
