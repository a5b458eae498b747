"""One strand linearised about an instant: its matrices per nodal mass, as bands, and what their inertia says.

Small motions x of the inner nodes about given positions obey x'' + B x' + A x = 0 with A = K/m, B = C/m + drag and the
mass m = rho h that every node carries, riding or not. With A and B symmetric and B never negative, as many eigenvalues
have a positive real part as A has negative ones (Kelvin, Tait and Chetaev), and they are real. The inertia of a band
matrix is the number of signs of its pivots (Sylvester), found in one sweep, so that counts and extreme values come by
bisection at any size.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import get_lapack_funcs

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array, Strands
from ropewalk.mechanics.compiled import kernel
from ropewalk.mechanics.stiffness import link_damping, link_stiffness

EPS = float(np.finfo(float).eps)
# Eigenvalues of A below this part of the largest one are rounding errors of its assembly.
ZERO = 32.0 * EPS


@kernel
def link_blocks(p: Array, c: float, ell: Array, r: Array, stiff: Array, damp: Array) -> None:
    """Stiffness and damping (link, axis, axis) of links of unstrained lengths ell between points r (axis, point)."""
    for i in range(ell.size):
        link_stiffness(p, ell[i], r, i, stiff[i])
        link_damping(c, ell[i], r, i, damp[i])


@kernel
def _negative_pivots(band: Array, first_only: bool) -> int:
    """Number of negative eigenvalues of a symmetric band matrix (row, offset), which is destroyed.

    With `first_only` it stops at the first pivot that is not positive: 0 says that the matrix is positive definite, and
    that answer is stable (no pivoting is needed then).
    """
    n, width = band.shape
    tiny = 1e-300
    for i in range(n):
        for k in range(width):
            tiny = max(tiny, EPS * EPS * abs(band[i, k]))
    count = 0
    for i in range(n):
        pivot = band[i, 0]
        if pivot < 0.0 or (first_only and not pivot > 0.0):
            count += 1
            if first_only:
                return count
        if abs(pivot) < tiny:
            pivot = tiny
        for k in range(1, min(width, n - i)):
            ratio = band[i, k] / pivot
            for j in range(k, min(width, n - i)):
                band[i + k, j - k] -= ratio * band[i, j]
    return count


def bisect(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Smallest value between low and high at which a property holds that holds at high and stays once it holds."""
    while high - low > 4.0 * EPS * high:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if holds(middle):
            high = middle
        else:
            low = middle
    return high


@dataclass(frozen=True, eq=False)
class Linearised:
    """One strand, linearised: a positive semidefinite damping and a stiffness, both as one block for each link."""

    stiffness: Array  # (link, axis, axis) 1/s^2
    damping: Array  # (link, axis, axis) 1/s, Kelvin-Voigt only
    drag: float  # 1/s

    @property
    def size(self) -> int:
        """Number N of displacements; spec(J) has 2 N eigenvalues."""
        return int((self.stiffness.shape[0] - 1) * self.stiffness.shape[1])

    @property
    def is_damped(self) -> bool:
        """Whether there is Kelvin-Voigt damping."""
        return bool(np.any(self.damping != 0.0))

    @cached_property
    def bands(self) -> tuple[Array, Array]:
        """A and C/m as lower bands (row, offset): band[j, k] is the element (j + k, j)."""
        return _band(self.stiffness), _band(self.damping)

    @cached_property
    def zero(self) -> float:
        """Eigenvalues of A up to this size, 1/s^2, count as zero."""
        return ZERO * 4.0 * float(np.abs(self.stiffness).max(initial=0.0))

    def combined(self, stiffness: float, rate: float, unit: float) -> Array:
        """Band of  stiffness A + rate C/m + unit 1."""
        band = stiffness * self.bands[0] + rate * self.bands[1]
        band[:, 0] += unit
        return band

    def below(self, value: float) -> int:
        """Number of eigenvalues of A below a value in 1/s^2."""
        return int(_negative_pivots(self.combined(1.0, 0.0, -value), False))

    def highest(self, *, of_damping: bool = False) -> float:
        """Largest eigenvalue of A in 1/s^2, or of C/m in 1/s."""
        blocks, band = (self.damping, self.bands[1]) if of_damping else (self.stiffness, self.bands[0])
        sizes = np.sqrt((blocks * blocks).sum(axis=(1, 2)))
        if band.shape[0] == 0 or not sizes.max() > 0.0:
            return 0.0
        top = 4.0 * float(sizes.max()) * (1.0 + 1e-9)
        sign = (0.0, -1.0) if of_damping else (-1.0, 0.0)
        return bisect(lambda x: _negative_pivots(self.combined(*sign, x), True) == 0, float(band[:, 0].max()), top)

    def positive(self, count: int, highest: float) -> float:
        """The positive eigenvalue of A in 1/s^2 that has `count` - 1 positive ones below it, by bisection."""
        wanted = self.below(self.zero) + count
        return bisect(lambda x: self.below(x) >= wanted, self.zero, highest * (1.0 + 1e-12))

    def growth_rate(self, rank: int = 1) -> float:
        """The eigenvalue of J with a positive real part that is `rank` from the largest, 1/s; 0 if there is none.

        As many lie above s as s^2 + s B + A has negative eigenvalues.
        """
        if not self.size or self.below(-self.zero) < rank:
            return 0.0

        def has_fewer(s: float) -> bool:
            return bool(_negative_pivots(self.combined(1.0, s, s * (s + self.drag)), rank == 1) < rank)

        return bisect(has_fewer, 0.0, self.frequency_bound)

    def decay_rate(self, at_least: float) -> float:
        """Size of the most negative real eigenvalue of J in 1/s, which must be known to be `at_least` that."""

        def is_beyond(s: float) -> bool:
            return bool(_negative_pivots(self.combined(1.0, -s, s * (s - self.drag)), True) == 0)

        top = self.highest(of_damping=True) + self.drag + self.frequency_bound
        return bisect(is_beyond, at_least * (1.0 - 1e-12), top)

    @property
    def frequency_bound(self) -> float:
        """An upper bound of the square root of every |eigenvalue| of A, 1/s."""
        return 2.0 * float(np.sqrt(np.sqrt((self.stiffness**2).sum(axis=(1, 2))).max())) * (1.0 + 1e-9)

    def times(self, blocks: Array, x: NDArray[Any]) -> NDArray[Any]:
        """The product of A (blocks `stiffness`) or C/m (blocks `damping`) with x (N,), summed link by link."""
        dim = blocks.shape[1]
        pull = np.einsum("iab,ib->ia", blocks, _differences(x, dim))
        return np.asarray(pull[:-1] - pull[1:]).reshape(-1)

    def form(self, blocks: Array, x: NDArray[Any]) -> Any:
        """x . A x or x . (C/m) x, without conjugation; link by link, so that rigid motions cancel exactly."""
        d = _differences(x, blocks.shape[1])
        return np.einsum("ia,iab,ib->", d, blocks, d)

    def solver(self, shift: complex, *, quadratic: bool) -> Callable[[NDArray[Any]], NDArray[Any]]:
        """Factorise A - shift, or shift^2 + shift B + A, and return what solves with it.

        Raises:
            ZeroDivisionError: the matrix is singular.
        """
        if quadratic:
            rate: Any = shift
            band = self.bands[0] + rate * self.bands[1]
            band[:, 0] += rate * (rate + self.drag)
        else:
            band = self.combined(1.0, 0.0, -float(np.real(shift)))
        width, n = band.shape[1] - 1, band.shape[0]
        full = np.zeros((3 * width + 1, n), dtype=band.dtype)
        for k in range(width + 1):
            full[2 * width + k, : n - k] = band[: n - k, k]
            full[2 * width - k, k:] = band[: n - k, k]
        factorise, substitute = get_lapack_funcs(("gbtrf", "gbtrs"), (full,))
        lu, pivots, info = factorise(full, width, width, overwrite_ab=True)
        if info != 0:
            raise ZeroDivisionError("the matrix is singular")
        return lambda b: np.asarray(substitute(lu, width, width, b.astype(full.dtype), pivots)[0])

    def jacobian(self) -> Array:
        """J of y' = J y, y = (displacements, velocities), each node after node: eq. (12); (2 N, 2 N)."""
        n = self.size
        out = np.zeros((2 * n, 2 * n))
        out[:n, n:] = np.eye(n)
        out[n:, :n] = -dense(self.bands[0])
        out[n:, n:] = -dense(self.bands[1]) - self.drag * np.eye(n)
        return out


def linearise(strands: Strands, s: int, r: Array, X: Array) -> Linearised:
    """Linearise strand s about the positions r (axis, node) in m, with material coordinates X (node,) in m.

    Links beside a riding node have their own unstrained lengths. The line is taken at rest and the loads standing:
    velocities add terms of the size of the Kelvin-Voigt tension c eps_t over T, and of a load's speed over the wave
    speed, which are left out, as is the constraint of a frictionless contact.

    Raises:
        RopewalkError: positions are not finite, or a link has no length.
    """
    i, j = int(strands.first[s]), int(strands.first[s] + strands.links[s])
    part, ell = np.ascontiguousarray(r[:, i : j + 1]), np.diff(X[i : j + 1])
    span = np.diff(part, axis=1)
    if not (np.isfinite(part).all() and np.all((span * span).sum(axis=0) > 0.0) and np.all(ell > 0.0)):
        raise RopewalkError("there is no spectrum: positions are not finite, or a link has no length")
    dim, mass = part.shape[0], float(strands.rho[s] * strands.h[s])
    stiff, damp = np.zeros((ell.size, dim, dim)), np.zeros((ell.size, dim, dim))
    link_blocks(strands.law[s], float(strands.damping[s]), ell, part, stiff, damp)
    return Linearised(stiff / mass, damp / mass, float(strands.drag[s]))


def dense(band: Array) -> Array:
    """A symmetric matrix from its lower band."""
    n, width = band.shape
    out = np.zeros((n, n))
    for k in range(min(width, n)):
        j = np.arange(n - k)
        out[j + k, j] = band[: n - k, k]
        out[j, j + k] = band[: n - k, k]
    return out


def _differences(x: NDArray[Any], dim: int) -> NDArray[Any]:
    """Differences over each link (link, axis) of displacements (N,) of the inner nodes."""
    restrained = np.zeros((x.size // dim + 2, dim), dtype=x.dtype)
    restrained[1:-1] = x.reshape(-1, dim)
    return np.diff(restrained, axis=0)


def _band(blocks: Array) -> Array:
    """The lower band of the matrix of the inner nodes from its link blocks."""
    links, dim, _ = blocks.shape
    band = np.zeros((max(links - 1, 0), dim, 2 * dim))
    for a in range(dim):
        for b in range(dim):
            if b >= a:
                band[:, a, b - a] = blocks[:-1, b, a] + blocks[1:, b, a]
            band[:-1, a, dim + b - a] = -blocks[1:-1, b, a]
    return band.reshape(-1, 2 * dim)
