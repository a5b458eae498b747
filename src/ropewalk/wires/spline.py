"""Uniform cubic splines: which nodes, with which weights, make a point of a wire.

A cubic B-spline is smooth enough for a load to pass nodes without a trace, but as a curve through nodes it rounds: it
evaluates short waves too low by the part (k h)^2 / 6. So its control points are the nodes moved against their second
difference, c = r - (r[i-1] - 2 r[i] + r[i+1]) / 6, which leaves an error of the fourth order and takes six nodes.
Beyond an end the wire is continued by reflection through the end; beyond a clamped end of a beam of the fourth order by
the cubic through its first nodes that leaves the end level.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.compiled import kernel, lean_inner
from ropewalk.wires.plan import Array, Integers

WIDTH = 6
"""Nodes that share a point."""


@lean_inner
def weights(s, n, w):
    """Weights of the WIDTH nodes from the one that is returned: `weights_between` ends that turn."""
    return weights_between(s, n, False, False, w)


@lean_inner
def weights_between(s, n, start, end, w):
    """Weights of the WIDTH nodes from the one that is returned.

    Args:
        s: place in links from the start, 0 to n.
        n: number of links, at least WIDTH.
        start, end: whether the wire leaves these ends level, along a cubic, and not by reflection.
        w: (3, WIDTH) is filled in: for the value and its first two derivatives with respect to s.
    """
    cell = min(max(int(s), 0), n - 1)
    f = s - cell
    g = 1.0 - f
    _sharpen(w, 0, g * g * g / 6.0, (4.0 - 6.0 * f * f + 3.0 * f * f * f) / 6.0,
             (4.0 - 6.0 * g * g + 3.0 * g * g * g) / 6.0, f * f * f / 6.0)  # fmt: skip
    _sharpen(w, 1, -0.5 * g * g, -2.0 * f + 1.5 * f * f, 2.0 * g - 1.5 * g * g, 0.5 * f * f)
    _sharpen(w, 2, g, 3.0 * f - 2.0, 1.0 - 3.0 * f, f)
    base = cell - 2
    if base < 0:
        for d in range(3):
            for k in range(1, 1 - base):
                _continue(w, d, -base, -k, start)
            for j in range(WIDTH):
                w[d, j] = w[d, j - base] if j - base < WIDTH else 0.0
        return 0
    beyond = base + WIDTH - 1 - n
    if beyond > 0:
        last = WIDTH - 1 - beyond  # entry of node n
        for d in range(3):
            for k in range(1, beyond + 1):
                _continue(w, d, last, k, end)
            for j in range(WIDTH - 1, -1, -1):
                w[d, j] = w[d, j - beyond] if j >= beyond else 0.0
        return n + 1 - WIDTH
    return base


@lean_inner
def _continue(w, d, e, k, level):
    """Give the weight of node e + k, which is missing beyond node e at an end, to the nodes that say where it would be.

    By reflection r[k] = 2 r[0] - r[-k]; from a level end r[k] - r[0] is the cubic a x^2 + b x^3 through the next two.
    """
    more, side = w[d, e + k], 1 if k > 0 else -1
    if level:
        square = float(k * k)
        one, two = square * (2.0 + abs(k)), -0.25 * square * (1.0 + abs(k))
        w[d, e] += (1.0 - one - two) * more
        w[d, e - side] += one * more
        w[d, e - 2 * side] += two * more
    else:
        w[d, e] += 2.0 * more
        w[d, e - k] -= more


@lean_inner
def _sharpen(w, d, a, b, c, e):
    """Weights of six nodes from those of four control points."""
    w[d, 0], w[d, 1], w[d, 2] = -a / 6.0, (8.0 * a - b) / 6.0, (8.0 * b - a - c) / 6.0
    w[d, 3], w[d, 4], w[d, 5] = (8.0 * c - b - e) / 6.0, (8.0 * e - c) / 6.0, -e / 6.0


@kernel
def _fill(s, n, level, base, w):
    for k in range(s.size):
        base[k] = weights_between(s[k], n[k], level[k, 0], level[k, 1], w[k])


def points(s: Array, n: Integers, level: NDArray[np.bool_] | None = None) -> tuple[Integers, Array]:
    """First node and weights (point, derivative, WIDTH) of places s in links on wires of n links.

    Args:
        s: (point,).
        n: (point,).
        level: (point, 2) whether the wire leaves its start and its end level, see `weights_between`; None: neither.
    """
    base: Integers = np.zeros(s.size, dtype=np.int64)
    w: Array = np.zeros((s.size, 3, WIDTH))
    if s.size:
        level = np.zeros((s.size, 2), dtype=np.bool_) if level is None else np.ascontiguousarray(level)
        _fill(np.ascontiguousarray(s, dtype=np.float64), np.ascontiguousarray(n, dtype=np.int64), level, base, w)
    return base, w
