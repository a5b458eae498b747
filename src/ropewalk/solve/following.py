"""Path following: equilibria at equal steps of a path, with smaller ones where the next equilibrium is hard to find."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array
from ropewalk.solve.search_budget import SearchBudgetError

# Steps are never made smaller than this part of the distance between two regular positions.
_LEAST = 1.0 / 4096.0
# Part of the path that the first step may take where its turning counts: there is nothing to judge it by yet.
FIRST = 1e-3
_FINE = 20001  # instants among which the end of a path is looked for while speeds change
_CLOSE = 2e-15  # part of a displacement that counts as rounding
_ROUNDINGS = 64  # steps of rounding by which an arrival may be too late
_ARRIVED = 1e-9  # m, from the end of a line, where a load is at it


class OnPath(Protocol):
    """An equilibrium on the path."""

    @property
    def path(self) -> float:
        """How far it is along the path, m."""


S = TypeVar("S")
P = TypeVar("P", bound=OnPath)


@dataclass(frozen=True)
class Reached(Generic[S]):
    """An equilibrium on the load path, at a time that goes with it."""

    path: float  # m
    t: float  # s
    shape: S


def follow(
    here: P,
    step: Callable[[P, P | None, float], P],
    is_fine: Callable[[P | None, P, P], bool],
    regular: Array,
    *,
    between: bool,
) -> Iterator[P]:
    """Yield equilibria at regular positions, after the first one.

    Args:
        here: the first equilibrium.
        step: finds the equilibrium at a position in m from the last one and, if there is one, that before.
        is_fine: whether an equilibrium is near enough to the last one, and that before.
        regular: (position,) m, rising, the first that of `here`.
        between: whether those in between are yielded, too.

    Raises:
        EquilibriumError: there is none at some position; the last one that can be reached has been yielded.
    """
    before: P | None = None
    size = widest = float(regular[1] - regular[0])
    for goal in regular[1:]:
        while here.path < goal:
            rest = float(goal) - here.path
            parts = max(1, round(np.ceil(rest / size - 1e-9)))
            target = float(goal) if parts == 1 else here.path + rest / parts
            try:
                new = step(here, before, target)
            except EquilibriumError as error:
                if isinstance(error, SearchBudgetError) or size <= _LEAST * widest:
                    if not between and here.path not in regular:
                        yield here
                    raise
                size = 0.5 * min(size, rest)
                continue
            if size > _LEAST * widest and not is_fine(before, here, new):
                size = 0.5 * min(size, rest)
                continue
            before, here = here, new
            size = min(2.0 * size, widest)
            if new.path == goal or between:
                yield new


def quasistatic_motion(
    rest: Callable[[float, S | None], S],
    contacts: Callable[[S], Array],
    times: Array,
    paths: Array,
    positions: int,
    turn: float | None,
) -> Iterator[Reached[S]]:
    """Yield equilibria at equal steps of the load path.

    Args:
        rest: finds the equilibrium at a time in s, next to another one.
        contacts: where loads touch in an equilibrium, (load, axis) m; NaN of those that do not.
        times, paths: as from `schedule`, s and m.
        positions: how many, both ends included.
        turn: angle in rad, by which no load's path turns from one to the next, with those in between; or None.

    Raises:
        EquilibriumError: there is none at some position; the last one that can be reached has been yielded.
    """

    def step(here: Reached[S], before: Reached[S] | None, path: float) -> Reached[S]:
        t = float(np.interp(path, paths, times))
        return Reached(path, t, rest(t, here.shape))

    def is_fine(before: Reached[S] | None, here: Reached[S], new: Reached[S]) -> bool:
        if turn is None or before is None:
            return turn is None or new.path - here.path <= FIRST * paths[-1]
        return turns_less(turn, *(contacts(p.shape) for p in (before, here, new)))

    first = Reached(0.0, float(times[0]), rest(float(times[0]), None))
    yield first
    yield from follow(first, step, is_fine, np.linspace(0.0, paths[-1], positions), between=turn is not None)


def turns_less(angle: float, before: Array, here: Array, new: Array) -> bool:
    """Whether no path through three places (load, axis) turns by more than an angle in rad."""
    a, b = here - before, new - here
    sizes = np.sqrt((a * a).sum(axis=1) * (b * b).sum(axis=1))
    way = sizes > 0.0  # neither standing nor missing
    cosine = (a * b).sum(axis=1)[way] / sizes[way]
    return bool(np.all(np.arccos(np.clip(cosine, -1.0, 1.0)) <= angle))


class Mover(NamedTuple):
    """Prescribed travel of a load: displacements along its line, and those between which it is on the line."""

    travelled: Callable[[Array], Array]  # times in s to displacements since time 0, m
    low: float  # m, at which the last contact leaves the start of the line
    high: float  # m, at which the last contact leaves the end of the line
    settled: float = 0.0  # s, from which the speed is constant
    refuses: bool = False  # whether the run ends where it would leave its line

    def is_at_end(self, t: float) -> bool:
        """Whether it is at an end of its line at a time in s."""
        place = float(self.travelled(np.array([t]))[0])
        return place <= self.low + _ARRIVED or place >= self.high - _ARRIVED

    def end(self) -> float:
        """Return the time at which the load has left its line for good, or has stopped, s."""
        close = _CLOSE * max(abs(bound) for bound in (self.low, self.high, 0.0) if np.isfinite(bound))
        then, after = self.travelled(np.array([self.settled, self.settled + 1.0])).tolist()
        bound = self.high if after > then else self.low
        late = self._arrives(bound, then, after)
        times = np.append(np.linspace(0.0, self.settled, _FINE if self.settled else 1), late)
        place = self.travelled(times)
        inside = np.flatnonzero((place >= self.low - close) & (place <= self.high + close))
        if inside.size == 0:
            return 0.0
        if inside[-1] < times.size - 1:
            pair = slice(int(inside[-1]), int(inside[-1]) + 2)
            bound = self.high if place[pair][1] > self.high else self.low
            order = np.argsort(place[pair])
            return float(np.interp(bound, place[pair][order], times[pair][order]))
        changes = np.flatnonzero(np.diff(place) != 0.0)
        return float(times[changes[-1] + 1]) if changes.size else 0.0

    def _arrives(self, bound: float, then: float, after: float) -> float:
        """Return the time at which a displacement is reached that rounding does not pass, s.

        Args:
            bound: the displacement, m.
            then, after: displacements when the speed has settled and a second later, m.
        """
        late = self.settled + max((bound - then) / (after - then), 0.0) if after != then else self.settled
        for _ in range(_ROUNDINGS if np.isfinite(late) else 0):
            place = float(self.travelled(np.array([late]))[0])
            if (place <= bound) if after > then else (place >= bound):
                break
            late = float(np.nextafter(late, self.settled))
        return late


def schedule(movers: Sequence[Mover]) -> tuple[Array, Array]:
    """Return times, s, and the load path then, m, which rises, until all loads have left their lines or stopped.

    The load path is the distance covered by the load that is fastest at each time, among those not at their end yet:
    it does not depend on the order of the loads. A load that must not leave its line ends the path there.

    Raises:
        EquilibriumError: no load moves.
    """
    ends = [mover.end() for mover in movers]
    refused = [end for mover, end in zip(movers, ends, strict=True) if mover.refuses and end and mover.is_at_end(end)]
    last, settled = min(refused, default=max(ends, default=0.0)), max((m.settled for m in movers), default=0.0)
    ends = [min(end, last) for end in ends]
    fine = np.linspace(0.0, min(last, settled), _FINE if settled else 1)
    times = np.unique(np.concatenate([fine, [0.0, last], ends]))
    steps = np.zeros(times.size - 1)
    for mover, end in zip(movers, ends, strict=True):
        covered = np.abs(np.diff(mover.travelled(times)))
        steps = np.maximum(steps, np.where(times[1:] <= end, covered, 0.0))
    path = np.concatenate([[0.0], np.cumsum(steps)])
    if not path[-1] > 0.0:
        raise EquilibriumError(
            "no load has a path: each is located at the end of its line and would move off it, or its speed is zero; "
            "let one start elsewhere (travel.from), or change the sign of its speed"
        )
    grows = np.concatenate([[True], np.diff(path) > 0.0])
    return times[grows], path[grows]
