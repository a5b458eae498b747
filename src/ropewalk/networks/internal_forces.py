"""Forces in a network at rest: links, springs, sheaves, wind; with those of its cells, all forces on its nodes."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import lean, lean_inner
from ropewalk.mechanics.moving_contact import look_up
from ropewalk.networks.geometry import add_bead_forces, distance
from ropewalk.networks.membrane_elements import add_membrane_forces
from ropewalk.networks.network import Array, Network
from ropewalk.networks.sheaves import add_sheave_forces


@lean_inner
def add_link_forces(links, begin, end, r, f):
    """Add the elastic forces of the links `begin` ... `end` - 1 that are on to f (node, 3)."""
    for p in range(begin, end):
        if links.on[p] == 1:
            i, j = links.one[p], links.other[p]
            length = distance(r, i, j)
            add_bead_forces(r, i, j, law.tension(links.laws[links.law[p]], length / links.rest[p] - 1.0) / length, f)


@lean
def _add_wind_forces(links, end, wind, t, r, f):
    """Add the forces of the wind on the first `end` links, which stand still, half to each of their nodes."""
    speed = look_up(wind.time, wind.speed, 0, wind.time.size, t)
    for p in range(end):
        if links.width[p] == 0.0:
            continue
        i, j = links.one[p], links.other[p]
        length, along, square = distance(r, i, j), 0.0, 0.0
        for a in range(3):
            u = speed * wind.direction[a]
            along += u * (r[j, a] - r[i, a]) / length
            square += u * u
        across = np.sqrt(max(square - along * along, 0.0))
        k = 0.25 * wind.density * links.width[p] * length * across
        for a in range(3):
            F = k * (speed * wind.direction[a] - along * (r[j, a] - r[i, a]) / length)
            f[i, a] += F
            f[j, a] += F


def blown(network: Network, t: float, r: Array) -> Array:
    """Forces (node, 3) of the wind at time t in s on what stands still at places r (node, 3) in m, N."""
    out = np.zeros_like(r)
    _add_wind_forces(network.links, network.own_links, network.wind, t, r, out)
    return out


@lean_inner
def add_spring_forces(restrained, r, f):
    """Add the forces of the springs that hold nodes."""
    for k in range(restrained.spring.size):
        n = restrained.spring[k]
        for a in range(3):
            for b in range(3):
                f[n, a] += restrained.stiffness[k, a, b] * (restrained.place[k, b] - r[n, b])


@lean_inner
def add_soft_edge_forces(network, r, f, F, P):
    """Forces (node, 3) of everything but slots: conservative ones, weight and constant forces included."""
    body = network.body
    for n in range(f.shape[0]):
        for a in range(3):
            f[n, a] = body.force[n, a]
    add_link_forces(network.links, 0, network.own_links, r, f)
    add_membrane_forces(network.cells, r, f, F, P)
    add_spring_forces(network.restrained, r, f)
    add_sheave_forces(network.links, network.sheaves, r, f)


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
