"""From a scenario to nodes: lines divided between what is joined to them, nodes numbered, about where they are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.restrained_points import supports_of
from ropewalk.model.joint import Joined
from ropewalk.model.line import spatial
from ropewalk.model.net import CableEdge
from ropewalk.model.scenario import Scenario
from ropewalk.system.assembling.line_shapes import curves
from ropewalk.system.assembling.membranes import MembraneMesh, sheet_of
from ropewalk.system.elements.cells import Cells

# A sheave is no closer to a node than this part of the link over which it stands.
_CLOSEST = 1e-3

Marks = Mapping[str, Sequence[float]]
"""Places along lines, m, at which nodes are to be, too."""
Over = Mapping[tuple[str, str], float]
"""Where along lines their sheaves are, m, by the names of line and sheave."""


class LaidLine(NamedTuple):
    """A line, or the edge cable of a net: its nodes in order and where they are along it."""

    name: str
    node: Integers
    station: Array  # m, unstrained


class LaidSheave(NamedTuple):
    """A sheave over which a line runs."""

    line: str
    name: str
    node: int  # its own
    link: int  # of its line over which it stands, -1: it stands at a node, where the line is divided
    ahead: float  # m, unstrained length between the start of that link and the sheave
    friction: float


class End(NamedTuple):
    """A support, and its node."""

    name: str
    node: int


@dataclass(frozen=True, eq=False)
class Laid:
    """Lines and nets as laid out."""

    place: Array  # (node, 3) m, about where nodes are
    strands: tuple[LaidLine, ...]  # lines, then edge cables
    membranes: tuple[MembraneMesh, ...]
    vertex: tuple[Integers, ...]  # nodes of the vertices of each sheet
    cells: Cells
    ends: tuple[End, ...]  # supports
    sheaves: tuple[LaidSheave, ...]
    split: frozenset[int]  # nodes at which lines are divided only because it was asked for


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


def lay(
    scenario: Scenario, lengths: Mapping[str, float], *, marks: Marks | None = None, over: Over | None = None,
    split: bool = False,
) -> Laid:  # fmt: skip
    """Number the nodes of a scenario.

    Args:
        scenario: what is there.
        lengths: unstrained length of each line, m.
        marks: where lines have nodes besides those between equal links; they are divided there.
        over: where along lines their sheaves are; None: about there as they are drawn.
        split: whether lines are divided at their sheaves, too, and do not run over them.

    Raises:
        RopewalkError: a net cannot be divided, or a path leads over its edge.
    """
    nodes, more = _Nodes(), {name: list(places) for name, places in (marks or {}).items()}
    membranes = tuple(sheet_of(name, net) for name, net in scenario.nets.items())
    joint = {name: int(nodes.add(np.zeros((1, 3)))[0]) for name in scenario.joints}
    if split:
        assert over is not None
        for (name, _), xi in over.items():
            more.setdefault(name, []).append(xi)
    drawn = curves(scenario, lengths, membranes, more)
    along = {name: (nodes.add(places), xi) for name, (xi, places, _) in drawn.items()}
    vertex = tuple(nodes.add(sheet.place) for sheet in membranes)
    wheels = [(name, own, s) for name, line in scenario.lines.items() for own, s in line.sheaves.items()]
    wheel = {(name, own): int(nodes.add(np.array([spatial(s.at)]))[0]) for name, own, s in wheels}
    for name, line in scenario.lines.items():
        mine = along[name][0]
        for end, support in ((int(mine[0]), line.start_support), (int(mine[-1]), line.end_support)):
            if isinstance(support, Joined):
                nodes.join(end, _target(support, joint, along, membranes, vertex))
    for name, own, s in wheels:
        if s.to is not None:
            nodes.join(wheel[name, own], joint[s.to])
        if split and over is not None:
            node, station = along[name]
            n = int(node[np.abs(station - over[name, own]).argmin()])
            nodes.place[n] = nodes.place[wheel[name, own]]
            nodes.join(n, wheel[name, own])
    if joint:  # their own place was not known: only what is joined to them says where they are
        roots = np.array([nodes.root(j) for j in range(len(nodes.place))])
        for i in joint.values():
            others = [nodes.place[j] for j in np.flatnonzero(roots == roots[i]).tolist() if j not in joint.values()]
            nodes.place[i] = np.mean(others, axis=0) if others else np.zeros(3)
    number, place = nodes.numbered()
    strands = [LaidLine(name, number[own], xi) for name, (own, xi) in along.items()]
    vertices = tuple(number[v] for v in vertex)
    for sheet, mine in zip(membranes, vertices, strict=True):
        strands += _edge(sheet, mine)
    ends = [End(*end) for own in strands for end in _ends(scenario, own)]
    ends += [End(f"{name}.{own}", int(number[wheel[name, own]])) for name, own, s in wheels if s.to is None]
    by_name = {own.name: own for own in strands}
    sheaves = list[LaidSheave]()
    for name, own, s in wheels:
        at = int(number[wheel[name, own]])
        if split:
            sheaves.append(LaidSheave(name, own, at, -1, 0.0, s.friction))
            continue
        corner = 1 + list(scenario.lines[name].sheaves).index(own)
        far = float(drawn[name][2][corner]) * lengths[name] if over is None else over[name, own]
        link, ahead = _over_link(by_name[name], far)
        if any((other.line, other.link) == (name, link) for other in sheaves):
            raise RopewalkError(f"lines: {name}: elements: two sheaves stand over one link; write more elements")
        sheaves.append(LaidSheave(name, own, at, link, ahead, s.friction))
    cut = {
        int(by_name[name].node[np.abs(by_name[name].station - far).argmin()])
        for name, places in more.items()
        for far in places
    }
    return Laid(
        place, tuple(strands), membranes, vertices, _cells(membranes, vertices), tuple(ends), tuple(sheaves),
        frozenset(cut),
    )  # fmt: skip


def _ends(scenario: Scenario, own: LaidLine) -> Iterator[tuple[str, int]]:
    """Names and nodes of the supports of a line."""
    line = scenario.lines.get(own.name)
    for side, _, support, station in supports_of(line, float(own.station[-1])) if line is not None else ():
        if not isinstance(support, Joined):
            yield f"{own.name}.{side}", int(own.node[np.abs(own.station - station).argmin()])


def _over_link(own: LaidLine, xi: float) -> tuple[int, float]:
    """The link of a line over which a sheave at xi in m stands, and how much of it is behind, m."""
    station = own.station
    p = int(np.clip(np.searchsorted(station, xi) - 1, 1, station.size - 3))
    whole = float(station[p + 1] - station[p])
    return p, float(np.clip(xi - station[p], _CLOSEST * whole, (1.0 - _CLOSEST) * whole))


def _edge(sheet: MembraneMesh, node: Integers) -> Iterator[LaidLine]:
    """The edge cable of a net."""
    edge = sheet.net.edge
    if not isinstance(edge, CableEdge):
        return
    rim = sheet.surface.rim
    start = int(np.flatnonzero(rim == sheet.corners[0])[0])
    loop = np.append(np.roll(rim, -start), rim[start])
    laid = np.linalg.norm(np.diff(sheet.place[loop], axis=0), axis=1)
    rest = laid / (1.0 + (edge.tension or 0.0) / edge.axial_stiffness)
    yield LaidLine(f"{sheet.name}.edge", node[loop], np.concatenate(([0.0], np.cumsum(rest))))


def _cells(membranes: Sequence[MembraneMesh], vertices: Sequence[Integers]) -> Cells:
    """All cells of nets, whose vertices have these nodes."""
    node, inverse, area = [np.zeros((0, 3), dtype=np.int64)], [np.zeros((0, 4))], [np.zeros(0)]
    for sheet, own in zip(membranes, vertices, strict=True):
        corners = (sheet.surface.plan * sheet.scale)[sheet.surface.triangle]
        p, q = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        twice = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
        node.append(own[sheet.surface.triangle])
        inverse.append(np.stack([q[:, 1], -q[:, 0], -p[:, 1], p[:, 0]], axis=1) / twice[:, None])
        area.append(0.5 * twice)
    rows = np.repeat(np.arange(len(membranes)), [own.size for own in area[1:]])
    return Cells(
        np.ascontiguousarray(np.concatenate(node), dtype=np.int64), np.concatenate(inverse), np.concatenate(area),
        rows.astype(np.int64), np.array([sheet.membrane_elements for sheet in membranes] or [np.zeros(7)]),
    )  # fmt: skip


def _target(
    support: Joined, joint: Mapping[str, int], along: Mapping[str, tuple[Integers, Array]],
    membranes: tuple[MembraneMesh, ...], vertex: tuple[Integers, ...],
) -> int:  # fmt: skip
    """The node to which an end is joined."""
    if support.to in joint:
        return joint[support.to]
    if support.to in along:
        assert isinstance(support.at, float)
        mine, xi = along[support.to]
        return int(mine[np.abs(xi - support.at).argmin()])
    assert isinstance(support.at, tuple)
    at = next(i for i, sheet in enumerate(membranes) if sheet.name == support.to)
    return int(vertex[at][membranes[at].near(support.at)[0]])
