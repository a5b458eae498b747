"""Eigenvalues of a linearised strand: all of them for a small one, the slowest and the fastest for any size.

Small: the symmetric band matrix A = K/m by LAPACK, and J itself where Kelvin-Voigt damping couples the modes. Large:
the ends of the spectrum of A by shift-invert Lanczos beside shifts that bisection has found, checked by counting; with
Kelvin-Voigt damping shift-invert Arnoldi on J. Values are Rayleigh quotients summed link by link, which keeps the
relative accuracy of slow modes where the stiffness ratio exceeds 1 / (rounding error).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eig_banded
from scipy.sparse.linalg import ArpackError, LinearOperator, eigs, eigsh

from ropewalk.mechanics.chain import Array
from ropewalk.solve.linearised import EPS, Linearised, dense
from ropewalk.solve.one_thread import one_thread

Complex = NDArray[np.complex128]
# Of the iterations: their values are made better by Rayleigh quotients, whose error is the square of this.
TOLERANCE = 1e-9
# An iteration that has not come to an end after so many restarts looks into a cluster that it cannot resolve.
RESTARTS = 60


@dataclass(frozen=True, eq=False)
class Eigenvalues:
    """What was found of one strand; `frequency` and `ratio` belong together, slow to fast."""

    values: Complex  # 1/s, of J, by size; without those of neutral modes if not complete
    frequency: Array  # rad/s, natural (undamped) angular frequencies, rising
    ratio: Array  # damping ratio of each in its undamped shape; above 1 it does not oscillate
    neutral: int  # modes without stiffness
    complete: bool
    method: str


@one_thread()
def every(line: Linearised) -> Eigenvalues:
    """The whole spectrum, dense."""
    slack = line.zero
    if line.is_damped:
        mu, shapes = np.linalg.eigh(dense(line.bands[0]))
        rate = np.einsum("ij,ij->j", shapes, dense(line.bands[1]) @ shapes) + line.drag
        values = _tidy(np.linalg.eigvals(line.jacobian()).astype(complex))
        values[np.abs(values) <= np.sqrt(slack)] = 0.0
        method = "dense, all eigenvalues of J"
    else:
        mu = eig_banded(line.bands[0].T, lower=True, eigvals_only=True) if line.size else np.zeros(0)
        mu = np.where(np.abs(mu) <= slack, 0.0, mu)
        rate = np.full(mu.size, line.drag)
        values = np.concatenate(roots(rate, mu))
        method = "dense, all eigenvalues of the symmetric stiffness matrix"
    up = mu > slack
    frequency = np.sqrt(mu[up])
    neutral = int((np.abs(mu) <= slack).sum())
    return Eigenvalues(by_size(values), frequency, _clean(0.5 * rate[up] / frequency), neutral, True, method)


@one_thread()
def ends(line: Linearised, how_many: int) -> Eigenvalues:
    """The `how_many` slowest and fastest modes and their eigenvalues, by iteration."""
    top, grown, limp = line.highest(), line.below(-line.zero), line.below(line.zero)
    if not top > line.zero:
        values = np.array([line.growth_rate(), -line.drag - line.highest(of_damping=True)], dtype=complex)
        values, none = by_size(values[values != 0.0]), np.zeros(0)
        return Eigenvalues(values, none, none, line.size - grown, False, "bisection by inertia")
    how_many = min(how_many, line.size - limp)
    shift = 0.0
    if limp:  # look beyond the modes that are unstable or without stiffness, amidst those wanted
        shift = 0.5 * (line.positive(1, top) + line.positive(how_many, top))
    slow = [x for x in _modes(line, shift, how_many, top) if line.form(line.stiffness, x) > line.zero]
    fast = _modes(line, top * (1.0 + 1e-10), how_many, top)
    mu = np.array([line.form(line.stiffness, x) for x in (*slow, *fast)])
    rate = np.array([line.form(line.damping, x) for x in (*slow, *fast)]) + line.drag
    order = np.argsort(mu)
    frequency = np.sqrt(mu[order])
    if line.is_damped:
        values, method = _damped(line, slow, fast, how_many, guess_only=limp > grown)
    else:
        values, method = np.concatenate(roots(rate, mu)), "shift-invert Lanczos on the stiffness matrix"
    known = [line.growth_rate(1), line.growth_rate(grown)] if grown else []
    known += [-line.drag] if limp > grown and not line.is_damped else []
    for value in known:
        if value != 0.0 and not np.any(np.abs(values - value) <= 1e-9 * abs(value)):
            values = np.append(values, value)
    ratio = _clean(0.5 * rate[order] / frequency)
    return Eigenvalues(by_size(values), frequency, ratio, limp - grown, False, f"{method}; counts by inertia")


def roots(rate: NDArray[Any], mu: NDArray[Any]) -> tuple[Complex, Complex]:
    """Both roots of s^2 + rate s + mu, without cancellation: the larger one and the smaller one."""
    half = 0.5 * np.asarray(rate, dtype=complex)
    root = np.sqrt(half * half - mu)
    root = np.where((half.conj() * root).real < 0.0, -root, root)
    large = -half - root
    small = np.divide(mu, large, out=np.zeros_like(large), where=large != 0.0)
    real = (np.isreal(half) & np.isreal(mu)) & (large.imag != 0.0)
    return large, np.where(real, large.conj(), small)


def _tidy(values: Complex) -> Complex:
    """What oscillates does not grow, and what grows does not oscillate (linearised.py): the rest is rounding error."""
    swings = np.abs(values.imag) > np.abs(values.real)
    still = np.where(values.real > 0.0, values.real + 0j, values)
    return np.where(swings, np.minimum(values.real, 0.0) + 1j * values.imag, still)


def _clean(ratio: Array) -> Array:
    return np.where(ratio < EPS, 0.0, ratio)


def by_size(values: Complex) -> Complex:
    """Sorted by size, and by imaginary part among those of one size; without negative zeros."""
    return values[np.lexsort((values.imag, np.abs(values)))] + 0.0


def _modes(line: Linearised, shift: float, how_many: int, top: float) -> list[Array]:
    """Shapes of the modes of A nearest to a shift, each of length 1; none is left out, as a count confirms."""
    n = line.size
    try:
        solve = line.solver(shift, quadratic=False)
    except ZeroDivisionError:  # the shift is an eigenvalue to the last digit
        shift += 1e-13 * top
        solve = line.solver(shift, quadratic=False)
    wanted = min(how_many, n - 1)
    operator = LinearOperator((n, n), matvec=lambda x: line.times(line.stiffness, x.ravel()), dtype=float)
    inverse = LinearOperator((n, n), matvec=lambda x: solve(x.ravel()), dtype=float)
    shapes = np.zeros((n, 0))
    for attempt in range(3):
        size = min(n, max(2 * wanted + 1, 20) * (attempt + 1))
        start = np.random.default_rng(attempt).standard_normal(n)
        try:
            mu, shapes = eigsh(
                operator, wanted, sigma=shift, OPinv=inverse, v0=start, ncv=size, tol=TOLERANCE, maxiter=RESTARTS
            )
        except ArpackError:
            continue
        reach = np.abs(mu - shift).max() * (1.0 - 1e-6) - 64.0 * EPS * abs(shift)  # not the last one itself
        if line.below(shift + reach) - line.below(shift - reach) <= (np.abs(mu - shift) < reach).sum():
            break
    if not shapes.shape[1]:
        x = np.random.default_rng(0).standard_normal(n)
        for _ in range(8):
            x = solve(x / np.linalg.norm(x))
        shapes = (x / np.linalg.norm(x))[:, None]
    return list(shapes.T)


def _damped(
    line: Linearised, slow: list[Array], fast: list[Array], how_many: int, *, guess_only: bool
) -> tuple[Complex, str]:
    """Eigenvalues of J at both ends where Kelvin-Voigt damping couples the modes, and how they were found.

    The fastest one belongs to the top of the stiffness or, where that prevails, of the damping. The slowest one belongs
    to the slowest modes or, with very strong damping, to the fastest, which then creep: s = -k / c.
    """
    top = line.highest(of_damping=True) * (1.0 + 1e-10)
    solve = _definite_solver(line.combined(0.0, -1.0, top))
    x = np.random.default_rng(1).standard_normal(line.size)
    for _ in range(8):
        x = solve(x / np.linalg.norm(x))
    creeping = np.concatenate([_stationary(line, x) for x in (*fast, x / np.linalg.norm(x))])
    largest = creeping[np.argmax(np.abs(creeping))]
    if largest.imag == 0.0 and largest.real < 0.0:
        largest = complex(-line.decay_rate(abs(largest)))
    guesses = np.concatenate([*(_stationary(line, x) for x in slow), creeping])
    guesses = by_size(guesses[np.abs(guesses) > np.sqrt(line.zero)])
    upper = _arnoldi(line, largest * (1.0 + 1e-9), how_many, abs(largest))
    lower = None if guess_only else _arnoldi(line, 0.0, 2 * how_many, abs(guesses[0]))
    method = "shift-invert Arnoldi on J"
    if lower is None or upper is None:
        method += " (in part estimated from undamped shapes)"
    lower = guesses if lower is None else lower
    upper = creeping if upper is None else upper
    return np.concatenate([lower[: 2 * how_many], upper[-2 * how_many :]]), method


def _definite_solver(band: Array) -> Callable[[Array], Array]:
    from scipy.linalg import cho_solve_banded, cholesky_banded

    factor = cholesky_banded(band.T, lower=True)
    return lambda b: np.asarray(cho_solve_banded((factor, True), b))


def _stationary(line: Linearised, x: NDArray[Any]) -> Complex:
    """Both roots of x . Q(s) x = 0; one is an eigenvalue to second order in the error of its shape x."""
    mass = (x * x).sum()
    rate = line.form(line.damping, x) / mass + line.drag
    large, small = roots(np.atleast_1d(rate), np.atleast_1d(line.form(line.stiffness, x) / mass))
    return np.concatenate([large, small])


def _arnoldi(line: Linearised, shift: complex, how_many: int, scale: float) -> Complex | None:
    """Eigenvalues of J nearest to a shift, with their conjugates, by size; None if the iteration fails."""
    n = line.size
    shift = complex(shift) if np.imag(shift) != 0.0 else float(np.real(shift))
    try:
        solve = line.solver(shift, quadratic=True)
    except ZeroDivisionError:
        return None

    def inverse(y: Complex) -> Complex:
        f, g = y.ravel()[:n] / scale, y.ravel()[n:]
        r = -solve(g + line.times(line.damping, f) + (line.drag + shift) * f)
        return np.concatenate([scale * r, f + shift * r])

    def product(y: Complex) -> Complex:
        r, w = y.ravel()[:n] / scale, y.ravel()[n:]
        return np.concatenate([scale * w, -line.times(line.stiffness, r) - line.times(line.damping, w) - line.drag * w])

    kind = float if shift.imag == 0.0 else complex
    operator = LinearOperator((2 * n, 2 * n), matvec=product, dtype=kind)
    inverted = LinearOperator((2 * n, 2 * n), matvec=inverse, dtype=kind)
    start = np.random.default_rng(2).standard_normal(2 * n).astype(kind)
    wanted = min(how_many, 2 * n - 2)
    size = min(2 * n, 2 * wanted + 8)
    try:
        found, shapes = eigs(
            operator, wanted, sigma=shift, OPinv=inverted, v0=start, ncv=size, tol=TOLERANCE, maxiter=RESTARTS
        )
    except ArpackError:
        return None
    values = []
    for value, y in zip(found, shapes.T, strict=True):
        # The sum of squares of a complex shape may vanish: then the iteration's own value is the better one.
        x = y[:n] / np.linalg.norm(y[:n])
        better = _stationary(line, x) if abs((x * x).sum()) > 1e-3 else np.array([value])
        best = better[np.argmin(np.abs(better - value))]
        values.append(best if abs(best - value) <= 1e-3 * abs(value) else value)
    return _with_conjugates(np.array(values))


def _with_conjugates(values: Complex) -> Complex:
    """Real ones as they are, each other one with its conjugate, once."""
    values = _tidy(values)
    is_real = np.abs(values.imag) <= 1e-9 * np.abs(values)
    upper = values[~is_real & (values.imag > 0.0)]
    lower = values[~is_real & (values.imag < 0.0)].conj()
    alone = [v for v in lower if not np.any(np.abs(upper - v) <= 1e-9 * abs(v))]
    upper = np.concatenate([upper, np.array(alone, dtype=complex)])
    return by_size(np.concatenate([values[is_real].real.astype(complex), upper, upper.conj()]))
