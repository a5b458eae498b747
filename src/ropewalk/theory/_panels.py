"""Functions of one variable as Legendre polynomials on panels, fitted at the Gauss points of each panel."""

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

__all__ = ["FIT", "INTEGRATE", "ORDER", "POINTS", "SUM", "SUM_TO_POINTS", "at", "integral_at"]

FloatArray = NDArray[np.float64]

ORDER = 12  # points and coefficients of a panel
_GAUSS: FloatArray = np.asarray(legendre.leggauss(ORDER)[0], dtype=np.float64)
POINTS: FloatArray = 0.5 * (_GAUSS + 1.0)  # Gauss points of the panel 0..1
FIT: FloatArray = np.asarray(
    np.linalg.inv(legendre.legvander(_GAUSS, ORDER - 1)), np.float64
)  # values at the points to coefficients
# Coefficients of a function on 0..1 to those of its integral from 0, one degree higher.
INTEGRATE: FloatArray = 0.5 * np.array([legendre.legint(unit, lbnd=-1) for unit in np.eye(ORDER)]).T
# Values at the points to values of the integral from 0 at the points.
SUM_TO_POINTS: FloatArray = legendre.legvander(_GAUSS, ORDER) @ INTEGRATE @ FIT
SUM: FloatArray = np.ones(ORDER + 1) @ INTEGRATE @ FIT  # the same at the end of the panel: Gauss weights


def at(coefficients: FloatArray, place: FloatArray) -> FloatArray:
    """Return the values at places 0..1 in panels, given the coefficients, last axis, of each place's panel."""
    columns = np.moveaxis(coefficients, -1, 0)
    return np.asarray(legendre.legval(2.0 * place - 1.0, columns, tensor=False), dtype=np.float64)


def integral_at(coefficients: FloatArray, place: FloatArray) -> FloatArray:
    """Return the integral from the start of the panel of width 1 to places 0..1 in it."""
    return at(coefficients @ INTEGRATE.T, place)
