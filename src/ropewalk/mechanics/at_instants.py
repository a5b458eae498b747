"""Given forces and speeds, and stored energies, at many instants in one call."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import kernel
from ropewalk.mechanics.law import stored_total
from ropewalk.mechanics.moving_contact import force_at, speed_at


@kernel
def forces_at(loads, k, times, axes):
    """Given forces of load k at times in s, (instant, axis) N."""
    out = np.empty((times.size, axes))
    for i in range(times.size):
        for a in range(axes):
            out[i, a] = force_at(loads, k, times[i], a)
    return out


@kernel
def speeds_at(loads, k, times):
    """Speeds of load k at times in s, as measured, (instant,) m/s."""
    out = np.empty(times.size)
    for i in range(times.size):
        out[i] = speed_at(loads, k, times[i])
    return out


@kernel
def stored_totals(p, eps, rest):
    """Stored energies of links with strains and unstrained lengths in m, (instant, link), at each instant, J."""
    out = np.empty(eps.shape[0])
    for i in range(eps.shape[0]):
        out[i] = stored_total(p, eps[i], rest[i])
    return out
