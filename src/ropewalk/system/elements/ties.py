"""Ties: springs between points of lines, or between one and the ground, such as droppers, arms and inner supports.

A point of a line is one of its spline, which nodes share; so the way from one end of a tie to the other is

    a = sum p r + g,   p: parts of nodes, those of the one end negative;   g: m, of the ground, or between coordinates,

and with the length l = |a|, or l = n a along a unit vector n that stays, its potential energy is

    V = 1/2 k (l - L)^2 + P l,   k: one stiffness where it is longer than L, another one (of droppers: none) where not.

A spline rounds the kink of a line under a point force; what the point itself is higher (`compliance.py`) acts as a
spring in series, of each tie by itself: where two of them act on one link, they know of each other's kinks to the
first order of the mesh. Dampers act as the springs do, where a tie is longer, or shorter.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.system.elements.compliance import compliance, compliances
from ropewalk.system.elements.spline import WIDTH, share

_YIELDS = 1e-12  # m/N: what yields less is taken to yield by this
_AT_NODE = 1e-9  # links


class Ties(NamedTuple):
    """All ties; one entry for each, if not said otherwise."""

    first: Integers  # where its nodes begin
    size: Integers  # how many these are
    node: Integers
    part: Array  # of `node`
    ground: Array  # (tie, axis) m
    way: Array  # (tie, axis) unit vector that stays; zero: it turns with the tie
    length: Array  # m, unstrained
    k: Array  # (tie, 2) N/m, where it is longer, and where it is shorter
    c: Array  # (tie, 2) N s/m, the same
    preload: Array  # N
    span: Array  # (tie, axis) unit vector from the one end to the other, as it was when last looked at
    longer: Array  # m, by which it was longer than `length`, or shorter

    @staticmethod
    def nothing(axes: int) -> Ties:
        """Of lines that nothing is tied to."""
        i, x, way, pair = np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros((0, axes)), np.zeros((0, 2))
        return Ties(i, i, i, x, way, way, x, pair, pair, x, way, x)

    def away(self, r: Array) -> Array:
        """Ways from one end to the other, (tie, axis) m, by places (axis, node) in m; or without the ground, rates."""
        return np.asarray(self.parts(r.shape[1]) @ r.T)

    def parts(self, nodes: int) -> sparse.csr_matrix:
        """Parts of all nodes, (tie, node)."""
        first = np.append(self.first, self.node.size)
        matrix = (self.part, self.node, first)  # a copy: who sorts it would leave parts at other nodes
        return sparse.csr_matrix(matrix, shape=(self.first.size, nodes), copy=True)

    def look(self, r: Array) -> tuple[Array, Array, Array]:
        """Unit vectors (tie, axis), lengths and by how much they are too long, m, at places of nodes (axis, node)."""
        away: Array = self.away(r) + self.ground
        turns = np.asarray(~self.way.any(axis=1))
        length = np.where(turns, np.linalg.norm(away, axis=1), (away * self.way).sum(axis=1))
        own = np.where(turns, length, 1.0).reshape(-1, 1)
        span = np.where(turns.reshape(-1, 1), away / own, self.way)
        return span, length, length - self.length

    def forces(self, r: Array, v: Array | None = None) -> Array:
        """Forces of all ties, positive if they pull, (tie,) N; of springs alone if no velocities are given."""
        span, _, longer = self.look(r)
        force = self.preload + _of(self.k, longer) * longer
        if v is not None:
            force += _of(self.c, longer) * (span * self.away(v)).sum(axis=1)
        return np.asarray(force)

    def stiffness(self, r: Array) -> sparse.csc_matrix:
        """Second derivatives of V, (place, place) N/m."""
        span, length, longer = self.look(r)
        k, force = _of(self.k, longer), self.forces(r)
        turn = np.where(self.way.any(axis=1), 0.0, force / np.where(length > 0.0, length, 1.0))
        both = (k - turn)[:, None, None] * span[:, :, None] * span[:, None, :]
        return self._gathered(both + turn[:, None, None] * np.eye(r.shape[0]), r.shape[1])

    def damping(self, r: Array) -> sparse.csc_matrix:
        """Forces of dampers over velocities, (place, place) N s/m."""
        span, _, longer = self.look(r)
        both = _of(self.c, longer)[:, None, None] * span[:, :, None] * span[:, None, :]
        return self._gathered(both, r.shape[1])

    def neighbours(self, nodes: int) -> sparse.csc_matrix:
        """Which places may feel which, (place, place)."""
        axes = self.ground.shape[1]
        P = abs(self.parts(nodes))
        return sparse.kron(np.ones((axes, axes)), P.T @ P, format="csc")

    def _gathered(self, blocks: Array, nodes: int) -> sparse.csc_matrix:
        P, axes = self.parts(nodes), self.ground.shape[1]
        rows = [[P.T @ sparse.diags(blocks[:, a, b]) @ P for b in range(axes)] for a in range(axes)]
        return sparse.bmat(rows, format="csc")

    def bounds(self, mass: Array) -> tuple[Array, Array]:
        """Bounds (node,) of squares of frequencies, 1/s^2, and of rates of decay, 1/s, that springs and dampers make.

        Sums of the rows of M^-1 K: a spring of the stiffness k is felt at a node by k |p| times the sum of all |p|.
        """
        P = abs(self.parts(mass.size))
        whole = np.asarray(P.sum(axis=1)).ravel()
        light = np.divide(1.0, mass, out=np.zeros_like(mass), where=mass > 0.0)
        square, rate = (light * (P.T @ (k.max(axis=1) * whole)) for k in (self.k, self.c))
        return np.asarray(square), np.asarray(rate)

    @property
    def damped(self) -> bool:
        """Whether any tie is."""
        return bool(self.c.any())


def _of(pair: Array, longer: Array) -> Array:
    """Those of ties that are longer, or shorter."""
    return np.where(longer > 0.0, pair[:, 0], pair[:, 1])


@dataclass(frozen=True)
class Point:
    """A point of a run of links."""

    first: int  # first node of the run
    links: int
    h: float  # m, length of a link
    at: float  # links along the run
    tension: float  # N, at rest
    bending: float  # N m^2
    axial: float = 0.0  # N, EA

    @cached_property
    def parts(self) -> tuple[Integers, Array]:
        """Nodes that share it, and their parts."""
        weight, slope = np.zeros(WIDTH), np.zeros(WIDTH)
        base = self.first + share(self.at, self.links, weight, slope)
        used = np.flatnonzero(weight)
        return base + used, weight[used]

    def yields(self, whole: float) -> float:
        """By how much it is further than its spline for each N, m/N: `whole` is T + EI/h^2, or EA along the line."""
        bending, out = self.bending / self.h**2, np.zeros(4)
        if whole <= 0.0 or min(self.at, self.links - self.at) < _AT_NODE:  # nothing kinks at an end
            return 0.0
        root = np.sqrt(bending / (self.tension + bending)) if bending > 0.0 else 0.0
        compliance(self.at, self.links, root, compliances(), out)
        return float(self.h / whole * out[0])

    @property
    def yields_across(self) -> float:
        """The same across the line."""
        return self.yields(self.tension + self.bending / self.h**2)


@dataclass(frozen=True)
class MassNode:
    """A node between ties that is on no line."""

    node: int

    @property
    def parts(self) -> tuple[Integers, Array]:
        """The node, all of it."""
        return np.array([self.node]), np.ones(1)


@dataclass(frozen=True)
class Tie:
    """A tie to be: from a point of a line, or a mass, to another one, or to the ground."""

    one: Point | MassNode
    other: Point | MassNode | Array  # or (axis,) m
    length: float = 0.0  # m
    stiffness: tuple[float, float] = (0.0, 0.0)  # N/m, where it is longer and where it is shorter; inf: rigid
    damping: tuple[float, float] = (0.0, 0.0)
    preload: float = 0.0  # N
    way: Array | None = None  # (axis,)
    along: float = 0.0  # square of the cosine of its angle to the line
    apart: Array | None = None  # (axis,) m, how much farther away the other point is than its coordinates say

    def in_series(self, stiffness: float) -> float:
        """What is left of a stiffness beside what the ends give way, N/m."""
        if stiffness == 0.0:
            return 0.0
        points = [end for end in (self.one, self.other) if isinstance(end, Point)]
        soft = sum(self.along * end.yields(end.axial) + (1.0 - self.along) * end.yields_across for end in points)
        return 1.0 / max(1.0 / stiffness + soft, _YIELDS)


def ties_of(ties: Sequence[Tie], axes: int) -> Ties | None:
    """The arrays of ties; None: there are none."""
    if not ties:
        return None
    nodes, parts, ground, way = [], [], np.zeros((len(ties), axes)), np.zeros((len(ties), axes))
    for e, tie in enumerate(ties):
        node, part = tie.one.parts
        part = -part
        if isinstance(tie.other, Point | MassNode):
            more, other = tie.other.parts
            node, part = np.concatenate([node, more]), np.concatenate([part, other])
            ground[e] = 0.0 if tie.apart is None else tie.apart
        else:
            ground[e] = tie.other
        if tie.way is not None:
            way[e] = tie.way
        nodes.append(node)
        parts.append(part)
    count = np.array([node.size for node in nodes], dtype=np.int64)
    stiffness = np.array([[tie.in_series(k) for k in tie.stiffness] for tie in ties])
    return Ties(
        np.cumsum(count) - count, count, np.concatenate(nodes).astype(np.int64), np.concatenate(parts), ground, way,
        np.array([tie.length for tie in ties]), stiffness, np.array([tie.damping for tie in ties]),
        np.array([tie.preload for tie in ties]), np.zeros((len(ties), axes)), np.zeros(len(ties)),
    )  # fmt: skip


@inlined
def tie_up(ties):
    """Whether there are any: asked where a call would hand all arrays on."""
    if ties is None:
        return False
    return ties.first.size > 0


@lean_inner
def _look_at(ties, r, e):
    """Find the span of tie e, and by how much it is too long; returns its length, m."""
    square = along = 0.0
    for a in range(r.shape[0]):
        away = ties.ground[e, a]
        for i in range(ties.first[e], ties.first[e] + ties.size[e]):
            away += ties.part[i] * r[a, ties.node[i]]
        ties.span[e, a] = away
        square += away * away
        along += away * ties.way[e, a]
    turns = 0.0
    for a in range(r.shape[0]):
        turns += abs(ties.way[e, a])
    length = along if turns > 0.0 else np.sqrt(square)
    for a in range(r.shape[0]):
        ties.span[e, a] = ties.way[e, a] if turns > 0.0 else ties.span[e, a] / max(length, 1e-300)
    ties.longer[e] = length - ties.length[e]
    return length


@lean_inner
def add_tie_forces(ties, r, force):
    """Add the forces of the springs of all ties."""
    if ties is None:
        return
    for e in range(ties.first.size):
        _look_at(ties, r, e)
        side = 0 if ties.longer[e] > 0.0 else 1
        T = ties.preload[e] + ties.k[e, side] * ties.longer[e]
        if T != 0.0:
            for a in range(r.shape[0]):
                F = T * ties.span[e, a]
                for i in range(ties.first[e], ties.first[e] + ties.size[e]):
                    force[a, ties.node[i]] -= ties.part[i] * F


@lean_inner
def are_damped(ties):
    """Whether any tie is."""
    found = False
    if ties is None:
        return found
    for e in range(ties.first.size):
        found = found or ties.c[e, 0] > 0.0 or ties.c[e, 1] > 0.0
    return found


@lean_inner
def damp_ties(ties, v, force):
    """Add the forces of the dampers of all ties, which have been looked at; returns the power they take, W."""
    lost = 0.0
    if ties is None:
        return lost
    for e in range(ties.first.size):
        c = ties.c[e, 0 if ties.longer[e] > 0.0 else 1]
        if c == 0.0:
            continue
        rate = 0.0
        for a in range(v.shape[0]):
            for i in range(ties.first[e], ties.first[e] + ties.size[e]):
                rate += ties.part[i] * v[a, ties.node[i]] * ties.span[e, a]
        lost += c * rate * rate
        for a in range(v.shape[0]):
            for i in range(ties.first[e], ties.first[e] + ties.size[e]):
                force[a, ties.node[i]] -= ties.part[i] * c * rate * ties.span[e, a]
    return lost


@lean_inner
def stored_in_ties(ties, r):
    """Energy of all ties, J."""
    total = 0.0
    if ties is None:
        return total
    for e in range(ties.first.size):
        length = _look_at(ties, r, e)
        k = ties.k[e, 0 if ties.longer[e] > 0.0 else 1]
        total += 0.5 * k * ties.longer[e] ** 2 + ties.preload[e] * length
    return total
