"""The passage of forces of one speed over the modes of a line, instant by instant; for the formulas see `steady.py`.

This kernel calls none of other files and takes no constants of theirs: its own file says all that it comes of.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.compiled import inlined, lean
from ropewalk.solve.modal import Complex

# Phase by which a force and a mode come apart in the whole run; below it they are in resonance.
_CLOSE = 1e-4
_EVEN = 1e-12  # of the time: instants that are as close to even ones are even
_AFRESH = 256  # instants after which no more is built on the one before


@inlined
def _mean(x: complex) -> complex:
    """(exp(x) - 1) / x, of an x much smaller than one."""
    return 1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0))


@lean
def passage(
    times: Array, events: Array, comes: Array, goes: Array, phases: Complex, V: float, k: Array, rate: Complex,
    driven: Complex, z: Array, rates: Array,
) -> None:  # fmt: skip
    """Add the coordinates of the modes and their rates under forces of one speed.

    Args:
        times: (instant,) s, rising from 0.
        events: (stretch,) s, where forces come and go, from 0 and up to the last instant.
        comes, goes: (force,) s.
        phases: (mode, force) F exp(i k x) at time 0.
        V: m/s.
        k, rate, driven: (mode,), see `series.py`.
        z, rates: (mode, instant) that are added to.
    """
    last, h = times[-1], times[1] - times[0] if times.size > 1 else 0.0
    for m in range(k.size):
        r, w, d = rate[m], 1j * (V * k[m]), driven[m] / 2j
        is_ahead, is_back = abs(w - r) * last < _CLOSE, abs(w + r) * last < _CLOSE  # in resonance
        ahead, back = 0j, 0j
        if not is_ahead:
            ahead = d / (w - r)
        if not is_back:
            back = d / (w + r)
        # What follows the forces, and its rate: the real parts of one factor times their phases.
        follows = ahead + back.conjugate()
        faster = r * ahead + (r * back).conjugate() - 1j * driven[m].real
        free_step, step = np.exp(r * h), np.exp(w * h)
        C, P, y, begin, i = 0j, 0j, 0j, 0.0, 0
        for s in range(events.size):
            since = events[s] - begin
            gone = np.exp(r * since)
            C *= gone
            if is_ahead:
                C += d * y * gone * since * _mean((w - r) * since)
            if is_back:
                C -= d * y.conjugate() * gone * since * _mean(-(w + r) * since)
            begin, before, P = events[s], P, 0j
            for j in range(comes.size):
                if comes[j] <= begin < goes[j]:
                    P += phases[m, j]
            # All goes on smoothly where forces come and go: the free part jumps by as much as the driven one.
            turn = np.exp(w * begin)
            jump = (P - before) * turn
            C -= ahead * jump + back * jump.conjugate()
            y = P * turn
            end = events[s + 1] if s + 1 < events.size else np.inf
            first, n, free, turned = 0.0, 0, 0j, 0j
            while i < times.size and times[i] < end:
                t = times[i]
                if 0 < n < _AFRESH and abs(t - (first + n * h)) <= _EVEN * last:
                    free, turned = free * free_step, turned * step
                else:
                    free, turned = C * np.exp(r * (t - begin)), P * np.exp(w * t)
                    first, n = t, 0
                own = free
                if is_ahead or is_back:
                    since = t - begin
                    gone = np.exp(r * since) * since
                    if is_ahead:
                        own += d * y * gone * _mean((w - r) * since)
                    if is_back:
                        own -= d * y.conjugate() * gone * _mean(-(w + r) * since)
                z[m, i] += (follows * turned).real + own.real
                rates[m, i] += (faster * turned).real + (r * own).real
                n += 1
                i += 1
