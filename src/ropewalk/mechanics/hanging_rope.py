"""Ropes that hang freely from a carriage to a station, at rest: elastic catenaries.

The rope pulls at the carriage with n = (H, V), H level towards the station and V upwards, and V grows by w along each
metre of it. Its end is at

    l = H L/EA + H/w [asinh(v/H)],   h = (V + w L/2) L/EA + [T]/w,   v = V ... V + w L,  T^2 = H^2 + v^2

(Irvine, Cable Structures): the gradient of a convex function of n, so that there is one solution, to which Newton's
method with a line search comes. A rope whose tension is given at its far end, and that does not stretch, is
z = a cosh(x/a) with T = w z.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import lean, lean_inner

# Where Newton's method ends: gap over the length of the rope, and rounds.
_CLOSE, _ROUNDS = 1e-13, 50


@lean_inner
def _gap(l, h, L, w, EA, H, V):
    """By how much the end of a rope misses its place, level and upwards, m."""
    U = V + w * L
    T, S = np.hypot(H, V), np.hypot(H, U)
    x = H * L / EA + H / w * (np.arcsinh(U / H) - np.arcsinh(V / H)) - l
    return x, (V + 0.5 * w * L) * L / EA + L * (U + V) / (S + T) - h


@lean_inner
def hang(l, h, L, w, EA, H, V):
    """Pull (H, V) in N at one end of a rope whose other end is l > 0 away and h higher, m.

    Args:
        l: m, level.
        h: m, upwards.
        L: m, its unstrained length.
        w: N/m, its weight per unstrained length, not 0.
        EA: N.
        H: N, about the result; 0: nothing is known.
        V: N, the same.
    """
    if H <= 0.0:
        c = np.hypot(l, h)
        H = w * l * np.sqrt(c / (24.0 * max(L - c, 1e-6 * c))) + EA * max(c / L - 1.0, 0.0)
        V = H * h / l - 0.5 * w * L
    x, z = _gap(l, h, L, w, EA, H, V)
    for _ in range(_ROUNDS):
        miss = np.hypot(x, z)
        if miss <= _CLOSE * L:
            break
        U = V + w * L
        T, S = np.hypot(H, V), np.hypot(H, U)
        A, B = (np.arcsinh(U / H) - np.arcsinh(V / H)) / w, (U / S - V / T) / w
        a, b, c = L / EA + A - B, H / w * (1.0 / S - 1.0 / T), L / EA + B
        D = a * c - b * b
        more, up, part = (b * z - c * x) / D, (b * x - a * z) / D, 1.0
        while part > 1e-6:
            if H + part * more > 0.1 * H:
                p, q = _gap(l, h, L, w, EA, H + part * more, V + part * up)
                if np.hypot(p, q) < miss:
                    break
            part *= 0.5
        if part <= 1e-6:  # as close as rounding lets it come
            break
        H, V, x, z = H + part * more, V + part * up, p, q
    return H, V


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
def hang_entry(l, h, L, w, EA, H, V):
    """`hang` as Python calls it."""
    return hang(l, h, L, w, EA, H, V)


@lean
def hang_by_tension_entry(l, h, T, w):
    """`hang_by_tension` as Python calls it."""
    return hang_by_tension(l, h, T, w)
