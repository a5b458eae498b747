"""A sprung body that travels along a taut string with constant speed on a mass in contact with the string."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ropewalk.theory import _arguments, _delay
from ropewalk.theory._wave import FloatArray, wave_speed
from ropewalk.theory.moving_mass import times_of_passage

__all__ = ["OscillatorPassage", "moving_oscillator"]

NO_MASS = 1e-9  # of the total: a smaller contact mass counts as none


@dataclass(frozen=True)
class OscillatorPassage:
    """Motion of an oscillator on a string; arrays of the shape of the times.

    ``deflection`` (m) and ``velocity`` (m/s) of the contact, ``body_deflection`` and ``body_velocity`` of the sprung
    body from its rest on rigid ground, all in the direction of gravity; ``contact_force`` (N) of the load on the
    string. The contact is held: `contact_lost_at` is the first time at which the force turns negative, in s, or None.
    """

    deflection: FloatArray
    velocity: FloatArray
    body_deflection: FloatArray
    body_velocity: FloatArray
    contact_force: FloatArray
    contact_lost_at: float | None


def moving_oscillator(
    t: ArrayLike,
    *,
    sprung_mass: float,
    contact_mass: float = 0.0,
    stiffness: float,
    damping: float = 0.0,
    speed: float,
    length: float,
    tension: float,
    mass: float,
    gravity: float = 9.81,
) -> OscillatorPassage:
    """Return the motion of an oscillator that rolls from rigid ground onto a string at rest, and to its other end.

    ``t`` (s) from 0 to length/speed; ``sprung_mass`` in kg on ``stiffness`` >= 0 in N/m and ``damping`` >= 0 in N s/m,
    ``contact_mass`` >= 0 in kg; the rest, errors and accuracy as in `moving_mass`, with a positive ``mass`` of the
    string. The spring carries the body's weight at t = 0. With contact force N and spring force
    ``f = K (y - w) + C (y' - w')``,

        contact_mass w'' = (sprung_mass + contact_mass) g + f - N,    sprung_mass y'' = -f,

    and N from the delay equation in `_delay`. Without contact mass w' jumps when a wave front arrives, and the values
    at length/speed are finite; with it, force and velocity are infinite there as in `moving_mass`.
    """
    _arguments.positive(mass=mass)
    t = times_of_passage(t, speed, length, tension, mass)
    _check_oscillator(sprung_mass, contact_mass, stiffness, damping, gravity)
    total, still = sprung_mass + contact_mass, np.zeros_like(t)
    contact_mass = contact_mass if contact_mass > NO_MASS * total else 0.0
    c = wave_speed(tension=tension, mass=mass)
    if speed == 0.0 or speed >= c:
        return OscillatorPassage(still, still, still, still, np.full_like(t, total * gravity), None)
    time = length / c
    moving_load = _moving_load(
        contact_mass / total, stiffness * time**2 / total, damping * time / total, 2.0 * mass * length / total
    )
    response = _delay.response(speed / c, moving_load)
    own = t / time
    w, force, v = response.path(own), response.force(own), response.state(0, own)
    arrived = (own * speed / c >= 1.0 - _delay.REMAINDER) & (contact_mass > 0.0)
    endless = np.copysign(np.inf, response.end)
    lost = response.contact_lost()
    return OscillatorPassage(
        deflection=gravity * time**2 * w,
        velocity=np.where(arrived, -endless, gravity * time * v),
        body_deflection=gravity * time**2 * (w + response.state(2, own)),
        body_velocity=gravity * time * response.state(1, own),
        contact_force=np.where(arrived, endless, total * gravity * force),
        contact_lost_at=None if lost is None else lost * time,
    )


def _moving_load(contact: float, stiffness: float, damping: float, line: float) -> _delay.DelayBody:
    """Velocities of contact and body and compression of the spring, with weight, total mass and gravity 1."""
    spring = np.array([-damping, damping, stiffness])
    return _delay.DelayBody(
        inertia=np.array([contact, 1.0 - contact, 1.0]),
        matrix=np.array([spring, -spring, [-1.0, 1.0, 0.0]]),
        drive=np.array([1.0, 0.0, 0.0]),
        line=line,
    )


def _check_oscillator(
    sprung_mass: float, contact_mass: float, stiffness: float, damping: float, gravity: float
) -> None:
    _arguments.positive(sprung_mass=sprung_mass, gravity=gravity)
    _arguments.not_negative(contact_mass=contact_mass, stiffness=stiffness, damping=damping)
