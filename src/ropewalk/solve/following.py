"""Path following: equilibria at equal steps of a path, with smaller ones where the next equilibrium is hard to find."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array
from ropewalk.solve.search_budget import SearchBudgetError

# Steps are never made smaller than this part of the distance between two regular positions.
_LEAST = 1.0 / 4096.0
# Part of the path that the first step may take where its turning counts: there is nothing to judge it by yet.
FIRST = 1e-3
_FINE = 20001  # instants among which the end of a path is looked for
_MOST_DOUBLINGS = 60


class OnPath(Protocol):
    """An equilibrium on the path."""

    @property
    def path(self) -> float:
        """How far it is along the path, m."""


S = TypeVar("S")
P = TypeVar("P", bound=OnPath)


@dataclass(frozen=True)
class Reached(Generic[S]):
    """An equilibrium on the path of the first load, at a time that goes with it."""

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
    """Yield equilibria at equal steps of the path of the first load.

    Args:
        rest: finds the equilibrium at a time in s, next to another one.
        contacts: where loads touch in an equilibrium, (load, axis) m; NaN of those that do not.
        times, paths: of the first load, s and m; paths rise.
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


def schedule(
    name: str, place: Callable[[Array], Array], end: float, begin: float = 0.0, last: float = 0.0, first: float = 0.0
) -> tuple[Array, Array]:
    """Times at which a load is on its way until it has come to the end of its line, and its path then, which rises, m.

    Args:
        name: of the load.
        place: times in s to places in m.
        begin, end: of its line, m.
        last, first: how far its last and its first contact are behind its place, m.

    Raises:
        EquilibriumError: it has no way.
    """
    origin = float(place(np.zeros(1))[0])

    def beyond(places: Array) -> Array:
        """Whether and how far all contacts are beyond the end that the load goes to; negative: not there yet."""
        ahead, back = places - last - end, begin - (places - first)
        gone: Array = np.where(places < origin, np.maximum(ahead, back), ahead) / end
        return gone

    until, before = 1.0, np.nan
    for _ in range(_MOST_DOUBLINGS):
        now = place(np.array([until]))
        if beyond(now)[0] >= 0.0 or now[0] == before:
            break
        until, before = 2.0 * until, float(now[0])
    times = np.linspace(0.0, until, _FINE)
    gone = beyond(place(times))
    if (gone >= 0.0).any():
        i = max(int(np.argmax(gone >= 0.0)), 1)
        end = float(np.interp(0.0, gone[i - 1 : i + 1], times[i - 1 : i + 1]))
        times = np.append(times[:i], end)
    path = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(place(times))))])
    if not path[-1] > 0.0:
        raise EquilibriumError(
            f"load {name} has no path: it stands at the end of its line and would move off it, or its speed is zero; "
            "let it start elsewhere (travel.from), or turn the sign of speed"
        )
    grows = np.concatenate([[True], np.diff(path) > 0.0])
    return times[grows], path[grows]
