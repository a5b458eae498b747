"""Infinite string or beam on an elastic, viscous bed under a load that moves with constant speed.

``EI w'''' - T w'' + k w + c w_t + m w_tt = force * exp(i Omega t) delta(x - V t)`` (Winkler bed, with viscous terms
Kelvin-Voigt). In the frame of the load, ``w = W(xi) exp(i Omega t)`` with xi = x - V t, counted ahead of the load,
W is a sum of exponentials exp(r xi) over the roots of

    D(r) = EI r^4 - T r^2 + m (i Omega - V r)^2 + c (i Omega - V r) + k,

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
    "critical_frequency",
    "critical_speed",
    "drive_force",
    "harmonic_state",
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


def critical_frequency(
    *, speed: float, bending_stiffness: float, foundation: float, mass: float, tension: float = 0.0
) -> float:
    """Return the lowest circular frequency at which a moving harmonic load resonates, in rad/s.

    ``0 <= speed < critical_speed`` in m/s, else `ValueError`; ``tension`` not negative; other arguments as in
    `critical_speed`. The least ``omega(q) - q V`` over all waves, with equal group velocity and speed; for the string
    ``sqrt(k/m) sqrt(1 - (V/c)^2)``.
    """
    _arguments.not_negative(speed=speed, tension=tension)
    limit = critical_speed(bending_stiffness=bending_stiffness, foundation=foundation, mass=mass, tension=tension)
    if not speed < limit:
        raise ValueError(f"speed must be below the critical speed {limit:.6g} m/s, not {speed}")
    if bending_stiffness == 0.0:
        return float(np.sqrt(foundation / mass * (1.0 - (speed / limit) ** 2)))

    def frequency(q: float) -> float:
        return float(np.sqrt((bending_stiffness * q**4 + tension * q**2 + foundation) / mass))

    # The group velocity rises with q (frequency is convex for tension >= 0) beyond that of sqrt(EI/m) q^2.
    low, high = 0.0, speed * np.sqrt(mass / bending_stiffness) + (foundation / bending_stiffness) ** 0.25
    while _group_velocity(high, frequency(high), bending_stiffness, tension, mass) < speed:
        high *= 2.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        slow = _group_velocity(middle, frequency(middle), bending_stiffness, tension, mass) < speed
        low, high = (middle, high) if slow else (low, middle)
    return frequency(low) - low * speed


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
    return _moving(x, force, speed, 0.0, bending_stiffness, foundation, mass, tension, damping, derivative).real


def harmonic_state(
    x: ArrayLike,
    *,
    force: complex,
    frequency: float,
    speed: float,
    bending_stiffness: float,
    foundation: float,
    mass: float,
    tension: float = 0.0,
    damping: float = 0.0,
    derivative: int = 0,
) -> ComplexArray:
    """Return the complex amplitude W of the deflection ``Re[W exp(i frequency t)]`` that travels with a load, in m.

    The load is ``Re[force exp(i frequency t)]``, ``force`` (N) possibly complex, ``frequency`` the circular one in
    rad/s, not negative. Other arguments and errors as in `steady_state`; without damping the critical frequency of
    the speed is an error.
    """
    _arguments.not_negative(frequency=frequency)
    return _moving(x, force, speed, frequency, bending_stiffness, foundation, mass, tension, damping, derivative)


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
    return np.asarray(_moving(x, 1.0, speed, 0.0, *line, 0).real @ forces)


def drive_force(
    *,
    force: float,
    speed: float,
    bending_stiffness: float,
    foundation: float,
    mass: float,
    tension: float = 0.0,
    damping: float = 0.0,
) -> float:
    """Return the force along the line that keeps a constant load moving, in N.

    Arguments and errors as in `steady_state`. ``-force`` times the mean slope at the load; times the speed it is what
    the damping dissipates and the waves carry away. Zero below the critical speed without damping.
    """
    if bending_stiffness == 0.0 and _pull(tension, mass, speed) == 0.0:
        raise ValueError("speed is the wave speed of the string, where the drive force is infinite")
    slope = steady_state(
        0.0,
        force=force,
        speed=speed,
        bending_stiffness=bending_stiffness,
        foundation=foundation,
        mass=mass,
        tension=tension,
        damping=damping,
        derivative=1,
    )
    return float(-force * slope)


def _group_velocity(q: float, frequency: float, stiffness: float, tension: float, mass: float) -> float:
    return float((2.0 * stiffness * q**3 + tension * q) / (mass * frequency))


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
    force: complex,
    speed: float,
    frequency: float,
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
        mass=mass,
        foundation=foundation,
        damping=damping,
        speed=speed / unit,
        frequency=frequency,
    )
    return force / unit ** (1 + derivative) * polynomial.response(np.asarray(x, dtype=np.float64) / unit, derivative)


def _pull(tension: float, mass: float, speed: float) -> float:
    """T - m V^2, zero at the wave speed in spite of rounding."""
    pull = tension - mass * speed**2
    return 0.0 if abs(pull) < 4e-15 * abs(tension) else pull


@dataclass(frozen=True)
class _Polynomial:
    """D(r) = stiffness r^4 - pull r^2 + mass (-Omega^2 - 2 i Omega V r) + damping (i Omega - V r) + foundation."""

    stiffness: float
    pull: float
    mass: float
    foundation: float
    damping: float
    speed: float
    frequency: float

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

    def _sides(self) -> tuple[complex, ComplexArray, ComplexArray]:
        """Leading coefficient, roots ahead, roots behind."""
        gyration = 2.0 * self.mass * self.speed * self.frequency
        spring = self.foundation - self.mass * self.frequency**2
        # With r = i q the undamped coefficients are real, so that waves (q real) are told from decay without doubt.
        real = np.trim_zeros(np.array([self.stiffness, 0.0, self.pull, gyration, spring]), "f")
        drag, loss = self.damping * self.speed, self.damping * self.frequency
        if drag == 0.0 and loss == 0.0:
            q = _roots_of_squares(real) if gyration == 0.0 else _all_roots(real)
            self._refuse_critical(q)
            wave = q.imag == 0.0
        else:
            losses = np.array([0.0, 0.0, 0.0, -1j * drag, 1j * loss])
            q = _all_roots(np.trim_zeros(np.array([self.stiffness, 0.0, self.pull, gyration, spring]) + losses, "f"))
            wave = np.abs(q.imag) < 1e-12 * np.abs(q)  # damping too small to be seen in the roots
        slope = np.polyval(np.polyder(real), q).real
        outgoing = (self.frequency - self.speed * q.real) * slope < 0.0  # radiation: where damping would move it
        ahead = np.where(wave, outgoing, q.imag > 0.0)
        r = 1j * q
        degree = len(q)
        lead = {4: self.stiffness, 2: -self.pull, 1: -drag - 1j * gyration}[degree]
        return lead, r[ahead], r[~ahead]

    def _refuse_critical(self, q: ComplexArray) -> None:
        """A double root on or next to the real axis belongs to both sides; pairs that decay on one side may meet."""
        size = np.max(np.abs(q), initial=1e-300)
        facing = np.abs(q.imag) < CLOSE * size
        gaps = np.abs(q[:, np.newaxis] - q) + np.diag(np.full(len(q), np.inf))
        if len(q) == 0 or np.any(facing & (np.min(gaps, axis=1, initial=np.inf) < 2.0 * CLOSE * size)):
            raise ValueError(
                "without damping there is no steady state at exactly the critical speed or frequency; change the speed "
                "or the frequency, or give damping"
            )


def _all_roots(coefficients: NDArray[np.number]) -> ComplexArray:
    return np.roots(coefficients).astype(np.complex128)


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
