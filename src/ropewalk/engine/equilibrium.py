"""Equilibrium of a conservative structure: Newton's method whose steps decrease the energy."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray
from scipy.sparse.linalg import SuperLU, splu

from ropewalk.engine.bound import Bound

Array = NDArray[np.float64]
TOLERANCE = 1e-11
"""Largest residual over the largest force on a node, reactions of supports included."""
_ROUNDING = 1e-13
"""Of energies: changes below this part of them say nothing."""


class SearchOutcome(NamedTuple):
    """How the search has ended: in a minimum of the energy, at a saddle point, or not at all."""

    outcome: Literal["found", "unstable", "not found"]
    iterations: int
    residual: float
    """Largest force that is not balanced, N."""


def find_equilibrium(bound: Bound, iterations: int = 200) -> SearchOutcome:
    """Move the State to an equilibrium nearby, and set its velocities to zero.

    Args:
        bound: structure; positions of its State are where the search begins.
        iterations: largest number of steps of Newton's method.
    """
    state, free = bound.state, bound.unknowns()
    state.velocity[:] = state.predicted[:] = state.lag[:] = 0.0
    for count in range(iterations + 1):
        at = bound.linearise()
        residual, stiffness = free.T @ at.forces.ravel(), (free.T @ at.stiffness @ free).tocsc()
        largest = float(np.abs(residual).max(initial=0.0))
        rounding = np.finfo(float).eps * (abs(at.stiffness) @ np.abs(state.position.ravel()))  # of positions
        if largest <= max(TOLERANCE * float(np.abs(at.forces).max()), float(rounding.max())):
            stable = residual.size == 0 or _factor(stiffness, 0.0) is not None
            return SearchOutcome("found" if stable else "unstable", count, largest)
        if count == iterations or not _descend(bound, free, residual, stiffness):
            break
    return SearchOutcome("not found", count, largest)


def _descend(bound: Bound, free: sparse.csc_matrix, residual: Array, stiffness: sparse.csc_matrix) -> bool:
    """Take a step along which the energy decreases; False if there is none."""
    shift, begin = 0.0, bound.state.position.copy()
    largest = float(abs(stiffness.diagonal()).max()) or 1.0
    energy = _energy(bound)
    while shift < 1e3 * largest:
        factors = _factor(stiffness, shift)
        if factors is not None:
            step = factors.solve(residual)
            slope, part = float(residual @ step), 1.0
            while part > 1e-3:
                bound.state.position[:] = begin + part * (free @ step).reshape(begin.shape)
                allowed = _ROUNDING * max(abs(energy), slope)
                if _energy(bound) <= energy - 1e-4 * part * slope + allowed:
                    return True
                part *= 0.5
        shift = max(1e-6 * largest, 4.0 * shift)
    bound.state.position[:] = begin
    return False


def _energy(bound: Bound) -> float:
    """Return the potential energy, J."""
    found = bound.potentials()
    return found.elastic + found.weight


def _factor(stiffness: sparse.csc_matrix, shift: float) -> SuperLU | None:
    """Return the factors of a stiffness matrix, its diagonal raised by a shift, if it is positive definite."""
    raised = stiffness + shift * sparse.identity(stiffness.shape[0], format="csc")
    try:
        factors = splu(
            raised.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError:  # exactly singular
        return None
    symmetric = np.array_equal(factors.perm_r, factors.perm_c)
    return factors if symmetric and bool(np.all(factors.U.diagonal() > 0.0)) else None
