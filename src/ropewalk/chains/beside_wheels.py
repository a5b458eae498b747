"""The pieces of line beside wheels that have a place of their own, at many instants at once.

A wheel stands within a link, which it divides, or in the place of a node. Only these links are looked at here: whole
ones are those of lines without wheels (`frames.py`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.chains.many_bodies import ManyBodies
from ropewalk.mechanics.at_instants import stored_totals
from ropewalk.mechanics.bodies import INSIDE, LOCATED
from ropewalk.mechanics.chain import Array, Integers, Strands
from ropewalk.mechanics.law import tensions

BEHIND, AHEAD = 0, 1


class Points(NamedTuple):
    """Points of lines, and how they move."""

    X: Array  # (point,) m
    r: Array  # (point, axis) m
    v: Array  # (point, axis) m/s
    U: Array  # (point,) m/s, d X / dt

    def where(self, is_other: NDArray[np.bool_], others: Points) -> Points:
        """Others in the place of some of them."""
        chosen = is_other[:, None]
        return Points(
            np.where(is_other, others.X, self.X), np.where(chosen, others.r, self.r),
            np.where(chosen, others.v, self.v), np.where(is_other, others.U, self.U),
        )  # fmt: skip

    def at(self, rows: Integers) -> Points:
        """Some of them."""
        return Points(*(array[rows] for array in self))


class Pulls(NamedTuple):
    """Straight pieces of line between two points each."""

    strain: Array  # (piece,)
    pull: Array  # (piece,) N
    vector: Array  # (piece, axis) N
    tangent: Array  # (piece, axis) r'
    energy: Array  # (piece,) J

    @staticmethod
    def between(strands: Strands, strand: Integers, one: Points, other: Points) -> Pulls:
        """Pieces of some strands."""
        d, rest = other.r - one.r, other.X - one.X
        square, along = np.zeros(rest.size), np.zeros(rest.size)
        for a in range(d.shape[1]):
            square += d[:, a] * d[:, a]
            along += d[:, a] * (other.v[:, a] - one.v[:, a])
        length = np.sqrt(square)
        strain = length / rest - 1.0
        rate = (along / length - (other.U - one.U) * length / rest) / rest
        pull, energy = np.zeros(rest.size), np.zeros(rest.size)
        for s in np.unique(strand).tolist():
            own = strand == s
            pull[own] = tensions(strands.law[s], strain[own]) + strands.damping[s] * rate[own]
            energy[own] = stored_totals(strands.law[s], strain[own, None], rest[own, None])
        return Pulls(strain, pull, pull[:, None] * d / length[:, None], d / rest[:, None], energy)


class ManyNodes(NamedTuple):
    """All nodes at some instants, as `Points`."""

    X: Array  # (instant, node) m
    r: Array  # (instant, axis, node) m
    v: Array  # (instant, axis, node) m/s
    U: Array  # (instant, node) m/s

    def at(self, row: Integers, b: Integers) -> Points:
        """Some of them."""
        return Points(self.X[row, b], self.r[row, :, b], self.v[row, :, b], self.U[row, b])

    def place(self, bodies: ManyBodies, speed: Array) -> None:
        """Let those that wheels carry move as these, whose speeds along the lines are (instant, wheel) m/s."""
        for k in range(bodies.phase.shape[1]):
            rows, b = bodies.are(LOCATED, k)
            self.U[rows, b], self.v[rows, :, b] = speed[rows, k], bodies.v[rows, k]


@dataclass(frozen=True)
class SplitLinks:
    """The links that wheels divide: one entry for each wheel, in the order of instants and along the lines."""

    row: Integers  # (wheel,) its instant
    k: Integers  # its number
    link: Integers  # that it is inside of
    X: Array  # (wheel,) m
    is_first: NDArray[np.bool_]  # whether it is the first one in its link
    is_last: NDArray[np.bool_]
    sides: tuple[Pulls, Pulls]  # the pieces behind and ahead of each

    @staticmethod
    def of(
        strands: Strands, strand: Integers, xi: Array, speed: Array, nodes: ManyNodes, bodies: ManyBodies
    ) -> SplitLinks:
        """Look for them.

        Args:
            strands: the lines.
            strand: (wheel,) of each.
            xi, speed: (instant, wheel) m, m/s.
            nodes: of the lines.
            bodies: what stands on them.
        """
        inside = bodies.phase == INSIDE
        order = np.lexsort((xi, np.where(inside, bodies.at, nodes.X.shape[1])), axis=-1)  # those inside of links first
        row, place = np.nonzero(np.take_along_axis(inside, order, axis=1))
        k = order[row, place]
        link = bodies.at[row, k]
        wheels = Points(xi[row, k], bodies.r[row, k], bodies.v[row, k], speed[row, k])
        follows = np.zeros(row.size + 1, dtype=np.bool_)  # whether the wheel before is in the same link
        follows[1:-1] = (row[1:] == row[:-1]) & (link[1:] == link[:-1])
        number = np.arange(row.size)
        behind = nodes.at(row, link).where(follows[:-1], wheels.at(number - 1))
        ahead = nodes.at(row, link + 1).where(follows[1:], wheels.at((number + 1) % max(row.size, 1)))
        sides = Pulls.between(strands, strand[k], behind, wheels), Pulls.between(strands, strand[k], wheels, ahead)
        return SplitLinks(row, k, link, wheels.X, ~follows[:-1], ~follows[1:], sides)

    def put(self, strands: Strands, X: Array, eps: Array, T: Array, f: Array) -> None:
        """Write strains, tensions and force vectors of the links (instant, ..., link), whose nodes are at X.

        They are those in the middle, and at the first node; of a last link those at the support.
        """
        middle = 0.5 * (X[self.row, self.link] + X[self.row, self.link + 1])
        behind, ahead = self.sides
        last = np.isin(self.link, strands.first + strands.links - 1)
        before = np.concatenate([[-np.inf], self.X[:-1]])
        before[self.is_first] = -np.inf
        for piece, at_middle, at_node in (
            (behind, (before < middle) & (middle <= self.X), self.is_first & ~last),
            (ahead, self.is_last & (middle > self.X), self.is_last & last),
        ):
            row, link = self.row[at_middle], self.link[at_middle]
            eps[row, link], T[row, link] = piece.strain[at_middle], piece.pull[at_middle]
            f[self.row[at_node], :, self.link[at_node]] = piece.vector[at_node]

    def stored(self, count: int) -> Array:
        """Energies of all these links at each of some instants, (instant,) J."""
        behind, ahead = self.sides
        energy = behind.energy + np.where(self.is_last, ahead.energy, 0.0)
        return np.bincount(self.row, weights=energy, minlength=count).astype(np.float64)  # of nothing it is integers


@dataclass(frozen=True)
class BesideWheels:
    """What pulls at the wheels that have a place of their own on a line, on both sides of each."""

    pull: Array  # (instant, wheel, 2) N
    vector: Array  # (instant, wheel, axis, 2) N
    tangent: Array  # (instant, wheel, axis, 2) r'

    @staticmethod
    def of(split: SplitLinks, nodes: ManyNodes, T: Array, f: Array, bodies: ManyBodies) -> BesideWheels:
        """Look at them; tensions and force vectors of whole links are T (instant, link) and f (instant, axis, link)."""
        (count, wheels), dim = bodies.phase.shape, nodes.r.shape[1]
        beside = BesideWheels(np.full((count, wheels, 2), np.nan), *np.full((2, count, wheels, dim, 2), np.nan))
        for side, piece in enumerate(split.sides):
            beside._set(split.row, split.k, side, piece.pull, piece.vector, piece.tangent)
        ends = np.full((2, *T.shape), -1)  # the wheel whose piece lies at the first and the last node of a link
        for end, own in enumerate((split.is_first, split.is_last)):
            ends[end, split.row[own], split.link[own]] = np.flatnonzero(own)
        for k in range(wheels):
            rows, b = bodies.are(LOCATED, k)
            for side, link in ((BEHIND, b - 1), (AHEAD, b)):
                run = nodes.X[rows, link + 1] - nodes.X[rows, link]
                tangent = (nodes.r[rows, :, link + 1] - nodes.r[rows, :, link]) / run[:, None]
                beside._set(rows, k, side, T[rows, link], f[rows, :, link], tangent)
                own = ends[1 - side, rows, link]
                piece, cut, own = split.sides[1 - side], own >= 0, own[own >= 0]
                beside._set(rows[cut], k, side, piece.pull[own], piece.vector[own], piece.tangent[own])
        return beside

    def _set(self, row: Integers, k: Integers | int, side: int, pull: Array, vector: Array, tangent: Array) -> None:
        self.pull[row, k, side] = pull
        self.vector[row, k, :, side], self.tangent[row, k, :, side] = vector, tangent
