"""Elements of a few nodes to the first order about rest: forces linear in how far these are from there.

    f = f(rest) - K (r - rest) - C v,   V = V(rest) - f(rest) (r - rest) + 1/2 (r - rest) K (r - rest),

with the tangent stiffness K and the dampers C of each element as it rests: of a cell of nets and membranes, of the link
that lies over a sheave, of a node that lies on a saddle. A thread or a sheet that is slack there stays without
stiffness, and one that is taut pushes where it would be slack; what is in touch stays so.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import inlined, lean_inner


class ElementsAboutRest(NamedTuple):
    """Elements of one kind; places node by node, with their axes one after the other. No nodes: all geometry."""

    node: Integers  # (element, corner)
    place: Array  # (element, place) m
    force: Array  # (element, place) N, on the nodes
    stiffness: Array  # (element, place, place) N/m
    damping: Array  # (element, place, place) N s/m
    stored: Array  # (element,) J
    away: Array  # (place,) room

    @staticmethod
    def nothing() -> ElementsAboutRest:
        """Of what moves with all geometry."""
        x, K = np.zeros((0, 0)), np.zeros((0, 0, 0))
        return ElementsAboutRest(np.zeros((0, 0), dtype=np.int64), x, x, K, K, np.zeros(0), np.zeros(0))

    @staticmethod
    def of(node: Integers, rest: Array, force: Array, K: Array, C: Array, stored: Array) -> ElementsAboutRest:
        """Of forces, stiffnesses, dampers and energies of elements at places of all nodes (axis, node) in m."""
        place = rest[:, node].transpose(1, 2, 0).reshape(len(node), node.shape[1] * len(rest))
        return ElementsAboutRest(node, np.ascontiguousarray(place), force, K, C, stored, np.zeros(place.shape[1]))

    @property
    def are_there(self) -> bool:
        """Whether what they stand for is linearised."""
        return bool(self.node.shape[1] > 0)


def gathered(node: Integers, values: Array, nodes: int, axes: int) -> sparse.csc_matrix:
    """Matrices of elements (element, place, place) as one of all places, axis by axis, (place, place)."""
    at = (node[:, :, None] + nodes * np.arange(axes)).reshape(len(node), node.shape[1] * axes)
    rows, columns = np.broadcast_to(at[:, :, None], values.shape), np.broadcast_to(at[:, None, :], values.shape)
    size = axes * nodes
    return sparse.coo_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size)).tocsc()


@inlined
def is_little(about):
    """Whether what elements stand for is linearised."""
    return about.node.shape[1] > 0


@lean_inner
def gather_about_rest(about, e, r):
    """Put how far the nodes of element e are from rest into `away`."""
    axes = r.shape[0]
    for i in range(about.node.shape[1]):
        for a in range(axes):
            about.away[i * axes + a] = r[a, about.node[e, i]] - about.place[e, i * axes + a]


@lean_inner
def add_forces_about_rest(about, r, force):
    """Add the elastic forces of all elements, with places and forces as (axis, node)."""
    axes = r.shape[0]
    for e in range(about.node.shape[0]):
        gather_about_rest(about, e, r)
        for i in range(about.node.shape[1]):
            for a in range(axes):
                m = i * axes + a
                f = about.force[e, m]
                for n in range(about.away.size):
                    f -= about.stiffness[e, m, n] * about.away[n]
                force[a, about.node[e, i]] += f


@lean_inner
def damp_about_rest(about, v, force):
    """Add the forces of the dampers of all elements; returns the power they take, W."""
    lost, axes = 0.0, v.shape[0]
    for e in range(about.node.shape[0]):
        for i in range(about.node.shape[1]):
            for a in range(axes):
                about.away[i * axes + a] = v[a, about.node[e, i]]
        for i in range(about.node.shape[1]):
            for a in range(axes):
                m = i * axes + a
                f = 0.0
                for n in range(about.away.size):
                    f += about.damping[e, m, n] * about.away[n]
                lost += f * about.away[m]
                force[a, about.node[e, i]] -= f
    return lost


@lean_inner
def stored_about_rest(about, r):
    """Energy stored in all elements to the second order, J."""
    total = 0.0
    for e in range(about.node.shape[0]):
        gather_about_rest(about, e, r)
        total += about.stored[e]
        for m in range(about.away.size):
            f = -about.force[e, m]
            for n in range(about.away.size):
                f += 0.5 * about.stiffness[e, m, n] * about.away[n]
            total += f * about.away[m]
    return total
