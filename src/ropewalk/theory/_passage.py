"""Place of a force that travels with constant speed, and the phases that its solution needs."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ropewalk.theory._wave import FloatArray, wave_speed

__all__ = ["Passage", "passage_at"]


@dataclass(frozen=True)
class Passage:
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


def passage_at(t: FloatArray, speed: float, length: float, tension: float, mass: float) -> Passage:
    """Return the passage at times ``t``: the load enters at 0 and leaves at length/speed."""
    c = wave_speed(tension=tension, mass=mass)
    exit_time = length / speed if speed > 0.0 else np.inf
    t = np.maximum(t, 0.0)
    gone = t >= exit_time
    load = np.where(gone, length, np.minimum(speed * t, length))
    phase_at_load = load + c * np.where(gone, t - exit_time, 0.0)
    return Passage(
        alpha=speed / c,
        period=2.0 * length,
        load=load,
        start=np.mod(phase_at_load if speed <= c else -phase_at_load, 2.0 * length),
        width=abs(c - speed) * np.minimum(t, exit_time),
        under_way=np.asarray((t > 0.0) & ~gone, dtype=np.float64),
        gone=gone,
    )
