"""A mass on a massless string between two supports: its path is a hypergeometric function.

With xi = V t/L, the deflection y in m g L/P and ``lam = P L/(m V^2)``, Newton's law reads

    y'' + lam y/(xi (1 - xi)) = lam,    y(0) = y'(0) = 0,
    y = lam/(lam - 2) [xi (1 - xi) - h],   h = xi 2F1(-a, 1 + a; 2; xi),   h' = P_a(1 - 2 xi),   a (a + 1) = lam,

with Legendre's function of the real degree a. (Smith 1964; Dyniewicz and Bajer 2009, whose series this is; the end
value ``y(1) = -sin(pi a)/(pi (lam - 2))`` follows from Gauss's theorem.) h and P_a come from 2F1 at degrees below 3 and
climb to a by the recurrence in the degree, written in differences so that small xi keeps its digits; far up, from the
leading terms in Bessel functions of both ends (Szego, Orthogonal Polynomials, section 8.21).
"""

import numpy as np
from numpy.typing import NDArray

__all__ = ["contact_lost", "end_value", "shape"]

FloatArray = NDArray[np.float64]

HIGHEST_RISE = 1e4  # degree; above, the leading terms err by less than 1e-10 in y
FREE_FALL = 1e-5  # lam below which two terms in lam do
EARLY = 0.02  # xi, or lam xi, below which the power series in xi is taken
NEAR_WHOLE = 0.01  # distance of the degree from a whole one
PLACES = 65  # samples in one round of the search for the loss of contact


def shape(lam: float, xi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return y in m g L/P and dy/dxi at places 0..1; the slope at 1, unless a is an integer, is one just before."""
    a, inside = degree(lam), np.minimum(xi, 1.0 - 1e-14)  # P_a is infinite at 1
    whole = np.rint(a)
    if whole >= 1.0 and abs(a - whole) < NEAR_WHOLE and a < HIGHEST_RISE:
        # SciPy loses digits near whole degrees, and the factor 1/(lam - 2) does. The solution is smooth there.
        y, slope = _interpolated(a, float(whole), inside)
    elif lam < FREE_FALL:
        y = lam * (0.5 * inside**2 + 0.5 * lam * (0.5 * inside**2 - (1.0 - inside) * np.log1p(-inside) - inside))
        slope = lam * (inside + 0.5 * lam * (inside + np.log1p(-inside)))
    else:
        y, slope = _direct(a, lam, inside)
    early = inside * max(lam, 1.0) < EARLY
    y_early, slope_early = _beginning(lam, np.where(early, inside, 0.0))
    y, slope = np.where(early, y_early, y), np.where(early, slope_early, slope)
    return np.where(xi == 1.0, end_value(lam), y), slope


def degree(lam: float) -> float:
    """Return a, ``a (a + 1) = lam``."""
    return float(2.0 * lam / (1.0 + np.sqrt(1.0 + 4.0 * lam)))


def end_value(lam: float) -> float:
    """Return y(1); 1/3 at lam = 2, zero only at lam = k (k + 1), k > 1."""
    a = degree(lam)
    if a < 0.5:
        return float(a / (2.0 - lam) * np.sinc(a))
    return float(np.sinc(a - 1.0) / (a + 2.0)) if lam < 1e30 else 0.0


def contact_lost(lam: float) -> float | None:
    """Return the first place at which y, and with it the contact force, turns negative, or None.

    Searched from twelve radians of the last oscillations to the end: before, the force stays positive.
    """
    if lam > 1e30:
        return None
    angles = np.linspace(min(np.pi * (1.0 - 1e-3), 12.0 / (degree(lam) + 0.5)), 0.0, 8 * PLACES)
    for _ in range(9):
        y = shape(lam, np.cos(0.5 * angles) ** 2)[0]
        negative = y < (-1e-14 if len(angles) > PLACES else 0.0)
        if not np.any(negative):
            return None if len(angles) > PLACES else float(np.cos(0.5 * angles[-1]) ** 2)
        first = max(int(np.argmax(negative)), 1)
        angles = np.linspace(angles[first - 1], angles[first], PLACES)
    return float(np.cos(0.5 * angles[0]) ** 2)


def _beginning(lam: float, xi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Power series, ``lam xi^2/2 - lam^2 xi^3/12 + ...``, where the closed form loses digits."""
    coefficients = [0.0, 0.0, 0.5 * lam, -(lam**2) / 12.0 if lam < 1e150 else 0.0]
    for k in range(3, 12):
        coefficients.append(coefficients[k] * (k * (k - 1.0) - lam) / (k * (k + 1.0)) if lam < 1e20 else 0.0)
    polynomial = np.polynomial.Polynomial(coefficients)
    return polynomial(xi), polynomial.deriv()(xi)


def _interpolated(a: float, whole: float, xi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Interpolate in the degree between twelve Chebyshev points within 1/4 of a whole one."""
    angle = (2 * np.arange(12) + 1) * np.pi / 24
    points = whole + 0.25 * np.cos(angle)
    weights = (-1.0) ** np.arange(12) * np.sin(angle) / (a - points)
    rows = np.array([_direct(point, point * (point + 1.0), xi) for point in points])
    y, slope = np.tensordot(weights, rows, axes=1) / np.sum(weights)
    return y, slope


def _direct(a: float, lam: float, xi: FloatArray) -> tuple[FloatArray, FloatArray]:
    h, legendre = _rise(a, xi) if a < HIGHEST_RISE else _leading_terms(a, lam, xi)
    factor = lam / (lam - 2.0) if lam < 1e300 else 1.0
    return factor * (xi * (1.0 - xi) - h), factor * (1.0 - 2.0 * xi - legendre)


def _rise(a: float, xi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """h and P_a(1 - 2 xi) by the recurrence in the degree."""
    from scipy.special import hyp2f1, lpmv

    # Two degrees each to begin with. SciPy's 2F1 fails here and there for xi near 1; its P does not.
    low = a - np.floor(a)
    nu, x, near_end = low + 1.0, 1.0 - 2.0 * xi, xi > 0.5
    first = np.minimum(xi, 0.5)
    p, p_above, p_third = (
        np.where(near_end, lpmv(0, n, x), hyp2f1(-n, 1.0 + n, 1.0, first)) for n in (low, nu, nu + 1.0)
    )
    h = np.where(near_end, (x * p_above - p_third) / (2.0 * nu), xi * hyp2f1(-nu, 1.0 + nu, 2.0, first))
    p_fourth = ((2.0 * nu + 3.0) * x * p_third - (nu + 1.0) * p_above) / (nu + 2.0)
    above = np.where(
        near_end, (x * p_third - p_fourth) / (2.0 * nu + 2.0), xi * hyp2f1(-nu - 1.0, 2.0 + nu, 2.0, first)
    )
    if a < 1.0:
        if a == 0.0:
            return xi, p
        return ((2.0 * nu + 1.0) * x * h - (nu + 2.0) * above) / (nu - 1.0), p
    h_step, p_step = above - h, p_above - p
    p = p_above
    while nu < a - 0.5:
        p_step = (nu * p_step - 2.0 * (2.0 * nu + 1.0) * xi * p) / (nu + 1.0)
        h, p = h + h_step, p + p_step
        nu += 1.0
        h_step = ((nu - 1.0) * h_step - 2.0 * (2.0 * nu + 1.0) * xi * h) / (nu + 2.0)
    return h, p


def _leading_terms(a: float, lam: float, xi: FloatArray) -> tuple[FloatArray, FloatArray]:
    from scipy.special import j0, j1, y0, y1

    if lam > 1e30:  # the degree has no digits behind the point; the waves are below rounding
        return np.zeros_like(xi), np.zeros_like(xi)
    u = a + 0.5
    near_end = xi > 0.5
    angle = 2.0 * np.arcsin(np.sqrt(np.where(near_end, 1.0 - xi, xi)))
    with np.errstate(divide="ignore", invalid="ignore"):
        spread = np.where(angle > 0.0, np.sqrt(angle / np.sin(angle)), 1.0)
        bend = np.where(angle > 0.0, (1.0 / np.tan(angle) - 1.0 / angle) / (8.0 * u), 0.0)
        cosine, sine = np.where(near_end, np.cos(np.pi * a), 1.0), np.where(near_end, np.sin(np.pi * a), 0.0)
        z = u * angle
        zero = cosine * j0(z) + np.where(near_end, sine * y0(z), 0.0)
        one = cosine * j1(z) + np.where(near_end, sine * y1(z), 0.0)
        one = np.where(np.isfinite(one), one, 0.0)  # at xi = 1, where the end value is known
    h = np.where(near_end, -1.0, 1.0) * 0.5 * np.sin(angle) * spread * u / lam * one
    return h, spread * (zero + bend * one)
