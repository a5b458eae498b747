"""Statics of one strand with loads standing on it: the link under a load becomes two that meet at the load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.chain import FRICTIONLESS, Array, Strands
from ropewalk.mechanics.law import tensions
from ropewalk.solve.equilibrium import Rest, at_rest

# A load nearer to a node than this part of a link stands on the node.
_SNAP = 1e-9


@dataclass(frozen=True)
class Standing:
    """A strand at rest with loads on it."""

    position: Array  # (axis, node) m, material nodes only
    X: Array  # (point,) m, material coordinates of nodes and contacts
    r: Array  # (axis, point) m, positions of nodes and contacts
    contact: NDArray[np.int64]  # (load,) index of each contact among the points
    force: Array  # (axis, load) N, on the line, hold forces included
    first_force: Array  # (axis,) N, start value for a similar shape

    def link_vectors(self, p: Array) -> tuple[Array, Array, Array]:
        """Strain (piece,), tension (piece,) and unit vectors (axis, piece) of the pieces between the points."""
        d = np.diff(self.r, axis=1)
        length = np.sqrt((d * d).sum(axis=0))
        eps = length / np.diff(self.X) - 1.0
        return eps, tensions(p, eps), d / length


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
    guess: Array | None = None,
) -> Standing:
    """Find the rest shape of strand s under its weight and loads at the material coordinates xi.

    Args:
        strands, s: the strands and which of them.
        ends: positions of the two supports, (axis,) m each.
        xi: (load,) m.
        force: (axis, load) N, given forces on the line.
        contact: (load,) CLAMPED, or FRICTIONLESS: a horizontal hold force keeps both tensions equal.
        guess: force vector of the first link of a similar shape; not needed.

    Raises:
        EquilibriumError: no rest shape, or not a single one.
    """
    X, nodes, contacts = lengths_of_pieces(strands, s, xi)
    weight = np.zeros((ends[0].size, X.size))
    weight[:, nodes[1:-1]] += strands.rho[s] * strands.h[s] * strands.gravity[:, None]
    p, ell = strands.law[s], np.diff(X)

    def solve(total: Array, start: Array | None) -> Rest:
        f = weight.copy()
        for k, i in enumerate(contacts):
            f[:, i] += total[:, k]
        return at_rest(p, ell, f, ends[0], ends[1], start)

    total = np.array(force, dtype=float)
    rest = solve(total, guess)
    sliding = [k for k in range(len(xi)) if contact[k] == FRICTIONLESS and 0 < contacts[k] < X.size - 1]
    if sliding:
        rest, total = _hold(solve, total, rest, [(k, int(contacts[k])) for k in sliding], p, ell)
    return Standing(rest.position[:, nodes], X, rest.position, contacts, total, rest.first_force)


def _hold(solve, total, rest, sliding, p, ell):  # type: ignore[no-untyped-def]
    """Find the horizontal hold forces that make the tensions on both sides of sliding contacts equal."""
    from scipy.optimize import root

    def jumps(hold: Array) -> Array:
        nonlocal rest
        trial = total.copy()
        for (k, _), value in zip(sliding, hold, strict=True):
            trial[0, k] += value
        rest = solve(trial, rest.first_force)
        d = np.diff(rest.position, axis=1)
        T = tensions(p, np.sqrt((d * d).sum(axis=0)) / ell - 1.0)
        return np.array([T[i] - T[i - 1] for _, i in sliding])

    scale = float(np.abs(total).max()) or 1.0
    start = np.zeros(len(sliding))
    found = root(lambda x: jumps(x * scale) / scale, start, tol=1e-12)
    hold = found.x * scale
    jumps(hold)
    out = total.copy()
    for (k, _), value in zip(sliding, hold, strict=True):
        out[0, k] += value
    return rest, out
