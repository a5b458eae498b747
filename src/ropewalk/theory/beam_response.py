"""Response of a damped mode, ``q'' + 2 decay q' + omega^2 q = f``: exact for exponentials and for polynomials.

Everything is written with the two poles of the mode and with differences of exponentials that stay accurate when
poles meet, so that undamped, critically damped and overdamped modes are one case.

`ExactStep` and `GaussStep` say what many modes do within a step whose forces are known at the four Gauss points: the
one solves the mode exactly for the polynomial through them, the other by collocation.
"""

import numpy as np
from numpy.typing import NDArray

__all__ = ["GAUSS", "STAGES", "ExactStep", "GaussStep", "difference", "forced", "free", "poles", "second_difference"]

STAGES = 4

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Poles = tuple[ComplexArray, ComplexArray]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_NODES, _WEIGHTS = 0.5 * (1.0 + _NODES), 0.5 * _WEIGHTS


def poles(frequency: FloatArray, decay: float) -> Poles:
    """Return the roots of ``p^2 + 2 decay p + omega^2``, in 1/s, the slower one first, without cancellation."""
    fast = -decay - np.sqrt(decay**2 - frequency**2 + 0j)
    return np.where(fast.imag == 0.0, frequency**2 / fast, fast.conj()), fast


def difference(a: ComplexArray, b: ComplexArray, t: FloatArray, offset: FloatArray | float = 0.0) -> ComplexArray:
    """Return ``(exp(a t) - exp(b t))/(a - b) exp(-offset)``, accurate for a near b and where one of them vanishes."""
    larger = a.real >= b.real
    a, b = np.where(larger, a, b), np.where(larger, b, a)
    z = (b - a) * t
    tiny = np.abs(z) < 1e-100  # complex division of the smallest numbers overflows
    mean = np.where(tiny, 1.0, np.expm1(z) / np.where(tiny, 1.0, z))
    first = np.exp(a * t - offset)
    # The plain form keeps each phase as it is elsewhere, so that after many periods equal terms still cancel.
    plain = (first - np.exp(b * t - offset)) / np.where(a == b, 1.0, a - b)
    return np.where(np.abs(z) > 1.0, plain, t * first * mean)


def second_difference(s: ComplexArray, pair: Poles, t: FloatArray, offset: FloatArray) -> ComplexArray:
    """Return the second divided difference of ``z -> exp(z t - offset)`` over s and both poles.

    It is the response from rest to exp(s t - offset). Where all three are near to each other, seen over t, by its
    series about their mean; else from two first differences, the pole far from s dividing.
    """
    first = np.abs(s - pair[0]) <= np.abs(s - pair[1])
    near, far = np.where(first, pair, pair[::-1])
    gap = np.where(s == far, 1.0, s - far)
    value = (difference(s, near, t, offset) - difference(*pair, t, offset)) / gap
    close = np.abs(s - far) * t < 3e-3
    if np.any(close):
        points = np.stack([np.broadcast_to(z, value.shape)[close] for z in (s, *pair)])
        times, shift = np.broadcast_to(t, value.shape)[close], np.broadcast_to(offset, value.shape)[close]
        mean = np.mean(points, axis=0)
        apart = (points - mean) * times
        series = 0.5 + np.sum(apart**2, axis=0) / 48.0 + np.prod(apart, axis=0) / 120.0
        value[close] = times**2 * np.exp(mean * times - shift) * series
    return value


def free(pair: Poles, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return how q(t) follows from q(0) and q'(0), then how q'(t) does; t broadcasts with the modes."""
    slow, fast = pair
    by_rate = difference(slow, fast, t).real
    even = (0.5 * (np.exp(slow * t) + np.exp(fast * t))).real
    decay = -0.5 * (slow + fast).real
    return even + decay * by_rate, by_rate, -(slow * fast).real * by_rate, even - decay * by_rate


def forced(pair: Poles, t: FloatArray, h: float, degree: int) -> tuple[FloatArray, FloatArray]:
    """Return q and q' from rest under the forces ``(t/h)^k``, k = 0..degree; shape (instant, mode, power).

    ``t`` (instant,) lies within 0..h. While no pole has gone far, by quadrature (16 Gauss points, exact to
    rounding up to a phase of 6); with both far, a polynomial and a free vibration; with one far, pole by pole.
    """
    instants = np.asarray(t, dtype=np.float64)[:, np.newaxis]
    slow, fast = (np.broadcast_to(p, (len(instants), len(p))) for p in pair)
    times = np.broadcast_to(instants, slow.shape)
    value, rate = np.zeros((2, *slow.shape, degree + 1))
    near = np.abs(fast) * times < 6.0
    both_far = ~near & (np.abs(slow) * times >= 4.0)
    for where, method in ((near, _by_quadrature), (both_far, _by_polynomial), (~near & ~both_far, _by_poles)):
        if np.any(where):
            value[where], rate[where] = method(slow[where], fast[where], times[where], h, degree)
    return value, rate


def _by_quadrature(
    slow: ComplexArray, fast: ComplexArray, t: FloatArray, h: float, degree: int
) -> tuple[FloatArray, FloatArray]:
    tau, since = t[:, np.newaxis] * _NODES, t[:, np.newaxis] * (1.0 - _NODES)
    kernel = difference(slow[:, np.newaxis], fast[:, np.newaxis], since)
    kernel_rate = slow[:, np.newaxis] * kernel + np.exp(fast[:, np.newaxis] * since)
    force = (tau[..., np.newaxis] / h) ** np.arange(degree + 1) * (
        t[:, np.newaxis, np.newaxis] * _WEIGHTS[:, np.newaxis]
    )
    return np.einsum("mg,mgk->mk", kernel.real, force), np.einsum("mg,mgk->mk", kernel_rate.real, force)


def _by_polynomial(
    slow: ComplexArray, fast: ComplexArray, t: FloatArray, h: float, degree: int
) -> tuple[FloatArray, FloatArray]:
    square, double = (slow * fast).real * h**2, -(slow + fast).real * h  # of time in units of h
    from_q, from_rate, rate_from_q, rate_from_rate = free((slow, fast), t)
    value, rate = np.zeros((2, len(t), degree + 1))
    theta = t / h
    for k in range(degree + 1):
        coefficient = np.zeros((k + 3, len(t)))
        for i in range(k, -1, -1):
            lower = double * (i + 1) * coefficient[i + 1] + (i + 1) * (i + 2) * coefficient[i + 2]
            coefficient[i] = (float(i == k) - lower) / square
        particular = sum(coefficient[i] * theta**i for i in range(k + 1))
        slope = sum((i * coefficient[i] * theta ** (i - 1) for i in range(1, k + 1)), np.zeros_like(t)) / h
        q, v = -coefficient[0], -coefficient[1] * (k > 0) / h
        value[:, k] = h**2 * (particular + from_q * q + from_rate * v)
        rate[:, k] = h**2 * (slope + rate_from_q * q + rate_from_rate * v)
    return value, rate


def _by_poles(
    slow: ComplexArray, fast: ComplexArray, t: FloatArray, h: float, degree: int
) -> tuple[FloatArray, FloatArray]:
    """Overdamped with poles far apart: each alone; ``I_k = (k I_(k-1) - t^k)/p`` is stable for the far one."""
    k = np.arange(degree + 1)
    tau, since = t[:, np.newaxis] * _NODES, t[:, np.newaxis] * (1.0 - _NODES)
    kernel = np.exp(slow[:, np.newaxis] * since) * _WEIGHTS * t[:, np.newaxis]
    by_slow = np.einsum("mg,mgk->mk", kernel, (tau[..., np.newaxis] / h) ** k)
    by_fast = np.zeros_like(by_slow)
    by_fast[:, 0] = np.expm1(fast * t) / fast
    for i in range(1, degree + 1):
        by_fast[:, i] = (i * by_fast[:, i - 1] / h - (t / h) ** i) / fast
    gap = (slow - fast)[:, np.newaxis]
    value, rate = (by_slow - by_fast) / gap, (slow[:, np.newaxis] * by_slow - fast[:, np.newaxis] * by_fast) / gap
    return value.real, rate.real


class Gauss:
    """The Gauss points of 0..1 and the polynomials through values at them."""

    def __init__(self) -> None:
        nodes, weights = np.polynomial.legendre.leggauss(STAGES)
        self.c = 0.5 * (1.0 + nodes)
        self.powers = np.linalg.inv(np.vander(self.c, increasing=True))  # (power, stage)
        self.once = self.integrals(self.c)[1]
        self.twice = self.once @ self.once
        self.b, self.b_twice = 0.5 * weights, 0.5 * weights @ self.once

    def integrals(self, theta: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return weights (instant, stage) of the interpolated value, its integral and its double integral from 0."""
        k = np.arange(STAGES)
        power = theta[:, np.newaxis] ** k
        first, second = theta[:, np.newaxis] / (k + 1), theta[:, np.newaxis] ** 2 / ((k + 1) * (k + 2))
        return power @ self.powers, (power * first) @ self.powers, (power * second) @ self.powers


GAUSS = Gauss()
Response = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]


class ExactStep:
    """Modes solved exactly for forces that are cubic polynomials in time; any frequency, at any step.

    ``from_q``, ``from_v`` (each (mode, stage)) and ``by_force`` (each (mode, stage, stage)) map the state at the
    beginning and the forces at the stages to accelerations, velocities and coordinates at the stages.
    """

    def __init__(self, frequency: FloatArray, decay: float, h: float) -> None:
        self.pair, self.h = poles(frequency, decay), h
        square, double = frequency[:, np.newaxis] ** 2, 2.0 * decay
        q_q, q_v, v_q, v_v, q_f, v_f = self.response(h * GAUSS.c)
        self.from_q, self.from_v = ((-square * a.T - double * b.T, b.T, a.T) for a, b in ((q_q, v_q), (q_v, v_v)))
        q_f, v_f = q_f.transpose(1, 0, 2), v_f.transpose(1, 0, 2)
        self.by_force = (np.eye(STAGES) - square[..., np.newaxis] * q_f - double * v_f, v_f, q_f)

    def response(self, t: FloatArray) -> Response:
        """Return the maps to coordinates and velocities at instants within the step: from q, from v, and by force.

        Of shapes (instant, mode): q from q, q from v, v from q, v from v; (instant, mode, stage): q and v by force.
        """
        value, rate = forced(self.pair, t, self.h, STAGES - 1)
        return (*free(self.pair, t[:, np.newaxis]), value @ GAUSS.powers, rate @ GAUSS.powers)


class GaussStep:
    """Modes by Gauss collocation (order 8): stable also where forces follow the acceleration, under wheels with mass.

    Attributes as in `ExactStep`. A mode is resolved while frequency times step is below about 2; beyond, its amplitude
    stays right but its phase does not.
    """

    def __init__(self, frequency: FloatArray, decay: float, h: float) -> None:
        self.h = h
        square, c = frequency[:, np.newaxis] ** 2, h * GAUSS.c
        once, twice = h * GAUSS.once, h**2 * GAUSS.twice
        alone = np.linalg.inv(np.eye(STAGES) + 2.0 * decay * once + square[..., np.newaxis] * twice)
        from_q = -square * np.sum(alone, axis=2)
        from_v = -np.einsum("nij,nj->ni", alone, 2.0 * decay + square * c)
        self.from_q = (from_q, from_q @ once.T, 1.0 + from_q @ twice.T)
        self.from_v = (from_v, 1.0 + from_v @ once.T, c + from_v @ twice.T)
        self.by_force = (alone, once @ alone, twice @ alone)

    def response(self, t: FloatArray) -> Response:
        """Return what `ExactStep.response` does, from the polynomials of the collocation."""
        _, first, second = GAUSS.integrals(t / self.h)
        first, second = self.h * first, self.h**2 * second
        by_q, by_v, by_force = self.from_q[0], self.from_v[0], self.by_force[0]
        after = t[:, np.newaxis]
        return (
            1.0 + second @ by_q.T,
            after + second @ by_v.T,
            first @ by_q.T,
            1.0 + first @ by_v.T,
            np.einsum("ti,nij->tnj", second, by_force),
            np.einsum("ti,nij->tnj", first, by_force),
        )
