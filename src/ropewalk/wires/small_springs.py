"""What ties do in small motion: vertical springs about rest that slacken, and may fail."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import inlined
from ropewalk.wires.moving_loads import DAMPED
from ropewalk.wires.spline import WIDTH

_WIDTH = np.uint64(WIDTH)
_SHARES = tuple(np.uint64(k) for k in range(WIDTH))


@inlined
def _stored(springs, e, apart):
    """Energy that spring e loses as it fails, beside what it had stored at rest, J; `energy.py` counts it so."""
    N, pull = springs.rest[e] + springs.pull[e] * springs.way[e] * apart, springs.pull[e]
    k = 1.0 / pull if N > 0.0 else springs.push[e] / (pull * pull)
    return 0.5 * (k * N * N + springs.across[e] * apart * apart)


@inlined
def add_spring_forces(springs, window, now, other, gain, stepping, record, row, step, t):
    """What ties do during a step, which begins at t in s."""
    dt = stepping.step
    one, two, weight, rest, pull = springs.one, springs.other, springs.weight, springs.rest, springs.pull
    push, across, damping, way, last = springs.push, springs.across, springs.damping, springs.way, springs.last
    nodes, failed = springs.nodes, springs.failed
    for e in range(window.springs[0], window.springs[1]):
        i, j, c = np.uint64(one[e]), np.uint64(two[e]), damping[e]  # unsigned: no look at what is before an array
        m, n = nodes[e, 0], nodes[e, 1]
        apart = 0.0
        if m < 0:
            for k in _SHARES:
                apart += weight[e, k] * now[i + k] + weight[e, k + _WIDTH] * now[j + k]
        else:
            apart = now[n] - now[m] if n != m else -now[m]
        loss, whole, was = 0.0, failed[e, 0] == np.inf, last[e]
        last[e] = apart
        if c > 0.0 and whole:
            rate = (apart - was) / dt
            loss = c * rate
            stepping.work[DAMPED] += 0.5 * c * way[e] * way[e] * springs.rate[e] * (springs.rate[e] + rate) * dt
            springs.rate[e] = rate
        F = across[e] * apart if whole else 0.0
        if pull[e] > 0.0:
            N = rest[e] + pull[e] * way[e] * apart
            if N > 0.0:
                N += way[e] * loss
            else:
                N *= push[e] / pull[e]
                springs.rate[e] = 0.0
            if whole and (springs.strength[e] < N or t >= springs.fails_at[e]):
                failed[e, 0], failed[e, 1], whole, F = t, N, False, 0.0
                stepping.work[DAMPED] += 0.5 * (_stored(springs, e, apart) + _stored(springs, e, was))
            if not whole:
                N = 0.0
            before = rest[e] if rest[e] > 0.0 else rest[e] * push[e] / pull[e]
            F += way[e] * (N - before)
            if step == 0:
                record.tie[springs.number[e], row] = N - max(rest[e], 0.0)
        if m >= 0:
            other[m] += gain[m] * F
            if n != m:
                other[n] -= gain[n] * F
            continue
        for k in _SHARES:
            other[i + k] -= gain[i + k] * weight[e, k] * F
            other[j + k] -= gain[j + k] * weight[e, k + _WIDTH] * F
