"""The taut string itself: its wave speed and its checks."""

import numpy as np
from numpy.typing import NDArray

from ropewalk.theory import _arguments

__all__ = ["FloatArray", "check_string", "wave_speed"]

FloatArray = NDArray[np.float64]


def wave_speed(*, tension: float, mass: float) -> float:
    """Return the speed of transverse waves on a taut string, in m/s.

    ``tension`` in N and ``mass`` per length in kg/m, both positive or `ValueError`. c = sqrt(tension/mass).
    """
    _arguments.positive(tension=tension, mass=mass)
    return float(np.sqrt(tension / mass))


def check_string(*, speed: float, length: float, tension: float, mass: float) -> None:
    """Raise `ValueError` unless the string can be and the load moves forwards or stands."""
    _arguments.positive(length=length, tension=tension, mass=mass)
    _arguments.not_negative(speed=speed)
