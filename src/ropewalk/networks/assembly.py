"""From a scenario to a network: nodes numbered, lines divided between what is joined to them, all as plain arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ropewalk.model.division import links_of_line
from ropewalk.model.joint import Joined
from ropewalk.model.line import Line, spatial
from ropewalk.model.scenario import Scenario
from ropewalk.networks.elements import Builder, End
from ropewalk.networks.membranes import MembraneMesh, sheet_of
from ropewalk.networks.moving_loads import MovingLoad, Strand, course_of, locations_of, moving_loads_of
from ropewalk.networks.network import Array, Integers, Network

_POINTS = 401  # on each span of the curve along which a line is drawn


@dataclass(frozen=True, eq=False)
class Laid:
    """A network as laid out, with what results are made of."""

    network: Network
    place: Array  # (node, 3) m, about where nodes are
    strands: tuple[Strand, ...]  # lines, then edge cables
    membranes: tuple[MembraneMesh, ...]
    vertex: tuple[Integers, ...]  # nodes of the vertices of each sheet
    cell: tuple[int, ...]  # first cell of each sheet
    ends: tuple[End, ...]  # supports
    moving_loads: tuple[MovingLoad, ...]
    diagnostics: tuple[str, ...]
    plane: bool


class _Nodes:
    """Nodes under construction: those that are joined get one number."""

    def __init__(self) -> None:
        self.parent: list[int] = []
        self.place: list[Array] = []

    def add(self, places: Array) -> Integers:
        first = len(self.parent)
        self.parent += range(first, first + len(places))
        self.place += list(places)
        return np.arange(first, first + len(places))

    def root(self, i: int) -> int:
        while self.parent[i] != i:
            i = self.parent[i]
        return i

    def join(self, i: int, j: int) -> None:
        a, b = self.root(i), self.root(j)
        self.parent[max(a, b)] = min(a, b)

    def numbered(self) -> tuple[Integers, Array]:
        """The final number of each, and the mean place of what is joined."""
        roots = np.array([self.root(i) for i in range(len(self.parent))], dtype=np.int64)
        kept, number = np.unique(roots, return_inverse=True)
        count = np.bincount(number, minlength=kept.size)
        place = np.zeros((kept.size, 3))
        np.add.at(place, number, np.array(self.place).reshape(-1, 3))
        return number, place / count[:, None]


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


def _curves(
    scenario: Scenario, lengths: Mapping[str, float], membranes: tuple[MembraneMesh, ...]
) -> dict[str, tuple[Array, Array, Array]]:
    """Stations, about the places of the nodes, and the parts at the corners of all lines.

    Lines that others are joined to are drawn first, these then begin and end on them.
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
            xi = stations(line, lengths[name], attached(scenario, name))
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


def lay(scenario: Scenario, lengths: Mapping[str, float], until: float) -> Laid:
    """Make a network of a scenario.

    Args:
        scenario: what is there.
        lengths: unstrained length of each line, m.
        until: how long the histories of the loads are needed, s.

    Raises:
        RopewalkError: a net cannot be divided, or a path leads over its edge.
    """
    nodes, diagnostics = _Nodes(), list[str]()
    membranes = tuple(sheet_of(name, net) for name, net in scenario.nets.items())
    joint = {name: int(nodes.add(np.zeros((1, 3)))[0]) for name in scenario.joints}
    along: dict[str, tuple[Integers, Array]] = {}
    curves = _curves(scenario, lengths, membranes)
    for name, (xi, places, _) in curves.items():
        along[name] = nodes.add(places), xi
    vertex = tuple(nodes.add(sheet.place) for sheet in membranes)
    wheel = {
        (name, sheave): int(nodes.add(np.array([spatial(s.at)]))[0])
        for name, line in scenario.lines.items()
        for sheave, s in line.sheaves.items()
    }
    for name, line in scenario.lines.items():
        mine = along[name][0]
        for end, support in ((int(mine[0]), line.start_support), (int(mine[-1]), line.end_support)):
            if isinstance(support, Joined):
                nodes.join(end, _target(support, joint, along, membranes, vertex, diagnostics, name))
        for sheave, s in line.sheaves.items():
            if s.to is not None:
                nodes.join(wheel[name, sheave], joint[s.to])
    for i in joint.values():  # their own place was not known: only what is joined to them says where they are
        others = [nodes.place[j] for j in range(len(nodes.place)) if j != i and nodes.root(j) == nodes.root(i)]
        nodes.place[i] = np.mean(others, axis=0) if others else np.zeros(3)
    number, place = nodes.numbered()
    build = Builder(scenario, place, number, until)
    strands = [build.line(name, line, *along[name]) for name, line in scenario.lines.items()]
    for name, line in scenario.lines.items():
        build.supports(name, line, number[along[name][0]], along[name][1])
    for name, at in joint.items():
        build.joint(name, int(number[at]))
    cells = []
    for sheet, mine in zip(membranes, vertex, strict=True):
        cells.append(build.sheet(sheet, number[mine]))
        strands += build.edge(sheet, number[mine])
    for (name, sheave), at in wheel.items():
        corner = curves[name][2][1 + list(scenario.lines[name].sheaves).index(sheave)]
        strand = next(s for s in strands if s.name == name)
        build.sheave(name, sheave, int(number[at]), strand, float(corner) * lengths[name])
    moving_loads = moving_loads_of(scenario, until)
    vertices = tuple(number[v] for v in vertex)
    locations = locations_of(moving_loads, strands)
    network = build.network(locations, course_of(moving_loads, lengths))
    return Laid(
        network, place, tuple(strands), membranes, vertices, tuple(cells), tuple(build.ends),
        tuple(moving_loads), tuple(diagnostics), scenario.is_plane,
    )  # fmt: skip


def _target(
    support: Joined,
    joint: Mapping[str, int],
    along: Mapping[str, tuple[Integers, Array]],
    membranes: tuple[MembraneMesh, ...],
    vertex: tuple[Integers, ...],
    diagnostics: list[str],
    name: str,
) -> int:
    """The node to which an end is joined."""
    if support.to in joint:
        return joint[support.to]
    if support.to in along:
        assert isinstance(support.at, float)
        mine, xi = along[support.to]
        return int(mine[np.abs(xi - support.at).argmin()])
    assert isinstance(support.at, tuple)
    at = next(i for i, sheet in enumerate(membranes) if sheet.name == support.to)
    node, away = membranes[at].near(support.at)
    size = float(np.sqrt(2.0 * membranes[at].surface.areas.mean()))
    if away > 1e-6 * size:
        diagnostics.append(f"line {name} is joined to the nearest node of net {support.to}, {away:.3g} m away")
    return int(vertex[at][node])
