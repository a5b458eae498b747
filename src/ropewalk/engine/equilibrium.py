"""Equilibrium of a conservative structure: Newton's method whose steps decrease the energy."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray
from scipy.sparse.linalg import SuperLU, splu

from ropewalk.engine.bound import Bound, TangentMatrices

Array = NDArray[np.float64]
TOLERANCE = 1e-11
"""Largest residual over the largest force on a node, reactions of supports included."""
RELAXED = 1e-4
"""The same where links do not push, for a beginning."""
_ROUNDING = 1e-13
"""Of energies: changes below this part of them say nothing."""

_DIGITS = 4e-16
"""Of positions, which forces cannot be nearer than."""
_LARGEST = 1e-6
"""Tolerance that rounding may make of a smaller one."""

_SHAKE = 1e-3
"""Of a link."""


class SearchOutcome(NamedTuple):
    """How the search has ended: in a minimum of the energy, at a saddle point, or not at all."""

    outcome: Literal["found", "unstable", "not found"]
    iterations: int
    residual: float
    """Largest force that is not balanced, N."""


def find_equilibrium(bound: Bound, iterations: int = 200, friction: Array | None = None) -> SearchOutcome:
    """Move the State to an equilibrium nearby, and set its velocities to zero.

    Args:
        bound: structure; positions of its State are where the search begins.
        iterations: largest number of steps of Newton's method.
        friction: (sheave,) N, forces on splits of ropes over sheaves; not a number: the rope sticks. None: no forces.
    """
    state, begun = bound.state, 0
    forces = np.zeros(bound.model.sheave_split.size) if friction is None else friction
    state.velocity[:] = state.predicted[:] = state.lag[:] = 0.0
    search = Search(bound, forces)
    if not bound.model.run_tension_only.all() and not search.is_stable():
        search.shake()
        begun = Search(_relaxed(bound), forces).run(iterations, RELAXED).iterations
    found = search.run(iterations, TOLERANCE)
    return found._replace(iterations=begun + found.iterations)


def _relaxed(bound: Bound) -> Bound:
    """Return the same State with runs without bending stiffness that do not push: their energy is convex."""
    model = bound.model.copy()
    model.run_tension_only[bound.model.bending_stiffness == 0.0] = 1
    return Bound(model, bound.state)


class Search:
    """Newton's method for the free coordinates of a structure."""

    def __init__(self, bound: Bound, friction: Array) -> None:
        self.bound, self.position = bound, bound.state.position
        splits, sticks = bound.model.sheave_split, np.isnan(friction)
        self.push = np.zeros(self.position.shape)
        self.push[0, splits] = np.where(sticks, 0.0, friction)
        moves = ~np.isin(np.flatnonzero(bound.model.mobility), splits[sticks])
        self.free = bound.unknowns()[:, moves]
        self.longest = np.full(self.position.shape, np.ptp(self.position, axis=1).max() or 1.0)  # step, m
        self.longest[0, splits] = 0.5 * bound.model.link_length[bound.model.sheave_run]

    def stiffness(self, at: TangentMatrices) -> sparse.csc_matrix:
        """Return K of the free coordinates."""
        return (self.free.T @ at.stiffness @ self.free).tocsc()

    def shake(self) -> None:
        """Move nodes a little, as a straight line that is too long balances on its tip."""
        size = _SHAKE * float(self.bound.model.link_length.min())
        shaken = self.free @ (size * np.random.default_rng(0).normal(size=self.free.shape[1]))
        self.position += shaken.reshape(self.position.shape)

    def is_stable(self) -> bool:
        """Whether the stiffness is positive definite."""
        return _factor(self.stiffness(self.bound.linearise()), 0.0) is not None

    def energy(self) -> float:
        """Return the potential energy, J."""
        found = self.bound.potentials()
        return found.elastic + found.weight - float((self.push * self.position).sum())

    def run(self, iterations: int, tolerance: float) -> SearchOutcome:
        """Search until the residual over the largest force is small, or as small as digits of positions allow."""
        for count in range(iterations + 1):
            at = self.bound.linearise()
            residual, stiffness = self.free.T @ (at.forces + self.push).ravel(), self.stiffness(at)
            largest, scale = float(np.abs(residual).max(initial=0.0)), float(np.abs(at.forces).max())
            rounding = _DIGITS * float((abs(at.stiffness) @ np.abs(self.position).ravel()).max())
            if largest <= max(tolerance * scale, min(rounding, _LARGEST * scale)):
                stable = residual.size == 0 or _factor(stiffness, 0.0) is not None
                return SearchOutcome("found" if stable else "unstable", count, largest)
            if count == iterations or not self.descend(residual, stiffness):
                break
            self.bound.pass_nodes()
        return SearchOutcome("not found", count, largest)

    def descend(self, residual: Array, stiffness: sparse.csc_matrix) -> bool:
        """Take a step along which the energy decreases; False if there is none."""
        shift, begin, model = 0.0, self.position.copy(), self.bound.model
        taut = (model.axial_stiffness / model.link_length).max(initial=0.0)  # as stiff where nothing is
        largest, energy = float(max(abs(stiffness.diagonal()).max(), taut)) or 1.0, self.energy()
        while shift < 1e3 * largest:
            factors = _factor(stiffness, shift)
            if factors is not None:
                step = factors.solve(residual)
                way = (self.free @ step).reshape(begin.shape)
                slope, part = float(residual @ step), float(np.all(np.abs(way) <= self.longest))
                while part > 1e-3:
                    self.position[:] = begin + part * way
                    allowed = _ROUNDING * max(abs(energy), slope)
                    if self.energy() <= energy - 1e-4 * part * slope + allowed:
                        return True
                    part *= 0.5
            shift = max(1e-6 * largest, 4.0 * shift)
        self.position[:] = begin
        return False


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
