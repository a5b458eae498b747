"""Balance to the side, step by step: a pendulum whose feet are placed next to where it falls (Hof; Macdonald).

On rigid ground (`lateral_walk`) and on a deck that moves (`deck_walk`, with the pendulum of
`ropewalk.theory.lateral_balance`).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

FloatArray = NDArray[np.float64]


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


def peak_force(
    *, mass: float, margin: ArrayLike, step_time: ArrayLike, leg_length: ArrayLike, gravity: float = 9.81
) -> FloatArray:
    """Return the largest force to the side in steady walking on still ground, in N, when a foot has just been placed.

    ``mass`` in kg; the rest as in `step_width`, they broadcast. `ValueError` out of range. ``m Omega^2 width/2``,
    outwards.
    """
    _arguments.positive(mass=mass)
    width = step_width(margin=margin, step_time=step_time, leg_length=leg_length, gravity=gravity)
    return np.asarray(0.5 * mass * gravity / np.asarray(leg_length) * width)


@dataclass(frozen=True)
class DeckWalk:
    """A walk on a deck that moves: ``position`` (m), ``velocity`` (m/s) and ``force`` on the deck (N) over the times.

    All to the side and from the ground. ``feet`` (step,): where they stand on the deck, m from its middle.
    """

    position: FloatArray
    velocity: FloatArray
    force: FloatArray
    feet: FloatArray


def deck_walk(
    t: ArrayLike,
    deck: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    *,
    mass: float,
    margin: float,
    leg_length: float,
    landings: ArrayLike,
    position: float,
    velocity: float,
    gravity: float = 9.81,
    side: Literal[1, -1] = 1,
) -> DeckWalk:
    """Return the walk on a deck that moves as it likes, step by step, by quadrature.

    Args:
        t: s, not before the first landing, any shape.
        deck: place and velocity (m, m/s) of the deck at times (s).
        mass: kg.
        margin, leg_length, gravity: as in `step_width`.
        landings: instants at which feet are placed, rising, s.
        position, velocity: of the body at the first landing, from the ground, m and m/s.
        side: of the first foot.

    Raises:
        ValueError: an argument out of range.

    Over a step ``y = x_0 + u + A cosh + B sinh - Omega int sinh(Omega (t - s)) (x(s) - x_0) ds``, the integral by
    Gauss-Legendre of 12 points: exact to rounding for a deck that sways less than once in a step.
    """
    _arguments.positive(mass=mass, margin=margin, leg_length=leg_length, gravity=gravity)
    _arguments.finite(t=t, landings=landings, position=position, velocity=velocity)
    t, landings = np.asarray(t, dtype=np.float64), np.asarray(landings, dtype=np.float64)
    if landings.ndim != 1 or not landings.size or np.any(np.diff(landings) <= 0.0):
        raise ValueError("landings must rise, one at least")
    if np.any(t < landings[0]):
        raise ValueError("t must not lie before the first of landings")
    rate = float(np.sqrt(gravity / leg_length))
    number = np.searchsorted(landings, t, side="right") - 1
    y, v, force, feet = np.empty_like(t), np.empty_like(t), np.empty_like(t), np.empty(landings.size)
    for n, begin in enumerate(landings):
        x, speed = (float(np.asarray(value)[0]) for value in deck(np.array([begin])))
        feet[n] = position - x + (velocity - speed) / rate + side * (-1) ** n * margin
        here = number == n
        y[here], v[here] = _over_step(t[here] - begin, begin, deck, rate, feet[n], position, velocity)
        force[here] = mass * rate**2 * (deck(t[here])[0] + feet[n] - y[here])
        if n + 1 < landings.size:
            after = np.array([landings[n + 1] - begin])
            position, velocity = (
                float(value[0]) for value in _over_step(after, begin, deck, rate, feet[n], position, velocity)
            )
    return DeckWalk(y, v, force, feet)


def _over_step(
    since: FloatArray,
    begin: float,
    deck: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    rate: float,
    foot: float,
    position: float,
    velocity: float,
) -> tuple[FloatArray, FloatArray]:
    """Position and velocity of the body some time after a foot was placed."""
    nodes, weights = np.polynomial.legendre.leggauss(12)
    still = float(np.asarray(deck(np.array([begin]))[0])[0]) + foot
    at = 0.5 * since[:, None] * (1.0 + nodes)
    moved = 0.5 * since[:, None] * weights * (deck(begin + at)[0] + foot - still)
    left = rate * (since[:, None] - at)
    away, c, s = position - still, np.cosh(rate * since), np.sinh(rate * since)
    y = still + away * c + velocity / rate * s - rate * (np.sinh(left) * moved).sum(axis=1)
    v = away * rate * s + velocity * c - rate**2 * (np.cosh(left) * moved).sum(axis=1)
    return np.asarray(y), np.asarray(v)
