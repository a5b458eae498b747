"""Cells of nets and membranes to the first order about rest: forces linear in how far corners are from there.

    f = f(rest) - K (r - rest) - C v,   V = V(rest) - f(rest) (r - rest) + 1/2 (r - rest) K (r - rest),

with the tangent stiffness K and the dampers C of each cell as it rests. A thread or a sheet that is slack there stays
without stiffness, and one that is taut pushes where it would be slack.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.compiled import lean_inner
from ropewalk.system.elements.cells import Cells
from ropewalk.system.elements.membrane_elements import tensions_of

_PART = 1e-4  # of the side of the smallest cell, over which tensions are differenced


class CellsAboutRest(NamedTuple):
    """What cells are about rest; corners axis by axis, one after the other. No entries: they have all geometry."""

    place: Array  # (cell, 9) m
    force: Array  # (cell, 9) N, on the corners
    stiffness: Array  # (cell, 9, 9) N/m
    damping: Array  # (cell, 9, 9) N s/m
    stored: Array  # (cell,) J
    away: Array  # (9,) room

    @staticmethod
    def nothing() -> CellsAboutRest:
        """Of cells that move with all geometry."""
        x, K = np.zeros((0, 9)), np.zeros((0, 9, 9))
        return CellsAboutRest(x, x, K, K, np.zeros(0), np.zeros(9))


@lean_inner
def _gather(about, cells, e, r):
    """Put how far corners of cell e are from rest into `away`."""
    for n in range(9):
        about.away[n] = r[n % 3, cells.node[e, n // 3]] - about.place[e, n]


@lean_inner
def add_forces_about_rest(about, cells, r, force):
    """Add the elastic forces of all cells, with places and forces as (axis, node)."""
    for e in range(cells.area.size):
        _gather(about, cells, e, r)
        for m in range(9):
            f = about.force[e, m]
            for n in range(9):
                f -= about.stiffness[e, m, n] * about.away[n]
            force[m % 3, cells.node[e, m // 3]] += f


@lean_inner
def damp_about_rest(about, cells, v, force):
    """Add the forces of the dampers of all cells; returns the power they take, W."""
    lost = 0.0
    for e in range(cells.area.size):
        for n in range(9):
            about.away[n] = v[n % 3, cells.node[e, n // 3]]
        for m in range(9):
            f = 0.0
            for n in range(9):
                f += about.damping[e, m, n] * about.away[n]
            lost += f * about.away[m]
            force[m % 3, cells.node[e, m // 3]] -= f
    return lost


@lean_inner
def stored_about_rest(about, cells, r):
    """Energy stored in all cells to the second order, J."""
    total = 0.0
    for e in range(cells.area.size):
        _gather(about, cells, e, r)
        total += about.stored[e]
        for m in range(9):
            f = -about.force[e, m]
            for n in range(9):
                f += 0.5 * about.stiffness[e, m, n] * about.away[n]
            total += f * about.away[m]
    return total


def tensions_about_rest(cells: Cells, count: int, rest: Array, r: Array) -> Array:
    """Tensions per width (cell, 2) of the first cells to the first order about rest, N/m; places as (axis, node)."""
    found, x = tensions_of(cells, count, rest.T), r - rest
    size = float(np.abs(x).max(initial=0.0))
    if size == 0.0:
        return found
    part = _PART * float(np.sqrt(cells.area.min())) / size
    ahead, behind = (tensions_of(cells, count, (rest + sign * part * x).T) for sign in (1.0, -1.0))
    return np.asarray(found + (ahead - behind) / (2.0 * part))
