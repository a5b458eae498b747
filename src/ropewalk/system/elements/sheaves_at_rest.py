"""Lines over sheaves as rest and small motion see them: energy, stiffness, dampers, and nodes about to pass."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.system.elements.elements_about_rest import ElementsAboutRest, gathered
from ropewalk.system.elements.sheaves import CLOSEST, LITTLE, STICKS
from ropewalk.system.elements.structure import Lines, Runs, Sheaves

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
    return gathered(_nodes(sheaves, runs), np.ones((sheaves.node.size, 3 * axes, 3 * axes)), nodes, axes)


def part_until_passing(sheaves: Sheaves, runs: Runs, way: Array) -> float:
    """The part of a way (axis, node) in m on which no node beside a sheave moves by more than half a link.

    Nodes pass one by one, and only those that are close.
    """
    moved = np.linalg.norm(way[:, _nodes(sheaves, runs)], axis=0).max(axis=1)
    return float(min(1.0, (_MOST * runs.h[sheaves.run] / np.maximum(moved, 1e-300)).min()))


def stiffness_of(sheaves: Sheaves, runs: Runs, r: Array, how: int) -> sparse.csc_matrix:
    """Second derivatives of the energy of all pieces, (place, place) N/m; places as (axis, node); linearised: at rest.

    Args:
        how: SLIPS: with the slip at which it is least; STICKS: with the slip as it is; LITTLE: as small motion has it.
    """
    if sheaves.about.are_there:
        return gathered(sheaves.about.node, sheaves.about.stiffness, r.shape[1], r.shape[0])
    K = [_Derivatives.of(sheaves, runs, r, q).stiffness(_sticks(sheaves, q, how)) for q in range(sheaves.node.size)]
    return gathered(_nodes(sheaves, runs), np.array(K), r.shape[1], r.shape[0])


def _sticks(sheaves: Sheaves, q: int, how: int) -> bool:
    return how == STICKS or (how == LITTLE and bool(sheaves.friction[q] > 0.0))


class _Derivatives(NamedTuple):
    """Derivatives of the energy of both pieces at a sheave, by places of its nodes and by what is behind it, s."""

    across: Array  # (place, place) N/m, with s as it is
    bent: Array  # (place,) N/m, by places and s
    curved: float  # N/m, twice by s
    longer: Array  # (2, place) change of the lengths of both pieces
    firm: Array  # (2,) N/m, change of their tensions with their lengths
    stretch: Array  # (2,)

    @staticmethod
    def of(sheaves: Sheaves, runs: Runs, r: Array, q: int) -> _Derivatives:
        """Those of sheave q at places r (axis, node) in m."""
        axes, run = r.shape[0], int(sheaves.run[q])
        h, p, s = runs.h[run], runs.law[run], sheaves.ahead[q]
        nodes = _nodes(sheaves, runs)[q]
        K, bent, curved = np.zeros((3, axes, 3, axes)), np.zeros((3, axes)), 0.0
        longer, firm, stretches = np.zeros((2, 3, axes)), np.zeros(2), np.zeros(2)
        for one, rest, sign in ((0, s, -1.0), (1, h - s, 1.0)):  # the piece between the places `one` and `one` + 1
            chord = r[:, nodes[one + 1]] - r[:, nodes[one]]
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
            longer[one, one], longer[one, one + 1], firm[one], stretches[one] = -unit, unit, k, stretch
        w = 0.5 * sheaves.weight[q]
        bent[0] -= w
        bent[2] += w
        size = 3 * axes
        return _Derivatives(
            K.reshape(size, size), bent.ravel(), float(curved), longer.reshape(2, size), firm, stretches
        )  # fmt: skip

    def slip(self, sticks: bool) -> Array:
        """Change of s with places, (place,)."""
        return np.zeros_like(self.bent) if sticks or self.curved <= 0.0 else -self.bent / self.curved

    def stiffness(self, sticks: bool) -> Array:
        """Second derivatives with s where the energy is least, or as it is, (place, place) N/m."""
        return np.asarray(self.across + np.outer(self.bent, self.slip(sticks)))

    def tensions(self, sticks: bool) -> Array:
        """Change of both tensions with places, (2, place) N/m."""
        way = np.outer(self.stretch * [1.0, -1.0], self.slip(sticks))
        return np.asarray(self.firm[:, None] * (self.longer - way))


def about_rest(sheaves: Sheaves, runs: Runs, rest: Array) -> Sheaves:
    """The same, with slip and tensions of rest, linearised about places of all nodes there (axis, node) in m."""
    nodes, count, axes = _nodes(sheaves, runs), sheaves.node.size, rest.shape[0]
    size = 3 * axes
    K, C, changes = np.zeros((count, size, size)), np.zeros((count, size, size)), np.zeros((count, 5, size))
    stored, at_rest, force = np.zeros(count), np.zeros((count, 5)), np.zeros((count, size))
    for q, run in enumerate(sheaves.run.tolist()):
        h, p, s, sticks = runs.h[run], runs.law[run], sheaves.ahead[q], _sticks(sheaves, q, LITTLE)
        derived = _Derivatives.of(sheaves, runs, rest, q)
        longer = derived.longer.sum(axis=0)
        K[q], C[q] = derived.stiffness(sticks), runs.damping[run] / h * np.outer(longer, longer)
        one, two = derived.stretch - 1.0
        strain = (s * derived.stretch[0] + (h - s) * derived.stretch[1]) / h - 1.0
        at_rest[q] = *sheaves.tension[q], s, strain, float(law.tension(p, strain))
        slope = float(law.tangent(p, strain))
        changes[q] = *derived.tensions(sticks), derived.slip(sticks), longer / h, slope * longer / h
        stored[q] = s * float(law.stored(p, one)) + (h - s) * float(law.stored(p, two))
        r, w = rest[:, nodes[q]], 0.5 * sheaves.weight[q]
        stored[q] += float(w @ ((h - s) * r[:, 0] + s * r[:, 2] - h * r[:, 1]))
        force[q] = -sheaves.tension[q] @ derived.longer - np.concatenate([(h - s) * w, -h * w, s * w])
    about = ElementsAboutRest.of(nodes, rest, force, K, C, stored)
    return sheaves._replace(about=about, rest=at_rest, changes=changes)


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


def run_over(sheaves: Sheaves, runs: Runs, lines: Lines, station: Array) -> None:
    """Let lines run on until stations (sheave,) in m are at their sheaves."""
    for q, run in enumerate(sheaves.run.tolist()):
        h, begin, was = float(runs.h[run]), float(lines.begin[run]), int(runs.links[run])
        links = int(np.floor((station[q] - begin) / h))
        way = links - was
        runs.links[run], runs.links[run + 1] = links, runs.links[run + 1] - way
        runs.first[run + 1] += way
        lines.begin[run + 1] += way * h
        sheaves.ahead[q] = np.clip(station[q] - begin - links * h, CLOSEST * h, (1.0 - CLOSEST) * h)


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
    if sheaves.about.are_there:
        return gathered(sheaves.about.node, sheaves.about.damping, n, axes)
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
