"""Beams over several spans: closed forms, and the motion of two spans under a moving force by their exact modes.

Sources: Clapeyron's equation of three moments; Mueller-Breslau's principle; and the dynamic equation of three moments
of spans that vibrate (Timoshenko and Young, Vibration problems in engineering).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

Array = NDArray[np.float64]
MASS, EI = 50.0, 2e6  # kg/m, N m^2
SPANS = [(8.0, 12.0), (8.0, 12.0, 10.0)]


def three_moments(spans: tuple[float, ...], weight: float) -> Array:
    """Support forces under an even weight, from M' l' + 2 M (l' + l) + M'' l = -w (l'^3 + l^3) / 4."""
    own = np.array(spans)
    pairs = own[:-1] + own[1:]
    system = np.diag(2.0 * pairs) + np.diag(own[1:-1], 1) + np.diag(own[1:-1], -1)
    moments = np.linalg.solve(system, -0.25 * weight * (own[:-1] ** 3 + own[1:] ** 3))
    slope = np.diff([0.0, *moments, 0.0]) / own  # shear forces that the moments make
    left, right = 0.5 * weight * own + slope, 0.5 * weight * own - slope
    shares: Array = np.append(left, 0.0) + np.append(0.0, right)
    return shares


def sunk(x: Any, at: Any, whole: float) -> Any:
    """Deflection at x of a beam on its two ends under a unit load, m/N."""
    a, b = np.minimum(x, at), whole - np.maximum(x, at)
    return a * b * (whole**2 - a**2 - b**2) / (6.0 * EI * whole)


def influence(spans: tuple[float, ...], x: Array, stiffness: float = np.inf) -> Array:
    """Forces of the inner supports under a unit load at x, (place, support): what closes their gaps."""
    at, whole = np.cumsum(spans)[:-1], sum(spans)
    flexible = sunk(at[:, None], at, whole) + np.eye(at.size) / stiffness
    return np.linalg.solve(flexible, sunk(at[:, None], x, whole)).T


def over_unlike_spans(spans: tuple[float, ...], count: int) -> Array:
    """Frequencies from the moments M over the supports of vibrating spans, rad/s.

    With p = b l, f(p) = coth p - cot p and g(p) = 1 / sinh p - 1 / sin p: g(p') M' + (f(p') + f(p)) M + g(p) M'' = 0.
    """
    own = np.array(spans)

    def determinant(b: float) -> float:
        p = b * own
        f, g = 1.0 / np.tanh(p) - 1.0 / np.tan(p), 1.0 / np.sinh(p) - 1.0 / np.sin(p)
        system = np.diag(f[:-1] + f[1:]) + np.diag(g[1:-1], 1) + np.diag(g[1:-1], -1)
        return float(np.linalg.det(system) * np.prod(np.sin(p)))  # poles are taken away

    b = np.linspace(0.05, 1.0, 4001)
    signs = np.sign([determinant(v) for v in b])
    found = [brentq(determinant, b[i], b[i + 1]) for i in np.flatnonzero(signs[:-1] != signs[1:])]
    return np.square(found)[:count] * np.sqrt(EI / MASS)


def mode_of_two_spans(b: float, one: float, two: float, x: Any) -> Array:
    """Shape of a mode of two spans, sin b u - sin bl sinh b u / sinh bl on each, u from its outer end."""

    def within(u: Array, span: float) -> Array:
        return np.asarray(np.sin(b * u) - np.sin(b * span) * np.sinh(b * u) / np.sinh(b * span))

    def slope(span: float) -> float:
        return float(np.cos(b * span) - np.sin(b * span) / np.tanh(b * span))

    far = np.clip(one + two - x, 0.0, two)
    shape = np.where(x < one, within(np.clip(x, 0.0, one), one), -slope(one) / slope(two) * within(far, two))
    return np.asarray(np.where((x >= 0.0) & (x <= one + two), shape, 0.0))


def wave_numbers(spans: tuple[float, float], count: int) -> Array:
    """Those of the modes of two spans, 1/m."""
    one, two = spans

    def determinant(b: Any) -> Any:
        p, q = b * one, b * two
        return np.sin(p) * np.sin(q) * (1.0 / np.tanh(p) + 1.0 / np.tanh(q)) - np.sin(p + q)

    grid = np.linspace(0.5, 1.1 * (count + 2), 40 * count) * np.pi / (one + two)
    signs = np.sign(determinant(grid))
    found = [brentq(determinant, grid[i], grid[i + 1]) for i in np.flatnonzero(signs[:-1] != signs[1:])]
    return np.array(found[:count])


def under_a_moving_force(spans: tuple[float, float], speed: float, x: Array, times: Array, count: int = 100) -> Array:
    """Deflections (time, place) in m/N of two spans at rest that a unit force crosses from the start.

    Superposition of modes whose forces are linear between instants; what modes are left out is of the part count^-3.
    """
    one, two = spans
    whole, b = one + two, wave_numbers(spans, count)
    omega = b**2 * np.sqrt(EI / MASS)
    along, t = np.linspace(0.0, whole, 20001), np.linspace(0.0, times[-1], 20001)
    modal = np.array([MASS * np.trapezoid(mode_of_two_spans(k, one, two, along) ** 2, along) for k in b])
    force = np.array([mode_of_two_spans(k, one, two, speed * t) for k in b]) / modal[:, None]
    dt = float(t[1])
    q, rate, c, s = np.zeros_like(force), np.zeros(b.size), np.cos(omega * dt), np.sin(omega * dt)
    for i in range(t.size - 1):
        before, rise = force[:, i], (force[:, i + 1] - force[:, i]) / dt
        u, v = q[:, i] - before / omega**2, (rate - rise / omega**2) / omega
        q[:, i + 1] = u * c + v * s + force[:, i + 1] / omega**2
        rate = omega * (v * c - u * s) + rise / omega**2
    at_times = np.array([np.interp(times, t, row) for row in q])
    return np.asarray(at_times.T @ np.array([mode_of_two_spans(k, one, two, x) for k in b]))
