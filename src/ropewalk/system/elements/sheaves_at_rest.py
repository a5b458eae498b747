"""Lines over sheaves as rest and small motion see them: energy, stiffness, dampers, and nodes about to pass."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.system.elements.sheaves import CLOSEST, SLIPS
from ropewalk.system.elements.structure import Runs, Sheaves

# A node is at a sheave if it is closer than this part of a link.
_AT = 1e-4
# The most that a node beside a sheave moves in a step on the way to rest, in links.
_MOST = 0.5


def _nodes(sheaves: Sheaves, runs: Runs) -> Integers:
    """The node behind each sheave, its own, and the one ahead of it, (sheave, 3)."""
    ends = runs.first[sheaves.run] + runs.links[sheaves.run]
    return np.stack([ends, sheaves.node, ends + 1], axis=1)


def neighbours_of(sheaves: Sheaves, runs: Runs, nodes: int, axes: int) -> sparse.csc_matrix:
    """Ones where the stiffness of pieces may have entries, (place, place)."""
    at = (_nodes(sheaves, runs)[:, :, None] + nodes * np.arange(axes)).reshape(-1, 3 * axes)
    rows, columns = (np.broadcast_to(part, (*at.shape, 3 * axes)).ravel() for part in (at[:, :, None], at[:, None]))
    size = axes * nodes
    return sparse.coo_matrix((np.ones(rows.size), (rows, columns)), shape=(size, size)).tocsc()


def part_until_passing(sheaves: Sheaves, runs: Runs, way: Array) -> float:
    """The part of a way (axis, node) in m on which no node beside a sheave moves by more than half a link.

    Nodes pass one by one, and only those that are close.
    """
    moved = np.linalg.norm(way[:, _nodes(sheaves, runs)], axis=0).max(axis=1)
    return float(min(1.0, (_MOST * runs.h[sheaves.run] / np.maximum(moved, 1e-300)).min()))


def stiffness_of(sheaves: Sheaves, runs: Runs, r: Array, how: int) -> sparse.csc_matrix:
    """Second derivatives of the energy of all pieces, (place, place) N/m; places as (axis, node).

    Args:
        how: SLIPS: with the slip at which it is least; STICKS: with the slip as it is.
    """
    axes, n = r.shape
    row, column, value = [], [], []
    for q, (b, run) in enumerate(zip(sheaves.node, sheaves.run, strict=True)):
        e, h, p, s = int(runs.first[run] + runs.links[run]), runs.h[run], runs.law[run], sheaves.ahead[q]
        K = np.zeros((3, axes, 3, axes))  # of e, b, e + 1
        bent, curved = np.zeros((3, axes)), 0.0
        for one, rest, sign in ((0, s, -1.0), (1, h - s, 1.0)):  # the piece between the places `one` and `one` + 1
            chord = r[:, [b, e + 1][one]] - r[:, [e, b][one]]
            length = max(float(np.linalg.norm(chord)), CLOSEST * h)
            stretch, T = length / rest, float(law.tension(p, length / rest - 1.0))
            k = float(law.tangent(p, stretch - 1.0)) / rest
            unit = chord / length
            own = (k - T / length) * np.outer(unit, unit) + T / length * np.eye(axes)
            for i in (one, one + 1):
                for j in (one, one + 1):
                    K[i, :, j, :] += own if i == j else -own
            bent[one] -= sign * k * stretch * unit
            bent[one + 1] += sign * k * stretch * unit
            curved += k * stretch**2
        w = 0.5 * sheaves.weight[q]
        bent[0] -= w
        bent[2] += w
        if how == SLIPS and curved > 0.0:
            K -= bent[:, :, None, None] * bent[None, None] / curved
        at = (np.array([e, b, e + 1])[:, None] + n * np.arange(axes)).ravel()
        row.append(np.repeat(at, at.size))
        column.append(np.tile(at, at.size))
        value.append(K.ravel())
    entries = np.concatenate(value), (np.concatenate(row), np.concatenate(column))
    return sparse.coo_matrix(entries, shape=(axes * n, axes * n)).tocsc()


def push_over(sheaves: Sheaves, runs: Runs, r: Array) -> None:
    """Push nodes at rest that have come close to a sheave beyond it, where the line pulls harder from there.

    In the energy as a function of its place, a node that is about to pass sits on the tip of a cone. Places
    (axis, node) are changed.
    """
    for q, (b, run) in enumerate(zip(sheaves.node, sheaves.run, strict=True)):
        e, h = int(runs.first[run] + runs.links[run]), float(runs.h[run])
        for near, far, side in ((e, e - 1, 0), (e + 1, e + 2, 1)):
            if runs.links[run + side] < 2 or np.linalg.norm(r[:, near] - r[:, b]) > _AT * h:
                continue
            way = r[:, near] - r[:, far]
            length = float(np.linalg.norm(way))
            if sheaves.tension[q, 1 - side] > law.tension(runs.law[run], length / h - 1.0):
                r[:, near] = r[:, b] + 1e-9 * h * way / length


def turned_at(sheaves: Sheaves, runs: Runs, r: Array) -> Array:
    """Angles by which lines turn at sheaves, (sheave,) rad, at places r (axis, node) in m."""
    behind, own, ahead = (r[:, at] for at in _nodes(sheaves, runs).T)
    one, two = own - behind, ahead - own
    cosine = (one * two).sum(axis=0) / np.maximum(np.linalg.norm(one, axis=0) * np.linalg.norm(two, axis=0), 1e-300)
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))


def gravitational(sheaves: Sheaves, runs: Runs, r: Array) -> float:
    """Potential energy of the weights of pieces beyond that of nodes, J, at places r (axis, node) in m."""
    ends, h = runs.first[sheaves.run] + runs.links[sheaves.run], runs.h[sheaves.run]
    shares = (h - sheaves.ahead) * r[:, ends] + sheaves.ahead * r[:, ends + 1] - h * r[:, sheaves.node]
    return 0.5 * float((sheaves.weight.T * shares).sum())


def damping_of(sheaves: Sheaves, runs: Runs, r: Array) -> sparse.csc_matrix:
    """Forces of the dampers of all links that sheaves divide over velocities, (place, place) N s/m."""
    axes, n = r.shape
    C = sparse.csc_matrix((axes * n, axes * n))
    for b, run in zip(sheaves.node, sheaves.run, strict=True):
        e, longer = int(runs.first[run] + runs.links[run]), np.zeros((axes, n))
        for i, j in ((e, b), (b, e + 1)):
            way = r[:, j] - r[:, i]
            unit = way / max(float(np.linalg.norm(way)), CLOSEST * runs.h[run])
            longer[:, i] -= unit
            longer[:, j] += unit
        row = sparse.csr_matrix(longer.reshape(1, -1))
        C = C + runs.damping[run] / runs.h[run] * (row.T @ row)
    return C.tocsc()
