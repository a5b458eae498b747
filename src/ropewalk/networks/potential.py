"""Potential energy of a network at rest, its forces and its stiffness, with contacts as further nodes."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.mechanics.compiled import lean, lean_inner
from ropewalk.networks.contact_location import energy_of_segments
from ropewalk.networks.geometry import distance
from ropewalk.networks.internal_forces import add_link_forces, add_soft_edge_forces, link_stiffness
from ropewalk.networks.membrane_elements import cell_stiffness
from ropewalk.networks.membrane_elements import stored as stored_in_cell
from ropewalk.networks.network import OFF, Array, Network
from ropewalk.networks.sheaves import add_sheave_forces, sheave_energy

# Step for the stiffness of sheaves by central differences, as a part of the link: 1e-5 leaves an error of 1e-10.
_NUDGE = 1e-5


@lean
def _stored(network, r, F):
    """Energy stored in links, cells, springs and at sheaves, J."""
    links, restrained, sheaves = network.links, network.restrained, network.sheaves
    total = energy_of_segments(network, r)
    for e in range(network.cells.area.size):
        total += stored_in_cell(network.cells, e, r, F)
    for k in range(restrained.spring.size):
        n = restrained.spring[k]
        for a in range(3):
            for b in range(3):
                total += (
                    0.5
                    * (r[n, a] - restrained.place[k, a])
                    * restrained.stiffness[k, a, b]
                    * (r[n, b] - restrained.place[k, b])
                )
    for k in range(sheaves.node.size):
        e, b = sheaves.link[k], sheaves.node[k]
        l1, l2 = distance(r, links.one[e], b), distance(r, b, links.other[e])
        total += sheave_energy(links.laws[links.law[e]], l1, l2, links.rest[e], sheaves.ahead[k])
    return total


@lean
def add_internal_forces(network, r, f, F, P):
    """Conservative forces f (node, 3) of everything, slots included, N."""
    add_soft_edge_forces(network, r, f, F, P)
    add_link_forces(network.links, network.own_links, network.links.on.size, r, f)


@lean_inner
def _put(rows, columns, values, at, i, j, value):
    rows[at], columns[at], values[at] = i, j, value
    return at + 1


@lean
def _assemble(network, r, ahead, rows, columns, values, f, K, F, D):
    """Entries of the stiffness; returns their number."""
    links, cells, restrained, sheaves = network.links, network.cells, network.restrained, network.sheaves
    at = 0
    for p in range(links.on.size):
        if links.on[p] == 0:
            continue
        link_stiffness(links, p, r, K)
        i, j = 3 * links.one[p], 3 * links.other[p]
        for a in range(3):
            for b in range(3):
                at = _put(rows, columns, values, at, i + a, i + b, K[a, b])
                at = _put(rows, columns, values, at, j + a, j + b, K[a, b])
                at = _put(rows, columns, values, at, i + a, j + b, -K[a, b])
                at = _put(rows, columns, values, at, j + a, i + b, -K[a, b])
    for e in range(cells.area.size):
        cell_stiffness(cells, e, r, K, F, D)
        for m in range(9):
            for n in range(9):
                i, j = 3 * cells.node[e, m // 3] + m % 3, 3 * cells.node[e, n // 3] + n % 3
                at = _put(rows, columns, values, at, i, j, K[m, n])
    for k in range(restrained.spring.size):
        n = 3 * restrained.spring[k]
        for a in range(3):
            for b in range(3):
                at = _put(rows, columns, values, at, n + a, n + b, restrained.stiffness[k, a, b])
    for k in range(sheaves.node.size):
        e = sheaves.link[k]
        nudge = _NUDGE * links.rest[e]
        for m in range(9):
            i = _of_sheave(links, sheaves, k, m // 3)
            start = r[i, m % 3]
            for side in range(2):
                for n in range(3):
                    for b in range(3):
                        f[_of_sheave(links, sheaves, k, n), b] = 0.0
                r[i, m % 3] = start + (nudge if side == 0 else -nudge)
                sheaves.ahead[k] = ahead[k]
                add_sheave_forces(links, sheaves, r, f)
                for n in range(9):
                    change = f[_of_sheave(links, sheaves, k, n // 3), n % 3]
                    K[n, m] = change if side == 0 else (change - K[n, m]) / (2.0 * nudge)
            r[i, m % 3] = start
        sheaves.ahead[k] = ahead[k]
        for m in range(9):
            for n in range(9):
                i = 3 * _of_sheave(links, sheaves, k, m // 3) + m % 3
                at = _put(rows, columns, values, at, i, 3 * _of_sheave(links, sheaves, k, n // 3) + n % 3, K[m, n])
    return at


@lean_inner
def _of_sheave(links, sheaves, k, which):
    e = sheaves.link[k]
    if which == 1:
        return sheaves.node[k]
    return links.one[e] if which == 0 else links.other[e]


class NetworkPotential:
    """Potential energy of a network and its contacts as they stand, as a function of all places (node, 3).

    Args:
        network: whose contacts have been located and stand on slots.
        rubs: whether lines rub at sheaves, from the slip where they are; else they slip freely.
    """

    def __init__(self, network: Network, *, rubs: bool = False) -> None:
        self.network = network
        self._ahead, self._friction = network.sheaves.ahead.copy(), network.sheaves.friction.copy()
        self.rubs = rubs and bool(self._friction.any())
        n = network.body.mass.size
        self._F, self._P = np.zeros((3, 2)), np.zeros((3, 2))
        self._K, self._D, self._f = np.zeros((9, 9)), np.zeros((4, 4)), np.zeros((n, 3))
        self._count = 0
        self.given = network.body.force.copy()
        loaded = np.ones(n, dtype=np.bool_)
        loaded[network.nodes :] = network.locations.kind != OFF
        self.given[network.nodes :] += network.locations.load + network.locations.mass[:, None] * network.gravity
        self.given[~loaded] = 0.0
        self._loaded = loaded

    @cached_property
    def _entries(self) -> tuple[Any, Any, Array]:
        """Room for rows, columns and values of the stiffness: only who asks for it needs them."""
        network = self.network
        most = (
            36 * network.links.on.size
            + 81 * (network.cells.area.size + network.sheaves.node.size)
            + 9 * network.restrained.spring.size
        )
        return np.zeros(most, dtype=np.int64), np.zeros(most, dtype=np.int64), np.zeros(most)

    @cached_property
    def free(self) -> sparse.csc_matrix:
        """Matrix from the unknowns to the components of all places."""
        restrained, n = self.network.restrained, self._loaded.size
        moves = self._loaded.copy()
        moves[restrained.fixed] = False
        moves[restrained.rail] = False
        whole = np.flatnonzero(np.repeat(moves, 3))
        rows = np.concatenate([whole, (3 * restrained.rail[:, None] + np.arange(3)).ravel()])
        columns = np.concatenate([np.arange(whole.size), whole.size + np.repeat(np.arange(restrained.rail.size), 3)])
        values = np.concatenate([np.ones(whole.size), restrained.along.ravel()])
        return sparse.csc_matrix((values, (rows, columns)), shape=(3 * n, whole.size + restrained.rail.size))

    def in_plane(self) -> NDArray[np.bool_]:
        """Which of the unknowns leave nothing out of the x-z plane."""
        return np.asarray(abs(self.free[1::3]).sum(axis=0) == 0.0).ravel()

    def _rub(self) -> None:
        sheaves = self.network.sheaves
        sheaves.ahead[:] = self._ahead
        if not self.rubs:
            sheaves.friction[:] = 0.0

    def _done(self) -> None:
        self.network.sheaves.friction[:] = self._friction

    def settle_slip(self) -> None:
        """From now on lines slip at sheaves from where they are."""
        self._ahead[:] = self.network.sheaves.ahead

    def energy(self, r: Array) -> float:
        """Potential energy, J; where lines rub, of the slip as it is."""
        self.pull(r)
        return float(_stored(self.network, r, self._F) - (self.given * r).sum())

    def stored(self, r: Array) -> float:
        """Energy stored, J, with the slip as it is."""
        return float(_stored(self.network, r, self._F))

    def pull(self, r: Array) -> Array:
        """Forces on all nodes (node, 3), N, without those of what holds them; lines slip at sheaves."""
        self._rub()
        out = np.zeros_like(r)
        add_internal_forces(self.network, r, out, self._F, self._P)
        self._done()
        return out - self.network.body.force + self.given

    def out_of_balance(self, r: Array) -> Array:
        """Forces that belong to the unknowns, N."""
        return np.asarray(self.free.T @ self.pull(r).ravel())

    def pattern(self, r: Array) -> sparse.csc_matrix:
        """Where the stiffness of the unknowns may have entries, whatever the shape is."""
        self.stiffness(r)
        return self._gathered(np.ones(self._count), abs(self.free))

    def stiffness(self, r: Array) -> sparse.csc_matrix:
        """Stiffness of the unknowns, N/m."""
        self.pull(r)
        ahead = self._ahead.copy()
        self._rub()
        self._count = _assemble(
            self.network, r.copy(), ahead, *self._entries, self._f, self._K, self._F, self._D,
        )  # fmt: skip
        self._done()
        self.pull(r)
        return self._gathered(self._entries[2][: self._count], self.free)

    def _gathered(self, values: Array, free: sparse.csc_matrix) -> sparse.csc_matrix:
        n = free.shape[0]
        rows, columns, _ = self._entries
        entries = (values, (rows[: self._count], columns[: self._count]))
        return (free.T @ sparse.coo_matrix(entries, shape=(n, n)).tocsc() @ free).tocsc()
