"""Layers next to the borders of a window that take up waves across the wires, which would come back from there.

Within a layer velocities are damped at a rate that grows with the square of the way into it. What is taken is lost.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import inlined, lean_inner, summing
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.moving_loads import DAMPED
from ropewalk.wires.plan import Array, Integers

THICK = 0.4  # of the half width of a window
_STRENGTH = 2.0  # greatest rate, in speeds of waves across over the thickness


def layers(mesh: Mesh, width: float) -> tuple[Integers, Array]:
    """Nodes in each layer of all wires, (wire,), and at which rates they are slowed, (wire, side, node) 1/s along x.

    Args:
        mesh: the wires.
        width: half that of the window, m; infinite: there are none.
    """
    s = mesh.strands
    if np.isinf(width):
        return np.zeros_like(s.links), np.zeros((s.first.size, 2, 0))
    speed = np.sqrt(np.maximum(s.tension, 0.0) / s.rho)
    nodes = np.floor(THICK * width / s.h).astype(np.int64)
    rates = np.zeros((s.first.size, 2, int(nodes.max())))
    for n, own, c in zip(nodes, rates, speed, strict=True):
        depth = np.arange(n) / max(n, 1)  # what stands still is one link beyond the last node
        own[1, :n] = _STRENGTH * c / (THICK * width) * depth**2
        own[0, :n] = own[1, :n][::-1]
    return nodes, rates


@lean_inner
def _slow(now, other, rate, begin, end, step):
    """Take from what nodes from `begin` to `end` moved in a step."""
    u, out, own = now[begin:end], other[begin:end], rate[: end - begin]  # slices let the loop vectorise
    for i in range(end - begin):
        out[i] -= step * own[i] * (out[i] - u[i])


@summing
def _taken(now, other, mass, rate, begin, end, step):
    """What that takes of kinetic energy, times 2 dt^2, J s^2."""
    u, out, m, own, lost = now[begin:end], other[begin:end], mass[begin:end], rate[: end - begin], 0.0
    for i in range(end - begin):
        share, d = step * own[i], out[i] - u[i]
        lost += m[i] * share * (2.0 - share) * d * d
    return lost


@inlined
def absorb(strands, window, mass, now, other, first, dt, step, work, count):
    """Damp in layers what moves in a step of the wires of dt in s, for all of a step in s.

    Args:
        mass: (node,) kg.
        now, other: (axis, node) m, at the beginning and at the end of that step of the wires; axes from `first` on.
        count: steps whose losses are counted with those of this one; 0: they have been.
    """
    for a in range(strands.first.size):
        n = window.layer[a]
        if window.low[a] >= window.high[a] or n == 0:
            continue
        low, high = strands.first[a] + window.low[a], strands.first[a] + window.high[a]
        for side in range(2):
            if (window.low[a] == 0) if side == 0 else (window.high[a] > strands.links[a]):
                continue
            begin, end = (low, min(low + n, high)) if side == 0 else (max(high - n, low), high)
            rate = window.rate[a, side, 0 if side == 0 else n - (end - begin) : n]
            for c in range(first, now.shape[0]):
                if count > 0:
                    lost = _taken(now[c], other[c], mass, rate, begin, end, step)
                    work[DAMPED] += 0.5 * count * lost / (dt * dt)
                _slow(now[c], other[c], rate, begin, end, step)
