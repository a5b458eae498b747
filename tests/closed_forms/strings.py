"""Strings without ends under a mass and an oscillator, and several moving forces by superposition."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments
from ropewalk.theory._wave import wave_speed
from ropewalk.theory.moving_mass import MassPassage
from ropewalk.theory.moving_oscillator import NO_MASS, OscillatorPassage, _check_oscillator, _moving_load
from ropewalk.theory.string import moving_force

FloatArray = NDArray[np.float64]


def moving_mass_infinite(
    t: ArrayLike, *, load_mass: float, tension: float, mass: float, gravity: float = 9.81
) -> MassPassage:
    """Return the motion of a mass that is set on an infinite string at t = 0 and travels slower than the waves.

    ``t`` >= 0 in s; the rest and errors as in `moving_mass`. The speed does not matter below the wave speed:
    ``N = m g (1 - exp(-t/T0))``, ``T0 = m/(2 rho c)``, and the velocity across is ``N/(2 rho c)``. Derived in
    docs/notes/moving-mass-on-a-string.md.
    """
    _arguments.positive(load_mass=load_mass, gravity=gravity)
    resistance = 2.0 * mass * wave_speed(tension=tension, mass=mass)
    (t,) = _arguments.within(0.0, np.inf, t=t)
    _arguments.finite(t=t)
    settling = load_mass / resistance
    age = t / settling
    force = -load_mass * gravity * np.expm1(-age)
    # Few terms of the series where the closed form would lose digits.
    few = age**2 * np.polyval([-1 / 5040, 1 / 720, -1 / 120, 1 / 24, -1 / 6, 1 / 2], np.minimum(age, 1.0))
    path = np.where(age < 0.03, few, age + np.expm1(-age))
    return MassPassage(gravity * settling**2 * path, force / resistance, force, None)


def moving_oscillator_infinite(
    t: ArrayLike,
    *,
    sprung_mass: float,
    contact_mass: float = 0.0,
    stiffness: float,
    damping: float = 0.0,
    tension: float,
    mass: float,
    gravity: float = 9.81,
) -> OscillatorPassage:
    """Return the motion of an oscillator that is set on an infinite string at t = 0 and travels slower than the waves.

    ``t`` >= 0 in s; the rest as in `moving_oscillator`. The string resists with ``N = 2 rho c w'`` whatever the speed,
    so that the three unknowns w', y' and y - w obey a linear equation of third order with constant coefficients, here
    solved by its eigenvalues (exact to rounding). They settle at N = weight. ``contact_lost_at`` looks at the
    given times only. Derived here.
    """
    _check_oscillator(sprung_mass, contact_mass, stiffness, damping, gravity)
    resistance = 2.0 * mass * wave_speed(tension=tension, mass=mass)
    (t,) = _arguments.within(0.0, np.inf, t=t)
    _arguments.finite(t=t)
    total = sprung_mass + contact_mass
    contact_mass = contact_mass if contact_mass > NO_MASS * total else 0.0
    settling = total / resistance
    moving_load = _moving_load(contact_mass / total, stiffness * settling**2 / total, damping * settling / total, 1.0)
    # Unknowns w', y' and y - w less their final values 1, 1, 0; without contact mass w' follows from the other two.
    closed, first = moving_load.closed(), 0 if contact_mass > 0.0 else 1
    reduced = closed[first:] / moving_load.inertia[first:, np.newaxis]
    if first == 1:
        contact = -closed[0, 1:] / closed[0, 0]
        system = reduced[:, 1:] + np.outer(reduced[:, 0], contact)
    else:
        contact, system = np.eye(3)[0], reduced
    age = t / settling
    rest, rests = _decay(system, np.array([-1.0, -1.0, 0.0])[first:], age)
    v, w = 1.0 + rest @ contact, age + rests @ contact
    d, u = rest[..., -1], 1.0 + rest[..., -2]
    pulls = np.flatnonzero(np.ravel(v < -1e-12))
    return OscillatorPassage(
        deflection=gravity * settling**2 * w,
        velocity=gravity * settling * v,
        body_deflection=gravity * settling**2 * (w + d),
        body_velocity=gravity * settling * u,
        contact_force=total * gravity * v,
        contact_lost_at=float(np.min(np.ravel(t)[pulls])) if len(pulls) else None,
    )


def _decay(system: FloatArray, start: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Solution of ``z' = system z`` at times t, and its integral from 0; the last axis is that of z."""
    rates, modes = np.linalg.eig(system)
    if np.linalg.cond(modes) > 1e6:  # critical damping: no full set of modes, and the exponential takes its time
        from scipy.linalg import expm

        size = len(start)
        extended = np.block([[system, np.zeros((size, size))], [np.eye(size), np.zeros((size, size))]])
        both = expm(extended * t[..., np.newaxis, np.newaxis])[..., :size] @ start
        return both[..., :size], both[..., size:]
    parts = np.linalg.solve(modes, start)
    exponent = rates * t[..., np.newaxis]
    lasting = np.abs(rates) * np.max(t, initial=0.0) < 1e-12
    with np.errstate(invalid="ignore", divide="ignore"):
        sums = np.where(lasting, t[..., np.newaxis], np.expm1(exponent) / np.where(lasting, 1.0, rates))
    return np.real((np.exp(exponent) * parts) @ modes.T), np.real((sums * parts) @ modes.T)


def moving_forces(
    x: ArrayLike,
    t: ArrayLike,
    *,
    forces: ArrayLike,
    speeds: ArrayLike,
    entries: ArrayLike,
    length: float,
    tension: float,
    mass: float,
) -> FloatArray:
    """Return the deflection under several moving forces by superposition, in m.

    ``forces`` (N), ``speeds`` (m/s) and ``entries`` (s, when each reaches x = 0) broadcast to one value for each load.
    The rest, errors included, is as in `moving_force`. Axles in fixed distances d enter at d/V after one another.
    """
    x, t = np.asarray(x, dtype=np.float64), np.asarray(t, dtype=np.float64)
    total = np.zeros(np.broadcast_shapes(x.shape, t.shape))
    for force, speed, entry in np.broadcast(np.atleast_1d(forces), speeds, entries):
        total += moving_force(
            x, t - entry, force=float(force), speed=float(speed), length=length, tension=tension, mass=mass
        )
    return total
