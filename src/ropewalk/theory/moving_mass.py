"""A mass that travels along a taut string with constant speed; the contact force is the unknown.

On a massless string the path is a hypergeometric function; on a string with mass the force obeys a delay equation,
which is marched to the far support. Expanding the string in modes converges only as 1/N, so that no modes are used:
docs/notes/moving-mass-on-a-string.md.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ropewalk.theory import _arguments, _delay, _massless
from ropewalk.theory._wave import FloatArray, check_string, wave_speed

__all__ = ["SLOWEST", "MassPassage", "moving_mass", "passage_time", "times_of_passage"]

SLOWEST = 0.02  # of the wave speed, on a string with mass: the number of reflections grows as its inverse, squared

LIGHTEST = 1e14  # twice the string's mass over the load's, beyond which only the weight counts


@dataclass(frozen=True)
class MassPassage:
    """Motion of a load on a string; arrays of the shape of the times.

    ``deflection`` (m) and ``velocity`` (m/s, of the load, across the string) in the direction of gravity,
    ``contact_force`` (N) of the load on the string. The load is held to the string: where the force is negative it
    would have lifted off. ``contact_lost_at`` is the first such time of the whole passage, in s, or None; the values
    after it belong to a load that cannot lift off.
    """

    deflection: FloatArray
    velocity: FloatArray
    contact_force: FloatArray
    contact_lost_at: float | None


def moving_mass(
    t: ArrayLike,
    *,
    load_mass: float,
    speed: float,
    length: float,
    tension: float,
    mass: float,
    gravity: float = 9.81,
) -> MassPassage:
    """Return the motion of a mass that enters a string at rest at t = 0 and travels to the other support.

    ``t`` (s) from 0 to length/speed; ``load_mass`` in kg, ``speed`` >= 0 in m/s, ``length`` in m, ``tension`` in N,
    ``mass`` of the string in kg/m, which may be 0, ``gravity`` in m/s^2. Raises `ValueError` for arguments out of
    range, among them times after the passage and, on a string with mass, speeds other than 0 below 0.02 of the wave
    speed: take ``mass=0`` for these.

    Massless: `_massless`, exact. With mass and slower than the waves: the delay equation of `_delay`, to rounding
    until 2L/(V + c), when the first wave comes back from the far support; then with errors below 1e-9 m g L/P of the
    path and 2e-6 of the force's size, 1e-4 in the last thousandth of the way. It takes 0.01 s at half the wave speed, a
    second at the slowest for a load as heavy as the string, a minute for one of a hundredth of that. At the wave speed
    and above the load meets a string at rest: no deflection, the force is the weight. (From below, the wave speed has
    another limit: a mass on a string without ends.)

    At t = length/speed the deflection is the limit, which is not 0 in general: the paradox of the trajectory. Before,
    the force grows as 1/(L - V t), on a string with mass times a function that repeats itself with every bounce of the
    wave ahead of the load, and the velocity as a logarithm. There both are given as infinite, the force with the sign
    of its mean over a bounce, which is that of the deflection. On a massless string with P L/(m V^2) = k (k + 1),
    k > 1, they are finite.
    """
    t = times_of_passage(t, speed, length, tension, mass)
    _arguments.positive(load_mass=load_mass, gravity=gravity)
    weight = load_mass * gravity
    if speed == 0.0 or (mass > 0.0 and speed >= wave_speed(tension=tension, mass=mass)):
        return MassPassage(np.zeros_like(t), np.zeros_like(t), np.full_like(t, weight), None)
    if mass == 0.0:
        return _on_massless(t, load_mass, speed, length, tension, weight)
    c = wave_speed(tension=tension, mass=mass)
    line = min(2.0 * mass * length / load_mass, LIGHTEST)
    response = _delay.response(speed / c, _delay.DelayBody(np.ones(1), np.zeros((1, 1)), np.ones(1), line))
    own = t * c / length
    force, velocity = weight * response.force(own), gravity * length / c * response.state(0, own)
    arrived = own * speed / c >= 1.0 - _delay.REMAINDER
    endless = np.copysign(np.inf, response.end)
    lost = response.contact_lost()
    return MassPassage(
        deflection=gravity * (length / c) ** 2 * response.path(own),
        velocity=np.where(arrived, -endless, velocity),
        contact_force=np.where(arrived, endless, force),
        contact_lost_at=None if lost is None else lost * length / c,
    )


def passage_time(speed: float, length: float) -> float:
    """Return the time that the load takes, infinite if it stands; `ValueError` for a negative speed or no length."""
    _arguments.not_negative(speed=speed)
    _arguments.positive(length=length)
    return length / speed if speed > 0.0 else np.inf


def times_of_passage(t: ArrayLike, speed: float, length: float, tension: float, mass: float) -> FloatArray:
    """Return the times as an array; raise `ValueError` unless they lie in the passage and the string can be marched."""
    _arguments.not_negative(mass=mass)
    check_string(speed=speed, length=length, tension=tension, mass=mass if mass > 0.0 else 1.0)
    if mass > 0.0 and 0.0 < speed < SLOWEST * wave_speed(tension=tension, mass=mass):
        slowest = SLOWEST * wave_speed(tension=tension, mass=mass)
        raise ValueError(
            f"speed must be 0 or at least {slowest:g} ({SLOWEST:g} of the wave speed), not {speed:g}; "
            "mass=0 takes any speed"
        )
    times = np.asarray(t, dtype=np.float64)
    last = passage_time(speed, length)
    if not np.all(np.isfinite(times) & (times >= 0.0) & (times <= last * (1.0 + 1e-12))):
        raise ValueError(f"t must lie in the passage, between 0 and length/speed = {last:g} s")
    return np.minimum(times, last)


def _on_massless(
    t: FloatArray, load_mass: float, speed: float, length: float, tension: float, weight: float
) -> MassPassage:
    lam = min(tension * length / load_mass / speed / speed, 1e300)
    xi = np.minimum(t * speed / length, 1.0)
    xi = np.where(t == passage_time(speed, length), 1.0, xi)
    y, slope = _massless.shape(lam, xi)
    between = np.where((xi > 0.0) & (xi < 1.0), xi * (1.0 - xi), 1.0)
    force = np.where(xi > 0.0, y / between, 0.0)
    degree = _massless.degree(lam)
    if degree < 1.5 or (lam < 1e30 and abs(degree - np.rint(degree)) > 1e-12):
        end_force, end_slope = (
            np.copysign(np.inf, _massless.end_value(lam)),
            -np.copysign(np.inf, _massless.end_value(lam)),
        )
    else:
        end_slope = lam / (lam - 2.0) * (-1.0 - (-1.0) ** np.rint(degree)) if lam < 1e30 else -1.0
        end_force = -end_slope
    lost = _massless.contact_lost(lam)
    return MassPassage(
        deflection=weight * length / tension * y,
        velocity=weight / tension * speed * np.where(xi == 1.0, end_slope, slope),
        contact_force=weight * np.where(xi == 1.0, end_force, force),
        contact_lost_at=None if lost is None else lost * length / speed,
    )
