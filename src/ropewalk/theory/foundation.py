"""Infinite string or beam on an elastic, viscous bed under a load that moves with constant speed.

``EI w'''' - T w'' + k w + c w_t + m w_tt = force delta(x - V t)`` (Winkler bed, with viscous terms
Kelvin-Voigt). In the frame of the load, with xi = x - V t counted ahead of the load, w is a sum of exponentials
exp(r xi) over the roots of

    D(r) = EI r^4 - (T - m V^2) r^2 - c V r + k,

those with Re r < 0 ahead of the load, the others behind it (derived here; Fryba, Vibration of Solids and Structures
under Moving Loads, for the constant force). Without damping a root on the imaginary axis, a wave, stands on the side
to which vanishing damping moves it: the radiation condition. The two roots of one side enter through their divided
difference, so that nothing cancels where they meet.

A string is the beam with ``bending_stiffness=0``. ``foundation`` is in N/m^2, ``mass`` in kg/m, ``damping`` in
N s/m^2. ``tension`` in N may be negative as long as the resting beam does not buckle, above ``-2 sqrt(k EI)``.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

__all__ = [
    "critical_speed",
    "several_loads",
    "steady_state",
]

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

# Undamped roots nearer to each other than this part of their size count as one: the critical state.
CLOSE = 1e-7


def critical_speed(*, bending_stiffness: float, foundation: float, mass: float, tension: float = 0.0) -> float:
    """Return the speed above which a constant load radiates waves, in m/s: the least phase velocity.

    Units as in the head of this module; ``bending_stiffness`` and ``foundation`` may be 0. `ValueError` out of range
    and where the resting beam buckles. ``V_cr^2 = (T + 2 sqrt(k EI))/m``, at the wavenumber (k/EI)^(1/4).
    """
    _line(bending_stiffness, foundation, mass, tension, 0.0)
    return float(np.sqrt((tension + 2.0 * np.sqrt(foundation * bending_stiffness)) / mass))


def steady_state(
    x: ArrayLike,
    *,
    force: float,
    speed: float,
    bending_stiffness: float,
    foundation: float,
    mass: float,
    tension: float = 0.0,
    damping: float = 0.0,
    derivative: int = 0,
) -> FloatArray:
    """Return the deflection that travels with a constant force, in m, or a derivative of it along the line.

    ``x`` in m is the distance ahead of the load (behind it negative), of any shape; ``force`` in N, ``speed`` >= 0 in
    m/s, the line as in the head of this module with ``foundation`` positive; ``derivative`` 0 to 3, at the load the
    mean of both sides. `ValueError` out of range, and without damping at exactly the critical speed,
    where no steady state exists; string at exactly its wave speed: undamped likewise, damped
    ``F/(c V) exp(k x/(c V))`` behind and at the load, zero ahead.

    Undamped below the critical speed, with ``a^2, b^2 = sqrt(k/(4 EI)) +- (T - m V^2)/(4 EI)``:
    ``w = F exp(-a |x|) (cos b x + a sin(b |x|)/b)/(4 EI a (a^2 + b^2))``. Formula in general: head of this module.
    """
    return _moving(x, force, speed, bending_stiffness, foundation, mass, tension, damping, derivative).real


def several_loads(
    x: ArrayLike,
    *,
    forces: ArrayLike,
    places: ArrayLike,
    speed: float,
    bending_stiffness: float,
    foundation: float,
    mass: float,
    tension: float = 0.0,
    damping: float = 0.0,
) -> FloatArray:
    """Return the deflection under several constant forces that travel together, in m.

    ``forces`` (N) and ``places`` (m, ahead of the origin of ``x``) are lists of one length. Other arguments and errors
    as in `steady_state`, whose results are added.
    """
    forces, places = (np.atleast_1d(np.asarray(a, dtype=np.float64)) for a in (forces, places))
    if forces.ndim != 1 or forces.shape != places.shape:
        raise ValueError("forces and places must be lists of one length")
    x = np.asarray(x, dtype=np.float64)[..., np.newaxis] - places
    line = (bending_stiffness, foundation, mass, tension, damping)
    return np.asarray(_moving(x, 1.0, speed, *line, 0).real @ forces)


def _line(bending_stiffness: float, foundation: float, mass: float, tension: float, damping: float) -> None:
    _arguments.positive(mass=mass)
    _arguments.not_negative(bending_stiffness=bending_stiffness, foundation=foundation, damping=damping)
    _arguments.finite(tension=tension)
    limit = -2.0 * np.sqrt(foundation * bending_stiffness)
    if tension < limit or (tension == limit and tension < 0.0):
        raise ValueError(f"the resting beam buckles: tension must be above {limit:.6g} N, not {tension:.6g} N")
    if bending_stiffness == 0.0 and tension <= 0.0:
        raise ValueError("tension must be positive where bending_stiffness is 0")


def _moving(
    x: ArrayLike,
    force: float,
    speed: float,
    bending_stiffness: float,
    foundation: float,
    mass: float,
    tension: float,
    damping: float,
    derivative: int,
) -> ComplexArray:
    _line(bending_stiffness, foundation, mass, tension, damping)
    _arguments.positive(foundation=foundation)
    _arguments.not_negative(speed=speed)
    _arguments.finite(x=x, force=force)
    if derivative not in (0, 1, 2, 3):
        raise ValueError(f"derivative must be 0, 1, 2 or 3, not {derivative}")
    # Lengths in units that make the coefficients comparable.
    unit = (bending_stiffness / foundation) ** 0.25 or float(np.sqrt(tension / foundation))
    polynomial = _Polynomial(
        stiffness=bending_stiffness / unit**4,
        pull=_pull(tension, mass, speed) / unit**2,
        foundation=foundation,
        drag=damping * speed / unit,
    )
    return force / unit ** (1 + derivative) * polynomial.response(np.asarray(x, dtype=np.float64) / unit, derivative)


def _pull(tension: float, mass: float, speed: float) -> float:
    """T - m V^2, zero at the wave speed in spite of rounding."""
    pull = tension - mass * speed**2
    return 0.0 if abs(pull) < 4e-15 * abs(tension) else pull


@dataclass(frozen=True)
class _Polynomial:
    """D(r) = stiffness r^4 - pull r^2 - drag r + foundation."""

    stiffness: float
    pull: float
    foundation: float
    drag: float

    def response(self, xi: FloatArray, derivative: int) -> ComplexArray:
        """Solution of D(d/dxi) W = delta(xi) that stays bounded, or one of its derivatives."""
        lead, ahead, behind = self._sides()
        value = np.zeros(xi.shape, dtype=np.complex128)
        for roots, others, side, sign in ((ahead, behind, xi > 0.0, 1.0), (behind, ahead, xi < 0.0, -1.0)):
            value[side] = sign / lead * _residues(roots, others, xi[side], derivative)
        at, none = xi == 0.0, np.zeros(1)
        if np.any(at):
            both = _residues(ahead, behind, none, derivative)[0] - _residues(behind, ahead, none, derivative)[0]
            # With one root only the string jumps at the load, which stands on what it has pressed down already.
            value[at] = both / lead * (1.0 if len(ahead) + len(behind) == 1 else 0.5)
        return value

    def _sides(self) -> tuple[float, ComplexArray, ComplexArray]:
        """Leading coefficient, roots ahead, roots behind."""
        # With r = i q the undamped coefficients are real, so that waves (q real) are exactly distinguished from decay.
        whole = np.array([self.stiffness, 0.0, self.pull, 0.0, self.foundation])
        real = np.trim_zeros(whole, "f")
        if self.drag == 0.0:
            q = _roots_of_squares(real)
            self._refuse_critical(q)
            wave = q.imag == 0.0
        else:
            damped = np.trim_zeros(whole + np.array([0.0, 0.0, 0.0, -1j * self.drag, 0.0]), "f")
            q = np.roots(damped).astype(np.complex128)
            wave = np.abs(q.imag) < 1e-12 * np.abs(q)  # damping too small to be seen in the roots
        outgoing = q.real * np.polyval(np.polyder(real), q).real > 0.0  # radiation: where damping would move it
        ahead = np.where(wave, outgoing, q.imag > 0.0)
        r = 1j * q
        degree = len(q)
        lead = {4: self.stiffness, 2: -self.pull, 1: -self.drag}[degree]
        return lead, r[ahead], r[~ahead]

    def _refuse_critical(self, q: ComplexArray) -> None:
        """A double root on or next to the real axis belongs to both sides; pairs that decay on one side may meet."""
        size = np.max(np.abs(q), initial=1e-300)
        facing = np.abs(q.imag) < CLOSE * size
        gaps = np.abs(q[:, np.newaxis] - q) + np.diag(np.full(len(q), np.inf))
        if len(q) == 0 or np.any(facing & (np.min(gaps, axis=1, initial=np.inf) < 2.0 * CLOSE * size)):
            raise ValueError(
                "without damping there is no steady state at exactly the critical speed; change it, or give damping"
            )


def _roots_of_squares(real: FloatArray) -> ComplexArray:
    """Roots of a polynomial in q^2, exactly in pairs."""
    if len(real) < 5:
        squares = -real[-1] / real[:1] + 0j if len(real) == 3 else np.zeros(0, dtype=np.complex128)
    else:
        stiffness, _, pull, _, spring = real
        root = np.sqrt(pull**2 - 4.0 * stiffness * spring + 0j)
        larger = -0.5 * (pull + (root if pull >= 0.0 else -root))
        squares = np.array([larger / stiffness, spring / larger if larger != 0.0 else 0.0])
    positive = np.sqrt(squares)
    return np.concatenate([positive, -positive])


def _residues(roots: ComplexArray, others: ComplexArray, xi: FloatArray, derivative: int) -> ComplexArray:
    """Sum of ``r^d exp(r xi)`` over the product of the differences of r to all other roots."""
    if len(roots) == 2:
        return _pair(roots, others, xi, derivative)
    value = np.zeros(xi.shape, dtype=np.complex128)
    for index, r in enumerate(roots):
        rest = np.concatenate([np.delete(roots, index), others])
        value += r**derivative * np.exp(r * xi) / np.prod(r - rest)
    return value


def _pair(roots: ComplexArray, others: ComplexArray, xi: FloatArray, derivative: int) -> ComplexArray:
    """The same for two roots, which may meet: the divided difference of a product, by Leibniz' rule."""
    one, two = sorted(roots, key=lambda r: r.real, reverse=bool(np.all(xi >= 0.0)))
    z = (two - one) * xi
    tiny = np.abs(z) < 1e-100  # complex division of the smallest numbers overflows
    mean = np.where(tiny, 1.0, np.expm1(z) / np.where(tiny, 1.0, z))
    value: ComplexArray = np.exp(two * xi)
    difference: ComplexArray = xi * np.exp(one * xi) * mean  # of exp(r xi): at two, between both
    for factor_one, factor_two, slope in (
        (one**derivative, two**derivative, sum(one**i * two ** (derivative - 1 - i) for i in range(derivative))),
        *((1.0 / (one - s), 1.0 / (two - s), -1.0 / ((one - s) * (two - s))) for s in others),
    ):
        difference = difference * factor_one + value * slope
        value = value * factor_two
    return difference
