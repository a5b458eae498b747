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
RELAXED = 1e-4
"""The same where links do not push, for a beginning."""
_ROUNDING = 1e-13
"""Of energies: changes below this part of them say nothing."""

_DIGITS = 4e-16
"""Of positions, which forces cannot be nearer than."""
_LARGEST = 1e-8
"""Tolerance that rounding may make of a smaller one."""

_SHAKE = 1e-3
"""Of a link."""


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
    state = bound.state
    state.velocity[:] = state.predicted[:] = state.lag[:] = 0.0
    begun = 0
    if not bound.model.run_tension_only.all() and not _is_stable(bound):
        begun = _search(_relaxed(bound), iterations, RELAXED).iterations
    found = _search(bound, iterations, TOLERANCE)
    return found._replace(iterations=begun + found.iterations)


def _relaxed(bound: Bound) -> Bound:
    """Return the same State with runs without bending stiffness that do not push: their energy is convex.

    Nodes are shaken a little, as a straight line that is too long balances on its tip.
    """
    model, draw = bound.model.copy(), np.random.default_rng(0)
    shaken = _SHAKE * float(model.link_length.min()) * draw.normal(size=bound.state.position.size)
    free = bound.unknowns()
    bound.state.position += (free @ (free.T @ shaken)).reshape(bound.state.position.shape)
    model.run_tension_only[bound.model.bending_stiffness == 0.0] = 1
    return Bound(model, bound.state)


def _is_stable(bound: Bound) -> bool:
    free = bound.unknowns()
    return _factor((free.T @ bound.linearise().stiffness @ free).tocsc(), 0.0) is not None


def _search(bound: Bound, iterations: int, tolerance: float) -> SearchOutcome:
    state, free = bound.state, bound.unknowns()
    for count in range(iterations + 1):
        at = bound.linearise()
        residual, stiffness = free.T @ at.forces.ravel(), (free.T @ at.stiffness @ free).tocsc()
        largest = float(np.abs(residual).max(initial=0.0))
        rounding = _DIGITS * float((abs(at.stiffness) @ np.abs(state.position).ravel()).max())
        if largest <= max(tolerance, min(rounding / (scale := float(np.abs(at.forces).max())), _LARGEST)) * scale:
            stable = residual.size == 0 or _factor(stiffness, 0.0) is not None
            return SearchOutcome("found" if stable else "unstable", count, largest)
        if count == iterations or not _descend(bound, free, residual, stiffness):
            break
        bound.pass_nodes()
    return SearchOutcome("not found", count, largest)


def _descend(bound: Bound, free: sparse.csc_matrix, residual: Array, stiffness: sparse.csc_matrix) -> bool:
    """Take a step along which the energy decreases; False if there is none."""
    shift, begin = 0.0, bound.state.position.copy()
    model = bound.model  # where nothing is taut, as stiff as if it were
    largest = float(max(abs(stiffness.diagonal()).max(), (model.axial_stiffness / model.link_length).max(initial=0.0)))
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
