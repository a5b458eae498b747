"""Motion of a structure and of all that it carries: one loop of kicks and drifts, the whole of it compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.compiled import inlined, lean, lean_inner
from ropewalk.mechanics.rider import look_up
from ropewalk.system.bodies import LEAVES, STAYS, arrive, balance, drift, ground, kick
from ropewalk.system.cables import blow, energy_of, pull_all, stretch_all
from ropewalk.system.contacts import AWAY, BODY, GONE, ON, bend, fade, locate, press
from ropewalk.system.structure import CARRIED, DAMPED, HELD, LOADED, MOVED, STRUCK

RUNNING, NOT_FINITE, AT_END = 0, 1, 2


class Tables(NamedTuple):
    """Histories of all contacts, one after the other."""

    speed_time: Array
    speed_value: Array
    speed_path: Array
    force_time: Array
    force_value: Array  # (axis, entry)


@inlined
def _displaced(holdings, e, a, t):
    """Component a of where a holding stands, or its springs are without force."""
    return holdings.place[e, a] + look_up(holdings.time, holdings.moved[a], holdings.table[e], holdings.entries[e], t)


@lean_inner
def _look(structure, room, contacts, tables, bodies, state, table, out, dt, since, windy):
    """All forces at the places of now: on nodes to `room.force`, of contacts to their records.

    Args:
        dt: s, for which the wind will kick.
        since: s, since they were looked at before; 0: what damps does not act.

    Returns:
        Powers of what damps and of the wind, W.
    """
    for a in range(state.r.shape[0]):
        for i in range(state.r.shape[1]):
            room.force[a, i] = structure.nodes.force[a, i]
    stretch_all(structure.runs, room, state.r)
    locate(structure, contacts, tables, state, state.t[0])
    if since > 0.0:
        state.work[STRUCK] += fade(room, contacts, since)
    _let_go(contacts, bodies)
    arrive(structure, contacts, bodies, state)
    balance(structure, room, contacts, bodies, state, table, out, since)
    bend(structure, room, contacts, state, table, out)
    lost, blown = pull_all(structure, room, state.r, since), 0.0
    press(structure, room, contacts, state, table, out)
    if windy:
        blown = blow(structure, room, state.r, state.v, state.t[0], dt)
    return lost, blown


@lean_inner
def _kick_nodes(structure, room, state, h, dragged):
    """Kick all nodes that no holding moves; returns what drag takes, J."""
    nodes, v, lost = structure.nodes, state.v, 0.0
    for a in range(v.shape[0]):
        w, F, light = v[a], room.force[a], nodes.light
        if not dragged:
            for i in range(w.size):
                w[i] += h * light[i] * F[i]
            continue
        for i in range(w.size):
            x = 0.5 * h * nodes.drag[i]
            new = ((1.0 - x) * w[i] + h * light[i] * F[i]) / (1.0 + x)
            mean = 0.5 * (new + w[i])
            if light[i] > 0.0:
                lost += nodes.drag[i] * nodes.mass[i] * mean * mean
                w[i] = new
    return h * lost


@lean_inner
def _kick_holdings(structure, room, state, h, dt, A, b):
    """Kick what is held: (M + h/2 C + dt^2/4 K) dv = h (F - C (v - v')), in the directions that are free."""
    held, nodes, r, v, t = structure.holdings, structure.nodes, state.r, state.v, state.t[0]
    axes = r.shape[0]
    for e in range(held.mass.size):
        first = held.node[held.first[e]]
        M, drag = held.mass[e], 0.0
        for a in range(axes):
            b[a] = held.force[e, a]
        for i in range(held.first[e], held.first[e] + held.nodes[e]):
            n = held.node[i]
            M += nodes.mass[n]
            drag += nodes.mass[n] * nodes.drag[n]
            for a in range(axes):
                b[a] += room.force[a, n]
        moves = held.entries[e] > 1
        rank = 0.0
        for a in range(axes):
            rank += held.free[e, a, a]
        for a in range(axes):
            room.reaction[e, a] = held.force[e, a] - b[a]
        if rank == 0.0:
            if moves:  # places half a kick before and after
                for a in range(axes):
                    way = _displaced(held, e, a, t + 0.5 * h) - _displaced(held, e, a, t - 0.5 * h)
                    state.work[MOVED] -= b[a] * way
            continue
        for a in range(axes):
            F = b[a]
            for c in range(axes):
                far = _displaced(held, e, c, t)
                rate = (_displaced(held, e, c, t + 0.5 * h) - _displaced(held, e, c, t - 0.5 * h)) / h if moves else 0.0
                spring = held.stiffness[e, a, c] * (far - r[c, first])
                F += spring - held.damping[e, a, c] * (v[c, first] - rate)
            A[a, axes] = h * (F - drag * v[a, first])
        # within the free directions: P A P + (1 - P)
        for a in range(axes):
            b[a] = 0.0
            for c in range(axes):
                b[a] += held.free[e, a, c] * A[c, axes]
        for a in range(axes):
            for c in range(axes):
                A[a, c] = 0.5 * h * held.damping[e, a, c] + 0.25 * dt * dt * held.stiffness[e, a, c]
                A[a, c] += (M + 0.5 * h * drag) * held.free[e, a, c] + (1.0 if a == c else 0.0) - held.free[e, a, c]
        _cramer(A, b, axes)
        lost = 0.0
        for a in range(axes):
            rate_a, way = v[a, first] + 0.5 * b[a], 0.0
            if moves:
                way = _displaced(held, e, a, t + 0.5 * h) - _displaced(held, e, a, t - 0.5 * h)
                rate_a -= way / h
            for c in range(axes):
                rate_c, far = v[c, first] + 0.5 * b[c], _displaced(held, e, c, t)
                if moves:
                    rate_c -= (_displaced(held, e, c, t + 0.5 * h) - _displaced(held, e, c, t - 0.5 * h)) / h
                lost += rate_a * held.damping[e, a, c] * rate_c
                state.work[MOVED] += way * (
                    held.stiffness[e, a, c] * (far - r[c, first]) - held.damping[e, a, c] * rate_c
                )
            lost += drag * (v[a, first] + 0.5 * b[a]) ** 2
        state.work[DAMPED] += h * lost
        for a in range(axes):
            room.reaction[e, a] += (M - held.mass[e]) * b[a] / h + drag * (v[a, first] + 0.5 * b[a])
        for i in range(held.first[e], held.first[e] + held.nodes[e]):
            for a in range(axes):
                v[a, held.node[i]] += b[a]


@inlined
def _cramer(A, b, n):
    """Solve A x = b of two or three unknowns, in place; A is positive definite."""
    for c in range(n):
        for i in range(c + 1, n):
            factor = A[i, c] / A[c, c]
            for j in range(c, n):
                A[i, j] -= factor * A[c, j]
            b[i] -= factor * b[c]
    for c in range(n - 1, -1, -1):
        for j in range(c + 1, n):
            b[c] -= A[c, j] * b[j]
        b[c] /= A[c, c]


@lean_inner
def _drift(structure, state, h):
    """Move all nodes for the time h; what moves as prescribed comes to its place."""
    r, v, held = state.r, state.v, structure.holdings
    for a in range(r.shape[0]):
        x, w = r[a], v[a]
        for i in range(x.size):
            x[i] += h * w[i]
    for e in range(held.mass.size):
        rank = 0.0
        for a in range(r.shape[0]):
            rank += held.free[e, a, a]
        if held.entries[e] > 1 and rank == 0.0:
            for i in range(held.first[e], held.first[e] + held.nodes[e]):
                n = held.node[i]
                for a in range(r.shape[0]):
                    place = _displaced(held, e, a, state.t[0] + h)
                    v[a, n] = (place - r[a, n]) / h
                    r[a, n] = place


@lean_inner
def _let_go(contacts, bodies):
    """Note loads all of whose contacts have left their lines."""
    for i in range(bodies.gone.size):
        if bodies.gone[i] != STAYS:
            continue
        leaves = True
        for k in range(contacts.size):
            if contacts[k].load == i and (contacts[k].state != AWAY or contacts[k].been == 0):
                leaves = False
        if leaves:
            bodies.gone[i] = LEAVES
            for k in range(contacts.size):
                if contacts[k].load == i:
                    contacts[k].state = GONE


@lean_inner
def _book(structure, room, contacts, state, h):
    """Works of given forces since the last look, and of what moves contacts along, for a kick of the time h."""
    axes = state.r.shape[0]
    for k in range(contacts.size):
        if contacts[k].state != ON:
            for a in range(axes):
                contacts[k].before[a] = np.nan
            continue
        for a in range(axes):
            way = contacts[k].place[a] - contacts[k].before[a]
            if np.isfinite(way):
                state.work[LOADED] += 0.5 * (contacts[k].given[a] + contacts[k].last[a]) * way
            contacts[k].before[a], contacts[k].last[a] = contacts[k].place[a], contacts[k].given[a]
            push = contacts[k].carried * contacts[k].d[a]
            if np.isfinite(way):
                state.work[CARRIED] += 0.5 * (push + contacts[k].lagged[a]) * (contacts[k].d[a] - contacts[k].was[a])
            contacts[k].was[a], contacts[k].lagged[a] = contacts[k].d[a], push
        if contacts[k].speed != 0.0:
            pushed = 0.0
            for a in range(axes):
                pushed -= contacts[k].N[a] * contacts[k].along[a]
                pushed -= 0.5 * contacts[k].d[a] ** 2 * contacts[k].turn
            for j in range(3):
                pull = room.pull[contacts[k].link[j]]
                pushed += contacts[k].change[j] / structure.runs.h[contacts[k].run] * pull * contacts[k].kink
            if contacts[k].kind == BODY:
                state.work[HELD] += h * contacts[k].speed * pushed
            else:  # nobody holds a given force: what its contact draws from the line is lost, or gained
                state.work[STRUCK] -= h * contacts[k].speed * pushed


@lean_inner
def _is_refused(contacts):
    """Whether a load that was to stay on its line has come to an end of it."""
    found = False
    for k in range(contacts.size):
        found = found or (contacts[k].refuses == 1 and contacts[k].been == 1 and contacts[k].state != ON)
    return found


@lean_inner
def _is_finite(r, v):
    total = 0.0
    for a in range(r.shape[0]):
        for i in range(r.shape[1]):
            total += abs(r[a, i]) + abs(v[a, i])
    return np.isfinite(total)


@lean
def stand(structure, contacts, state):
    """Let bodies that are not on their lines stand on level ground beside them."""
    for k in range(contacts.size):
        if contacts[k].kind == BODY and contacts[k].state == AWAY:
            ground(structure, contacts, state, k)


@lean
def advance(structure, room, contacts, tables, bodies, state, table, out, A, b, dt, steps):
    """Move a state by some steps of the length dt in s; returns RUNNING, or what went wrong."""
    windy = False
    for a in range(state.r.shape[0]):
        windy = windy or structure.wind.direction[a] != 0.0
    dragged = False
    for i in range(structure.nodes.drag.size):
        dragged = dragged or structure.nodes.drag[i] > 0.0
    begin = state.t[0]
    for step in range(steps + 1):
        half = 1 if step in (0, steps) else 0
        h = 0.5 * dt if half == 1 else dt
        since = dt if step > 0 else 0.0
        lost, blown = _look(structure, room, contacts, tables, bodies, state, table, out, h, since, windy)
        ends = step > 0 and _is_refused(contacts)
        if ends:
            half, h = 1, 0.5 * dt
        state.work[DAMPED] += h * lost
        state.work[LOADED] += h * blown
        _book(structure, room, contacts, state, h)
        state.work[DAMPED] += _kick_nodes(structure, room, state, h, dragged)
        _kick_holdings(structure, room, state, h, dt, A, b)
        kick(contacts, bodies, state, h, half)
        if step < steps:
            _drift(structure, state, dt)
            drift(bodies, state, dt)
            state.t[0] = begin + (step + 1) * dt
        if step % 64 == 0 and not _is_finite(state.r, state.v):
            return NOT_FINITE
        if ends:
            return AT_END
    return RUNNING if _is_finite(state.r, state.v) else NOT_FINITE


@lean
def look(structure, room, contacts, tables, bodies, state, table, out):
    """Find all forces at the places of now, as nothing moved."""
    windy = False
    for a in range(state.r.shape[0]):
        windy = windy or structure.wind.direction[a] != 0.0
    _look(structure, room, contacts, tables, bodies, state, table, out, 0.0, 0.0, windy)


@lean
def stored(structure, room, contacts, tables, bodies, state, table, out):
    """Energy stored in all runs with their kinks, J."""
    stretch_all(structure.runs, room, state.r)
    locate(structure, contacts, tables, state, state.t[0])
    bend(structure, room, contacts, state, table, out)
    total = energy_of(structure, room, state.r)
    for k in range(contacts.size):
        if contacts[k].state == ON:
            for a in range(state.r.shape[0]):
                total += 0.5 * contacts[k].d[a] ** 2 * contacts[k].firm
    return total
