"""Motion of a web: Verlet's method for all nodes, contacts solved in between."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.compiled import lean, lean_inner
from ropewalk.mechanics.rider import look_up
from ropewalk.webs.contacts import neighbours, pass_node, pressed, solve
from ropewalk.webs.pull import blow, pull_softly, resist
from ropewalk.webs.seats import divide, extra_energy, hold_on, join, place_at, seat
from ropewalk.webs.sheaves import hop
from ropewalk.webs.web import (
    CONTACTS,
    DAMPED,
    FORCE,
    LOADS,
    MASS,
    OFF,
    STOPPED,
    SUPPORTS,
    Array,
    Integers,
    Web,
)

# A step is no shorter than this part of the longest: speeds are differences of places over it.
TINY = 1e-4

RUNNING, DIVERGED, NOT_FOUND, AT_SHEAVE, LINE_OUT, AT_END = 0, 1, 2, 3, 4, 5


class Room(NamedTuple):
    """Room for a step, so that the loop allocates nothing."""

    movable: Integers  # (node,) 0: fixed, 1: free, 2 + k: on rail k
    soft: Array  # (node, 3) N, conservative forces of everything but slots
    drag: Array  # (node, 3) N, forces of what damps
    gust: Array  # (node, 3) N, of the wind
    guess: Array  # (node, 3) m/s, velocities at the end of a step, for what damps
    gain: Array  # (node, 3) m/s^2, accelerations at the last kick
    z: Array  # (node, 3) m
    f: Array  # (node, 3) N, of slots
    node: Integers  # (row,) nodes that are solved for
    row: Integers  # (node,) its row, -1: none
    J: Array
    b: Array
    pull: Array
    K: Array  # (9, 9)
    F: Array  # (3, 2)
    P: Array
    V: Array
    q: Array  # (contact, 3) m, places of masses
    drawn: Array  # (contact, 3) N, what the passing line takes from a contact
    slope: Array  # (contact, 3) of the line behind it then, in the direction in which it goes
    steady: Array  # (contact, 3) N, of that, at the middle of the step
    owed: Array  # (contact, 3) N s, what it has taken since the last node, for the next one
    grip: Array  # (contact,) N/m, between contacts and the middles of their masses without it
    passing: Integers  # (contact,) 1: comes to a node at the end of the step
    lags: bool  # whether anything damps
    windy: bool

    @staticmethod
    def of(web: Web) -> Room:
        """Room of the right size."""
        n, contacts = web.body.mass.size, web.seats.kind.size
        movable = np.ones(n, dtype=np.int64)
        movable[web.held.fixed] = 0
        movable[web.held.rail] = 2 + np.arange(web.held.rail.size)

        def vectors() -> Array:
            return np.zeros((n, 3))

        fabrics, held = web.cells.fabrics, web.held
        damped = web.body.drag.any() or web.links.damping.any() or fabrics[:, 3:5].any() or held.damping.any()
        size = max(1, 4 * contacts)
        square = np.zeros((3, 2))
        return Room(
            movable, vectors(), vectors(), vectors(), vectors(), vectors(), vectors(), vectors(),
            np.zeros(size, dtype=np.int64), np.full(n, -1, dtype=np.int64), np.zeros((3 * size, 3 * size)),
            np.zeros(3 * size), np.zeros(3 * size), np.zeros((9, 9)), square, square.copy(),
            square.copy(), np.zeros((contacts, 3)), np.zeros((contacts, 3)), np.zeros((contacts, 3)),
            np.zeros((contacts, 3)), np.zeros((contacts, 3)), np.zeros(contacts), np.zeros(contacts, dtype=np.int64),
            bool(damped), bool(web.wind.direction.any()),
        )  # fmt: skip


@lean_inner
def _shift(web, state, room):
    """Divide anew at fixed nodes, after contacts have been seated; what that changes in energy goes to `work`.

    A contact on a new link keeps its distance from the undivided one; one without mass goes where its forces
    balance.

    Returns:
        False if such a place is not found.
    """
    seats, r = web.seats, state.r
    work = state.work
    before = work[CONTACTS]
    work[CONTACTS] += extra_energy(web, r, state.q)
    for k in range(seats.kind.size):
        n = web.nodes + k
        room.drawn[k, 0], room.drawn[k, 1], room.drawn[k, 2] = 0.0, 0.0, 0.0
        if seats.divided[k] >= 0:
            for a in range(3):
                room.z[n, a] = r[n, a] - _straight(web, r, k, seats.divided[k], seats.before[k], a)
        else:
            for a in range(3):
                room.z[n, a] = 0.0
    join(web)
    for k in range(seats.kind.size):
        n, was = web.nodes + k, seats.last[k]
        if seats.kind[k] == OFF:
            state.parting[k] = np.nan if was >= 0 else state.parting[k]
            seats.last[k] = -1
            continue
        if seats.kind[k] != OFF:
            # Small where a contact is close to a node or an edge, as the distance from the undivided link is.
            hold_on(web, k)
            grown = 1.0 if was != seats.cell[k] else _bubble(seats.weight[k]) / _bubble(seats.before[k])
            for a in range(3):
                place = _straight(web, r, k, seats.cell[k], seats.weight[k], a) + grown * room.z[n, a]
                if was >= 0 and seats.kind[k] == FORCE:
                    done = seats.load[k, a] * (place - r[n, a])
                    work[LOADS] += done
                    work[CONTACTS] += done
                r[n, a] = place
                if was < 0 and seats.grip[k] > 0.0 and not np.isfinite(state.u[k, a]):
                    if not np.isfinite(state.q[k, a]):
                        state.q[k, a] = _straight(web, r, k, seats.cell[k], seats.weight[k], a)
                        state.q[k, a] += _straight(web, r, k, seats.cell[k], seats.beyond[k], a)
                    state.u[k, a] = _straight(web, state.v, k, seats.cell[k], seats.weight[k], a)
                    state.u[k, a] += seats.speed[k] * _along(web, r, k, a)
            seats.last[k] = seats.cell[k]
        for c in range(2):
            seats.before[k, c] = seats.weight[k, c]
    divide(web)
    done = _balance(web, state, room, False)
    work[CONTACTS] += done - extra_energy(web, r, state.q)
    for k in range(seats.kind.size):
        if not np.isfinite(state.parting[k]):
            state.parting[k] = work[CONTACTS] - before
    return np.isfinite(done)


@lean_inner
def _balance(web, state, room, draws):
    """Move contacts without mass where their forces balance, at fixed nodes.

    Args:
        draws: whether what the passing line has taken from them in the step works on the way.

    Returns:
        Work of the loads, J; NaN if no place is found.
    """
    count = solve(web, state, room, 1.0, True)
    if count < 0:
        return np.nan
    done = 0.0
    for i in range(count):
        n, k = room.node[i], room.node[i] - web.nodes
        for a in range(3):
            way = room.z[n, a] - state.r[n, a]
            if web.seats.kind[k] == FORCE:
                done += web.seats.load[k, a] * way
            if draws:
                state.work[CONTACTS] -= room.steady[k, a] * way
            state.r[n, a] = room.z[n, a]
    state.work[LOADS] += done
    return done


@lean_inner
def _straight(web, r, k, e, weight, a):
    """Component a of the place of contact k on its undivided link e."""
    return weight[0] * r[web.links.one[e], a] + weight[1] * r[web.links.other[e], a]


@lean_inner
def _bubble(weight):
    return weight[0] * weight[1]


@lean_inner
def _along(web, r, k, a):
    """Component a of the derivative of the place of contact k by the unstrained length of its undivided link."""
    e = web.seats.cell[k]
    return (r[web.links.other[e], a] - r[web.links.one[e], a]) / web.links.rest[e]


@lean_inner
def _look(web, state, room, t):
    """All forces but those of slots."""
    pull_softly(web, state.r, room.soft, state.work, room.F, room.P)
    if room.lags:
        resist(web, state.r, room.guess, room.drag, room.F, room.P, room.V)
    if room.windy:
        room.gust[:] = 0.0
        blow(web.links, web.own_links, web.wind, t, state.r, room.guess, room.gust)


@lean_inner
def _kick(web, state, room, h):
    """Kick all nodes for the time h."""
    v, mass, work = state.v, web.body.mass, state.work
    lost, blown = 0.0, 0.0
    for n in range(mass.size):
        if room.movable[n] == 0 or mass[n] == 0.0:
            continue
        k = h / mass[n]
        along = 0.0
        rail = room.movable[n] - 2
        if rail >= 0:
            for a in range(3):
                along += web.held.along[rail, a] * (room.soft[n, a] + room.drag[n, a] + room.gust[n, a])
        for a in range(3):
            gain = k * (room.soft[n, a] + room.drag[n, a] + room.gust[n, a])
            if rail >= 0:
                gain = k * along * web.held.along[rail, a]
            mean = v[n, a] + 0.5 * gain
            lost -= room.drag[n, a] * mean
            blown += room.gust[n, a] * mean
            v[n, a] += gain
            room.gain[n, a] = gain / h
    work[DAMPED] += h * lost
    work[LOADS] += h * blown
    seats, g = web.seats, web.gravity
    for k in range(seats.kind.size):
        if seats.kind[k] == MASS:
            for a in range(3):
                state.u[k, a] += h * (seats.load[k, a] / seats.mass[k] + g[a])


@lean_inner
def _drive(web, state, room, h):
    """Give what moves as prescribed the velocities with which it comes to its places after a step of length h.

    Dampers that have been looked at with the last ones follow.
    """
    held, moves, t = web.held, web.held.moves, state.t[0] + h
    for i in range(moves.node.size):
        n, k = moves.node[i], moves.spring[i]
        for a in range(3):
            place = moves.place[i, a] + look_up(moves.time, moves.value[a], moves.first[i], moves.entries[i], t)
            if k >= 0:
                old, held.rate[k, a] = held.rate[k, a], (place - held.place[k, a]) / h
                for b in range(3):
                    room.drag[held.spring[k], b] += held.damping[k, b, a] * (held.rate[k, a] - old)
            else:
                v, old = (place - state.r[n, a]) / h, state.v[n, a]
                state.work[SUPPORTS] += 0.5 * web.body.mass[n] * (v * v - old * old)
                state.v[n, a] = v


@lean_inner
def _push_supports(web, state, room, h):
    """Works at what moves as prescribed, in a kick for the time h."""
    held, moves, work = web.held, web.held.moves, state.work
    for i in range(moves.node.size):
        n, k = moves.node[i], moves.spring[i]
        for a in range(3):
            if k < 0:
                v = state.v[n, a]
                work[SUPPORTS] -= h * (room.soft[n, a] + room.drag[n, a] + room.gust[n, a]) * v
                work[DAMPED] -= h * room.drag[n, a] * v
                work[LOADS] += h * room.gust[n, a] * v
                continue
            m, F, lost = held.spring[k], 0.0, 0.0
            for b in range(3):
                F += held.stiffness[k, a, b] * (held.place[k, b] - state.r[m, b])
                lost -= held.damping[k, a, b] * (room.guess[m, b] - held.rate[k, b])
            work[SUPPORTS] += h * (F + lost) * held.rate[k, a]
            work[DAMPED] += h * lost * held.rate[k, a]


@lean_inner
def _drag_supports(web, state, room, h):
    """Works of nodes that move at the pieces beside contacts, in a step of length h; springs come to their places."""
    held, moves, links = web.held, web.held.moves, web.links
    for i in range(moves.node.size):
        n, k = moves.node[i], moves.spring[i]
        if k >= 0:
            for a in range(3):
                held.place[k, a] += h * held.rate[k, a]
            continue
        beside = False
        for p in range(web.own_links, links.on.size):
            beside = beside or (links.on[p] == 1 and (links.one[p] == n or links.other[p] == n))
        for a in range(3):
            if beside:
                state.work[SUPPORTS] -= h * room.f[n, a] * state.v[n, a]


@lean_inner
def _drift(web, state, room, h, count):
    """Move all nodes for the time h; those next to contacts as they were solved for."""
    seats, r, v, work = web.seats, state.r, state.v, state.work
    for n in range(web.nodes):
        for a in range(3):
            r[n, a] += h * v[n, a]
    for k in range(seats.kind.size):
        if seats.kind[k] == MASS:
            behind, ahead = neighbours(web, k)
            p = behind if seats.speed[k] > 0.0 else ahead
            for a in range(3):
                d = room.z[web.links.other[p], a] - room.z[web.links.one[p], a]
                room.slope[k, a] = d / web.links.rest[p]
    for i in range(count):
        n, k = room.node[i], room.node[i] - web.nodes
        for a in range(3):
            if k >= 0:
                way = room.z[n, a] - r[n, a]
                if seats.kind[k] == FORCE:
                    work[LOADS] += seats.load[k, a] * way
                room.steady[k, a] = room.drawn[k, a]
                work[CONTACTS] -= room.steady[k, a] * way
                room.owed[k, a] -= h * room.steady[k, a]
                push = h * pressed(web, room, k, room.z, a)
                state.pushed[k, a] += push
                if seats.kind[k] == MASS:
                    moved = h * (state.u[k, a] - 0.5 * push / seats.mass[k])
                    work[LOADS] += seats.load[k, a] * moved
                    state.q[k, a] += moved
                    state.u[k, a] -= push / seats.mass[k]
                r[n, a] = room.z[n, a]
                v[n, a] = _straight(web, v, k, seats.cell[k], seats.weight[k], a)
                continue
            start = r[n, a] - h * v[n, a]
            end = 2.0 * room.z[n, a] - start
            v[n, a] = 2.0 * (end - start) / h - v[n, a]
            r[n, a] = end


@lean_inner
def _until_node(web, k, t):
    """Time until contact k comes to a node of its line, s."""
    seats, course = web.seats, web.course
    if seats.wanted[k] == OFF:
        return np.inf
    xi, speed = place_at(course, k, t)
    base, count = seats.first_station[k], seats.pieces[k]
    length = seats.station[base + count]
    if speed == 0.0 or xi < 0.0 or xi > length:
        return np.inf
    near = 1e-9 * length
    p = 0
    if speed > 0.0:
        low, high = 0, count
        while high - low > 0:  # the first node that is further ahead than `near`
            p = (low + high) // 2
            if seats.station[base + p] > xi + near:
                high = p
            else:
                low = p + 1
        return (seats.station[base + min(low, count)] - xi) / speed
    low, high = 0, count
    while high - low > 0:  # the last node that is further behind
        p = (low + high + 1) // 2
        if seats.station[base + p] < xi - near:
            low = p
        else:
            high = p - 1
    return (seats.station[base + low] - xi) / speed


@lean_inner
def _aligned(web, room, t, left, step):
    """A step no longer than `step`: one of equal ones up to where a contact comes to a node, or for the time `left`.

    Notes which contacts come to one at its end. Steps that change would feed fast vibrations.
    """
    size = room.passing.size
    for k in range(size):
        way = _until_node(web, k, t)
        if way > TINY * step:
            left = min(left, way)
    cut = left / np.ceil(left / step * (1.0 - 1e-12))
    for k in range(size):
        way = _until_node(web, k, t)
        room.passing[k] = 1 if 0.0 < way <= cut * (1.0 + 1e-9) else 0
    return cut


@lean
def advance(web, state, room, until, step):
    """Move a web to the time `until`, in steps no longer than `step`.

    Returns:
        RUNNING, or why it came to an end before.
    """
    seats, links = web.seats, web.links
    led = web.held.moves.node.size > 0  # asked here: a call hands over all arrays, which costs in each step
    if not look_at_contacts(web, state, room):
        return NOT_FOUND
    _guess(state, room, 0.0)
    _look(web, state, room, state.t[0])
    while state.t[0] < until:
        t = state.t[0]
        left = until - t
        h = _aligned(web, room, t, left, step)
        if left - h < TINY * step:
            h = left
        changed = seat(web, t + 0.5 * h)
        if not _shift(web, state, room):
            return NOT_FOUND
        if changed:
            _look(web, state, room, t)
        for k in range(seats.kind.size):
            if web.course.at_end[k] == STOPPED:
                return AT_END
            if seats.kind[k] != OFF:
                for q in range(web.sheaves.link.size):
                    if web.sheaves.link[q] == seats.cell[k]:
                        return AT_SHEAVE
        if led:
            _drive(web, state, room, h)
            _push_supports(web, state, room, 0.5 * h)
        _kick(web, state, room, 0.5 * h)
        count = solve(web, state, room, h, False)
        if count < 0:
            return NOT_FOUND
        if led:
            _drag_supports(web, state, room, h)
        _drift(web, state, room, h, count)
        if not np.isfinite(_balance(web, state, room, True)):
            return NOT_FOUND
        state.t[0] = until if h == left else t + h
        if web.sheaves.node.size > 0 and not hop(links, web.sheaves, state.r, state.v, web.body.mass, state.work):
            return LINE_OUT
        _guess(state, room, 0.5 * h)
        _look(web, state, room, state.t[0])
        if led:
            _push_supports(web, state, room, 0.5 * h)
        _kick(web, state, room, 0.5 * h)
        for k in range(seats.kind.size):
            if room.passing[k] == 1 and seats.kind[k] != OFF:
                state.work[CONTACTS] += pass_node(web, state, room, k)
        if not np.isfinite(state.work[DAMPED] + state.v[0, 0] + state.v[web.nodes // 2, 2]):
            return DIVERGED
    return RUNNING


@lean_inner
def _guess(state, room, h):
    """Velocities at the end of a step, from the last forces."""
    if not (room.lags or room.windy):
        return
    for n in range(state.v.shape[0]):
        for a in range(3):
            room.guess[n, a] = state.v[n, a] + h * room.gain[n, a]


@lean
def look_at_contacts(web, state, room):
    """Seat all contacts at the present time, and find those without mass; False if one is not found."""
    seat(web, state.t[0])
    return _shift(web, state, room)
