"""Sheaves: a line bends over a point and slips as far as friction lets it; its nodes pass from side to side.

The link over which a sheave stands is divided into two pieces that share its unstrained length. With the tensions T1
and T2 on both sides and the angle theta by which the line turns, it slips as soon as one exceeds exp(mu theta) times
the other (Euler and Eytelwein), and until it no longer does. Without friction both are equal at any time.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import inlined, lean, lean_inner
from ropewalk.networks.geometry import add_bead_forces, distance

# A sheave is taken to be no closer to a node than this part of the link over which it stands.
CLOSEST = 1e-9


@inlined
def _turning_angle(r, a, b, c, l1, l2):
    cosine = 0.0
    for x in range(3):
        cosine += (r[b, x] - r[a, x]) * (r[c, x] - r[b, x])
    return np.arccos(min(max(cosine / (l1 * l2), -1.0), 1.0))


@lean_inner
def slip(p, l1, l2, whole, s, ratio):
    """Unstrained length behind a sheave once its line has slipped as far as friction lets it.

    Args:
        p: axial law.
        l1, l2: lengths behind and ahead of the sheave, m.
        whole: unstrained length of both together, m.
        s: unstrained length behind before, m.
        ratio: of the larger tension to the smaller one from which on it slips.
    """
    low, high = CLOSEST * whole, (1.0 - CLOSEST) * whole
    s = min(max(s, low), high)
    one, two = law.tension(p, l1 / s - 1.0), law.tension(p, l2 / (whole - s) - 1.0)
    if two > one * ratio:
        behind, ahead = ratio, 1.0  # T2 - ratio T1 = 0 at a smaller s
        high = s
    elif one > two * ratio:
        behind, ahead = 1.0, ratio
        low = s
    else:
        return s
    for _ in range(60):
        s = 0.5 * (low + high)
        one, two = law.tension(p, l1 / s - 1.0), law.tension(p, l2 / (whole - s) - 1.0)
        if ahead * two > behind * one:
            high = s
        else:
            low = s
    return 0.5 * (low + high)


@lean_inner
def sheave_energy(p, l1, l2, whole, s):
    """Energy stored on both sides of a sheave, J."""
    return s * law.stored(p, l1 / s - 1.0) + (whole - s) * law.stored(p, l2 / (whole - s) - 1.0)


@lean_inner
def add_sheave_forces(links, sheaves, r, f):
    """Let lines slip over their sheaves, and add their forces."""
    for k in range(sheaves.node.size):
        e, b = sheaves.link[k], sheaves.node[k]
        a, c, whole, p = links.one[e], links.other[e], links.rest[e], links.laws[links.law[e]]
        l1, l2 = max(distance(r, a, b), CLOSEST * whole), max(distance(r, b, c), CLOSEST * whole)
        ratio = np.exp(sheaves.friction[k] * _turning_angle(r, a, b, c, l1, l2))
        sheaves.ahead[k] = s = slip(p, l1, l2, whole, sheaves.ahead[k], ratio)
        one, two = law.tension(p, l1 / s - 1.0), law.tension(p, l2 / (whole - s) - 1.0)
        sheaves.tension[k, 0], sheaves.tension[k, 1] = one, two
        add_bead_forces(r, a, b, one / l1, f)
        add_bead_forces(r, b, c, two / l2, f)


@lean
def hop(links, sheaves, r, v):
    """Let nodes that have come to a sheave pass to its other side.

    A node keeps its speed along the line and takes the direction of the piece beyond.

    Returns:
        False where the line has come to its end, or to another sheave.
    """
    for k in range(sheaves.node.size):
        e, b = sheaves.link[k], sheaves.node[k]
        for side in range(2):
            near = links.one[e] if side == 0 else links.other[e]
            beyond = links.other[e] if side == 0 else links.one[e]
            onto = e - 1 if side == 0 else e + 1
            if onto < sheaves.first[k] or onto > sheaves.last[k]:
                continue
            far = links.one[onto] if side == 0 else links.other[onto]
            passed, length, away = 0.0, distance(r, far, near), distance(r, b, beyond)
            for a in range(3):
                passed += (r[near, a] - r[b, a]) * (r[near, a] - r[far, a])
            if passed <= 0.0:
                continue
            if links.on[onto] == 0 or onto == (sheaves.first[k] if side == 0 else sheaves.last[k]):
                return False
            along = 0.0
            for a in range(3):
                along += (v[near, a] - v[b, a]) * (r[near, a] - r[far, a]) / length
            over = passed / length
            for a in range(3):
                v[near, a] += along * ((r[beyond, a] - r[b, a]) / away - (r[near, a] - r[far, a]) / length)
                r[near, a] = r[b, a] + over * (r[beyond, a] - r[b, a]) / away
            links.on[e], links.on[onto] = 1, 0
            sheaves.link[k] = onto
            whole = links.rest[onto]
            behind = distance(r, links.one[onto], b)
            sheaves.ahead[k] = whole * behind / (behind + distance(r, b, links.other[onto]))
            break
    return True
