"""Links: how strongly each pulls, from positions (and velocities, where the line is damped).

Axes: x first, z last, and y between them in space. `space` is None in the plane: the compiler drops what depends on
it, so that plane and space share one formula and the plane pays nothing for the third axis. Each loop writes one array
only: with more, the compiler gives up proving that they do not overlap, and the loop is not vectorised.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import kernel, summing
from ropewalk.mechanics.law import CUBIC


@kernel
def _pull(p, h, i0, i1, r, q, space):
    x, z, out = r[0, i0 : i1 + 1], r[-1, i0 : i1 + 1], q[i0:i1]
    if space is not None:
        y = r[1, i0 : i1 + 1]
    floor, c1, c2, c3 = p[1], p[2], p[3], p[4]
    inverse = 1.0 / h
    for i in range(i1 - i0):
        dx, dz = x[i + 1] - x[i], z[i + 1] - z[i]
        square = dx * dx + dz * dz
        if space is not None:
            dy = y[i + 1] - y[i]
            square += dy * dy
        length = np.sqrt(square)
        e = max(length * inverse - 1.0, floor)
        out[i] = e * (c1 + e * (c2 + e * c3)) / length


@summing
def _pull_damped(p, c, h, i0, i1, r, w, q, space):
    """The same with the Kelvin-Voigt force c eps_t; returns the sum of eps_t^2 over the links."""
    x, z, u, v, out = r[0, i0 : i1 + 1], r[-1, i0 : i1 + 1], w[0, i0 : i1 + 1], w[-1, i0 : i1 + 1], q[i0:i1]
    if space is not None:
        y, s = r[1, i0 : i1 + 1], w[1, i0 : i1 + 1]
    floor, c1, c2, c3 = p[1], p[2], p[3], p[4]
    inverse = 1.0 / h
    total = 0.0
    for i in range(i1 - i0):
        dx, dz = x[i + 1] - x[i], z[i + 1] - z[i]
        square, along = dx * dx + dz * dz, dx * (u[i + 1] - u[i]) + dz * (v[i + 1] - v[i])
        if space is not None:
            dy = y[i + 1] - y[i]
            square += dy * dy
            along += dy * (s[i + 1] - s[i])
        length = np.sqrt(square)
        per_length = 1.0 / length
        rate = along * per_length * inverse
        total += rate * rate
        e = max(length * inverse - 1.0, floor)
        out[i] = (e * (c1 + e * (c2 + e * c3)) + c * rate) * per_length
    return total


@kernel
def stretch(r, i):
    """Length of link i in m."""
    square = 0.0
    for a in range(r.shape[0]):
        d = r[a, i + 1] - r[a, i]
        square += d * d
    return np.sqrt(square)


@kernel
def stretch_rate(r, w, i):
    """Rate of the length of link i in m/s if its nodes move at w."""
    square, along = 0.0, 0.0
    for a in range(r.shape[0]):
        d = r[a, i + 1] - r[a, i]
        square += d * d
        along += d * (w[a, i + 1] - w[a, i])
    return along / np.sqrt(square)


@kernel
def pull_one(p, c, rest, rate, r, i):
    """Tension over length of the single link i of unstrained length `rest`, whose strain changes at `rate`."""
    length = stretch(r, i)
    return (law.tension(p, length / rest - 1.0) + c * rate) / length


@kernel
def pull(p, c, h, i0, i1, r, w, q):
    """Tension over length of the links i0 ... i1 - 1 of one strand, each of unstrained length h.

    Args:
        p: axial law, see law.py.
        c: Kelvin-Voigt damping in N s; with 0 the velocities are not looked at.
        r, w: positions and velocities (axis, node).
        q: (link,) N/m, overwritten.

    Returns:
        Sum of eps_t^2 over the links (0 without damping).
    """
    if p[0] != CUBIC:
        total = 0.0
        for i in range(i0, i1):
            rate = stretch_rate(r, w, i) / h if c > 0.0 else 0.0
            total += rate * rate
            q[i] = pull_one(p, c, h, rate, r, i)
        return total
    plane = r.shape[0] == 2
    if c > 0.0:
        if plane:
            return _pull_damped(p, c, h, i0, i1, r, w, q, None)
        return _pull_damped(p, c, h, i0, i1, r, w, q, True)
    if plane:
        _pull(p, h, i0, i1, r, q, None)
    else:
        _pull(p, h, i0, i1, r, q, True)
    return 0.0


@kernel
def pull_vectors(i0, i1, r, q, f):
    """Force vectors f (axis, link) of the links i0 ... i1 - 1 from their tension over length q."""
    for a in range(r.shape[0]):
        x, fx, qa = r[a, i0 : i1 + 1], f[a, i0:i1], q[i0:i1]
        for i in range(i1 - i0):
            fx[i] = qa[i] * (x[i + 1] - x[i])
