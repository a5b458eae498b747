"""Riders on wires: linear multi-body systems that touch the spline, the same for both kinds of motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.compiled import inlined
from ropewalk.wires.mesh import Riders
from ropewalk.wires.plan import Array

_SWEEPS = 4


class Pace(NamedTuple):
    """What a step of a given length needs of the riders: central differences, damping implicit. And their state."""

    step: float  # s
    inverse: Array  # (rider, C, C) of M/dt^2 + C/(2 dt)
    middle: Array  # (rider, C, C) 2 M/dt^2 - K
    back: Array  # (rider, C, C) M/dt^2 - C/(2 dt)
    q: Array  # (rider, C) now
    last: Array  # (rider, C) a step ago
    pushed: Array  # (rider, C) N, room
    gap: Array  # (contact,) m by which rider and wire overlapped a step ago, NaN before the first
    place: Array  # (contact,) in links along its wire, where it was found last
    joined: Array  # (contact,) N, what has kept a rigid contact together in this step
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
        step, inverse, 2.0 * M - riders.stiffness, M - C, q.copy(), q.copy(), np.zeros_like(q), nowhere, place.copy(),
        np.zeros(riders.owner.size), yields.reshape(-1),
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
    for i in range(riders.size.size):
        for c in range(riders.size[i]):
            pace.pushed[i, c] = push[row, i, c] + part * (push[row + 1, i, c] - push[row, i, c])


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
    pace.gap[k] = gap
    if riders.lifts[k] and riders.sign[k] * force < 0.0:
        force = 0.0
    for c in range(riders.size[i]):
        pace.pushed[i, c] -= riders.row[k, c] * (force - rest)
    return force


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
    q, last, pushed = pace.q, pace.last, pace.pushed
    for i in range(riders.size.size):
        n = riders.size[i]
        for c in range(n):
            for d in range(n):
                pushed[i, c] += pace.middle[i, c, d] * q[i, d] - pace.back[i, c, d] * last[i, d]
        for c in range(n):
            last[i, c] = q[i, c]
        for c in range(n):
            q[i, c] = 0.0
            for d in range(n):
                q[i, c] += pace.inverse[i, c, d] * pushed[i, d]


@inlined
def local_at(strands, a, s):
    """Compliance of wire a beside its spline at a place in links, m/N."""
    part = s - np.floor(s)
    g = part * (1.0 - part)
    return strands.local[a, 0] + g * g * (strands.local[a, 1] + g * strands.local[a, 2])
