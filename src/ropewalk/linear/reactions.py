"""Support forces of a line in the linear theory: the static ones of all loads, and what the motion adds.

The slope at a hinged end times the tension, plus the shear EI w''', is the support force. Both are discontinuous below
a point force, so nodes near it do not show them. The static deflection under the same loads has the same
discontinuities and known support forces; the rest of the deflection is smooth, and its sine series converges fast.
Along the chord a line does not stretch: its supports share the forces there as those of a uniform bar.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from ropewalk.linear.chord import Chord
from ropewalk.mechanics.chain import Array

_TERMS = 8  # of the static series for each element: the neglected ones change a support force by 4e-4 of the load


def reactions(chord: Chord, gravity: Array, moved: Array, rate: Array, place: Array, force: Array) -> Array:
    """Return the forces of both supports on the line, (instant, end, axis) N.

    Args:
        gravity: (axis,) m/s^2.
        moved, rate: (instant, node, axis) m from rest and m/s, at nodes at equal distances.
        place: (instant, load) m along the chord, NaN off the line.
        force: (instant, load, axis) N, of the loads on the line.
    """
    L, on, across = chord.length, np.isfinite(place), np.eye(chord.along.size) - np.outer(chord.along, chord.along)
    x, P = np.where(on, place, 0.0), np.where(on[..., None], force, 0.0)
    out = -np.einsum("etj,tja->tea", np.stack([1.0 - x / L, x / L]), P) - 0.5 * chord.mass * L * gravity
    out += np.outer([-1.0, 1.0], chord.tension * chord.along)
    n = moved.shape[1] - 1
    if chord.is_string:
        h = L / n
        near = np.stack([np.minimum(y, h) * (L - np.maximum(y, h)) for y in (x, L - x)]) / (L * chord.tension)
        static = np.einsum("etj,tja->tea", near, P @ across)
        return np.asarray(out - chord.tension / h * (moved[:, [1, -2]] - static))
    m = np.arange(1, _TERMS * n)
    k, sign = m * np.pi / L, np.where(m % 2 == 1, 1.0, -1.0)
    elastic, ends = chord.bending_stiffness * k**4 + chord.tension * k**2, np.stack([1.0 / k, sign / k], axis=1)
    follows = pressed(x, P @ across, k) * (2.0 / L) / (elastic + chord.foundation)
    sag = np.outer(across @ gravity, (1.0 + sign) * 2.0 * chord.mass / (L * k * (elastic + chord.foundation)))
    out += ((follows + sag) @ (chord.foundation * ends)).swapaxes(1, 2)
    shape = np.sin(np.outer(k, np.arange(1, n) * (L / n)))
    felt = moved[:, 1:-1] + chord.retardation * rate[:, 1:-1]
    other = (felt.swapaxes(1, 2) - follows @ shape) @ (2.0 / n * shape[: n - 1].T)
    return np.asarray(out - (other @ (elastic[:, None] * ends)[: n - 1]).swapaxes(1, 2))


def pressed(x: Array, force: Array, k: Array) -> Array:
    """(instant, axis, term) N, the sum of the forces times the sines at their places."""
    i, j = np.nonzero(force.any(axis=2))
    sines, rows = np.sin(np.outer(x[i, j], k)), (i, np.arange(i.size))
    size = x.shape[0], i.size
    parts = [sparse.csr_matrix((force[i, j, a], rows), shape=size) @ sines for a in range(force.shape[2])]
    return np.stack(parts, axis=1)
