"""Slow motion: rest shapes for positions of the loads along their path."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import HORIZONTAL, LEAVE, MATERIAL, SLIP, STAY, Array
from ropewalk.solve.following import FIRST, Mover, follow, schedule, turns_less
from ropewalk.solve.load_schedule import movers_of
from ropewalk.solve.loaded_equilibrium import LoadedStrand
from ropewalk.solve.path_measure import Measure, shapes
from ropewalk.solve.start import PreparedRun

# The loads' places are found to this part of their line's length: below the rounding of the shapes' tensions.
_TOLERANCE = 1e-12
# Beyond this part of the length a place was not found: the path turns back.
_REACHED = 1e-6
# Error of the slip path in each step, as a part of the step.
_SLIP = 1e-6


@dataclass(frozen=True)
class LoadPosition:
    """One position of the loads: the load path, the places of all loads, and the shapes of all strands."""

    path: float  # m
    t: float  # s
    xi: Array  # (load,) m
    marks: Array  # (load,) the measures there
    stands: list[LoadedStrand]
    given: Array  # (load, axis) N
    left: NDArray[np.bool_]  # (load,) whether it has left its line, at whose end it is computed from then on

    def contacts(self, setting: PreparedRun) -> Array:
        """Positions of the contacts (load, axis), m."""
        out = np.empty((self.xi.size, len(setting.axes)))
        for on, rest in zip(setting.on, self.stands, strict=True):
            out[on] = rest.r[:, rest.contact].T
        return out


def walk(setting: PreparedRun, positions: int, turn: float | None = None) -> Iterator[LoadPosition]:
    """Yield the loads at equal steps of the load path, until all have come to the ends of their lines or stopped.

    All loads keep the pace of their speeds. Forces that change in time are taken at the time of the path. Between the
    positions the step is refined where the next shape is not found at once, where the slip path needs it, and where a
    load's path turns by more than the angle `turn` (rad); with `turn` given, the places in between are yielded, too.

    Raises:
        EquilibriumError: a rest shape cannot be found, or the loads do not advance; the last place that can be reached
            has been yielded.
    """
    if setting.xi.size == 0:
        raise EquilibriumError("quasi-static runs need a load that travels")
    stands, given = shapes(setting, setting.xi, 0.0)
    measures = [Measure(setting, k) for k in range(setting.xi.size)]
    marks = np.array([m.of(x, stands) for m, x in zip(measures, setting.xi, strict=True)])
    movers = movers_of(setting, measures, marks)
    times, path = schedule(movers)
    here = LoadPosition(0.0, 0.0, setting.xi.copy(), marks, stands, given, np.zeros(setting.xi.size, dtype=np.bool_))
    yield here
    by = _PathWalk(setting, measures, movers, times, path, marks, turn)
    yield from follow(here, by.step, by.is_fine, np.linspace(0.0, path[-1], positions), between=turn is not None)


@dataclass
class _PathWalk:
    """Steps along the path."""

    setting: PreparedRun
    measures: list[Measure]
    movers: list[Mover]
    times: Array
    path: Array  # the load path at these times, m
    begin: Array  # (load,) the measures at the beginning
    turn: float | None

    def step(self, here: LoadPosition, before: LoadPosition | None, path: float) -> LoadPosition:
        t = float(np.interp(path, self.path, self.times))
        before_this, target = np.array([mover.travelled(np.array([here.t, t])) for mover in self.movers]).T
        stays = self.setting.loads.at_end == STAY
        low, high = np.array([mover[1:3] for mover in self.movers]).T
        before_this, target = (np.where(stays, np.clip(way, low, high), way) for way in (before_this, target))
        advance = target - before_this
        step = _PathStep(self.setting, self.measures, t, here.xi, here.marks, self.begin + target, advance)
        guess = here.xi + advance
        similar = here.stands
        if before is not None:
            on = (path - here.path) / (here.path - before.path)
            guess = here.xi + on * (here.xi - before.xi)
            if not self.setting.loads.contact.any():  # hold forces may have other roots: those stay near the last ones
                similar = [now.continued(last, on) for now, last in zip(here.stands, before.stands, strict=True)]
        xi, stands, given = step.take(guess, similar)
        marks = np.array([m.of(x, stands) for m, x in zip(self.measures, xi, strict=True)])
        left = (self.setting.loads.at_end == LEAVE) & ((target < low) | (target > high))
        return LoadPosition(path, t, xi, marks, stands, given, left)

    def is_fine(self, before: LoadPosition | None, here: LoadPosition, new: LoadPosition) -> bool:
        slipping = np.array([m.kind == SLIP for m in self.measures])
        if before is None:
            return not (slipping.any() or self.turn) or new.path - here.path <= FIRST * float(self.path[-1])
        if slipping.any():
            last, now = here.path - before.path, new.path - here.path
            bend = 2.0 * ((new.marks - here.marks) / now - (here.marks - before.marks) / last) / (last + now)
            if float(np.abs(bend[slipping]).max()) * now * now / 12.0 > _SLIP:
                return False
        if self.turn is None:
            return True
        return turns_less(self.turn, *(place.contacts(self.setting) for place in (before, here, new)))


@dataclass
class _PathStep:
    """A step of all loads along their paths."""

    setting: PreparedRun
    measures: list[Measure]
    t: float
    before: Array  # (load,) m, xi before the step
    marks: Array  # (load,) the measures before the step
    target: Array  # (load,) m, where the measures have to come (slip: see `advance`)
    advance: Array  # (load,) m, path to go in this step

    def take(self, guess: Array, stands: list[LoadedStrand]) -> tuple[Array, list[LoadedStrand], Array]:
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

    def _shapes(
        self, xi: Array, trial: list[int], last: Array, stands: list[LoadedStrand]
    ) -> tuple[list[LoadedStrand], Array]:
        """Shapes with the loads at xi; if there are none, the loads on trial go back towards their last places."""
        for _ in range(10 if trial else 0):
            try:
                return shapes(self.setting, xi, self.t, stands)
            except EquilibriumError:
                xi[trial] = 0.5 * (xi[trial] + last)
        return shapes(self.setting, xi, self.t, stands)

    def _miss(self, k: int, x: float, stands: list[LoadedStrand]) -> float:
        m = self.measures[k]
        if m.kind == SLIP:
            return float((x - self.before[k]) * 0.5 * (self.marks[k] + m.of(x, stands)) - self.advance[k])
        return float(m.of(x, stands) - self.target[k])

    def _place(
        self, k: int, length: float, xi: Array, stands: list[LoadedStrand], given: Array
    ) -> tuple[list[LoadedStrand], Array]:
        """Put load k where its path comes out right (or to the end of its line): secant steps within a bracket."""
        m, low, high, slope = self.measures[k], 0.0, length, 1.0
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
                if abs(miss) > _REACHED * length:
                    break
                return stands, given
            xi[k] = new
            stands, given = self._shapes(xi, [k], np.array([x]), stands)
            following = self._miss(k, float(xi[k]), stands)
            slope = (following - miss) / (xi[k] - x)
            slope = slope if slope > 0.0 else 1.0
            miss = following
        if m.kind != HORIZONTAL:
            raise EquilibriumError("a load cannot be held further along its path")
        raise EquilibriumError(
            f"a load cannot reach x = {self.target[k]:.6g} m: its path turns back before, at "
            f"{m.of(xi[k], stands):.6g} m; measure its travel along the line (material, slip or arc)"
        )
