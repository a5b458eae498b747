"""Where a contact is on a run of links: a point of a quintic spline through the nodes, sharpened.

The spline is four times differentiable along the run, so that a load passes nodes without an event. Its control points
are c = r - D2 r / 4, which undoes to the fourth order of the mesh what a quintic B-spline smooths: 1 - (k h)^2 / 4 of a
wave k. Beyond an end the run is continued by its point reflection, c(-j) = 2 c(0) - c(j): the curve ends in the end
node, without curvature.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.compiled import lean, lean_inner

# Nodes that share a point, one after the other.
WIDTH = 8
SHARPENED = 0.25


def _within() -> NDArray[np.float64]:
    """Parts of the eight nodes about a link that is far from ends, as polynomials of the place in it: (power, node)."""
    basis = np.array([
        (1.0, -5.0, 10.0, -10.0, 5.0, -1.0),
        (26.0, -50.0, 20.0, 20.0, -20.0, 5.0),
        (66.0, 0.0, -60.0, 0.0, 30.0, -10.0),
        (26.0, 50.0, 20.0, -20.0, -20.0, 10.0),
        (1.0, 5.0, 10.0, 10.0, 5.0, -5.0),
        (0.0, 0.0, 0.0, 0.0, 0.0, 1.0),
    ])  # fmt: skip
    sharp = np.array([-SHARPENED, 1.0 + 2.0 * SHARPENED, -SHARPENED])
    return np.array([np.convolve(power, sharp) for power in basis.T / 120.0])


_WITHIN = _within()


@lean_inner
def _basis(u):
    """Quintic B-spline at a distance u >= 0 in links from its node, and its slope."""
    if u < 1.0:
        square = u * u
        return 0.55 + square * (-0.5 + square * (0.25 - u / 12.0)), u * (-1.0 + square * (1.0 - u * 5.0 / 12.0))
    if u < 2.0:
        return (
            0.425 + u * (0.625 + u * (-1.75 + u * (1.25 + u * (-0.375 + u / 24.0)))),
            0.625 + u * (-3.5 + u * (3.75 + u * (-1.5 + u * 5.0 / 24.0))),
        )
    if u < 3.0:
        rest = 3.0 - u
        return rest**5 / 120.0, -(rest**4) / 24.0
    return 0.0, 0.0


@lean
def _basis_curvature(u):
    """Second derivative of the quintic B-spline at a distance u >= 0 in links from its node."""
    if u < 1.0:
        return -1.0 + u * u * (3.0 - u * 5.0 / 3.0)
    if u < 2.0:
        return -3.5 + u * (7.5 + u * (-4.5 + u * 5.0 / 6.0))
    if u < 3.0:
        return (3.0 - u) ** 3 / 6.0
    return 0.0


@lean
def share(x, n, weight, slope):
    """How the nodes of a run share the point at x links along it.

    Args:
        x: 0 to n.
        n: number of links.
        weight, slope: (WIDTH,), overwritten: of the point and of its derivative per link.

    Returns:
        Number of the first of these nodes within the run; those beyond its end have the weight zero.
    """
    i = min(max(int(np.floor(x)), 0), n - 1)
    base = max(min(i - 3, n + 1 - WIDTH), 0)
    if 3 <= i <= n - 4:
        f = x - i
        for k in range(WIDTH):
            c0, c1, c2, c3, c4, c5 = (
                _WITHIN[0, k], _WITHIN[1, k], _WITHIN[2, k], _WITHIN[3, k], _WITHIN[4, k], _WITHIN[5, k],
            )  # fmt: skip
            weight[k] = c0 + f * (c1 + f * (c2 + f * (c3 + f * (c4 + f * c5))))
            slope[k] = c1 + f * (2.0 * c2 + f * (3.0 * c3 + f * (4.0 * c4 + f * 5.0 * c5)))
        return base
    for k in range(WIDTH):
        weight[k] = slope[k] = 0.0
    for k in range(6):
        j = i - 2 + k
        w, d = _basis(abs(x - j))
        if x < j:
            d = -d
        if j < 0:
            _control(0, n, base, 2.0 * w, 2.0 * d, weight, slope)
            w, d, j = -w, -d, min(-j, n)
        elif j > n:
            _control(n, n, base, 2.0 * w, 2.0 * d, weight, slope)
            w, d, j = -w, -d, max(2 * n - j, 0)
        _control(j, n, base, w, d, weight, slope)
    return base


@lean_inner
def _control(j, n, base, w, d, weight, slope):
    """Add the control point of node j."""
    own = 1.0 if j == 0 or j == n else 1.0 + 2.0 * SHARPENED
    weight[j - base] += own * w
    slope[j - base] += own * d
    if 0 < j < n:
        for k in range(j - 1, j + 2, 2):
            weight[k - base] -= SHARPENED * w
            slope[k - base] -= SHARPENED * d


@lean
def share_curvature(x, n, base, second):
    """How the nodes of a run share the second derivative of its spline at x links along it.

    Args:
        base: number of the first node, from `share`.
        second: (WIDTH,), overwritten, per link squared.
    """
    i = min(max(int(np.floor(x)), 0), n - 1)
    if 3 <= i <= n - 4:
        f = x - i
        for k in range(WIDTH):
            c2, c3, c4, c5 = _WITHIN[2, k], _WITHIN[3, k], _WITHIN[4, k], _WITHIN[5, k]
            second[k] = 2.0 * c2 + f * (6.0 * c3 + f * (12.0 * c4 + f * 20.0 * c5))
        return
    for k in range(WIDTH):
        second[k] = 0.0
    for k in range(6):
        j = i - 2 + k
        w = _basis_curvature(abs(x - j))
        if j < 0:
            _control(0, n, base, 2.0 * w, 0.0, second, second)
            w, j = -w, min(-j, n)
        elif j > n:
            _control(n, n, base, 2.0 * w, 0.0, second, second)
            w, j = -w, max(2 * n - j, 0)
        _control(j, n, base, w, 0.0, second, second)


@lean
def links_under(x, first, n, before, after, link, part, slope):
    """The three links that bear the kink under a contact at x links along a run, with their parts and slopes of these.

    Args:
        first: first link of the run.
        before, after: the links that a line goes on with at both ends of the run; -1: it ends there.
        link, part, slope: (3,), overwritten; parts are a quadratic B-spline over the middles of links.
    """
    y = x - 0.5
    i = int(np.floor(y + 0.5))
    f = y - i
    part[0], part[1], part[2] = 0.5 * (0.5 - f) ** 2, 0.75 - f * f, 0.5 * (0.5 + f) ** 2
    slope[0], slope[1], slope[2] = f - 0.5, -2.0 * f, 0.5 + f
    for k in range(3):
        j = i - 1 + k
        link[k] = first + min(max(j, 0), n - 1)
        if j < 0 and before >= 0:
            link[k] = before
        if j >= n and after >= 0:
            link[k] = after + min(j - n, 1)
    for k in range(3):  # parts of links that do not exist go to the last one
        if k != 1 and link[k] == link[1]:
            part[1], slope[1] = part[1] + part[k], slope[1] + slope[k]
            part[k] = slope[k] = 0.0
