"""People who balance to the side on a deck that sways: the gait, and how it feeds or damps the sway.

The body is an inverted pendulum, ``y'' = Omega^2 (y - u)``, ``Omega = sqrt(gravity/
leg_length)``, whose foot u moves with the deck. Every step time T a foot is placed at ``u = y + v/Omega`` and further
out by the margin b, where v is the velocity seen from the deck: on a deck in uniform motion one walks as on still
ground. The force on the deck is ``-m y''``. All is linear, so that what the steps do on still ground and what the sway
adds are independent of each other (Hof, Hum. Mov. Sci. 27, 2008; Macdonald, Proc. R. Soc. A 465, 2009).
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

__all__ = [
    "critical_number",
    "self_excited_force",
    "sway_growth",
]

FloatArray = NDArray[np.float64]


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
