"""Forces of constant size at constant speeds along one line in the linear theory: its sine modes, exact in time.

Between two instants at which a force comes or goes every mode answers to harmonic forces,

    z' = r z + d sum_j F_j sin(k x_j(t)),   x_j = x_j(0) + V_j t,

of which forces of one speed make one: their phases add up to P = sum_j F_j exp(i k x_j(0)) over those on the line, and

    z = C exp(r (t - t0)) + d / 2i (P exp(w t) / (w - r) + P* exp(-w t) / (w + r)),   w = i k V,

with a constant C that follows from one stretch to the next. So a train costs little more than one of its axles, and an
instant as much as two harmonics. Where a harmonic is in resonance with an undamped mode both parts grow without
bounds, and their difference is taken.
L. Fryba, Vibration of Solids and Structures under Moving Loads (1999), chapter 1; for trains chapter 9.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ropewalk.linear.chord import Chord
from ropewalk.linear.passage import passage
from ropewalk.linear.series import wave_numbers_and_rates
from ropewalk.mechanics.chain import Array


class SteadyForces:
    """Deflections of a line at rest at first.

    Args:
        chord: the line.
        begin: (force,) m, where they are at time 0, also beside the line.
        speed: (force,) m/s.
        force: (force,) N, across the line.
        modes: how many; None: until those left out are a millionth.

    Raises:
        RopewalkError: too many would be needed.
    """

    def __init__(self, chord: Chord, begin: Array, speed: Array, force: Array, modes: int | None) -> None:
        self.begin, self.speed = begin, speed
        self._chord, self._force = chord, force
        self.k, self._rate, self._driven = wave_numbers_and_rates(chord, modes)
        self._amplitude = 2.0 / (chord.mass * chord.length)
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.sort((np.array([[0.0], [chord.length]]) - begin) / speed, axis=0)
        inside = (begin >= 0.0) & (begin <= chord.length)
        still = speed == 0.0
        self._comes = np.where(still, np.where(inside, 0.0, np.inf), np.maximum(ends[0], 0.0))
        self._goes = np.where(still, np.inf, ends[1])
        self._seen: tuple[Array, Array, Array] | None = None

    def shape(self, x: Array) -> Array:
        """(mode, place) deflections in m at places in m for each unit of a coordinate."""
        return np.asarray(self._amplitude * np.sin(np.outer(self.k, x)))

    def coordinates(self, times: Array) -> tuple[Array, Array]:
        """Coordinates of the modes (instant, mode) and their rates at rising times in s, from 0; the last ones stay."""
        if self._seen is not None and self._seen[0] is times:
            return self._seen[1:]
        z, rates = (np.zeros((self._rate.size, times.size)) for _ in range(2))
        for V in sorted(set(self.speed.tolist())):
            mine = np.flatnonzero((self.speed == V) & (self._comes < self._goes))
            comes, goes = self._comes[mine], self._goes[mine]
            events = np.unique(np.concatenate([[0.0], comes, goes]))
            events = events[events <= times[-1]]
            phases = np.exp(1j * np.outer(self.k, self.begin[mine])) * self._force[mine]
            passage(times, events, comes, goes, phases, V, self.k, self._rate, self._driven, z, rates)
        self._seen = times, z.T, rates.T
        return self._seen[1:]

    def motion(self, x: Array, times: Array) -> tuple[Array, Array]:
        """Deflections and their rates (instant, place) at places in m along the line, m and m/s."""
        z, rates = self.coordinates(times)
        shape = self.shape(x)
        return z @ shape, rates @ shape

    def under(self, times: Array, rows: slice, which: NDArray[np.bool_]) -> tuple[Array, Array]:
        """Deflections in m and slopes (instant, force) under forces; zero where they are not asked for.

        Args:
            times: (instant,) s, rising from 0.
            rows: those of them that are meant.
            which: (instant, force) where they are asked for.
        """
        z, times = self.coordinates(times)[0][rows], times[rows]
        out = np.zeros((2, *which.shape))
        i, j = np.nonzero(which)
        x = np.clip(self.begin[j] + self.speed[j] * times[i], 0.0, self._chord.length)
        turned, a = np.outer(x, self.k), self._amplitude * z[i]
        out[0, i, j] = (np.sin(turned) * a).sum(axis=1)
        out[1, i, j] = (np.cos(turned) * a * self.k).sum(axis=1)
        return out[0], out[1]
