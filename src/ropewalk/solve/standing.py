"""Statics of one strand with loads standing on it: the link under a load becomes two that meet at the load.

A point between two nodes takes over part of their masses, the more the nearer it is: all of it on the node itself. Mass
and its first moment are kept (but for the halves at the supports), and nothing jumps where a load passes a node: there
the node left behind is without weight and its two links are in line. The tension beside a load is that of its link
without the part of the point's own weight that lies between: right to the second order, as the shape is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import FRICTIONLESS, Array, Strands
from ropewalk.mechanics.law import tensions
from ropewalk.solve.equilibrium import at_rest, hang_up

# A load nearer to a node than this part of a link stands on the node.
_SNAP = 1e-9
# Tensions beside a frictionless load agree to this part of the forces: well above the rounding of the root finder.
_EQUAL = 1e-10


@dataclass(frozen=True)
class Standing:
    """A strand at rest with loads on it."""

    position: Array  # (axis, node) m, material nodes only
    X: Array  # (point,) m, material coordinates of nodes and contacts
    r: Array  # (axis, point) m, positions of nodes and contacts
    contact: NDArray[np.int64]  # (load,) index of each contact among the points
    force: Array  # (axis, load) N, on the line, hold forces included
    hold: Array  # (load,) N, the hold forces, along x
    first_force: Array  # (axis,) N, start value for a similar shape
    weight: Array  # (axis, point) N, supports included
    between: Array  # (axis, load, side) N, weight between each contact and its links, behind and ahead

    def link_vectors(self, p: Array) -> tuple[Array, Array, Array]:
        """Strain (piece,), tension (piece,) and unit vectors (axis, piece; zero for a piece without length)."""
        d = np.diff(self.r, axis=1)
        length = np.sqrt((d * d).sum(axis=0))
        eps = length / np.diff(self.X) - 1.0
        return eps, tensions(p, eps), d / np.where(length > 0.0, length, 1.0)

    def contact_tensions(self, p: Array) -> Array:
        """Tensions close to the contacts (load, side): behind and ahead; on a support the only one twice."""
        _, T, t = self.link_vectors(p)
        out = np.empty((self.contact.size, 2))
        for k, i in enumerate(self.contact):
            behind, ahead = max(int(i) - 1, 0), min(int(i), T.size - 1)
            if i > 0:
                out[k, 0] = np.linalg.norm(T[behind] * t[:, behind] - self.between[:, k, 0])
            if i < self.X.size - 1:
                out[k, 1] = np.linalg.norm(T[ahead] * t[:, ahead] + self.between[:, k, 1])
            if not 0 < i < self.X.size - 1:
                out[k] = out[k, 1 if i == 0 else 0]
        return out * np.where(T[[max(int(i) - 1, 0) for i in self.contact]] < 0.0, -1.0, 1.0)[:, None]


def lengths_of_pieces(strands: Strands, s: int, xi: Array) -> tuple[Array, NDArray[np.int64], NDArray[np.int64]]:
    """Material coordinates of nodes and contacts, in order; and where the nodes and the contacts are among them."""
    n, h = int(strands.links[s]), float(strands.h[s])
    place = np.asarray(xi) / h
    nearest = np.rint(place)
    place = np.where(np.abs(place - nearest) < _SNAP, nearest, place)
    X, where = np.unique(np.concatenate([np.arange(n + 1.0), place]), return_inverse=True)
    return X * h, where[: n + 1], where[n + 1 :]


def masses(mass: float, place: Array, nodes: NDArray[np.int64], contacts: NDArray[np.int64]) -> tuple[Array, Array]:
    """Masses of nodes and contacts in kg.

    Args:
        mass: of a link, kg.
        place: (point,) material coordinates in links.
        nodes, contacts: where the nodes and the contacts are among the points.

    Returns:
        Masses of all points (point,), and of those of the contacts the part on either side (load, side).
    """
    n = nodes.size - 1
    own = np.full(n + 1, 1.0)
    own[[0, -1]] = 0.5
    links = np.minimum(place[contacts].astype(np.int64), n - 1)
    parts = place[contacts] - links
    wanted = np.zeros(n + 1)
    # A contact on a node takes all of its mass; half-way, half a link's, as if it were a node of the mesh.
    weights = 1.0 - 2.0 * parts * (1.0 - parts)
    np.add.at(wanted, links, weights * (1.0 - parts))
    np.add.at(wanted, links + 1, weights * parts)
    share = 1.0 / np.maximum(wanted, 1.0)  # loads close together share a node
    out, sides = np.zeros(place.size), np.zeros((contacts.size, 2))
    out[nodes] = own * (1.0 - wanted * share)
    for k, (j, part, weight) in enumerate(zip(links, parts, weights, strict=True)):
        first, second = own[j] * weight * (1.0 - part), own[j + 1] * weight * part
        out[contacts[k]] += first * share[j] + second * share[j + 1]
        # What is left of a cell at its node is not between the contact and the middle of the next link.
        behind, ahead = first + part - 0.5, second + 0.5 - part
        sides[k] = np.array([behind, ahead]) * (first * share[j] + second * share[j + 1]) / (first + second)
    return mass * out, mass * sides


def stand(
    strands: Strands,
    s: int,
    ends: tuple[Array, Array],
    xi: Array,
    force: Array,
    contact: NDArray[np.int64],
    before: Standing | None = None,
) -> Standing:
    """Find the rest shape of strand s under its weight and loads at the material coordinates xi.

    Args:
        strands, s: the strands and which of them.
        ends: positions of the two supports, (axis,) m each.
        xi: (load,) m.
        force: (axis, load) N, given forces on the line.
        contact: (load,) CLAMPED, or FRICTIONLESS: a horizontal hold force keeps both tensions equal.
        before: a similar shape to start from; not needed.

    Raises:
        EquilibriumError: no rest shape, or not a single one.
    """
    X, nodes, contacts = lengths_of_pieces(strands, s, xi)
    mass, sides = masses(float(strands.rho[s] * strands.h[s]), X / strands.h[s], nodes, contacts)
    weight = strands.gravity[:, None] * mass
    between = strands.gravity[:, None, None] * sides
    f = weight.copy()
    total, hold = np.array(force, dtype=float), np.zeros(len(xi))
    for i, vector in zip(contacts, total.T, strict=True):  # two loads may stand on one point
        f[:, i] += vector
    hanging = _Hanging(strands.law[s], np.diff(X), f, ends, before.first_force if before is not None else None)
    inside = (contacts > 0) & (contacts < X.size - 1)
    sliding = np.flatnonzero((contact == FRICTIONLESS) & inside)
    if sliding.size:
        guess = before.hold[sliding] if before is not None else None
        hold[sliding] = _hold(hanging, contacts[sliding], between[:, sliding], guess)
        total[0] += hold
        for i, push in zip(contacts, hold, strict=True):
            f[0, i] += push
    rest = at_rest(hanging.p, hanging.ell, f, *ends, hanging.guess)
    return Standing(rest.position[:, nodes], X, rest.position, contacts, total, hold, rest.first_force, weight, between)


@dataclass
class _Hanging:
    """A strand under given forces, to which horizontal ones are added."""

    p: Array
    ell: Array
    f: Array  # (axis, point) N
    ends: tuple[Array, Array]
    guess: Array | None  # force vector of the first link of the last shape, N

    def jumps(self, at: NDArray[np.int64], between: Array, hold: Array) -> Array:
        """Tension ahead less tension behind of each point in N, with horizontal forces added there."""
        f = self.f.copy()
        for i, push in zip(at, hold, strict=True):
            f[0, i] += push
        first, _ = hang_up(self.p, self.ell, f, *self.ends, self.guess)
        self.guess = first
        pulls = first[:, None] - np.concatenate([np.zeros((f.shape[0], 1)), np.cumsum(f[:, 1:-1], axis=1)], axis=1)
        ahead, behind = pulls[:, at] + between[:, :, 1], pulls[:, at - 1] - between[:, :, 0]
        return np.asarray(np.sqrt((ahead * ahead).sum(axis=0)) - np.sqrt((behind * behind).sum(axis=0)))


def _hold(hanging: _Hanging, at: NDArray[np.int64], between: Array, guess: Array | None) -> Array:
    """Find the horizontal hold forces that make the tensions on both sides of the points `at` equal, N."""
    from scipy.optimize import root

    scale = float(np.abs(hanging.f[:, at]).max()) or 1.0
    first = hanging.guess
    for start in (guess, np.zeros(at.size)):
        if start is None:
            continue
        try:
            hanging.guess = first
            found = root(lambda x: hanging.jumps(at, between, x * scale) / scale, start / scale, tol=1e-13)
        except EquilibriumError:
            continue
        if np.abs(found.fun).max() <= _EQUAL * max(1.0, float(np.abs(found.x).max())):
            return np.asarray(found.x * scale)
    raise EquilibriumError(
        "no horizontal force makes the tensions on both sides of a frictionless load equal: it cannot be held so near "
        "to a support; begin or end further from it, lower the force, or write contact: clamped"
    )
