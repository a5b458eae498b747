"""Walking people: vertical forces by harmonics, which are independent of the ground."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

__all__ = [
    "WalkingForce",
    "bachmann",
    "young",
]

FloatArray = NDArray[np.float64]

BACHMANN = (2.0, 2.4)  # Hz, steps per second
YOUNG = (1.0, 2.8)


@dataclass(frozen=True)
class WalkingForce:
    """The vertical force of a person who walks, ``G [1 + sum_i a_i sin(2 pi i f t - phi_i)]``, downwards.

    ``weight`` G in N, ``step_frequency`` f in steps per second, ``factors`` a_i from 0, ``phases`` phi_i in rad, one
    each.
    """

    weight: float
    step_frequency: float
    factors: tuple[float, ...]
    phases: tuple[float, ...]

    def __post_init__(self) -> None:
        _arguments.positive(weight=self.weight, step_frequency=self.step_frequency)
        _arguments.within(0.0, np.inf, factors=self.factors)
        _arguments.finite(factors=self.factors, phases=self.phases)
        if len(self.factors) != len(self.phases):
            raise ValueError(f"phases must be as many as factors, {len(self.factors)}, not {len(self.phases)}")

    def total(self, t: ArrayLike) -> FloatArray:
        """Return the force of both feet together at ``t`` (s, any shape), in N."""
        t = np.asarray(t, dtype=np.float64)
        _arguments.finite(t=t)
        ratio = np.ones_like(t)
        for order, (factor, phase) in enumerate(zip(self.factors, self.phases, strict=True), start=1):
            ratio = ratio + factor * np.sin(2.0 * np.pi * order * self.step_frequency * t - phase)
        return np.asarray(self.weight * ratio)

    def foot(self, t: ArrayLike, step: ArrayLike, *, overlap: float, landing: float | None = None) -> FloatArray:
        """Return the force of the single foot number ``step`` (integer, any sign) at ``t`` (s), in N; they broadcast.

        Args:
            t: s.
            step: 0 for the foot that lands at ``landing``, 1 for the next.
            overlap: the share of the step time 1/f in which both feet carry, 0 to 1.
            landing: s; by default such that the largest value of the first harmonic lies in the middle of the overlap.

        Returns:
            The force, zero before the foot lands and after it leaves, ``(1 + overlap)/f`` later.

        Raises:
            ValueError: an argument out of range.

        The rule: each foot carries a share of the total, one while it stands alone. While both stand, the share of the
        new foot grows as ``(1 - cos(pi s))/2``, s from 0 to 1, and the old foot carries the rest, so that the feet
        together give the total exactly. The rule is ours, it is smooth and no fit to single footfalls.
        """
        (overlap,) = (float(value) for value in _arguments.within(0.0, 1.0, overlap=overlap))
        t, step = np.asarray(t, dtype=np.float64), np.asarray(step, dtype=np.float64)
        _arguments.finite(t=t, step=step)
        if landing is None:
            crest = 0.25 + (self.phases[0] / (2.0 * np.pi) if self.phases else 0.0)
            landing = (crest - 0.5 * overlap) / self.step_frequency
        _arguments.finite(landing=landing)
        steps = (t - landing) * self.step_frequency
        # differences of one form: what one foot gives up, the next one takes to the last bit
        share = _taken_over(steps - step, overlap) - _taken_over(steps - (step + 1.0), overlap)
        return np.asarray(self.total(t) * share)


def _taken_over(since: FloatArray, overlap: float) -> FloatArray:
    """Share of the weight that has left the earlier feet, ``since`` steps after a foot has landed."""
    if overlap == 0.0:
        return np.asarray(np.where(since >= 0.0, 1.0, 0.0))
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * (np.clip(since, 0.0, overlap) / overlap)))


def bachmann(*, weight: float, step_frequency: float) -> WalkingForce:
    """Return the force of a person of ``weight`` (N) by Bachmann: three harmonics, 2 to 2.4 steps a second.

    ``a_1 = 0.4`` at 2 Hz growing linearly to 0.5 at 2.4 Hz, ``a_2 = a_3 = 0.1``, ``phi_2 = phi_3 = pi/2``. `ValueError`
    outside these frequencies. Bachmann and Ammann, Vibrations in Structures, IABSE 1987.
    """
    _arguments.within(*BACHMANN, step_frequency=step_frequency)
    first = 0.4 + 0.25 * (step_frequency - 2.0)
    return WalkingForce(weight, step_frequency, (first, 0.1, 0.1), (0.0, 0.5 * np.pi, 0.5 * np.pi))


def young(
    *, weight: float, step_frequency: float, phases: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
) -> WalkingForce:
    """Return the force of a person of ``weight`` (N) by Young's design values: four harmonics, 1 to 2.8 steps a second.

    ``a_1 = 0.41 (f - 0.95)``, at most 0.56, and at the frequency ``i f`` of the harmonic ``a_2 = 0.069 + 0.0056 (2
    f)``, ``a_3 = 0.033 + 0.0064 (3 f)``, ``a_4 = 0.013 + 0.0065 (4 f)``: values that a quarter of people exceed, not
    means. No ``phases`` (rad) belong to them. `ValueError` outside these frequencies. Young, Improved floor vibration
    prediction methodologies, Arup seminar 2001.
    """
    _arguments.within(*YOUNG, step_frequency=step_frequency)
    f = step_frequency
    factors = (
        min(0.41 * (f - 0.95), 0.56),
        0.069 + 0.0056 * 2.0 * f,
        0.033 + 0.0064 * 3.0 * f,
        0.013 + 0.0065 * 4.0 * f,
    )
    return WalkingForce(weight, f, factors, phases)
