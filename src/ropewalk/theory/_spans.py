"""A straight line on equal supports in equal distances, shaken with a phase that advances by mu from span to span.

Both modules on periodic supports stand on this one. The line obeys ``mass w_tt + damping w_t + bending_stiffness
w_xxxx - tension w_xx = f`` and a support at every j d pushes back with ``D(omega) w``, ``D = support_stiffness + i
omega support_damping - omega^2 support_mass``; time goes with ``exp(i omega t)``.

Forces ``exp(-i mu j)`` at all j d deflect the bare line by its compliance G. With the two squares z of the
wavenumbers, ``bending_stiffness z^2 + tension z = mass omega^2 - i omega damping``,

    G(x) = [p(x; z1) - p(x; z2)] / (bending_stiffness (z1 - z2)),    of a string p(x; z1)/tension,
    p(x; z) = [s(d - x) + exp(-i mu) s(x)] / (2 cos(sqrt(z) d) - 2 cos(mu)),   s(x) = sin(sqrt(z) x)/sqrt(z),

for 0 <= x <= d. Free waves are where ``1 + D G(0) = 0``. Derived here; equal to Mead's receptance form, Free wave
propagation in periodically supported, infinite beams, J. Sound Vib. 11 (1970).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.theory import _arguments

__all__ = ["SpanLayout"]

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complexfloating[Any, Any]]
_SPACE = 1e250  # the largest number, 1e308, with room for higher bands


@dataclass(frozen=True)
class SpanLayout:
    """Line and supports; `ValueError` out of range. An infinite ``support_stiffness`` stands for rigid supports."""

    spacing: float
    mass: float
    tension: float
    bending_stiffness: float
    support_stiffness: float
    support_mass: float
    damping: float = 0.0
    support_damping: float = 0.0

    def __post_init__(self) -> None:
        _arguments.positive(spacing=self.spacing, mass=self.mass)
        _arguments.not_negative(
            tension=self.tension,
            bending_stiffness=self.bending_stiffness,
            support_mass=self.support_mass,
            damping=self.damping,
            support_damping=self.support_damping,
        )
        if self.tension == self.bending_stiffness == 0.0:
            raise ValueError("tension or bending_stiffness must be positive: without both nothing travels")
        if not self.support_stiffness >= 0.0:
            raise ValueError(f"support_stiffness must not be negative, not {self.support_stiffness}")
        self._check_scales()

    def _check_scales(self) -> None:
        """Raise `ValueError` where squares and fourth powers on the way overflow, or vanish."""
        d, pull, bend = np.float64(self.spacing), np.float64(self.tension), np.float64(self.bending_stiffness)
        with np.errstate(all="ignore"):
            b = np.pi / d
            scales = np.array([d**3, (bend * b**2 + pull) * b**2 / self.mass, pull**2, (bend * b**2) ** 2, bend * b**4])
        used = np.array([1.0, 1.0, pull, bend, bend]) > 0.0
        if not np.all((scales > 1.0 / _SPACE) & (scales < _SPACE), where=used):
            raise ValueError(
                f"spacing {self.spacing:g}, mass {self.mass:g}, tension {self.tension:g} and bending_stiffness "
                f"{self.bending_stiffness:g} give numbers beyond the range of computers: choose other units"
            )

    @property
    def rigid(self) -> bool:
        """Whether the supports do not give way at all."""
        return bool(np.isinf(self.support_stiffness))

    def support(self, omega: ComplexArray) -> ComplexArray:
        """Dynamic stiffness D of a support that is not rigid."""
        return np.asarray(self.support_stiffness + omega * (1j * self.support_damping - self.support_mass * omega))

    def load(self, omega: ComplexArray) -> ComplexArray:
        """What inertia and damping of the line oppose to its stiffness: mass omega^2 - i omega damping."""
        return omega * (self.mass * omega - 1j * self.damping)

    def stiffness(self, q: ComplexArray, omega: ComplexArray) -> ComplexArray:
        """Dynamic stiffness of the bare line for the wave exp(-i q x), N/m^2."""
        return (self.bending_stiffness * q**2 + self.tension) * q**2 - self.load(omega)

    def squares(self, load: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """The squares of the wavenumbers of the bare beam and EI times their difference, as (z1, EI (z1 - z2))."""
        root = np.sqrt(self.tension**2 + 4.0 * self.bending_stiffness * load + 0.0j)
        half = self.tension + root
        return np.where(load == 0.0, 0.0, 2.0 * load / np.where(load == 0.0, 1.0, half)), root

    def compliance(self, x: FloatArray, omega: ComplexArray, mu: ComplexArray) -> ComplexArray:
        """G at ``x`` in 0..d (last axis) for ``omega`` and ``mu`` (first axis), m/N; infinite on its poles."""
        omega, mu = omega[:, None], mu[:, None]
        load = self.load(omega)
        if self.bending_stiffness == 0.0:
            return self._pair(x, load / self.tension, mu) / self.tension
        near, root = self.squares(load)
        far = -(self.tension + root) / (2.0 * self.bending_stiffness)
        small = np.ravel(np.maximum(np.abs(near), np.abs(far)) * self.spacing**2 < 0.5)
        result = np.empty((len(omega), len(x)), dtype=np.complex128)
        n, f, m = near[~small], far[~small], mu[~small]
        result[~small] = (self._pair(x, n, m) - self._pair(x, f, m)) / root[~small]
        if np.any(small):
            result[small] = self._slow(x, near[small], far[small], mu[small])
        return result

    def free_wave_equation(self, q: FloatArray, speed: float) -> FloatArray:
        """Left side of the undamped free waves' equation, without poles, on the line omega = q V, q > 0."""
        omega, d = q * speed, self.spacing
        stiffness = 1.0 if self.rigid else self.support_stiffness - self.support_mass * omega**2
        weight = 0.0 if self.rigid else 1.0
        load = self.mass * omega**2
        cosine = np.cos(q * d)
        if self.bending_stiffness == 0.0:
            theta = np.sqrt(load / self.tension) * d
            gap = np.cos(theta) - cosine
            return np.asarray(weight * 2.0 * self.tension * gap + stiffness * d * np.sin(theta) / theta)
        near, root = self.squares(load + 0.0j)
        theta = np.sqrt(near.real) * d
        phi = np.sqrt((self.tension + root.real) / (2.0 * self.bending_stiffness)) * d
        decay = np.exp(-2.0 * phi)
        other = 1.0 - cosine * 2.0 * np.exp(-phi) / (1.0 + decay)
        gap = np.cos(theta) - cosine
        bending = np.sin(theta) / theta * other + np.expm1(-2.0 * phi) / (1.0 + decay) / phi * gap
        return np.asarray(weight * 2.0 * root.real * gap * other + stiffness * d * bending)

    def _pair(self, x: FloatArray, z: ComplexArray, mu: ComplexArray) -> ComplexArray:
        """p(x; z), all parts times exp(i sqrt(z) d), so that nothing overflows and poles lose no digits."""
        d = self.spacing
        ik = 1j * np.sqrt(z)
        ik = np.where(ik.real > 0.0, -ik, ik)
        back = np.exp(ik * x) * _expm1_ratio(2.0 * ik * (d - x)) * (d - x)
        ahead = np.exp(ik * (d - x) - 1j * mu) * _expm1_ratio(2.0 * ik * x) * x
        return np.asarray((back + ahead) / (np.expm1(ik * d - 1j * mu) * np.expm1(ik * d + 1j * mu)))

    def _slow(self, x: FloatArray, z1: ComplexArray, z2: ComplexArray, mu: ComplexArray) -> ComplexArray:
        """G for wavenumbers below 1/d, the difference quotient in z taken term by term in power series."""
        d = self.spacing

        def series(y: FloatArray, first: int) -> tuple[ComplexArray, ComplexArray]:
            """Of sum (-z)^j y^(2j + first)/(2j + first)! the value at z2 and the quotient between z1 and z2."""
            term = np.asarray(y**first + 0.0j)
            value, quotient, power, mean = term + 0.0 * z2, 0.0 * term + 0.0 * z2, 1.0 + 0.0 * z2, 0.0 * z2
            for j in range(1, 11):
                term = -term * y**2 / ((2 * j + first) * (2 * j + first - 1))
                mean, power = z1 * mean + power, power * z2
                value, quotient = value + term * power, quotient + term * mean
            return value, quotient

        (s_x, q_x), (s_far, q_far), (_, q_c) = series(x, 1), series(d - x, 1), series(np.array([d]), 0)
        phase = np.exp(-1j * mu)
        n, n_quotient = s_far + phase * s_x, q_far + phase * q_x
        m_1, m_2 = (-4.0 * np.sin(0.5 * (k + mu)) * np.sin(0.5 * (k - mu)) for k in (np.sqrt(z1) * d, np.sqrt(z2) * d))
        return np.asarray((n_quotient * m_2 - 2.0 * n * q_c) / (self.bending_stiffness * m_1 * m_2))


def _expm1_ratio(w: ComplexArray) -> ComplexArray:
    """(exp(w) - 1)/w."""
    none = np.abs(w) < 1e-290
    safe = np.where(none, 1.0, w)
    return np.where(none, 1.0, np.expm1(safe) / safe)
