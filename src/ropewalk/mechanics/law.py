"""Axial laws as plain numbers: tension, tangent, stored energy and the strain for a tension.

A law is packed into one array of floats. Most laws are a cubic in the strain, cut off below a floor, which a
loop over links evaluates without a branch; longer series and tables take the general way.

    kind   p[1]        p[2:]
    CUBIC  floor       c1, c2, c3      T = e (c1 + e (c2 + e c3)),  e = max(eps, floor)
    SERIES n           c1 ... cn       T = c1 eps + ... + cn eps^n
    TABLE  n           eps_1 ... eps_n, T_1 ... T_n   (linear in between, end slopes beyond)
    RIGID  0           eps = 0 at any tension, which does not follow from the strain
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.compiled import kernel, lean

CUBIC, SERIES, TABLE, RIGID = 0, 1, 2, 3
NO_FLOOR = -1e300


@lean
def _segment(p, n, eps):
    """Index of the table's segment that holds eps (the first or last one beyond the ends)."""
    i = 0
    while i < n - 2 and eps > p[3 + i]:
        i += 1
    return i


@lean
def tension(p, eps):
    """Tension T(eps) in N; of a rigid law NaN, or zero where it is slack."""
    if p[0] == CUBIC:
        e = max(eps, p[1])
        return e * (p[2] + e * (p[3] + e * p[4]))
    return _other_tension(p, eps)  # apart, so that what is usual is short enough to be put into its callers


@lean
def _other_tension(p, eps):
    """Tension of a law that is no cubic."""
    if p[0] == RIGID:
        return 0.0 if eps < 0.0 else np.nan
    n = int(p[1])
    if p[0] == SERIES:
        total = 0.0
        for i in range(n - 1, -1, -1):
            total = (total + p[2 + i]) * eps
        return total
    i = _segment(p, n, eps)
    e0, e1, t0, t1 = p[2 + i], p[3 + i], p[2 + n + i], p[3 + n + i]
    return t0 + (t1 - t0) * (eps - e0) / (e1 - e0)


@kernel
def tangent(p, eps):
    """Slope dT/deps in N."""
    if p[0] == CUBIC:
        if eps <= p[1]:
            return 0.0
        return p[2] + eps * (2.0 * p[3] + eps * 3.0 * p[4])
    if p[0] == RIGID:
        return np.inf
    n = int(p[1])
    if p[0] == SERIES:
        total = 0.0
        for i in range(n - 1, -1, -1):
            total = total * eps + (i + 1) * p[2 + i]
        return total
    i = _segment(p, n, eps)
    return (p[3 + n + i] - p[2 + n + i]) / (p[3 + i] - p[2 + i])


@lean
def stored(p, eps):
    """Stored energy per unstrained length W(eps), the integral of T from 0, in N (= J/m)."""
    if p[0] == CUBIC:
        e = max(eps, p[1])
        return e * e * (p[2] / 2.0 + e * (p[3] / 3.0 + e * p[4] / 4.0))
    return _other_stored(p, eps)


@lean
def _other_stored(p, eps):
    """Stored energy per unstrained length of a law that is no cubic."""
    if p[0] == RIGID:
        return 0.0
    n = int(p[1])
    if p[0] == SERIES:
        total = 0.0
        for i in range(n - 1, -1, -1):
            total = (total + p[2 + i] / (i + 2)) * eps
        return total * eps
    # Trapezia from 0 to eps, segment by segment: exact, as the law is linear in each.
    sign = 1.0 if eps >= 0.0 else -1.0
    low, high = min(eps, 0.0), max(eps, 0.0)
    total = 0.0
    for i in range(n - 1):
        left = low if i == 0 else max(low, p[2 + i])
        right = high if i == n - 2 else min(high, p[3 + i])
        if right > left:
            total += 0.5 * (tension(p, left) + tension(p, right)) * (right - left)
    return sign * total


@kernel
def strain(p, force):
    """Strain at which the law gives the tension `force` >= 0 (the inverse law); NaN where there is none."""
    if p[0] == CUBIC and p[3] == 0.0 and p[4] == 0.0:
        return force / p[2]
    if p[0] == RIGID:
        return 0.0
    if p[0] == TABLE:
        n = int(p[1])
        i = 0
        while i < n - 2 and force > p[3 + n + i]:
            i += 1
        e0, e1, t0, t1 = p[2 + i], p[3 + i], p[2 + n + i], p[3 + n + i]
        return e1 if t1 == t0 else e0 + (e1 - e0) * (force - t0) / (t1 - t0)
    # A rising series: bracket the root, then Newton kept inside the bracket.
    low, high = 0.0, force / p[2] + 1e-300
    for _ in range(200):
        if tension(p, high) >= force:
            break
        high *= 2.0
    else:
        return np.nan
    eps = 0.5 * (low + high)
    for _ in range(200):
        gap = tension(p, eps) - force
        if gap > 0.0:
            high = eps
        else:
            low = eps
        slope = tangent(p, eps)
        new = eps - gap / slope if slope > 0.0 else 0.5 * (low + high)
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - eps) <= 1e-16 * (1.0 + abs(eps)):
            return new
        eps = new
    return eps


def pushing(p: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same law, continued into compression with its slope at the least strain at which there is one."""
    found = p.copy()
    if p[0] == CUBIC:
        found[1] = NO_FLOOR
    elif p[0] == TABLE:
        n = int(p[1])
        strain, force = p[2 : 2 + n], found[2 + n : 2 + 2 * n]
        flat = int(np.argmax(np.diff(force) > 0.0))  # entries before have the tension of this one
        slope = (force[flat + 1] - force[flat]) / (strain[flat + 1] - strain[flat])
        force[:flat] += slope * (strain[:flat] - strain[flat])
    return found


@kernel
def strains(p, force):
    """Strains for an array of tensions, each with a law of its own, p (tension, parameter)."""
    out = np.empty(force.size)
    for i in range(force.size):
        out[i] = strain(p[i], force[i])
    return out


@kernel
def tensions(p, eps):
    """Tensions for an array of strains."""
    out = np.empty(eps.size)
    for i in range(eps.size):
        out[i] = tension(p, eps[i])
    return out


@kernel
def tangents(p, eps):
    """Slopes dT/deps for an array of strains."""
    out = np.empty(eps.size)
    for i in range(eps.size):
        out[i] = tangent(p, eps[i])
    return out


@kernel
def stored_total(p, eps, rest):
    """Stored energy of links with strains eps and unstrained lengths rest, J."""
    total = 0.0
    for i in range(eps.size):
        total += stored(p, eps[i]) * rest[i]
    return total
