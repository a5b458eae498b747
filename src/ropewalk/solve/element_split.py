"""How a load standing between two nodes divides its link, and the masses beside it.

A point between two nodes takes over part of their masses, the more the nearer it is: all of it on the node itself. Mass
and its first moment are kept (but for the halves at the supports), and nothing jumps where a load passes a node: there
the node left behind is without weight and its two links are in line.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import kernel

# A load nearer to a node than this part of a link stands on the node.
SNAP = 1e-9


def split(n: int, h: float, mass: float, xi: Array) -> tuple[Array, Integers, Integers, Array, Array]:
    """Divide the links of a strand at the loads that stand on it.

    Args:
        n, h: number and unstrained length in m of the links.
        mass: of a link, kg.
        xi: (load,) m.

    Returns:
        Material coordinates of nodes and contacts (point,) in m, in order; where the nodes (node,) and the contacts
        (load,) are among them; the masses of the points (point,) in kg; and of those of the contacts the part on either
        side (load, 2).
    """
    place = xi / h
    near = np.rint(place)
    place = np.where(np.abs(place - near) < SNAP, near, place)
    X, nodes, contacts, masses, sides = _divide(int(n), place, np.argsort(place, kind="stable"))
    return X * h, nodes, contacts, mass * masses, mass * sides


@kernel
def _divide(n, place, order):
    """The same in links and masses of one link, for places (load,) and their order."""
    count = place.size
    X, nodes, contacts = np.empty(n + 1 + count), np.empty(n + 1, np.int64), np.empty(count, np.int64)
    points, k = 0, 0
    for i in range(n + 1):
        while k < count and place[order[k]] < i:
            if points == 0 or X[points - 1] < place[order[k]]:
                X[points] = place[order[k]]
                points += 1
            contacts[order[k]] = points - 1
            k += 1
        X[points], nodes[i] = i, points
        while k < count and place[order[k]] == i:
            contacts[order[k]] = points
            k += 1
        points += 1
    own, wanted = np.ones(n + 1), np.zeros(n + 1)
    own[0] = own[n] = 0.5
    # A contact on a node takes all of its mass; half-way, half a link's, as if it were a node of the mesh.
    links, parts, weights = np.empty(count, np.int64), np.empty(count), np.empty(count)
    for k in range(count):
        links[k] = min(int(place[k]), n - 1)
        parts[k] = place[k] - links[k]
        weights[k] = 1.0 - 2.0 * parts[k] * (1.0 - parts[k])
        wanted[links[k]] += weights[k] * (1.0 - parts[k])
        wanted[links[k] + 1] += weights[k] * parts[k]
    masses, sides = np.zeros(points), np.zeros((count, 2))
    for i in range(n + 1):
        masses[nodes[i]] = own[i] * (1.0 - wanted[i] / max(wanted[i], 1.0))  # loads close together share a node
    for k in range(count):
        j, part = links[k], parts[k]
        first, second = own[j] * weights[k] * (1.0 - part), own[j + 1] * weights[k] * part
        taken = first / max(wanted[j], 1.0) + second / max(wanted[j + 1], 1.0)
        masses[contacts[k]] += taken
        # What is left of a cell at its node is not between the contact and the middle of the next link.
        sides[k, 0] = (first + part - 0.5) * taken / (first + second)
        sides[k, 1] = (second + 0.5 - part) * taken / (first + second)
    return X[:points], nodes, contacts, masses, sides
