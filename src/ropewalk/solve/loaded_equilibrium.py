"""Statics of one strand with loads standing on it: the link under a load becomes two that meet at the load.

The tension beside a load is that of its link without the part of the point's own weight that lies between: right to the
second order, as the shape is. See element_split.py for how masses are divided, hold_forces.py for hold forces.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import CLAMPED, Array, Integers, Loads, Strands
from ropewalk.mechanics.compiled import kernel
from ropewalk.solve.catenary_shooting import dot
from ropewalk.solve.element_split import split
from ropewalk.solve.end_conditions import EndConditions
from ropewalk.solve.equilibrium import at_rest
from ropewalk.solve.hold_forces import StrandContacts, StrandHoldForces, coefficient_used

# A tension below this part of that on the other side is none: no friction holds such a load.
_SLACK = 1e-9


@dataclass(frozen=True)
class LoadedStrand:
    """A strand at rest with loads on it."""

    X: Array  # (point,) m, material coordinates of nodes and contacts
    r: Array  # (axis, point) m, positions of nodes and contacts
    node: Integers  # (node,) index of each node among the points
    contact: Integers  # (load,) index of each contact among the points
    strain: Array  # (piece,)
    pull: Array  # (axis, piece) N, force vectors of the pieces
    force: Array  # (axis, load) N, on the line, hold forces included
    hold: Array  # (load,) N, the hold forces, along x
    beside: Array  # (load, side) N, tensions close to the contacts, behind and ahead; on a support the only one twice
    turn: Array  # (load,) rad, the angle by which the line turns at the contact
    friction: Array  # (load,) the friction coefficient that the tensions need at least
    first_force: Array  # (axis,) N, start value for a similar shape
    weight: Array  # (axis, point) N, supports included

    def continued(self, before: LoadedStrand, part: float) -> LoadedStrand:
        """The same shape as a start for the next: its force changed on by a part of what it changed last."""
        return replace(self, first_force=self.first_force + part * (self.first_force - before.first_force))

    @property
    def position(self) -> Array:
        """Positions of the material nodes, (axis, node) m."""
        return self.r[:, self.node]

    @property
    def tension(self) -> Array:
        """Tensions of the pieces, negative in compression, (piece,) N."""
        along = (self.pull * np.diff(self.r, axis=1)).sum(axis=0)
        return np.asarray(np.copysign(np.sqrt((self.pull * self.pull).sum(axis=0)), along))


@dataclass(frozen=True)
class View:
    """What is seen of a strand at rest: its material nodes, its links in their middles, its energy."""

    position: Array  # (node, axis) m
    tension: Array  # (link,) N
    strain: Array  # (link,)
    elastic: float  # J
    gravitational: float  # J

    @staticmethod
    def of(rest: LoadedStrand, p: Array, h: float) -> View:
        """Look at a strand with the law p and links of the unstrained length h in m."""
        position, links = np.empty((rest.node.size, rest.r.shape[0])), rest.node.size - 1
        tension, strain = np.empty(links), np.empty(links)
        arrays = rest.X, rest.r, rest.pull, rest.strain, rest.weight, rest.node
        elastic, gravitational = _look(p, h, *arrays, position, tension, strain)
        return View(position, tension, strain, elastic, gravitational)


@kernel
def _look(p, h, X, r, pull, eps, weight, node, position, tension, strain):
    dim, elastic, gravitational = r.shape[0], 0.0, 0.0
    for i in range(node.size):
        for a in range(dim):
            position[i, a] = r[a, node[i]]
        if i == node.size - 1:
            break
        k = node[i]
        while X[k + 1] <= (i + 0.5) * h and k + 1 < node[i + 1]:
            k += 1
        square, along = 0.0, 0.0
        for a in range(dim):
            square += pull[a, k] * pull[a, k]
            along += pull[a, k] * (r[a, k + 1] - r[a, k])
        tension[i] = np.copysign(np.sqrt(square), along)
        strain[i] = eps[k]
    for k in range(eps.size):
        elastic += law.stored(p, eps[k]) * (X[k + 1] - X[k])
    for k in range(X.size):
        for a in range(dim):
            gravitational -= weight[a, k] * r[a, k]
    return elastic, gravitational


def contacts_on(loads: Loads, on: Integers) -> StrandContacts:
    """How the loads `on` one strand are held; their places are not known yet."""
    nowhere = np.zeros(on.size, dtype=np.int64)
    ahead = np.array([np.copysign(1.0, loads.speed_value[loads.speed_first[k]]) for k in on])
    return StrandContacts(
        nowhere, loads.contact[on], loads.friction[on], loads.friction_model[on], ahead, np.zeros((0, on.size, 2))
    )


def clamped(count: int) -> StrandContacts:
    """Loads that stay where they are, whatever the tensions."""
    codes, nothing = np.full(count, CLAMPED), np.zeros(count)
    return StrandContacts(codes, codes, np.full(count, np.nan), codes, nothing, np.zeros((0, count, 2)))


NOTHING = clamped(0)


def stand(
    strands: Strands,
    s: int,
    restrained: EndConditions,
    xi: Array,
    force: Array,
    contacts: StrandContacts,
    before: LoadedStrand | None = None,
) -> LoadedStrand:
    """Find the rest shape of strand s under its weight and loads at the material coordinates xi.

    Args:
        strands, s: the strands and which of them.
        restrained: its supports.
        xi: (load,) m.
        force: (axis, load) N, given forces on the line.
        contacts: how the loads are held.
        before: a similar shape to start from; not needed.

    Raises:
        EquilibriumError: no rest shape, or not a single one.
    """
    p = strands.law[s]
    X, nodes, at, mass, sides = split(strands.links[s], strands.h[s], strands.rho[s] * strands.h[s], xi)
    weight = strands.gravity[:, None] * mass
    between = strands.gravity[:, None, None] * sides
    f = weight.copy()
    total, hold, ell = np.array(force, dtype=float), np.zeros(len(xi)), np.diff(X)
    for i, vector in zip(at, total.T, strict=True):  # two loads may stand on one point
        f[:, i] += vector
    guess = before.first_force if before is not None else None
    if (contacts.kind != CLAMPED).any():
        g = f.copy()
        g[:, 0] += restrained.force[0]
        g[:, -1] += restrained.force[1]
        placed = StrandContacts(at, contacts.kind, contacts.friction, contacts.model, contacts.ahead, between)
        restraint = StrandHoldForces(p, ell, g, restrained, placed, guess)
        hold = restraint.forces(before.hold if before is not None else hold)
        guess = restraint.first_force
        total[0] += hold
        np.add.at(f[0], at, hold)
    rest = at_rest(p, ell, f, restrained, guess)
    beside, turn, friction = np.empty((at.size, 2)), np.empty(at.size), np.empty(at.size)
    _beside(rest.pull, rest.position, at, between, contacts.model, beside, turn, friction)
    return LoadedStrand(
        X,
        rest.position,
        nodes,
        at,
        rest.strain,
        rest.pull,
        total,
        hold,
        beside,
        turn,
        friction,
        rest.first_force,
        weight,
    )


@kernel
def _beside(pull, r, at, between, model, beside, turn, friction):
    """Tensions on both sides of the contacts, the angles between them, and the friction that they need."""
    dim, last = pull.shape
    behind, ahead = np.empty(dim), np.empty(dim)
    for k in range(at.size):
        i = at[k]
        first, second = min(max(i - 1, 0), last - 1), min(i, last - 1)
        along_behind = along_ahead = 0.0
        for d in range(dim):
            behind[d], ahead[d] = pull[d, first] - between[d, k, 0], pull[d, second] + between[d, k, 1]
            if i == 0:
                behind[d] = ahead[d]
            elif i == last:
                ahead[d] = behind[d]
            along_behind += behind[d] * (r[d, first + 1] - r[d, first])
            along_ahead += ahead[d] * (r[d, second + 1] - r[d, second])
        b, a = np.sqrt(dot(behind, behind)), np.sqrt(dot(ahead, ahead))
        # A link in compression pushes: its force points backwards.
        beside[k, 0] = b if along_behind >= 0.0 else -b
        beside[k, 1] = a if along_ahead >= 0.0 else -a
        if not min(a, b) > _SLACK * max(a, b):
            turn[k], friction[k] = np.nan, np.inf if max(a, b) > 0.0 else 0.0
            continue
        cosine, across = dot(ahead, behind) / (a * b), 0.0
        for d in range(dim):
            across += (ahead[d] / a - cosine * behind[d] / b) ** 2
        turn[k] = np.arctan2(np.sqrt(across), cosine)
        friction[k] = coefficient_used(model[k], np.log(a / b), turn[k])
