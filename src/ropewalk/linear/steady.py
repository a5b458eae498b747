"""Forces of constant size at constant speeds along one line in the linear theory: its sine modes, exact in time.

Between two instants at which a force comes or goes every mode answers to harmonic forces,

    z' = r z + d sum_j F_j sin(k x_j(t)),   x_j = x_j(0) + V_j t,

of which forces of one speed make one: their phases add up. So a train costs little more than one of its axles.
L. Fryba, Vibration of Solids and Structures under Moving Loads (1999), chapter 1; for trains chapter 9.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ropewalk.linear.chord import Chord
from ropewalk.linear.series import wave_numbers_and_rates
from ropewalk.mechanics.chain import Array
from ropewalk.solve.modal import Complex


class SteadyForces:
    """Deflections of a line at rest at first.

    Args:
        chord: the line.
        names: (force,) their numbers.
        begin: (force,) m, where they are at time 0, also beside the line.
        speed: (force,) m/s.
        force: (force,) N, across the line.
        modes: how many; None: until those left out are a millionth.

    Raises:
        RopewalkError: too many would be needed.
    """

    def __init__(
        self, chord: Chord, names: Sequence[int], begin: Array, speed: Array, force: Array, modes: int | None
    ) -> None:
        self._chord, self._begin, self._speed, self._force = chord, begin, speed, force
        self.k, self._rate, self._driven = wave_numbers_and_rates(chord, modes)
        self._shape = 2.0 / (chord.mass * chord.length)
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.sort((np.array([[0.0], [chord.length]]) - begin) / speed, axis=0)
        inside = (begin >= 0.0) & (begin <= chord.length)
        still = speed == 0.0
        self._comes = np.where(still, np.where(inside, 0.0, np.inf), np.maximum(ends[0], 0.0))
        self._goes = np.where(still, np.inf, ends[1])
        self._way = {k: (float(x), float(V)) for k, x, V in zip(names, begin, speed, strict=True)}
        self._seen: dict[float, tuple[Complex, Complex]] = {}

    def place(self, name: int, t: float) -> float:
        """Where a force is at an instant in s, m."""
        begin, speed = self._way[name]
        return begin + speed * t

    def coordinates(self, times: Array) -> tuple[Complex, Complex]:
        """Coordinates of the modes (instant, mode) and their rates at rising times in s, from 0."""
        events = np.concatenate([[0.0], self._comes, self._goes, times[-1:]])
        events = np.unique(events[(events >= 0.0) & (events <= times[-1])])
        z = np.zeros(self._rate.size, dtype=np.complex128)
        out, rates = (np.zeros((times.size, self._rate.size), dtype=np.complex128) for _ in range(2))
        for begin, end in zip(events, [*events[1:], np.inf], strict=True):
            middle = 0.5 * (begin + end) if np.isfinite(end) else begin
            on = np.flatnonzero((self._comes <= middle) & (middle < self._goes))
            here = np.flatnonzero((times >= begin) & (times < end))
            asked = np.concatenate([times[here], [end] if np.isfinite(end) else []]) - begin
            found = np.exp(self._rate * asked[:, None]) * z
            pushed = np.zeros_like(found)
            for V in np.unique(self._speed[on]):
                mine = on[self._speed[on] == V]
                place = self._begin[mine] + V * begin
                phases = np.exp(1j * np.outer(self.k, place)) @ self._force[mine]
                w = 1j * self.k * V
                forward, back = (self._answer(turn, asked) for turn in (w, -w))
                found = found + self._driven * (phases * forward - phases.conj() * back) / 2j
                pushed = pushed + self._driven * (phases * np.exp(w * asked[:, None])).imag
            out[here], rates[here] = found[: here.size], (self._rate * found + pushed)[: here.size]
            z = found[-1] if np.isfinite(end) else z
        return out, rates

    def _answer(self, turn: Complex, t: Array) -> Complex:
        """Integral over s from 0 to t of exp(rate (t - s)) exp(turn s), (instant, mode) s, at resonance, too."""
        own, apart = self._rate * t[:, None], (turn - self._rate) * t[:, None]
        near = np.abs(apart) < 1.0
        some = np.where(near & (apart != 0.0), apart, 1.0)
        close = np.exp(own) * t[:, None] * np.where(apart == 0.0, 1.0, np.expm1(some) / some)
        far = (np.exp(turn * t[:, None]) - np.exp(own)) / np.where(near, 1.0, turn - self._rate)
        return np.asarray(np.where(near, close, far))

    def motion(self, x: Array, times: Array) -> tuple[Array, Array]:
        """Deflections and their rates (instant, place) at places in m along the line, m and m/s."""
        z, rates = self.coordinates(times)
        self._seen = {float(t): (z[i], rates[i]) for i, t in enumerate(times)}
        shape = self._shape * np.sin(np.outer(self.k, x))
        return z.real @ shape, rates.real @ shape

    def at(self, x: Array, t: float) -> tuple[Array, Array]:
        """Deflections in m and slopes (place,) at an instant of `motion` in s."""
        a = self._shape * self._seen[t][0].real
        turned = np.outer(x, self.k)
        return np.sin(turned) @ a, np.cos(turned) @ (a * self.k)
