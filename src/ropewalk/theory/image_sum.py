"""A force that moves along a taut string in any way: exact, as the time that waves had to come.

A short push at y, after the time s/c, has moved the point x of the string by 1/(2 rho c) times the number of waves
from the push and its images (at y + 2nL with its sign, at -y + 2nL with the other) that have arrived:

    w(x, t) = 1/(2 rho c) integral of f(tau) g dtau,   g = sum over n of H(s - |x - y - 2nL|) - H(s - |x + y - 2nL|),

y = x1(tau), s = c (t - tau). The two sums collapse, for s >= 0, to four steps,

    g = b(c t - x) - b(c t + x),   b(u) = floor((u - c tau + x1)/2L) - floor((u - c tau - x1)/2L),

so that w needs one function of u, and that only the times at which ``c tau +- x1(tau)`` takes the values u - 2kL. A
constant force times these times is the answer; a varying force enters through its integral. Derived here from the
method of images.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ropewalk.theory import _arguments
from ropewalk.theory._course import Given, PiecewiseFunction, course
from ropewalk.theory._wave import FloatArray, wave_speed

__all__ = ["travelling_force"]

FLAT = 1e-13  # change of a phase, over the largest one, that counts as none


def travelling_force(
    x: ArrayLike, t: ArrayLike, *, path: Given, force: Given, length: float, tension: float, mass: float
) -> FloatArray:
    """Return the deflection of a taut string under a force of any course on any path, in m.

    ``x`` (m, 0..length) and ``t`` (s) broadcast and give the shape of the result. ``path`` is the place of the force in
    m, ``force`` its size in N, each a function that takes an array of times, or a table (times, values), linear
    between, or a number. The string is at rest at t = 0, or at the first time of the path's table; the force acts while
    it is on the string, 0..length, and within the times of the tables. It may stop, turn, leave and come back, and pass
    the wave speed; travelling at exactly that speed it carries a jump of the deflection, with the mean at the jump.

    Exact up to rounding: roots of the path against the waves (head of this module), found to rounding. Functions are
    followed to rounding, too, if they have no features narrower than 1/200 of the time. `ValueError` for arguments
    out of range, paths or forces that are not finite, and tables that are none.
    """
    c = wave_speed(tension=tension, mass=mass)
    _arguments.positive(length=length)
    (x,) = _arguments.within(0.0, length, x=x)
    t = np.asarray(t, dtype=np.float64)
    _arguments.finite(t=t)
    end = float(np.max(t, initial=0.0))
    shape = np.broadcast_shapes(x.shape, t.shape)
    if end <= 0.0 and not isinstance(path, tuple):
        return np.zeros(shape)
    place = course("path", path, 0.0, end, scale=length)
    given = course("force", force, min(place.edges[0], 0.0), max(place.edges[-1], end))
    work = given.integral()
    total = np.zeros(shape)
    for sign in (1.0, -1.0):
        for run in _runs(place, given, sign, c, length):
            for side in (-1.0, 1.0):
                total += sign * side * run.passed(c * t + side * x, t, work, 2.0 * length)
    return total / (2.0 * mass * c)


@dataclass(frozen=True)
class _Stretch:
    """Stretch of time, with the force on the string, on which the phase ``c tau + sign x1`` rises, falls or stays."""

    place: PiecewiseFunction
    rate: PiecewiseFunction
    sign: float
    wave_speed: float
    times: FloatArray  # of pieces in which x1 is one polynomial
    phases: FloatArray

    def phase(self, t: FloatArray) -> FloatArray:
        return self.wave_speed * t + self.sign * self.place(t)

    def passed(self, u: FloatArray, until: FloatArray, work: PiecewiseFunction, period: float) -> FloatArray:
        """Integral of f floor((u - phase)/period) over the run, up to the times ``until``, which broadcast to u."""
        end = np.clip(until, self.times[0], self.times[-1])
        begin = work(self.times[:1])[0]
        done = work(end) - begin
        first = (u - self.phases[0]) / period
        if np.ptp(self.phases) <= FLAT * max(np.max(np.abs(self.phases)), period):
            on_jump = np.abs(first - np.rint(first)) < 10.0 * FLAT
            return np.asarray(np.where(on_jump, np.rint(first) - 0.5, np.floor(first)) * done)
        level, last = np.floor(first), np.floor((u - self.phase(end)) / period)
        total = np.asarray(last * done)
        rising = self.phases[-1] > self.phases[0]
        steps, base = (level - last, last) if rising else (last - level, level)
        steps = np.where(until > self.times[0], steps, 0.0)
        end = np.broadcast_to(end, u.shape)
        for step in range(int(np.max(steps, initial=0.0))):
            cross = steps > step
            at = np.minimum(self._time(u[cross] - period * (base[cross] + 1.0 + step)), end[cross])
            total[cross] += (1.0 if rising else -1.0) * (work(at) - begin)
        return total

    def _time(self, target: FloatArray) -> FloatArray:
        """Time at which the phase takes a value: Newton's method between bounds that close in."""
        direction = np.sign(self.phases[-1] - self.phases[0])
        index = np.searchsorted(direction * self.phases, direction * target, side="right") - 1
        index = np.clip(index, 0, len(self.times) - 2)
        low, high = self.times[index], self.times[index + 1]
        span = self.phases[index + 1] - self.phases[index]
        part = np.where(span == 0.0, 0.5, (target - self.phases[index]) / np.where(span == 0.0, 1.0, span))
        at = low + np.clip(part, 0.0, 1.0) * (high - low)
        todo = np.arange(len(at))
        for _ in range(100):
            if not len(todo):
                break
            now = at[todo]
            excess = direction * (self.phase(now) - target[todo])
            low[todo], high[todo] = np.where(excess > 0.0, low[todo], now), np.where(excess > 0.0, now, high[todo])
            slope = direction * (self.wave_speed + self.sign * self.rate(now))
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                new = now - excess / slope
            inside = (new >= low[todo]) & (new <= high[todo])
            at[todo] = np.where(inside, new, 0.5 * (low[todo] + high[todo]))
            todo = todo[np.abs(at[todo] - now) > 1e-15 * self.times[-1]]
        return np.asarray(at)


def _runs(
    place: PiecewiseFunction, given: PiecewiseFunction, sign: float, c: float, length: float
) -> Iterator[_Stretch]:
    """Split the time at edges, at entries and exits and where the phase turns, and join what belongs together."""
    rate = place.rate()
    start, end = max(place.edges[0], given.edges[0]), min(place.edges[-1], given.edges[-1])
    times = np.concatenate(
        [place.edges, place.times_at(0.0), place.times_at(length), rate.times_at(-sign * c), [start, end]]
    )
    times = np.unique(times[(times >= start) & (times <= end)])
    if len(times) < 2 or end <= start:
        return
    phases = c * times + sign * place(times)
    middle = place(0.5 * (times[1:] + times[:-1]))
    change = np.diff(phases)
    kind = np.where(np.abs(change) <= FLAT * np.diff(times) * c, 0.0, np.sign(change))
    kind = np.where((middle >= 0.0) & (middle <= length), kind, np.nan)
    first = 0
    for piece in range(1, len(kind) + 1):
        if piece == len(kind) or kind[piece] != kind[first]:
            if not np.isnan(kind[first]):
                yield _Stretch(place, rate, sign, c, times[first : piece + 1], phases[first : piece + 1])
            first = piece
