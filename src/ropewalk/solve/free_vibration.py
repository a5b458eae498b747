"""Small free motions of any structure and what stands on it, from its equations of motion."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg as linalg
import scipy.sparse as sparse
from scipy.sparse.linalg import LinearOperator, splu

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array
from ropewalk.results.spectrum import Modes, Spectrum
from ropewalk.solve.equations import Equations
from ropewalk.solve.lanczos import eigenpairs
from ropewalk.solve.one_thread import one_thread
from ropewalk.solve.spectrum import LOWEST, unit
from ropewalk.solve.symmetric import IndefiniteError, Solver, modes

_DENSE = 400  # unknowns up to which the highest frequency is found with all others
_SHIFTS = (0.0, *(10.0 ** np.arange(-8.0, 4.0)))  # of a bound of all squares
# The search for a damped mode ends with a step this small, of its frequency, or with one no smaller than that before.
_MOST_STEPS, _CLOSE, _ALMOST = 20, 1e-11, 1e-4
_UNDAMPED = 1e-12  # damping ratios below are rounding errors
_PROPORTIONAL = 1e-6  # of the damping force of a mode: what is left of it beside the mode is nothing


def free_vibration(equations: Equations, how_many: int | None = None) -> Spectrum:
    """Natural frequencies, damping ratios and shapes of the lowest modes, and the highest frequency.

    Frequencies and shapes are the undamped ones. Ratios are those of the damped modes, -Re lambda / |lambda|, or where
    these do not oscillate x^T C x / (2 w) with x^T M x = 1, right to the first order.

    Args:
        equations: of motion.
        how_many: of the lowest modes.

    Raises:
        RopewalkError: nothing moves that has a mass.
    """
    equations = equations.without_massless()
    K, M, C = equations.stiffness, equations.mass, equations.damping
    count = equations.unknowns
    if count == 0:
        return _empty(equations.name)
    found, shapes = lowest(K, M, min(how_many or LOWEST, count))
    highest = float(np.sqrt(max(_top(K, M), 0.0)))
    damped = bool(C.nnz)
    loss = (shapes * (C @ shapes)).sum(axis=0) if damped else np.zeros(found.size)
    ratio = np.divide(loss, 2.0 * found, out=np.zeros_like(loss), where=found > 0.0)
    moving, growing = found > 0.0, found[found < 0.0]
    w, zeta, moved = found[moving], ratio[moving], shapes[:, moving]
    if damped:
        zeta = np.array([_damped(K, C, M, *mode) for mode in zip(w, zeta, moved.T, strict=True)]).reshape(-1)
    zeta = np.where(np.abs(zeta) <= _UNDAMPED, 0.0, zeta)
    rate, swing = w * zeta, w * np.sqrt(np.maximum(1.0 - zeta**2, 0.0))
    spread = w * np.sqrt(np.maximum(zeta**2 - 1.0, 0.0))  # beyond oscillation: two real eigenvalues
    pairs = [-rate + spread + 1j * swing, -rate - spread - 1j * swing]
    values = np.concatenate([*pairs, -growing, growing, [1j * highest, -1j * highest]])
    sizes = np.abs(values)[np.abs(values) > 0.0]
    nodes = len(equations.line)
    shape = unit(np.asarray((equations.moves @ moved).T).reshape(w.size, nodes, 3))
    return Spectrum(
        name=equations.name, unknowns=2 * count, lowest_frequency=float(w.min(initial=np.inf)) if w.size else 0.0,
        highest_frequency=highest, slowest_damping_ratio=float(zeta[:1].sum()),
        fastest_damping_ratio=float(zeta[-1:].sum()), largest_damping_ratio=float(zeta.max(initial=0.0)),
        smallest_eigenvalue=float(sizes.min(initial=np.inf)) if sizes.size else 0.0, largest_eigenvalue=highest,
        imaginary=not (damped and bool(loss.any())), real_branches=bool((zeta >= 1.0).any()),
        unstable=int(growing.size), growth_rate=float(-growing.min(initial=0.0)), neutral=int((found == 0.0).sum()),
        damping_rate=0.0, eigenvalues=values[np.argsort(np.abs(values))], complete=False,
        method="lowest natural frequencies and the highest",
        modes=Modes(w, zeta, shape, equations.position, equations.line),
    )  # fmt: skip


@one_thread()
def lowest(K: Any, M: Any, how_many: int) -> tuple[Array, Array]:
    """Lowest natural angular frequencies in rad/s, ascending, and their shapes; as `modes`, with any mass matrix.

    Args:
        K: (unknown, unknown) N/m, symmetric, sparse.
        M: (unknown, unknown) kg, positive definite, sparse.
        how_many: modes wanted.
    """
    M = sparse.csc_matrix(M)
    diagonal = M.diagonal()
    if abs(M - sparse.diags(diagonal)).sum() == 0.0:
        return modes(K, diagonal, how_many)
    K = sparse.csc_matrix(0.5 * (K + K.T))
    scale = 1.0 / np.sqrt(diagonal)
    bound = float(np.asarray(abs(sparse.diags(scale) @ K @ sparse.diags(scale)).sum(axis=1)).max())
    count = K.shape[0]
    if count <= _DENSE or how_many > count // 4:
        try:
            squares, vectors = linalg.eigh(K.toarray(), M.toarray(), subset_by_index=(0, how_many - 1))
        except linalg.LinAlgError:
            raise _without_mass() from None
    else:
        squares, vectors = _by_iteration(K, M, bound, how_many)
    squares = np.where(np.abs(squares) <= count * np.finfo(np.float64).eps * bound, 0.0, squares)
    largest = np.take_along_axis(vectors, np.abs(vectors).argmax(axis=0)[np.newaxis], axis=0)
    return np.sign(squares) * np.sqrt(np.abs(squares)), vectors * np.sign(largest)


def _by_iteration(K: Any, M: Any, bound: float, how_many: int) -> tuple[Array, Array]:
    """Lowest eigenpairs by inverse iteration about a shift below all of them."""
    solver, shift = Solver(abs(K) + abs(M)), 0.0
    for part in _SHIFTS:
        shift = part * bound
        try:
            solver.factorise(K + shift * M)
            break
        except IndefiniteError:
            continue
    else:
        raise _without_mass()
    inverse = LinearOperator(K.shape, matvec=solver.solve, dtype=np.float64)
    start = np.random.default_rng(1).uniform(0.5, 1.5, K.shape[0])  # the same each time, with a share of every mode
    squares, vectors = eigenpairs(K, how_many, M=M, sigma=-shift, OPinv=inverse, which="LM", v0=start)
    order = np.argsort(squares)
    return squares[order], vectors[:, order]


def _without_mass() -> RopewalkError:
    return RopewalkError("there is no spectrum: the masses are not positive definite; check the matrices of vehicles")


@one_thread()
def _top(K: Any, M: Any) -> float:
    """The largest square of a natural frequency, 1/s^2."""
    count = K.shape[0]
    if count <= _DENSE:
        last = (count - 1, count - 1)
        return float(linalg.eigh(K.toarray(), M.toarray(), eigvals_only=True, subset_by_index=last)[0])
    M = sparse.csc_matrix(M)
    diagonal = M.diagonal()
    if abs(M - sparse.diags(diagonal)).sum() == 0.0:
        root = sparse.diags(1.0 / np.sqrt(diagonal))
        return float(eigenpairs(root @ K @ root, 1, which="LA", return_eigenvectors=False)[0])
    light = LinearOperator(M.shape, matvec=splu(M).solve, dtype=np.float64)
    return float(eigenpairs(K, 1, M=M, Minv=light, which="LA", return_eigenvectors=False)[0])


def _damped(K: Any, C: Any, M: Any, w: float, ratio: float, shape: Array) -> float:
    """The damping ratio of the damped mode next to an undamped one, by Newton's method for the quadratic problem."""
    felt = C @ shape
    if ratio >= 1.0 or np.abs(felt - 2.0 * ratio * w * (M @ shape)).max() <= _PROPORTIONAL * np.abs(felt).max():
        return ratio
    eigenvalue, x = w * complex(-ratio, np.sqrt(1.0 - ratio**2)), shape.astype(np.complex128)
    across = M @ shape  # what the mode is normalised with
    before = np.inf
    for _ in range(_MOST_STEPS):
        try:
            factor = splu(sparse.csc_matrix(K + eigenvalue * C + eigenvalue**2 * M))
        except RuntimeError:  # it is an eigenvalue to the last digit
            break
        y = factor.solve(C @ x + 2.0 * eigenvalue * (M @ x))
        size = across @ y
        if not np.isfinite(size) or size == 0.0:
            break
        step, x = 1.0 / size, y / size
        eigenvalue -= step
        if abs(step) <= _CLOSE * w or before <= abs(step) <= _ALMOST * w:
            break
        before = abs(step)
    else:
        return ratio
    return float(-eigenvalue.real / abs(eigenvalue)) if eigenvalue.imag > 0.0 else ratio


def _empty(name: str) -> Spectrum:
    return Spectrum(
        name=name, unknowns=0, lowest_frequency=0.0, highest_frequency=0.0, slowest_damping_ratio=0.0,
        fastest_damping_ratio=0.0, largest_damping_ratio=0.0, smallest_eigenvalue=0.0, largest_eigenvalue=0.0,
        imaginary=True, real_branches=False, unstable=0, growth_rate=0.0, neutral=0, damping_rate=0.0,
        eigenvalues=np.zeros(0, dtype=np.complex128), complete=True, method="none",
    )  # fmt: skip
