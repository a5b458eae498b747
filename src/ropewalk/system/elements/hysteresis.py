"""Hysteresis of links: friction within them, whatever the speed, by a spring and a slider in series (Jenkins).

With T1 the law of loading and f half of what unloading differs from it by, both functions of the strain e,

    T = T1 - f + q,   dq = k de,   |q| <= f,
    V = W1 - F + q^2/(2 k),   F' = f,

per unstrained length, and q (de - dq/k) is lost: what the slider has gone while q stays at its bound. It is the model
of Iwan (1966) with one element, whose slider rubs as much as what is told of the two curves. What a link keeps in mind
is s = f - q, by which its tension is below the curve of loading: 0 at the beginning.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.assembly import pack
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.compiled import lean_inner
from ropewalk.model.law import Tabulated, TensionOnly
from ropewalk.model.line import Line


def packed_of(line: Line) -> Array:
    """Stiffness k of its spring in N, 0: there is none; and the bound f of the force on it, as laws are packed."""
    if line.hysteresis is None:
        return np.zeros(1)
    if isinstance(line.law, Tabulated):
        halves = line.hysteresis.halves(line.law)
        return np.array([line.hysteresis.stiffness, law.TABLE, len(halves), *line.law.strain, *halves])
    half = 0.5 * (1.0 - (line.hysteresis.ratio or 0.0)) * float(pack(line.law, line.axial_stiffness)[2])
    return np.array([line.hysteresis.stiffness, *pack(TensionOnly(), half)])


@lean_inner
def bound(p, e):
    """Half of what unloading differs from loading by, N: nothing where nothing is stretched."""
    return max(law.tension(p[1:], max(e, 0.0)), 0.0)


@lean_inner
def let_off(p, h, strain, lag, tension, begin, n, since):
    """Take from tensions what they are below the curve of loading; returns what has been lost since the last look, J.

    Args:
        p: of the run, `packed_of`.
        h: m, unstrained length of a link.
        lag: (2, node) by how much they are, N, and strains at the last look; changes.
        since: s, since the last look; 0: nothing has moved since, and what jumps rubs nothing.
    """
    lost, k = 0.0, p[0]
    for i in range(begin, begin + n):
        if since > 0.0:
            de, most = strain[i] - lag[1, i], bound(p, strain[i])
            before = bound(p, lag[1, i]) - lag[0, i]
            q = min(max(before + k * de, -most), most)
            lost += 0.5 * (before + q) * (de - (q - before) / k)
            lag[0, i] = most - q
        lag[1, i] = strain[i]
        tension[i] -= lag[0, i]
    return h * lost


@lean_inner
def stored_in_hysteresis(p, e, s):
    """What is stored per unstrained length more than by loading alone, N (= J/m)."""
    q = bound(p, e) - s
    return 0.5 * q * q / p[0] - law.stored(p[1:], max(e, 0.0))
