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
from ropewalk.linear.series import wave_numbers_and_rates
from ropewalk.mechanics.chain import Array
from ropewalk.solve.modal import Complex

# Phase by which a force and a mode come apart in the whole run; below it they are in resonance.
_CLOSE = 1e-4
_EVEN = 1e-12  # of the time: instants that are as close to even ones are even


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
        z, pushed = (np.zeros((times.size, self._rate.size), dtype=np.complex128) for _ in range(2))
        for V in np.unique(self.speed):
            found = self._of_speed(float(V), times)
            z, pushed = z + found[0], pushed + found[1]
        self._seen = times, z.real.copy(), (self._rate * z + pushed).real.copy()
        return self._seen[1:]

    def _of_speed(self, V: float, times: Array) -> tuple[Complex, Complex]:
        """Coordinates under the forces of one speed in m/s, and what these add to their rates."""
        mine = np.flatnonzero((self.speed == V) & (self._comes < self._goes))
        comes, goes = self._comes[mine], self._goes[mine]
        events = np.unique(np.concatenate([[0.0], comes, goes]))
        begin = events[events <= times[-1]]
        on = (comes <= begin[:, None]) & (begin[:, None] < goes)
        phases = np.exp(1j * np.outer(self.begin[mine], self.k)) * self._force[mine, None]
        P = on.astype(np.float64).astype(np.complex128) @ phases  # (stretch, mode)
        w: Complex = np.asarray(1j * V * self.k, dtype=np.complex128)
        r, d = self._rate, self._driven / 2j
        close = [np.flatnonzero(np.abs(turn - r) * max(float(times[-1]), 1e-300) < _CLOSE) for turn in (w, -w)]
        ahead, back = d / _without(w - r, close[0]), d / _without(w + r, close[1])
        ahead[close[0]] = back[close[1]] = 0.0

        def driven(y: Complex) -> Complex:
            """The part that follows forces of the phases y."""
            return np.asarray(ahead * y + back * y.conj())

        def resonant(y: Complex, decay: Complex, t: Array) -> Complex:
            """The part in resonance at times after stretches have begun with the phases y, decayed since."""
            out = np.zeros_like(y)
            for j, turn, sign, phase in ((close[0], w, 1.0, y), (close[1], -w, -1.0, y.conj())):
                apart = (turn - r)[j] * t[:, None]
                some = np.where(apart == 0.0, 1.0, apart)
                mean = np.where(apart == 0.0, 1.0, np.expm1(some) / some)
                out[:, j] += sign * d[j] * phase[:, j] * decay[:, j] * t[:, None] * mean
            return out

        y = P * np.exp(np.outer(begin, w))
        length = np.diff(begin)
        decay = np.exp(np.outer(length, r))
        added = driven(P[:-1] * np.exp(np.outer(begin[1:], w))) - decay * driven(y[:-1])
        added += resonant(y[:-1], decay, length)
        C = np.zeros_like(y)
        for i, (kept, more) in enumerate(zip(decay, added, strict=True)):
            C[i + 1] = kept * C[i] + more
        C -= driven(y)
        # All instants at once: each in the stretch that it lies in, and decayed since the first instant there.
        at = np.searchsorted(begin, times, side="right") - 1
        first = np.searchsorted(times, begin, side="left")
        since = first[at]
        late = np.minimum(first, times.size - 1)
        at_first = np.exp(np.outer(np.maximum(times[late] - begin, 0.0), r))
        turned = P[at] * _powers(w, times)
        if not any(j.size for j in close):
            return _decayed(C * at_first, at, since, r, times) + driven(turned), 2j * d * turned.imag
        gone = _decayed(at_first, at, since, r, times)
        z = C[at] * gone + driven(turned) + resonant(y[at], gone, times - begin[at])
        return z, 2j * d * turned.imag

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


def _without(values: Complex, which: NDArray[np.intp]) -> Complex:
    """The same with ones where they are not divided by."""
    out = values.copy()
    out[which] = 1.0
    return out


def _decayed(C: Complex, at: NDArray[np.intp], since: NDArray[np.intp], rate: Complex, times: Array) -> Complex:
    """C (stretch, mode) of the stretch of each instant, decayed since the first instant there."""
    h = _interval(times)
    late = np.arange(times.size) - since
    if h is None:
        return np.asarray(C[at] * np.exp((times - times[since])[:, None] * rate))
    out = np.asarray(C[at] * _powers(rate, h * np.arange(late.max() + 1.0))[late])
    if times[-1] != h * (times.size - 1):
        out[-1] = C[at[-1]] * np.exp((times[-1] - times[since[-1]]) * rate)
    return out


def _powers(rate: Complex, times: Array) -> Complex:
    """exp(rate t), (instant, mode): of even instants by products."""
    h = _interval(times)
    if h is None or times.size < 64:
        return np.asarray(np.exp(np.outer(times, rate)))
    size = int(np.sqrt(times.size)) + 1
    fine = np.exp(np.outer(h * np.arange(size), rate))
    coarse = np.exp(np.outer(h * size * np.arange(-(-times.size // size)), rate))
    out = (coarse[:, None] * fine).reshape(-1, rate.size)[: times.size]
    if times[-1] != h * (times.size - 1):
        out[-1] = np.exp(rate * times[-1])
    return np.asarray(out)


def _interval(times: Array) -> float | None:
    """What all instants from 0 but maybe the last are multiples of, s; None if they are not even."""
    if times.size < 3 or times[0] != 0.0:
        return None
    h = float(times[1])
    even = np.abs(times[:-1] - h * np.arange(times.size - 1.0)) <= _EVEN * times[-1]
    return h if even.all() else None
