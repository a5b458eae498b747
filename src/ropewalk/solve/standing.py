"""Statics of one strand with loads standing on it: the link under a load becomes two that meet at the load."""

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

    def link_vectors(self, p: Array) -> tuple[Array, Array, Array]:
        """Strain (piece,), tension (piece,) and unit vectors (axis, piece; zero for a piece without length)."""
        d = np.diff(self.r, axis=1)
        length = np.sqrt((d * d).sum(axis=0))
        eps = length / np.diff(self.X) - 1.0
        return eps, tensions(p, eps), d / np.where(length > 0.0, length, 1.0)


def lengths_of_pieces(strands: Strands, s: int, xi: Array) -> tuple[Array, NDArray[np.int64], NDArray[np.int64]]:
    """Material coordinates of nodes and contacts, in order; and where the nodes and the contacts are among them."""
    n, h = int(strands.links[s]), float(strands.h[s])
    place = np.asarray(xi) / h
    nearest = np.rint(place)
    place = np.where(np.abs(place - nearest) < _SNAP, nearest, place)
    X, where = np.unique(np.concatenate([np.arange(n + 1.0), place]), return_inverse=True)
    return X * h, where[: n + 1], where[n + 1 :]


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
    f = np.zeros((ends[0].size, X.size))
    f[:, nodes[1:-1]] += strands.rho[s] * strands.h[s] * strands.gravity[:, None]
    total, hold = np.array(force, dtype=float), np.zeros(len(xi))
    for i, vector in zip(contacts, total.T, strict=True):  # two loads may stand on one point
        f[:, i] += vector
    hanging = _Hanging(strands.law[s], np.diff(X), f, ends, before.first_force if before is not None else None)
    inside = (contacts > 0) & (contacts < X.size - 1)
    sliding = np.flatnonzero((contact == FRICTIONLESS) & inside)
    if sliding.size:
        hold[sliding] = _hold(hanging, contacts[sliding], before.hold[sliding] if before is not None else None)
        total[0] += hold
        for i, push in zip(contacts, hold, strict=True):
            f[0, i] += push
    rest = at_rest(hanging.p, hanging.ell, f, *ends, hanging.guess)
    return Standing(rest.position[:, nodes], X, rest.position, contacts, total, hold, rest.first_force)


@dataclass
class _Hanging:
    """A strand under given forces, to which horizontal ones are added."""

    p: Array
    ell: Array
    f: Array  # (axis, point) N
    ends: tuple[Array, Array]
    guess: Array | None  # force vector of the first link of the last shape, N

    def jumps(self, at: NDArray[np.int64], hold: Array) -> Array:
        """How much more the piece ahead of each point pulls than the one behind, N, with horizontal forces added."""
        f = self.f.copy()
        for i, push in zip(at, hold, strict=True):
            f[0, i] += push
        first, _ = hang_up(self.p, self.ell, f, *self.ends, self.guess)
        self.guess = first
        pulls = first[:, None] - np.concatenate([np.zeros((f.shape[0], 1)), np.cumsum(f[:, 1:-1], axis=1)], axis=1)
        T = np.sqrt((pulls * pulls).sum(axis=0))
        return np.asarray(T[at] - T[at - 1])


def _hold(hanging: _Hanging, at: NDArray[np.int64], guess: Array | None) -> Array:
    """Find the horizontal hold forces that make the tensions on both sides of the points `at` equal, N."""
    from scipy.optimize import root

    scale = float(np.abs(hanging.f[:, at]).max()) or 1.0
    first = hanging.guess
    for start in (guess, np.zeros(at.size)):
        if start is None:
            continue
        try:
            hanging.guess = first
            found = root(lambda x: hanging.jumps(at, x * scale) / scale, start / scale, tol=1e-13)
        except EquilibriumError:
            continue
        if np.abs(found.fun).max() <= _EQUAL * max(1.0, float(np.abs(found.x).max())):
            return np.asarray(found.x * scale)
    raise EquilibriumError(
        "no horizontal force makes the tensions on both sides of a frictionless load equal: it cannot be held so near "
        "to a support; begin or end further from it, lower the force, or write contact: clamped"
    )
