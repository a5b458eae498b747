"""Nets and membranes, and the ways of loads on them.

Cells pull at the nodes of the structure (`membrane_elements.py`). A way is a run without mass and
stiffness whose nodes are laid on the cells,

    r(way) = A r,   f = A^T f(way),

with the barycentric coordinates A of each place. Loads travel on the spline through them as on any line. A point force
on a membrane has no finite deflection; a spline hands a force over to the cells within a few links of a way, which are
as long as cells are wide: that is the patch on which a load stands, and what is under it moves by the mean of that.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import lean, lean_inner
from ropewalk.system.elements.cells import Cells
from ropewalk.system.elements.elements_about_rest import (
    ElementsAboutRest,
    add_forces_about_rest,
    damp_about_rest,
    gathered,
    is_little,
    stored_about_rest,
)
from ropewalk.system.elements.membrane_elements import (
    add_membrane_forces,
    cell_stiffness,
    damp_cells,
    stored,
    tensions_of,
)

_PART = 1e-4  # of the side of the smallest cell, over which tensions are differenced


class Surfaces(NamedTuple):
    """Cells, and the nodes of ways that are laid on them."""

    cells: Cells
    node: Integers  # (laid,) nodes of ways
    first: Integers  # (laid,) where the corners below each begin
    size: Integers  # how many
    corner: Integers  # (share,) nodes of cells
    part: Array  # (share,) barycentric coordinates
    damped: bool
    F: Array  # (3, 2) room
    P: Array
    V: Array
    about: ElementsAboutRest = ElementsAboutRest.nothing()

    @staticmethod
    def of(cells: Cells, laid: list[tuple[int, Integers, Array]]) -> Surfaces:
        """Of cells and of nodes of ways, each with the nodes below it and its coordinates there."""
        count = np.array([corner.size for _, corner, _ in laid], dtype=np.int64)
        none = np.zeros(0, dtype=np.int64)
        return Surfaces(
            cells, np.array([node for node, *_ in laid], dtype=np.int64), np.cumsum(count) - count, count,
            np.concatenate([none, *(corner for _, corner, _ in laid)]).astype(np.int64),
            np.concatenate([np.zeros(0), *(part for *_, part in laid)]), bool(cells.fabrics[:, 3:5].any()),
            np.zeros((3, 2)), np.zeros((3, 2)), np.zeros((3, 2)),
        )  # fmt: skip

    @staticmethod
    def nothing() -> Surfaces:
        """Of lines alone."""
        i = np.zeros((0, 3), dtype=np.int64)
        cells = Cells(i, np.zeros((0, 4)), np.zeros(0), np.zeros(0, dtype=np.int64), np.zeros((0, 7)))
        return Surfaces.of(cells, [])

    def shares(self, nodes: int) -> sparse.csr_matrix:
        """The matrix A of all nodes, (node, node); rows of those that are not laid are empty."""
        row = np.repeat(self.node, self.size)
        return sparse.coo_matrix((self.part, (row, self.corner)), shape=(nodes, nodes)).tocsr()

    def stiffness(self, r: Array) -> sparse.csc_matrix:
        """Stiffness of all cells at places r (axis, node) in m, (place, place) N/m; linearised: at rest."""
        return self._gathered(self.about.stiffness if self.is_linearised else self._stiffness(r), r.shape[1])

    def _stiffness(self, r: Array) -> Array:
        """The same of each cell, (cell, 9, 9)."""
        K = np.zeros((self.cells.area.size, 9, 9))
        _stiffness(self.cells, r, K, self.F, np.zeros((4, 4)))
        return 0.5 * (K + K.transpose(0, 2, 1))

    def damping(self, r: Array) -> sparse.csc_matrix:
        """Damping of all cells, (place, place) N s/m; forces are linear in the velocities of their corners."""
        return self._gathered(self.about.damping if self.is_linearised else self._damping(r), r.shape[1])

    def _damping(self, r: Array) -> Array:
        """The same of each cell, (cell, 9, 9)."""
        C = np.zeros((self.cells.area.size, 9, 9))
        _damping(self.cells, r, np.zeros_like(r), np.zeros_like(r), C, self.F, self.P, self.V)
        return C

    @property
    def is_linearised(self) -> bool:
        """Whether cells are linearised about rest."""
        return self.about.are_there

    def about_rest(self, rest: Array) -> Surfaces:
        """The same, linearised about places of all nodes at rest (axis, node) in m."""
        count = self.cells.area.size
        force, energies = np.zeros((count, 9)), np.zeros(count)
        _at_rest(self.cells, rest, np.zeros_like(rest), force, energies, self.F, self.P)
        K, C = self._stiffness(rest), self._damping(rest)
        return self._replace(about=ElementsAboutRest.of(self.cells.node, rest, force, K, C, energies))

    def neighbours(self, nodes: int) -> sparse.csc_matrix:
        """Ones where the stiffness may have entries, (place, place)."""
        return self._gathered(np.ones((self.cells.area.size, 9, 9)), nodes)

    def _gathered(self, values: Array, nodes: int) -> sparse.csc_matrix:
        """Matrices of all cells (cell, 9, 9), by corners and axes, as one of all places, (place, place)."""
        return gathered(self.cells.node, values, nodes, 3)


@lean
def _stiffness(cells, r, K, F, D):
    for e in range(cells.area.size):
        cell_stiffness(cells, e, r.T, K[e], F, D)


@lean
def _damping(cells, r, v, f, C, F, P, V):
    for e in range(cells.area.size):
        for m in range(9):
            for n in range(9):
                f[n % 3, cells.node[e, n // 3]] = 0.0
            v[m % 3, cells.node[e, m // 3]] = 1.0
            damp_cells(cells, e, e + 1, r.T, v.T, f.T, F, P, V)
            v[m % 3, cells.node[e, m // 3]] = 0.0
            for n in range(9):
                C[e, n, m] = -f[n % 3, cells.node[e, n // 3]]


@lean
def _at_rest(cells, r, f, force, energies, F, P):
    """Forces (cell, 9) of each cell on its corners, and its energy (cell,)."""
    for e in range(cells.area.size):
        for n in range(9):
            f[n % 3, cells.node[e, n // 3]] = 0.0
        add_membrane_forces(cells, e, e + 1, r.T, f.T, F, P)
        for n in range(9):
            force[e, n] = f[n % 3, cells.node[e, n // 3]]
        energies[e] = stored(cells, e, r.T, F)


@lean_inner
def follow(surfaces, r, v):
    """Put the nodes of ways where the cells below them are."""
    if surfaces is None:
        return
    for i in range(surfaces.node.size):
        n = surfaces.node[i]
        for a in range(r.shape[0]):
            r[a, n] = v[a, n] = 0.0
            for j in range(surfaces.first[i], surfaces.first[i] + surfaces.size[i]):
                r[a, n] += surfaces.part[j] * r[a, surfaces.corner[j]]
                v[a, n] += surfaces.part[j] * v[a, surfaces.corner[j]]


@lean_inner
def distribute_forces(surfaces, force):
    """Let cells bear what acts on the nodes of ways."""
    if surfaces is None:
        return
    for i in range(surfaces.node.size):
        n = surfaces.node[i]
        for a in range(force.shape[0]):
            for j in range(surfaces.first[i], surfaces.first[i] + surfaces.size[i]):
                force[a, surfaces.corner[j]] += surfaces.part[j] * force[a, n]
            force[a, n] = 0.0


@lean_inner
def add_surface_forces(surfaces, r, force):
    """Add the elastic forces of all cells."""
    if surfaces is None:
        return
    cells = surfaces.cells
    if is_little(surfaces.about):
        add_forces_about_rest(surfaces.about, r, force)
    else:
        add_membrane_forces(cells, 0, cells.area.size, r.T, force.T, surfaces.F, surfaces.P)


@lean_inner
def damp_surfaces(surfaces, r, v, force):
    """Add the Kelvin-Voigt forces of all cells; returns the power they take, W."""
    if surfaces is None:
        return 0.0
    cells = surfaces.cells
    if is_little(surfaces.about):
        return damp_about_rest(surfaces.about, v, force)
    return damp_cells(cells, 0, cells.area.size, r.T, v.T, force.T, surfaces.F, surfaces.P, surfaces.V)


@lean_inner
def is_damped(surfaces):
    """Whether any cell is."""
    if surfaces is None:
        return False
    return surfaces.damped


@lean_inner
def stored_in(surfaces, r):
    """Energy stored in all cells, J."""
    if surfaces is None:
        return 0.0
    if is_little(surfaces.about):
        return stored_about_rest(surfaces.about, r)
    total = 0.0
    for e in range(surfaces.cells.area.size):
        total += stored(surfaces.cells, e, r.T, surfaces.F)
    return total


def tensions_about_rest(cells: Cells, count: int, rest: Array, r: Array) -> Array:
    """Tensions per width (instant, cell, 2) of the first cells to the first order about rest, N/m.

    Args:
        cells: they.
        count: how many of them.
        rest: (axis, node) m.
        r: (instant, axis, node) m.
    """
    x = r - rest
    size = np.abs(x).max(axis=(1, 2), initial=0.0)
    part = _PART * np.sqrt(cells.area.min()) / np.where(size > 0.0, size, 1.0)
    step = part[:, None, None]
    ahead, behind = (tensions_of(cells, count, rest + sign * step * x) for sign in (1.0, -1.0))
    return np.asarray(tensions_of(cells, count, rest[None]) + (ahead - behind) / (2.0 * step))
