"""Hauling ropes: masses that move with the rope between carriage and drive, springs that sag, a sheave that slips.

The place y of a piece of rope is its way to the drive, or to a pulley, beyond which it is negative. The unstrained
length l between drive and carriage changes as the drive takes rope in, and n masses m l/n stand at the middles of n
equal parts of it, s = l (i + 1/2)/n from the drive; springs are between their neighbours, half ones at both ends:

    v = y' + (1 + e) (1 - s/l) l',   m l/n (v' + (1 - s/l) l' dv/ds) = T+ - T- - w (z+ - z-),

T and z: tensions and heights ahead of and behind a mass, v: velocity of the rope, e: strain along the way. So the drive
pulls with w times the height more than the carriage does, and with the mass times the acceleration. Where the rope
hangs freely over level spans L between rollers, each piece is shorter along the way than it is by (w L)^2/(24 T^2)
(Irvine; Ernst's modulus is the slope of that):

    e = T/EA - (w L)^2/(24 T^2) + what the damper takes.

The rope slips on the sheave of the drive where one side pulls more than e^(friction wrap) times the other: as much of
it slips as brings it there. A counter rope is one mass on half of its spring, beside the tension that a weight keeps.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import lean, lean_inner
from ropewalk.mechanics.hanging_rope import hang_by_tension
from ropewalk.mechanics.moving_contact import look_up
from ropewalk.system.contact.contact_record import ON
from ropewalk.system.contact.travel import travelled
from ropewalk.system.loads.ways_to_stations import aim, middle, to_drive

_REAL, _CODE, _VECTOR = "f8", "i8", ("f8", (3,))
_BOTH = ("f8", (2,))  # of the carriage, and of that at the other end
# Tensions that are noted for each carriage: at it, at the drive, of its counter rope, on the other side of the drive.
TENSIONS = 4
HAUL = np.dtype(
    [
        ("first", _CODE),  # first contact of its carriage
        ("wheels", _CODE),
        ("other", _CODE),  # first contact of the carriage at its other end, -1: none
        ("others", _CODE),
        ("to", _CODE),  # 1: the drive is at the end of the line, -1: at its start
        ("stiffness", _REAL),  # N, EA
        ("damping", _REAL),  # N s
        ("mass", _REAL),  # kg/m
        ("weight", _REAL),  # N/m
        ("beyond", _REAL),  # m, from the end of the line to the drive
        ("length", _REAL),  # m, unstrained, of what is between carriage and drive at time zero, or both carriages
        ("driven", _CODE),  # 1: a drive takes it in
        ("hangs", _CODE),  # 1: freely from the carriage to the next tower, and so on
        ("part", _CODE),  # first of its parts; there is one more than masses
        ("masses", _CODE),
        ("tower", _CODE),  # first of the towers on its way, beginning at the drive
        ("towers", _CODE),
        ("bears", _REAL),  # e^(friction wrap) of the sheave of the drive; 0: it does not slip
        ("counter", _REAL),  # N, tension of the counter rope at its station; 0: there is none
        ("counter_weight", _REAL),  # N/m
        ("counter_mass", _REAL),  # kg/m
        ("counter_stiffness", _REAL),  # N, EA
        ("counter_place", *_BOTH),  # m, way to the station of the carriage when its rope is not stretched by inertia
        ("counter_speed", *_BOTH),  # m/s, of the mass of that, away from the station
        ("counter_push", *_BOTH),  # m/s^2
        ("slack_side", _REAL),  # N, pull of what goes from the drive to the weight of the counter rope
        ("slipped", _REAL),  # m, that has slipped out over the sheave of the drive
        ("now", _REAL),  # m, unstrained, between carriage and drive
        ("grows", _REAL),  # m/s
        ("near", _REAL),  # m, way of the carriage to the drive
        ("back", _REAL),  # m, of the carriage at the other end
        ("high", *_VECTOR),  # m, heights of the carriage, of the end of the line, of the other carriage
        ("level", _REAL),  # m, level, from the carriage to the end of the line
        ("across", *_BOTH),  # N, across the way of what hangs freely, at the carriage and at the drive: w L/2
        ("deep", _REAL),  # weight of what hangs between two rollers over its tension, the largest one
        ("way", *_VECTOR),  # level unit vector from the carriage to a station
        ("free", *_VECTOR),  # N, pull of all that hangs freely, beside that along the line
        ("tensions", "f8", (2 * TENSIONS,)),  # N, to be told, of both carriages
    ],
    align=True,
)
PART = np.dtype(
    [  # of mass i, and of the spring between it and the one before, towards the drive
        ("place", _REAL),  # m, y
        ("speed", _REAL),  # m/s, v
        ("push", _REAL),  # m/s^2
        ("strain", _REAL),
        ("rate", _REAL),  # 1/s
        ("soft", _REAL),  # N^2, (w L)^2/24
        ("tension", _REAL),  # N
    ],
    align=True,
)
# Rounds in which a tension is found, the part of it to which it is, and rounds in which a rope at rest is laid out.
_ROUNDS, _CLOSE, _LAID = 60, 1e-14, 60
# Part of the tension that friction bears to which it is found.
_SLIPS = 1e-9
# Least tension of a rope that hangs freely as it is laid out, over w L/24^(1/2): its sag takes a quarter of its length.
_LEAST = 2.0


@lean_inner
def tension_of(strain, soft, EA):
    """Tension in N of a rope at a strain along its way, with `soft` = (w L)^2/24 in N^2: T/EA - soft/T^2 = strain."""
    T = max(EA * strain, 0.0)
    if soft > 0.0:  # from above, where the cubic is convex
        T += (soft * EA) ** (1.0 / 3.0)
        for _ in range(_ROUNDS):
            step = ((T - EA * strain) * T * T - soft * EA) / ((3.0 * T - 2.0 * EA * strain) * T)
            T -= step
            if abs(step) <= _CLOSE * T:
                break
    return T


@lean_inner
def _softness(hauls, towers, e, low, high):
    """Mean of (w L)^2/24 in N^2 over what is between two ways to the drive in m, L: level spans between rollers."""
    if hauls[e].hangs == 0 or high <= low:
        return 0.0
    at, along, total = 0.0, hauls[e].beyond, 0.0
    for i in range(hauls[e].tower, hauls[e].tower + hauls[e].towers + 1):
        last = i == hauls[e].tower + hauls[e].towers or towers[i, 1] >= hauls[e].level
        level, way = hauls[e].level, hauls[e].near
        if not last:
            level, way = towers[i, 1], min(towers[i, 0], hauls[e].near)
        part = min(high, way) - max(low, along)
        if part > 0.0:
            total += part * (hauls[e].weight * (level - at)) ** 2 / 24.0
        if last:
            break
        at, along = level, way
    return total / (high - low)


@lean_inner
def _next_tower(hauls, towers, e):
    """Ways to the drive of the roller next to the carriage, m: along the rope, and level from the end of the line."""
    along, level = hauls[e].beyond, 0.0
    for i in range(hauls[e].tower, hauls[e].tower + hauls[e].towers):
        if towers[i, 1] >= hauls[e].level:
            break
        along, level = towers[i, 0], towers[i, 1]
    return along, level


@lean_inner
def _height(hauls, e, y):
    """Height of the rope in m at a way y to the drive in m."""
    if y >= 0.0:
        return hauls[e].high[1] + (hauls[e].high[0] - hauls[e].high[1]) * y / max(hauls[e].near, 1e-300)
    return hauls[e].high[1] - (hauls[e].high[2] - hauls[e].high[1]) * y / max(hauls[e].back, 1e-300)


@lean_inner
def _edge(hauls, ropes, e, j):
    """Way to the drive in m of where the tension of spring j is that of the rope."""
    p, n = hauls[e].part, hauls[e].masses
    if j == 0:
        return -hauls[e].back
    return hauls[e].near if j == n else 0.5 * (ropes[p + j - 1].place + ropes[p + j].place)


@lean_inner
def _share(hauls, e, j):
    """Part of the length of a rope that is in its spring j."""
    n = hauls[e].masses
    if n == 0:
        return 1.0
    return 0.5 / n if j == 0 or j == n else 1.0 / n


@lean_inner
def _ends(hauls, ropes, e, j):
    """Ways to the drive of both ends of spring j, m."""
    p, n = hauls[e].part, hauls[e].masses
    low = ropes[p + j - 1].place if j > 0 else -hauls[e].back
    return low, ropes[p + j].place if j < n else hauls[e].near


@lean_inner
def reach(hauls, towers, e, lines, runs, length, r, u, contacts):
    """Note the ways of carriages to the drive, and their heights."""
    first, count, to, top = hauls[e].first, hauls[e].wheels, hauls[e].to, r.shape[0] - 1
    level, up = aim(hauls, e, lines, runs, r, u, contacts, first, count, to)
    hauls[e].level = level
    hauls[e].high[0] = middle(contacts, first, count, u, top)
    hauls[e].high[1] = hauls[e].high[0] + up
    hauls[e].back, hauls[e].high[2] = 0.0, hauls[e].high[1]
    hauls[e].across[0] = hauls[e].across[1] = 0.0
    if hauls[e].hangs == 1:
        last = towers[hauls[e].tower, 1] if hauls[e].towers > 0 else level
        hauls[e].across[0] = 0.5 * hauls[e].weight * (level - _next_tower(hauls, towers, e)[1])
        hauls[e].across[1] = 0.5 * hauls[e].weight * min(last, level)
    if hauls[e].hangs == 1 and hauls[e].towers == 0:
        hauls[e].near = np.hypot(level, up) + hauls[e].beyond
        return
    hauls[e].near = to_drive(lines, runs, length, contacts, first, count, to) + hauls[e].beyond
    if hauls[e].driven == 0:
        other, others = hauls[e].other, hauls[e].others
        hauls[e].back = to_drive(lines, runs, length, contacts, other, others, to) + hauls[e].beyond
        hauls[e].high[2] = middle(contacts, other, others, u, top)


@lean_inner
def lay_out(hauls, ropes, towers, e, pull, speed):
    """Let a rope be as long, and its masses where they rest, as makes it pull at its carriage.

    Args:
        pull: N, at the carriage, whose way to the drive is known.
        speed: m/s, with which the drive takes it in.
    """
    p, n, EA = hauls[e].part, hauls[e].masses, hauls[e].stiffness
    whole = hauls[e].near + hauls[e].back
    for i in range(n):
        ropes[p + i].place = whole * (i + 0.5) / n - hauls[e].back
    for _ in range(_LAID):
        total = 0.0
        for j in range(n + 1):
            low, high = _ends(hauls, ropes, e, j)
            T = pull + hauls[e].weight * (_height(hauls, e, _edge(hauls, ropes, e, j)) - hauls[e].high[0])
            soft = _softness(hauls, towers, e, low, high)
            T = max(T, _LEAST * np.sqrt(soft))
            ropes[p + j].soft, ropes[p + j].tension = soft, T
            ropes[p + j].strain = T / EA - (soft / (T * T) if soft > 0.0 else 0.0)
            total += _share(hauls, e, j) * (1.0 + ropes[p + j].strain)
        hauls[e].now, at = whole / total, -hauls[e].back
        for i in range(n):
            at += _share(hauls, e, i) * (1.0 + ropes[p + i].strain) * hauls[e].now
            ropes[p + i].place = at
    hauls[e].length, hauls[e].slipped = hauls[e].now, 0.0
    for j in range(n + 1):
        ropes[p + j].rate, ropes[p + j].push = 0.0, 0.0
        ropes[p + j].speed = -speed * (1.0 + ropes[p + j].strain) if hauls[e].driven == 1 else 0.0


@lean_inner
def _stretch(hauls, ropes, towers, e, since):
    """Find the tensions of all springs of a rope, and what they accelerate."""
    p, n, EA, now, grows = hauls[e].part, hauls[e].masses, hauls[e].stiffness, hauls[e].now, hauls[e].grows
    deep = 0.0
    for j in range(n + 1):
        low, high = _ends(hauls, ropes, e, j)
        strain = (high - low) / (_share(hauls, e, j) * now) - 1.0
        if since > 0.0:
            ropes[p + j].rate = (strain - ropes[p + j].strain) / since
        ropes[p + j].strain, ropes[p + j].soft = strain, _softness(hauls, towers, e, low, high)
        spring = tension_of(strain, ropes[p + j].soft, EA)
        T = max(spring + hauls[e].damping * ropes[p + j].rate, 0.0) if spring > 0.0 else 0.0
        ropes[p + j].tension = T
        deep = max(deep, ropes[p + j].soft / max(spring * spring, 1e-300))
    hauls[e].deep = np.sqrt(24.0 * deep)
    if since > 0.0 and hauls[e].bears > 0.0:
        _slip(hauls, ropes, e, since)
    for i in range(n):
        up = _height(hauls, e, _edge(hauls, ropes, e, i + 1)) - _height(hauls, e, _edge(hauls, ropes, e, i))
        pull = ropes[p + i + 1].tension - ropes[p + i].tension - hauls[e].weight * up
        ropes[p + i].push = pull * n / (hauls[e].mass * now)
        if grows != 0.0:
            below = ropes[p + i - 1].speed if i > 0 else (1.0 + ropes[p].strain) * grows
            above = ropes[p + i + 1].speed if i < n - 1 else ropes[p + i].speed
            apart = (1.0 if i > 0 else 0.5) + (1.0 if i < n - 1 else 0.0)
            ropes[p + i].push -= (1.0 - (i + 0.5) / n) * grows * (above - below) * n / (apart * now)


@lean_inner
def _slip(hauls, ropes, e, since):
    """Let a rope slip on the sheave of its drive, where it is pulled by more than friction bears, for a time in s.

    The strain d that the first spring loses, and its damper with it: T(e - d) + c (e' - d/dt) is what friction bears.
    """
    p, n, now, EA = hauls[e].part, hauls[e].masses, hauls[e].now, hauls[e].stiffness
    T, across, soft, strain = ropes[p].tension, hauls[e].across[1], ropes[p].soft, ropes[p].strain
    most, least = hauls[e].slack_side * hauls[e].bears, hauls[e].slack_side / hauls[e].bears
    least, most = np.sqrt(max(least**2 - across**2, 0.0)), np.sqrt(max(most**2 - across**2, 0.0))
    bears = min(max(T, least), most)
    if bears == T:
        return
    damper, lost = hauls[e].damping / since, 0.0
    for _ in range(_ROUNDS):
        spring = tension_of(strain - lost, soft, EA)
        stiff = 1.0 / (1.0 / EA + 2.0 * soft / max(spring, 1e-3 * bears) ** 3)
        step = (spring + hauls[e].damping * ropes[p].rate - damper * lost - bears) / (stiff + damper)
        lost += step
        if abs(step) * EA <= _SLIPS * bears:
            break
    way = lost * _share(hauls, e, 0) * now
    hauls[e].slipped += way
    for i in range(n):
        ropes[p + i].place -= (1.0 + ropes[p + i].strain) * (1.0 - (i + 0.5) / n) * way
    hauls[e].now += way
    ropes[p].strain -= lost
    ropes[p].rate -= lost / since
    ropes[p].tension = bears


@lean_inner
def kick_ropes(carriages, h):
    """Kick the masses of all ropes for a time in s."""
    H, R = carriages.hauls, carriages.ropes
    for e in range(H.size):
        for i in range(H[e].part, H[e].part + H[e].masses):
            R[i].speed += h * R[i].push
        for q in range(2):
            H[e].counter_speed[q] += h * H[e].counter_push[q]


@lean_inner
def drift_ropes(carriages, h):
    """Move the masses of all ropes for a time in s."""
    H, R = carriages.hauls, carriages.ropes
    for e in range(H.size):
        p, n = H[e].part, H[e].masses
        for i in range(n):
            strain = 0.5 * (R[p + i].strain + R[p + i + 1].strain)
            R[p + i].place += h * (R[p + i].speed - (1.0 + strain) * (1.0 - (i + 0.5) / n) * H[e].grows)
        for q in range(2):
            H[e].counter_place[q] += h * H[e].counter_speed[q]


@lean_inner
def haul(carriages, structure, buffers, contacts, tables, state, since):
    """Let hauling ropes pull at their carriages.

    Args:
        since: s, since they were looked at before; 0: nothing has moved.
    """
    H, R = carriages.hauls, carriages.ropes
    lines, runs, r, u, length = structure.lines, structure.runs, state.r, state.u, buffers.length
    for e in range(H.size):
        first, count = H[e].first, H[e].wheels
        reach(H, carriages.towers, e, lines, runs, length, r, u, contacts)
        H[e].now, H[e].grows = H[e].length + H[e].slipped, 0.0
        if H[e].driven == 1:
            H[e].now -= travelled(tables, contacts, first, state.t[0])
            H[e].grows = -look_up(
                tables.speed_time, tables.speed_value, contacts[first].speed_first, contacts[first].speed_count,
                state.t[0],
            )  # fmt: skip
        if H[e].counter > 0.0:
            up = aim(H, e, lines, runs, r, u, contacts, first, count, -H[e].to)[1]
            H[e].slack_side = H[e].counter + H[e].counter_weight * (H[e].high[1] - H[e].high[0] - up)
        _stretch(H, R, carriages.towers, e, since)
        _pull_back(carriages, e, lines, runs, length, r, u, contacts, 0)
        if H[e].driven == 0:
            _pull_back(carriages, e, lines, runs, length, r, u, contacts, 1)


@lean_inner
def _tension_at_pulley(hauls, ropes, e):
    """Tension in N where the rope runs over its pulley, or around its drive."""
    p, n = hauls[e].part, hauls[e].masses
    if hauls[e].driven == 1:
        return ropes[p].tension
    j = 0
    while j < n and ropes[p + j].place < 0.0:
        j += 1
    return ropes[p + j].tension + hauls[e].weight * (hauls[e].high[1] - _height(hauls, e, _edge(hauls, ropes, e, j)))


@lean_inner
def _pull_back(carriages, e, lines, runs, length, r, u, contacts, q):
    """Let the hauling rope, whose tensions are known, and the counter rope pull at carriage q of its two."""
    H, R, axes, to, along = carriages.hauls, carriages.ropes, r.shape[0], carriages.hauls[e].to, 0.0
    first, count, pull = H[e].first, H[e].wheels, R[H[e].part + H[e].masses].tension
    if q == 1:
        first, count, pull = H[e].other, H[e].others, R[H[e].part].tension
    for a in range(axes):
        H[e].free[a] = 0.0
    weighs = 0.0  # N, of what hangs freely from the carriage
    if H[e].hangs == 1:
        way, _ = _next_tower(H, carriages.towers, e)
        weighs = 0.5 * H[e].weight * max(H[e].near - way, 0.0) if pull > 0.0 else 0.0
    if H[e].hangs == 1 and H[e].towers == 0:
        far, up = aim(H, e, lines, runs, r, u, contacts, first, count, to)
        chord = np.hypot(far, up)
        for a in range(axes - 1):
            H[e].free[a] += (pull + weighs * up / chord) * far / chord * H[e].way[a]
        H[e].free[axes - 1] += (pull + weighs * up / chord) * up / chord - weighs
        weighs = 0.0
    else:
        along = to * pull
    H[e].tensions[TENSIONS * q] = np.hypot(pull, H[e].across[0])
    H[e].tensions[TENSIONS * q + 1] = np.hypot(_tension_at_pulley(H, R, e), H[e].across[1])
    if H[e].counter > 0.0:
        far, up = aim(H, e, lines, runs, r, u, contacts, first, count, -to)
        chord = np.hypot(far, up)
        way = chord
        if H[e].hangs == 0 or H[e].towers > 0:
            way = to_drive(lines, runs, length, contacts, first, count, -to)
        inertia = 0.0
        if H[e].counter_mass > 0.0:
            inertia = 2.0 * H[e].counter_stiffness * (way - H[e].counter_place[q]) / max(way, 1e-300)
            H[e].counter_push[q] = inertia / (H[e].counter_mass * max(way, 1e-300))
        back = max(H[e].counter - H[e].counter_weight * up + inertia, 0.0)
        if H[e].hangs == 1 and H[e].towers == 0:
            level, rise = hang_by_tension(far, up, H[e].counter, H[e].counter_weight)
            for a in range(axes - 1):
                H[e].free[a] += (level + inertia * far / chord) * H[e].way[a]
            H[e].free[axes - 1] += rise + inertia * up / chord
            back = np.hypot(level, rise) + inertia
        else:
            beside = 0.0
            if H[e].hangs == 1:
                span = _span_behind(H, carriages.towers, e, far)
                weighs += 0.5 * H[e].counter_weight * span * way / max(far, 1e-300)
                beside = 0.5 * H[e].counter_weight * span
            along -= to * np.sqrt(max(back**2 - beside**2, 0.0))
        H[e].tensions[TENSIONS * q + 2], H[e].tensions[TENSIONS * q + 3] = back, H[e].slack_side
    _pull(H, e, contacts, first, count, along, weighs, axes)


@lean_inner
def _span_behind(hauls, towers, e, far):
    """How far the roller next behind the carriage is, on the way of the counter rope, whose station is so far, m."""
    level = far
    for i in range(hauls[e].tower, hauls[e].tower + hauls[e].towers):
        if towers[i, 1] > hauls[e].level:
            level = min(level, towers[i, 1] - hauls[e].level)
    return level


@lean_inner
def _pull(hauls, e, contacts, first, count, pull, weighs, axes):
    """Let contacts of a carriage be pulled by a force in N along their line, and what hangs freely, all alike.

    Args:
        weighs: N, weight of what hangs from it; of that only the part across the line is new.
    """
    for k in range(first, first + count):
        square = 0.0
        for a in range(axes):
            square += contacts[k].along[a] ** 2
        on, one = 1.0 if contacts[k].state == ON else 0.0, 1.0 / np.sqrt(max(square, 1e-300))
        steep = contacts[k].along[axes - 1] * one
        for a in range(axes):
            new = (pull + weighs * steep) * contacts[k].along[a] * one + hauls[e].free[a]
            new -= weighs if a == axes - 1 else 0.0
            new *= on / count
            contacts[k].given[a] += new - contacts[k].hauled[a]
            contacts[k].hauled[a] = new


@lean
def lay_out_entry(carriages, structure, buffers, r, u, contacts, e, pull, speed):
    """Let hauling rope e rest as it pulls at its carriage with so many N, and its counter rope beside it."""
    H, lines, runs = carriages.hauls, structure.lines, structure.runs
    reach(H, carriages.towers, e, lines, runs, buffers.length, r, u, contacts)
    lay_out(H, carriages.ropes, carriages.towers, e, pull, speed)
    for q in range(2 - H[e].driven):
        first, count = (H[e].first, H[e].wheels) if q == 0 else (H[e].other, H[e].others)
        far, up = aim(H, e, lines, runs, r, u, contacts, first, count, -H[e].to)
        H[e].counter_place[q] = np.hypot(far, up)
        if H[e].hangs == 0 or H[e].towers > 0:
            H[e].counter_place[q] = to_drive(lines, runs, buffers.length, contacts, first, count, -H[e].to)
        H[e].counter_speed[q] = speed if H[e].driven == 1 else 0.0


@lean
def tension_entry(strain, soft, EA):
    """`tension_of` as Python calls it."""
    return tension_of(strain, soft, EA)
