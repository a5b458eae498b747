"""How long a step may be for explicit motion of a web to be stable."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.webs.fabric import bounds_of_cells
from ropewalk.webs.web import Array, Web

# Part of the stable step that is used: lines get stiffer as they are stretched.
SAFETY = 0.5
_STRAINS = np.linspace(1e-6, 0.05, 26)  # at which the slope of a law is looked at
_STUCK = 4.0  # stiffness of a link that sticks at a sheave near one of its ends, over its own


def largest_step(web: Web) -> float:
    """The step that is used at most, s.

    From bounds of the largest frequency omega and of the largest rate of decay gamma, each the sum of what pulls or
    damps at a node over its mass (Gershgorin): 2/omega (sqrt(1 + zeta^2) - zeta) with zeta = gamma/omega.
    """
    stiffness, damping = (total[: web.nodes] for total in sums(web, slots=False))
    moves = np.ones(web.nodes, dtype=np.bool_)
    moves[web.held.fixed] = False
    mass = web.body.mass[: web.nodes]
    moves &= mass > 0.0
    if not moves.any():
        return np.inf
    omega = float(np.sqrt((stiffness[moves] / mass[moves]).max()))
    gamma = float((damping[moves] / mass[moves] + web.body.drag[: web.nodes][moves]).max())
    if omega == 0.0:
        return SAFETY / gamma if gamma > 0.0 else np.inf
    zeta = gamma / omega
    return SAFETY * 2.0 / omega * float(np.sqrt(1.0 + zeta**2) - zeta)


def sums(web: Web, *, slots: bool = True) -> tuple[Array, Array]:
    """Bounds of the stiffness (N/m) and the damping (N s/m) at each node and contact: sums over what pulls there."""
    stiffness, damping = np.zeros((2, web.body.mass.size))
    links, held = web.links, web.held
    n = web.own_links
    if n:
        slope = np.array([max(float(law.tangent(p, e)) for e in (0.0, *_STRAINS)) for p in links.laws])
        k = slope[links.law] / links.rest
        k[web.sheaves.link] *= np.where(web.sheaves.friction > 0.0, _STUCK, 1.0)
        k[n:] *= links.on[n:] * slots
        for at in (links.one, links.other):
            np.add.at(stiffness, at, 2.0 * k)
            np.add.at(damping, at, 2.0 * links.damping / links.rest)
        np.add.at(stiffness, web.sheaves.node, 4.0 * k[web.sheaves.link])
    around, viscous = bounds_of_cells(web.cells, stiffness.size)
    stiffness, damping = stiffness + around, damping + viscous
    for node, K, C in zip(held.spring.tolist(), held.stiffness, held.damping, strict=True):
        stiffness[node] += np.linalg.norm(K, 2)
        damping[node] += np.linalg.norm(C, 2)
    return stiffness, damping
