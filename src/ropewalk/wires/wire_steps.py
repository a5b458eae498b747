"""How wires go on for a step by what pulls along and across them, in large motion; and what they lose."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.wires.damping import dissipated

# Strain up to which tension over length follows from a series: its error is 1e-11 of the tension there.
SMALL_STRAIN = 5e-3


@lean_inner
def _stretch(x, y, z, rest, pull, out, first, n, small):
    """Tension over length of the links of a wire."""
    a, c = x[first : first + n + 1], z[first : first + n + 1]  # slices let the loops vectorise
    d, e, q = rest[first : first + n], pull[first : first + n], out[first : first + n]
    if y is not None:
        b = y[first : first + n + 1]
    if small:
        for i in range(n):
            square = (a[i + 1] - a[i]) ** 2 + (c[i + 1] - c[i]) ** 2
            if y is not None:
                square += (b[i + 1] - b[i]) ** 2
            E = 0.5 * (square * d[i] - 1.0)
            q[i] = e[i] * E * (1.0 - E * (1.5 - E * (2.5 - E * (4.375 - E * 7.875))))  # 1 - (1 + 2 E)^(-1/2)
        return
    for i in range(n):
        square = (a[i + 1] - a[i]) ** 2 + (c[i + 1] - c[i]) ** 2
        if y is not None:
            square += (b[i + 1] - b[i]) ** 2
        q[i] = e[i] * (1.0 - 1.0 / np.sqrt(square * d[i]))


@lean_inner
def _axial(now, other, q, gain, first, n, keep):
    """Put the next x of the inner nodes, two away from the ends, in place of the last; without bending stiffness."""
    u, k = now[first + 1 : first + n], q[first + 1 : first + n - 1]  # slices let the loops vectorise
    out, g = other[first + 2 : first + n - 1], gain[first + 2 : first + n - 1]
    for i in range(n - 3):
        pull = k[i + 1] * (u[i + 2] - u[i + 1]) - k[i] * (u[i + 1] - u[i])
        out[i] = u[i + 1] + keep * (u[i + 1] - out[i]) + g[i] * pull


@lean_inner
def _along(now, other, felt, q, gain, first, n, keep, b, t, falls, bed, level):
    """Put the next positions of the inner nodes, two away from the ends, in place of the last; one component."""
    u, k = now[first : first + n + 1], q[first : first + n]  # slices let the loops vectorise
    out, g = other[first + 2 : first + n - 1], gain[first + 2 : first + n - 1]
    fall = falls[first + 2 : first + n - 1]
    if felt is None:
        for i in range(n - 3):
            pull = k[i + 2] * (u[i + 3] - u[i + 2]) - k[i + 1] * (u[i + 2] - u[i + 1])
            pull -= b * (u[i] + u[i + 4] - 4.0 * (u[i + 1] + u[i + 3]) + 6.0 * u[i + 2])
            out[i] = u[i + 2] + keep * (u[i + 2] - out[i]) + g[i] * pull + fall[i]
        return
    f, base = felt[first : first + n + 1], level[first + 2 : first + n - 1]
    for i in range(n - 3):
        pull = k[i + 2] * (u[i + 3] - u[i + 2]) - k[i + 1] * (u[i + 2] - u[i + 1]) - bed * (u[i + 2] - base[i])
        pull -= b * (f[i] + f[i + 4] - 4.0 * (f[i + 1] + f[i + 3]) + 6.0 * f[i + 2])
        pull += t * ((f[i + 1] - u[i + 1]) - 2.0 * (f[i + 2] - u[i + 2]) + (f[i + 3] - u[i + 3]))
        out[i] = u[i + 2] + keep * (u[i + 2] - out[i]) + g[i] * pull + fall[i]


@inlined
def _end(now, other, felt, ql, qi, gain, e, d, keep, keep_end, b, t, fall, bed, level, clamped, slope):
    """The same for the node e at an end, and for its neighbour e + d.

    Args:
        ql, qi: tension over length of the first link and of the second.
        slope: difference of nodes that a clamped end asks for.
    """
    i = e + d
    m0 = 2.0 * (felt[i] - felt[e] - slope) if clamped else 0.0
    m1 = felt[e] - 2.0 * felt[i] + felt[i + d]
    m2 = felt[i] - 2.0 * felt[i + d] + felt[i + 2 * d]
    late = t * ((felt[i] - now[i]) - (felt[e] - now[e]))
    late_next = t * ((felt[i + d] - now[i + d]) - (felt[i] - now[i]))
    pull = qi * (now[i + d] - now[i]) - ql * (now[i] - now[e]) - b * (m0 - 2.0 * m1 + m2) - bed * (now[i] - level[i])
    pull += late_next - late
    other[i] = now[i] + keep * (now[i] - other[i]) + gain[i] * pull + fall[i]
    pull = ql * (now[i] - now[e]) - b * (m1 - m0) - 0.5 * bed * (now[e] - level[e]) + late
    other[e] = now[e] + keep_end * (now[e] - other[e]) + gain[e] * pull + fall[e]


@inlined
def move_wires(strands, threads, window, now, other, buffers, q, level, slope, small, dt):
    """Let the wires go on for a step."""
    axes, up = now.shape[0], now.shape[0] - 1
    for a in range(strands.first.size):
        low, high, links = window.low[a], window.high[a], strands.links[a]
        if low >= high:
            continue
        i, h, keep = strands.first[a] + max(low - 2, 0), strands.h[a], threads.keep[a]
        n = strands.first[a] + min(high + 1, links) - i  # links that count, from node i on
        late, b, bed = strands.retardation[a] / dt, 0.0, strands.bed[a] * h
        if axes == 2:
            _stretch(now[0], None, now[1], threads.rest, threads.pull, q, i, n, small)
        else:
            _stretch(now[0], now[1], now[up], threads.rest, threads.pull, q, i, n, small)
        t = strands.tension[a] / h if late > 0.0 else 0.0
        for c in range(axes):
            gain, fall = threads.gain[c], threads.fall[c]
            k, felt = bed if c == up else 0.0, now[c]
            b = (strands.stiffness[a] if c == 0 else threads.bending[a]) / (h * h * h)  # waves along are not corrected
            if late > 0.0:
                felt = buffers
                for j in range(i, i + n + 1):
                    buffers[j] = now[c, j] + late * (now[c, j] - other[c, j])
            if c == 0 and b == 0.0 and late == 0.0:
                _axial(now[c], other[c], q, gain, i, n, keep)
            elif late > 0.0 or k > 0.0:
                _along(now[c], other[c], felt, q, gain, i, n, keep, b, t, fall, k, level)
            else:
                _along(now[c], other[c], None, q, gain, i, n, keep, b, t, fall, k, None)
            for side in range(2):
                if (low if side == 0 else links - high + 1) > 1:
                    continue
                e, d = (i, 1) if side == 0 else (i + n, -1)
                ql, qi = (q[e], q[e + 1]) if side == 0 else (q[e - 1], q[e - 2])
                _end(now[c], other[c], felt, ql, qi, gain, e, d, keep, threads.keep_end[2 * a + side], b, t, fall, k,
                     level, strands.clamped[a, side], slope[2 * a + side, c])  # fmt: skip


@lean_inner
def lost_in_wires(strands, threads, window, now, other, dt):
    """What all wires lose while they move from the other to the one in dt, by time, W."""
    lost = 0.0
    for a in range(strands.first.size):
        low, high = window.low[a], window.high[a]
        h, part = strands.h[a], slice(strands.first[a] + low, strands.first[a] + high)
        if low >= high or (strands.drag[a] == 0.0 and strands.retardation[a] == 0.0):
            continue
        for c in range(now.shape[0]):
            lost += dissipated(
                other[c, part], now[c, part], now[c, part], 1.0, threads.mass[c, part], strands.drag[a],
                strands.retardation[a], strands.tension[a] / h,
                (strands.stiffness[a] if c == 0 else threads.bending[a]) / (h * h * h), 0.0,
                low == 0 and strands.clamped[a, 0], high > strands.links[a] and strands.clamped[a, 1],
            )  # fmt: skip
    return lost / (dt * dt)


@lean_inner
def are_strains_small(strands, threads, window, now):
    """Whether the strains of all that moves are small."""
    most = 0.0
    for a in range(strands.first.size):
        first = strands.first[a]
        for i in range(first + window.low[a], first + window.high[a] - 1):
            square = 0.0
            for c in range(now.shape[0]):
                square += (now[c, i + 1] - now[c, i]) ** 2
            most = max(most, abs(np.sqrt(square * threads.rest[i]) - 1.0))
    return most < 0.5 * SMALL_STRAIN
