"""Relaxation: from any shape to near rest, by motion with masses made up for it that is stopped whenever it slows down.

Explicit motion of masses that suit the stiffness around each node goes downhill by the whole network at once, however
slack it is, and stops at every maximum of its kinetic energy (Cundall 1976; Barnes, Int. J. Space Struct. 14, 1999).
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import lean
from ropewalk.networks.network import Array
from ropewalk.networks.potential import NetworkPotential, add_internal_forces
from ropewalk.networks.sheaves import hop
from ropewalk.networks.stability import stiffness_around

MOST_STEPS = 200_000
NEAR = 1e-4  # of the largest given force on a node and the mean tension: what is out of balance at the end


@lean
def _relax(network, r, v, mass, given, along, movable, steps, enough, f, F, P):
    """Go on for at most `steps` steps; returns the largest force out of balance, negative: a line has run out."""
    before, largest = 0.0, np.inf
    for _ in range(steps):
        add_internal_forces(network, r, f, F, P)
        energy, largest = 0.0, 0.0
        for n in range(mass.size):
            if movable[n] == 0:
                continue
            rail = movable[n] - 2
            push = 0.0
            for a in range(3):
                f[n, a] += given[n, a]
                if rail >= 0:
                    push += along[rail, a] * f[n, a]
            for a in range(3):
                pull = push * along[rail, a] if rail >= 0 else f[n, a]
                largest = max(largest, abs(pull))
                v[n, a] += pull / mass[n]
                energy += mass[n] * v[n, a] * v[n, a]
        if largest < enough:
            break
        slows = energy < before
        before = 0.0 if slows else energy
        for n in range(mass.size):
            for a in range(3):
                if slows:
                    v[n, a] = 0.0
                r[n, a] += v[n, a]
        if network.sheaves.node.size > 0 and not hop(network.links, network.sheaves, r, v):
            return -1.0
    return largest


def relaxed(potential: NetworkPotential, start: Array) -> Array | None:
    """A shape near rest, (node, 3) m; None: a line runs out over a sheave, or it never comes near.

    Lines slip freely at sheaves.
    """
    network = potential.network
    mass = np.maximum(stiffness_around(network), 1e-12)
    movable = np.ones(mass.size, dtype=np.int64)
    movable[network.restrained.fixed] = 0
    movable[network.restrained.rail] = 2 + np.arange(network.restrained.rail.size)
    movable[network.nodes :] = network.locations.kind != 0
    given = potential.given - network.body.force
    r, v, f = start.copy(), np.zeros_like(start), np.zeros_like(start)
    square = np.zeros((3, 2))
    scale = max(float(np.abs(potential.given).max(initial=0.0)), float(np.abs(potential.given).sum()) / r.shape[0])
    friction = network.sheaves.friction.copy()
    network.sheaves.friction[:] = 0.0
    try:
        left = _relax(
            network, r, v, mass, given, network.restrained.along, movable, MOST_STEPS, NEAR * scale, f, square,
            square.copy(),
        )  # fmt: skip
    finally:
        network.sheaves.friction[:] = friction
    potential.settle_slip()
    return None if left < 0.0 or not np.isfinite(r).all() else r
