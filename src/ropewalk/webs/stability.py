"""How stiff a web is around each of its nodes."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.webs.fabric import bounds_of_cells
from ropewalk.webs.web import Array, Web

_STRAINS = np.linspace(1e-6, 0.05, 26)  # at which the slope of a law is looked at
_STUCK = 4.0  # stiffness of a link that sticks at a sheave near one of its ends, over its own


def stiffness_around(web: Web) -> Array:
    """Bounds of the stiffness at each node and contact, N/m: sums over what pulls there."""
    stiffness, links, held = np.zeros(web.body.mass.size), web.links, web.held
    n = web.own_links
    if n:
        slope = np.array([max(float(law.tangent(p, e)) for e in (0.0, *_STRAINS)) for p in links.laws])
        k = slope[links.law] / links.rest
        k[web.sheaves.link] *= np.where(web.sheaves.friction > 0.0, _STUCK, 1.0)
        k[n:] *= links.on[n:]
        for at in (links.one, links.other):
            np.add.at(stiffness, at, 2.0 * k)
        np.add.at(stiffness, web.sheaves.node, 4.0 * k[web.sheaves.link])
    stiffness = stiffness + bounds_of_cells(web.cells, stiffness.size)[0]
    for node, K in zip(held.spring.tolist(), held.stiffness, strict=True):
        stiffness[node] += np.linalg.norm(K, 2)
    return stiffness
