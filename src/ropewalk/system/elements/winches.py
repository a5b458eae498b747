"""Winches that keep a tension: the end of a line runs along its rail, no faster than the winch can.

The winch pulls with W = T0 + X. The force T0 that is set stands with the other constant forces, and

    X = -c u - band sgn u  while |u| < limit;  |X| <= band  where u = 0;  any X that brakes  where |u| = limit,

u: velocity along the rail, of either sign. The velocity after a kick obeys it, which no step makes unstable.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import lean_inner
from ropewalk.system.elements.structure import DAMPED, MOVED

LIMIT, BAND = 0, 1  # columns of `Restraints.winch`


@lean_inner
def kick_winch(restrained, v, reaction, tight, work, e, b, mass, drag, h):
    """Kick the end of a line that a winch pulls at.

    Args:
        restrained: all restraints.
        v: (axis, node) m/s.
        reaction: (restraint, axis) N.
        tight: inextensible links, whose tensions find by `mobile` how the end gives way to them; or None.
        work: by their forms, J.
        e: number of the restraint.
        b: (axis,) N, all forces on it but X; spoiled.
        mass: kg, of the restraint and its nodes.
        drag: kg/s.
        h: s, of the kick.
    """
    axes, first, j = v.shape[0], restrained.node[restrained.first[e]], 0
    for a in range(axes):
        if restrained.free[e, a, a] > restrained.free[e, j, j]:
            j = a
    size, push, before, c = np.sqrt(restrained.free[e, j, j]), 0.0, 0.0, 0.0
    for a in range(axes):
        n = restrained.free[e, j, a] / size
        push += n * b[a]
        before += n * v[a, first]
        c += restrained.damping[e, a, a]  # of a dyad c n n
    limit, band, inertia = restrained.winch[e, LIMIT], restrained.winch[e, BAND], mass / h
    push += inertia * before
    u = 0.0
    if abs(push) > band:
        u = (push - (band if push > 0.0 else -band)) / (inertia + drag + c)
        u = min(max(u, -limit), limit)
    X, mean = (inertia + drag) * u - push, 0.5 * (u + before)
    work[MOVED] += h * X * mean
    work[DAMPED] += h * drag * u * mean
    if tight is not None and tight.h.size > 0:  # also where it stands: what tensions miss there sums to little
        gives = 1.0 / (mass + h * (drag + c))
        for a in range(axes):
            for i in range(axes):
                tight.mobile[e, a, i] = gives * restrained.free[e, a, i]
    for a in range(axes):
        n = restrained.free[e, j, a] / size
        reaction[e, a] += ((mass - restrained.mass[e]) * (u - before) / h + drag * u) * n
        for i in range(restrained.first[e], restrained.first[e] + restrained.nodes[e]):
            v[a, restrained.node[i]] += (u - before) * n
