"""Potential energy of a structure at rest, without loads, as `solve/minimum.py` wants it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import lean
from ropewalk.solve import minimum
from ropewalk.solve.symmetric import Way
from ropewalk.system.cables import ARC, SHORT_ARC, energy_of, pull_all, stretch_all
from ropewalk.system.compliance import SMOOTH
from ropewalk.system.structure import Room, Structure


@lean
def _energy(structure, room, r):
    stretch_all(structure.runs, room, r)
    return energy_of(structure, room, r)


@lean
def _forces(structure, room, r):
    stretch_all(structure.runs, room, r)
    pull_all(structure, room, r, 0.0)


class Potential:
    """Potential energy of a structure as a function of the places of its nodes, (axis, node)."""

    is_symmetric = True

    def __init__(self, structure: Structure, axes: int, size: float) -> None:
        self.structure, self.axes, self.size = structure, axes, size
        self.room = Room.of(structure, axes)
        held, n = structure.holdings, structure.nodes.mass.size
        moves = np.ones(n, dtype=np.bool_)
        moves[held.node] = False
        whole = np.flatnonzero(np.tile(moves, axes))
        columns = [(np.array([i]), np.ones(1)) for i in whole]
        for e in range(held.mass.size):
            nodes = held.node[held.first[e] : held.first[e] + held.nodes[e]]
            values, ways = np.linalg.eigh(held.free[e])
            for way in ways.T[values > 0.5]:
                at = (nodes[None, :] + n * np.arange(axes)[:, None]).ravel()
                columns.append((at, np.repeat(way, nodes.size)))
        row, column, value = (
            np.concatenate(parts)
            for parts in zip(*((at, np.full(at.size, j), v) for j, (at, v) in enumerate(columns)), strict=True)
        )
        self.free = sparse.csc_matrix((value, (row, column)), shape=(axes * n, len(columns)))
        self._one, self._two, self._weight = self._operators()
        self._three = self._one @ self._two  # links are between second differences as between nodes

    def _operators(self) -> tuple[sparse.csr_matrix, sparse.csr_matrix, Array]:
        """Links and second differences (node, node), and weights of the bending energy of these."""
        runs, n = self.structure.runs, self.structure.nodes.mass.size
        one, two = (sparse.lil_matrix((n, n)) for _ in range(2))
        weight = np.ones(n)
        for first, links, clamped in zip(runs.first, runs.links, runs.clamped, strict=True):
            for i in range(first, first + links):
                one[i, i], one[i, i + 1] = -1.0, 1.0
            for i in range(first + 1, first + links):
                two[i, i - 1], two[i, i], two[i, i + 1] = 1.0, -2.0, 1.0
            for side, (e, i) in enumerate(((first, first + 1), (first + links, first + links - 1))):
                weight[e] = 0.5
                if clamped[side]:
                    two[e, e], two[e, i] = -2.0, 2.0
        return one.tocsr(), two.tocsr(), weight

    def energy(self, r: Array) -> float:
        """Potential energy, J."""
        held, total = self.structure.holdings, float(_energy(self.structure, self.room, r))
        total -= float((self.structure.nodes.force * r).sum())
        for e in range(held.mass.size):
            here = r[:, held.node[held.first[e]]]
            away = here - self._place(e)
            total += 0.5 * float(away @ held.stiffness[e] @ away) - float(held.force[e] @ here)
        return total

    def _place(self, e: int) -> Array:
        held = self.structure.holdings
        part = slice(int(held.table[e]), int(held.table[e] + held.entries[e]))
        moved = [np.interp(0.0, held.time[part], row[part]) for row in held.moved]
        return np.asarray(held.place[e] + moved)

    def forces(self, r: Array) -> Array:
        """Forces on all nodes (axis, node), N, those of springs of supports included."""
        self.room.force[:] = self.structure.nodes.force
        _forces(self.structure, self.room, r)
        held, out = self.structure.holdings, self.room.force.copy()
        for e in range(held.mass.size):
            node = held.node[held.first[e]]
            out[:, node] += held.force[e] + held.stiffness[e] @ (self._place(e) - r[:, node])
        return out

    def out_of_balance(self, r: Array) -> Array:
        return np.asarray(self.free.T @ self.forces(r).ravel())

    def stiffness(self, r: Array) -> sparse.csc_matrix:
        """Second derivatives of the energy, (unknown, unknown) N/m."""
        runs, n, axes = self.structure.runs, self.structure.nodes.mass.size, self.axes
        self.room.force[:] = self.structure.nodes.force
        _forces(self.structure, self.room, r)
        tension, strain = self.room.tension.copy(), self.room.strain.copy()
        h, slope, EI, bed = np.ones(n), np.zeros(n), np.zeros(n), np.zeros(n)
        for s, (first, links) in enumerate(zip(runs.first, runs.links, strict=True)):
            part = slice(first, first + links)
            h[part] = runs.h[s]
            slope[part] = law.tangents(runs.law[s], strain[part])
            EI[first : first + links + 1] = runs.bending[s] / runs.h[s] ** 3
            bed[first : first + links + 1] = runs.bed[s] * runs.h[s]
            bed[[first, first + links]] *= 0.5
            tension[first + links] = 0.0
            h[first + links] = runs.h[s]
        D = self.room.bent.copy()
        length = self.room.length.copy()
        length[runs.first + runs.links] = 1.0
        q = tension / length
        pair = sparse.diags([np.ones(n), np.ones(n - 1)], [0, 1])
        rows = [
            sparse.diags(self._one @ r[a]) @ self._one
            + 2.0 * ARC * pair @ sparse.diags(D[a]) @ self._two
            + sparse.diags(2.0 * SHORT_ARC * (self._one @ D[a])) @ self._three
            for a in range(axes)
        ]
        rise = sparse.diags((slope / h - q) / length**2)  # change of T/l with l^2/2
        across = self._one.T @ sparse.diags(q) @ self._one
        arcs = 2.0 * ARC * (q + np.concatenate([[0.0], q[:-1]]))
        bent = self._two.T @ sparse.diags(arcs + EI * self._weight) @ self._two
        bent = bent + self._three.T @ sparse.diags(SMOOTH * EI + 2.0 * SHORT_ARC * q) @ self._three
        blocks = [[rows[a].T @ rise @ rows[b] for b in range(axes)] for a in range(axes)]
        for a in range(axes):
            blocks[a][a] = blocks[a][a] + across + bent
        blocks[-1][-1] = blocks[-1][-1] + sparse.diags(bed)
        K = sparse.bmat(blocks, format="lil")
        held = self.structure.holdings
        for e in np.flatnonzero(held.stiffness.any(axis=(1, 2))):
            at = held.node[held.first[e]] + n * np.arange(axes)
            K[np.ix_(at, at)] += held.stiffness[e]
        return (self.free.T @ K.tocsc() @ self.free).tocsc()

    def pattern(self, r: Array) -> sparse.csc_matrix:
        K = self.stiffness(r)
        return abs(K)

    def stability(self, r: Array) -> tuple[sparse.csc_matrix, Integers]:
        K = self.stiffness(r)
        return K, np.arange(K.shape[0])

    def moved(self, r: Array, step: Array) -> Array:
        return np.asarray(r + (self.free @ step).reshape(r.shape))

    def arrived(self, r: Array) -> tuple[Array, bool]:
        return r, False

    def approaches(self, start: Array, way: Way) -> Iterator[Array]:
        return iter(())


def settle(structure: Structure, start: Array) -> Array:
    """Places of all nodes at rest next to a shape (axis, node), m.

    Raises:
        EquilibriumError: no rest was found.
    """
    potential = Potential(structure, start.shape[0], float(np.ptp(start, axis=1).max()))
    return minimum.settle(potential, start)


def at_rest(structure: Structure, gravity: Array, start: Array) -> tuple[Structure, Array]:
    """A structure with the loads on its links shared among nodes as at rest, and the places of all nodes there.

    Where a run ends free to turn, its point reflection takes the load on it for one that jumps to its opposite there.
    Arcs and bending, right to the fourth order, see that jump two nodes further: with the load w on a link, the rows of
    the first nodes are (1 + 2/12) w, (1 - 1/24) w under tension and (1 + 1/18) w, (1 + 1/72) w in bending for the shape
    of a constant load. They get as much of what the end node would bear.

    Args:
        structure: with each node bearing half of the links beside it.
        gravity: (axis,) m/s^2.
        start: (axis, node) m, about where its nodes rest.

    Raises:
        EquilibriumError: no rest was found.
    """
    rest, runs = settle(structure, start), structure.runs
    held = structure.holdings
    fast = {
        int(node) for e in range(held.mass.size) if not held.free[e].any()
        for node in held.node[held.first[e] : held.first[e] + held.nodes[e]]
    }  # fmt: skip
    T, shift, force = tensions(structure, rest), np.zeros_like(runs.shift), structure.nodes.force.copy()
    for s, (first, links, h) in enumerate(zip(runs.first, runs.links, runs.h, strict=True)):
        for side, (end, way, link) in enumerate(((first, 1, first), (first + links, -1, first + links - 1))):
            bending = runs.bending[s] / h**2
            whole = max(T[link], 0.0) + bending
            if runs.clamped[s, side] or whole == 0.0:
                continue
            zeta = bending / whole
            parts = np.array([(1.0 - zeta) / 6.0 + zeta / 18.0, (zeta - 1.0) / 24.0 + zeta / 72.0])
            for part, node in zip((-parts.sum(), *parts), (0, 1, 2), strict=True):
                force[:, end + way * node] += part * runs.rho[s] * h * gravity
            if end in fast:  # elsewhere the inertia of links acts as the wind does, and is lumped
                shift[s, side] = parts
    shared = structure._replace(runs=runs._replace(shift=shift), nodes=structure.nodes._replace(force=force))
    return shared, settle(shared, rest)


def tensions(structure: Structure, r: Array) -> Array:
    """Tensions of all links, each by its first node, at places of the nodes (axis, node) in m; N."""
    room = Room.of(structure, r.shape[0])
    _forces(structure, room, r)
    return room.tension
