"""Distances of nodes, and forces along them."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import inlined


@inlined
def distance(r, i, j):
    """Distance of two nodes, m."""
    x, y, z = r[j, 0] - r[i, 0], r[j, 1] - r[i, 1], r[j, 2] - r[i, 2]
    return np.sqrt(x * x + y * y + z * z)


@inlined
def add_bead_forces(r, i, j, q, f):
    """Let nodes i and j attract each other by q times their distance."""
    for a in range(3):
        pull = q * (r[j, a] - r[i, a])
        f[i, a] += pull
        f[j, a] -= pull
