"""Potential energy of a web at rest, its forces and its stiffness, with contacts as further nodes."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.mechanics.compiled import lean, lean_inner
from ropewalk.webs.fabric import cell_stiffness
from ropewalk.webs.fabric import stored as stored_in_cell
from ropewalk.webs.geometry import distance
from ropewalk.webs.pull import link_stiffness, pull_links, pull_softly
from ropewalk.webs.seats import energy_of_pieces
from ropewalk.webs.sheaves import pull_sheaves, sheave_energy
from ropewalk.webs.web import OFF, Array, Web

# Step for the stiffness of sheaves by central differences, as a part of the link: 1e-5 leaves an error of 1e-10.
_NUDGE = 1e-5


@lean
def _stored(web, r, F):
    """Energy stored in links, cells, springs and at sheaves, J."""
    links, held, sheaves = web.links, web.held, web.sheaves
    total = energy_of_pieces(web, r)
    for e in range(web.cells.area.size):
        total += stored_in_cell(web.cells, e, r, F)
    for k in range(held.spring.size):
        n = held.spring[k]
        for a in range(3):
            for b in range(3):
                total += 0.5 * (r[n, a] - held.place[k, a]) * held.stiffness[k, a, b] * (r[n, b] - held.place[k, b])
    for k in range(sheaves.node.size):
        e, b = sheaves.link[k], sheaves.node[k]
        l1, l2 = distance(r, links.one[e], b), distance(r, b, links.other[e])
        total += sheave_energy(links.laws[links.law[e]], l1, l2, links.rest[e], sheaves.ahead[k])
    return total


@lean
def pull_all(web, r, f, F, P):
    """Conservative forces f (node, 3) of everything, slots included, N."""
    pull_softly(web, r, f, F, P)
    pull_links(web.links, web.own_links, web.links.on.size, r, f)


@lean_inner
def _put(rows, columns, values, at, i, j, value):
    rows[at], columns[at], values[at] = i, j, value
    return at + 1


@lean
def _assemble(web, r, ahead, rows, columns, values, f, K, F, D):
    """Entries of the stiffness; returns their number."""
    links, cells, held, sheaves = web.links, web.cells, web.held, web.sheaves
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
    for k in range(held.spring.size):
        n = 3 * held.spring[k]
        for a in range(3):
            for b in range(3):
                at = _put(rows, columns, values, at, n + a, n + b, held.stiffness[k, a, b])
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
                pull_sheaves(links, sheaves, r, f)
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


class Potential:
    """Potential energy of a web and its contacts as they stand, as a function of all places (node, 3).

    Args:
        web: whose contacts have been seated and stand on slots.
        rubs: whether lines rub at sheaves, from the slip where they are; else they slip freely.
    """

    def __init__(self, web: Web, *, rubs: bool = False) -> None:
        self.web = web
        self._ahead, self._friction = web.sheaves.ahead.copy(), web.sheaves.friction.copy()
        self.rubs = rubs and bool(self._friction.any())
        n = web.body.mass.size
        self._F, self._P = np.zeros((3, 2)), np.zeros((3, 2))
        self._K, self._D, self._f = np.zeros((9, 9)), np.zeros((4, 4)), np.zeros((n, 3))
        self._count = 0
        self.given = web.body.force.copy()
        standing = np.ones(n, dtype=np.bool_)
        standing[web.nodes :] = web.seats.kind != OFF
        self.given[web.nodes :] += web.seats.load + web.seats.mass[:, None] * web.gravity
        self.given[~standing] = 0.0
        self._standing = standing

    @cached_property
    def _entries(self) -> tuple[Any, Any, Array]:
        """Room for rows, columns and values of the stiffness: only who asks for it needs them."""
        web = self.web
        most = 36 * web.links.on.size + 81 * (web.cells.area.size + web.sheaves.node.size) + 9 * web.held.spring.size
        return np.zeros(most, dtype=np.int64), np.zeros(most, dtype=np.int64), np.zeros(most)

    @cached_property
    def free(self) -> sparse.csc_matrix:
        """Matrix from the unknowns to the components of all places."""
        held, n = self.web.held, self._standing.size
        moves = self._standing.copy()
        moves[held.fixed] = False
        moves[held.rail] = False
        whole = np.flatnonzero(np.repeat(moves, 3))
        rows = np.concatenate([whole, (3 * held.rail[:, None] + np.arange(3)).ravel()])
        columns = np.concatenate([np.arange(whole.size), whole.size + np.repeat(np.arange(held.rail.size), 3)])
        values = np.concatenate([np.ones(whole.size), held.along.ravel()])
        return sparse.csc_matrix((values, (rows, columns)), shape=(3 * n, whole.size + held.rail.size))

    def in_plane(self) -> NDArray[np.bool_]:
        """Which of the unknowns leave nothing out of the x-z plane."""
        return np.asarray(abs(self.free[1::3]).sum(axis=0) == 0.0).ravel()

    def _rub(self) -> None:
        sheaves = self.web.sheaves
        sheaves.ahead[:] = self._ahead
        if not self.rubs:
            sheaves.friction[:] = 0.0

    def _done(self) -> None:
        self.web.sheaves.friction[:] = self._friction

    def settle_slip(self) -> None:
        """From now on lines slip at sheaves from where they are."""
        self._ahead[:] = self.web.sheaves.ahead

    def energy(self, r: Array) -> float:
        """Potential energy, J; where lines rub, of the slip as it is."""
        self.pull(r)
        return float(_stored(self.web, r, self._F) - (self.given * r).sum())

    def stored(self, r: Array) -> float:
        """Energy stored, J, with the slip as it is."""
        return float(_stored(self.web, r, self._F))

    def pull(self, r: Array) -> Array:
        """Forces on all nodes (node, 3), N, without those of what holds them; lines slip at sheaves."""
        self._rub()
        out = np.zeros_like(r)
        pull_all(self.web, r, out, self._F, self._P)
        self._done()
        return out - self.web.body.force + self.given

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
            self.web, r.copy(), ahead, *self._entries, self._f, self._K, self._F, self._D,
        )  # fmt: skip
        self._done()
        self.pull(r)
        return self._gathered(self._entries[2][: self._count], self.free)

    def _gathered(self, values: Array, free: sparse.csc_matrix) -> sparse.csc_matrix:
        n = free.shape[0]
        rows, columns, _ = self._entries
        entries = (values, (rows[: self._count], columns[: self._count]))
        return (free.T @ sparse.coo_matrix(entries, shape=(n, n)).tocsc() @ free).tocsc()
