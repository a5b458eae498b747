"""Force, mass, oscillator or vehicle that crosses a Bernoulli-Euler beam with constant speed.

The beam has an axial force, an elastic bed and viscous damping, and simply supported or clamped ends
(`beam_modes`). It is at rest at t = 0, when the load enters at x = 0, and vibrates freely after the load has left.
Deflections are positive in the direction of the load.

A force is treated here, exactly for every mode (Fryba, Vibration of Solids and Structures under Moving Loads, for
the simply supported beam; the rest derived here): its modal force is a sum of exponentials exp(s V t), and the
response to one of them is the second divided difference of z -> exp(z t) over s V and the two poles of the mode. In
that form nothing is special about resonance, critical damping or a pole at zero. Loads with inertia are in
`beam_crossing`, those that can leave the beam in `beam_flight`; their names stand here, too.

All functions take the beam as the keyword arguments of `Beam`: ``length``, ``bending_stiffness``, ``mass``,
``tension``, ``foundation``, ``damping``, ``ends``. ``modes`` fixes the number of modes; without it as many are taken
as keep the part left out below ``tolerance`` times the static deflection.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments
from ropewalk.theory.beam_crossing import Crossing, moving_mass, moving_oscillator, moving_vehicle
from ropewalk.theory.beam_flight import Flight, flying_vehicle
from ropewalk.theory.beam_modes import Beam, Ends, Modes, buckling_force, natural_frequencies, resonance_speeds
from ropewalk.theory.beam_response import free, poles, second_difference
from ropewalk.theory.beam_vehicle import Vehicle

__all__ = [
    "Beam",
    "Crossing",
    "Flight",
    "Peak",
    "Vehicle",
    "buckling_force",
    "flying_vehicle",
    "impact_factor",
    "moving_force",
    "moving_force_peak",
    "moving_force_velocity",
    "moving_mass",
    "moving_oscillator",
    "moving_vehicle",
    "natural_frequencies",
    "resonance_speeds",
    "standing_force",
]

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
Coordinates = Callable[[FloatArray], FloatArray]

TOLERANCE = 1e-9


def moving_force(
    x: ArrayLike,
    t: ArrayLike,
    *,
    force: float,
    speed: float,
    length: float,
    bending_stiffness: float,
    mass: float,
    tension: float = 0.0,
    foundation: float = 0.0,
    damping: float = 0.0,
    ends: Ends = "simply_supported",
    modes: int | None = None,
    tolerance: float = TOLERANCE,
) -> FloatArray:
    """Return the deflection of a beam under a constant force that crosses it, in m.

    ``x`` (m, within 0..length) and ``t`` (s; at rest before 0) broadcast and give the shape of the result. ``force``
    in N, ``speed`` >= 0 in m/s; the beam as in `Beam`; ``modes`` or ``tolerance`` as in the head of this module.
    `ValueError` for arguments out of range and for a beam that buckles. At speed 0 the force stays on the support and
    nothing moves. Loads one after the other: add results at ``t - distance/speed``.

    Simply supported and undamped: ``q_n = 2F/(mL) (sin O t - O/w sin w t)/(w^2 - O^2)``, O = n pi V/L, w the natural
    frequency; at O = w ``F/(mL w^2) (sin w t - w t cos w t)``.
    """
    beam = Beam(length, bending_stiffness, mass, tension, foundation, damping, ends)
    return _field(x, t, 0, beam, force, speed, modes, tolerance)


def moving_force_velocity(
    x: ArrayLike,
    t: ArrayLike,
    *,
    force: float,
    speed: float,
    ends: Ends = "simply_supported",
    modes: int | None = None,
    tolerance: float = TOLERANCE,
    **beam: float,
) -> FloatArray:
    """Return the velocity dw/dt of the deflection that `moving_force` gives, in m/s.

    Arguments and errors as there. Its series converges one order more slowly, so ``tolerance`` is not a bound for it.
    """
    return _field(x, t, 1, Beam(ends=ends, **beam), force, speed, modes, tolerance)


def standing_force(
    x: ArrayLike,
    place: ArrayLike,
    *,
    force: float,
    ends: Ends = "simply_supported",
    modes: int | None = None,
    tolerance: float = TOLERANCE,
    **beam: float,
) -> FloatArray:
    """Return the static deflection at ``x`` under a force that stands at ``place``, in m, the limit of slow travel.

    ``x`` and ``place`` in m, within 0..length, broadcast. Other arguments and errors as in `moving_force`.
    ``F sum phi_n(x) phi_n(place)/omega_n^2``; at midspan F L^3/(48 EI) on two simple supports without axial force
    and bed, F L^3/(192 EI) between clamped ends.
    """
    given = Beam(ends=ends, **beam)
    _arguments.finite(force=force)
    x, place = _arguments.within(0.0, given.length, x=x, place=place)
    series = given.modes(modes if modes is not None else given.enough(tolerance, 0.0))
    count = len(series.frequency)
    return _combine(x, place, count, series.shape, lambda at: force * series.shape(at) / series.frequency**2)


@dataclass(frozen=True)
class Peak:
    """Largest deflection in m, its place in m and its instant in s."""

    deflection: float
    x: float
    t: float


def moving_force_peak(
    *,
    force: float,
    speed: float,
    x: float | None = None,
    free_vibration: bool = True,
    ends: Ends = "simply_supported",
    modes: int | None = None,
    tolerance: float = TOLERANCE,
    **beam: float,
) -> Peak:
    """Find the largest deflection, in the sense of the force, at ``x`` (m) or anywhere on the beam if None.

    Searched from the entry to the exit and, with ``free_vibration``, for one period of the lowest mode beyond.
    ``speed`` must be positive; other arguments and errors as in `moving_force`. The result has the accuracy of the
    series.
    """
    _arguments.positive(speed=speed)
    _arguments.finite(force=force)
    return _peak(Beam(ends=ends, **beam), force, speed, x, free_vibration, modes, tolerance)


def _peak(
    given: Beam,
    force: float,
    speed: float,
    x: float | None,
    free_vibration: bool,
    modes: int | None,
    tolerance: float,
) -> Peak:
    """A coarse search with few modes, then ever smaller windows about the best point with all of them."""
    series = given.modes(modes if modes is not None else given.enough(tolerance, speed))
    until = given.length / speed + (2.0 * np.pi / series.frequency[0] if free_vibration else 0.0)
    places = (0.0, given.length) if x is None else (float(x), float(x))
    _arguments.within(0.0, given.length, x=places)
    sense = -1.0 if force < 0.0 else 1.0

    def deflection(at: FloatArray, t: FloatArray, used: Modes) -> FloatArray:
        return sense * force * (_modal(t, 0, used, given, speed) @ used.shape(at).T)

    few = given.modes(min(len(series.frequency), 60))
    highest = int(min(4000, 400 + 8 * until * few.frequency[min(len(few.frequency), 10) - 1] / (2.0 * np.pi)))
    t, at = np.linspace(0.0, until, highest), np.linspace(*places, 1 if x is not None else 201)
    value = deflection(at, t, few)
    for zoom in range(30):
        row, column = np.unravel_index(np.argmax(value), value.shape)
        best = Peak(sense * float(value[row, column]), float(at[column]), float(t[row]))
        reach_t, reach_x = 4.0 * (t[1] - t[0]), 4.0 * (at[1] - at[0]) if x is None else 0.0
        if zoom and reach_t <= 1e-9 * until:
            break
        t = np.linspace(max(best.t - reach_t, 0.0), min(best.t + reach_t, until), 33)
        if x is None:
            at = np.linspace(max(best.x - reach_x, 0.0), min(best.x + reach_x, given.length), 33)
        value = deflection(at, t, series)
    return best


def impact_factor(
    speed: ArrayLike,
    *,
    x: float | None = None,
    free_vibration: bool = True,
    ends: Ends = "simply_supported",
    modes: int | None = None,
    tolerance: float = TOLERANCE,
    **beam: float,
) -> FloatArray:
    """Return the dynamic amplification: largest deflection by the largest static one, shape of ``speed``.

    ``speed`` >= 0 in m/s, 1 at speed 0. Both deflections are taken at ``x`` in m, which must lie between the ends,
    or wherever they are largest if None; arguments and errors as in `moving_force_peak`.
    """
    given = Beam(ends=ends, **beam)
    speed = np.asarray(speed, dtype=np.float64)
    if not np.all(np.isfinite(speed) & (speed >= 0.0)):
        raise ValueError("speed must be finite and not negative")
    if x is not None and not 0.0 < x < given.length:
        raise ValueError(f"x must lie between the supports, not at {x}")
    static = _largest_static(given, x, modes, tolerance)

    def factor(v: float) -> float:
        if v == 0.0:
            return 1.0
        peak = _peak(given, 1.0, v, x, free_vibration, modes, tolerance)
        return peak.deflection / static

    factors = [factor(float(v)) for v in speed.ravel()]
    return np.array(factors).reshape(speed.shape)


def _largest_static(beam: Beam, x: float | None, modes: int | None, tolerance: float) -> float:
    """Largest static deflection at x for any place of a unit force; anywhere, it is under the force."""
    series = beam.modes(modes if modes is not None else beam.enough(tolerance, 0.0))
    low, high = 0.0, beam.length
    for _ in range(14):
        place = np.linspace(low, high, 41)
        shape = series.shape(place)
        value = (
            shape**2 @ series.frequency**-2.0
            if x is None
            else shape @ (series.shape(np.asarray(x)) / series.frequency**2)
        )
        best = int(np.argmax(value))
        low, high = place[max(best - 3, 0)], place[min(best + 3, 40)]
    return float(np.max(value))


def _field(
    x: ArrayLike,
    t: ArrayLike,
    derivative: int,
    beam: Beam,
    force: float,
    speed: float,
    modes: int | None,
    tolerance: float,
) -> FloatArray:
    _arguments.finite(force=force, t=t)
    _arguments.not_negative(speed=speed)
    (x,) = _arguments.within(0.0, beam.length, x=x)
    series = beam.modes(modes if modes is not None else beam.enough(tolerance, speed))
    t = np.asarray(t, dtype=np.float64)
    count = len(series.frequency)
    return _combine(x, t, count, series.shape, lambda at: force * _modal(at, derivative, series, beam, speed))


def _modal(t: FloatArray, derivative: int, modes: Modes, beam: Beam, speed: float) -> FloatArray:
    """Modal coordinates (or velocities) for a unit force that entered at t = 0, shape (*t.shape, mode)."""
    if speed == 0.0:  # it never leaves the support
        return np.zeros((*t.shape, len(modes.frequency)))
    t, exit_time = np.maximum(t, 0.0)[..., np.newaxis], beam.length / speed
    pair = poles(modes.frequency, beam.decay)
    gone = t > exit_time
    value, rate = _forced(np.minimum(t, exit_time), modes, pair, speed)
    if np.any(gone):
        from_q, from_rate, rate_from_q, rate_from_rate = free(pair, np.where(gone, t - exit_time, 0.0))
        value, rate = from_q * value + from_rate * rate, rate_from_q * value + rate_from_rate * rate
    return value if derivative == 0 else rate


def _forced(
    t: FloatArray, modes: Modes, pair: tuple[ComplexArray, ComplexArray], speed: float
) -> tuple[FloatArray, FloatArray]:
    """Response from rest and its rate; with f: z -> exp(z t) they are f[s, p1, p2] and s f[s, p1, p2] + f[p1, p2].

    The last term leaves the sum: it gets the factor phi(0) = 0.
    """
    value, rate = np.zeros((2, *np.broadcast_shapes(t.shape, modes.frequency.shape)))
    for exponent, amplitude, offset in zip(modes.exponent, modes.amplitude, modes.offset, strict=True):
        if np.any(amplitude):
            forced = second_difference(exponent * speed, pair, t, offset)
            value += (amplitude * forced).real
            rate += (amplitude * exponent * speed * forced).real
    return value, rate


def _combine(x: FloatArray, t: FloatArray, count: int, shapes: Coordinates, coordinates: Coordinates) -> FloatArray:
    """Sum of the modes over the broadcast of x and t; a matrix product where no axis is shared by both."""
    rank = max(x.ndim, t.ndim)
    x, t = (a.reshape((1,) * (rank - a.ndim) + a.shape) for a in (x, t))
    if not all(1 in pair for pair in zip(x.shape, t.shape, strict=True)):
        x, t = np.broadcast_arrays(x, t)
        rows = zip(_blocks(x.ravel(), count), _blocks(t.ravel(), count), strict=True)
        return np.concatenate([np.sum(shapes(a) * coordinates(b), axis=-1) for a, b in rows]).reshape(x.shape)
    shape = shapes(x.ravel()).T
    table = np.concatenate([coordinates(b) @ shape for b in _blocks(t.ravel(), count)]).reshape(t.shape + x.shape)
    for axis in range(rank):  # bring each axis of t next to its partner of x, one of which has length 1
        table = np.moveaxis(table, rank + axis, 2 * axis + 1)
    return table.reshape(np.broadcast_shapes(x.shape, t.shape))


def _blocks(values: FloatArray, count: int) -> list[FloatArray]:
    """Pieces short enough for tables of (value, mode) to stay in memory."""
    return np.array_split(values, max(1, -(-len(values) * count // 2_000_000)))
