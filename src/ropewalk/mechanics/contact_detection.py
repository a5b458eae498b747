"""Landing: where on its line a wheel in the air comes down."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import lean_inner
from ropewalk.mechanics.link import upward


@lean_inner
def project(strands, loads, state, bodies, k):
    """Look up the place on the line below a wheel in the air.

    Returns:
        Height above the line towards the wheel's own side, m; infinite beyond its ends.
    """
    s, i, r = loads.strand[k], bodies.wheels[k].at, state.r
    first, last = strands.first[s], strands.first[s] + strands.links[s] - 1
    z, part = r.shape[0] - 1, 0.0
    for _ in range(last - first + 1):
        along, square = 0.0, 0.0
        for a in range(z + 1):
            d = r[a, i + 1] - r[a, i]
            along, square = along + (bodies.wheels[k].r[a] - r[a, i]) * d, square + d * d
        part = along / square
        if part > 1.0 and i < last:
            i += 1
        elif part < 0.0 and i > first:
            i -= 1
            if part > -0.5:  # the corner between two links: either will do
                break
        else:
            break
    if part < 0.0 or part > 1.0:
        outside = (part < 0.0 and i == first) or (part > 1.0 and i == last)
        if outside:
            return np.inf
        part = min(max(part, 0.0), 1.0)
    bodies.wheels[k].at = i
    state.xi[k] = state.X[i] + part * (state.X[i + 1] - state.X[i])
    return bodies.wheels[k].lift * _height_above(state, bodies, k, i)


@lean_inner
def _height_above(state, bodies, k, i):
    """Height of wheel k above link i, m, whatever its distance to the side."""
    r, wheel, z = state.r, bodies.wheels[k], state.r.shape[0] - 1
    side = 1.0 if z == 2 else 0.0
    dy, y = side * (r[1, i + 1] - r[1, i]), side * (wheel.r[1] - r[1, i])
    return upward(r[0, i + 1] - r[0, i], dy, r[z, i + 1] - r[z, i], wheel.r[0] - r[0, i], y, wheel.r[z] - r[z, i])


@lean_inner
def bring_above(state, bodies, k):
    """Bring a wheel that lands in space level above its link: grooves and flanges guide it there, without any work."""
    i, r = bodies.wheels[k].at, state.r
    if r.shape[0] == 3:
        dx, dy = r[0, i + 1] - r[0, i], r[1, i + 1] - r[1, i]
        square = dx * dx + dy * dy
        if square > 0.0:
            aside = (dx * (bodies.wheels[k].r[1] - r[1, i]) - dy * (bodies.wheels[k].r[0] - r[0, i])) / square
            bodies.wheels[k].r[0] += aside * dy
            bodies.wheels[k].r[1] -= aside * dx
