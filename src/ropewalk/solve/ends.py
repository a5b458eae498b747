"""Ends of lines in motion, where supports yield or move: their arrays, and their kicks and drifts.

An end that yields is a node of the mass m = rho h / 2 + that of its support, which moves in the free directions only.
A kick solves, at fixed positions and for its whole length,

    m w' = pull of the link + share of the loads + weight + constant force + K (p + u - r) - C (w - u')

exactly, one principal direction of C after the other. In terms of the positions alone that is the method of central
differences with the mass m (x/2) coth(x/2) >= m, where x = c dt / m: however strong a dashpot is, the stable step stays
what it is without. An end that moves as prescribed stands at p + u(t) and carries half a link (docs/notes/supports.md).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.chain import (
    LINE_DAMPING,
    LOAD_WORK,
    SHARED,
    SUPPORT_WORK,
    Array,
    ChainState,
    Integers,
    Strands,
    Supports,
)
from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.mechanics.moving_contact import _entry, force_at, location_of, look_up

# Exponent of the strongest decay within a drift: the audit divides by what is left, which must not vanish.
STRONGEST = 30.0

# The velocity of a table is taken this part of a step before its end: at a corner that of the side which is left.
INSIDE = 1e-6


class Ends(NamedTuple):
    """The ends that yield or move, one entry for each, and room for what they do in a step."""

    number: Integers  # among all ends, see Supports
    strand: Integers
    node: Integers
    link: Integers  # the only one that pulls at the end
    sign: Array  # of its force vector: 1 at the start of a line, -1 at its end
    half: Array  # kg, half a link
    mass: Array  # kg, with that of the support
    place: Array  # (end, axis) m
    free: Integers  # number of directions in which the end may move; 0: it moves as prescribed
    direction: Array  # (end, direction, axis) principal directions of the damping within the free ones
    damping: Array  # (end, direction) N s/m
    stiffness: Array  # (end, axis, axis) N/m
    force: Array  # (end, axis) N, constant, with the weight of the support's mass
    motion_first: Integers
    motion_count: Integers
    motion_time: Array
    motion_value: Array  # (axis, entry) m
    drive: Array  # (axis, end) m/s, velocity of the table
    share: Array  # (axis, end) N, of the loads that stand on the link
    total: Array  # (axis, end) N, force
    kicked: Array  # (axis, end) m/s, velocity after the last kick, before a drift with drag


def ends_of(strands: Strands, supports: Supports) -> Ends | None:
    """What a motion needs to know of the ends that yield or move; None if all are held."""
    which = np.flatnonzero(supports.free.any(axis=(1, 2)) | (supports.motion_count > 1))
    if not which.size:
        return None
    s, at_end, dim = which // 2, which % 2, supports.place.shape[1]
    half = 0.5 * strands.rho[s] * strands.h[s]
    free = np.zeros(which.size, dtype=np.int64)
    direction, damping = np.zeros((which.size, dim, dim)), np.zeros((which.size, dim))
    for e, number in enumerate(which):
        sizes, axes = np.linalg.eigh(supports.free[number])
        axes = axes[:, sizes > 0.5]
        free[e] = axes.shape[1]
        values, turned = np.linalg.eigh(axes.T @ supports.damping[number] @ axes)
        damping[e, : free[e]], direction[e, : free[e]] = np.maximum(values, 0.0), (axes @ turned).T
    return Ends(
        number=which, strand=s, node=strands.first[s] + at_end * strands.links[s],
        link=strands.first[s] + at_end * (strands.links[s] - 1), sign=np.where(at_end == 0, 1.0, -1.0),
        half=half, mass=half + supports.mass[which], place=supports.place[which],
        free=free, direction=direction, damping=damping, stiffness=supports.stiffness[which],
        force=supports.force[which] + supports.mass[which, None] * strands.gravity,
        motion_first=supports.motion_first[which], motion_count=supports.motion_count[which],
        motion_time=supports.motion_time, motion_value=np.ascontiguousarray(supports.motion_value),
        drive=np.zeros((dim, which.size)), share=np.zeros((dim, which.size)), total=np.zeros((dim, which.size)),
        kicked=np.zeros((dim, which.size)),
    )  # fmt: skip


def drives_at(ends: Ends, t: float) -> Array:
    """Velocities (axis, end) of the tables just after time t in s, m/s."""
    return np.array(
        [
            [_rate(ends.motion_time, row, ends.motion_first[e], ends.motion_count[e], t) for e in range(ends.node.size)]
            for row in ends.motion_value
        ]
    )


def location_ends(strands: Strands, supports: Supports, state: ChainState) -> None:
    """Leave the ends of a state no velocity but those that their supports allow or prescribe; the state is changed."""
    for number in range(supports.mass.size):
        s = number // 2
        node = strands.first[s] + number % 2 * strands.links[s]
        state.w[:, node] = supports.free[number] @ state.w[:, node]
    ends = ends_of(strands, supports)
    if ends is not None:
        prescribed = ends.free == 0
        state.w[:, ends.node[prescribed]] = drives_at(ends, float(state.t[0]))[:, prescribed]


@lean_inner
def _slope_at(time, value, first, count, t):
    """Slope of a table that is constant outside its entries, at time t; at an entry that of what follows."""
    i = _entry(time, first, count, t)
    if count == 1 or i == first + count - 1 or t < time[i]:
        return 0.0
    return (value[i + 1] - value[i]) / (time[i + 1] - time[i])


def _rate(time: Array, value: Array, first: int, count: int, t: float) -> float:
    times, values = time[first : first + count], value[first : first + count]
    i = int(np.searchsorted(times, t, side="right")) - 1
    return 0.0 if i < 0 or i == count - 1 else float((values[i + 1] - values[i]) / (times[i + 1] - times[i]))


@lean_inner
def drive_ends(state, ends, t):
    """Note the velocities of all tables at time t, and give them to the ends that move as prescribed."""
    for e in range(ends.node.size):
        node = ends.node[e]
        for a in range(state.r.shape[0]):
            v = _slope_at(ends.motion_time, ends.motion_value[a], ends.motion_first[e], ends.motion_count[e], t)
            ends.drive[a, e] = v
            if ends.free[e] == 0:
                old = state.w[a, node]
                state.w[a, node] = v  # a blow on the half link, where the table has a corner
                state.work[SUPPORT_WORK] += 0.5 * ends.half[e] * (v * v - old * old)


@lean_inner
def _load_ends(strands, loads, state, buffers, ends):
    """Forces on the ends that do not depend on how these are held: pull, weight of half a link, share of the loads."""
    for e in range(ends.node.size):
        s, i = ends.strand[e], ends.link[e]
        weight = 0.5 * strands.rho[s] * (state.X[i + 1] - state.X[i])
        for a in range(state.r.shape[0]):
            ends.share[a, e] = 0.0
            ends.total[a, e] = ends.sign[e] * buffers.f[a, i] + weight * strands.gravity[a]
    for k in range(state.xi.size):
        if state.moving_load[k] != SHARED:
            continue
        s = loads.strand[k]
        first = strands.first[s]
        i = location_of(state.X, state.xi[k], strands.h[s], first, first + strands.links[s])
        part = (state.xi[k] - state.X[i]) / (state.X[i + 1] - state.X[i])
        for e in range(ends.node.size):
            if ends.strand[e] == s and ends.link[e] == i and i <= ends.node[e] <= i + 1:
                share = part if ends.node[e] == i + 1 else 1.0 - part
                for a in range(state.r.shape[0]):
                    F = share * force_at(loads, k, state.t[0], a)
                    ends.share[a, e] += F
                    ends.total[a, e] += F


@lean_inner
def _kick_moved(strands, state, buffers, ends, e, kick):
    """What holds an end that moves as prescribed works against everything that pulls at it."""
    drag = strands.drag[ends.strand[e]] * ends.half[e]
    for a in range(state.r.shape[0]):
        v = ends.drive[a, e]
        state.work[LOAD_WORK] += kick * ends.share[a, e] * v
        state.work[LINE_DAMPING] += kick * drag * v * v
        state.work[SUPPORT_WORK] += kick * (drag * v - ends.total[a, e]) * v
        ends.kicked[a, e] = v


@inlined
def _decay(x):
    """(1 - exp(-x)) / x and (1 - that) / x, for x of either sign."""
    if abs(x) < 1e-3:
        return 1.0 - x * (0.5 - x * (1.0 / 6.0 - x / 24.0)), 0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0))
    first = -np.expm1(-x) / x
    return first, (1.0 - first) / x


@lean_inner
def _kick_free(state, buffers, ends, e, kick, lead):
    """Kick an end that yields; the velocity at the instant to come, `lead` kicks later, goes to `ahead`."""
    dim, node, m, w, work = state.r.shape[0], ends.node[e], ends.mass[e], state.w, state.work
    for a in range(dim):
        ends.kicked[a, e] = w[a, node]
        buffers.ahead[a, node] = w[a, node]
    for a in range(dim):  # the force of the spring, and the work of its far end
        pull = 0.0
        for b in range(dim):
            u = look_up(ends.motion_time, ends.motion_value[b], ends.motion_first[e], ends.motion_count[e], state.t[0])
            pull += ends.stiffness[e, a, b] * (ends.place[e, b] + u - state.r[b, node])
        ends.total[a, e] += pull + ends.force[e, a]
        work[SUPPORT_WORK] += kick * pull * ends.drive[a, e]
    for j in range(ends.free[e]):
        c, F, before, far, given = ends.damping[e, j], 0.0, 0.0, 0.0, 0.0
        for a in range(dim):
            d = ends.direction[e, j, a]
            F += d * ends.total[a, e]
            before += d * (w[a, node] - ends.drive[a, e])
            far += d * ends.drive[a, e]
            given += d * ends.share[a, e]
        # Relative to the far end of the dashpot; `mean` is over the kick.
        once, twice = _decay(c * kick / m)
        gain = kick * (F - c * before) / m * once
        after, mean = before + gain, before * once + kick * F / m * twice
        if c > 0.0:
            work[LINE_DAMPING] += kick * F * mean - 0.5 * m * (after * after - before * before)
            work[SUPPORT_WORK] -= kick * c * mean * far
        work[LOAD_WORK] += kick * given * (mean + far)
        for a in range(dim):
            d = ends.direction[e, j, a]
            ends.kicked[a, e] += d * gain
            buffers.ahead[a, node] += d * (1.0 + lead) * gain


@lean_inner
def move_ends(strands, loads, state, buffers, ends, kick, drift, lead):
    """Kick and drift the ends that yield or move, with all that the loads add; works go to the account."""
    r, w, work, t = state.r, state.w, state.work, state.t[0] + drift
    _load_ends(strands, loads, state, buffers, ends)
    for e in range(ends.node.size):
        node, m = ends.node[e], ends.mass[e]
        if ends.free[e] == 0:
            _kick_moved(strands, state, buffers, ends, e, kick)
            if drift != 0.0:
                for a in range(r.shape[0]):
                    u = look_up(ends.motion_time, ends.motion_value[a], ends.motion_first[e], ends.motion_count[e], t)
                    r[a, node] = ends.place[e, a] + u
            continue
        _kick_free(state, buffers, ends, e, kick, lead)
        way, decay, rate = drift, 1.0, strands.drag[ends.strand[e]] * ends.half[e] / m
        if rate > 0.0:
            decay = np.exp(-min(rate * drift, STRONGEST))
            way = (1.0 - decay) / rate
        for a in range(r.shape[0]):
            v = ends.kicked[a, e]
            r[a, node] += way * v
            w[a, node] = decay * v
            buffers.ahead[a, node] *= decay
            work[LINE_DAMPING] += 0.5 * m * (1.0 - decay * decay) * v * v
    if drift != 0.0:
        drive_ends(state, ends, t - INSIDE * drift)
        for e in range(ends.node.size):
            if ends.free[e] == 0:
                for a in range(r.shape[0]):
                    buffers.ahead[a, ends.node[e]] = w[a, ends.node[e]]


@inlined
def kicked_velocity(state, ends, node, decay, a):
    """Component a of a node's velocity after the last kick, before drag has taken its part in the drift."""
    v = state.w[a, node] / decay
    for e in range(ends.node.size):
        if ends.node[e] == node:
            v = ends.kicked[a, e]
    return v
