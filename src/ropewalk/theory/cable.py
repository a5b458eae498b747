"""Small vibration of a shallow sagging cable between fixed supports: Irvine and Caughey's theory.

The cable hangs in a parabola. In its plane, symmetric modes stretch it and antisymmetric ones do not; motion out
of the plane is that of a taut string. One number decides,

    lambda^2 = (m g l cos(theta) / H)^2 l / (H l_e / EA),    l_e = l (1 + 8 (d/l)^2),

with the chord l, its inclination theta, the tension H along the chord and the sag ``d = m g l^2 cos(theta) / (8
H)`` across it. Irvine and Caughey, The linear theory of free vibrations of a suspended cable, Proc. R. Soc. A 341
(1974); Irvine, Cable Structures.

Validity: sag up to about an eighth of the chord, strains small, modes that do not reach the speed of longitudinal
waves. Inclined cables: the tension must vary little along the chord, ``m g l sin(theta) / H`` well below 1.
There the theory has symmetric and antisymmetric frequencies cross; those of a real inclined cable avoid each
other near the cross-over and their modes are neither (Triantafyllou, 1984).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

__all__ = [
    "CableFrequencies",
    "irvine_parameter",
    "natural_frequencies",
    "symmetric_roots",
]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class CableFrequencies:
    """Angular frequencies of a cable, rad/s, ascending along the last axis."""

    symmetric: FloatArray
    antisymmetric: FloatArray
    out_of_plane: FloatArray

    @property
    def in_plane(self) -> FloatArray:
        """Symmetric and antisymmetric ones together, ascending."""
        both = np.broadcast_arrays(self.symmetric, self.antisymmetric)
        return np.sort(np.concatenate(both, axis=-1), axis=-1)


def irvine_parameter(
    *,
    span: float,
    mass: float,
    axial_stiffness: float,
    horizontal_tension: float | None = None,
    sag: float | None = None,
    gravity: float = 9.81,
    inclination: float = 0.0,
) -> float:
    """Return lambda^2, without unit; infinite for an inextensible cable that sags.

    ``span`` in m is the chord between the supports, ``mass`` in kg/m, ``axial_stiffness`` EA in N (may be
    infinite), ``gravity`` in m/s^2, ``inclination`` of the chord in rad, below pi/2. Give either
    ``horizontal_tension`` in N (of an inclined cable the component along the chord) or ``sag`` across the chord at
    mid-span, in m. `ValueError` out of range. Formula and validity at the head of this module.
    """
    along = _tension(span, mass, horizontal_tension, sag, gravity, inclination)
    if not axial_stiffness > 0.0:
        raise ValueError(f"axial_stiffness must be positive, not {axial_stiffness}")
    across = mass * gravity * span * np.cos(inclination) / along
    if across == 0.0:
        return 0.0
    # the sag is across/8 of the span
    return float(across**2 * axial_stiffness / (along * (1.0 + across**2 / 8.0)))


def natural_frequencies(
    *,
    modes: int,
    span: float,
    mass: float,
    horizontal_tension: float | None = None,
    sag: float | None = None,
    axial_stiffness: float | None = None,
    lambda_squared: ArrayLike | None = None,
    gravity: float = 9.81,
    inclination: float = 0.0,
) -> CableFrequencies:
    """Return the lowest ``modes`` frequencies of each kind, in rad/s.

    Arguments and errors as in `irvine_parameter`; instead of ``axial_stiffness`` one may give ``lambda_squared``
    itself, 0 (taut string) to infinity (inextensible), scalar or array, which stands before the axis of modes.

    With ``omega_0 = sqrt(H/mass)/span``: out of plane ``n pi omega_0``, antisymmetric ``2 n pi omega_0``,
    symmetric ``2 x_n omega_0`` with the roots x_n of `symmetric_roots`. Validity at the head of this module.
    """
    along = _tension(span, mass, horizontal_tension, sag, gravity, inclination)
    if (axial_stiffness is None) == (lambda_squared is None):
        raise ValueError("either axial_stiffness or lambda_squared must be given")
    if axial_stiffness is not None:
        lambda_squared = irvine_parameter(
            span=span,
            mass=mass,
            axial_stiffness=axial_stiffness,
            horizontal_tension=along,
            gravity=gravity,
            inclination=inclination,
        )
    assert lambda_squared is not None
    unit = float(np.sqrt(along / mass) / span)
    n = np.arange(1, modes + 1)
    return CableFrequencies(
        symmetric=2.0 * unit * symmetric_roots(lambda_squared, modes=modes),
        antisymmetric=np.asarray(2.0 * np.pi * unit * n, dtype=np.float64),
        out_of_plane=np.asarray(np.pi * unit * n, dtype=np.float64),
    )


def symmetric_roots(lambda_squared: ArrayLike, *, modes: int) -> FloatArray:
    """Return the first ``modes`` roots x of ``tan(x) = x - 4 x^3 / lambda^2``, shape (..., modes).

    ``lambda_squared`` from 0 to infinity, both allowed, or `ValueError`. ``x = omega span sqrt(mass/H) / 2``
    of the symmetric modes; root n lies between (n - 1/2) pi, where it starts at lambda^2 = 0, and (n + 1/2) pi.
    There is one in each of these intervals because ``tan(x) - x + 4 x^3 / lambda^2`` rises throughout. Irvine and
    Caughey 1974.
    """
    if modes < 1:
        raise ValueError(f"modes must be at least 1, not {modes}")
    (parameter,) = _arguments.within(0.0, np.inf, lambda_squared=lambda_squared)
    parameter = parameter[..., None]
    endless = np.isinf(parameter)
    stretch = np.where(endless, 1.0, parameter)  # weights of the two parts of the equation
    sag = np.where(endless, 0.0, 4.0)
    n = np.arange(1, modes + 1)
    shape = np.broadcast_shapes(parameter.shape, n.shape)
    low, high = np.broadcast_to((n - 0.5) * np.pi, shape), np.broadcast_to((n + 0.5) * np.pi, shape)
    start, side = low, np.where(n % 2 == 1, 1.0, -1.0)  # sign of the function at the beginning of the interval
    for _ in range(60):
        x = 0.5 * (low + high)
        # cos(x) of the formula, from the distance to its zero at the beginning of the interval
        cosine, sine = -side * np.sin(x - start), side * np.cos(x - start)
        value = stretch * (sine - x * cosine) + sag * x**3 * cosine
        low, high = np.where(value * side > 0.0, x, low), np.where(value * side > 0.0, high, x)
    return np.where(parameter == 0.0, start, 0.5 * (low + high))


def _tension(
    span: float, mass: float, horizontal_tension: float | None, sag: float | None, gravity: float, inclination: float
) -> float:
    _arguments.positive(span=span, mass=mass)
    _arguments.not_negative(gravity=gravity)
    if not abs(inclination) < 0.5 * np.pi:
        raise ValueError(f"inclination must lie between -pi/2 and pi/2, not {inclination}")
    if (horizontal_tension is None) == (sag is None):
        raise ValueError("either horizontal_tension or sag must be given")
    if horizontal_tension is not None:
        _arguments.positive(horizontal_tension=horizontal_tension)
        return horizontal_tension
    assert sag is not None
    _arguments.positive(sag=sag, gravity=gravity)
    return float(mass * gravity * np.cos(inclination) * span**2 / (8.0 * sag))
