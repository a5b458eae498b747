"""About where lines are before their rest is known, and where their nodes are along them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.model.division import links_of_line
from ropewalk.model.joint import Joined
from ropewalk.model.line import Line, spatial
from ropewalk.model.scenario import Scenario
from ropewalk.system.assembling.membranes import MembraneMesh

_POINTS = 401  # on each span of the curve along which a line is drawn


def attached(scenario: Scenario, name: str) -> list[float]:
    """Where along a line others are joined to it, m."""
    supports = (s for line in scenario.lines.values() for s in (line.start_support, line.end_support))
    return [s.at for s in supports if isinstance(s, Joined) and s.to == name and isinstance(s.at, float)]


def stations(line: Line, length: float, joined: list[float]) -> Array:
    """Where the nodes of a line are: evenly between the places where it is held or something is joined, m.

    How many there are does not depend on a length that is still searched for: shapes found before must fit.
    """
    elements = links_of_line(line, joined) if line.bending_stiffness else line.elements
    joined = [*joined, *(support.at for support in line.supports.values())]
    joined += [] if line.cut is None else [line.cut.at]
    whole = line.length or max([line.distance, *(1.01 * at for at in joined)])
    near = 1e-9 * whole
    marks = [0.0, *sorted(at for at in set(joined) if near < at < whole - near), whole]
    # Until its length is found a line may be too short for what is joined to it.
    squeeze = 1.0 if marks[-2] < length - near else 0.99 * length / marks[-2]
    places = [*(squeeze * at for at in marks[:-1]), length]
    out = [np.zeros(1)]
    for (a, b), (c, d) in zip(pairwise(marks), pairwise(places), strict=True):
        count = max(2 if line.supports else 1, round(elements * (b - a) / whole))
        out.append(np.linspace(c, d, count + 1)[1:])
    return np.concatenate(out)


def drawn(corners: Array, part: Array, length: float) -> tuple[Array, Array]:
    """About where a line is: from support to sheave to support, the widest span sagging.

    Args:
        corners: (corner, 3) m, supports and sheaves.
        part: (n,) parts of its length.
        length: of the unstrained line, m.

    Returns:
        Places (n, 3) in m, and at which parts the corners are.
    """
    steps = np.diff(corners, axis=0)
    spans = np.linalg.norm(steps, axis=1)
    widest = int(np.hypot(steps[:, 0], steps[:, 1]).argmax())
    spare, chord = max(length - float(spans.sum()), 0.0), float(spans[widest])
    # A parabola is 8 sag^2 / (3 chord) longer than its chord.
    sag = np.sqrt(0.375 * spare * chord) if chord > 0.0 else 0.5 * spare
    x = np.linspace(0.0, 1.0, _POINTS)
    curve = []
    for k, (begin, step) in enumerate(zip(corners[:-1], steps, strict=True)):
        piece = begin + x[:, None] * step
        piece[:, 2] -= 4.0 * (sag if k == widest else 0.0) * x * (1.0 - x)
        curve.append(piece)
    points = np.concatenate(curve)
    way = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    places = np.stack([np.interp(part * way[-1], way, column) for column in points.T], axis=1)
    return places, np.append(way[::_POINTS], way[-1]) / way[-1]


def curves(
    scenario: Scenario, lengths: Mapping[str, float], membranes: tuple[MembraneMesh, ...],
    marks: Mapping[str, Sequence[float]],
) -> dict[str, tuple[Array, Array, Array]]:  # fmt: skip
    """Stations, about the places of the nodes, and the parts at the corners of all lines.

    Lines that others are joined to are drawn first, these then begin and end on them.

    Args:
        scenario: what is there.
        lengths: unstrained length of each line, m.
        membranes: of its nets.
        marks: where lines have nodes, too, m.
    """
    knots: dict[str, list[Array]] = {name: [] for name in scenario.joints}
    for line in scenario.lines.values():
        for point, support in ((line.start, line.start_support), (line.end, line.end_support)):
            if isinstance(support, Joined) and support.to in knots:
                knots[support.to].append(np.array(spatial(point)))
    joint = {name: np.mean(places, axis=0) for name, places in knots.items() if places}
    found: dict[str, tuple[Array, Array, Array]] = {}
    waiting = dict(scenario.lines)

    def end(point: tuple[float, ...], support: object) -> Array:
        if isinstance(support, Joined):
            if support.to in joint:
                return np.asarray(joint[support.to])
            if support.to in found and isinstance(support.at, float):
                xi, places, _ = found[support.to]
                return np.array([np.interp(support.at, xi, column) for column in places.T])
            sheet = next((sheet for sheet in membranes if sheet.name == support.to), None)
            if sheet is not None and isinstance(support.at, tuple):
                return np.asarray(sheet.place[sheet.near(support.at)[0]])
        return np.array(spatial(point))

    while waiting:
        ready = [name for name, line in waiting.items() if not _needs(line) & set(waiting) - {name}]
        for name in ready or list(waiting):  # lines that are joined to each other are drawn as declared
            line = waiting.pop(name)
            wheels = [joint.get(s.to or "", np.array(spatial(s.at))) for s in line.sheaves.values()]
            corners = [end(line.start, line.start_support), *wheels, end(line.end, line.end_support)]
            xi = stations(line, lengths[name], [*attached(scenario, name), *marks.get(name, ())])
            found[name] = xi, *drawn(np.array(corners), xi / lengths[name], lengths[name])
            if line.supports:
                found[name] = xi, _drawn_between(line, corners, xi, lengths[name]), found[name][2]
    return {name: found[name] for name in scenario.lines}


def _drawn_between(line: Line, corners: Sequence[Array], xi: Array, length: float) -> Array:
    """About where the nodes of a line are between its inner supports and its ends, (node, 3) m."""
    restrained = sorted(line.supports.values(), key=lambda support: support.at)
    marks = [0.0, *(support.at for support in restrained), length]
    points = [corners[0], *(np.array(line.place_of(support, length)) for support in restrained), corners[-1]]
    out = np.empty((xi.size, 3))
    for (a, b), (begin, end) in zip(pairwise(marks), pairwise(points), strict=True):
        own = (xi >= a) & (xi <= b)
        out[own] = drawn(np.array([begin, end]), (xi[own] - a) / (b - a), b - a)[0]
    return out


def _needs(line: Line) -> set[str]:
    return {s.to for s in (line.start_support, line.end_support) if isinstance(s, Joined)}
