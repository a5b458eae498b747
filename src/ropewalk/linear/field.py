"""Forces on a line in the linear theory: deflections that add up."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.linear.chord import Chord
from ropewalk.linear.series import Series
from ropewalk.linear.steady import SteadyForces
from ropewalk.mechanics.chain import FRICTIONLESS, HORIZONTAL, LEAVE, MATERIAL, Array
from ropewalk.mechanics.moving_contact import force_at, look_up_integral, speed_at
from ropewalk.model.run import Linear
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import MOVES, Contacts
from ropewalk.solve.start import PreparedRun
from ropewalk.theory import beam, string
from ropewalk.theory.image_sum import travelling_force

# Steps for differences of exact deflections, as a part of the length or the time of a wave along it.
_DIFFERENCE = 1e-6
FEW = 3  # loads up to which each is answered by a closed form of its own
_ROUNDING = 1e-12  # of a force: what it has of another direction is none
_LONGER = 1.01  # than the run: what differences look at


class Field:
    """The deflection of one line under all its loads."""

    def __init__(self, setting: PreparedRun, scenario: Scenario, s: int, chord: Chord) -> None:
        assert isinstance(scenario.run, Linear)
        self.setting, self.s, self.chord, self.modes = setting, s, chord, scenario.run.modes
        self.until = scenario.run.until
        self.names = tuple(scenario.loads)
        self._found: dict[tuple[int, int], Series] = {}
        self.places: Array = np.linspace(0.0, chord.length, int(setting.strands.links[s]) + 1)
        self.scales = {int(k): self._scale(int(k)) for k in setting.on[s]}
        self._train = self._steady() if len(setting.on[s]) > FEW else None

    def _steady(self) -> SteadyForces | None:
        """All loads together, where each is a constant force across the line at a constant speed and modes answer."""
        loads, own = self.setting.loads, [int(k) for k in self.setting.on[self.s]]
        sizes = [[self._force(k, a) for a in range(len(self.chord.across))] for k in own]
        steady = all(loads.speed_count[k] == 1 for k in own) and all(isinstance(f, float) for row in sizes for f in row)
        steady = steady and all(abs(other) <= _ROUNDING * abs(row[0]) for row in sizes for other in row[1:])
        if not steady or (self.chord.is_string and self.modes is None):
            return None
        begin = np.array([self.place(k, np.zeros(1))[0] for k in own])
        speed = np.array([self.scales[k] * speed_at(loads, k, 0.0) for k in own])
        return SteadyForces(self.chord, begin, speed, np.array([row[0] for row in sizes]), self.modes)

    def _scale(self, k: int) -> float:
        """Distance along the chord for each metre of the path as measured."""
        measure = self.setting.loads.measure[k]
        if measure == MATERIAL:
            return self.chord.length / self.chord.material
        return 1.0 / abs(float(self.chord.along[0])) if measure == HORIZONTAL else 1.0

    def place(self, k: int, t: Array) -> Array:
        """Where load k is along the chord, m."""
        loads = self.setting.loads
        first, count = loads.speed_first[k], loads.speed_count[k]
        tables = loads.speed_time, loads.speed_value, loads.speed_path
        if count == 1:
            way = tables[2][first] + tables[1][first] * (t - tables[0][first])
        else:
            way = np.array([look_up_integral(*tables, first, count, time) for time in np.ravel(t)]).reshape(np.shape(t))
        return np.asarray(self._begin(k) + self.scales[k] * way)

    def _begin(self, k: int) -> float:
        """Where load k begins along the chord, m; a beam has hardly an arc above it, a string that of its rest."""
        start, measure = self.setting.wheels[k].start, self.setting.loads.measure[k]
        if measure == MATERIAL or (self.chord.is_string and start > 0.0 and measure != HORIZONTAL):
            begin = float(self.setting.xi[k]) * self.chord.length / self.chord.material
        else:
            begin = self.scales[k] * start
        # A start at the far end is rounded, above all where the length follows from a tension.
        return self.chord.length if abs(begin - self.chord.length) < 1e-9 * self.chord.length else begin

    def deflection(self, k: int, a: int, x: Array, t: Array) -> Array:
        """Deflection in m in the direction `across[a]` under load k alone; x and t broadcast."""
        loads, chord = self.setting.loads, self.chord
        begin, V = float(self.place(k, np.zeros(1))[0]), self.scales[k] * speed_at(loads, k, 0.0)
        size = self._force(k, a)
        steady = loads.speed_count[k] == 1 and not callable(size) and not isinstance(size, tuple)
        from_end = steady and ((V > 0.0 and begin == 0.0) or (V < 0.0 and begin == chord.length))
        x = x if V > 0.0 else chord.length - x
        if chord.is_string:
            line = {"length": chord.length, "tension": chord.tension, "mass": chord.mass}
            if from_end:
                return string.moving_force(x, t, force=float(size), speed=abs(V), modes=self.modes, **line)
            if self.modes is not None:
                return self._series(k, a, size).deflection(x if V > 0.0 else chord.length - x, t)
            return travelling_force(x if V > 0.0 else chord.length - x, t, path=self._way(k), force=size, **line)
        if not from_end or chord.retardation:
            return self._series(k, a, size).deflection(x if V > 0.0 else chord.length - x, t)
        return beam.moving_force(x, t, force=float(size), speed=abs(V), modes=self.modes, **chord.beam)

    def _series(self, k: int, a: int, size: Any) -> Series:
        """The sum of modes under load k, in one direction."""
        if (k, a) not in self._found:
            loads = self.setting.loads
            jumps = [
                time[first[k] : first[k] + count[k]]
                for time, first, count in (
                    (loads.speed_time, loads.speed_first, loads.speed_count),
                    (loads.force_time, loads.force_first, loads.force_count),
                )
            ]

            def force(t: Array) -> Array:
                return np.asarray(np.interp(t, *size) if isinstance(size, tuple) else np.full(t.shape, size))

            self._found[k, a] = Series(
                self.chord, lambda t: self.place(k, t), force, np.concatenate(jumps), self.until * _LONGER, self.modes
            )
        return self._found[k, a]

    def _way(self, k: int) -> Any:
        """Path of load k as times in s and places in m, if its speed is constant between jumps; else a function."""
        loads = self.setting.loads
        part = slice(loads.speed_first[k], loads.speed_first[k] + loads.speed_count[k])
        time, speed = loads.speed_time[part], loads.speed_value[part]
        if np.any((np.diff(time) > 0.0) & (np.diff(speed) != 0.0)):
            return lambda tau: self.place(k, tau)
        inside = time[(time > 0.0) & (time < self.until)]
        times = np.unique(np.concatenate([[0.0], inside, [self.until]]))
        return times, self.place(k, times)

    def _force(self, k: int, a: int) -> Any:
        """Component of the force of load k across the chord: a number, or a table (times, values)."""
        loads = self.setting.loads
        entries = slice(loads.force_first[k], loads.force_first[k] + loads.force_count[k])
        values = self.chord.across[a] @ loads.force_value[:, entries]
        if values.size == 1:
            return float(values[0])
        times = np.concatenate(
            [[-1.0], loads.force_time[entries], [max(self.until, loads.force_time[entries][-1]) + 1.0]]
        )
        # A jump, two values at one instant, is a steep rise for a table whose times must increase.
        times[1:] = np.maximum(times[1:], times[:-1] + 1e-9 * self.until)
        return times, np.concatenate([values[:1], values, values[-1:]])

    def motion(self, x: Array, times: Array) -> tuple[Array, Array]:
        """Deflections and velocities (time, place, axis) of the line at places x under all loads."""
        if self._train is not None:
            w, rate = self._train.motion(x, times)
            across = self.chord.across[0]
            return w[:, :, None] * across, rate[:, :, None] * across
        moved, speed = (np.zeros((times.size, x.size, self.chord.along.size)) for _ in range(2))
        step = _DIFFERENCE * self.chord.length / self._wave_speed()
        for k in self.setting.on[self.s]:
            for a, direction in enumerate(self.chord.across):
                w = self.deflection(int(k), a, x[None, :], times[:, None])
                ahead = self.deflection(int(k), a, x[None, :], times[:, None] + step)
                behind = self.deflection(int(k), a, x[None, :], np.maximum(times[:, None] - step, 0.0))
                rate = (ahead - behind) / (step + np.minimum(step, times[:, None]))
                moved += w[:, :, None] * direction
                speed += rate[:, :, None] * direction
        return moved, speed

    def _wave_speed(self) -> float:
        if self.chord.is_string:
            return string.wave_speed(tension=self.chord.tension, mass=self.chord.mass)
        return float(beam.natural_frequencies(1, **self.chord.beam)[0]) * self.chord.length / np.pi

    def point(self, x: Array) -> Array:
        """Places on the chord with its sag, (place, axis) m."""
        return self.chord.point(x, self.setting.strands.gravity)

    def contacts(self, times: Array, rows: slice) -> Contacts:
        """What frames tell of the loads on the line.

        Args:
            times: (instant,) s, all of those that `motion` was asked for.
            rows: those of them that are meant.
        """
        loads, chord, own = self.setting.loads, self.chord, self.setting.on[self.s]
        t, dim = times[rows], chord.along.size
        seen = Contacts(t.size, own.size, dim)
        x = np.array([self.place(int(k), t) for k in own]).reshape(own.size, t.size).T
        on = (x >= 0.0) & (x <= chord.length) | (loads.at_end[own] != LEAVE)
        x = np.clip(x, 0.0, chord.length)
        place, slope = (self._under_train if self._train is not None else self._under_each)(times, rows, x, on)
        i, j = np.nonzero(on)
        given, hold = np.zeros((2, t.size, own.size, dim))
        speed = np.zeros((t.size, own.size))
        for n, k in enumerate(own):
            one = t[:1] if loads.force_count[k] == 1 else t
            given[:, n] = [[force_at(loads, k, time, a) for a in range(dim)] for time in one]
            one = t[:1] if loads.speed_count[k] == 1 else t
            speed[:, n] = [speed_at(loads, k, time) for time in one]
        thrown = loads.contact[own] == FRICTIONLESS  # what the slope throws back, or pulls on
        hold[:, thrown] = (-(given @ chord.across[0]) * slope)[:, thrown, None] * chord.along
        seen.position[i, j], seen.hold[i, j], seen.force[i, j] = place[i, j], hold[i, j], (given + hold)[i, j]
        seen.xi[i, j], seen.speed[i, j] = (x * chord.material / chord.length)[i, j], speed[i, j]
        seen.tension[i, j], seen.state[i, j] = chord.tension, MOVES
        return seen

    def _under_train(self, times: Array, rows: slice, x: Array, on: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Positions (instant, load, axis) and slopes (instant, load) of the line under loads that modes answer."""
        assert self._train is not None
        w, slope = self._train.under(times, rows, on)
        return self.point(x.ravel()).reshape(*x.shape, -1) + w[..., None] * self.chord.across[0], slope

    def _under_each(self, times: Array, rows: slice, x: Array, on: NDArray[np.bool_]) -> tuple[Array, Array]:
        """The same by closed forms, slopes by differences."""
        place, slope = np.zeros((*x.shape, self.chord.along.size)), np.zeros(x.shape)
        step = _DIFFERENCE * self.chord.length
        for i, j in np.argwhere(on):
            near = np.clip(x[i, j] + np.array([-step, 0.0, step]), 0.0, self.chord.length)
            w, _ = self.motion(near, times[rows][i : i + 1])
            slope[i, j] = float((w[0, 2] - w[0, 0]) @ self.chord.across[0]) / (near[2] - near[0])
            place[i, j] = self.point(near[1:2])[0] + w[0, 1]
        return place, slope
