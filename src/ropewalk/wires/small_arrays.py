"""What small motion of wires is computed with, as arrays: springs, stencil, what moves and is watched."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.wires.bending import EDGE, REACH
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.rest import (
    ROUNDING,
    WiresAtRest,
    slowed_ends,
    ties_springs,
    vertical_stiffness,
    with_tension,
    without_supports,
)
from ropewalk.wires.spline import WIDTH

_EDGE = 2  # nodes next to the end of a wire of the second order
_FEW = 0.1  # part of the nodes of a wire that may carry more than it and be seen to afterwards


class Springs(NamedTuple):
    """Ties as vertical springs between splines, about rest."""

    one: Integers  # (spring,) first control point of one end
    other: Integers  # the same of the other end
    weight: Array  # (spring, 2 WIDTH) that gives how far they move apart; zeros for the ground
    nodes: Integers  # (spring, 2) where both ends are nodes, these, or the node twice for the ground; else -1
    rest: Array  # N along the tie at rest; of a slack one the negative of what pulls it straight
    pull: Array  # N/m along the tie, while tight
    push: Array  # N/m along the tie, while slack
    across: Array  # N/m vertically, of its tension at rest
    damping: Array  # N s/m, while tight
    way: Array  # (spring,) vertical part of its direction
    last: Array  # m by which its ends had moved apart a step ago
    rate: Array  # m/s at which they did so then, while it damped
    x: Array  # m, to know whether it lies in the window
    number: Integers  # of the tie
    strength: Array  # N along the tie, that tears it
    fails_at: Array  # s
    failed: Array  # (spring, 2) when it did, s, and under which force, N; infinite: it has not


class WireWindow(NamedTuple):
    """What of the wires moves: the rest stands still. Each as the first of them and one beyond the last."""

    low: Integers  # (wire,) control points, counted in the wire
    high: Integers  # (wire,)
    layer: Integers  # (wire,) nodes of the layers that take up waves, and
    rate: Array  # (wire, side, node) 1/s, at which they do so
    beyond: Integers  # (wire,) nodes beyond a border that what acts near it may share; they stand still
    laden: Integers  # (wire, 2)
    springs: tuple[int, int]
    fast: tuple[int, int]  # holders, those that hold fast, and
    elastic: tuple[int, int]  # the others
    watched: tuple[int, int]


class Watched(NamedTuple):
    """Points whose height is recorded."""

    base: Integers
    weight: Array  # (point, WIDTH)
    x: Array  # m
    number: Integers  # in the record


class Stencil(NamedTuple):
    """What a step of a given length needs of the wires."""

    bending: Array  # (wire,) N m^2, corrected
    bent: (
        Array  # (wire,) N m^2, what second differences are multiplied by: on beams of the fourth order with more of it
    )
    edge: Integers  # (wire,) nodes next to each end whose rows differ from those inside
    rows: Array  # (end, EDGE, EDGE + REACH) N/m, stiffness of these against them and the nodes beside, from each end on
    gain: Array  # (node,) m/N, displacement by a force during a step
    keep: Array  # (wire,) part of the last displacement that is kept, 1 without drag
    keep_end: Array  # (end,) the same of its last nodes, whose supports have a mass without drag
    bare: Array  # (wire,) m/N, gain of a node that carries its wire alone; 0 where many carry more
    laden: Integers  # the other nodes, of all wires with a bare gain
    first: Integers  # (wire + 1,) where those of each wire begin
    saved: Array  # (laden,) room
    mass: Array  # (node,) kg, of which drag takes its part
    damped: bool  # whether any wire is
    relief: Array  # (node,) N/m, by which the link behind a node pulls less than its wire, over its length
    relieved: Integers  # (piece, 3) pieces of wires where that is so: the wire, its first node there, and one beyond


def _nodes(base: Integers, weight: Array) -> Integers:
    """The node of each place that is one, else -1."""
    return np.where((weight == 1.0).any(axis=1), base + np.argmax(weight, axis=1), -1)


def x_of(mesh: Mesh, wire: Integers, station: Array) -> Array:
    """Where stations of wires are along x, m."""
    across = mesh.strands.across[wire]
    x: Array = across[:, 0] + across[:, 1] * station
    return x


def springs_of(mesh: Mesh, rest: WiresAtRest) -> Springs:
    """Ties as springs about rest."""
    ties = mesh.ties
    pull, slack = ties_springs(mesh)
    way = rest.tie_way[:, 2]
    apart = np.hstack([-ties.one.weight, ties.other.weight])
    across = np.maximum(rest.tie_force, 0.0) / rest.tie_distance * (1.0 - way**2)
    one, other = _nodes(ties.one.base, -apart[:, :WIDTH]), _nodes(ties.other.base, apart[:, WIDTH:])
    grounded = ~apart[:, WIDTH:].any(axis=1)
    nodes = np.column_stack([one, np.where(grounded, one, other)])
    nodes[(nodes < 0).any(axis=1)] = -1
    return Springs(
        ties.one.base, ties.other.base, apart, nodes, pull * (rest.tie_distance - ties.length), pull, slack, across,
        ties.damping, way.copy(), np.zeros(way.size), np.zeros(way.size), x_of(mesh, ties.one.wire, ties.one.station),
        np.arange(way.size), ties.strength, ties.fails_at * (1.0 - ROUNDING), np.full((way.size, 2), np.inf),
    )  # fmt: skip


def stencil_of(mesh: Mesh, step: float) -> Stencil:
    """Prepare steps of a length in s."""
    s = mesh.strands
    T = np.where(s.fourth, s.tension, np.maximum(s.tension, 0.0))
    bending = s.stiffness + T * (np.where(s.fourth, 0.0, s.h**2) - T / s.rho * step**2) / 12.0
    edge = np.where(s.fourth, EDGE, _EDGE)
    slow, slow_end = 1.0 + 0.5 * step * s.drag, slowed_ends(mesh, step)
    slowed = np.repeat(slow, s.links + 1)
    slowed[np.stack([s.first, s.first + s.links], axis=1).ravel()] = slow_end
    gain = step**2 / mesh.mass / slowed
    gain[(mesh.fixed & ~mesh.driven)[2]] = 0.0
    bare, laden, first = step**2 / (s.rho * s.h) / slow, [], [0]
    for a, n in enumerate(s.links):
        part = slice(int(s.first[a] + edge[a]), int(s.first[a] + n + 1 - edge[a]))
        own = part.start + np.flatnonzero(np.abs(gain[part] / bare[a] - 1.0) > 1e-12)
        if own.size > _FEW * n:
            bare[a], own = 0.0, own[:0]
        laden += own.tolist()
        first.append(len(laden))
    corrected = mesh._replace(strands=s._replace(stiffness=bending), relief=np.zeros_like(mesh.relief))
    return Stencil(
        bending, with_tension(corrected.strands), edge, _rows_at_ends(corrected), gain, (2.0 - slow) / slow,
        (2.0 - slow_end) / slow_end, bare, np.array(laden, dtype=np.int64),
        np.array(first, dtype=np.int64), np.zeros(len(laden)), without_supports(mesh),
        bool(s.drag.any() or s.retardation.any()), mesh.relief / np.repeat(s.h, s.links + 1), _relieved(mesh),
    )  # fmt: skip


def _rows_at_ends(mesh: Mesh) -> Array:
    """Rows of the stiffness of all wires next to their ends, (end, EDGE, EDGE + REACH) N/m, from each end on."""
    s, K = mesh.strands, vertical_stiffness(mesh)
    found = np.zeros((2 * s.first.size, EDGE, EDGE + REACH))
    for a, (first, n) in enumerate(zip(s.first, s.links, strict=True)):
        near = np.arange(min(EDGE + REACH, int(n) + 1))
        for side, own in enumerate((first + near, first + n - near)):
            found[2 * a + side, : min(EDGE, near.size), : near.size] = K[np.ix_(own[:EDGE], own)].toarray()
    return found


def _relieved(mesh: Mesh) -> Integers:
    """Pieces of wires with less tension, (piece, 3): the wire, the first node that feels it, one beyond the last."""
    found = []
    for a in range(mesh.strands.first.size):
        first, less = int(mesh.strands.first[a]), np.flatnonzero(mesh.relief[mesh.of(a)])
        for piece in np.split(less, 1 + np.flatnonzero(np.diff(less) > 1)) if less.size else ():
            found.append((a, first + int(piece[0]), first + int(piece[-1]) + 2))
    return np.array(found, dtype=np.int64).reshape(-1, 3)
