"""How stiff a network is around each of its nodes."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.networks.membrane_elements import bounds_of_cells
from ropewalk.networks.network import Array, Network

_STRAINS = np.linspace(1e-6, 0.05, 26)  # at which the slope of a law is looked at
_STUCK = 4.0  # stiffness of a link that sticks at a sheave near one of its ends, over its own


def stiffness_around(network: Network) -> Array:
    """Bounds of the stiffness at each node and contact, N/m: sums over what pulls there."""
    stiffness, links, restrained = np.zeros(network.body.mass.size), network.links, network.restrained
    n = network.own_links
    if n:
        slope = np.array([max(float(law.tangent(p, e)) for e in (0.0, *_STRAINS)) for p in links.laws])
        k = slope[links.law] / links.rest
        k[network.sheaves.link] *= np.where(network.sheaves.friction > 0.0, _STUCK, 1.0)
        k[n:] *= links.on[n:]
        for at in (links.one, links.other):
            np.add.at(stiffness, at, 2.0 * k)
        np.add.at(stiffness, network.sheaves.node, 4.0 * k[network.sheaves.link])
    stiffness = stiffness + bounds_of_cells(network.cells, stiffness.size)[0]
    for node, K in zip(restrained.spring.tolist(), restrained.stiffness, strict=True):
        stiffness[node] += np.linalg.norm(K, 2)
    return stiffness
