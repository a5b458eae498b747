"""Planar swings of a taut line, by the theory of `ropewalk.theory.whirl`, and the skipping rope.

Skipping rope: an inextensible rope that turns as a rigid shape about the line through its supports, without
weight, any amplitude: exact in Jacobi's elliptic functions. Derived here.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments
from ropewalk.theory.whirl import _duffing

FloatArray = NDArray[np.float64]


def planar_frequency(
    amplitude: ArrayLike, *, length: float, tension: float, mass: float, axial_stiffness: float, half_waves: int = 1
) -> FloatArray:
    """Return the angular frequency of a planar swing of a taut line, in rad/s, shape of ``amplitude``.

    Arguments and errors as in `whirl_frequency`; ``amplitude`` is the largest deflection. The period is ``4 K(m) /
    Omega`` with the whirl's frequency Omega and the parameter ``m = gamma amplitude^2 / (2 Omega^2)``.
    """
    from scipy.special import ellipk

    square, gain = _duffing(amplitude, length, tension, mass, axial_stiffness, half_waves)
    whole = square + gain
    return np.asarray(0.5 * np.pi * np.sqrt(whole) / ellipk(0.5 * gain / whole))


def planar_motion(
    t: ArrayLike,
    *,
    amplitude: float,
    length: float,
    tension: float,
    mass: float,
    axial_stiffness: float,
    half_waves: int = 1,
) -> FloatArray:
    """Return the deflection of the antinode in a planar swing released from rest at t = 0, in m, shape of ``t``.

    ``t`` in s; the rest and the errors as in `planar_frequency`. ``amplitude cn(Omega t | m)``.
    """
    from scipy.special import ellipj

    square, gain = _duffing(amplitude, length, tension, mass, axial_stiffness, half_waves)
    _arguments.finite(t=t)
    whole = float(square + gain)
    _, cn, _, _ = ellipj(np.sqrt(whole) * np.asarray(t, dtype=np.float64), 0.5 * float(gain) / whole)
    return np.asarray(amplitude * cn)


@dataclass(frozen=True)
class SkippingRope:
    """Shape and tension of a rope that whirls; distances in m, forces in N."""

    span: float
    mass: float
    angular_speed: float
    radius: float  # largest distance from the axis, 0 for a rope as long as the span
    horizontal_tension: float
    parameter: float  # m of the elliptic functions
    argument: float  # their argument per metre along the axis

    @property
    def largest_tension(self) -> float:
        """Tension at the supports."""
        return self.horizontal_tension + 0.5 * self.mass * self.angular_speed**2 * self.radius**2

    def shape(self, x: ArrayLike) -> FloatArray:
        """Return the distance from the axis at ``x`` (m, 0..span along the axis), signed with several half waves."""
        from scipy.special import ellipj

        (x,) = _arguments.within(0.0, self.span, x=x)
        sn, _, _, _ = ellipj(self.argument * x, self.parameter)
        return np.asarray(self.radius * sn)

    def tension(self, x: ArrayLike) -> FloatArray:
        """Return the tension at ``x`` (m, 0..span): ``H + mass Omega^2 (radius^2 - y^2) / 2``."""
        y = self.shape(x)
        return self.horizontal_tension + 0.5 * self.mass * self.angular_speed**2 * (self.radius**2 - y**2)


def skipping_rope(
    *, span: float, length: float, mass: float, angular_speed: float, half_waves: int = 1
) -> SkippingRope:
    """Return the whirl of an inextensible rope of ``length`` >= ``span`` (m) at ``angular_speed`` (rad/s).

    ``mass`` in kg/m, ``half_waves`` >= 1. A rope just as long as the span is the limit of small whirls, ``H = mass
    (angular_speed span/(half_waves pi))^2``. `ValueError` out of range.

    ``y = y_0 sn(sqrt(c (2 + c y_0^2)) x | m)``, ``c = mass Omega^2/(2 H)``, ``m = c y_0^2/(2 + c y_0^2)``. Then
    ``length/span = 2 E(m)/(K(m) (1 - m)) - 1`` gives m, and ``span sqrt(c) = half_waves K(m) sqrt(2 (1 - m))``.
    Derived here from ``(T x')' = 0``, ``(T y')' = -mass Omega^2 y`` along the arc.
    """
    from scipy.optimize import brentq
    from scipy.special import ellipe, ellipkm1

    _arguments.positive(span=span, length=length, mass=mass, angular_speed=angular_speed)
    if half_waves < 1:
        raise ValueError(f"half_waves must be at least 1, not {half_waves}")
    ratio = length / span
    if not 1.0 <= ratio <= 1e100:
        raise ValueError(f"length must be at least the span {span:g} and at most 1e100 times it, not {length}")

    def excess(logarithm: float) -> float:  # of 1 - m, which spans many decades
        rest = np.exp(logarithm)
        return float(np.log(2.0 * ellipe(-np.expm1(logarithm)) / (ellipkm1(rest) * rest) - 1.0) - np.log(ratio))

    logarithm = 0.0 if ratio == 1.0 or excess(0.0) >= 0.0 else brentq(excess, -250.0, 0.0, xtol=1e-300, rtol=1e-15)
    parameter, rest = abs(float(np.expm1(logarithm))), float(np.exp(logarithm))
    quarter = float(ellipkm1(rest))
    c = 2.0 * rest * (half_waves * quarter / span) ** 2
    return SkippingRope(
        span=span,
        mass=mass,
        angular_speed=angular_speed,
        radius=float(np.sqrt(2.0 * parameter / (rest * c))),
        horizontal_tension=0.5 * mass * angular_speed**2 / c,
        parameter=parameter,
        argument=2.0 * half_waves * quarter / span,
    )
