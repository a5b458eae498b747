"""Moving loads on wires: linear multi-body systems that touch the spline, the same for both kinds of motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.compiled import inlined
from ropewalk.wires.mesh import MovingLoads
from ropewalk.wires.plan import Array

_SWEEPS = 4
# Entries of `work`: of given forces, pushes and external interfaces; of what holds loads at their places along the line
# and drives them over its roughness; lost in dampers of loads; taken up by contacts, as they come closer; lost in
# dampers and drag of wires, ties and holds; done by holds that move, at their far ends.
GIVEN, RESTRAINED, LOST, TAKEN, DAMPED, MOVED = 0, 1, 2, 3, 4, 5
WORKS = 6
# Entries of what is known of a contact at an instant: height of the spline in m, place in links, slope in m per link,
# given force and all force on the wire in N, by how much load and spline overlap in m, compliance beside the spline in
# m/N, roughness in m, how far aside it is in m, and by how much its height grows with that.
HEIGHT, PLACE, SLOPE, GIVEN_FORCE, FORCE, GAP, LOCAL, ROUGH, ASIDE, TURNED = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9
_KNOWN = 10


class TimeStepping(NamedTuple):
    """What a step of a given length needs of the loads: central differences, damping implicit. And their state."""

    step: float  # s
    inverse: Array  # (moving load, C, C) of M/dt^2 + C/(2 dt)
    middle: Array  # (moving load, C, C) 2 M/dt^2 - K
    back: Array  # (moving load, C, C) M/dt^2 - C/(2 dt)
    q: Array  # (moving load, C) now
    last: Array  # (moving load, C) a step ago
    pushed: Array  # (moving load, C) N, room
    outer: Array  # (moving load, C) N, what is put on them from outside
    past: Array  # (moving load, C) m, room
    gap: Array  # (contact,) m by which moving load and spline overlapped last, NaN before the first step
    place: Array  # (contact,) in links along its wire, where it was found last
    joined: Array  # (contact,) N, what has kept a rigid contact together in this step
    here: Array  # (contact, _KNOWN) at the last instant, NaN where it was neither on the wire nor beside it
    before: Array  # (contact, _KNOWN) the same a step ago
    work: Array  # (WORKS,) J since the start
    moved: Array  # (contact, C) m/N, by how much a force at a contact moves each coordinate of its load during a step
    yields: Array  # (contact,) m/N by which a rigid contact gives way on the side of its moving load, during a step


# What of it changes from step to step, and is more than room.
CHANGES = ("q", "last", "gap", "place", "joined", "here", "before", "work")


def stepping_of(moving_loads: MovingLoads, step: float, q: Array, place: Array) -> TimeStepping:
    """Prepare steps of a length in s, from rest at coordinates q."""
    M, C = moving_loads.mass / step**2, moving_loads.damping / (2.0 * step)
    inverse = np.zeros_like(M)
    for i, n in enumerate(moving_loads.size):
        inverse[i, :n, :n] = np.linalg.inv((M + C)[i, :n, :n])
    count = moving_loads.owner.size
    nowhere, unknown = np.full(count, np.nan), np.full((count, _KNOWN), np.nan)
    moved = np.array([inverse[i] @ row for i, row in zip(moving_loads.owner, moving_loads.row, strict=True)])
    moved = moved.reshape(count, inverse.shape[-1])
    yields = np.einsum("kc,kc->k", moved, moving_loads.row.reshape(moved.shape))
    return TimeStepping(
        step, inverse, 2.0 * M - moving_loads.stiffness, M - C, q.copy(), q.copy(), np.zeros_like(q), np.zeros_like(q),
        np.zeros_like(q), nowhere, place.copy(), np.zeros(count), unknown, unknown.copy(), np.zeros(WORKS),
        moved, yields,
    )  # fmt: skip


def sweeps_of(moving_loads: MovingLoads, constraints: int) -> int:
    """How often all that is rigid is seen to in a step: contacts and holds that share nodes, or a load, disturb."""
    rigid = int(np.isinf(moving_loads.spring).sum())
    return 0 if rigid + constraints == 0 else 1 if rigid == 0 else _SWEEPS


@inlined
def between(table, row, part, k):
    """Entry k of a table between two of its rows."""
    return table[row, k] + part * (table[row + 1, k] - table[row, k])


@inlined
def between_rows(table, row, part):
    """A table of one entry a row, between two of its rows."""
    return table[row] + part * (table[row + 1] - table[row])


@inlined
def begin(moving_loads, stepping, push, row, part):
    """Put what is given on the coordinates of all moving loads."""
    for k in range(moving_loads.owner.size):
        stepping.joined[k] = 0.0
        for c in range(_KNOWN):
            stepping.before[k, c], stepping.here[k, c] = stepping.here[k, c], np.nan
    for i in range(moving_loads.size.size):
        for c in range(moving_loads.size[i]):
            stepping.outer[i, c] = push[row, i, c] + part * (push[row + 1, i, c] - push[row, i, c])
            stepping.pushed[i, c] = stepping.outer[i, c]


@inlined
def contact_force(moving_loads, stepping, k, height, local, aside):
    """Force upwards on the wire at contact k, where the spline stands at a height; its moving load feels the reaction.

    Args:
        height: with its roughness.
        local: compliance of the wire beside its spline, in series with the spring of the contact, m/N: the wire stands
            so much higher, for each N.
        aside: how far the wire is to the left of the middle of the load, m.
    """
    i, spring, rest = moving_loads.owner[k], moving_loads.spring[k], moving_loads.rest[k]
    if spring == 0.0:
        return rest
    gap = moving_loads.base[k] - height
    for c in range(moving_loads.size[i]):
        gap += (moving_loads.row[k, c] + aside * moving_loads.turn[k, c]) * stepping.q[i, c]
    last, stepping.gap[k] = stepping.gap[k], gap
    if np.isinf(spring):  # rigid contacts are joined at the end of the step
        return rest
    force = rest + (gap - local * rest) / (local + 1.0 / spring)
    if moving_loads.damper[k] > 0.0 and np.isfinite(last):
        force += moving_loads.damper[k] * (gap - last) / stepping.step
    if moving_loads.lifts[k] and moving_loads.sign[k] * force < 0.0:
        force = 0.0
    for c in range(moving_loads.size[i]):
        stepping.pushed[i, c] -= (moving_loads.row[k, c] + aside * moving_loads.turn[k, c]) * (force - rest)
    return force


@inlined
def note(moving_loads, stepping, record, row, step, k, height, s, slope, given, force, local, rough, aside):
    """Keep what is known of contact k in this step: for the accounts, and in the first step of a row for the record."""
    here, gap = stepping.here[k], stepping.gap[k] if moving_loads.spring[k] > 0.0 else 0.0
    here[HEIGHT], here[PLACE], here[SLOPE], here[GIVEN_FORCE], here[FORCE] = height, s, slope, given, force
    here[GAP], here[LOCAL], here[ROUGH], here[ASIDE], here[TURNED] = gap, local, rough, aside, 0.0
    for c in range(moving_loads.size[moving_loads.owner[k]]):
        here[TURNED] += moving_loads.turn[k, c] * stepping.q[moving_loads.owner[k], c]
    if step == 0:
        record.force[row, k] = force
        record.height[row, k] = height + gap if np.isinf(moving_loads.spring[k]) else height + local * force


@inlined
def enforce_contact(moving_loads, stepping, k, height, soft, local):
    """Force upwards on the wire that brings a rigid contact together at the end of a step; its moving load gives way.

    Args:
        height: of the spline at the end of the step, and all that was done before; with its roughness.
        soft: what the spline gives way to a force during the step, m/N.
        local: what the wire gives way to beside its spline, m/N.
    """
    i, sign, rest = moving_loads.owner[k], moving_loads.sign[k], moving_loads.rest[k]
    gap = moving_loads.base[k] - height - local * (rest + stepping.joined[k])
    for c in range(moving_loads.size[i]):
        gap += moving_loads.row[k, c] * stepping.q[i, c]
    force = gap / (soft + local + stepping.yields[k])
    if moving_loads.lifts[k] and sign * (rest + stepping.joined[k] + force) < 0.0:
        force = -rest - stepping.joined[k]
    stepping.joined[k] += force
    for c in range(moving_loads.size[i]):
        stepping.q[i, c] -= stepping.moved[k, c] * force
    return force


@inlined
def advance_moving_loads(moving_loads, stepping):
    """Let the coordinates of all moving loads go on for a step."""
    q, last, past, pushed = stepping.q, stepping.last, stepping.past, stepping.pushed
    for i in range(moving_loads.size.size):
        n = moving_loads.size[i]
        for c in range(n):
            for d in range(n):
                pushed[i, c] += stepping.middle[i, c, d] * q[i, d] - stepping.back[i, c, d] * last[i, d]
        for c in range(n):
            past[i, c], last[i, c] = last[i, c], q[i, c]
        for c in range(n):
            q[i, c] = 0.0
            for d in range(n):
                q[i, c] += stepping.inverse[i, c, d] * pushed[i, d]
        for c in range(n):
            two = q[i, c] - past[i, c]  # moved in two steps
            stepping.work[GIVEN] += 0.5 * stepping.outer[i, c] * two
            for d in range(n):
                stepping.work[LOST] += (
                    0.25 * moving_loads.damping[i, c, d] * two * (q[i, d] - past[i, d]) / stepping.step
                )


@inlined
def settle_accounts(moving_loads, stepping):
    """Work at all contacts in the step that ends now, by what was there a step ago and is there now.

    A force on the wire gives it the force times the rise of the particles below: the rise of the contact less what its
    advance along the slope makes of it. The latter is what holds the load at its place, against the slope; as is what
    drives it over roughness, and what guides a wire across a load that has turned. What moving load and wire lose
    together is taken up by their contact.
    """
    for k in range(moving_loads.owner.size):
        here, before = stepping.here[k], stepping.before[k]
        here[FORCE] += stepping.joined[k]
        if np.isnan(here[HEIGHT]) or np.isnan(before[HEIGHT]):
            continue
        force, rough = 0.5 * (here[FORCE] + before[FORCE]), here[ROUGH] - before[ROUGH]
        stepping.work[GIVEN] += 0.5 * (here[GIVEN_FORCE] + before[GIVEN_FORCE]) * (here[HEIGHT] - before[HEIGHT])
        stepping.work[RESTRAINED] -= 0.5 * force * (here[SLOPE] + before[SLOPE]) * (here[PLACE] - before[PLACE])
        if moving_loads.spring[k] == 0.0:
            continue
        if moving_loads.size[moving_loads.owner[k]] == 0:  # the far end of an interface is moved from outside
            stepping.work[GIVEN] -= force * rough
        else:
            stepping.work[RESTRAINED] -= force * rough
            stepping.work[RESTRAINED] += 0.5 * force * (here[TURNED] + before[TURNED]) * (here[ASIDE] - before[ASIDE])
        stepping.work[TAKEN] += force * (here[GAP] - before[GAP])


@inlined
def local_at(strands, a, s):
    """Compliance of wire a beside its spline at a place in links, m/N."""
    part = s - np.floor(s)
    g = part * (1.0 - part)
    local = strands.local[a, 0] + g * g * (strands.local[a, 1] + g * strands.local[a, 2])
    if strands.fourth[a]:  # at an end the nodes share nothing, and a beam yields as its spline
        inner = 1.0 - min(s, strands.links[a] - s)
        if inner > 0.0:
            local *= 1.0 - inner * inner * inner
    return local


@inlined
def local_under(strands, moving_loads, k, s):
    """The same under contact k; where the spline yields more than a stiff wire itself, half of the contact at most."""
    local, spring = local_at(strands, moving_loads.wire[k], s), moving_loads.spring[k]
    return max(local, -0.5 / spring) if spring > 0.0 else local
