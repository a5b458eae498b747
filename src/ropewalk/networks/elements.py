"""The arrays of a network under construction: what each line, joint, net and sheave adds to them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.assembly import pack, restrained_by, speed_table, vector_table
from ropewalk.mechanics.restrained_points import supports_of
from ropewalk.model.joint import Joined
from ropewalk.model.law import Hooke
from ropewalk.model.line import Line, spatial
from ropewalk.model.net import CableEdge
from ropewalk.model.scenario import Scenario
from ropewalk.networks.membranes import MembraneMesh, restrained_at_edge
from ropewalk.networks.moving_loads import Strand
from ropewalk.networks.network import (
    LINK_SLOTS,
    Array,
    Cells,
    ContactSchedule,
    Integers,
    Links,
    Locations,
    Moves,
    Network,
    NetworkSheaves,
    NetworkSupports,
    NetworkWind,
    NodeWeights,
    whole,
)

_XYZ = ("x", "y", "z")


class Triangles(NamedTuple):
    """The cells of one net."""

    node: Integers  # (cell, 3)
    inverse: Array  # (cell, 4) 1/m
    area: Array  # (cell,) m^2


class End(NamedTuple):
    """A support, and what belongs to it at its node."""

    name: str
    node: int
    mass: float  # kg
    force: Array  # (3,) N, constant


class Builder:
    """Arrays of a network under construction."""

    def __init__(self, scenario: Scenario, place: Array, number: Integers, until: float) -> None:
        self.scenario, self.place, self.number, self.until = scenario, place, number, until
        n = place.shape[0]
        self.mass, self.force = np.zeros(n), np.zeros((n, 3))
        self.links: list[tuple[int, int, float, int, float]] = []
        self.laws: list[Array] = []
        self.cells: list[Triangles] = []
        self.fabrics: list[Array] = []
        self.fixed: set[int] = set()
        self.rails: list[tuple[int, Array]] = []
        self.springs: list[tuple[int, Array, Array]] = []
        self.sheaves: list[tuple[int, int, int, int, float, float]] = []
        self.ends: list[End] = []
        self.moves: list[tuple[int, int, Array, Array, Array]] = []

    def line(self, name: str, line: Line, mine: Integers, xi: Array) -> Strand:
        """Add the links and masses of a line."""
        node, first = self.number[mine], len(self.links)
        self._chain(node, np.diff(xi), pack(line.law, line.axial_stiffness), line.wind_drag)
        self._masses(node, np.diff(xi), line.mass)
        return Strand(name, node, xi, first)

    def _chain(self, node: Integers, rest: Array, law: Array, width: float) -> None:
        self.laws.append(law)
        for i, j, length in zip(node[:-1], node[1:], rest, strict=True):
            self.links.append((int(i), int(j), float(length), len(self.laws) - 1, width))

    def _masses(self, node: Integers, rest: Array, density: float) -> None:
        half = 0.5 * density * rest
        for at in (node[:-1], node[1:]):
            np.add.at(self.mass, at, half)

    def supports(self, name: str, line: Line, node: Integers, xi: Array) -> None:
        """Add what holds a line, whose nodes are at xi along it, m."""
        for side, point, support, station in supports_of(line, float(xi[-1])):
            if isinstance(support, Joined):
                continue
            n, mass = int(node[np.abs(xi - station).argmin()]), getattr(support, "mass", 0.0)
            free, stiffness, _, force = restrained_by(support, _XYZ)
            self.ends.append(End(f"{name}.{side}", n, mass, force))
            self.mass[n] += mass
            self.force[n] += force
            rank = round(float(np.trace(free)))
            time, moved = vector_table(getattr(support, "displacement", (0.0, 0.0)), self.until, _XYZ)
            declared = np.array(point)
            place = declared + [np.interp(0.0, time, row) for row in moved]
            if time.size > 1:
                spring = -1 if rank == 0 else len(self.springs)
                self.moves.append((n if rank == 0 else -1, spring, declared, time, moved))
            if rank == 0:
                self.fixed.add(n)
                self.place[n] = place
                continue
            if rank == 1:
                self.rails.append((n, np.linalg.eigh(free)[1][:, -1]))
            self.springs.append((n, place, stiffness))

    def joint(self, name: str, n: int) -> None:
        """Add the mass of a joint, and the force on it."""
        declared = self.scenario.joints[name]
        self.mass[n] += declared.mass
        self.force[n] += spatial(declared.force)

    def sheet(self, sheet: MembraneMesh, node: Integers) -> int:
        """Add the cells and masses of a net or membrane; returns its first cell."""
        first = self.cell_count
        corners = (sheet.surface.plan * sheet.scale)[sheet.surface.triangle]
        p, q = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        twice = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
        inverse = np.stack([q[:, 1], -q[:, 0], -p[:, 1], p[:, 0]], axis=1) / twice[:, None]
        self.cells.append(Triangles(node[sheet.surface.triangle], inverse, 0.5 * twice))
        self.fabrics.append(sheet.membrane_elements)
        self.mass[node] += sheet.weight
        fixed, soft, k, _ = restrained_at_edge(sheet)
        self.fixed |= {int(i) for i in node[fixed]}
        for i, stiff in zip(soft, k, strict=True):
            self.springs.append((int(node[i]), sheet.place[i], stiff * np.eye(3)))
        return first

    def edge(self, sheet: MembraneMesh, node: Integers) -> Iterator[Strand]:
        """Add the edge cable of a net."""
        edge = sheet.net.edge
        if not isinstance(edge, CableEdge):
            return
        rim = sheet.surface.rim
        start = int(np.flatnonzero(rim == sheet.corners[0])[0])
        loop = np.append(np.roll(rim, -start), rim[start])
        laid = np.linalg.norm(np.diff(sheet.place[loop], axis=0), axis=1)
        rest = laid / (1.0 + (edge.tension or 0.0) / edge.axial_stiffness)
        first = len(self.links)
        self._chain(node[loop], rest, pack(Hooke(), edge.axial_stiffness), 0.0)
        self._masses(node[loop], rest, edge.mass)
        yield Strand(f"{sheet.name}.edge", node[loop], np.concatenate(([0.0], np.cumsum(rest))), first)

    def sheave(self, name: str, sheave: str, n: int, strand: Strand, xi: float) -> None:
        """Stand a sheave over the link of its line that holds the material coordinate xi in m."""
        declared = self.scenario.lines[name].sheaves[sheave]
        if declared.to is None:
            self.fixed.add(n)
            self.ends.append(End(f"{name}.{sheave}", n, 0.0, np.zeros(3)))
        p = int(np.clip(np.searchsorted(strand.station, xi) - 1, 1, strand.node.size - 3))
        if any(link == strand.first + p for _, link, *_ in self.sheaves):
            raise RopewalkError(f"lines: {name}: elements: two sheaves stand over one link; write more elements")
        whole = strand.station[p + 1] - strand.station[p]
        ahead = float(np.clip(xi - strand.station[p], 0.05 * whole, 0.95 * whole))
        last = strand.first + strand.node.size - 2
        self.sheaves.append((n, strand.first + p, strand.first, last, ahead, declared.friction))

    @property
    def cell_count(self) -> int:
        """Number of cells so far."""
        return sum(part.area.size for part in self.cells)

    def network(self, locations: Locations, course: ContactSchedule) -> Network:
        """Everything together."""
        contacts, n = locations.kind.size, self.mass.size
        restrained = NetworkSupports(
            np.array(sorted(self.fixed), dtype=np.int64),
            np.array([i for i, _ in self.rails], dtype=np.int64),
            np.array([along for _, along in self.rails]).reshape(-1, 3),
            np.array([i for i, *_ in self.springs], dtype=np.int64),
            np.array([place for _, place, *_ in self.springs]).reshape(-1, 3),
            np.array([k for *_, k in self.springs]).reshape(-1, 3, 3), self._moves(),
        )  # fmt: skip
        gravity = np.array([0.0, 0.0, -self.scenario.gravity])
        mass = np.concatenate([self.mass, np.zeros(contacts)])
        force = np.concatenate([self.force, np.zeros((contacts, 3))]) + mass[:, None] * gravity
        return Network(
            self._links(contacts), self._cells(), restrained, self._sheaves(), locations, course, self._wind(),
            NodeWeights(mass, force),
            gravity, len(self.links), n,
        )  # fmt: skip

    def _moves(self) -> Moves:
        count = whole(np.array([time.size for *_, time, _ in self.moves]))
        return Moves(
            whole(np.array([n for n, *_ in self.moves])), whole(np.array([k for _, k, *_ in self.moves])),
            np.array([place for _, _, place, *_ in self.moves]).reshape(-1, 3), np.cumsum(count) - count, count,
            np.concatenate([np.zeros(0), *(time for *_, time, _ in self.moves)]),
            np.ascontiguousarray(np.hstack([np.zeros((3, 0)), *(value for *_, value in self.moves)])),
        )  # fmt: skip

    def _links(self, contacts: int) -> Links:
        slots = np.zeros(LINK_SLOTS * contacts)
        table = np.array(self.links, dtype=float).reshape(-1, 5)
        one, other, rest, law, width = (np.concatenate([column, slots]) for column in table.T)
        on = np.concatenate([np.ones(len(self.links), dtype=np.int64), slots.astype(np.int64)])
        on[[link for _, link, *_ in self.sheaves]] = 0
        rest[len(self.links) :] = 1.0
        wide = max((p.size for p in self.laws), default=5)
        laws = np.array([np.pad(p, (0, wide - p.size)) for p in self.laws]).reshape(-1, wide)
        return Links(whole(one), whole(other), rest, whole(law), width, on, laws)

    def _cells(self) -> Cells:
        node, inverse, area, membrane_elements = np.zeros((0, 3)), np.zeros((0, 4)), np.zeros(0), np.zeros(0)
        for row, part in enumerate(self.cells):
            node, inverse = np.concatenate([node, part.node]), np.concatenate([inverse, part.inverse])
            area, membrane_elements = (
                np.concatenate([area, part.area]),
                np.concatenate([membrane_elements, np.full(part.area.size, row)]),
            )
        return Cells(
            whole(node), inverse, area, whole(membrane_elements),
            np.array(self.fabrics).reshape(-1, 7) if self.fabrics else np.zeros((1, 7)),
        )  # fmt: skip

    def _sheaves(self) -> NetworkSheaves:
        node, link, first, last, ahead, friction = np.array(self.sheaves, dtype=float).reshape(-1, 6).T
        tension = np.zeros((len(self.sheaves), 2))
        return NetworkSheaves(
            whole(node), whole(link), whole(first), whole(last), ahead.copy(), friction.copy(), tension
        )

    def _wind(self) -> NetworkWind:
        wind = self.scenario.wind
        if wind is None:
            return NetworkWind(np.zeros(3), np.zeros(1), np.zeros(1), 1.0)
        direction = np.array(spatial(wind.direction))
        times, values = speed_table(wind.speed, self.until)
        return NetworkWind(direction / np.linalg.norm(direction), times, values, wind.air_density)
