"""What wires do alone in a step of small motion: stencils inside, rows of their stiffness next to the ends."""

from __future__ import annotations

from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.wires.bending import REACH
from ropewalk.wires.damping import dissipated


@lean_inner
def _along(now, felt, other, gain, e, low, high, keep, t, b, bed):
    """Put the next position of control points e + low to e + high - 1, all inside, in place of the last."""
    c0, c1, first, last = -2.0 * t - 6.0 * b - bed, t + 4.0 * b, e + low, e + high
    u, out, g = now[first:last], other[first:last], gain[first:last]  # slices let the loop vectorise
    f = felt[first - 2 : last + 2]
    for i in range(last - first):
        pull = c0 * f[i + 2] + c1 * (f[i + 1] + f[i + 3]) - b * (f[i] + f[i + 4])
        out[i] = u[i] + keep * (u[i] - out[i]) + g[i] * pull


@lean_inner
def _along_bare(now, felt, other, g, e, low, high, keep, t, b, bed):
    """The same where all have one gain: a stream of numbers less to read."""
    c0, c1, first, last = -2.0 * t - 6.0 * b - bed, t + 4.0 * b, e + low, e + high
    u, out, f = now[first:last], other[first:last], felt[first - 2 : last + 2]
    for i in range(last - first):
        pull = c0 * f[i + 2] + c1 * (f[i + 1] + f[i + 3]) - b * (f[i] + f[i + 4])
        out[i] = u[i] + keep * (u[i] - out[i]) + g * pull


@inlined
def _relieve(strands, stencil, window, now, other):
    """Take back what wires have pulled too much where others take over a part of their tension."""
    for p in range(stencil.relieved.shape[0]):
        a, first = stencil.relieved[p, 0], strands.first[stencil.relieved[p, 0]]
        low = max(stencil.relieved[p, 1], first + window.low[a])
        high = min(stencil.relieved[p, 2], first + window.high[a])
        for k in range(low, high):
            more = stencil.relief[k - 1] * (now[k] - now[k - 1]) - stencil.relief[k] * (now[k + 1] - now[k])
            other[k] += stencil.gain[k] * more


@lean_inner
def _along_beam(now, felt, other, gain, e, low, high, keep, t, b, bed):
    """The same of a beam of the fourth order: `d4 - d6 / 6`."""
    c0, c1, c2, c3 = -2.0 * t - 28.0 / 3.0 * b - bed, t + 6.5 * b, -2.0 * b, b / 6.0
    first, last = e + low, e + high
    u, out, g, f = now[first:last], other[first:last], gain[first:last], felt[first - 3 : last + 3]
    for i in range(last - first):
        pull = c0 * f[i + 3] + c1 * (f[i + 2] + f[i + 4]) + c2 * (f[i + 1] + f[i + 5]) + c3 * (f[i] + f[i + 6])
        out[i] = u[i] + keep * (u[i] - out[i]) + g[i] * pull


@inlined
def _end(now, felt, other, gain, e, d, keep, keep_end, rows, edge):
    """The same for the control point e at an end, and for its neighbours e + d, e + 2 d ..., `edge` in all."""
    for k in range(edge):
        i, pull = e + k * d, 0.0
        for j in range(edge + REACH):
            pull -= rows[k, j] * felt[e + j * d]
        other[i] = now[i] + (keep_end if k == 0 else keep) * (now[i] - other[i]) + gain[i] * pull


@inlined
def move(strands, stencil, window, now, other, buffers, dt):
    """Let the wires go on for a step."""
    gain = stencil.gain
    for a in range(strands.first.size):
        i, n, h, keep = strands.first[a], strands.links[a], strands.h[a], stencil.keep[a]
        low, high, late = window.low[a], window.high[a], strands.retardation[a] / dt
        if low >= high:
            continue
        t, b, bed, edge = strands.tension[a] / h, stencil.bent[a] / (h * h * h), strands.bed[a] * h, stencil.edge[a]
        begin, end, felt = max(low, edge), min(high, n + 1 - edge), now
        if late > 0.0:
            felt = buffers
            for k in range(i + max(min(low, n + 1 - edge) - REACH, 0), i + min(max(high, edge) + REACH, n + 1)):
                buffers[k] = now[k] + late * (now[k] - other[k])
        bare = stencil.bare[a]
        if strands.fourth[a]:
            _along_beam(now, felt, other, gain, i, begin, end, keep, t, b, bed)
        elif bare > 0.0:
            for k in range(window.laden[a, 0], window.laden[a, 1]):
                stencil.saved[k] = other[stencil.laden[k]]
            _along_bare(now, felt, other, bare, i, begin, end, keep, t, b, bed)
            for k in range(window.laden[a, 0], window.laden[a, 1]):
                e = stencil.laden[k]
                drift = now[e] + keep * (now[e] - stencil.saved[k])
                other[e] = drift + gain[e] / bare * (other[e] - drift)
        else:
            _along(now, felt, other, gain, i, begin, end, keep, t, b, bed)
        if low < edge:
            _end(now, felt, other, gain, i, 1, keep, stencil.keep_end[2 * a], stencil.rows[2 * a], edge)
        if high > n + 1 - edge:
            _end(now, felt, other, gain, i + n, -1, keep, stencil.keep_end[2 * a + 1], stencil.rows[2 * a + 1], edge)
    _relieve(strands, stencil, window, now, other)


@lean_inner
def _beam_retarded(now, after, felt, part, rows_at_start, rows_at_end, low, high, edge, t, b, bed):
    """D' K V of a beam of the fourth order, D and V twice its velocities: see `dissipated`."""
    n, lost = now.size - 1, 0.0
    c0, c1, c2, c3 = 2.0 * t + 28.0 / 3.0 * b + bed, -t - 6.5 * b, 2.0 * b, -b / 6.0
    for i in range(low, high):
        if i < edge or i > n - edge:
            first, d, k, rows = (0, 1, i, rows_at_start) if i < edge else (n, -1, n - i, rows_at_end)
            pull = 0.0
            for j in range(edge + REACH):
                e = first + j * d
                pull += rows[k, j] * (part * (felt[e] - now[e]) + after[e] - now[e])
        else:
            pull = c0 * (part * (felt[i] - now[i]) + after[i] - now[i])
            for d, c in ((1, c1), (2, c2), (3, c3)):
                for e in (i - d, i + d):
                    pull += c * (part * (felt[e] - now[e]) + after[e] - now[e])
        lost += part * (felt[i] - now[i]) * pull
    return lost


@lean_inner
def losses(strands, stencil, window, now, other, buffers, dt):
    """What all wires lose in a step from the one to the other, J; `buffers` is what they have felt."""
    lost = 0.0
    for a in range(strands.first.size):
        i, low, high, h, late = strands.first[a], window.low[a], window.high[a], strands.h[a], strands.retardation[a]
        if low >= high or (strands.drag[a] == 0.0 and late == 0.0):
            continue
        end, retarded = min(high, strands.links[a] + 1), late
        part, whole = slice(i + low, i + end), slice(i, i + strands.links[a] + 1)
        t, b, bed = strands.tension[a] / h, stencil.bent[a] / (h * h * h), strands.bed[a] * h
        scale = dt / late if late > 0.0 else 1.0
        felt = buffers if late > 0.0 else other
        if strands.fourth[a] and late > 0.0:
            retarded = 0.0
            lost += 0.5 * late * _beam_retarded(
                now[whole], other[whole], felt[whole], scale, stencil.rows[2 * a], stencil.rows[2 * a + 1], low, end,
                stencil.edge[a], t, b, bed,
            )  # fmt: skip
        lost += dissipated(
            now[part], other[part], felt[part], scale, stencil.mass[part], strands.drag[a], retarded, t, b, bed,
            low == 0 and strands.clamped[a, 0], high > strands.links[a] and strands.clamped[a, 1],
        )  # fmt: skip
    return lost / dt
