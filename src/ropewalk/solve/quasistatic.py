"""Slow motion: rest shapes for positions of the loads at equal steps of their path."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import HORIZONTAL, MATERIAL, SLIP, Array
from ropewalk.mechanics.rider import force_at, look_up_integral
from ropewalk.solve.standing import Standing, stand
from ropewalk.solve.start import Setting

# The loads' places are found to this part of their line's length: below the rounding of the shapes' tensions.
_TOLERANCE = 1e-12


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
        guess = before[s].first_force if before is not None else None
        try:
            out.append(stand(setting.strands, s, setting.ends[s], xi[on], given[on].T, loads.contact[on], guess))
        except EquilibriumError as error:
            raise EquilibriumError(f"line {setting.lines[s]}: {error}") from None
    return out, given


class _Measure:
    """How far a load has come along its path, as its speed is measured."""

    def __init__(self, setting: Setting, k: int) -> None:
        self.setting, self.k = setting, k
        self.s = int(setting.loads.strand[k])
        self.kind = int(setting.loads.measure[k])
        self.number = int(np.flatnonzero(np.flatnonzero(setting.loads.strand == self.s) == k)[0])

    def of(self, xi: float, stands: list[Standing]) -> float:
        """Path up to xi: material coordinate, arc length or horizontal place; for slip the mean stretch there."""
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
    """Yield the loads at equal steps of their path, from their start to the end of the line of the first to arrive.

    All loads keep the pace of their speeds. Forces that change in time are taken at the time of the path.

    Raises:
        EquilibriumError: a rest shape cannot be found, or the loads do not advance.
    """
    loads, count = setting.loads, setting.xi.size
    measures = [_Measure(setting, k) for k in range(count)]
    until, times, ways = _timetable(setting)
    xi = setting.xi.copy()
    stands, given = shapes(setting, xi, 0.0)
    begin = [m.of(x, stands) for m, x in zip(measures, xi, strict=True)]
    yield Place(0.0, xi.copy(), stands, given)
    now = begin.copy()
    first = ways[0]
    previous_t, previous_xi = 0.0, xi.copy()
    for step in range(1, positions):
        t = float(np.interp(step / (positions - 1) * abs(first[-1]), np.abs(first), times))
        target_way = np.array([np.interp(t, times, way) for way in ways])
        last_way = np.array([np.interp(previous_t, times, way) for way in ways])
        anchor, anchor_stands = xi.copy(), stands
        guess = xi + (xi - previous_xi) if step > 1 else xi + (target_way - last_way)
        previous_xi = xi.copy()
        xi, stands, given = _advance(
            setting, measures, anchor, anchor_stands, begin, now, last_way, target_way, guess, t
        )
        now = [m.of(x, stands) for m, x in zip(measures, xi, strict=True)]
        previous_t = t
        yield Place(abs(float(target_way[0])), xi.copy(), stands, given)


def _advance(setting, measures, anchor, anchor_stands, begin, now, last_way, target_way, guess, t):  # type: ignore[no-untyped-def]
    """Find the places of all loads at the next position: each measured path must come out right (secant, in turn)."""
    strands, loads = setting.strands, setting.loads
    length = strands.links[loads.strand] * strands.h[loads.strand]
    xi = np.clip(guess, 0.0, length)
    stands, given = shapes(setting, xi, t, anchor_stands)
    if all(m.kind == MATERIAL for m in measures):
        xi = np.clip(anchor + target_way - last_way, 0.0, length)
        stands, given = shapes(setting, xi, t, anchor_stands)
        return xi, stands, given

    def miss(k: int) -> float:
        m = measures[k]
        if m.kind == SLIP:
            return (xi[k] - anchor[k]) * 0.5 * (now[k] + m.of(xi[k], stands)) - (target_way[k] - last_way[k])
        return m.of(xi[k], stands) - begin[k] - target_way[k]

    for _ in range(50):
        worst = 0.0
        for k in range(len(measures)):
            gap = miss(k)
            if abs(gap) > _TOLERANCE * length[k]:
                x0 = xi[k]
                xi[k] = np.clip(x0 - gap, 0.0, length[k])
                for _ in range(30):
                    stands, given = shapes(setting, xi, t, stands)
                    new = miss(k)
                    if abs(new) <= _TOLERANCE * length[k] or xi[k] == x0 or new == gap:
                        break
                    following = np.clip(xi[k] - new * (xi[k] - x0) / (new - gap), 0.0, length[k])
                    x0, gap, xi[k] = xi[k], new, following
                worst = max(worst, abs(miss(k)))
        if worst <= 10 * _TOLERANCE * float(length.max()) or len(measures) == 1:
            break
    return xi, stands, given


def _timetable(setting: Setting) -> tuple[float, Array, list[Array]]:
    """Times and paths of all loads until the first of them comes to the end of its line."""
    loads, count = setting.loads, setting.xi.size
    if count == 0:
        raise EquilibriumError("slow motion needs a load that travels")

    def path(k: int, t: float) -> float:
        first, n = loads.speed_first[k], loads.speed_count[k]
        return float(look_up_integral(loads.speed_time, loads.speed_value, loads.speed_path, first, n, t))

    horizon = float(loads.speed_time.max()) if loads.speed_time.size else 0.0
    arrivals = []
    for k in range(count):
        speed = loads.speed_value[loads.speed_first[k] + loads.speed_count[k] - 1]
        room = _room(setting, k, forward=speed > 0.0 or (speed == 0.0 and path(k, horizon) > 0.0))
        constant = loads.speed_count[k] == 1
        if constant and speed != 0.0:
            arrivals.append(room / abs(speed))
        elif not constant:
            times = np.linspace(0.0, max(horizon, 1e-9) + (room / abs(speed) if speed != 0.0 else 0.0), 20001)
            gone = np.abs([path(k, t) for t in times])
            reached = np.flatnonzero(gone >= room * (1 - 1e-12))
            if reached.size:
                i = int(reached[0])
                arrivals.append(float(np.interp(room, gone[max(i - 1, 0) : i + 1], times[max(i - 1, 0) : i + 1])))
            else:
                arrivals.append(float(times[-1]))
    if not arrivals:
        raise EquilibriumError("slow motion needs a load that travels: all speeds are zero")
    until = min(arrivals)
    times = np.linspace(0.0, until, 2 if (loads.speed_count == 1).all() else 20001)
    return until, times, [np.array([path(k, t) for t in times]) for k in range(count)]


def _room(setting: Setting, k: int, forward: bool) -> float:
    """Path from the start of load k to the end of its line, as measured (slip: by a first walk along the line)."""
    s, kind = int(setting.loads.strand[k]), int(setting.loads.measure[k])
    strands, bare, xi = setting.strands, setting.bare[s], float(setting.xi[k])
    length = float(strands.links[s] * strands.h[s])
    if kind == MATERIAL:
        return length - xi if forward else xi
    if kind == HORIZONTAL:
        end = setting.ends[s][1 if forward else 0][0]
        return abs(float(end - np.interp(xi, bare.X, bare.r[0])))
    along = np.concatenate(([0.0], np.cumsum(np.sqrt((np.diff(bare.r, axis=1) ** 2).sum(axis=0)))))
    if kind != SLIP:
        here = float(np.interp(xi, bare.X, along))
        return float(along[-1]) - here if forward else here
    measure, grid = _Measure(setting, k), np.linspace(xi, length if forward else 0.0, 101)
    others = setting.xi.copy()
    lam, stands = [], None
    for x in grid:
        others[k] = x
        stands, _ = shapes(setting, others, 0.0, stands)
        lam.append(measure.of(float(x), stands))
    return abs(float(np.trapezoid(lam, grid)))
