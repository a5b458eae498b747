"""Riders on wires: linear multi-body systems that touch the spline, the same for both kinds of motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.compiled import inlined
from ropewalk.wires.mesh import Riders
from ropewalk.wires.plan import Array

_SWEEPS = 4
# Entries of `work`: of given forces and pushes; of what holds riders at their places along the line; lost in dampers of
# riders and contacts.
GIVEN, HELD, LOST = 0, 1, 2
WORKS = 3


class Pace(NamedTuple):
    """What a step of a given length needs of the riders: central differences, damping implicit. And their state."""

    step: float  # s
    inverse: Array  # (rider, C, C) of M/dt^2 + C/(2 dt)
    middle: Array  # (rider, C, C) 2 M/dt^2 - K
    back: Array  # (rider, C, C) M/dt^2 - C/(2 dt)
    q: Array  # (rider, C) now
    last: Array  # (rider, C) a step ago
    pushed: Array  # (rider, C) N, room
    outer: Array  # (rider, C) N, what is put on them from outside
    past: Array  # (rider, C) m, room
    gap: Array  # (contact,) m by which rider and wire overlapped a step ago, NaN before the first
    place: Array  # (contact,) in links along its wire, where it was found last
    joined: Array  # (contact,) N, what has kept a rigid contact together in this step
    here: Array  # (contact, 5) height in m, place in links, slope in m per link, given force and all force in N
    before: Array  # (contact, 5) the same a step ago, NaN where it was not on the wire
    work: Array  # (WORKS,) J since the start
    yields: Array  # (contact,) m/N by which a rigid contact gives way on the side of its rider, during a step


def pace_of(riders: Riders, step: float, q: Array, place: Array) -> Pace:
    """Prepare steps of a length in s, from rest at coordinates q."""
    M, C = riders.mass / step**2, riders.damping / (2.0 * step)
    inverse = np.zeros_like(M)
    for i, n in enumerate(riders.size):
        inverse[i, :n, :n] = np.linalg.inv((M + C)[i, :n, :n])
    nowhere = np.full(riders.owner.size, np.nan)
    yields = np.array([row @ inverse[i] @ row for i, row in zip(riders.owner, riders.row, strict=True)])
    return Pace(
        step, inverse, 2.0 * M - riders.stiffness, M - C, q.copy(), q.copy(), np.zeros_like(q), np.zeros_like(q),
        np.zeros_like(q), nowhere, place.copy(), np.zeros(riders.owner.size), np.full((riders.owner.size, 5), np.nan),
        np.full((riders.owner.size, 5), np.nan), np.zeros(WORKS), yields.reshape(-1),
    )  # fmt: skip


def sweeps_of(riders: Riders, grips: int) -> int:
    """How often all that is rigid is seen to in a step: contacts and holds that share nodes, or a rider, disturb."""
    rigid = int(np.isinf(riders.spring).sum())
    return 0 if rigid + grips == 0 else 1 if rigid == 0 else _SWEEPS


@inlined
def between(table, row, part, k):
    """Entry k of a table between two of its rows."""
    return table[row, k] + part * (table[row + 1, k] - table[row, k])


@inlined
def begin(riders, pace, push, row, part):
    """Put what is given on the coordinates of all riders."""
    for k in range(riders.owner.size):
        pace.joined[k] = 0.0
        for c in range(5):
            pace.before[k, c], pace.here[k, c] = pace.here[k, c], np.nan
    for i in range(riders.size.size):
        for c in range(riders.size[i]):
            pace.outer[i, c] = push[row, i, c] + part * (push[row + 1, i, c] - push[row, i, c])
            pace.pushed[i, c] = pace.outer[i, c]


@inlined
def press(riders, pace, k, height, local):
    """Force upwards on the wire at contact k, where the wire stands at a height; its rider feels the reaction.

    Args:
        local: compliance of the wire beside its spline, in series with the spring of the contact, m/N.
    """
    i, spring, rest = riders.owner[k], riders.spring[k], riders.rest[k]
    if spring == 0.0 or np.isinf(spring):  # rigid contacts are joined at the end of the step
        return rest
    gap = riders.base[k] - height
    for c in range(riders.size[i]):
        gap += riders.row[k, c] * pace.q[i, c]
    force = rest + gap / (local + 1.0 / spring)
    if riders.damper[k] > 0.0 and np.isfinite(pace.gap[k]):
        force += riders.damper[k] * (gap - pace.gap[k]) / pace.step
        pace.work[LOST] += riders.damper[k] * (gap - pace.gap[k]) ** 2 / pace.step
    pace.gap[k] = gap
    if riders.lifts[k] and riders.sign[k] * force < 0.0:
        force = 0.0
    for c in range(riders.size[i]):
        pace.pushed[i, c] -= riders.row[k, c] * (force - rest)
    return force


@inlined
def note(pace, record, row, step, k, on_wire, height, s, slope, given, force, local):
    """Keep what is known of contact k in this step: for the accounts, and in the first step of a row for the record."""
    if on_wire:
        here = pace.here[k]
        here[0], here[1], here[2], here[3], here[4] = height, s, slope, given, force
    if step == 0:
        record.force[row, k], record.height[row, k] = force, height + local * force


@inlined
def join(riders, pace, k, height, soft):
    """Force upwards on the wire that brings a rigid contact together at the end of a step; its rider gives way.

    Args:
        height: of the wire at the end of the step, and all that was done before.
        soft: what the wire gives way to a force during the step, m/N.
    """
    i, sign, rest = riders.owner[k], riders.sign[k], riders.rest[k]
    gap = riders.base[k] - height
    for c in range(riders.size[i]):
        gap += riders.row[k, c] * pace.q[i, c]
    force = gap / (soft + pace.yields[k])
    if riders.lifts[k] and sign * (rest + pace.joined[k] + force) < 0.0:
        force = -rest - pace.joined[k]
    pace.joined[k] += force
    for c in range(riders.size[i]):
        for d in range(riders.size[i]):
            pace.q[i, c] -= pace.inverse[i, c, d] * riders.row[k, d] * force
    return force


@inlined
def ride(riders, pace):
    """Let the coordinates of all riders go on for a step."""
    q, last, past, pushed = pace.q, pace.last, pace.past, pace.pushed
    for i in range(riders.size.size):
        n = riders.size[i]
        for c in range(n):
            for d in range(n):
                pushed[i, c] += pace.middle[i, c, d] * q[i, d] - pace.back[i, c, d] * last[i, d]
        for c in range(n):
            past[i, c], last[i, c] = last[i, c], q[i, c]
        for c in range(n):
            q[i, c] = 0.0
            for d in range(n):
                q[i, c] += pace.inverse[i, c, d] * pushed[i, d]
        for c in range(n):
            two = q[i, c] - past[i, c]  # moved in two steps
            pace.work[GIVEN] += 0.5 * pace.outer[i, c] * two
            for d in range(n):
                pace.work[LOST] += 0.25 * riders.damping[i, c, d] * two * (q[i, d] - past[i, d]) / pace.step


@inlined
def settle_accounts(riders, pace):
    """Work at all contacts in the step that ends now, by what was there a step ago and is there now.

    A force on the wire gives it the force times the rise of the particles below: the rise of the contact less what its
    advance along the slope makes of it. The latter is what holds the rider at its place, against the slope.
    """
    for k in range(riders.owner.size):
        here, before = pace.here[k], pace.before[k]
        here[4] += pace.joined[k]
        if np.isnan(here[0]) or np.isnan(before[0]):
            continue
        pace.work[GIVEN] += 0.5 * (here[3] + before[3]) * (here[0] - before[0])
        pace.work[HELD] -= 0.25 * (here[4] + before[4]) * (here[2] + before[2]) * (here[1] - before[1])


@inlined
def local_at(strands, a, s):
    """Compliance of wire a beside its spline at a place in links, m/N."""
    part = s - np.floor(s)
    g = part * (1.0 - part)
    return strands.local[a, 0] + g * g * (strands.local[a, 1] + g * strands.local[a, 2])
