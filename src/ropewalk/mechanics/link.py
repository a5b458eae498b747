"""Links: how strongly each pulls, from positions (and velocities, where the line is damped).

Axes: x first, z last, and y between them in space. `space` is None in the plane: the compiler drops what depends on
it, so that plane and space share one formula and the plane pays nothing for the third axis. Each loop writes one array
only: with more, the compiler gives up proving that they do not overlap, and the loop is not vectorised.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import apart, inlined, lean, summing
from ropewalk.mechanics.law import CUBIC


@lean
def stretch(r, i):
    """Length of link i in m."""
    square = 0.0
    for a in range(r.shape[0]):
        d = r[a, i + 1] - r[a, i]
        square += d * d
    return np.sqrt(square)


@lean
def stretch_rate(r, w, i):
    """Rate of the length of link i in m/s if its nodes move at w."""
    square, along = 0.0, 0.0
    for a in range(r.shape[0]):
        d = r[a, i + 1] - r[a, i]
        square += d * d
        along += d * (w[a, i + 1] - w[a, i])
    return along / np.sqrt(square)


@summing
def _growth(i0, i1, r, w, space):
    x, z, u, v = r[0, i0 : i1 + 1], r[-1, i0 : i1 + 1], w[0, i0 : i1 + 1], w[-1, i0 : i1 + 1]
    if space is not None:
        y, s = r[1, i0 : i1 + 1], w[1, i0 : i1 + 1]
    total = 0.0
    for i in range(i1 - i0):
        dx, dz = x[i + 1] - x[i], z[i + 1] - z[i]
        square, along = dx * dx + dz * dz, dx * (u[i + 1] - u[i]) + dz * (v[i + 1] - v[i])
        if space is not None:
            dy = y[i + 1] - y[i]
            square += dy * dy
            along += dy * (s[i + 1] - s[i])
        total += along / np.sqrt(square)
    return total


@lean
def growth(i0, i1, r, w):
    """Rate of the length of the links i0 ... i1 - 1 together in m/s if their nodes move at w."""
    return _growth(i0, i1, r, w, None) if r.shape[0] == 2 else _growth(i0, i1, r, w, True)


@lean
def upward(dx, dy, dz, x, y, z):
    """Component of a vector (x, y, z) along that normal of a link (dx, dy, dz) that points up, in its upright plane."""
    flat, ex, ey = np.sqrt(dx * dx + dy * dy), 1.0, 0.0
    if flat > 0.0:
        ex, ey = dx / flat, dy / flat
    return (flat * z - dz * (ex * x + ey * y)) / np.sqrt(dx * dx + dy * dy + dz * dz)


@lean
def link_force(p, c, rest, rate, r, i):
    """Tension over length of the single link i of unstrained length `rest`, whose strain changes at `rate`."""
    length = stretch(r, i)
    return (law.tension(p, length / rest - 1.0) + c * rate) / length


@lean
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
        return _each_link_force(p, c, h, i0, i1, r, w, q)
    _invert(i0, i1, r, q)
    return _known_link_forces(p, c, h, i0, i1, r, w, q, q)


@lean
def link_force_vectors(i0, i1, r, q, f):
    """Force vectors f (axis, link) of the links i0 ... i1 - 1 from their tension over length q."""
    for a in range(r.shape[0]):
        x, fx, qa = r[a, i0 : i1 + 1], f[a, i0:i1], q[i0:i1]
        for i in range(i1 - i0):
            fx[i] = qa[i] * (x[i + 1] - x[i])


# Sum of the fourth powers of the relative errors of a guess above which it is improved once more: an error of 1 % of
# one link, which the correction below brings to 1e-11.
_TOO_FAR, _TOO_FAR_PER_LINK = 1e-8, 1e-13


@lean
def _invert(i0, i1, r, per_length):
    for i in range(i0, i1):
        per_length[i] = 1.0 / stretch(r, i)


@inlined
def _is_hooke(p):
    """Whether a cubic law is a straight line for every length."""
    return p[1] < -1.0 and p[3] == 0.0 and p[4] == 0.0


@apart
def _go_over(p, c, h, x, y, z, u, s, v, known, fx, fy, fz, straight):
    """Force vectors of links of which guesses of 1 / length are known, which are improved.

    y (1 - e)^(-1/2) with e = 1 - length^2 y^2 goes to the fourth power of e.

    Args:
        x, y, z: two times (link,) m, coordinates at the beginnings and the ends; y is None in the plane, and so is what
            belongs to it. (With one array of all nodes the compiler keeps each for the next link, which costs more.)
        u, s, v: two times (link,) m/s, velocities; None without damping.
        known: (link,) 1/m.
        fx, fy, fz: (link,) N, overwritten.
        straight: None, or that the law is Hooke's for every length, which needs no strain.

    Returns:
        The sum of e^4 over the links, and that of eps_t^2 (0 without damping).
    """
    floor, c1, c2, c3, inverse = p[1], p[2], p[3], p[4], 1.0 / h
    slack, missed, total = c1 * inverse, 0.0, 0.0
    for i in range(known.size):
        dx, dz, guess = x[1][i] - x[0][i], z[1][i] - z[0][i], known[i]
        square = dx * dx + dz * dz
        if y is not None:
            dy = y[1][i] - y[0][i]
            square += dy * dy
        e = 1.0 - square * guess * guess
        per_length = guess + guess * e * (0.5 + e * (0.375 + e * (0.3125 + e * 0.2734375)))
        missed += e * e * e * e
        known[i] = per_length
        if straight is not None:
            q = slack - c1 * per_length
        else:
            eps = max(square * per_length * inverse - 1.0, floor)
            q = eps * (c1 + eps * (c2 + eps * c3)) * per_length
        if u is not None:
            along = dx * (u[1][i] - u[0][i]) + dz * (v[1][i] - v[0][i])
            if y is not None:
                along += dy * (s[1][i] - s[0][i])
            rate = along * per_length * inverse
            total += rate * rate
            q += c * rate * per_length
        fx[i], fz[i] = q * dx, q * dz
        if y is not None:
            fy[i] = q * dy
    return missed, total


@inlined
def _both(r, a, i0, i1):
    """Row a at the beginnings and at the ends of the links i0 ... i1 - 1."""
    return r[a, i0:i1], r[a, i0 + 1 : i1 + 1]


@inlined
def _go_over_rows(p, c, h, i0, i1, r, w, per_length, f, straight):
    """`_go_over` the links i0 ... i1 - 1."""
    x, z, u, v = _both(r, 0, i0, i1), _both(r, -1, i0, i1), _both(w, 0, i0, i1), _both(w, -1, i0, i1)
    known, fx, fz = per_length[i0:i1], f[0, i0:i1], f[-1, i0:i1]
    if r.shape[0] == 2:
        if c > 0.0:
            return _go_over(p, c, h, x, None, z, u, None, v, known, fx, None, fz, straight)
        return _go_over(p, c, h, x, None, z, None, None, None, known, fx, None, fz, straight)
    y, s, fy = _both(r, 1, i0, i1), _both(w, 1, i0, i1), f[1, i0:i1]
    if c > 0.0:
        return _go_over(p, c, h, x, y, z, u, s, v, known, fx, fy, fz, straight)
    return _go_over(p, c, h, x, y, z, None, None, None, known, fx, fy, fz, straight)


@lean
def _undamped_link_forces(p, h, i0, i1, r, per_length, q, space):
    """Tension over length of undamped links whose 1 / length is known."""
    known, out = per_length[i0:i1], q[i0:i1]
    inverse = 1.0 / h
    if _is_hooke(p):  # no strain is needed
        for i in range(i1 - i0):
            out[i] = p[2] * (inverse - known[i])
        return
    floor, c1, c2, c3 = p[1], p[2], p[3], p[4]
    x, z = r[0, i0 : i1 + 1], r[-1, i0 : i1 + 1]
    if space is not None:
        y = r[1, i0 : i1 + 1]
    for i in range(i1 - i0):
        dx, dz = x[i + 1] - x[i], z[i + 1] - z[i]
        square = dx * dx + dz * dz
        if space is not None:
            dy = y[i + 1] - y[i]
            square += dy * dy
        e = max(square * known[i] * inverse - 1.0, floor)
        out[i] = e * (c1 + e * (c2 + e * c3)) * known[i]


@summing
def _damped_link_forces(p, c, h, i0, i1, r, w, per_length, q, space):
    """The same with the Kelvin-Voigt force c eps_t; returns the sum of eps_t^2 over the links."""
    x, z, u, v = r[0, i0 : i1 + 1], r[-1, i0 : i1 + 1], w[0, i0 : i1 + 1], w[-1, i0 : i1 + 1]
    known, out = per_length[i0:i1], q[i0:i1]
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
        rate = along * known[i] * inverse
        total += rate * rate
        e = max(square * known[i] * inverse - 1.0, floor)
        out[i] = (e * (c1 + e * (c2 + e * c3)) + c * rate) * known[i]
    return total


@lean
def _known_link_forces(p, c, h, i0, i1, r, w, per_length, q):
    """Tension over length of links whose 1 / length is known (it may stand in q); returns the sum of eps_t^2."""
    if r.shape[0] == 2:
        if c > 0.0:
            return _damped_link_forces(p, c, h, i0, i1, r, w, per_length, q, None)
        _undamped_link_forces(p, h, i0, i1, r, per_length, q, None)
    else:
        if c > 0.0:
            return _damped_link_forces(p, c, h, i0, i1, r, w, per_length, q, True)
        _undamped_link_forces(p, h, i0, i1, r, per_length, q, True)
    return 0.0


@lean
def _each_link_force(p, c, h, i0, i1, r, w, q):
    """Tension over length link by link, for laws that are no cubic; returns the sum of eps_t^2."""
    total = 0.0
    for i in range(i0, i1):
        rate = stretch_rate(r, w, i) / h if c > 0.0 else 0.0
        total += rate * rate
        q[i] = link_force(p, c, h, rate, r, i)
    return total


@lean
def add_link_forces_again(p, c, h, i0, i1, r, w, per_length, q, f):
    """Force vectors f (axis, link), as of `pull` and `link_force_vectors`, in a loop over time: lengths change little.

    A square root and a division cost more than all the rest of a link. The inverse length of the last call, improved
    by a series, saves both; where a link has changed by more than 1 %, the series is applied again.

    Args:
        per_length: (link,) 1/m, inverse lengths of the last call (zeros at first); overwritten with the present ones.
        q: (link,) N/m, may be overwritten.

    Returns:
        Sum of eps_t^2 over the links (0 without damping).
    """
    if p[0] != CUBIC:
        total = _each_link_force(p, c, h, i0, i1, r, w, q)
        link_force_vectors(i0, i1, r, q, f)
        return total
    near, total = _TOO_FAR + _TOO_FAR_PER_LINK * (i1 - i0), 0.0
    for _ in range(5):
        if _is_hooke(p):
            missed, total = _go_over_rows(p, c, h, i0, i1, r, w, per_length, f, True)
        else:
            missed, total = _go_over_rows(p, c, h, i0, i1, r, w, per_length, f, None)
        if missed < near:
            break
        if not missed < 1e-2:  # an error of 30 % of one link, or not a number
            _invert(i0, i1, r, per_length)
    return total
