"""Ropes that hang freely from a carriage to a station where their tension is given: z = a cosh(x/a) with T = w z."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import lean, lean_inner

# Where Newton's method ends: part of the slope, and rounds.
_CLOSE, _ROUNDS = 1e-13, 50


@lean_inner
def hang_by_tension(l, h, T, w):
    """Pull (H, V) in N at one end of a rope whose other end is l > 0 away and h higher, where it is kept at T in N.

    The taut one of the two ropes that there are; it does not stretch, w in N/m.
    """
    c = np.hypot(l, h)
    H = T * l / c
    if w <= 0.0:
        return H, T * h / c
    p, y = w * l / T, 1.0 - w * h / T
    u = np.arcsinh(-h / l - 0.5 * w * l / H)  # slope at the far end, seen from there
    for _ in range(_ROUNDS):
        A = p * np.cosh(u)
        away = np.cosh(u + A) / np.cosh(u) - y
        step = away * np.cosh(u) ** 2 / (np.sinh(A) + p * np.sinh(u) * np.cosh(u) * np.sinh(u + A))
        u -= step
        if abs(step) < _CLOSE:
            break
    H = T / np.cosh(u)
    return H, -H * np.sinh(u + p * np.cosh(u))


@lean
def hang_by_tension_entry(l, h, T, w):
    """`hang_by_tension` as Python calls it."""
    return hang_by_tension(l, h, T, w)
