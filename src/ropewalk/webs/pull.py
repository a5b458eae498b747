"""Forces in a web: links, springs, sheaves, wind; with those of its cells, all forces on its nodes."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import lean, lean_inner
from ropewalk.mechanics.rider import look_up
from ropewalk.webs.fabric import damp_cells, pull_cells
from ropewalk.webs.geometry import attract, distance
from ropewalk.webs.sheaves import pull_sheaves
from ropewalk.webs.web import Array, Web


@lean_inner
def pull_links(links, begin, end, r, f):
    """Add the elastic forces of the links `begin` ... `end` - 1 that are on to f (node, 3)."""
    for p in range(begin, end):
        if links.on[p] == 1:
            i, j = links.one[p], links.other[p]
            length = distance(r, i, j)
            attract(r, i, j, law.tension(links.laws[links.law[p]], length / links.rest[p] - 1.0) / length, f)


@lean_inner
def damp_links(links, end, r, v, f):
    """Add the Kelvin-Voigt forces of the first `end` links that are on; returns the power lost, W."""
    lost = 0.0
    for p in range(end):
        c = links.damping[p]
        if c == 0.0 or links.on[p] == 0:
            continue
        i, j = links.one[p], links.other[p]
        square, along = 0.0, 0.0
        for a in range(3):
            d = r[j, a] - r[i, a]
            square += d * d
            along += d * (v[j, a] - v[i, a])
        rate = along / (links.rest[p] * max(square, 1e-24))  # rate of the strain over the length
        attract(r, i, j, c * rate, f)
        lost += c * rate * along
    return lost


@lean_inner
def blow(links, end, wind, t, r, v, f):
    """Add the forces of the wind on the first `end` links, half to each of their nodes."""
    speed = look_up(wind.time, wind.speed, 0, wind.time.size, t)
    for p in range(end):
        if links.width[p] == 0.0:
            continue
        i, j = links.one[p], links.other[p]
        length = distance(r, i, j)
        along, square = 0.0, 0.0
        for a in range(3):
            u = speed * wind.direction[a] - 0.5 * (v[i, a] + v[j, a])
            along += u * (r[j, a] - r[i, a]) / length
            square += u * u
        across = np.sqrt(max(square - along * along, 0.0))
        k = 0.25 * wind.density * links.width[p] * length * across
        for a in range(3):
            u = speed * wind.direction[a] - 0.5 * (v[i, a] + v[j, a])
            F = k * (u - along * (r[j, a] - r[i, a]) / length)
            f[i, a] += F
            f[j, a] += F


@lean_inner
def pull_springs(held, r, f):
    """Add the forces of the springs that hold nodes."""
    for k in range(held.spring.size):
        n = held.spring[k]
        for a in range(3):
            for b in range(3):
                f[n, a] += held.stiffness[k, a, b] * (held.place[k, b] - r[n, b])


@lean_inner
def damp_springs(held, v, f):
    """Add the forces of the dampers that hold nodes."""
    for k in range(held.spring.size):
        n = held.spring[k]
        for a in range(3):
            for b in range(3):
                f[n, a] -= held.damping[k, a, b] * (v[n, b] - held.rate[k, b])


@lean_inner
def pull_softly(web, r, f, work, F, P):
    """Forces (node, 3) of everything but slots: conservative ones, weight and constant forces included."""
    body = web.body
    for n in range(f.shape[0]):
        for a in range(3):
            f[n, a] = body.force[n, a]
    pull_links(web.links, 0, web.own_links, r, f)
    pull_cells(web.cells, r, f, F, P)
    pull_springs(web.held, r, f)
    pull_sheaves(web.links, web.sheaves, r, f, work)


@lean_inner
def resist(web, r, v, d, F, P, V):
    """Forces d (node, 3) of everything that damps."""
    body = web.body
    for n in range(d.shape[0]):
        for a in range(3):
            d[n, a] = -body.drag[n] * body.mass[n] * v[n, a]
    damp_links(web.links, web.own_links, r, v, d)
    damp_cells(web.cells, 0, web.cells.area.size, r, v, d, F, P, V)
    damp_springs(web.held, v, d)


@lean
def _note_resistance(web, t, r, v, d, F, P, V):
    resist(web, r, v, d, F, P, V)
    blow(web.links, web.own_links, web.wind, t, r, v, d)


def resistance(web: Web, t: float, r: Array, v: Array) -> Array:
    """Forces (node, 3) of everything that damps and of the wind at time t, places r and velocities v (node, 3), N."""
    out, square = np.zeros_like(r), np.zeros((3, 2))
    _note_resistance(web, t, r, v, out, square, square.copy(), square.copy())
    return out


@lean_inner
def link_stiffness(links, p, r, K):
    """Write the tangent stiffness (3, 3) of link p between its two nodes to K."""
    i, j, rest, laws = links.one[p], links.other[p], links.rest[p], links.laws[links.law[p]]
    length = distance(r, i, j)
    strain = length / rest - 1.0
    q = law.tension(laws, strain) / length
    k = law.tangent(laws, strain) / rest - q
    for a in range(3):
        for b in range(3):
            K[a, b] = k * (r[j, a] - r[i, a]) * (r[j, b] - r[i, b]) / (length * length)
            if a == b:
                K[a, b] += q
