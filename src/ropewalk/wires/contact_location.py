"""Where a point of a wire is: its place on the spline that is the wire."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.wires.mesh import Mesh, local_at
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.spline import WIDTH, points

_MOST, _CLOSE = 20, 1e-12  # steps of a search for a place, and its end, in links


@dataclass(frozen=True)
class Location:
    """A point of a wire: the nodes that share it."""

    links: float  # from the start of the wire
    first: int  # node
    weight: Array  # (derivative, WIDTH), with respect to `links`
    local: float  # m/N, by which the wire yields beside the spline

    def value(self, values: Array) -> Array:
        """What the spline through values (..., node) of all nodes is there."""
        return np.asarray(values[..., self.first : self.first + WIDTH] @ self.weight[0])

    def slope(self, values: Array) -> Array:
        """Its derivative there, per link."""
        return np.asarray(values[..., self.first : self.first + WIDTH] @ self.weight[1])


def location_at(mesh: Mesh, wire: int, links: float) -> Location:
    """The point of a wire so many links from its start."""
    n: Integers = mesh.strands.links[wire : wire + 1]
    base, weight = points(np.array([links]), n, mesh.strands.level[wire : wire + 1])
    own = float(local_at(mesh.strands, np.array([wire]), np.array([links]))[0])
    return Location(links, int(base[0] + mesh.strands.first[wire]), weight[0], own)


def location_below(mesh: Mesh, wire: int, x: Array, place: float) -> Location:
    """The point of a wire at a horizontal place, or the end of the wire next to it.

    Args:
        x: (node,) m, of all nodes.
        place: m.
    """
    n, own = float(mesh.strands.links[wire]), x[mesh.of(wire)]
    turn = 1.0 if own[-1] >= own[0] else -1.0
    found = location_at(mesh, wire, float(np.interp(turn * place, turn * own, np.arange(own.size))))
    for _ in range(_MOST):
        step = float((place - found.value(x)) / found.slope(x))
        found = location_at(mesh, wire, min(max(found.links + step, 0.0), n))
        if abs(step) < _CLOSE:
            break
    return found


def links_below(mesh: Mesh, wire: int, x: Array, place: Array) -> Array:
    """The same at many instants, in links from the start of the wire, (instant,).

    Args:
        x: (instant, node) m, of all nodes.
        place: (instant,) m.
    """
    n, own = int(mesh.strands.links[wire]), np.ascontiguousarray(x[:, mesh.of(wire)])
    turn = np.where(own[:, -1] >= own[:, 0], 1.0, -1.0)
    before = np.clip((turn[:, None] * own <= (turn * place)[:, None]).sum(axis=1) - 1, 0, n - 1)
    instant = np.arange(place.size)
    begin, end = own[instant, before], own[instant, before + 1]
    links = np.clip(before + (place - begin) / (end - begin), 0.0, float(n))
    count, level = np.full(place.size, n), np.tile(mesh.strands.level[wire], (place.size, 1))
    seeks = np.ones(place.size, dtype=np.bool_)
    for _ in range(_MOST):
        first, weight = points(links, count, level)
        near = np.take_along_axis(own, first[:, None] + np.arange(WIDTH), axis=1)
        here, slope = ((near * weight[:, k]).sum(axis=1) for k in range(2))
        step = np.where(seeks, (place - here) / slope, 0.0)
        links = np.clip(links + step, 0.0, float(n))
        seeks &= np.abs(step) >= _CLOSE
        if not seeks.any():
            break
    return np.asarray(links)
