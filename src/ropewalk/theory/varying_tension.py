"""String or beam whose tension varies along it, such as a hanging line: frequencies and deflection under a load.

``m w_tt + EI w'''' - (T(x) w')' + k w = f(x)``: the transverse equation of a tensioned beam with the axial force inside
the derivative, which is where it belongs unless it is constant. Ritz's method with polynomials: accuracy grows
faster than any power of their degree as long as T and f are smooth. ``ends``: "simply_supported", "clamped", or
"hanging" (simply supported at x = 0, free at x = length).
"""

from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

__all__ = ["deflection", "natural_frequencies"]

FloatArray = NDArray[np.float64]
Profile = Callable[[FloatArray], ArrayLike]
Ends = Literal["simply_supported", "clamped", "hanging"]

# Zeros of the shapes at start and end.
RESTRAINED = {"simply_supported": (1, 1), "clamped": (2, 2), "hanging": (1, 0)}
HIGHEST_DEGREE = 100


def natural_frequencies(
    count: int,
    *,
    length: float,
    mass: float,
    tension: Profile,
    bending_stiffness: float = 0.0,
    foundation: float = 0.0,
    ends: Ends = "simply_supported",
    tolerance: float = 1e-9,
) -> FloatArray:
    """Return the first ``count`` natural circular frequencies, in rad/s.

    ``length`` in m, ``mass`` in kg/m, ``tension(x)`` a function of arrays of x in m that gives N, ``bending_stiffness``
    in N m^2, ``foundation`` in N/m^2. Degrees are raised until no frequency changes by more than ``tolerance`` of
    itself. `ValueError` for arguments out of range, a line that buckles, and where the tolerance is not reached.

    For a chain hung at one end, ``T = m g (L - x)``: half the zeros of the Bessel function J0 times sqrt(g/L).
    """
    if count < 1:
        raise ValueError(f"count must be at least 1, not {count}")
    _arguments.positive(tolerance=tolerance, mass=mass)
    last: FloatArray | None = None
    degree = 2 * count + 12
    while degree <= HIGHEST_DEGREE:
        stiffness, gram, _ = _matrices(degree, length, tension, bending_stiffness, foundation, ends)
        found = np.sqrt(_eigenvalues(stiffness, gram)[:count] / mass)
        if last is not None and np.all(np.abs(found - last) <= tolerance * found):
            return found
        last, degree = found, degree + degree // 2
    raise ValueError(f"tolerance {tolerance:g} is not reached; tension may not be smooth, or count be too large")


def deflection(
    x: ArrayLike,
    *,
    load: Profile,
    length: float,
    tension: Profile,
    bending_stiffness: float = 0.0,
    foundation: float = 0.0,
    ends: Ends = "simply_supported",
    tolerance: float = 1e-9,
) -> FloatArray:
    """Return the static deflection at ``x`` (m, within 0..length) under a distributed load, in m.

    ``load(x)`` a function of arrays of x that gives N/m, smooth; other arguments and errors as in
    `natural_frequencies`, with ``tolerance`` relative to the largest deflection.
    """
    _arguments.positive(tolerance=tolerance, length=length)
    (x,) = _arguments.within(0.0, length, x=x)
    last: FloatArray | None = None
    degree = 12
    while degree <= HIGHEST_DEGREE:
        stiffness, gram, basis = _matrices(degree, length, tension, bending_stiffness, foundation, ends)
        _eigenvalues(stiffness, gram)
        y, weights = np.polynomial.legendre.leggauss(2 * degree + 20)
        load_values = _values("load", load, 0.5 * length * (1.0 + y))
        work = basis(y, 0) @ (0.5 * length * weights * load_values)
        found = np.linalg.solve(stiffness, work) @ basis(2.0 * x.ravel() / length - 1.0, 0)
        scale = np.max(np.abs(found), initial=0.0)
        if last is not None and np.all(np.abs(found - last) <= tolerance * scale):
            return np.asarray(found).reshape(x.shape)
        last, degree = found, degree + degree // 2
    raise ValueError(f"tolerance {tolerance:g} is not reached; tension or load may not be smooth")


Basis = Callable[[FloatArray, int], FloatArray]


def _matrices(
    degree: int, length: float, tension: Profile, bending_stiffness: float, foundation: float, ends: Ends
) -> tuple[FloatArray, FloatArray, Basis]:
    """Stiffness, Gram matrix and basis on y = -1..1: Legendre polynomials with the zeros of the ends."""
    _arguments.positive(length=length)
    _arguments.not_negative(bending_stiffness=bending_stiffness, foundation=foundation)
    if ends not in RESTRAINED:
        raise ValueError(f"ends must be one of {', '.join(RESTRAINED)}, not {ends!r}")
    start, end = RESTRAINED[ends]
    legendre = np.polynomial.Legendre
    restrained = legendre.fromroots([-1.0] * start + [1.0] * end)
    shapes = [restrained * legendre.basis(i) * (2.0 * i + 1.0) ** (0.5 - start - end) for i in range(degree)]

    def basis(y: FloatArray, derivative: int) -> FloatArray:
        return np.array([shape.deriv(derivative)(y) if derivative else shape(y) for shape in shapes])

    y, weights = np.polynomial.legendre.leggauss(2 * degree + 20)
    weights = 0.5 * length * weights
    scale = 2.0 / length
    pull = _values("tension", tension, 0.5 * length * (1.0 + y))
    w, slope = basis(y, 0), scale * basis(y, 1)
    gram = (w * weights) @ w.T
    stiffness = (slope * (weights * pull)) @ slope.T + foundation * gram
    if bending_stiffness > 0.0:
        bend = scale**2 * basis(y, 2)
        stiffness += bending_stiffness * (bend * weights) @ bend.T
    elif np.any(pull <= 0.0):
        raise ValueError("tension must be positive inside the line where bending_stiffness is 0")
    return stiffness, gram, basis


def _eigenvalues(stiffness: FloatArray, gram: FloatArray) -> FloatArray:
    from scipy.linalg import eigh  # SciPy's linear algebra loads slowly

    try:  # the inverse problem: its largest eigenvalues, which are wanted, are its most accurate ones
        inverse: FloatArray = eigh(gram, stiffness, eigvals_only=True)[::-1]
    except np.linalg.LinAlgError:
        raise ValueError("the line buckles: tension is too far below zero") from None
    return 1.0 / np.maximum(inverse, 1e-300)


def _values(name: str, profile: Profile, x: FloatArray) -> FloatArray:
    values = np.broadcast_to(np.asarray(profile(x), dtype=np.float64), x.shape)
    _arguments.finite(**{name: values})
    return values
