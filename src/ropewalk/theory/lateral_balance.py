"""People who balance to the side on a deck that sways: the gait, and how it feeds or damps the sway.

The body is the inverted pendulum of `gait.lateral_walk`, ``y'' = Omega^2 (y - u)``, ``Omega = sqrt(gravity/
leg_length)``, whose foot u moves with the deck. Every step time T a foot is placed at ``u = y + v/Omega`` and further
out by the margin b, where v is the velocity seen from the deck: on a deck in uniform motion one walks as on still
ground. The force on the deck is ``-m y''``. All is linear, so that what the steps do on still ground and what the sway
adds are independent of each other (Hof, Hum. Mov. Sci. 27, 2008; Macdonald, Proc. R. Soc. A 465, 2009).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments
from ropewalk.theory.gait import step_width

__all__ = [
    "DeckWalk",
    "critical_number",
    "deck_walk",
    "peak_force",
    "self_excited_force",
    "sway_growth",
]

FloatArray = NDArray[np.float64]


def peak_force(
    *, mass: float, margin: ArrayLike, step_time: ArrayLike, leg_length: ArrayLike, gravity: float = 9.81
) -> FloatArray:
    """Return the largest force to the side in steady walking on still ground, in N, when a foot has just been placed.

    ``mass`` in kg; the rest as in `gait.step_width`, they broadcast. `ValueError` out of range. ``m Omega^2 width/2``,
    outwards.
    """
    _arguments.positive(mass=mass)
    width = step_width(margin=margin, step_time=step_time, leg_length=leg_length, gravity=gravity)
    return np.asarray(0.5 * mass * gravity / np.asarray(leg_length) * width)


def self_excited_force(
    frequency: ArrayLike, *, mass: float, step_time: ArrayLike, leg_length: ArrayLike, gravity: float = 9.81
) -> tuple[FloatArray, FloatArray]:
    """Return what a walker does to a deck that sways at ``frequency`` (Hz), on average over long times.

    Args:
        frequency: of the deck, above 0.
        mass: kg.
        step_time: from one foot to the next, s.
        leg_length: of the pendulum, m.
        gravity: m/s^2.

    Returns:
        The force in phase with the velocity of the deck, over that velocity, in N s/m: positive where the walker
        drives the sway as a negative damper does. And the mass in kg that seems to be added to the deck, ``-F/x''``.
        The arguments broadcast.

    Raises:
        ValueError: an argument out of range.

    With ``theta = w T``, ``E = exp(Omega T)``, the deck at ``x = Re[X exp(i w t)]`` feels at its own frequency

        F = m w^2 Omega^2/(Omega^2 + w^2) [1 - i w (E exp(-i theta) - 1)(Omega + i w)/(T Omega (Omega^2 + w^2))] X,

    whatever the margin: the foot has the offset ``P exp(i n theta)``, ``P (exp(i theta) - 1) = X (E - exp(i theta))
    w^2/(Omega (Omega - i w))``, found from the growing mode ``y + y'/Omega``, whose motion over a step is exact. Where
    the deck sways at an odd multiple of half the frequency of the steps, the force of the gait itself comes on top, in
    a phase that is left to chance. The long-term mean of Macdonald's model (2009) is in closed form since McRobie, J.
    Sound Vib. 332 (2013); derived here anew.
    """
    _arguments.positive(mass=mass, gravity=gravity)
    most = np.finfo(np.float64).max
    frequency, step_time, leg_length = _arguments.within(
        np.finfo(np.float64).tiny, most, frequency=frequency, step_time=step_time, leg_length=leg_length
    )
    w = 2.0 * np.pi * frequency
    ratio = _answer(w, mass, step_time, np.sqrt(gravity / leg_length))
    return np.asarray(np.imag(ratio) / w), np.asarray(np.real(ratio) / w**2)


def critical_number(
    frequency: float, ratio: float, modal_mass: float, drive: float, share: float = 0.5
) -> float:  # fmt: skip
    """Return how many people undo the damping of a lateral mode, so that with more of them its sway grows.

    Args:
        frequency: of the mode, Hz.
        ratio: its damping over critical.
        modal_mass: kg, with the largest deflection of the mode 1.
        drive: force of one in phase with the velocity of the deck, over that, N s/m: of `self_excited_force`, or the
            300 N s/m that were measured on the London Millennium Bridge.
        share: mean square of the mode where they are: 1/2 for people all along a sine.

    Raises:
        ValueError: an argument out of range.

    ``N = 4 pi ratio frequency modal_mass/(share drive)``; with a share of a half it is the ``8 pi c f M/k`` of Dallard
    et al., The Structural Engineer 79 (22), 17 (2001).
    """
    _arguments.positive(frequency=frequency, ratio=ratio, modal_mass=modal_mass, drive=drive, share=share)
    return 4.0 * np.pi * ratio * frequency * modal_mass / (share * drive)


def sway_growth(
    frequency: float,
    *,
    damping_rate: float,
    modal_mass: float,
    mass: ArrayLike,
    step_time: ArrayLike,
    leg_length: float,
    share: ArrayLike = 0.5,
    gravity: float = 9.81,
) -> complex:
    """Return growth rate (1/s) and angular frequency (rad/s), as s in exp(s t), of a lateral mode under a crowd.

    Args:
        frequency: of the mode without people and damping, Hz.
        damping_rate: force that damps, over modal mass and velocity, 1/s: twice the rate at which it decays alone.
        modal_mass: kg, with the largest deflection of the mode 1.
        mass: of each person, kg.
        step_time: of each, s.
        leg_length: of the pendulum, m.
        share: square of the mode where each is, on average.
        gravity: m/s^2.

    Raises:
        ValueError: an argument out of range.

    The root near the mode of ``M (s^2 + damping_rate s + omega^2) = sum share F(w)/X``, s = i w, with the force of
    `self_excited_force`, which holds for a sway that grows as well. Newton's method from the mode alone.
    """
    _arguments.positive(frequency=frequency, modal_mass=modal_mass, leg_length=leg_length, gravity=gravity)
    _arguments.finite(damping_rate=damping_rate, share=share)
    least, most = np.finfo(np.float64).tiny, np.finfo(np.float64).max
    masses, times = _arguments.within(least, most, mass=mass, step_time=step_time)
    omega, rate, shares = 2.0 * np.pi * frequency, np.sqrt(gravity / leg_length), np.asarray(share)

    def left(w: complex) -> complex:
        own = modal_mass * (omega**2 - w**2 + 1j * damping_rate * w)
        return complex(own - np.sum(shares * _answer(w, masses, times, rate)))

    w, aside = complex(omega), 1e-6 * omega
    for _ in range(50):
        change = left(w) * 2.0 * aside / (left(w + aside) - left(w - aside))
        w -= change
        if abs(change) < 1e-12 * omega:
            break
    return 1j * w


def _answer(w: Any, mass: Any, step_time: Any, rate: Any) -> Any:
    """Force on the deck over its place, N/m, at an angular frequency that may be complex, see `self_excited_force`."""
    whole, grown = rate**2 + w**2, np.exp(rate * step_time - 1j * w * step_time)
    return (
        mass * (w * rate) ** 2 / whole * (1.0 - 1j * w * (grown - 1.0) * (rate + 1j * w) / (step_time * rate * whole))
    )


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
        margin, leg_length, gravity: as in `gait.step_width`.
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
