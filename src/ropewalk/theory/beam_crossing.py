"""Loads with inertia on a beam: mass, oscillator and vehicle, coupled with the beam in both directions.

The modes of the beam answer to the contact forces, the wheels follow the beam: with ``u(t) = w(V t - d, t)`` the
acceleration of a wheel has the convective terms ``w_tt + 2 V w_xt + V^2 w_xx`` (Fryba, Vibration of Solids and
Structures under Moving Loads, for mass and oscillator). Beside the beam the wheels run on level ground. A wheel that
enters or leaves takes the jump of the slope as an impact; the impact acts on the support.

In time: collocation at four Gauss points for contact forces and bodies. Under wheels without mass every mode is
solved exactly for the polynomials that the forces are then; under wheels with mass, where that would be unstable,
the modes are collocated, too (order 8, unconditionally stable). Modes do not see each other within a step, so that
each step ends in equations for contact forces and bodies alone. Contact is bilateral: where a contact force becomes
negative the load would have lifted off, and the solution is not valid from there on; `Crossing.contact_lost_at`
tells when. `beam_flight` lets the wheels go there.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments
from ropewalk.theory.beam_modes import Beam, Ends, Modes
from ropewalk.theory.beam_response import GAUSS, STAGES
from ropewalk.theory.beam_step import BeamUnderWheels, Track
from ropewalk.theory.beam_vehicle import Vehicle, oscillator, point_mass

__all__ = ["Crossing", "moving_mass", "moving_oscillator", "moving_vehicle"]

FloatArray = NDArray[np.float64]

TOLERANCE = 1e-5
MOST_MODES = 1000
MOST_STEPS = 200_000


@dataclass(frozen=True)
class Crossing:
    """What happened at the instants ``t`` (instant,): arrays of (instant, wheel) or (instant, body coordinate)."""

    t: FloatArray  # s
    place: FloatArray  # of the wheels, m; on the beam between 0 and its length
    deflection: FloatArray  # of the beam under the wheels, m; 0 off the beam
    velocity: FloatArray  # of the wheels, m/s, the rate of the deflection above
    contact_force: FloatArray  # N, positive in compression
    body: FloatArray  # displacement from rest, m (rad for a pitch)
    body_velocity: FloatArray  # m/s
    body_acceleration: FloatArray  # m/s^2
    contact_lost_at: float | None  # s; first negative contact force on the beam, from which on nothing is valid
    modes: int
    steps: int
    change: float  # in the last refinement, relative to the maximum: of what `tolerance` bounds
    _coordinates: FloatArray
    _rates: FloatArray
    _series: Modes

    def beam_deflection(self, x: ArrayLike, derivative: int = 0) -> FloatArray:
        """Return the deflection of the beam (or its derivative) at ``x`` (m), shape (instant, *x.shape), in m."""
        shape = self._series.shape(np.asarray(x, dtype=np.float64), derivative)
        return np.tensordot(self._coordinates, shape, axes=(-1, -1))

    def beam_velocity(self, x: ArrayLike) -> FloatArray:
        """Return the velocity of the beam's points at ``x`` (m), shape (instant, *x.shape), in m/s."""
        shape = self._series.shape(np.asarray(x, dtype=np.float64))
        return np.tensordot(self._rates, shape, axes=(-1, -1))


def moving_mass(
    t: ArrayLike,
    *,
    load_mass: float,
    speed: float,
    gravity: float = 9.81,
    ends: Ends = "simply_supported",
    modes: int | None = None,
    tolerance: float = TOLERANCE,
    **beam: float,
) -> Crossing:
    """Let a mass cross the beam in rigid contact; it enters at t = 0.

    ``load_mass`` in kg, not negative; other arguments, errors and method as in `moving_vehicle`.
    """
    vehicle = point_mass(load_mass, gravity=gravity)
    return moving_vehicle(t, vehicle=vehicle, speed=speed, ends=ends, modes=modes, tolerance=tolerance, **beam)


def moving_oscillator(
    t: ArrayLike,
    *,
    load_mass: float,
    load_stiffness: float,
    speed: float,
    load_damping: float = 0.0,
    wheel_mass: float = 0.0,
    gravity: float = 9.81,
    ends: Ends = "simply_supported",
    modes: int | None = None,
    tolerance: float = TOLERANCE,
    **beam: float,
) -> Crossing:
    """Let a sprung mass cross the beam, with or without an unsprung wheel; it enters at t = 0, at rest vertically.

    Load as in `beam_vehicle.oscillator`; other arguments, errors and method as in `moving_vehicle`.
    """
    vehicle = oscillator(
        load_mass, load_stiffness=load_stiffness, load_damping=load_damping, wheel_mass=wheel_mass, gravity=gravity
    )
    return moving_vehicle(t, vehicle=vehicle, speed=speed, ends=ends, modes=modes, tolerance=tolerance, **beam)


def moving_vehicle(
    t: ArrayLike,
    *,
    vehicle: Vehicle,
    speed: float,
    start: float = 0.0,
    ends: Ends = "simply_supported",
    modes: int | None = None,
    tolerance: float = TOLERANCE,
    **beam: float,
) -> Crossing:
    """Let a vehicle cross the beam; its front enters at t = 0, the vehicle being at rest vertically.

    ``t`` (s) is a scalar or list of instants, ``speed`` >= 0 in m/s, the beam as in `Beam`. At t = 0 the front stands
    at ``start`` (m): if that is positive, wheels stand on the beam then, and their weight begins to act at once on a
    beam that is still straight. Steps are halved, and modes doubled unless their number (up to 1000) is given, until
    deflections under the wheels, modal coordinates and bodies change by less than ``tolerance`` times their maximum at
    the given instants; contact forces and accelerations converge later. `ValueError` for arguments out of range, for a
    beam that buckles and where the tolerance is not reached.
    """
    given = Beam(ends=ends, **beam)
    _arguments.not_negative(speed=speed)
    _arguments.finite(t=t, start=start)
    _arguments.positive(tolerance=tolerance)
    instants = np.atleast_1d(np.asarray(t, dtype=np.float64)).ravel()
    count = 10 if modes is None else modes
    if not 1 <= count <= MOST_MODES:
        raise ValueError(f"modes must lie between 1 and {MOST_MODES}, not {count}")
    passage = max(given.length + float(np.max(vehicle.axles)) - start, 0.0) / speed if speed > 0.0 else 0.0
    # A first size that is not blind: some steps in a period of the bodies, and of the modes if they are collocated.
    highest = given.modes(count).frequency[-1] if vehicle.heavy_wheels else 0.0
    rate = np.max([4.0 * given.modes(1).frequency[0], *(4.0 * vehicle.natural_frequencies()), 0.1 * highest])
    steps = 20 + int(min(passage * rate / (2.0 * np.pi), MOST_STEPS))
    last: _March | None = None
    while steps <= MOST_STEPS and count <= MOST_MODES:
        march = _March(Track(given, given.modes(count), speed, vehicle.axles, start), vehicle, steps, instants)
        march.run()
        if last is not None:
            shared = slice(0, len(last.series.frequency))
            change = max(
                _change(last.seen, march.seen),
                _change(last.coordinates, march.coordinates[:, shared]),
                _change(last.body, march.body),
            )
            if change <= tolerance:
                return march.crossing(change)
        last, steps, count = march, 2 * steps, count if modes is not None else 2 * count
    raise ValueError(
        f"tolerance {tolerance:g} is not reached with {count} modes and {MOST_STEPS} steps: allow more, "
        "give fewer modes, or take the static deflection of a load as slow as this"
    )


def _change(before: FloatArray, after: FloatArray) -> float:
    """Largest difference by the largest value."""
    scale = max(float(np.max(np.abs(after), initial=0.0)), 1e-300)
    return float(np.max(np.abs(after - before), initial=0.0)) / scale


class _March:
    """One passage with given modes and steps; results are written at the instants that fall into each step."""

    def __init__(self, track: Track, vehicle: Vehicle, steps: int, instants: FloatArray) -> None:
        self.track, self.vehicle, self.steps, self.instants = track, vehicle, steps, instants
        self.series, self.speed = track.series, track.speed
        series = track.series
        count, wheels, bodies = len(instants), len(vehicle.axles), vehicle.bodies
        self.coordinates, self.rates = (
            np.zeros((count, len(series.frequency))),
            np.zeros((count, len(series.frequency))),
        )
        self.contact = np.tile(vehicle.static_load, (count, 1))
        self.body, self.body_rate, self.body_acceleration = np.zeros((3, count, bodies))
        self.q, self.v = np.zeros((2, len(series.frequency)))
        self.z, self.z_rate = np.zeros((2, bodies))
        self.lost_at: float | None = None
        self.place = track.place(instants)
        self.on = (self.place >= 0.0) & (self.place <= track.beam.length) & (instants[:, np.newaxis] > 0.0)
        self.seen = np.zeros((count, wheels))

    def run(self) -> None:
        if self.speed > 0.0:
            enters, leaves = self.track.enters, self.track.leaves
            end = float(np.max(self.instants, initial=0.0))
            events = np.unique(np.concatenate([[0.0], enters, leaves, [end]]))
            events = events[(events >= 0.0) & (events <= end)]
            for start, stop in zip(events[:-1], events[1:], strict=True):  # noqa: RUF007, itertools stays out
                middle = 0.5 * (start + stop)
                on = (enters <= middle) & (middle <= leaves)
                self._impact(enters == start, 0.0)
                self._interval(float(start), float(stop), on, max(float(np.max(leaves)), 1e-300))
                self._impact(leaves == stop, self.track.beam.length)
        shape = self.track.shapes(self.place, self.on, 0)
        self.seen = np.einsum("twn,tn->tw", shape, self.coordinates)

    def crossing(self, change: float) -> Crossing:
        slope = self.track.shapes(self.place, self.on, 1)
        velocity = np.einsum("twn,tn->tw", self.track.shapes(self.place, self.on, 0), self.rates)
        velocity += self.speed * np.einsum("twn,tn->tw", slope, self.coordinates)
        return Crossing(
            self.instants,
            self.place,
            self.seen,
            velocity,
            self.contact,
            self.body,
            self.body_rate,
            self.body_acceleration,
            self.lost_at,
            len(self.series.frequency),
            self.steps,
            change,
            self.coordinates,
            self.rates,
            self.series,
        )

    def _impact(self, wheels: NDArray[np.bool_], end: float) -> None:
        """A wheel takes or loses the speed of the slope; bodies with inertial coupling to it feel the jump."""
        bodies = self.vehicle.bodies
        if bodies and np.any(wheels):
            slope = self.speed * float(self.series.shape(np.asarray(end), 1) @ self.q)
            jump = np.where(wheels, slope if end == 0.0 else -slope, 0.0)
            mass = self.vehicle.mass[:bodies]
            self.z_rate = self.z_rate - np.linalg.solve(mass[:, :bodies], mass[:, bodies:] @ jump)

    def _interval(self, start: float, stop: float, on: NDArray[np.bool_], passage: float) -> None:
        """March from one event to the next in equal steps, some at a time."""
        count = max(2, int(np.ceil(self.steps * (stop - start) / passage)))
        h = (stop - start) / count
        step = _CrossingStep(self, h)
        together = max(1, 400_000 // (STAGES**2 * len(on) * len(self.series.frequency)))
        inside = np.flatnonzero((self.instants > start) & (self.instants <= stop))
        of_step = np.clip(np.ceil((self.instants[inside] - start) / h) - 1, 0, count - 1)
        order = np.argsort(of_step)
        inside, bounds = inside[order], np.searchsorted(of_step[order], np.arange(count + 1))
        for first in range(0, count, together):
            numbers = np.arange(first, min(first + together, count))
            step.prepare(np.asarray(start + h * numbers, dtype=np.float64), on)
            for index, number in enumerate(numbers):
                step.take(index, start + h * number, on, inside[bounds[number] : bounds[number + 1]])


class _CrossingStep:
    """Collocation over steps of one size: what each mode does alone, and the equations that couple them.

    Unknown at the stages are the contact forces and the accelerations of the bodies; ``a = K (f + r)`` are those of
    the modes, r from the state at the beginning.
    """

    def __init__(self, march: _March, h: float) -> None:
        self.march, self.h = march, h
        self.once, self.twice, self.c = h * GAUSS.once, h**2 * GAUSS.twice, h * GAUSS.c
        self.surface = BeamUnderWheels(march.track, h, exact=not march.vehicle.heavy_wheels)
        self.threshold = -1e-12 * float(np.max(np.abs(march.vehicle.static_load)))

    def prepare(self, begins: FloatArray, on: NDArray[np.bool_]) -> None:
        """Set up the coupled equations of several steps at once."""
        wheel_force, wheel_state = self.surface.prepare(begins, on)
        self.shape = self.surface.shape
        self._couple(wheel_force, wheel_state)

    def _couple(self, wheel_force: list[FloatArray], wheel_state: list[FloatArray]) -> None:
        """Rows (stage, coordinate): the equations of bodies and wheels; columns: forces, accelerations of bodies."""
        vehicle, bodies = self.march.vehicle, self.march.vehicle.bodies
        matrices, size = (vehicle.stiffness, vehicle.damping, vehicle.mass), len(vehicle.mass)
        steps, wheels = len(self.shape), size - bodies
        rows = STAGES * size
        on_force = sum(
            np.einsum("rw,piwjx->pirjx", m[:, bodies:], u) for m, u in zip(matrices, wheel_force, strict=True)
        )
        for wheel in range(wheels):
            for stage in range(STAGES):
                on_force[:, stage, bodies + wheel, stage, wheel] += 1.0
        on_body = sum(
            np.einsum("rb,ij->irjb", m[:, :bodies], a)
            for m, a in zip(matrices, (self.twice, self.once, np.eye(STAGES)), strict=True)
        )
        on_body = np.broadcast_to(on_body.reshape(1, rows, STAGES * bodies), (steps, rows, STAGES * bodies))
        solve = np.linalg.inv(np.concatenate([on_force.reshape(steps, rows, STAGES * wheels), on_body], axis=2))
        on_state = sum(
            np.einsum("rw,piwsn->pirsn", m[:, bodies:], g) for m, g in zip(matrices, wheel_state, strict=True)
        )
        k, c = vehicle.stiffness[:, :bodies], vehicle.damping[:, :bodies]
        on_z = np.broadcast_to(k, (STAGES, size, bodies))
        on_rate = c + self.c[:, np.newaxis, np.newaxis] * k
        on_bodies = np.concatenate([on_z, on_rate], axis=2).reshape(1, rows, 2 * bodies)
        on_bodies = np.broadcast_to(on_bodies, (steps, rows, 2 * bodies))
        weight = np.tile(np.concatenate([np.zeros(bodies), vehicle.static_load]), STAGES)
        self.rest = solve @ weight
        self.gain = solve @ np.concatenate([on_state.reshape(steps, rows, -1), on_bodies], axis=2)
        ends = [a[0].T[:, np.newaxis] * self.shape for a in self.surface.end[4:]]  # p j w n
        self.push = np.concatenate(ends, axis=3).reshape(steps, STAGES * wheels, -1)

    def take(self, index: int, begin: float, on: NDArray[np.bool_], inside: NDArray[np.intp]) -> None:
        """Take one step of those prepared, and write the results at the instants inside it."""
        march, h, wheels = self.march, self.h, len(on)
        q, v, z, z_rate = march.q, march.v, march.z, march.z_rate
        state = np.concatenate([q, v, z, z_rate])
        unknown = self.rest[index] - self.gain[index] @ state
        forces, pull = unknown[: STAGES * wheels], unknown[STAGES * wheels :].reshape(STAGES, -1)
        contact = forces.reshape(STAGES, wheels)
        if march.lost_at is None and np.min(contact[:, on], initial=0.0) < self.threshold:
            march.lost_at = begin + float(self.c[np.argmax(np.any(contact[:, on] < 0.0, axis=1))])
        if len(inside):
            theta = (march.instants[inside] - begin) / h
            value, first, second = GAUSS.integrals(theta)
            after = h * theta[:, np.newaxis]
            from_q, from_v, rate_from_q, rate_from_v, by_force, rate_by_force = self.surface.modes.response(h * theta)
            pushed = np.einsum("jwn,jw->nj", self.shape[index], contact)
            march.coordinates[inside] = from_q * q + from_v * v + np.sum(by_force * pushed, axis=-1)
            march.rates[inside] = rate_from_q * q + rate_from_v * v + np.sum(rate_by_force * pushed, axis=-1)
            march.contact[inside] = value @ contact
            march.body[inside] = z + after * z_rate + h**2 * second @ pull
            march.body_rate[inside] = z_rate + h * first @ pull
            march.body_acceleration[inside] = value @ pull
        pushed = forces @ self.push[index]
        march.q = self.surface.end[0][0] * q + self.surface.end[1][0] * v + pushed[: len(q)]
        march.v = self.surface.end[2][0] * q + self.surface.end[3][0] * v + pushed[len(q) :]
        march.z, march.z_rate = z + h * z_rate + h**2 * GAUSS.b_twice @ pull, z_rate + h * GAUSS.b @ pull
