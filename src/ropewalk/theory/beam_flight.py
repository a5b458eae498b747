"""Vehicles that can leave the beam: wheels that only push, fly while the gap is open, and land without bouncing.

The linear theory of `beam_crossing` with the one-sided contact ``gap >= 0, N >= 0, gap N = 0`` in place of the
bilateral one; ground beside the beam is level and can be left as well. A wheel leaves where its contact force passes
zero, and lands where the gap, line less wheel, does; both times are roots of the polynomials of the step, which is cut
there.

A wheel with mass that lands, or meets the ramp of a deflected beam at its ends, does so by a rigid, plastic impact:
contact impulses p that end the approach, with the momentum of the retained modes and of all wheels in contact balanced,

    A p = closing speeds,    A_ij = sum of phi_n(x_i) phi_n(x_j) over the modes, + 1/m_i on the diagonal,

p >= 0; the energy lost is half of p times the closing speeds (on a slope, what drives the load along gives or takes
p V w_x besides). Springs feel no impact. As the modes phi are of unit mass, A grows with their number: the part of the
beam that is hit becomes ever smaller, impulse and loss on the beam tend to zero, and the forces after the landing do
the work instead. The number of modes is therefore a part of the model. A wheel without mass has no impact; in flight
its springs and dampers set it back without a force. Derived here.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from ropewalk.theory import _arguments
from ropewalk.theory.beam_modes import Beam, Ends, Modes
from ropewalk.theory.beam_response import GAUSS, STAGES
from ropewalk.theory.beam_step import BeamUnderWheels, Track
from ropewalk.theory.beam_vehicle import Vehicle

__all__ = ["Flight", "flying_vehicle"]

FloatArray = NDArray[np.float64]
Mask = NDArray[np.bool_]

MODES = 20
TOLERANCE = 1e-4
MOST_STEPS = 50_000
MOST_EVENTS = 20_000
SAMPLES = np.linspace(0.0, 1.0, 9)  # of a step, where contact forces are looked at
NOTHING = 1e-9  # of static loads and deflections so far, that counts as rounding
AT_ONCE = 1e-9  # part of a step that counts as no time


@dataclass(frozen=True)
class Flight:
    """What happened at the instants ``t`` (instant,): arrays of (instant, wheel) or (instant, body coordinate)."""

    t: FloatArray  # s
    place: FloatArray  # of the wheels along the beam, m
    deflection: FloatArray  # of the beam under the wheels, m; 0 off the beam
    wheel: FloatArray  # displacement of the wheels themselves, downwards, m; less than the deflection in the air
    wheel_velocity: FloatArray  # m/s
    in_air: Mask
    time_in_air: FloatArray  # s, so far
    contact_force: FloatArray  # N, never negative
    body: FloatArray  # displacement from rest, m (rad for a pitch)
    body_velocity: FloatArray  # m/s
    body_acceleration: FloatArray  # m/s^2
    impact_loss: FloatArray  # (instant,) J, lost in impacts so far
    left_at: tuple[float, ...]  # s, when a wheel left the line
    landed_at: tuple[float, ...]  # s
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


def flying_vehicle(
    t: ArrayLike,
    *,
    vehicle: Vehicle,
    speed: float,
    start: float = 0.0,
    ends: Ends = "simply_supported",
    modes: int = MODES,
    tolerance: float = TOLERANCE,
    **beam: float,
) -> Flight:
    """Let a vehicle cross the beam on wheels that can leave it; law of contact at the head of this module.

    Arguments as in `beam_crossing.moving_vehicle`, but the number of ``modes`` is given and kept. Masses must not
    couple wheels with each other or with bodies. Steps are halved until deflections under the wheels, modal coordinates
    and bodies change by less than ``tolerance`` times their maximum. `ValueError` as there.
    """
    given = Beam(ends=ends, **beam)
    _arguments.not_negative(speed=speed)
    _arguments.finite(t=t, start=start)
    _arguments.positive(tolerance=tolerance)
    masses = vehicle.mass.copy()
    masses[: vehicle.bodies, : vehicle.bodies] = 0.0
    if np.any(masses != np.diag(np.diag(masses))):
        raise ValueError("mass must not couple wheels with bodies or other wheels: count all of them from the ground")
    instants = np.atleast_1d(np.asarray(t, dtype=np.float64)).ravel()
    series = given.modes(modes)
    track = Track(given, series, speed, vehicle.axles, start)
    highest = series.frequency[-1] if vehicle.heavy_wheels else 0.0
    rate = np.max([4.0 * series.frequency[0], *(4.0 * vehicle.natural_frequencies()), 0.1 * highest])
    steps = 40 + int(min(float(np.max(instants, initial=0.0)) * rate / (2.0 * np.pi), MOST_STEPS))
    last: _Passage | None = None
    while steps <= MOST_STEPS:
        run = _Passage(track, vehicle, steps, instants)
        run.go()
        if last is not None:
            pairs = ((last.seen, run.seen), (last.coordinates, run.coordinates), (last.body, run.body))
            change = max(_change(*pair) for pair in pairs)
            if change <= tolerance:
                return run.flight(change)
        last, steps = run, 2 * steps
    raise ValueError(f"tolerance {tolerance:g} is not reached with {MOST_STEPS} steps: allow more, or give fewer modes")


def _change(before: FloatArray, after: FloatArray) -> float:
    scale = max(float(np.max(np.abs(after), initial=0.0)), 1e-300)
    return float(np.max(np.abs(after - before), initial=0.0)) / scale


@dataclass(frozen=True)
class _Trial:
    """One step from a state with given contacts: unknowns at the stages, and what follows between them."""

    begin: float
    h: float
    on: Mask
    flies: Mask
    surface: BeamUnderWheels
    contact: FloatArray  # (stage, wheel) N, 0 in the air
    own: FloatArray  # (stage, wheel) acceleration of flying wheels with mass, rate of those without
    pull: FloatArray  # (stage, body) accelerations of the bodies
    pushed: FloatArray  # (mode, stage) modal forces


class _Passage:
    """One passage with given modes and steps."""

    def __init__(self, track: Track, vehicle: Vehicle, steps: int, instants: FloatArray) -> None:
        self.track, self.vehicle, self.steps, self.instants = track, vehicle, steps, instants
        count, wheels, size, bodies = len(instants), len(vehicle.axles), len(track.series.frequency), vehicle.bodies
        self.matrices = vehicle.stiffness, vehicle.damping, vehicle.mass
        self.wheel_mass = np.diag(vehicle.mass)[bodies:]
        self.heavy = self.wheel_mass > 0.0
        own = np.diag(vehicle.stiffness)[bodies:] + np.diag(vehicle.damping)[bodies:]
        self.can_fly = self.heavy | (own > 0.0)
        self.q, self.v, self.z, self.z_rate = np.zeros(size), np.zeros(size), np.zeros(bodies), np.zeros(bodies)
        self.u, self.u_rate = np.zeros(wheels), np.zeros(wheels)  # of flying wheels
        self.flies = np.zeros(wheels, dtype=bool)
        self.gripped = np.zeros(wheels, dtype=bool)  # grazing: not to be let go before the next step is done
        self.left, self.landed, self.lost = [np.zeros(0)] * wheels, [np.zeros(0)] * wheels, 0.0
        self.deepest = 0.0
        self.coordinates, self.rates = np.zeros((count, size)), np.zeros((count, size))
        self.body, self.body_rate, self.body_acceleration = np.zeros((3, count, bodies))
        self.contact = np.tile(vehicle.static_load, (count, 1))
        self.seen, self.wheel, self.wheel_rate = np.zeros((3, count, wheels))
        self.in_air, self.loss = np.zeros((count, wheels), dtype=bool), np.zeros(count)

    def go(self) -> None:
        end = float(np.max(self.instants, initial=0.0))
        if self.track.speed == 0.0 or end <= 0.0:
            return
        enters, leaves = self.track.enters, self.track.leaves
        events = np.unique(np.concatenate([[0.0], enters, leaves, [end]]))
        events = events[(events >= 0.0) & (events <= end)]
        for begin, stop in zip(events[:-1], events[1:], strict=True):  # noqa: RUF007, itertools stays out
            middle = 0.5 * (begin + stop)
            on = (enters <= middle) & (middle <= leaves)
            if begin > 0.0:
                self._ramp(float(begin), enters == begin)
            self._interval(float(begin), float(stop), on, end)
            self._ramp(float(stop), leaves == stop)

    def flight(self, change: float) -> Flight:
        air = [
            sum(np.clip(self.instants - a, 0.0, b - a) for a, b in zip(left, [*landed, np.inf], strict=False))
            for left, landed in zip(self.left, self.landed, strict=True)
        ]
        time_in_air = np.stack([a + np.zeros(len(self.instants)) for a in air], axis=1)
        return Flight(
            self.instants, self.track.place(self.instants), self.seen, self.wheel, self.wheel_rate, self.in_air,
            time_in_air, self.contact, self.body, self.body_rate, self.body_acceleration, self.loss,
            tuple(sorted(np.concatenate(self.left).tolist())), tuple(sorted(np.concatenate(self.landed).tolist())),
            self.steps, change, self.coordinates, self.rates, self.track.series,
        )  # fmt: skip

    def _interval(self, begin: float, stop: float, on: Mask, end: float) -> None:
        """March between entries and exits in equal steps, each cut where a wheel leaves or lands."""
        count = max(2, int(np.ceil(self.steps * (stop - begin) / end)))
        h, exact = (stop - begin) / count, not self.vehicle.heavy_wheels
        whole = BeamUnderWheels(self.track, h, exact=exact)
        together = max(1, 400_000 // (STAGES**2 * len(on) * len(self.q)))
        for first in range(0, count, together):
            starts: FloatArray = np.asarray(
                begin + h * np.arange(first, min(first + together, count), dtype=np.float64)
            )
            maps = whole.prepare(starts, on)
            for index, t in enumerate(starts):
                left, now = h, float(t)
                trial = self._try(now, whole, [[m[index] for m in kind] for kind in maps], whole.shape[index], on)
                while True:
                    theta, wheel, lands = self._first_event(trial)
                    if AT_ONCE < theta < 1.0 - AT_ONCE:
                        part = BeamUnderWheels(self.track, theta * trial.h, exact=exact)
                        cut = part.prepare(np.array([now]), on)
                        trial = self._try(now, part, [[m[0] for m in kind] for kind in cut], part.shape[0], on)
                    if theta > AT_ONCE:
                        self._accept(trial)
                        now, left = now + trial.h, left - trial.h
                    if wheel < 0:
                        break
                    self._switch(now, wheel, lands, on, at_once=theta <= AT_ONCE)
                    if left <= AT_ONCE * h:
                        break
                    rest = BeamUnderWheels(self.track, left, exact=exact)
                    maps_of_rest = rest.prepare(np.array([now]), on)
                    trial = self._try(now, rest, [[m[0] for m in kind] for kind in maps_of_rest], rest.shape[0], on)

    def _try(
        self, begin: float, surface: BeamUnderWheels, maps: list[list[FloatArray]], shape: FloatArray, on: Mask
    ) -> _Trial:
        """Solve the equations of bodies and wheels at the stages of a step."""
        h, bodies, wheels, flies = surface.h, self.vehicle.bodies, len(on), self.flies
        size = bodies + wheels
        once, twice, c = h * GAUSS.once, h**2 * GAUSS.twice, h * GAUSS.c
        # Coordinates, rates and accelerations at the stages: by the unknowns (wheels first), and from the state.
        by = np.zeros((3, STAGES, size, STAGES, size))
        known = np.zeros((3, STAGES, size))
        own = (twice, once, np.eye(STAGES))
        state = np.stack([self.q, self.v])
        for d in range(3):
            for b in range(bodies):
                by[d, :, b, :, wheels + b] = own[d]
            for w in range(wheels):
                if not flies[w]:
                    by[d, :, bodies + w, :, :wheels] = maps[0][d][:, w] * ~flies
                    known[d, :, bodies + w] = np.einsum("isn,sn->i", maps[1][d][:, w], state)
                elif self.heavy[w]:
                    by[d, :, bodies + w, :, w] = own[d]
                elif d < 2:
                    by[d, :, bodies + w, :, w] = own[d + 1]
        known[0, :, :bodies], known[1, :, :bodies] = self.z + np.outer(c, self.z_rate), self.z_rate
        for w in np.flatnonzero(flies).tolist():
            rate = self.u_rate[w] if self.heavy[w] else 0.0
            known[0, :, bodies + w], known[1, :, bodies + w] = self.u[w] + c * rate, rate
        system = np.einsum("drc,dicjk->irjk", np.stack(self.matrices), by)
        given = -np.einsum("drc,dic->ir", np.stack(self.matrices), known)
        given[:, bodies:] += self.vehicle.static_load
        for i in range(STAGES):
            for w in np.flatnonzero(~flies).tolist():
                system[i, bodies + w, i, w] += 1.0
        unknown = np.linalg.solve(system.reshape(STAGES * size, -1), given.ravel()).reshape(STAGES, size)
        contact = np.where(flies, 0.0, unknown[:, :wheels])
        return _Trial(
            begin, h, on, flies.copy(), surface, contact, np.where(flies, unknown[:, :wheels], 0.0),
            unknown[:, wheels:], np.einsum("jwn,jw->nj", shape, contact),
        )  # fmt: skip

    def _modes_at(self, trial: _Trial, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Coordinates and rates of the modes (instant, mode)."""
        q_q, q_v, v_q, v_v, q_f, v_f = trial.surface.modes.response(trial.h * theta)
        q = q_q * self.q + q_v * self.v + np.einsum("tnj,nj->tn", q_f, trial.pushed)
        return q, v_q * self.q + v_v * self.v + np.einsum("tnj,nj->tn", v_f, trial.pushed)

    def _line_at(self, t: FloatArray, on: Mask, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Deflection of the line under the wheels and its rate (instant, wheel)."""
        place = self.track.place(t)
        shape, slope = (self.track.shapes(place, on, d) for d in range(2))
        rate = np.einsum("twn,tn->tw", shape, v) + self.track.speed * np.einsum("twn,tn->tw", slope, q)
        return np.einsum("twn,tn->tw", shape, q), rate

    def _own_at(self, trial: _Trial, theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Displacement and rate of flying wheels (instant, wheel)."""
        value, first, second = GAUSS.integrals(theta)
        h, after = trial.h, trial.h * theta[:, np.newaxis]
        moved = np.where(self.heavy, after * self.u_rate + h**2 * second @ trial.own, h * first @ trial.own)
        return self.u + moved, np.where(self.heavy, self.u_rate + h * first @ trial.own, value @ trial.own)

    def _gaps(self, trial: _Trial, theta: FloatArray) -> FloatArray:
        line, _ = self._line_at(trial.begin + trial.h * theta, trial.on, *self._modes_at(trial, theta))
        return line - self._own_at(trial, theta)[0]

    def _first_event(self, trial: _Trial) -> tuple[float, int, bool]:
        """Part of the step after which a wheel leaves or lands, which one, and whether it lands; (1, -1, ...): none."""
        found = (1.0, -1, False)
        least = -NOTHING * float(np.max(np.abs(self.vehicle.static_load)))
        forces = GAUSS.integrals(SAMPLES)[0] @ trial.contact
        for w in np.flatnonzero(~trial.flies & self.can_fly & ~self.gripped & np.any(forces < least, axis=0)).tolist():
            cubic = GAUSS.powers @ trial.contact[:, w]

            def force(theta: float, cubic: FloatArray = cubic) -> float:
                return float(np.polynomial.polynomial.polyval(theta, cubic))

            at = int(np.argmax(forces[:, w] < least))
            before = float(SAMPLES[max(at - 1, 0)])
            root = brentq(force, before, float(SAMPLES[at])) if force(before) > 0.0 else before
            if root < found[0]:
                found = (root, w, False)
        if np.any(trial.flies):
            theta = np.concatenate([GAUSS.c, [1.0]])
            gaps = self._gaps(trial, theta)
            for w in np.flatnonzero(np.any(gaps < -NOTHING * self.deepest, axis=0) & trial.flies).tolist():

                def gap(theta: float, w: int = w) -> float:
                    return float(self._gaps(trial, np.array([theta]))[0, w])

                at = int(np.argmax(gaps[:, w] < -NOTHING * self.deepest))
                before = float(theta[at - 1]) if at > 0 else AT_ONCE
                root = brentq(gap, before, float(theta[at])) if gap(before) > 0.0 else before
                if root < found[0]:
                    found = (root, w, True)
        return found

    def _accept(self, trial: _Trial) -> None:
        """Write the results at the instants inside the step, and go to its end."""
        stop = trial.begin + trial.h
        inside = np.flatnonzero((self.instants > trial.begin) & (self.instants <= stop * (1.0 + 1e-14)))
        theta = np.append(np.minimum((self.instants[inside] - trial.begin) / trial.h, 1.0), 1.0)
        q, v = self._modes_at(trial, theta)
        line, rate = self._line_at(trial.begin + trial.h * theta, trial.on, q, v)
        own, own_rate = self._own_at(trial, theta)
        u, u_rate = np.where(trial.flies, own, line), np.where(trial.flies, own_rate, rate)
        value, first, second = GAUSS.integrals(theta)
        z = self.z + trial.h * theta[:, np.newaxis] * self.z_rate + trial.h**2 * second @ trial.pull
        z_rate = self.z_rate + trial.h * first @ trial.pull
        self.coordinates[inside], self.rates[inside] = q[:-1], v[:-1]
        self.seen[inside], self.wheel[inside], self.wheel_rate[inside] = line[:-1], u[:-1], u_rate[:-1]
        self.contact[inside], self.in_air[inside] = (value @ trial.contact)[:-1], trial.flies
        self.body[inside], self.body_rate[inside] = z[:-1], z_rate[:-1]
        self.body_acceleration[inside], self.loss[inside] = (value @ trial.pull)[:-1], self.lost
        self.q, self.v, self.z, self.z_rate = q[-1], v[-1], z[-1], z_rate[-1]
        self.u, self.u_rate = u[-1], u_rate[-1]
        self.deepest = max(self.deepest, float(np.max(np.abs(line))))
        self.gripped[:] = False

    def _switch(self, t: float, wheel: int, lands: bool, on: Mask, *, at_once: bool) -> None:
        if lands:
            self._land(t, wheel, on)
            # Let go and landed in one instant: it grazes, and the force of the next step decides nothing.
            self.gripped[wheel] = at_once
        else:
            self._let_go(t, wheel)

    def _let_go(self, t: float, wheel: int) -> None:
        self.flies[wheel] = True
        self.left[wheel] = np.append(self.left[wheel], t)
        if sum(map(len, self.left)) > MOST_EVENTS:
            raise ValueError(f"a wheel left the line more than {MOST_EVENTS} times: give fewer modes, or more damping")

    def _land(self, t: float, wheel: int, on: Mask) -> None:
        """A wheel comes down; the momenta of modes and heavy wheels in contact are balanced."""
        self.landed[wheel] = np.append(self.landed[wheel], t)
        self.flies[wheel] = False
        if not self.heavy[wheel]:
            return
        now = np.array([t])
        shape = self.track.shapes(self.track.place(now), on, 0)[0]
        _, rate = self._line_at(now, on, self.q[np.newaxis], self.v[np.newaxis])
        closing = np.where(np.arange(len(on)) == wheel, self.u_rate - rate[0], 0.0)
        active = np.flatnonzero(self.heavy & ~self.flies)
        while True:
            mobility = shape[active] @ shape[active].T + np.diag(1.0 / self.wheel_mass[active])
            impulse = np.linalg.solve(mobility, closing[active])
            if np.all(impulse >= 0.0) or closing[wheel] <= 0.0:
                break
            away = active[np.argmin(impulse)]
            self._let_go(t, int(away))
            active = active[active != away]
        if closing[wheel] > 0.0:
            self.lost += 0.5 * float(impulse @ closing[active])
            self.v = self.v + impulse @ shape[active]
            _, after = self._line_at(now, on, self.q[np.newaxis], self.v[np.newaxis])
            self.u_rate[active] = after[0, active]

    def _ramp(self, t: float, wheels: Mask) -> None:
        """Wheels in contact come to an end of the beam, where the line they follow has a bend."""
        series, speed = self.track.series, self.track.speed
        for w in np.flatnonzero(wheels & self.heavy & ~self.flies):
            entering = self.track.enters[w] == t
            x = 0.0 if entering else self.track.beam.length
            slope = speed * float(series.shape(np.asarray(x), 1) @ self.q)
            before, after = (0.0, slope) if entering else (slope, 0.0)
            if before >= after:  # the support takes the impulse
                self.lost += 0.5 * float(self.wheel_mass[w]) * (before - after) ** 2
                self.u[w], self.u_rate[w] = 0.0, after
            elif self.deepest > 0.0:
                self.u[w], self.u_rate[w] = 0.0, before
                self._let_go(t, int(w))
