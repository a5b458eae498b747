"""Walking people: vertical forces by harmonics, a mass on two springs, and balance to the side.

Three models that need no line. The harmonics are a force that takes no notice of the ground. The spring legs of Geyer,
Seyfarth and Blickhan walk by mechanics alone (`walk`, `gaits`). Sideways, the body is an inverted pendulum whose next
foot is placed beside where it is falling to (Hof; Macdonald).
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments
from ropewalk.theory._bipedal import Gait, SpringLegs, Walk, gaits, walk

__all__ = [
    "Gait",
    "LateralWalk",
    "SpringLegs",
    "Walk",
    "WalkingForce",
    "bachmann",
    "foot_place",
    "gaits",
    "lateral_walk",
    "step_width",
    "walk",
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


def step_width(*, margin: ArrayLike, step_time: ArrayLike, leg_length: ArrayLike, gravity: float = 9.81) -> FloatArray:
    """Return the distance across between left and right feet in steady walking, in m; arrays broadcast.

    Args:
        margin: of stability b, how far beyond ``y + y'/Omega`` each foot is placed, m.
        step_time: s.
        leg_length: of the pendulum, m, ``Omega = sqrt(gravity/leg_length)``.
        gravity: m/s^2.

    Raises:
        ValueError: an argument below 0 or not finite.

    ``b (1 + exp(Omega T))``. Hof, Hum. Mov. Sci. 27 (2008); Macdonald, Proc. R. Soc. A 465 (2009).
    """
    _arguments.positive(gravity=gravity)
    margin, step_time, leg_length = _arguments.within(
        0.0, np.finfo(np.float64).max, margin=margin, step_time=step_time, leg_length=leg_length
    )
    if not np.all(leg_length > 0.0):
        raise ValueError("leg_length must be positive")
    return np.asarray(margin * (1.0 + np.exp(np.sqrt(gravity / leg_length) * step_time)))


def foot_place(
    *,
    position: ArrayLike,
    velocity: ArrayLike,
    side: Literal[1, -1],
    margin: float,
    leg_length: float,
    gravity: float = 9.81,
) -> FloatArray:
    """Return where the foot goes, ``y + y'/Omega + side margin``, in m across.

    ``position`` (m) and ``velocity`` (m/s, from the ground) broadcast. ``side`` is 1 for the foot on the side of
    growing y, -1 for the other; the rest as in `step_width`. `ValueError`
    out of range.
    """
    _arguments.positive(leg_length=leg_length, gravity=gravity)
    _arguments.not_negative(margin=margin)
    _arguments.finite(position=position, velocity=velocity)
    if side not in (1, -1):
        raise ValueError(f"side must be 1 or -1, not {side}")
    caught = np.asarray(position) + np.asarray(velocity) / np.sqrt(gravity / leg_length)
    return np.asarray(caught + side * margin)


@dataclass(frozen=True)
class LateralWalk:
    """Balance to the side: ``position`` (m), ``velocity`` (m/s) and ``force`` on the ground (N) over the times.

    ``feet`` (step,): where they stand, in m; number i stands from i to i + 1 step times.
    """

    position: FloatArray
    velocity: FloatArray
    force: FloatArray
    feet: FloatArray


def lateral_walk(
    t: ArrayLike,
    *,
    mass: float,
    margin: float,
    step_time: float,
    leg_length: float,
    gravity: float = 9.81,
    side: Literal[1, -1] = 1,
    position: float | None = None,
    velocity: float | None = None,
) -> LateralWalk:
    """Return the motion to the side on rigid ground, a new foot at t = 0 and at every step time, exactly.

    Args:
        t: s, 0 or more, any shape.
        mass: kg.
        margin, step_time, leg_length, gravity: as in `step_width`, numbers, positive.
        side: of the first foot.
        position, velocity: at t = 0, m and m/s; by default those of the steady walk about y = 0.

    Raises:
        ValueError: an argument out of range.

    On the foot u the pendulum obeys ``y'' = Omega^2 (y - u)``: ``y + y'/Omega - u`` grows as ``exp(Omega t)`` and
    ``y - y'/Omega - u`` decays as ``exp(-Omega t)``. In the steady walk y = 0 when a foot is placed and ``y' = side
    Omega width/2 tanh(Omega T/2)``. Whatever the start, the feet are at once one steady width apart: a disturbance
    shifts the path to the side and does no more. The force on the ground is ``m Omega^2 (u - y)``.
    """
    _arguments.positive(mass=mass, margin=margin, step_time=step_time, leg_length=leg_length, gravity=gravity)
    (t,) = _arguments.within(0.0, np.inf, t=t)
    _arguments.finite(t=t)
    rate = float(np.sqrt(gravity / leg_length))
    width = float(step_width(margin=margin, step_time=step_time, leg_length=leg_length, gravity=gravity))
    y = 0.0 if position is None else position
    v = side * rate * 0.5 * width * float(np.tanh(0.5 * rate * step_time)) if velocity is None else velocity
    first = float(foot_place(position=y, velocity=v, side=side, margin=margin, leg_length=leg_length, gravity=gravity))
    steps = np.arange(int(np.max(t, initial=0.0) / step_time) + 1)
    feet = np.asarray(first - side * width * (steps % 2), dtype=np.float64)
    lag = np.empty(len(steps))  # y - y'/Omega at the beginning of each step
    lag[0] = y - v / rate
    for i in steps[1:]:
        lag[i] = feet[i - 1] + (lag[i - 1] - feet[i - 1]) * np.exp(-rate * step_time)
    step = np.minimum((t / step_time).astype(np.intp), len(steps) - 1)
    since = rate * (t - step * step_time)
    ahead = -side * (1.0 - 2.0 * (step % 2)) * margin * np.exp(since)
    behind = (lag[step] - feet[step]) * np.exp(-since)
    place = feet[step] + 0.5 * (ahead + behind)
    return LateralWalk(
        position=np.asarray(place),
        velocity=np.asarray(0.5 * rate * (ahead - behind)),
        force=np.asarray(mass * rate**2 * (feet[step] - place)),
        feet=feet,
    )
