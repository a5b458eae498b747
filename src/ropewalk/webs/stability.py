"""How long a step may be for explicit motion of a web to be stable."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.webs.web import THREADS, Array, Web

# Part of the stable step that is used, of lines and of nets. Lines get stiffer as they are stretched; the audit of an
# undamped net on which a person walks missed 2 % at 0.7, 5 % at 0.4 (it grew late) and less than 0.1 % at 0.25.
SAFETY, SAFETY_OF_NETS = 0.5, 0.25
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
    part = SAFETY_OF_NETS if web.own_cells else SAFETY
    omega = float(np.sqrt((stiffness[moves] / mass[moves]).max()))
    gamma = float((damping[moves] / mass[moves] + web.body.drag[: web.nodes][moves]).max())
    if omega == 0.0:
        return part / gamma if gamma > 0.0 else np.inf
    zeta = gamma / omega
    return part * 2.0 / omega * float(np.sqrt(1.0 + zeta**2) - zeta)


def sums(web: Web, *, slots: bool = True) -> tuple[Array, Array]:
    """Bounds of the stiffness (N/m) and the damping (N s/m) at each node and contact: sums over what pulls there."""
    stiffness, damping = np.zeros((2, web.body.mass.size))
    links, cells, held = web.links, web.cells, web.held
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
    if web.own_cells:
        on = (cells.on == 1) & slots
        on[: web.own_cells] = True
        for corner, (k, c) in enumerate(_of_cells(web)):
            np.add.at(stiffness, cells.node[:, corner], on * k)
            np.add.at(damping, cells.node[:, corner], on * c)
    for node, K, C in zip(held.spring.tolist(), held.stiffness, held.damping, strict=True):
        stiffness[node] += np.linalg.norm(K, 2)
        damping[node] += np.linalg.norm(C, 2)
    return stiffness, damping


def _of_cells(web: Web) -> list[tuple[Array, Array]]:
    """Bounds of the stiffness and the damping of each corner of all cells."""
    cells = web.cells
    b, area, p = cells.inverse, cells.area, cells.fabrics[cells.fabric]
    g = np.stack([[-b[:, 0] - b[:, 2], -b[:, 1] - b[:, 3]], [b[:, 0], b[:, 1]], [b[:, 2], b[:, 3]]])  # corner, axis
    threads = p[:, 0] == THREADS
    sheet = p[:, 1] / (1.0 - np.minimum(p[:, 2], 0.99) ** 2)
    sums = np.abs(g).sum(axis=0)
    size = np.sqrt((g**2).sum(axis=1))
    out = []
    for corner in range(3):
        along = [area * np.abs(g[corner, a]) * sums[a] for a in range(2)]
        whole = area * size[corner] * size.sum(axis=0)
        k = np.where(threads, p[:, 1] * along[0] + p[:, 2] * along[1], sheet * whole)
        c = np.where(threads, p[:, 3] * along[0] + p[:, 4] * along[1], p[:, 3] * whole)
        out.append((k, c))
    return out
