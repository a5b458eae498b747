"""Slow motion: rest shapes for positions of the loads at equal steps of their path."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import HORIZONTAL, MATERIAL, SLIP, Array
from ropewalk.mechanics.rider import force_at, look_up_integral
from ropewalk.model.history import SpeedTable
from ropewalk.model.scenario import Scenario
from ropewalk.solve.standing import Standing, stand
from ropewalk.solve.start import Setting

# The loads' places are found to this part of their line's length: below the rounding of the shapes' tensions.
_TOLERANCE = 1e-12


def horizon(scenario: Scenario) -> float:
    """For how long callables are needed until a load has certainly passed its line, s (0 without callables)."""
    loads = scenario.loads.values()
    if not any(callable(load.travel.speed) or callable(load.force) for load in loads):
        return 0.0
    times = []
    for load in loads:
        line, speed, until, gone = scenario.lines[load.on], load.travel.speed, 1.0, -1.0
        reach = 3.0 * max(line.length or 0.0, line.distance)  # longer than the stretched line, and there and back
        for _ in range(60):
            grid = np.linspace(0.0, until, 257)
            if callable(speed):
                rates = np.array([float(speed(t)) for t in grid])
            elif isinstance(speed, SpeedTable):
                rates = np.interp(grid, speed.time, speed.value)
            else:
                rates = np.full(grid.size, speed)
            last, gone = gone, float(np.trapezoid(np.abs(rates), grid))
            if not last < gone < reach:  # done, or the load comes to a stop
                break
            until *= 2.0
        times.append(until)
    return min(times)


@dataclass(frozen=True)
class Place:
    """One position of the loads: path of the first one, where they all stand, and the shapes of all strands."""

    path: float
    xi: Array
    stands: list[Standing]
    given: Array  # (load, axis) N


def shapes(setting: Setting, xi: Array, t: float, before: list[Standing] | None = None) -> tuple[list[Standing], Array]:
    """The rest shapes of all strands with the loads at xi, and the given forces at time t."""
    loads, dim = setting.loads, len(setting.axes)
    given = np.array([[force_at(loads, k, t, a) for a in range(dim)] for k in range(xi.size)]).reshape(xi.size, dim)
    out = []
    for s in range(setting.strands.first.size):
        on = np.flatnonzero(loads.strand == s)
        similar = before[s] if before is not None else None
        try:
            out.append(stand(setting.strands, s, setting.ends[s], xi[on], given[on].T, loads.contact[on], similar))
        except EquilibriumError as error:
            raise EquilibriumError(f"line {setting.lines[s]}: {error}") from None
    return out, given


class _Measure:
    """How far a load has come along its path, as its speed is measured."""

    def __init__(self, setting: Setting, k: int) -> None:
        self.setting, self.k = setting, k
        self.s = int(setting.loads.strand[k])
        self.kind = int(setting.loads.measure[k])
        # Slow motion may be measured against the material coordinate: along x on a line that runs towards -x.
        run = float(setting.ends[self.s][1][0] - setting.ends[self.s][0][0])
        self.direction = -1.0 if self.kind == HORIZONTAL and run < 0.0 else 1.0
        self.number = int(np.flatnonzero(np.flatnonzero(setting.loads.strand == self.s) == k)[0])

    def of(self, xi: float, stands: list[Standing]) -> float:
        """Path up to xi: material coordinate, arc length or x; for slip the mean stretch there."""
        rest = stands[self.s]
        i = int(rest.contact[self.number])
        if self.kind == MATERIAL:
            return xi
        if self.kind == HORIZONTAL:
            return float(rest.r[0, i])
        length = np.sqrt((np.diff(rest.r, axis=1) ** 2).sum(axis=0))
        if self.kind == SLIP:
            lam = length / np.diff(rest.X)
            return float(0.5 * (lam[max(i - 1, 0)] + lam[min(i, lam.size - 1)]))
        return float(length[:i].sum())


def walk(setting: Setting, positions: int) -> Iterator[Place]:
    """Yield the loads at equal steps of the path of the first one, until one of them comes to the end of its line.

    All loads keep the pace of their speeds. Forces that change in time are taken at the time of the path.

    Raises:
        EquilibriumError: a rest shape cannot be found, or the loads do not advance.
    """
    count = setting.xi.size
    if count == 0:
        raise EquilibriumError("slow motion needs a load that travels")
    measures = [_Measure(setting, k) for k in range(count)]
    xi = setting.xi.copy()
    stands, given = shapes(setting, xi, 0.0)
    begin = np.array([m.of(x, stands) for m, x in zip(measures, xi, strict=True)])
    times, ways = _timetable(setting, measures, begin)
    path = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(ways[0])))))
    first = setting.loads.strand[0]
    if not path[-1] > _TOLERANCE * setting.strands.links[first] * setting.strands.h[first]:
        raise EquilibriumError(
            "the first load has no path: it stands at the end of its line and would move off it, or its speed is zero; "
            "let it start elsewhere (travel.from), or turn the sign of speed"
        )
    yield Place(0.0, xi.copy(), stands, given)
    previous_t, previous_xi = 0.0, xi
    for place in np.linspace(0.0, path[-1], positions)[1:]:
        t = float(np.interp(place, path, times))
        target = np.array([np.interp(t, times, way) for way in ways])
        advance = target - [np.interp(previous_t, times, way) for way in ways]
        marks = np.array([m.of(x, stands) for m, x in zip(measures, xi, strict=True)])
        step = _Step(setting, measures, t, xi, marks, begin + target, advance)
        guess = xi + (xi - previous_xi) if previous_t > 0.0 else xi + advance * [m.direction for m in measures]
        previous_t, previous_xi = t, xi
        xi, stands, given = step.take(guess, stands)
        yield Place(float(place), xi.copy(), stands, given)


@dataclass
class _Step:
    """A step of all loads along their paths."""

    setting: Setting
    measures: list[_Measure]
    t: float
    before: Array  # (load,) m, xi before the step
    marks: Array  # (load,) the measures before the step
    target: Array  # (load,) m, where the measures have to come (slip: see `advance`)
    advance: Array  # (load,) m, path to go in this step

    def take(self, guess: Array, stands: list[Standing]) -> tuple[Array, list[Standing], Array]:
        """Find the places of all loads at which each measured path comes out right, one load after the other."""
        loads, strands = self.setting.loads, self.setting.strands
        length = strands.links[loads.strand] * strands.h[loads.strand]
        xi = np.clip(guess, 0.0, length)
        for k, m in enumerate(self.measures):
            if m.kind == MATERIAL:
                xi[k] = np.clip(self.before[k] + self.advance[k], 0.0, length[k])
        searched = [k for k, m in enumerate(self.measures) if m.kind != MATERIAL]
        stands, given = self._shapes(xi, searched, self.before[searched], stands)
        for _ in range(50):
            last = xi.copy()
            for k in searched:
                stands, given = self._place(k, float(length[k]), xi, stands, given)
            if len(searched) < 2 or np.all(np.abs(xi - last) <= _TOLERANCE * length):
                return xi, stands, given
        raise EquilibriumError("the loads hinder each other: no places were found that agree with all their paths")

    def _shapes(self, xi: Array, trial: list[int], last: Array, stands: list[Standing]) -> tuple[list[Standing], Array]:
        """Shapes with the loads at xi; if there are none, the loads on trial go back towards their last places."""
        for _ in range(10 if trial else 0):
            try:
                return shapes(self.setting, xi, self.t, stands)
            except EquilibriumError:
                xi[trial] = 0.5 * (xi[trial] + last)
        return shapes(self.setting, xi, self.t, stands)

    def _miss(self, k: int, x: float, stands: list[Standing]) -> float:
        m = self.measures[k]
        if m.kind == SLIP:
            return float((x - self.before[k]) * 0.5 * (self.marks[k] + m.of(x, stands)) - self.advance[k])
        return float(m.direction * (m.of(x, stands) - self.target[k]))

    def _place(
        self, k: int, length: float, xi: Array, stands: list[Standing], given: Array
    ) -> tuple[list[Standing], Array]:
        """Put load k where its path comes out right (or to the end of its line): secant steps within a bracket."""
        low, high, slope = 0.0, length, 1.0
        miss = self._miss(k, xi[k], stands)
        for _ in range(100):
            x = float(xi[k])
            if abs(miss) <= _TOLERANCE * length or (x >= length and miss < 0.0) or (x <= 0.0 and miss > 0.0):
                return stands, given
            low, high = (low, x) if miss > 0.0 else (x, high)
            new = min(max(x - miss / slope, 0.0), length)
            if not (low < new < high or (new == length == high) or (new == 0.0 == low)):
                new = 0.5 * (low + high)
            if abs(new - x) <= 1e-16 * length:
                return stands, given
            xi[k] = new
            stands, given = self._shapes(xi, [k], np.array([x]), stands)
            following = self._miss(k, float(xi[k]), stands)
            slope = (following - miss) / (xi[k] - x)
            slope = slope if slope > 0.0 else 1.0
            miss = following
        return stands, given


def _timetable(setting: Setting, measures: list[_Measure], begin: Array) -> tuple[Array, list[Array]]:
    """Times and paths of all loads until the first of them comes to the end of its line."""
    loads, count = setting.loads, setting.xi.size

    def path(k: int, times: Array) -> Array:
        first, n = loads.speed_first[k], loads.speed_count[k]
        tables = loads.speed_time, loads.speed_value, loads.speed_path
        return np.array([look_up_integral(*tables, first, n, t) for t in times])

    arrivals, changing = [], bool((loads.speed_count > 1).any())
    for k in range(count):
        table = slice(loads.speed_first[k], loads.speed_first[k] + loads.speed_count[k])
        speeds, last = loads.speed_value[table], float(loads.speed_value[table][-1])
        ahead = _room(setting, measures[k], float(begin[k]), forward=True) if (speeds > 0.0).any() else np.inf
        behind = _room(setting, measures[k], float(begin[k]), forward=False) if (speeds < 0.0).any() else np.inf
        if last == 0.0 and speeds.size == 1:
            continue
        horizon = max(float(loads.speed_time[table][-1]), 0.0)
        if last != 0.0:
            then = float(path(k, np.array([horizon]))[0])
            horizon += max((ahead - then) / last if last > 0.0 else (behind + then) / -last, 0.0)
        times = np.linspace(0.0, horizon, 20001 if speeds.size > 1 else 2)
        gone = path(k, times)
        off = np.maximum(gone / ahead, -gone / behind)
        i = int(np.argmax(off >= 1.0 - 1e-12)) if off.max() >= 1.0 - 1e-12 else times.size - 1
        arrivals.append(float(np.interp(1.0, off[i - 1 : i + 1], times[i - 1 : i + 1])))
    times = np.linspace(0.0, min(arrivals, default=0.0), 20001 if changing else 2)
    return times, [path(k, times) for k in range(count)]


def _room(setting: Setting, measure: _Measure, begin: float, *, forward: bool) -> float:
    """Path from the start of a load to the end of its line, as measured (slip: by a first walk along the line)."""
    s, k = measure.s, measure.k
    strands, bare, xi = setting.strands, setting.bare[s], float(setting.xi[k])
    length = float(strands.links[s] * strands.h[s])
    if measure.kind == MATERIAL:
        room = length - xi if forward else xi
    elif measure.kind == HORIZONTAL:  # forward is towards +x, whichever end of the line lies there
        ends = [float(end[0]) for end in setting.ends[s]]
        room = max(ends) - begin if forward else begin - min(ends)
    elif measure.kind != SLIP:
        arc = float(np.sqrt((np.diff(bare.r, axis=1) ** 2).sum(axis=0)).sum()) if bare is not None else length
        room = arc - begin if forward else begin
    else:
        grid, places = np.linspace(xi, length if forward else 0.0, 101), setting.xi.copy()
        lam: list[float] = []
        stands = None
        for x in grid:
            places[k] = x
            try:
                stands, _ = shapes(setting, places, 0.0, stands)
            except EquilibriumError:  # the walk will end there and say why
                lam += [lam[-1]] * (grid.size - len(lam))
                break
            lam.append(measure.of(float(x), stands))
        room = abs(float(np.trapezoid(lam, grid)))
    return max(room, 1e-300)
