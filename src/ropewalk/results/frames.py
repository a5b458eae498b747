"""Frames of several instants in one: so they are made, judged and written, for to call NumPy costs more than to count.

A motion goes on from output to output and notes what its frames will be made of; now and then all that has been noted
is made frames at once.
"""

from __future__ import annotations

import time as clock
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np

from ropewalk.results.frame import Array, Frame

NAMES = tuple(field.name for field in fields(Frame) if field.name != "path")
WAIT = 0.1  # s, the longest that frames wait for others: a run that is killed loses no more for it
SPACE = 2_000_000  # bytes, about as much as they take while they wait; of more, arrays leave the caches
_GROWTH = 8  # times as many instants as ever before are noted without a pause, at most
_QUICK = 1e-6  # s: clocks are no finer


@dataclass(frozen=True)
class Frames:
    """The states at some output instants."""

    path: Array  # (instant,) time in s, or load path in m
    of: Mapping[str, Array]  # by the names of `Frame`, with instants in front; not what only other runs have

    @staticmethod
    def together(frames: Sequence[Frame]) -> Frames:
        """The same frames, one after the other."""
        given = [name for name in NAMES if getattr(frames[0], name) is not None]
        of = {name: np.array([getattr(frame, name) for frame in frames], dtype=np.float64) for name in given}
        return Frames(np.array([frame.path for frame in frames], dtype=np.float64), of)

    def __len__(self) -> int:
        """How many."""
        return self.path.size

    def __getitem__(self, i: int) -> Frame:
        """One of them."""
        return Frame(float(self.path[i]), **{name: array[i] for name, array in self.of.items()})

    def __iter__(self) -> Iterator[Frame]:
        """One after the other."""
        return (self[i] for i in range(len(self)))


def summed(values: Array) -> Array:
    """Sums over all but instants, which come first; to the last bit they do not depend on how many of these there are.

    NumPy adds in an order that depends on how arrays lie in memory, as `@` and `einsum` do on sizes, and a run that is
    taken up again is to give what it would have given.
    """
    return np.asarray(np.ascontiguousarray(values).reshape(len(values), -1).sum(axis=1))


class NotedInstants(NamedTuple):
    """What a motion has noted of output instants that it has come to without a pause."""

    number: int
    of: Any  # each engine's own


class Waiting:
    """What has been noted of instants whose frames are still to be made."""

    def __init__(self, each: int) -> None:
        self._most = max(1, SPACE // max(each, 1))
        self._since = -np.inf  # the first frame does not wait
        self._notes = list[Any]()
        self._count = 0
        self._begun, self._largest = 0.0, 1  # when they were asked for, and the most at once so far
        self._each = max(WAIT, _QUICK)  # s, that the last of them took for one

    def ask(self) -> int:
        """How many instants may be noted without a pause: as many as there is time and memory for."""
        self._begun = clock.monotonic()
        left = WAIT - (self._begun - self._since)
        in_time = int(min(max(left / self._each, 1.0), _GROWTH * self._largest))
        return max(1, min(in_time, self._most - self._count))

    def append(self, noted: NotedInstants, beside: Any) -> bool:
        """Keep notes, and what belongs to them; says whether it is time to make frames."""
        now = clock.monotonic()
        self._largest = max(self._largest, noted.number)
        self._each = max(now - self._begun, _QUICK) / max(noted.number, 1)
        self._notes.append((noted, beside))
        self._count += noted.number
        return self._count >= self._most or now + self._each > self._since + WAIT

    def taken(self) -> list[Any]:
        """All that is waiting, which does so no longer."""
        notes, self._notes, self._count, self._since = self._notes, [], 0, clock.monotonic()
        return notes

    def __len__(self) -> int:
        """How many instants are waiting."""
        return self._count
