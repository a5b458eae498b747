"""Tethers: springs that turn, between a contact and a particle. Payloads hang by them, and legs are such, too.

    T = k (l - L) + c l',   l: length of the span from the contact to the particle, without what lies `across`.

Those that pull have no force where they are slack, those that push none where they are longer than L. A leg is watched:
while it swings until its foot comes down to the line, while it stands until it no longer pushes.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.bodies import PULLS, PUSHES, STANDS, SWINGS
from ropewalk.mechanics.compiled import lean, lean_inner
from ropewalk.mechanics.moving_contact import look_up_integral
from ropewalk.mechanics.vehicles import TOUCHING
from ropewalk.system.elements.profile import height_at
from ropewalk.system.elements.spline import WIDTH, share

_REAL, _CODE, _VECTOR = "f8", "i8", ("f8", (3,))
TETHER = np.dtype(
    [
        ("contact", _CODE),  # from which it hangs, or on which it stands
        ("first", _CODE),  # first of the coordinates of the particle at its end
        ("length", _REAL),  # m
        ("full", _REAL),  # m, length that it grows to
        ("growth", _REAL),  # m/s, while it does
        ("hoist_first", _CODE),  # where the table of the speed begins at which it is taken in
        ("hoist_count", _CODE),  # its entries; 0: it is not taken in
        ("begin", _REAL),  # m, its length at time zero
        ("shortest", _REAL),  # m, that it will be
        ("grows", _REAL),  # m/s, by which it has become longer in the last step
        ("stiffness", _REAL),  # N/m
        ("damping", _REAL),  # N s/m, while it pulls or pushes
        ("way", _CODE),  # PULLS or PUSHES
        ("on", _CODE),  # 1: it holds
        ("watch", _CODE),  # of a leg: what is waited for
        ("across", *_VECTOR),  # unit vector in whose direction it does not act; zero: it acts in all
        ("reach", *_VECTOR),  # m, of a leg that swings: its foot, seen from the particle
        ("span", *_VECTOR),  # unit vector from the contact to the particle
        ("long", _REAL),  # m, how long it is now
        ("force", _REAL),  # N, of its spring and its damper, positive if it pulls
        ("damper", _REAL),  # N, of the damper alone
    ],
    align=True,
)
# Rounds in which the place below a foot is found, and the part of a link to which it is.
ROUNDS, FOUND = 20, 1e-14


@lean_inner
def pull(contacts, bodies, state, e, rate):
    """Find the span and the force of tether e.

    Args:
        rate: 1/s, one over the time since `bodies.old` were the places of contacts without mass; 0: their velocities
            are known.
    """
    axes, u, w, T = state.r.shape[0], state.u, state.w, bodies.tethers
    first, own = T[e].first, contacts[T[e].contact].first
    square, along, aside = 0.0, 0.0, 0.0
    for a in range(axes):
        aside += T[e].across[a] * (u[first + a] - u[own + a])
    for a in range(axes):
        T[e].span[a] = u[first + a] - u[own + a] - aside * T[e].across[a]
        square += T[e].span[a] ** 2
        below = w[own + a]
        if rate > 0.0 and bodies.per_mass[own + a] == 0.0:
            below = (u[own + a] - bodies.old[own + a]) * rate
        along += T[e].span[a] * (w[first + a] - below)
    T[e].long = np.sqrt(square)
    for a in range(axes):
        T[e].span[a] /= max(T[e].long, 1e-300)
    T[e].force = T[e].damper = 0.0
    longer, sure = T[e].long - T[e].length, TOUCHING * T[e].length
    if T[e].on == 0 or (T[e].way == PULLS and longer <= 0.0) or (T[e].way == PUSHES and longer >= sure):
        return
    spring = T[e].stiffness * longer
    T[e].damper = T[e].damping * (along / max(T[e].long, 1e-300) - T[e].grows)
    T[e].force = spring + T[e].damper
    if T[e].force * T[e].way < 0.0:
        T[e].force, T[e].damper = 0.0, -spring


@lean_inner
def bear(contacts, bodies, state, A, b, p, i, rate):
    """Add the tethers at coordinate i of part p, that of a contact without mass, to the equations of its place.

    Args:
        A, b: the equations A u = b of the part.
        rate: see `pull`.
    """
    c = bodies.at[p, i]
    k, a = bodies.contact[c], bodies.axis[c]
    for e in range(bodies.tethers.size):
        if bodies.tethers[e].contact != k or bodies.tethers[e].on == 0:
            continue
        pull(contacts, bodies, state, e, rate)
        T, n = bodies.tethers[e].force, bodies.tethers[e].span
        b[i] += T * n[a]
        if T == 0.0:
            continue
        stiff, turn = bodies.tethers[e].stiffness + bodies.tethers[e].damping * rate, T / bodies.tethers[e].long
        for j in range(bodies.size[p]):
            d = bodies.at[p, j]
            if bodies.contact[d] == k:
                g, across = bodies.axis[d], bodies.tethers[e].across
                change = stiff * n[a] * n[g] - turn * (n[a] * n[g] + across[a] * across[g])
                change += turn if d == c else 0.0
                A[i, j] += change
                b[i] += change * state.u[d]


@lean_inner
def hang(contacts, bodies, state):
    """Add the forces of all tethers to those of bodies."""
    for e in range(bodies.tethers.size):
        if bodies.tethers[e].on == 0:
            bodies.tethers[e].damper = 0.0
            continue
        pull(contacts, bodies, state, e, 0.0)
        first, own = bodies.tethers[e].first, contacts[bodies.tethers[e].contact].first
        for a in range(state.r.shape[0]):
            force = bodies.tethers[e].force * bodies.tethers[e].span[a]
            bodies.f[first + a] -= force
            bodies.f[own + a] += force


@lean_inner
def grow(contacts, bodies, state, dt):
    """Let legs that are stretched grow for a time in s; returns the work of it, J."""
    work = 0.0
    for e in range(bodies.tethers.size):
        if bodies.tethers[e].growth == 0.0 or bodies.tethers[e].on == 0:
            continue
        length, full = bodies.tethers[e].length, bodies.tethers[e].full
        if length < full:
            pull(contacts, bodies, state, e, 0.0)
            new = min(length + bodies.tethers[e].growth * dt, full)
            before, after = max(length - bodies.tethers[e].long, 0.0), max(new - bodies.tethers[e].long, 0.0)
            work += 0.5 * bodies.tethers[e].stiffness * (after * after - before * before)
            bodies.tethers[e].length = new
    return work


@lean_inner
def hoist(bodies, contacts, state, dt):
    """Take in ropes of payloads after a drift for a time in s, whose stiffness EA/L goes with 1 / length.

    Returns:
        The work of it, J: EA (e + e^2/2) is what the energy EA L e^2/2 changes by with the length L, e: strain, at the
        mean of the places before and behind the drift, as kicks have it.
    """
    work, T = 0.0, bodies.tethers
    for e in range(T.size):
        if T[e].hoist_count == 0:
            continue
        gone = look_up_integral(
            bodies.hoist_time, bodies.hoist_value, bodies.hoist_path, T[e].hoist_first, T[e].hoist_count,
            state.t[0] + dt,
        )  # fmt: skip
        square, old, new = 0.0, T[e].length, T[e].begin - gone
        for a in range(state.r.shape[0]):
            square += (state.u[T[e].first + a] - state.u[contacts[T[e].contact].first + a]) ** 2
        before, after = max(T[e].long / old - 1.0, 0.0), max(np.sqrt(square) / new - 1.0, 0.0)
        pulls = before * (1.0 + 0.5 * before) + after * (1.0 + 0.5 * after)
        work += 0.5 * T[e].stiffness * old * pulls * (old - new)
        T[e].grows = (new - old) / dt
        T[e].length, T[e].stiffness = new, T[e].stiffness * old / new
    return work


@lean_inner
def seek(lines, runs, r, line, ex, ey, x, weight, slope):
    """Look up the place of a line, which does not turn back, above or below a level place.

    Args:
        r: (axis, node) m.
        line: its number.
        ex, ey: level unit vector.
        x: m along it.
        weight, slope: (WIDTH,), overwritten, see `share`.

    Returns:
        Its run, links along that, first node that shares it, and m along the vector by which the line ends before.
    """
    run, last = lines.first[line], lines.first[line] + lines.runs[line] - 1
    far = runs.first[last] + runs.links[last]
    forward = 1.0 if _level(r, far, ex, ey) > _level(r, runs.first[run], ex, ey) else -1.0
    while run < last and (x - _level(r, runs.first[run] + runs.links[run], ex, ey)) * forward > 0.0:
        run += 1
    first, n = runs.first[run], runs.links[run]
    i = 0
    while i < n - 1 and (x - _level(r, first + i + 1, ex, ey)) * forward > 0.0:
        i += 1
    here = _level(r, first + i, ex, ey)
    u = i + min(max((x - here) / (_level(r, first + i + 1, ex, ey) - here), 0.0), 1.0)
    for _ in range(ROUNDS):
        base, place, change = first + share(u, n, weight, slope), 0.0, 0.0
        for j in range(min(WIDTH, n + 1)):
            place += weight[j] * _level(r, base + j, ex, ey)
            change += slope[j] * _level(r, base + j, ex, ey)
        new = min(max(u + min(max((x - place) / change, -1.0), 1.0), 0.0), float(n))
        if abs(new - u) <= FOUND * n:
            break
        u = new
    return run, u, base, x - place


@lean_inner
def _level(r, i, ex, ey):
    return ex * r[0, i] + (ey * r[1, i] if r.shape[0] == 3 else 0.0)


@lean_inner
def height(lines, runs, r, line, ex, ey, x, weight, slope):
    """Height of a line in m, with its profile, above or below a level place; beyond its ends it goes on straight."""
    run, u, base, over = seek(lines, runs, r, line, ex, ey, x, weight, slope)
    rise, change, top = 0.0, 0.0, r.shape[0] - 1
    place, _ = height_at(lines.profiles, line, lines.begin[run] + u * runs.h[run])
    for j in range(min(WIDTH, runs.links[run] + 1)):
        place += weight[j] * r[top, base + j]
        rise += slope[j] * r[top, base + j]
        change += slope[j] * _level(r, base + j, ex, ey)
    return place + over * rise / change


@lean_inner
def gap(lines, runs, contacts, bodies, state):
    """How far the next leg is from landing or taking off, m: infinite if none is watched, at most 0 if one is due."""
    found, top, T = np.inf, state.r.shape[0] - 1, bodies.tethers
    for e in range(T.size):
        if T[e].watch == STANDS:
            pull(contacts, bodies, state, e, 0.0)
            found = min(found, T[e].length - T[e].long)
        elif T[e].watch == SWINGS:
            k, first, chord = T[e].contact, T[e].first, 0.0
            ex, ey = 1.0, 0.0
            if T[e].across[0] != 0.0 or T[e].across[1] != 0.0:
                ex, ey = T[e].across[1], -T[e].across[0]
            elif top == 2:
                chord = abs(_chord(lines, runs, state.r, contacts[k].line, 1))
                if chord > abs(_chord(lines, runs, state.r, contacts[k].line, 0)):
                    ex, ey = 0.0, 1.0
            x = ex * (state.u[first] + T[e].reach[0])
            if top == 2:
                x += ey * (state.u[first + 1] + T[e].reach[1])
            own = contacts[k].weight, contacts[k].slope
            below = height(lines, runs, state.r, contacts[k].line, ex, ey, x, own[0], own[1])
            found = min(found, state.u[first + top] + T[e].reach[top] - below)
    return found


@lean_inner
def _chord(lines, runs, r, line, a):
    last = lines.first[line] + lines.runs[line] - 1
    return r[a, runs.first[last] + runs.links[last]] - r[a, runs.first[lines.first[line]]]


@lean
def seek_entry(lines, runs, r, line, ex, ey, x, weight, slope):
    """`seek` as Python calls it."""
    return seek(lines, runs, r, line, ex, ey, x, weight, slope)


@lean
def height_entry(lines, runs, r, line, ex, ey, x, weight, slope):
    """`height` as Python calls it."""
    return height(lines, runs, r, line, ex, ey, x, weight, slope)


@lean
def gap_entry(lines, runs, contacts, bodies, state):
    """`gap` as Python calls it."""
    return gap(lines, runs, contacts, bodies, state)
