"""Equilibrium of any structure: the least potential energy next to a shape, by Newton's method."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import Protocol

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.solve.search_budget import SearchBudgetError, search, spend
from ropewalk.solve.sensitivity import NotBesideError, Rests, Solve, by_factors, present
from ropewalk.solve.symmetric import IndefiniteError, Solver, Way, modes

_FULL_STEPS, _FEW_STEPS, _MOST_STEPS = 40, 12, 2000
# Of the size of the structure: longer steps are cut.
_LONGEST = 0.1
# Of the size: a step this small is the last one, as is the first that is no smaller than before, if it is small enough
# for rounding to hide whether the energy falls.
_CLOSE, _ALMOST = 1e-11, 1e-8
# Of the largest stiffness: what rounding may take from the smallest one, which a structure free to slide has none of.
_NEUTRAL = 1e-12
# Part of the largest component of a mode below which it is rounding.
_IN_PLANE = 1e-9
# Of the largest stiffness times the size: forces that rounding makes; and how many shapes in a row with no others tell
# that nothing but that is left.
_ROUNDING, _STALLED = 4.0 * np.finfo(np.float64).eps, 5
# Of the largest stiffness: a direction with less is free.
_SLIDES = 1e-10
_STIFFEST = 1e6  # shift, of the largest stiffness, with which a search downhill gives up
_LEAPS = 10.0 ** -np.arange(1.0, 8.0)  # of the size, off a saddle: stiff lines leave it by short ones only


class Potential(Protocol):
    """A potential energy as a function of a shape: positions of nodes, of which unknowns may move.

    Forces need not come from it: friction makes the stiffness unsymmetric, and only `stability` knows what sticks.
    """

    @property
    def size(self) -> float:
        """Extent of the structure, m."""

    @property
    def free(self) -> sparse.spmatrix:
        """The unit movements of the unknowns, (entry of a shape, unknown), at right angles to each other."""

    @property
    def is_symmetric(self) -> bool:
        """Whether the stiffness is."""

    def energy(self, r: Array) -> float:
        """Potential energy, J."""

    def out_of_balance(self, r: Array) -> Array:
        """Forces that belong to the unknowns, (unknown,) N."""

    def stiffness(self, r: Array) -> sparse.csc_matrix:
        """Change of these forces, with the sign turned, (unknown, unknown) N/m."""

    def convex(self, r: Array) -> sparse.csc_matrix:
        """The same without what makes it indefinite, as far as that is known: the thrust of links."""

    def pattern(self, r: Array) -> sparse.csc_matrix:
        """Where the stiffness may have entries, whatever the shape is."""

    def stability(self, r: Array) -> tuple[sparse.csc_matrix, Integers]:
        """A symmetric stiffness that is definite where the energy is least, and the unknowns that it is of."""

    def part(self, r: Array, way: Array) -> str:
        """Name of the part that moves most with a change of a shape, and where it is."""

    def moved(self, r: Array, step: Array) -> Array:
        """The shape after a step (unknown,) m of the unknowns."""

    def arrived(self, r: Array) -> tuple[Array, bool]:
        """The shape, and whether the structure is another one there: lines may have passed sheaves.

        Raises:
            EquilibriumError: the structure ends there.
        """

    def approaches(self, start: Array, way: Way) -> Iterator[Array]:
        """Shapes from which rest may be easier to find."""


def settle(potential: Potential, start: Array, way: Way = "auto") -> Array:
    """Find the rest next to a shape: a minimum of the potential energy, as its stiffness shows.

    Newton's method in full steps, which may climb the walls of the narrow valley that lines which hardly stretch make
    of the energy; the same from other shapes if that ends at no minimum; and downhill only from the lowest of these,
    and off saddles, if none does.

    Args:
        potential: of the structure.
        start: a shape, m.
        way: of solving, see `solve/symmetric.py`.

    Raises:
        EquilibriumError: no rest was found.
    """
    if potential.out_of_balance(start).size == 0:
        return start.copy()
    rests = present()
    with search():
        try:
            return _settle(potential, start, way) if rests is None else _among(rests, potential, start, way)
        except SearchBudgetError as error:
            if error.shape is None:
                raise
            raise SearchBudgetError(f"{error}: {cause(potential, error.shape)}") from None


def cause(potential: Potential, r: Array) -> str:
    """Why a search has come no further than a shape: what is free to move there, or is not in balance."""
    K, unknowns = potential.stability(r)
    out, largest = potential.out_of_balance(r), float(np.abs(K.diagonal()).max(initial=0.0))
    if np.isfinite(K.data).all() and np.isfinite(out).all() and largest > 0.0:
        rates, shapes = modes(K, np.ones(K.shape[0]), 1)
        if abs(rates[0]) * rates[0] <= _SLIDES * largest:
            way = np.zeros(out.size)
            way[unknowns] = shapes[:, 0]
            part = potential.part(r, np.asarray(potential.free @ way))
            if rates[0] > -np.sqrt(_SLIDES * largest):
                return f"{part} is free to move; hold it with a support, a line or a spring"
            return f"{part} is unstable: lines are in compression there; check lengths, supports and forces"
    worst = int(np.abs(np.nan_to_num(out, nan=np.inf)).argmax())
    part = potential.part(r, np.asarray(potential.free @ (np.arange(out.size) == worst).astype(np.float64)))
    return f"{abs(out[worst]):.3g} N are not in balance on {part}; check supports, lengths and forces there"


def _among(rests: Rests, potential: Potential, start: Array, way: Way) -> Array:
    """The same as one of the equilibria of a run, or beside them; unknowns are the way from the start.

    Raises:
        NotBesideError: see `Rests.settle`.
    """

    def found() -> Array:
        shape = _settle(potential, start, way)
        free = potential.free  # several nodes may go with one unknown
        solve = sparse.linalg.splu((free.T @ free).tocsc())
        moved = np.asarray(solve.solve(np.asarray(free.T @ (shape - start).ravel())))
        if not np.abs(potential.moved(start, moved) - shape).max() <= _CLOSE * potential.size:
            raise NotBesideError("the structure in equilibrium differs from the initial one")
        return moved

    def out(moved: Array) -> Array:
        return potential.out_of_balance(potential.moved(start, moved))

    def factorised(moved: Array) -> Solve:
        return by_factors(potential.stiffness(potential.moved(start, moved)))

    shape = potential.moved(start, rests.settle(found, out, factorised))
    potential.out_of_balance(shape)  # and all that is noted of it
    return shape


def _settle(potential: Potential, start: Array, way: Way) -> Array:
    """The same, solved for."""
    found = _minimum(potential, start, way)
    if found is not None:
        return found
    lowest = start
    for near in potential.approaches(start, way):
        found = _minimum(potential, near, way)
        if found is not None:
            return found
        if potential.energy(near) < potential.energy(lowest):
            lowest = near
    if not potential.is_symmetric:  # friction has no energy to go down by
        raise EquilibriumError("no rest was found where lines rub: ask for more positions, or write friction: 0")
    return _downhill(potential, lowest, way)


def _minimum(potential: Potential, start: Array, way: Way) -> Array | None:
    """Where Newton's method ends, if the energy is least there."""
    found, definite = newton(potential, start, way)
    return found if found is not None and (definite or is_least(potential, found, way)) else None


def nearest(potential: Potential, start: Array, way: Way = "auto") -> Array:
    """The same as `settle` from a shape that is close by: by few steps of Newton's method, or not at all.

    Raises:
        EquilibriumError: it is not close by.
    """
    if present() is not None or potential.out_of_balance(start).size == 0:
        return settle(potential, start, way)
    found, definite = newton(potential, start, way, _FEW_STEPS)
    if found is None or not (definite or is_least(potential, found, way)):
        raise EquilibriumError("no rest was found close by")
    return found


def newton(potential: Potential, start: Array, way: Way = "auto", steps: int = 0) -> tuple[Array | None, bool]:
    """Where Newton's method in full steps ends, cut where they are long, and whether the stiffness is definite there.

    Args:
        potential: of the structure.
        start: a shape, m.
        way: of solving, see `solve/symmetric.py`.
        steps: at most; 0: as many as it takes.

    Returns:
        The shape, None if it does not converge; and False, too, where the stiffness is not symmetric.
    """
    r, size, before = start.copy(), potential.size, np.inf
    solver: Solver | None = None
    stalled = list[Array]()  # shapes out of balance by no more than rounding
    for _ in range(steps or _FULL_STEPS):
        spend(r)
        K, out = potential.stiffness(r), potential.out_of_balance(r)
        if potential.is_symmetric and solver is None:
            solver = Solver(_with_diagonal(potential.pattern(r)), way)
        if np.abs(out).max() <= _ROUNDING * size * float(np.abs(K.diagonal()).max()):
            stalled.append(r)
        if len(stalled) == _STALLED:  # what is free to slide is moved by rounding for ever
            return stalled[0], False
        step, definite = _step(solver, K, out)
        largest = float(np.abs(step).max(initial=0.0))
        if not np.isfinite(largest):
            return None, False
        try:
            r, is_another = potential.arrived(potential.moved(r, _cut(step, largest, size)))
        except EquilibriumError:  # a step too far
            return None, False
        if is_another:
            solver, before = None, np.inf
            continue
        if largest <= _CLOSE * size or before <= largest <= _ALMOST * size:
            return r, definite
        before = largest
    return None, False


def is_least(potential: Potential, r: Array, way: Way = "auto") -> bool:
    """Whether the energy is least there, but for what is free to slide."""
    K, _ = potential.stability(r)
    return is_definite(K, way)


def is_definite(K: sparse.csc_matrix, way: Way = "auto") -> bool:
    """Whether a symmetric stiffness is positive definite, but for what rounding leaves of zero."""
    return _factorised(Solver(_with_diagonal(K), way), K, _NEUTRAL)


def _with_diagonal(K: sparse.csc_matrix) -> sparse.csc_matrix:
    pattern = abs(K)  # what rounding leaves of zero may stand on one side of the diagonal alone
    return pattern + pattern.T + sparse.identity(K.shape[0], format="csc")


def _factorised(solver: Solver, K: sparse.csc_matrix, shift: float) -> bool:
    """Whether a stiffness is definite with a shift, of its largest diagonal entry; the solver has its factor then."""
    if shift:
        largest = float(np.abs(K.diagonal()).max(initial=0.0))
        K = K + shift * largest * sparse.identity(K.shape[0], format="csc")
    try:
        solver.factorise(K)
    except (IndefiniteError, ValueError):  # a ValueError: it is not finite
        return False
    return True


def _cut(step: Array, largest: float, size: float) -> Array:
    return step * min(1.0, _LONGEST * size / max(largest, 1e-300))


def _step(solver: Solver | None, K: sparse.csc_matrix, out: Array) -> tuple[Array, bool]:
    """Solution of K x = out, the least one where the structure may stand anywhere, and whether K is definite.

    Args:
        solver: for symmetric K; None: it is not symmetric.

    Returns:
        The solution is not finite where K is singular.
    """
    if solver is not None and (_factorised(solver, K, 0.0) or _factorised(solver, K, _NEUTRAL)):
        return solver.solve(out), True
    nowhere = np.full_like(out, np.nan)
    if not np.isfinite(K.data).all():
        return nowhere, False
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:  # a saddle on the way
            return np.asarray(scipy.sparse.linalg.splu(K.tocsc()).solve(out)), False
        except RuntimeError:
            return nowhere, False


def _downhill(potential: Potential, start: Array, way: Way) -> Array:
    """Newton's method with a shift that grows until the stiffness is definite and the energy falls."""
    r, size, shift, before = start.copy(), potential.size, 0.0, np.inf
    energy = potential.energy(r)
    solver: Solver | None = None
    for _ in range(_MOST_STEPS):
        K, out = potential.stiffness(r), potential.out_of_balance(r)
        solver = solver or Solver(_with_diagonal(potential.pattern(r)), way)
        if shift == 0.0 and not _factorised(solver, K, 0.0):
            shift = _NEUTRAL
        K = potential.convex(r) if shift else K
        while True:
            spend(r)
            step = solver.solve(out) if _factorised(solver, K, shift) else np.full_like(out, np.nan)
            largest = float(np.abs(step).max(initial=0.0))
            if np.isfinite(largest) and float(step @ out) >= 0.0:
                tried = potential.moved(r, _cut(step, largest, size))
                lower = potential.energy(tried)
                if lower <= energy or largest < _ALMOST * size:
                    break
            if shift > _STIFFEST:
                raise EquilibriumError(f"no equilibrium was found: {cause(potential, r)}")
            shift = max(_NEUTRAL, 10.0 * shift)
        r, is_another = potential.arrived(tried)
        energy = lower
        if is_another:
            solver, energy = None, potential.energy(r)
        if largest <= _CLOSE * size or (before <= largest <= _ALMOST * size and shift <= 1e3 * _NEUTRAL):
            if is_least(potential, r, way):
                return r
            r, shift, largest = _off_saddle(potential, r), 0.0, np.inf
            energy = potential.energy(r)
        before, shift = largest, 0.1 * shift if shift > _NEUTRAL else 0.0
    raise EquilibriumError(f"no equilibrium was found in {_MOST_STEPS} steps: {cause(potential, r)}")


def _off_saddle(potential: Potential, r: Array) -> Array:
    """A shape of less energy than a saddle, along its most negative curvature.

    Raises:
        EquilibriumError: there is none nearby.
    """
    K, unknowns = potential.stability(r)
    energy, step = potential.energy(r), np.zeros(potential.out_of_balance(r).size)
    curved = modes(K, np.ones(K.shape[0]), 1)[1][:, 0]
    curved = np.where(np.abs(curved) > _IN_PLANE * np.abs(curved).max(), curved, 0.0)  # what is in a plane stays
    step[unknowns] = potential.size * curved / np.abs(curved).max()
    for far in _LEAPS:
        for side in (far, -far):
            tried = potential.moved(r, side * step)
            if potential.energy(tried) < energy:
                return tried
    raise EquilibriumError(
        f"the equilibrium is not stable: {cause(potential, r)}, or give lines without bending stiffness law: "
        "{kind: tension_only}"
    )
