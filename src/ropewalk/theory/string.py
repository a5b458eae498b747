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

import numpy as np
from numpy.typing import ArrayLike

from ropewalk.theory._passage import Passage, passage_at
from ropewalk.theory._wave import FloatArray, check_string, wave_speed
from ropewalk.theory.image_sum import travelling_force
from ropewalk.theory.moving_mass import MassPassage, moving_mass
from ropewalk.theory.moving_oscillator import OscillatorPassage, moving_oscillator

__all__ = [
    "MassPassage",
    "OscillatorPassage",
    "moving_force",
    "moving_force_path",
    "moving_mass",
    "moving_oscillator",
    "travelling_force",
    "wave_speed",
]


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


def moving_force_path(
    t: ArrayLike, *, force: float, speed: float, length: float, tension: float, mass: float
) -> FloatArray:
    """Return the deflection under the moving load, in m, shape of ``t``; 0 once the load has left.

    Arguments and errors as in `moving_force`. On the way it is ``F V t / (P (1 + alpha))`` up to 2L/(V + c),
    and for V > c zero up to 2L/(V + c); at V = c half the jump, ``F c t / (4 P)``.
    """
    check_string(speed=speed, length=length, tension=tension, mass=mass)
    place = np.clip(speed * np.asarray(t, dtype=np.float64), 0.0, length)
    return moving_force(place, t, force=force, speed=speed, length=length, tension=tension, mass=mass)


def _modal_shape(x: FloatArray, passage: Passage, modes: int) -> FloatArray:
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
) -> tuple[FloatArray, Passage]:
    check_string(speed=speed, length=length, tension=tension, mass=mass)
    x, t = np.asarray(x, dtype=np.float64), np.asarray(t, dtype=np.float64)
    if not np.all((x >= 0.0) & (x <= length)):
        raise ValueError(f"x must lie on the string, between 0 and its length {length}")
    if not np.all(np.isfinite(t)):
        raise ValueError("t must be finite")
    return x, passage_at(t, speed, length, tension, mass)
