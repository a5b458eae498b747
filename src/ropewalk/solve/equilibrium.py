"""Rest: the shape of least potential energy of one strand under dead forces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import kernel
from ropewalk.mechanics.link import pull_one
from ropewalk.mechanics.stiffness import strand_blocks
from ropewalk.solve.banded import factorise, substitute
from ropewalk.solve.hanging import hang, p_scale

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rest:
    """A strand at rest."""

    position: Array  # (axis, node) m
    first_force: Array  # (axis,) N, force vector of the first link: the start value for a similar shape
    residual: float  # largest unbalanced nodal force, N


@kernel
def residual(p, ell, f, r, force, out):
    """Unbalanced force on the inner nodes (node - 2, axis), minus the gradient of the potential energy; its maximum."""
    dim, n = r.shape[0], ell.size
    for i in range(n):
        q = pull_one(p, 0.0, ell[i], 0.0, r, i)
        for a in range(dim):
            force[a, i] = q * (r[a, i + 1] - r[a, i])
    worst = 0.0
    for i in range(1, n):
        for a in range(dim):
            out[i - 1, a] = force[a, i] - force[a, i - 1] + f[a, i]
            worst = max(worst, abs(out[i - 1, a]))
    return worst


@kernel
def potential(p, ell, f, r):
    """Potential energy of a strand in J: stored energy minus the work of the dead forces."""
    total = 0.0
    for i in range(ell.size):
        square = 0.0
        for a in range(r.shape[0]):
            square += (r[a, i + 1] - r[a, i]) ** 2
        total += ell[i] * law.stored(p, np.sqrt(square) / ell[i] - 1.0)
        if i > 0:
            for a in range(r.shape[0]):
                total -= f[a, i] * r[a, i]
    return total


@kernel
def polish(p, ell, f, r, tolerance, most):
    """Newton's method on the potential energy, with a shift where it is not convex; r is changed.

    Returns:
        The largest unbalanced force that is left, N.
    """
    dim, n = r.shape[0], ell.size
    m = n - 1
    force, x, g = np.zeros((dim, n)), np.zeros((m, dim)), np.zeros((m, dim))
    worst = residual(p, ell, f, r, force, g)
    if m < 1 or worst <= tolerance:
        return worst
    diagonal, inverse = np.zeros((m, dim, dim)), np.zeros((m, dim, dim))
    off, ratio = np.zeros((max(m - 1, 1), dim, dim)), np.zeros((max(m - 1, 1), dim, dim))
    unused, unused_off = np.zeros((m, dim, dim)), np.zeros((max(m - 1, 1), dim, dim))
    energy, before, shift = potential(p, ell, f, r), r.copy(), 0.0
    for _ in range(most):
        strand_blocks(p, 0.0, ell, r, diagonal, off, unused, unused_off)
        for i in range(m):
            for a in range(dim):
                diagonal[i, a, a] += shift
        x[:] = g
        fine = factorise(diagonal, off, off, inverse, ratio)
        if fine:
            substitute(off, inverse, ratio, x)
            fine = (x * g).sum() > 0.0
        if fine:
            before[:] = r
            for i in range(m):
                for a in range(dim):
                    r[a, i + 1] += x[i, a]
            new = potential(p, ell, f, r)
            now = residual(p, ell, f, r, force, x)
            # Near the minimum the energy is all rounding error and the residual decides.
            fine = now < worst if abs(new - energy) <= 1e-12 * abs(energy) else new < energy
            if not fine:
                r[:] = before
        if fine:
            stalled = now > 0.5 * worst and abs(new - energy) <= 1e-12 * abs(energy)
            worst, energy = now, new
            g[:] = x
            shift = 0.1 * shift if shift > 1e-8 * p[2] / ell[0] else 0.0
            if worst <= tolerance or stalled:
                return worst
        elif shift > 1e3 * p[2] / ell[0]:
            return worst
        else:
            shift = max(10.0 * shift, 1e-6 * p[2] / ell[0])
    return worst


def at_rest(p: Array, ell: Array, f: Array, start: Array, end: Array, guess: Array | None = None) -> Rest:
    """Find the rest shape of one strand between fixed ends.

    Args:
        p: axial law, see mechanics/law.py.
        ell: (link,) unstrained lengths, m.
        f: (axis, node) dead forces on the nodes, N.
        start, end: (axis,) m.
        guess: (axis,) force vector of the first link of a similar shape, N; not needed.

    Raises:
        EquilibriumError: there is no rest shape, or more than one.
    """
    dim, n = start.size, ell.size
    length, distance = float(ell.sum()), float(np.linalg.norm(end - start))
    weight = float(np.abs(f[:, 1:-1]).sum())
    r = np.empty((dim, n + 1))
    if n == 1:
        r[:, 0], r[:, 1] = start, end
        return Rest(r, np.zeros(dim), 0.0)
    if weight == 0.0 and length > distance * (1.0 + 1e-12):
        raise EquilibriumError(
            f"the line is slack (length {length:g} m over a distance of {distance:g} m) and nothing pulls on it: "
            "its rest shape is not determined; give gravity, a load, a shorter length or a tension"
        )
    R = np.array(guess) if guess is not None else _first_force(p, f, start, end, length)
    miss = hang(p, ell, f, start, end, 1e-13, R, r)
    if not miss < 1e-9 * length:  # folds: links without tension; come to them step by step
        R = _first_force(p, f, start, end, length)
        for smooth in 10.0 ** -np.arange(2.0, 11.0):
            miss = hang(p, ell, f, start, end, smooth, R, r)
    if not miss < 1e-6 * length:
        raise EquilibriumError(
            "no rest shape was found: the axial law cannot carry the load (its tension does not rise far enough), or "
            "the numbers are too far apart; check length, axial_stiffness, law and forces"
        )
    scale = max(weight, float(np.abs(R).max()))
    worst = polish(p, ell, f, r, 1e-14 * scale, 500)
    if not worst <= 1e-4 * scale + 1e-14 * n * p_scale(p):
        raise EquilibriumError(f"the rest shape is not in balance: {worst:.3g} N are left over of {scale:.3g} N")
    return Rest(r, R, float(worst))


def _first_force(p: Array, f: Array, start: Array, end: Array, length: float) -> Array:
    """A rough force vector at the first link: half the load, and a pull along the chord."""
    chord = end - start
    distance = float(np.linalg.norm(chord))
    total = f[:, 1:-1].sum(axis=1)
    pull = 0.5 * float(np.linalg.norm(total))
    if distance > length:
        pull += float(law.tension(p, distance / length - 1.0))
    if distance == 0.0:
        return 0.5 * total
    return 0.5 * total + pull * chord / distance
