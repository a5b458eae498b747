"""Nets and membranes of a structure: which nodes are theirs, what holds them, and the ways of loads on them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.model.net import CableEdge
from ropewalk.model.scenario import Scenario
from ropewalk.system.assembling.laid import Laid
from ropewalk.system.assembling.membranes import MembraneMesh, restrained_at_edge
from ropewalk.system.assembling.surface import Surface, locate
from ropewalk.system.elements.surfaces import Surfaces

# A place is at the rim if it is closer to that than this part of a cell.
_AT_RIM = 1e-6
# Cells up to which vertices share a place, the fewest of them, and the condition from which on they cannot.
_FAR, _FEWEST, _FLAT = 2.2, 10, 1e8
# Links of a path to a cell: coarse ones would spread a force over cells, by where the path happens to begin.
_FINE = 8.0
# Stiffness of a contact, over that of the fabric below.
STIFF = 10.0


@dataclass(frozen=True, eq=False)
class PathPiece:
    """A straight piece of the way of a load on a net."""

    load: str
    places: Array  # (node, 2) m, in the plan
    begin: float  # m, where it begins on the whole way
    h: float  # m, length of its links
    firm: float  # N/m, stiffness of contacts on it
    stands: bool = False  # it is a place, and no way


class Nets:
    """The nets and membranes of a structure, as nodes of it.

    Args:
        scenario: what is there.
        laid: the same laid out.
    """

    def __init__(self, scenario: Scenario, laid: Laid) -> None:
        self.membranes, self._laid, self._scenario = laid.membranes, laid, scenario
        self.vertex: tuple[Integers, ...] = ()  # nodes of the vertices of each
        self.ways = tuple(self._ways())

    def number(self, original: Integers) -> Integers:
        """Add nodes of nets that no cable run has to all of these, (node,) as they are laid out."""
        out = np.concatenate([original, np.setdiff1d(np.concatenate(self._laid.vertex), original)])
        self._column = {int(n): i for i, n in reversed(list(enumerate(out)))}
        self.vertex = tuple(
            np.array([self._column[int(n)] for n in mine], dtype=np.int64) for mine in self._laid.vertex
        )
        return out

    def lump(self, mass: Array, lag: Array) -> None:
        """Add the masses of all vertices in kg, and what drags at them in kg/s, to those of all nodes."""
        for sheet, mine in zip(self.membranes, self.vertex, strict=True):
            np.add.at(mass, mine, sheet.weight)
            np.add.at(lag, mine, sheet.net.drag * sheet.weight)

    def restrained(self) -> Iterator[tuple[int, dict[str, Any]]]:
        """What holds edges: numbers of nodes as laid out, and entries of holdings."""
        for sheet, mine in zip(self.membranes, self._laid.vertex, strict=True):
            fixed, soft, k, c = restrained_at_edge(sheet)
            for i in fixed:
                yield int(mine[i]), {"free": np.zeros((3, 3)), "place": self._laid.place[mine[i]]}
            for i, stiff, viscous in zip(soft, k, c, strict=True):
                springs = {"stiffness": stiff * np.eye(3), "damping": viscous * np.eye(3)}
                yield int(mine[i]), {"place": sheet.place[i], **springs}

    def corners(self) -> Iterator[int]:
        """Nodes as laid out in which edge cables turn."""
        for sheet, mine in zip(self.membranes, self._laid.vertex, strict=True):
            if isinstance(sheet.net.edge, CableEdge):
                yield from mine[sheet.corners].tolist()

    def surfaces(self, first: Mapping[int, int]) -> Surfaces:
        """All cells, and the nodes of ways; `first` node of each of these by its number."""
        cells, places = self._laid.cells, {sheet.name: i for i, sheet in enumerate(self.membranes)}
        node = np.array([self._column[int(n)] for n in cells.node.ravel()], dtype=np.int64).reshape(-1, 3)
        laid = []
        for w, way in enumerate(self.ways):
            at = places[self._scenario.loads[way.load].on]
            surface = self.membranes[at].surface
            for i, place in enumerate(way.places):
                below = patch(surface, place)
                if below is None:
                    raise RopewalkError(
                        f"loads: {way.load}: its path leads beyond the edge of {self.membranes[at].name}"
                    )
                laid.append((first[w] + i, self.vertex[at][below[0]], below[1]))
        return Surfaces.of(cells._replace(node=node), laid)

    def _ways(self) -> Iterator[PathPiece]:
        membranes = {sheet.name: sheet for sheet in self.membranes}
        for name, load in self._scenario.loads.items():
            if load.on in membranes:
                path = getattr(load, "path", None) or load.travel.path  # type: ignore[union-attr]
                yield from _segments(name, membranes[load.on], np.array(path, dtype=float))


def patch(surface: Surface, place: Array) -> tuple[Integers, Array] | None:
    """Vertices that share a place (2,) of the plan, m, and their parts; None: it lies outside.

    By moving least squares (Lancaster and Salkauskas, Math. Comput. 37, 141, 1981): parts that are right for every
    quadratic surface, of the vertices close by. At the rim, of its two vertices beside the place alone, which may be
    held.
    """
    cell, part = locate(surface, place)
    if cell < 0:
        return None
    corners = surface.triangle[cell]
    if any(part[c] < _AT_RIM and surface.across[cell, c] < 0 for c in range(3)) or part.max() > 1.0 - _AT_RIM:
        return corners, part
    size = np.sqrt(2.0 * surface.areas[cell])
    away = (surface.plan - place) / (_FAR * size)
    square = (away**2).sum(axis=1)
    near = np.flatnonzero(square < 1.0)
    if near.size < _FEWEST:
        near = np.argsort(square)[:_FEWEST]
    u, v = away[near].T
    reach = max(1.0, 1.01 * float(square[near].max()))
    weight = (1.0 - square[near] / reach) ** 2
    P = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=1)
    moments = P.T @ (weight[:, None] * P)
    if np.linalg.cond(moments) > _FLAT:  # too few cells beside each other
        return corners, part
    return near, weight * (P @ np.linalg.solve(moments, np.eye(6)[0]))


def _segments(load: str, sheet: MembraneMesh, path: Array) -> Iterator[PathPiece]:
    """Yield the straight pieces of a path (corner, 2) in m along the sides of a sheet, in links shorter than cells."""
    corners = sheet.in_plan(path)
    for corner in corners:
        sheet.cell_at(corner, f"loads: {load}: its path")
    size, firm = float(np.sqrt(2.0 * sheet.surface.areas.mean())), STIFF * float(sheet.membrane_elements[1])
    lengths = np.hypot(*np.diff(path, axis=0).T)
    begin = 0.0
    for one, other, length in zip(corners[:-1], corners[1:], lengths, strict=True):
        if length > 0.0:
            links = max(1, round(_FINE * float(np.hypot(*(other - one))) / size))
            part = np.linspace(0.0, 1.0, links + 1)[:, None]
            yield PathPiece(load, one + part * (other - one), begin, float(length) / links, firm)
            begin += float(length)
    if begin == 0.0:  # it stands; what follows leads to the middle of the sheet, and is never reached
        inwards = sheet.surface.plan.mean(axis=0) - corners[0]
        step = 0.5 * size * inwards / max(float(np.hypot(*inwards)), 1e-12)
        if not inwards.any():
            step = np.array([0.5 * size, 0.0])
        yield PathPiece(load, np.array([corners[0], corners[0] + step]), 0.0, 0.5 * size, firm, stands=True)
