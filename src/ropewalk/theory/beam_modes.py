"""Eigenmodes of the Bernoulli-Euler beam with axial force on an elastic bed, exact for both kinds of ends.

The beam obeys ``EI w'''' - T w'' + k w + c w_t + m w_tt = f``. Every eigenfunction is a sum of at most three
exponentials, ``phi(x) = Re sum_j a_j exp(s_j x - o_j)``, kept bounded by the offsets o_j, and has
``m * integral of phi^2 = 1``; then ``q'' + (c/m) q' + omega^2 q`` is the integral of f phi.

*Simply supported*: sine waves, ``m omega^2 = EI (n pi/L)^4 + T (n pi/L)^2 + k`` (Fryba, Vibration of Solids and
Structures under Moving Loads).

*Clamped* (derived here): with ``EI beta^2 gamma^2 = m omega^2 - k`` and ``gamma^2 - beta^2 = T/EI`` the modes are
cos(beta y) and cosh(gamma y), or sin and sinh, about midspan, where ``beta L = (n + 1) pi - 2 arctan(gamma tau/beta)``,
tau = tanh(gamma L/2) for odd n and coth for even n: one root in each interval of pi, and no growing numbers. Under
compression gamma can become imaginary, gamma = i g; then with ``u, v = (beta -+ g) L/2`` the equations are
``sin(u)/u = -+ sin(v)/v`` for even and odd shapes.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ropewalk.theory import _arguments

__all__ = [
    "Beam",
    "Ends",
    "Modes",
    "buckling_force",
    "natural_frequencies",
    "resonance_speeds",
]

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Ends = Literal["simply_supported", "clamped"]

MOST_MODES = 20_000


@dataclass(frozen=True)
class Modes:
    """Eigenmodes as sums of exponentials; arrays of (term, mode) unless said otherwise."""

    frequency: FloatArray  # omega, rad/s, (mode,)
    wavenumber: FloatArray  # of the travelling part of the shape, 1/m, (mode,)
    exponent: ComplexArray  # s_j, 1/m
    amplitude: ComplexArray  # a_j
    offset: FloatArray  # o_j

    def shape(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """Return the eigenfunctions or a derivative of them at ``x``, shape (*x.shape, mode)."""
        value = np.zeros((*x.shape, len(self.frequency)))
        for s, a, o in zip(self.exponent, self.amplitude, self.offset, strict=True):
            value += (a * s**derivative * np.exp(s * x[..., np.newaxis] - o)).real
        return value


@dataclass(frozen=True)
class Beam:
    """A uniform beam between two supports.

    ``length`` in m, ``bending_stiffness`` EI in N m^2, ``mass`` per length in kg/m; ``tension`` in N, negative for
    compression; ``foundation``, the stiffness of an elastic bed, in N/m^2; ``damping`` in N s/m^2, viscous and the
    same along the beam, so that every mode decays as exp(-damping t/(2 mass)); ``ends`` "simply_supported" or
    "clamped". `ValueError` out of range, and for compression at or beyond buckling.
    """

    length: float
    bending_stiffness: float
    mass: float
    tension: float = 0.0
    foundation: float = 0.0
    damping: float = 0.0
    ends: Ends = "simply_supported"

    def __post_init__(self) -> None:
        _arguments.positive(length=self.length, bending_stiffness=self.bending_stiffness, mass=self.mass)
        _arguments.not_negative(foundation=self.foundation, damping=self.damping)
        _arguments.finite(tension=self.tension)
        if self.ends not in ("simply_supported", "clamped"):
            raise ValueError(f'ends must be "simply_supported" or "clamped", not {self.ends!r}')
        if self.tension < 0.0:
            limit = _buckling_force(self)
            if -self.tension >= limit:
                raise ValueError(f"the beam buckles: tension must be above {-limit:.6g} N, not {self.tension:.6g} N")

    @property
    def decay(self) -> float:
        """Rate at which every mode decays, damping/(2 mass), in 1/s."""
        return self.damping / (2.0 * self.mass)

    def modes(self, count: int) -> Modes:
        """Return the first ``count`` modes (counted by half waves if simply supported, else by frequency)."""
        if not 1 <= count <= MOST_MODES:
            raise ValueError(f"modes must lie between 1 and {MOST_MODES}, not {count}")
        if self.ends == "clamped":
            return _clamped_modes(self, count)
        k: FloatArray = np.asarray(np.arange(1, count + 1) * np.pi / self.length)
        amplitude = np.full((1, count), -1j * np.sqrt(2.0 / (self.mass * self.length)))
        return Modes(
            self._frequency(k**2 * self._bending(k)), k, np.asarray(1j * k[np.newaxis]), amplitude, np.zeros((1, count))
        )

    def enough(self, tolerance: float, speed: float) -> int:
        """Return how many modes leave out less than ``tolerance`` of the static deflection.

        Each term of the series is at most ``1/(omega^2 |1 - r|)`` times a common factor, r = n pi speed/(L omega), and
        at most what n half waves of resonance can build up. Clamped beams are stiffer, so the count serves for them.
        """
        _arguments.positive(tolerance=tolerance)
        n = np.arange(1, MOST_MODES + 1)
        k: FloatArray = np.asarray(n * np.pi / self.length)
        square = np.abs(k**2 * self._bending(k) + self.foundation) / self.mass
        ratio = k * speed / np.sqrt(square)
        half_waves = n * np.pi / np.maximum(ratio, 1e-300)
        bound = np.minimum(1.0 / np.maximum(np.abs(1.0 - ratio), 1e-300), half_waves) / square
        tail = np.cumsum(bound[::-1])[::-1] - bound + bound[-1] * MOST_MODES / 3.0  # beyond: as 1/n^4
        enough = np.flatnonzero(tail <= tolerance * np.sum(1.0 / square))
        if len(enough) == 0:
            raise ValueError(f"tolerance {tolerance:g} is not reached with {MOST_MODES} modes; give modes")
        return int(n[enough[0]])

    def _bending(self, k: FloatArray) -> FloatArray:
        return self.bending_stiffness * k**2 + self.tension

    def _frequency(self, stiffness: FloatArray) -> FloatArray:
        """Frequencies from the eigenvalues of bending and axial force, in N/m^2."""
        # Just below buckling rounding may turn a vanishing stiffness negative.
        return np.sqrt(np.maximum(stiffness + self.foundation, 1e-300) / self.mass)


def natural_frequencies(count: int, *, ends: Ends = "simply_supported", **beam: float) -> FloatArray:
    """Return the first ``count`` natural circular frequencies without damping, in rad/s.

    The keywords are those of `Beam`. Simply supported: in the order of the number n of half waves,
    ``sqrt((EI (n pi/L)^4 + T (n pi/L)^2 + k)/m)``; clamped: in rising order, equation at the head of this module.
    """
    return Beam(ends=ends, **beam).modes(count).frequency


def resonance_speeds(count: int, *, ends: Ends = "simply_supported", **beam: float) -> FloatArray:
    """Return the speeds at which a constant moving force excites the first ``count`` modes at resonance, in m/s.

    The keywords are those of `Beam`. ``omega_n`` over the wavenumber of the mode; simply supported without axial
    force and bed: ``n (pi/L) sqrt(EI/m)`` (Fryba).
    """
    modes = Beam(ends=ends, **beam).modes(count)
    return modes.frequency / modes.wavenumber


def buckling_force(
    *, length: float, bending_stiffness: float, foundation: float = 0.0, ends: Ends = "simply_supported"
) -> float:
    """Return the compression at which the beam buckles, in N, positive.

    Arguments as in `Beam`. Simply supported: the least ``EI (n pi/L)^2 + k (L/(n pi))^2``; clamped: the equations at
    the head of this module at omega = 0, ``4 pi^2 EI/L^2`` without a bed.
    """
    return _buckling_force(Beam(length, bending_stiffness, 1.0, 0.0, foundation, 0.0, ends))


def _buckling_force(beam: Beam) -> float:
    stiffness, h = beam.bending_stiffness, 0.5 * beam.length
    if beam.ends == "simply_supported":
        best = (beam.foundation / stiffness) ** 0.25 * beam.length / np.pi  # half waves, not whole yet
        k = np.maximum(np.array([np.floor(best), np.floor(best) + 1.0]), 1.0) * np.pi / beam.length
        return float(np.min(stiffness * k**2 + beam.foundation / k**2))
    bed = 4.0 * h**2 * np.sqrt(beam.foundation / stiffness)  # v^2 - u^2
    lowest = np.pi
    for sign in (1.0, -1.0):

        def mismatch(u: FloatArray, sign: float = sign) -> FloatArray:
            return _sinc(u) + sign * _sinc(np.sqrt(u**2 + bed))

        lowest = min([lowest, *_roots(mismatch, 1e-9, np.pi, 2000)])
    return float(stiffness * (2.0 * lowest**2 + bed) / (2.0 * h**2))


def _clamped_modes(beam: Beam, count: int) -> Modes:
    axial = beam.tension * beam.length**2 / beam.bending_stiffness
    least = np.sqrt(max(0.0, -axial))  # beta L at gamma = 0
    n = np.arange(1, max(count, int(least / np.pi) + 2) + 1)
    imaginary = _clamped_mismatch(np.full(len(n), least), n, axial) >= 0.0
    parts = [_real_modes(n[~imaginary], axial, least)]
    for odd in (0, 1):
        how_many = int(np.sum(imaginary & (n % 2 == odd)))
        if how_many:
            parts.append(_imaginary_modes(*_imaginary_pairs(odd == 1, how_many, least), odd == 1))
    exponent, amplitude, offset, beta, stiffness, norm = (np.concatenate(p, axis=-1) for p in zip(*parts, strict=True))
    order = np.argsort(stiffness)[:count]
    scale = np.sqrt(beam.mass * beam.length * norm)
    return Modes(
        beam._frequency(stiffness * beam.bending_stiffness / beam.length**4)[order],
        (beta / beam.length)[order],
        np.asarray(exponent / beam.length, dtype=np.complex128)[:, order],
        np.asarray(amplitude / scale, dtype=np.complex128)[:, order],
        offset[:, order],
    )


# Of one family of clamped modes on a beam of unit length: exponents, amplitudes, offsets (term, mode); beta,
# eigenvalue, integral of the square (mode,).
Family = tuple[ComplexArray, ComplexArray, FloatArray, FloatArray, FloatArray, FloatArray]


def _real_modes(n: NDArray[np.int64], axial: float, least: float) -> Family:
    """Modes with real gamma, by bisection: their equation has one root in each interval."""
    low, high = np.maximum(n * np.pi, least), (n + 1.0) * np.pi
    for _ in range(60):
        beta = 0.5 * (low + high)
        below = _clamped_mismatch(beta, n, axial) < 0.0
        low, high = np.where(below, beta, low), np.where(below, high, beta)
    beta = 0.5 * (low + high)
    # The shapes have a removable singularity at gamma = 0; 1e-5 costs them 1e-10.
    gamma = np.maximum(np.sqrt(np.maximum(beta**2 + axial, 0.0)), 1e-5)
    sign = np.where(n % 2 == 1, 1.0, -1.0)  # even shapes, odd shapes
    theta, decayed = 0.5 * beta, np.exp(-gamma)
    end = np.where(sign > 0.0, np.cos(theta), np.sin(theta))
    side = -end / (1.0 + sign * decayed)
    exponent = np.stack([1j * beta, -gamma + 0j, gamma + 0j])
    amplitude = np.stack([np.where(sign > 0.0, 1.0, -1j) * np.exp(-1j * theta), sign * side + 0j, side + 0j])
    offset = np.stack([0.0 * gamma, 0.0 * gamma, gamma])
    tau = ((1.0 - decayed) / (1.0 + decayed)) ** sign
    squeeze = sign * 4.0 * decayed / (1.0 + sign * decayed) ** 2  # sech^2, -csch^2 of gamma/2
    norm = 0.5 + sign * 0.5 * np.sin(beta) / beta + end**2 * (tau / gamma + 0.5 * squeeze)
    return exponent, amplitude, offset, beta, beta**2 * gamma**2, norm


def _clamped_mismatch(beta: FloatArray, n: NDArray[np.int64], axial: float) -> FloatArray:
    gamma = np.sqrt(np.maximum(beta**2 + axial, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        odd_shape = np.where(gamma > 1e-8, gamma / np.tanh(0.5 * gamma), 2.0)
    pull = np.where(n % 2 == 1, gamma * np.tanh(0.5 * gamma), odd_shape)
    mismatch: FloatArray = beta - (n + 1.0) * np.pi + 2.0 * np.arctan2(pull, beta)
    return mismatch


def _imaginary_pairs(even_shape: bool, count: int, radius: float) -> tuple[FloatArray, FloatArray]:
    """Pairs beta > g on the circle of the given radius, for modes that are softer than the bed."""
    sign = 1.0 if even_shape else -1.0

    def mismatch(psi: FloatArray) -> FloatArray:
        u, v = 0.5 * radius * (np.cos(psi) - np.sin(psi)), 0.5 * radius * (np.cos(psi) + np.sin(psi))
        return _sinc(u) + sign * _sinc(v)

    for points in (200, 2000, 20000):
        psi = _roots(mismatch, 1e-9, 0.25 * np.pi, points * (count + 1))
        if len(psi) == count:
            return radius * np.cos(psi), radius * np.sin(psi)
    raise ValueError("tension is too near to a value at which a mode changes its form; change it slightly")


def _imaginary_modes(beta: FloatArray, g: FloatArray, even_shape: bool) -> Family:
    theta, chi, scale = 0.5 * beta, 0.5 * g, np.hypot(beta, g)
    value, slope = (np.cos, np.sin) if even_shape else (np.sin, np.cos)
    # Either condition at the end gives the mixture; take the one that does not vanish.
    by_value = np.stack([value(chi), -value(theta)])
    by_slope = np.stack([g * slope(chi), -beta * slope(theta)]) / scale
    a, b = np.where(np.hypot(*by_value) >= np.hypot(*by_slope), by_value, by_slope)
    sign, unit = (1.0, 1.0 + 0j) if even_shape else (-1.0, -1j)
    norm = 0.5 * (a**2 * (1.0 + sign * np.sin(beta) / beta) + b**2 * (1.0 + sign * np.sin(g) / g))
    none = np.zeros_like(beta)
    exponent = np.stack([1j * beta, 1j * g, none + 0j])
    amplitude = np.stack([unit * a * np.exp(-1j * theta), unit * b * np.exp(-1j * chi), none + 0j])
    return exponent, amplitude, np.stack([none, none, none]), beta, -(beta**2) * g**2, norm


def _sinc(z: FloatArray) -> FloatArray:
    return np.sinc(z / np.pi)


def _roots(function: Callable[[FloatArray], FloatArray], low: float, high: float, points: int) -> FloatArray:
    """All changes of sign between the points of an even grid, by bisection."""
    grid = np.linspace(low, high, points)
    value = function(grid)
    at = np.flatnonzero(value[1:] * value[:-1] < 0.0)
    left, right, rising = grid[at], grid[at + 1], value[at + 1] > 0.0
    for _ in range(60):
        middle = 0.5 * (left + right)
        before = (function(middle) < 0.0) == rising
        left, right = np.where(before, middle, left), np.where(before, right, middle)
    return 0.5 * (left + right)
