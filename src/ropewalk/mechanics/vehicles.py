"""Vehicles: coordinates q that are coupled to each other and to the wheels below them.

With the places of the wheels appended, u = (q, places),

    M u'' + C u' + K u = weights + forces of tethers and buffers + forces of the line on the wheels

where M holds the vehicle's own inertia for q, and for a wheel what moves with it: its mass, and the node that a light
wheel rides with. A kick solves this for the velocities, with the damping at their mean before and after: however strong
a damper is, it costs no smaller step. Tethers (straight, of any direction: hanging ropes, legs) and buffers (vertical,
pushing only: contact stiffness) are explicit.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.bodies import AWAY, BOTH, INSIDE, LOCATED, MOVING_WITH, PARKED, PULLS, PUSHES, WAITING
from ropewalk.mechanics.chain import HOLD_WORK, LOAD_DAMPING, OFF, SHARED
from ropewalk.mechanics.compiled import lean_inner
from ropewalk.mechanics.elimination import solve_definite
from ropewalk.mechanics.moving_contact import force_at, location_of

# A tether that is longer or shorter than its length by less than this part of it touches: ten thousand roundings.
TOUCHING = 1e-12


@lean_inner
def is_fast(bodies, k):
    """Whether wheel k stands on something that does not give way to it."""
    phase = bodies.wheels[k].phase
    return phase in (AWAY, WAITING, PARKED)


@lean_inner
def wheel_place(strands, loads, state, bodies, k, a):
    """Component a of the place of wheel k."""
    b = state.moving_load[k]
    if b >= 0:
        return state.r[a, b]
    if b != SHARED:
        return bodies.wheels[k].r[a]
    s = loads.strand[k]
    first = strands.first[s]
    i = location_of(state.X, state.xi[k], strands.h[s], first, first + strands.links[s])
    part = (state.xi[k] - state.X[i]) / (state.X[i + 1] - state.X[i])
    return (1.0 - part) * state.r[a, i] + part * state.r[a, i + 1]


@lean_inner
def tether_square(strands, loads, state, bodies, e):
    """Square of the length of tether e, m^2, seen along the direction in which it does not act."""
    k, d, square, aside = bodies.tethers[e].wheel, bodies.tethers[e].first, 0.0, 0.0
    for a in range(state.r.shape[0]):
        way = bodies.coordinates[d + a].q - wheel_place(strands, loads, state, bodies, k, a)
        aside += way * bodies.tethers[e].across[a]
        square += way * way
    return square - aside * aside


@lean_inner
def have_dampers(bodies):
    """1 if any tether damps: then velocities of wheels are wanted at the instant of the positions, else 0."""
    found = 0
    for e in range(bodies.tethers.size):
        if bodies.tethers[e].damping > 0.0:
            found = 1
    return found


@lean_inner
def _look_at_wheels(strands, loads, state, buffers, bodies, kick):
    """Note of each wheel how it moves in a kick without its vehicle.

    Its place, its velocities before the kick and at the instant of the positions, what the line and given forces add to
    it, and what an impulse adds: the inverse of the mass that moves with the wheel.
    """
    w, X, r, f, t, led = state.w, state.X, state.r, buffers.f, state.t[0], have_dampers(bodies)
    for k in range(state.xi.size):
        wheel = bodies.wheels[k]
        s, b, U, phase = loads.strand[k], state.moving_load[k], state.speed[k], wheel.phase
        m = strands.rho[s] * strands.h[s]
        ahead = buffers.ahead if strands.damping[s] > 0.0 or led == 1 else w  # kept up where something damps
        on_line = phase in (INSIDE, LOCATED)
        fast = phase in (AWAY, WAITING, PARKED)
        first, last = strands.first[s], strands.first[s] + strands.links[s]
        i = location_of(X, state.xi[k], strands.h[s], first, last) if b == SHARED else 0
        for a in range(r.shape[0]):
            g, M = strands.gravity[a], wheel.mass[a]
            given = force_at(loads, k, t, a) + M * g
            if b >= 0:
                span = X[b + 1] - X[b - 1]
                along = U * (r[a, b + 1] - r[a, b - 1]) / span
                flux = U * (w[a, b + 1] - w[a, b - 1]) / span
                own = (f[a, b] - f[a, b - 1]) + m * (g + 2.0 * flux)
                wheel.place[a], wheel.before[a], wheel.leading[a] = r[a, b], w[a, b] + along, ahead[a, b] + along
                wheel.per_impulse[a] = 1.0 / (m + M)
                wheel.own[a] = kick * (own + given) / (m + M)
            elif b == SHARED:
                part, rest = (state.xi[k] - X[i]) / (X[i + 1] - X[i]), X[i + 1] - X[i]
                along, own, per_impulse = U * (r[a, i + 1] - r[a, i]) / rest, 0.0, 0.0
                wheel.place[a] = (1.0 - part) * r[a, i] + part * r[a, i + 1]
                wheel.before[a] = along + (1.0 - part) * w[a, i] + part * w[a, i + 1]
                wheel.leading[a] = along + (1.0 - part) * ahead[a, i] + part * ahead[a, i + 1]
                for end in range(2):
                    node, share = i + end, (part if end == 1 else 1.0 - part)
                    if first < node < last:
                        own += share * ((f[a, node] - f[a, node - 1]) / m + g)
                        per_impulse += share * share / m
                mass = 1.0 + per_impulse * M
                wheel.own[a] = kick * (own + per_impulse * given) / mass
                wheel.per_impulse[a] = per_impulse / mass
            else:
                wheel.place[a], wheel.before[a], wheel.leading[a] = wheel.r[a], wheel.v[a], wheel.ahead[a]
                wheel.own[a] = wheel.per_impulse[a] = 0.0
                if not fast:
                    if on_line:
                        given += wheel.forth[a] - wheel.behind[a] + (m * g if phase == LOCATED else 0.0)
                    wheel.own[a], wheel.per_impulse[a] = kick * given / M, 1.0 / M


@lean_inner
def _tethers(state, bodies, kick):
    """Forces of tethers and buffers, on the coordinates and (as impulses of a kick) on the wheels."""
    dim = state.r.shape[0]
    for e in range(bodies.tethers.size):
        if bodies.tethers[e].on == 0:
            continue
        k, d = bodies.tethers[e].wheel, bodies.tethers[e].first
        square, along, aside = 0.0, 0.0, 0.0
        for a in range(dim):
            aside += bodies.tethers[e].across[a] * (bodies.coordinates[d + a].q - bodies.wheels[k].place[a])
        for a in range(dim):
            way = bodies.coordinates[d + a].q - bodies.wheels[k].place[a] - aside * bodies.tethers[e].across[a]
            square += way * way
            if bodies.tethers[e].damping > 0.0:
                v = bodies.wheels[k].leading[a]
                along += way * (bodies.coordinates[d + a].ahead - v)
        length = np.sqrt(square)
        longer, acts = length - bodies.tethers[e].length, bodies.tethers[e].way
        # A leg that lands touches: roundings do not decide whether it damps its first kick.
        sure = TOUCHING * bodies.tethers[e].length
        if (acts == PULLS and longer <= -sure) or (acts == PUSHES and longer >= sure):
            continue
        spring = bodies.tethers[e].stiffness * longer
        T = spring + bodies.tethers[e].damping * along / length
        if acts != BOTH and T * acts < 0.0:
            T = 0.0
        if bodies.tethers[e].damping > 0.0:  # all of it where the end runs ahead
            state.work[LOAD_DAMPING] += kick * (T - spring) * along / length
        if T != 0.0:
            for a in range(dim):
                way = bodies.coordinates[d + a].q - bodies.wheels[k].place[a] - aside * bodies.tethers[e].across[a]
                pull = T / length * way
                bodies.coordinates[d + a].pushed -= pull
                bodies.wheels[k].push[a] += kick * pull
    z = dim - 1
    for e in range(bodies.buffers.size):
        k, d = bodies.buffers[e].wheel, bodies.buffers[e].coordinate
        side = float(bodies.buffers[e].side)
        deep = side * (bodies.wheels[k].place[z] - bodies.coordinates[d].q)
        if deep > 0.0 and bodies.wheels[k].phase != AWAY:
            force = bodies.buffers[e].stiffness * deep * side
            bodies.coordinates[d].pushed += force
            bodies.wheels[k].push[z] -= kick * force
        elif bodies.wheels[k].phase == MOVING_WITH and state.moving_load[k] != OFF:
            bodies.wheels[k].in_air += kick


@lean_inner
def _kick_vehicle(state, bodies, v, kick, lead):
    """New velocities of the coordinates of vehicle v, and the impulses that its wheels get."""
    first, n, wheels = bodies.vehicles[v].first, bodies.vehicles[v].coordinates, bodies.vehicles[v].wheels
    size = n + wheels
    A, b, M, C, K = bodies.A, bodies.b, bodies.M[v], bodies.C[v], bodies.K[v]
    # u into the last column of A, velocities into the one before it
    for i in range(size):
        if i < n:
            A[i, size + 1], A[i, size] = bodies.coordinates[first + i].q, bodies.coordinates[first + i].v
        else:
            k, a = bodies.wheel[v, i - n], bodies.axis[v, i - n]
            A[i, size + 1] = bodies.wheels[k].place[a]
            A[i, size] = bodies.wheels[k].before[a]
    for i in range(size):
        force = bodies.load[v, i] + (bodies.coordinates[first + i].pushed if i < n else 0.0)
        for j in range(size):
            force -= K[i, j] * A[j, size + 1]
        b[i] = kick * force
    damped = bodies.vehicles[v].damped == 1
    if damped:
        for i in range(size):
            for j in range(size):
                b[i] -= kick * C[i, j] * A[j, size]
    # Unknown: the change of the velocities. A wheel on firm ground has none but its own.
    for i in range(n, size):
        k, a = bodies.wheel[v, i - n], bodies.axis[v, i - n]
        own, per_impulse = bodies.wheels[k].own[a], bodies.wheels[k].per_impulse[a]
        if per_impulse > 0.0:
            b[i] += bodies.wheels[k].push[a] + own / per_impulse
    if not damped and bodies.vehicles[v].lumped == 1:
        for i in range(size):
            if i < n:
                b[i] /= M[i, i]
            else:
                k, a = bodies.wheel[v, i - n], bodies.axis[v, i - n]
                per_impulse = bodies.wheels[k].per_impulse[a]
                b[i] *= per_impulse
    else:
        for i in range(size):
            for j in range(size):
                A[i, j] = M[i, j] + (0.5 * kick * C[i, j] if damped else 0.0)
            if i >= n:
                k, a = bodies.wheel[v, i - n], bodies.axis[v, i - n]
                per_impulse = bodies.wheels[k].per_impulse[a]
                if per_impulse > 0.0:
                    A[i, i] += 1.0 / per_impulse
                else:
                    for j in range(size):
                        A[i, j] = 1.0 if i == j else 0.0
                    b[i] = 0.0
        solve_definite(A, b, size)
    if damped:
        lost = 0.0
        for i in range(size):
            for j in range(size):
                lost += (A[i, size] + 0.5 * b[i]) * C[i, j] * (A[j, size] + 0.5 * b[j])
        state.work[LOAD_DAMPING] += kick * lost
    for i in range(n):
        bodies.coordinates[first + i].v += b[i]
        bodies.coordinates[first + i].ahead = bodies.coordinates[first + i].v + lead * b[i]
    for i in range(n, size):
        k, a = bodies.wheel[v, i - n], bodies.axis[v, i - n]
        own, per_impulse = bodies.wheels[k].own[a], bodies.wheels[k].per_impulse[a]
        if per_impulse > 0.0:
            bodies.wheels[k].push[a] = (b[i] - own) / per_impulse
        else:  # what the firm ground has to bear
            impulse = kick * bodies.load[v, i]
            for j in range(size):
                impulse -= kick * (K[i, j] * A[j, size + 1] + C[i, j] * (A[j, size] + 0.5 * b[j])) + M[i, j] * b[j]
            bodies.wheels[k].push[a] += impulse


@lean_inner
def _add_drag_air(bodies, state, kick):
    """Air drag on the particles of vehicles: exact for a kick in which nothing else acts."""
    dim = state.r.shape[0]
    for d in range(bodies.coordinates.size):
        if bodies.coordinates[d].drag == 0.0:
            continue
        square = 0.0
        for a in range(dim):
            square += bodies.coordinates[d + a].v ** 2
        v = 0
        while bodies.vehicles[v].first + bodies.vehicles[v].coordinates <= d:
            v += 1
        m = bodies.M[v, d - bodies.vehicles[v].first, d - bodies.vehicles[v].first]
        slower = 1.0 / (1.0 + kick * bodies.coordinates[d].drag * np.sqrt(square) / m)
        state.work[LOAD_DAMPING] += 0.5 * m * square * (1.0 - slower * slower)
        for a in range(dim):
            bodies.coordinates[d + a].v *= slower


@lean_inner
def kick_vehicles(strands, loads, state, buffers, bodies, kick, lead):
    """New velocities of all coordinates, and the impulses for the wheels, into `bodies.push`."""
    for k in range(state.xi.size):
        for a in range(state.r.shape[0]):
            bodies.wheels[k].push[a] = 0.0
    for d in range(bodies.coordinates.size):
        bodies.coordinates[d].pushed = 0.0
    if bodies.vehicles.size == 0:
        return
    _look_at_wheels(strands, loads, state, buffers, bodies, kick)
    _tethers(state, bodies, kick)
    for v in range(bodies.vehicles.size):
        _kick_vehicle(state, bodies, v, kick, lead)
    for k in range(state.xi.size):
        if is_fast(bodies, k):  # it keeps its velocity, whatever pushes it
            for a in range(state.r.shape[0]):
                state.work[HOLD_WORK] -= bodies.wheels[k].push[a] * bodies.wheels[k].before[a]
    _add_drag_air(bodies, state, kick)
