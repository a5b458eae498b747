"""How far a load has come: the integral of a speed."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array


class Travelled:
    """A speed that is linear between the entries of a table and constant outside, and its integral.

    Args:
        time: (entry,) s, rising.
        speed: (entry,) m/s.
    """

    def __init__(self, time: Array, speed: Array) -> None:
        self._time, self._speed, self._begin = time, speed, 0.0
        self._way: Array = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
        self._begin = float(self.at(np.zeros(1))[0])

    @property
    def settled(self) -> float:
        """The time from which the speed is constant, s."""
        return max(float(self._time[-1]), 0.0) if self._time.size > 1 else 0.0

    @property
    def path(self) -> Array:
        """What has been travelled since time 0 at each entry, m."""
        return self._way - self._begin

    def speed(self, times: Array) -> Array:
        """The speed at times in s, m/s."""
        return np.interp(times, self._time, self._speed)

    def at(self, times: Array, start: float = 0.0) -> Array:
        """What has been travelled since time 0 at times in s, and the start in m."""
        i = np.clip(np.searchsorted(self._time, times, side="right") - 1, 0, self._time.size - 1)
        late = times - self._time[i]
        gone: Array = start + (self._way[i] + 0.5 * late * (self._speed[i] + self.speed(times))) - self._begin
        return gone
