"""Circular whirls of a taut line between fixed supports.

Kirchhoff and Carrier: a taut elastic line whose tension is everywhere the mean one, ``T + EA/(2 L) * integral of
w_x^2``. A mode with n half waves of amplitude q then obeys ``q'' + omega_0^2 q + gamma q^3 = 0``, ``omega_0^2 =
(T/m) (n pi/L)^2``, ``gamma = (EA/(4 m)) (n pi/L)^4``. Valid for slopes well below 1 and frequencies well below
those of longitudinal waves. Kirchhoff, Vorlesungen ueber Mechanik; Carrier, Q. Appl. Math. 3 (1945).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

__all__ = ["whirl_frequency"]

FloatArray = NDArray[np.float64]


def whirl_frequency(
    amplitude: ArrayLike, *, length: float, tension: float, mass: float, axial_stiffness: float, half_waves: int = 1
) -> FloatArray:
    """Return the angular speed of a circular whirl of a taut line, in rad/s, shape of ``amplitude``.

    ``amplitude`` is the radius of the whirl in m, 0 or more; ``length`` in m, ``tension`` at rest in N, ``mass`` in
    kg/m, ``axial_stiffness`` in N, 0 or more. `ValueError` out of range. Exact within the theory at the head of
    this module: ``sqrt(omega_0^2 + gamma amplitude^2)``.
    """
    square, gain = _duffing(amplitude, length, tension, mass, axial_stiffness, half_waves)
    return np.sqrt(square + gain)


def _duffing(
    amplitude: ArrayLike, length: float, tension: float, mass: float, axial_stiffness: float, half_waves: int
) -> tuple[float, FloatArray]:
    """omega_0^2 and gamma amplitude^2."""
    _arguments.positive(length=length, tension=tension, mass=mass)
    _arguments.not_negative(axial_stiffness=axial_stiffness)
    if half_waves < 1:
        raise ValueError(f"half_waves must be at least 1, not {half_waves}")
    (a,) = _arguments.within(0.0, np.finfo(np.float64).max, amplitude=amplitude)
    k = half_waves * np.pi / length
    return tension / mass * k**2, axial_stiffness / (4.0 * mass) * (k**2 * a) ** 2
