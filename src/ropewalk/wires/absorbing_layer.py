"""Layers next to the borders of a window that take up waves across the wires, which would come back from there.

Within a layer velocities are damped at a rate that grows with the square of the way into it. What is taken is lost.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import inlined
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.moving_loads import DAMPED
from ropewalk.wires.plan import Array, Integers

_THICK = 0.4  # of the half width of a window
_STRENGTH = 2.0  # greatest rate, in speeds of waves across over the thickness


def layers(mesh: Mesh, width: float) -> tuple[Integers, Array]:
    """Nodes in each layer of all wires, (wire,), and at which rate the outermost takes up waves, (wire,) 1/s.

    Args:
        mesh: the wires.
        width: half that of the window, m; infinite: there are none.
    """
    s = mesh.strands
    if np.isinf(width):
        return np.zeros_like(s.links), np.zeros(s.first.size)
    speed = np.sqrt(np.maximum(s.tension, 0.0) / s.rho)
    return np.floor(_THICK * width / s.h).astype(np.int64), _STRENGTH * speed / (_THICK * width)


@inlined
def absorb(strands, window, mass, now, other, first, dt, step, work):
    """Damp in layers what moves in a step of the wires of dt in s, for all of a step in s.

    Args:
        mass: (node,) kg.
        now, other: (axis, node) m, at the beginning and at the end of that step of the wires; axes from `first` on.
    """
    for a in range(strands.first.size):
        n = window.layer[a]
        if window.low[a] >= window.high[a] or n == 0:
            continue
        for side in range(2):
            if (window.low[a] == 0) if side == 0 else (window.high[a] > strands.links[a]):
                continue
            e = strands.first[a] + (window.low[a] if side == 0 else window.high[a] - 1)
            for j in range(n):
                i = e + j if side == 0 else e - j
                part = 1.0 - j / n
                taken = window.rate[a] * step * part * part
                for c in range(first, now.shape[0]):
                    d = other[c, i] - now[c, i]
                    other[c, i] -= taken * d
                    work[DAMPED] += 0.5 * mass[i] * taken * (2.0 - taken) * d * d / (dt * dt)
