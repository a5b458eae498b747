"""The mean of a speed that changes in time, and by how much it changes about that."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any, NamedTuple

from ropewalk.model.history import SpeedTable

_LOOKS = 1000  # at a callable


class MeanSpeed(NamedTuple):
    """A speed in a time from 0, all in m/s."""

    mean: float
    rms: float  # of what it changes by
    most: float

    @staticmethod
    def of(speed: Any, until: float) -> MeanSpeed:
        """Of a constant, a table or a callable, up to a time in s."""
        course = list(_course(speed, until))
        parts = [((b - a) / until, u, v) for (a, u), (b, v) in pairwise(course)]
        mean = sum(part * (u + v) for part, u, v in parts) / 2.0
        parts = [(part, u - mean, v - mean) for part, u, v in parts]
        square = sum(part * (u * u + u * v + v * v) for part, u, v in parts) / 3.0
        return MeanSpeed(mean, math.sqrt(max(square, 0.0)), max(abs(u - mean) for _, u in course))

    @property
    def is_gusty(self) -> bool:
        """Whether on average the squares of its changes are more than that of the mean."""
        return self.rms > abs(self.mean)


def _course(speed: Any, until: float) -> list[tuple[float, float]]:
    """Instants from 0 on in s, and speeds there in m/s, linear in between."""
    if callable(speed):
        return [(t, float(speed(t))) for t in (until * i / _LOOKS for i in range(_LOOKS + 1))]
    if not isinstance(speed, SpeedTable):
        return [(0.0, float(speed)), (until, float(speed))]
    table = list(zip(speed.time, speed.value, strict=True))
    inside = [(t, u) for t, u in table if 0.0 < t < until]
    return [(0.0, _at(table, 0.0)), *inside, (until, _at(table, until))]


def _at(table: list[tuple[float, float]], t: float) -> float:
    """A table's value, constant outside."""
    for (a, u), (b, v) in pairwise(table):
        if a <= t < b:
            return u + (t - a) / (b - a) * (v - u)
    return table[0][1] if t < table[0][0] else table[-1][1]
