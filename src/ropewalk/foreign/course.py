"""The course of a vehicle: how far it has come, and how fast it is."""

from __future__ import annotations

from bisect import bisect_right
from itertools import pairwise
from typing import Any

from ropewalk.mechanics.assembly import speed_table


class Course:
    """The integral of a speed that is linear between the entries of a table and constant outside.

    Args:
        speed: in m/s, as declared.
        until: end of the run, s.
    """

    def __init__(self, speed: Any, until: float) -> None:
        times, values = speed_table(speed, until)
        self._times, self._speeds = times.tolist(), values.tolist()
        self._ways = [0.0]  # m, from the first entry
        for (t0, t1), (v0, v1) in zip(pairwise(self._times), pairwise(self._speeds), strict=True):
            self._ways.append(self._ways[-1] + 0.5 * (v0 + v1) * (t1 - t0))
        self._begin = 0.0
        self._begin = self.at(0.0)[0]

    def at(self, t: float) -> tuple[float, float]:
        """How far it has come since time 0 in m, and its speed in m/s, at a time in s."""
        i = max(bisect_right(self._times, t) - 1, 0)
        first, late = self._speeds[i], t - self._times[i]
        here = first
        if late > 0.0 and i + 1 < len(self._times):
            here += (self._speeds[i + 1] - first) * late / (self._times[i + 1] - self._times[i])
        return self._ways[i] + 0.5 * (first + here) * late - self._begin, here
