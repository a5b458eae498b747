"""Kicks and drifts: the flows that a step is composed of, of the nodes and of the loads.

A kick changes velocities at fixed positions, a drift positions at fixed velocities. Both are done in one pass over the
nodes; what the loads add to both follows.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import FRICTIONLESS, HOLD_WORK, LINE_DAMPING, LOAD_WORK, MATERIAL, OFF, SHARED, STAY
from ropewalk.mechanics.compiled import apart, inlined, lean_inner, summing
from ropewalk.mechanics.moving_contact import (
    even_out,
    force_at,
    has_arrived,
    location_of,
    look_up,
    look_up_integral,
    material_speed,
    speed_at,
)
from ropewalk.solve.ends import STRONGEST, kicked_velocity


@apart
def _go_over(per_mass, gx, gy, gz, way, decay, lead, x, y, z, u, s, v, ux, sx, vx, fx, fy, fz):
    """Kick and drift nodes: w <- w + per_mass [f] + kick g, then along with drag r <- r + way w, w <- decay w.

    Damped lines also want the velocities at the instant of the new positions: those of `ahead`, led on by `lead` kicks.

    Args:
        gx, gy, gz: m/s, gravity times the kick; gy is not looked at in the plane.
        x, y, z, u, s, v: (node,) m and m/s, positions and velocities; y and s are None in the plane.
        ux, sx, vx: (node,) m/s, those velocities, overwritten; None without damping.
        fx, fy, fz: two times (node,) N, force vectors of the links behind and ahead.
    """
    for i in range(x.size):
        gain_x, gain_z = per_mass * (fx[1][i] - fx[0][i]) + gx, per_mass * (fz[1][i] - fz[0][i]) + gz
        new_u, new_v = u[i] + gain_x, v[i] + gain_z
        u[i], v[i] = decay * new_u, decay * new_v
        x[i] += way * new_u
        z[i] += way * new_v
        if ux is not None:
            ux[i], vx[i] = decay * (new_u + lead * gain_x), decay * (new_v + lead * gain_z)
        if y is not None:
            gain_y = per_mass * (fy[1][i] - fy[0][i]) + gy
            new_s = s[i] + gain_y
            s[i] = decay * new_s
            y[i] += way * new_s
            if ux is not None:
                sx[i] = decay * (new_s + lead * gain_y)


@inlined
def _update(r, w, ahead, f, i0, i1, per_mass, gravity, kick, way, decay, lead, damped):
    """`_go_over` the nodes between i0 and i1."""
    j = i0 + 1
    x, z, u, v = r[0, j:i1], r[-1, j:i1], w[0, j:i1], w[-1, j:i1]
    fx, fz = (f[0, i0 : i1 - 1], f[0, j:i1]), (f[-1, i0 : i1 - 1], f[-1, j:i1])
    ux, vx, gx, gz = ahead[0, j:i1], ahead[-1, j:i1], kick * gravity[0], kick * gravity[-1]
    if r.shape[0] == 2:
        if damped:
            _go_over(per_mass, gx, 0.0, gz, way, decay, lead, x, None, z, u, None, v, ux, None, vx, fx, None, fz)
        else:
            _go_over(per_mass, gx, 0.0, gz, way, decay, lead, x, None, z, u, None, v, None, None, None, fx, None, fz)
    else:
        y, s, sx, gy = r[1, j:i1], w[1, j:i1], ahead[1, j:i1], kick * gravity[1]
        fy = (f[1, i0 : i1 - 1], f[1, j:i1])
        if damped:
            _go_over(per_mass, gx, gy, gz, way, decay, lead, x, y, z, u, s, v, ux, sx, vx, fx, fy, fz)
        else:
            _go_over(per_mass, gx, gy, gz, way, decay, lead, x, y, z, u, s, v, None, None, None, fx, fy, fz)


@inlined
def _drift_with_drag(drag, drift):
    """Way over velocity of a drift that drag slows down, s, and the part of the velocity that is left at its end."""
    if drag == 0.0:
        return drift, 1.0
    decay = np.exp(-min(drag * drift, STRONGEST))
    return (1.0 - decay) / drag, decay


@summing
def _sum_of_squares(w, i0, i1):
    """Sum of the squared velocities of the nodes between i0 and i1."""
    total = 0.0
    for a in range(w.shape[0]):
        v = w[a, i0 + 1 : i1]
        for i in range(v.size):
            total += v[i] * v[i]
    return total


@inlined
def move_nodes(strands, state, buffers, kick, drift, lead, led):
    """Kick and drift all nodes.

    Args:
        led: 1: velocities at the instant of the new positions are wanted of lines without damping, too.

    Returns:
        What the drag takes from the motion, J.
    """
    lost = 0.0
    for s in range(strands.first.size):
        first, last, m = strands.first[s], strands.first[s] + strands.links[s], strands.rho[s] * strands.h[s]
        way, decay = _drift_with_drag(strands.drag[s], drift)
        _update(
            state.r, state.w, buffers.ahead, buffers.f, first, last, kick / m, strands.gravity, kick, way, decay, lead,
            strands.damping[s] > 0.0 or led == 1,
        )  # fmt: skip
        if strands.drag[s] > 0.0:  # exactly what the decay takes from the kinetic energy
            lost += 0.5 * m * (1.0 / decay**2 - 1.0) * _sum_of_squares(state.w, first, last)
    return lost


@inlined
def _kick_moving_load(strands, loads, state, buffers, k, kick, way, decay, lead, ends, bodies):
    """Momentum for the node b that rides with load k: its force, and the flux of momentum past it.

    The links and gravity have already kicked all nodes, and these have drifted, see _update.

    Returns:
        The work of the force, J.
    """
    r, w, X, ahead, f, dr, dw = state.r, state.w, state.X, buffers.ahead, buffers.f, buffers.dr, buffers.dw
    b, U, s = state.moving_load[k], state.speed[k], loads.strand[k]
    m, span, work = strands.rho[s] * strands.h[s], X[b + 1] - X[b - 1], 0.0
    per_mass, restore, rate = 1.0 / m, 1.0 / decay, U / span
    for a in range(r.shape[0]):
        F = force_at(loads, k, state.t[0], a)
        if ends is None:
            after = (w[a, b + 1] - w[a, b - 1]) * restore
        else:
            after = kicked_velocity(state, ends, b + 1, decay, a) - kicked_velocity(state, ends, b - 1, decay, a)
        flux = kick * rate * 0.5 * (dw[a, k] + after)
        pulled = kick * ((f[a, b] - f[a, b - 1]) * per_mass + strands.gravity[a])
        impulse = kick * F
        if bodies is not None:  # a light wheel: its mass moves with the contact, at w + U r'
            M = bodies.wheels[k].mass[a]
            impulse = (
                (impulse + bodies.wheels[k].push[a] + M * (kick * strands.gravity[a] - pulled - 2.0 * flux))
                * m
                / (m + M)
            )
            bodies.wheels[k].on_line[a] = impulse / kick
        extra = impulse * per_mass + flux
        kicked, new = pulled + extra, w[a, b] + decay * extra
        w[a, b] = new
        r[a, b] += way * extra
        if strands.damping[s] > 0.0 or bodies is not None:
            ahead[a, b] += decay * (1.0 + lead) * extra
        if a > 0 or loads.contact[k] != FRICTIONLESS:  # of that one the hold force decides how fast it moves along x
            work += kick * F * (new * restore - 0.5 * kicked + rate * dr[a, k])
        else:
            buffers.before[k] = new * restore - kicked
        if bodies is not None and decay < 1.0:
            before, noted = new * restore, new - decay * extra
            lost = _spare(bodies.wheels[k].mass[a], m, before, way, decay, r, w, a, b)
            state.work[LINE_DAMPING] += lost - 0.5 * m * (1.0 / decay**2 - 1.0) * noted * noted
    return work


@inlined
def _spare(M, m, v, way, decay, r, w, a, b):
    """Let drag slow down a node with a mass M on it as if it acted on the line's own m only; v is without drag.

    Returns:
        What the drag takes from the motion, J.
    """
    part = decay ** (m / (m + M))
    w[a, b] = part * v
    r[a, b] += ((1.0 - part) / (1.0 - decay) * (m + M) / m - 1.0) * way * v
    return 0.5 * (m + M) * (1.0 - part * part) * v * v


@inlined
def _uneven(strands, state, s, b, node):
    """How much more of a link than others node `node` beside the riding node b bears: half of what theirs is longer."""
    return 0.5 * (abs(state.X[b] - state.X[node]) / strands.h[s] - 1.0)


@inlined
def _shift_weight(strands, loads, state, buffers, k, kick, way, decay, lead, bodies):
    """Weight of the nodes beside the riding node b: of half the links that they really have, not of uniform ones.

    Without it a load of no force at all would stir the rope it travels on.
    """
    s, b = loads.strand[k], state.moving_load[k]
    first, last = strands.first[s], strands.first[s] + strands.links[s]
    for side in (-1, 1):
        node = b + side
        if first < node < last:
            part = kick * _uneven(strands, state, s, b, node)
            for a in range(state.r.shape[0]):
                if strands.gravity[a] != 0.0:
                    extra = part * strands.gravity[a]
                    state.w[a, node] += decay * extra
                    state.r[a, node] += way * extra
                    if strands.damping[s] > 0.0 or bodies is not None:
                        buffers.ahead[a, node] += decay * (1.0 + lead) * extra


@inlined
def _kick_shared(strands, loads, state, buffers, k, kick, way, decay, lead, bodies):
    """Momentum from a load that is shared by the two nodes of its link; those on supports are left to `move_ends`.

    Returns:
        The work of the force, J.
    """
    r, w, X, ahead, f = state.r, state.w, state.X, buffers.ahead, buffers.f
    s, xi, U = loads.strand[k], state.xi[k], state.speed[k]
    first, last = strands.first[s], strands.first[s] + strands.links[s]
    i, m = location_of(X, xi, strands.h[s], first, last), strands.rho[s] * strands.h[s]
    part, work = (xi - X[i]) / (X[i + 1] - X[i]), 0.0
    for a in range(r.shape[0]):
        F = force_at(loads, k, state.t[0], a)
        v = U * (r[a, i + 1] - r[a, i]) / (X[i + 1] - X[i])
        impulse = kick * F
        if bodies is not None:
            M, per_impulse, pulled = bodies.wheels[k].mass[a], 0.0, 0.0
            for end in range(2):
                node, share = i + end, (part if end == 1 else 1.0 - part)
                if first < node < last:
                    per_impulse += share * share / m
                    pulled += share * kick * ((f[a, node] - f[a, node - 1]) / m + strands.gravity[a])
            impulse = (impulse + bodies.wheels[k].push[a] + M * (kick * strands.gravity[a] - pulled)) / (
                1.0 + per_impulse * M
            )
            bodies.wheels[k].on_line[a] = impulse / kick
        for end in range(2):
            node, share = i + end, (part if end == 1 else 1.0 - part)
            if first < node < last:
                extra, weight = share * impulse / m, strands.gravity[a]
                for j in range(state.moving_load.size):
                    if abs(state.moving_load[j] - node) == 1:
                        weight += strands.gravity[a] * _uneven(strands, state, s, state.moving_load[j], node)
                kicked = kick * ((f[a, node] - f[a, node - 1]) / m + weight) + extra
                w[a, node] += decay * extra
                ahead[a, node] += decay * (1.0 + lead) * extra
                r[a, node] += way * extra
                v += share * (w[a, node] / decay - 0.5 * kicked)
        work += kick * F * v
    return work


@inlined
def kick_loads(strands, loads, state, buffers, kick, drift, lead, ends, bodies):
    """Give the nodes at the loads what these add to the kick that all nodes have had.

    Returns:
        The work of the forces, J.
    """
    work = 0.0
    for k in range(state.xi.size):
        way, decay = _drift_with_drag(strands.drag[loads.strand[k]], drift)
        if state.moving_load[k] >= 0:
            _shift_weight(strands, loads, state, buffers, k, kick, way, decay, lead, bodies)
            work += _kick_moving_load(strands, loads, state, buffers, k, kick, way, decay, lead, ends, bodies)
        elif state.moving_load[k] == SHARED:
            work += _kick_shared(strands, loads, state, buffers, k, kick, way, decay, lead, bodies)
    return work


@inlined
def _carry(r, X, dr, k, b, xi, way):
    """Carry the riding node b over the material by `way` along the line."""
    X[b] = xi
    part = way * 0.5 / (X[b + 1] - X[b - 1])
    for a in range(r.shape[0]):
        r[a, b] += part * (dr[a, k] + r[a, b + 1] - r[a, b - 1])


@lean_inner
def _travel(strands, loads, state, dr, k, dt):
    """Let load k travel for dt at a speed that depends on the state of the line."""
    t, b, xi = state.t[0], state.moving_load[k], state.xi[k]
    U = material_speed(strands, loads, state, k, speed_at(loads, k, t))
    state.xi[k] = xi + dt * U
    if b >= 0:
        _carry(state.r, state.X, dr, k, b, state.xi[k], dt * U)
    better = 0.5 * (U + material_speed(strands, loads, state, k, speed_at(loads, k, t + dt)))
    state.xi[k] = xi + dt * better
    if b >= 0:
        _carry(state.r, state.X, dr, k, b, state.xi[k], dt * (better - U))
    state.speed[k] = material_speed(strands, loads, state, k, speed_at(loads, k, t + dt))


@lean_inner
def hold(strands, loads, state, buffers, k, kick, new):
    """Frictionless contact: give the riding node the velocity `new` along x with which both tensions stay equal.

    What this takes is the impulse of the hold force. It is part of the last kick, in which the contact has moved with
    the mean of the velocities before and after: so much it works, and so much does the given force along x.
    """
    b, s, w = state.moving_load[k], loads.strand[k], state.w
    impulse = strands.rho[s] * strands.h[s] * (new - w[0, b])
    w[0, b] = new
    v = 0.5 * (buffers.before[k] + new) + state.speed[k] * buffers.dr[0, k] / (state.X[b + 1] - state.X[b - 1])
    state.hold[k] += impulse
    state.work[HOLD_WORK] += impulse * v
    state.work[LOAD_WORK] += kick * force_at(loads, k, state.t[0], 0) * v


@inlined
def _step_on(strands, loads, state, k, drift):
    """How far load k, whose speed is prescribed as dxi/dt, goes during a drift; notes its speed at the end."""
    first, count, t = loads.speed_first[k], loads.speed_count[k], state.t[0]
    step = drift * loads.speed_value[first]
    if count > 1:
        time, value, path = loads.speed_time, loads.speed_value, loads.speed_path
        step = look_up_integral(time, value, path, first, count, t + drift)
        step -= look_up_integral(time, value, path, first, count, t)
        state.speed[k] = look_up(time, value, first, count, t + drift)
    if loads.at_end[k] == STAY and has_arrived(strands, loads, k, state.xi[k], step * drift):
        step, state.speed[k] = 0.0, 0.0
    return step


@inlined
def move_loads(strands, loads, state, buffers, kick, drift):
    """Let all loads travel for the time of a drift that follows a kick; nodes that ride with them are carried along."""
    r, w, X, dr = state.r, state.w, state.X, buffers.dr
    for k in range(state.xi.size):
        b, s = state.moving_load[k], loads.strand[k]
        if b <= OFF:
            continue
        x = 0.0  # of the node before the drift
        if loads.contact[k] == FRICTIONLESS and b >= 0:
            way, decay = _drift_with_drag(strands.drag[s], drift)
            x = r[0, b] - way * w[0, b] / decay
        if loads.measure[k] == MATERIAL:
            step = _step_on(strands, loads, state, k, drift)
            state.xi[k] += step
            if b >= 0:
                _carry(r, X, dr, k, b, state.xi[k], step)
        else:
            _travel(strands, loads, state, dr, k, drift)
        if loads.contact[k] == FRICTIONLESS and b >= 0:
            even_out(r, X, b)
            tangent = 0.5 * (dr[0, k] + r[0, b + 1] - r[0, b - 1]) / (X[b + 1] - X[b - 1])
            hold(strands, loads, state, buffers, k, kick, (r[0, b] - x) / drift - state.speed[k] * tangent)
