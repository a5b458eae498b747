"""Constant force that enters a taut string at one support and travels to the other with constant speed.

The string obeys ``mass w_tt = tension w_xx + force delta(x - V t)`` between fixed ends and is at rest at t =
0.

Write ``y = min(V t, L)`` for the place of the load, ``s = c t`` for the path of a wave and ``alpha = V/c``.
Fryba's modal series (Vibration of Solids and Structures under Moving Loads) can be summed; the sum is

    w = F / (P (1 + alpha)) * (min(x, y) - y phi),

where ``phi`` is the part of the phase interval from ``y`` to ``s`` (after the load has left: from
``L + c t - L/alpha`` to ``c t``) on which the 2L-periodic continuation of "phase below x" holds, that is,
which lies in one of the windows ``2kL - x .. 2kL + x``. The factor 1/(1 - alpha) of the usual form has been
absorbed in ``phi``, so nothing cancels near alpha = 1; at alpha = 1 the interval is a point and ``phi`` is 0
or 1, and 1/2 on the edge of a window, which is the value the series converges to at the displacement jump.
Derived in docs/notes.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

__all__ = [
    "drive_force",
    "moving_force",
    "moving_force_path",
    "moving_force_slope",
    "moving_force_velocity",
    "wave_resistance",
    "wave_speed",
]

FloatArray = NDArray[np.float64]


def wave_speed(*, tension: float, mass: float) -> float:
    """Return the speed of transverse waves on a taut string, in m/s.

    ``tension`` in N and ``mass`` per length in kg/m, both positive or `ValueError`. c = sqrt(tension/mass).
    """
    _arguments.positive(tension=tension, mass=mass)
    return float(np.sqrt(tension / mass))


def moving_force(
    x: ArrayLike,
    t: ArrayLike,
    *,
    force: float,
    speed: float,
    length: float,
    tension: float,
    mass: float,
    modes: int | None = None,
) -> FloatArray:
    """Return the deflection of a taut string under a moving force, in m, positive in the load's direction.

    ``x`` (m, within 0..length) and ``t`` (s; at rest before 0) broadcast and give the shape of the result.
    ``force`` in N, ``speed`` >= 0 in m/s (below, at or above the wave speed), ``length`` in m, ``tension`` in
    N, ``mass`` in kg/m. The result is exact, or the sum of the first ``modes`` sine modes. After its passage
    the load is gone and the string vibrates freely. `ValueError` for arguments out of range.

    Exact form: see the head of this module. Modes: Fryba; "Walking the Line", Fig. 5; with
    ``q_n = 2 F L / (pi^2 n^2 P (1 + alpha)) (sin n pi y/L - (n pi y/L) mean of cos n pi sigma/L)``,
    the mean over the same phase interval, which is regular at alpha = 1.
    """
    x, passage = _at(x, t, speed, length, tension, mass)
    scale = force / (tension * (1.0 + passage.alpha))
    if modes is not None:
        return scale * _modal_shape(x, passage, modes)
    return scale * (np.minimum(x, passage.load) - passage.load * passage.fraction(x))


def moving_force_slope(
    x: ArrayLike,
    t: ArrayLike,
    *,
    force: float,
    speed: float,
    length: float,
    tension: float,
    mass: float,
) -> FloatArray:
    """Return the slope dw/dx of the deflection that `moving_force` gives, without unit.

    Arguments and errors as there. At a kink (the load, a wave front) it is the mean of the two sides. At
    exactly the wave speed the displacement jump at the load has no slope and is left out.

    ``w_x = F / (P (1 + alpha)) * (H(y - x) - y N / |interval|)``, N the number of window edges in the
    interval.
    """
    x, passage = _at(x, t, speed, length, tension, mass)
    behind = np.where(passage.gone, 1.0, np.heaviside(passage.load - x, 0.5)) * (passage.load > 0.0)
    return force / (tension * (1.0 + passage.alpha)) * (behind - passage.load * passage.edge_density(x))


def moving_force_velocity(
    x: ArrayLike,
    t: ArrayLike,
    *,
    force: float,
    speed: float,
    length: float,
    tension: float,
    mass: float,
) -> FloatArray:
    """Return the velocity dw/dt of the deflection that `moving_force` gives, in m/s.

    Arguments and errors as there. At a kink it is the mean of the two sides; at exactly the wave speed the
    travelling displacement jump is left out.

    The time derivative of the formula at the head of this module: with h(sigma) = 1 inside the windows, ``w_t
    = F / (P (1 + alpha)) (V H(x - y) - d(y phi)/dt)``, and ``d(y phi)/dt = (c h(s) - V h(y)) V/(c - V)``
    during the passage, ``(h(s) - h(s - L/alpha + L)) c V/(c - V)`` after it.
    """
    x, passage = _at(x, t, speed, length, tension, mass)
    c = wave_speed(tension=tension, mass=mass)
    ahead = np.heaviside(x - passage.load, 0.5)
    scale = force / (tension * (1.0 + passage.alpha))
    return scale * (speed * passage.under_way * ahead - _load_fraction_rate(x, passage, speed, c))


def moving_force_path(
    t: ArrayLike, *, force: float, speed: float, length: float, tension: float, mass: float
) -> FloatArray:
    """Return the deflection under the moving load, in m, shape of ``t``; 0 once the load has left.

    Arguments and errors as in `moving_force`. On the way it is ``F V t / (P (1 + alpha))`` up to 2L/(V + c),
    and for V > c zero up to 2L/(V + c); at V = c half the jump, ``F c t / (4 P)``.
    """
    _require_motion(speed, length, tension, mass)
    place = np.clip(speed * np.asarray(t, dtype=np.float64), 0.0, length)
    return moving_force(place, t, force=force, speed=speed, length=length, tension=tension, mass=mass)


def drive_force(t: ArrayLike, *, force: float, speed: float, length: float, tension: float, mass: float) -> FloatArray:
    """Return the force along the string that keeps the load's speed against the slope, in N, shape of ``t``.

    Arguments and errors as in `moving_force`; 0 before the entry and after the exit. It is ``-F`` times the
    mean slope under the load: ``F^2 (2 alpha - 1) / (2 P (1 - alpha^2))`` from the support to 2L/(V + c) for
    V < c, negative for alpha < 1/2 because the support's image pushes. Infinite at exactly the wave speed, so
    that speed is a `ValueError`.
    """
    _require_motion(speed, length, tension, mass)
    _require_not_wave_speed(speed, tension, mass)
    t = np.asarray(t, dtype=np.float64)
    place = np.clip(speed * t, 0.0, length)
    slope = moving_force_slope(place, t, force=force, speed=speed, length=length, tension=tension, mass=mass)
    return -force * np.where((place > 0.0) & (place < length), slope, 0.0)


def wave_resistance(*, force: float, speed: float, tension: float, mass: float) -> float:
    """Return the force along the string that keeps a load moving far from any support, in N.

    ``force`` in N, ``speed`` >= 0 in m/s, ``tension`` in N, ``mass`` in kg/m. `ValueError` out of range and
    at exactly the wave speed, where it is infinite. The load started suddenly on an infinite string: ``F^2
    alpha / (2 P (1 - alpha^2))`` below the wave speed, ``F^2 / (2 P (alpha^2 - 1))`` above it. Derived in
    docs/notes.
    """
    _require_motion(speed, 1.0, tension, mass)
    _require_not_wave_speed(speed, tension, mass)
    c = wave_speed(tension=tension, mass=mass)
    alpha = speed / c
    return force**2 * min(alpha, 1.0) * c / (2.0 * tension * abs(c - speed) * (1.0 + alpha))


@dataclass(frozen=True)
class _Passage:
    """Place of the load and phase interval of the solution; arrays of the shape of the time argument.

    The windows are even in the phase, so the interval may be counted from the load's end upwards even where
    the wave lags behind the load (V > c); both its ends stay exact.
    """

    alpha: float
    period: float  # 2 L
    load: FloatArray  # y: V t, then L
    start: FloatArray  # the load's end of the phase interval, reduced to 0..2L; the other is the wave's
    width: FloatArray  # length of the phase interval, >= 0
    under_way: FloatArray  # 1 while the load is on the string, else 0
    gone: NDArray[np.bool_]

    def fraction(self, x: FloatArray) -> FloatArray:
        """phi: the part of the phase interval inside the windows ``2kL - x .. 2kL + x``."""
        whole, rest = self._whole_periods()
        inside = 2.0 * x * whole
        for centre in self._centres(rest):
            upper = np.minimum(rest, centre + x - self.start)
            inside = inside + np.maximum(upper - np.maximum(centre - x - self.start, 0.0), 0.0)
        return np.where(self.width > 0.0, inside / self._safe_width(), self._indicator(x, self.start))

    def edge_density(self, x: FloatArray) -> FloatArray:
        """d phi / dx: window edges in the phase interval (halves on its ends) by its length."""
        whole, rest = self._whole_periods()
        count = 2.0 * whole + np.zeros_like(x)
        for centre in self._centres(rest):
            for edge in (centre - x - self.start, centre + x - self.start):
                count = count + np.heaviside(edge, 0.5) * np.heaviside(rest - edge, 0.5)
        return np.where(self.width > 0.0, count / self._safe_width(), 0.0)

    def indicator_at_ends(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """1 where the wave's and the load's end of the interval lie in a window, 1/2 on an edge, else 0."""
        _, rest = self._whole_periods()
        return self._indicator(x, self.start + rest), self._indicator(x, self.start)

    def _indicator(self, x: FloatArray, phase: FloatArray) -> FloatArray:
        inside = np.zeros(np.broadcast_shapes(x.shape, phase.shape))
        for centre in (0.0, self.period, 2.0 * self.period):
            inside += np.heaviside(centre + x - phase, 0.5) - np.heaviside(centre - x - phase, 0.5)
        return inside

    def _whole_periods(self) -> tuple[FloatArray, FloatArray]:
        whole = np.floor(self.width / self.period)
        return whole, self.width - whole * self.period

    def _centres(self, rest: FloatArray) -> list[float]:
        """Centres of the windows that the reduced phase interval can touch."""
        reach = float(np.max(self.start + rest, initial=0.0)) + 0.5 * self.period
        return [centre for centre in (0.0, self.period, 2.0 * self.period) if centre <= reach]

    def _safe_width(self) -> FloatArray:
        return np.where(self.width > 0.0, self.width, 1.0)


def _passage(t: FloatArray, speed: float, length: float, tension: float, mass: float) -> _Passage:
    c = wave_speed(tension=tension, mass=mass)
    exit_time = length / speed if speed > 0.0 else np.inf
    t = np.maximum(t, 0.0)
    gone = t >= exit_time
    load = np.where(gone, length, np.minimum(speed * t, length))
    phase_at_load = load + c * np.where(gone, t - exit_time, 0.0)
    return _Passage(
        alpha=speed / c,
        period=2.0 * length,
        load=load,
        start=np.mod(phase_at_load if speed <= c else -phase_at_load, 2.0 * length),
        width=abs(c - speed) * np.minimum(t, exit_time),
        under_way=np.asarray((t > 0.0) & ~gone, dtype=np.float64),
        gone=gone,
    )


def _load_fraction_rate(x: FloatArray, passage: _Passage, speed: float, c: float) -> FloatArray:
    """Time derivative of ``y phi``, split so that nothing cancels where both ends are inside."""
    at_wave, at_load = passage.indicator_at_ends(x)
    if speed == c:
        return c * at_wave * passage.under_way
    both = np.minimum(at_wave, at_load)
    gain = speed / (c - speed)
    load_rate = np.where(passage.gone, c, speed)
    return gain * (c * (at_wave - both) - load_rate * (at_load - both)) + speed * both * passage.under_way


def _modal_shape(x: FloatArray, passage: _Passage, modes: int) -> FloatArray:
    if modes < 1:
        raise ValueError(f"modes must be at least 1, not {modes}")
    length = 0.5 * passage.period
    middle = passage.start + 0.5 * passage.width
    shape = np.zeros(np.broadcast_shapes(x.shape, middle.shape))
    for n in range(1, modes + 1):
        k = n * np.pi / length
        mean_cosine = np.cos(k * middle) * np.sinc(0.5 * k * passage.width / np.pi)
        sine = np.sin(k * passage.load) * passage.under_way
        coefficient = 2.0 / (length * k**2) * (sine - k * passage.load * mean_cosine)
        shape += coefficient * np.sin(k * x)
    return shape


def _at(
    x: ArrayLike, t: ArrayLike, speed: float, length: float, tension: float, mass: float
) -> tuple[FloatArray, _Passage]:
    _require_motion(speed, length, tension, mass)
    x, t = np.asarray(x, dtype=np.float64), np.asarray(t, dtype=np.float64)
    if not np.all((x >= 0.0) & (x <= length)):
        raise ValueError(f"x must lie on the string, between 0 and its length {length}")
    if not np.all(np.isfinite(t)):
        raise ValueError("t must be finite")
    return x, _passage(t, speed, length, tension, mass)


def _require_motion(speed: float, length: float, tension: float, mass: float) -> None:
    _arguments.positive(length=length, tension=tension, mass=mass)
    if not (np.isfinite(speed) and speed >= 0.0):
        raise ValueError(f"speed must be finite and not negative, not {speed}")


def _require_not_wave_speed(speed: float, tension: float, mass: float) -> None:
    if speed == wave_speed(tension=tension, mass=mass):
        raise ValueError("the drive force is infinite at exactly the wave speed")
