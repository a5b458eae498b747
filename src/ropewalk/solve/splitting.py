"""Explicit motion: symmetric compositions of kicks and drifts, the whole loop compiled.

A step is kick b1, drift a1, kick b2, ..., drift am, kick b1 with the coefficients of composition.py. The last kick of a
step and the first of the next need the same force, which is evaluated once. Steps end exactly where a load changes its
seat on the chain and at the instants asked for.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import (
    CONTACT,
    FRICTIONLESS,
    HOLD_WORK,
    LINE_DAMPING,
    LOAD_WORK,
    MATERIAL,
    OFF,
    SHARED,
    STAY,
)
from ropewalk.mechanics.compiled import inner, kernel
from ropewalk.mechanics.link import pull_again, pull_one, pull_one_again, pull_vectors, stretch, stretch_rate
from ropewalk.mechanics.rider import (
    ARRIVED,
    contact_loss,
    even_out,
    even_out_velocity,
    link_of,
    look_up,
    look_up_integral,
    material_speed,
    mesh_speed,
    next_change,
    node_velocity,
    seat_of,
    settle,
    slope,
    speed_at,
)

RUNNING, END_OF_LINE, NOT_FINITE, TOO_MANY_STEPS, NO_CONVERGENCE = 0, 1, 2, 3, 4


@inner
def _update(r, w, f, i0, i1, per_mass, gravity, kick, way, decay):
    """Kick and drift the nodes between i0 and i1: w <- w + per_mass [f] + kick gravity, then along with drag
    r <- r + way w, w <- decay w."""
    for a in range(w.shape[0]):
        ra, wa, fa, ga = r[a, i0 + 1 : i1], w[a, i0 + 1 : i1], f[a, i0:i1], kick * gravity[a]
        for i in range(i1 - i0 - 1):
            v = wa[i] + (per_mass * (fa[i + 1] - fa[i]) + ga)
            wa[i] = decay * v
            ra[i] += way * v


@inner
def _update_ahead(w, ahead, f, i0, i1, per_mass, gravity, kick, decay, lead):
    """Velocities after the coming kick and drift, led on by `lead` kicks: those at the instant of the new positions."""
    for a in range(w.shape[0]):
        wa, out, fa, ga = w[a, i0 + 1 : i1], ahead[a, i0 + 1 : i1], f[a, i0:i1], kick * gravity[a]
        more = decay * (1.0 + lead)
        for i in range(i1 - i0 - 1):
            out[i] = decay * wa[i] + more * (per_mass * (fa[i + 1] - fa[i]) + ga)


@inner
def _strain_rate(r, w, X, rider, speed, i):
    """Strain rate of link i, whose ends may ride with loads."""
    rest = X[i + 1] - X[i]
    length = stretch(r, i)
    along = length * stretch_rate(r, w, i)
    U0, U1 = mesh_speed(rider, speed, i), mesh_speed(rider, speed, i + 1)
    for a in range(r.shape[0]):
        d = r[a, i + 1] - r[a, i]
        if U1 != 0.0:
            along += d * U1 * slope(r, X, i + 1, a)
        if U0 != 0.0:
            along -= d * U0 * slope(r, X, i, a)
    return (along / length - (U1 - U0) * length / rest) / rest


@inner
def _pull_beside(p, c, h, r, w, X, rider, speed, q, b):
    """Tension over length of the two links beside the riding node b, whose unstrained lengths are not h.

    Returns:
        What the damping of these two links adds to the sum of eps_t^2 over uniform links.
    """
    more = 0.0
    first = b - 1
    for k in range(rider.size):
        if rider[k] == b - 1:  # the link behind is the one ahead of another load, which looks after it
            first = b
    for i in range(first, b + 1):
        rest, rate = X[i + 1] - X[i], 0.0
        if c > 0.0:
            rate = _strain_rate(r, w, X, rider, speed, i)
            uniform = stretch_rate(r, w, i) / h
            more += rate * rate * rest / h - uniform * uniform
        q[i] = pull_one(p, c, rest, rate, r, i)
    return more


@inner
def _kick_rider(time, value, first, count, t, m, U, b, kick, way, decay, lead, r, w, ahead, f, g, X, dr, dw, k):
    """Momentum for the node b that rides with load k: its force, and the flux of momentum past it.

    The links and gravity have already kicked all nodes, and these have drifted, see _update.

    Returns:
        The work of the force, J.
    """
    span, work = X[b + 1] - X[b - 1], 0.0
    for a in range(r.shape[0]):
        F = look_up(time, value[a], first, count, t)
        after = (w[a, b + 1] - w[a, b - 1]) / decay
        extra = kick * (F / m + U / span * 0.5 * (dw[a, k] + after))
        kicked = kick * ((f[a, b] - f[a, b - 1]) / m + g[a]) + extra
        w[a, b] += decay * extra
        ahead[a, b] += decay * (1.0 + lead) * extra
        r[a, b] += way * extra
        work += kick * F * (w[a, b] / decay - 0.5 * kicked + U * dr[a, k] / span)
    return work


@inner
def _shift_weight(h, first, last, b, kick, way, decay, lead, r, w, ahead, g, X):
    """Weight of the nodes beside the riding node b: of half the links that they really have, not of uniform ones.

    Without it a load of no force at all would stir the rope it travels on.
    """
    for side in (-1, 1):
        node = b + side
        if first < node < last:
            part = 0.5 * (abs(X[b] - X[node]) / h - 1.0)
            for a in range(r.shape[0]):
                extra = kick * part * g[a]
                w[a, node] += decay * extra
                ahead[a, node] += decay * (1.0 + lead) * extra
                r[a, node] += way * extra


@inner
def _kick_shared(time, value, first, count, t, m, h, U, xi, i0, i1, kick, way, decay, lead, r, w, ahead, f, g, X):
    """Momentum from a load that is shared by the two nodes of its link, which may be held at i0 and i1.

    Returns:
        The work of the force, J.
    """
    i = seat_of(X, xi, h, i0, i1)
    part, work = (xi - X[i]) / (X[i + 1] - X[i]), 0.0
    for a in range(r.shape[0]):
        F = look_up(time, value[a], first, count, t)
        v = U * (r[a, i + 1] - r[a, i]) / (X[i + 1] - X[i])
        for end in range(2):
            node, share = i + end, (part if end == 1 else 1.0 - part)
            if i0 < node < i1:
                extra = kick * share * F / m
                kicked = kick * ((f[a, node] - f[a, node - 1]) / m + g[a]) + extra
                w[a, node] += decay * extra
                ahead[a, node] += decay * (1.0 + lead) * extra
                r[a, node] += way * extra
                v += share * (w[a, node] / decay - 0.5 * kicked)
        work += kick * F * v
    return work


@inner
def _carry(r, X, dr, k, b, xi, way):
    """Carry the riding node b over the material by `way` along the line."""
    X[b] = xi
    for a in range(r.shape[0]):
        r[a, b] += way * 0.5 * (dr[a, k] + r[a, b + 1] - r[a, b - 1]) / (X[b + 1] - X[b - 1])


@inner
def _travel(strands, loads, state, dr, k, dt):
    """Let load k travel for dt at a speed that depends on the state of the line."""
    t, b, xi = state.t[0], state.rider[k], state.xi[k]
    U = material_speed(strands, loads, state, k, speed_at(loads, k, t))
    state.xi[k] = xi + dt * U
    if b >= 0:
        _carry(state.r, state.X, dr, k, b, state.xi[k], dt * U)
    better = 0.5 * (U + material_speed(strands, loads, state, k, speed_at(loads, k, t + dt)))
    state.xi[k] = xi + dt * better
    if b >= 0:
        _carry(state.r, state.X, dr, k, b, state.xi[k], dt * (better - U))
    state.speed[k] = material_speed(strands, loads, state, k, speed_at(loads, k, t + dt))


@inner
def _hold(m, U, r, w, X, dr, k, b, x, dt):
    """Frictionless contact: put the riding node where both tensions agree; its velocity follows.

    Returns:
        The impulse of the hold force, N s, and its work, J.
    """
    even_out(r, X, b)
    v = (r[0, b] - x) / dt
    new = v - U * 0.5 * (dr[0, k] + r[0, b + 1] - r[0, b - 1]) / (X[b + 1] - X[b - 1])
    impulse = m * (new - w[0, b])
    w[0, b] = new
    return impulse, impulse * v


@inner
def _even_out_all(strands, loads, state):
    """Put all frictionless contacts where both tensions agree, at rates that keep them so."""
    for k in range(state.xi.size):
        b = state.rider[k]
        if loads.contact[k] == FRICTIONLESS and b >= 0:
            even_out(state.r, state.X, b)
            before = state.w[0, b]
            even_out_velocity(state, b)
            s = loads.strand[k]
            impulse = strands.rho[s] * strands.h[s] * (state.w[0, b] - before)
            state.hold[k] += impulse
            state.work[HOLD_WORK] += impulse * node_velocity(state, b, 0)


@inner
def _copy(source, target):
    for a in range(source.shape[0]):
        for i in range(source.shape[1]):
            target[a, i] = source[a, i]


@inner
def _gap(target, xi, speed):
    """Distance still to go to the next change of seat; negative if the load has turned round since it was noted."""
    if speed == 0.0:
        return np.inf
    return -1.0 if np.isinf(target) else (target - xi if speed > 0.0 else xi - target)


@inner
def _take_seats(strands, loads, state, buffers):
    """Let every load take the seat that its place asks for, and note where it has to change next.

    Returns:
        True if a load has come to the end of its line and may go neither on nor off.
    """
    t = state.t[0]
    for k in range(state.xi.size):
        if state.rider[k] == OFF:
            continue
        state.speed[k] = material_speed(strands, loads, state, k, speed_at(loads, k, t))
        target, tolerance = next_change(strands, loads, state, k), ARRIVED * strands.h[loads.strand[k]]
        if _gap(target, state.xi[k], state.speed[k]) <= tolerance or state.rider[k] == SHARED:
            if settle(strands, loads, state, k, buffers.point, buffers.velocity):
                return True
            if state.rider[k] != OFF:
                state.speed[k] = material_speed(strands, loads, state, k, speed_at(loads, k, t))
        buffers.target[k] = next_change(strands, loads, state, k)
    _even_out_all(strands, loads, state)
    return False


@inner
def _plan(rest, longest, target, xi, speed, rider):
    """Length of the next step: equal steps up to the next event or to the end, none above `longest`."""
    for k in range(xi.size):
        if rider[k] != OFF and speed[k] != 0.0:
            gap = _gap(target[k], xi[k], speed[k])
            if gap > 0.0:
                rest = min(rest, gap / abs(speed[k]))
    return rest / max(np.ceil(rest / longest - 1e-9), 1.0)


@inner
def _is_due(target, xi, speed, rider, tolerance):
    """Whether some load has come to a place where its seat has to change."""
    for k in range(xi.size):  # noqa: SIM110, a generator cannot be compiled
        if rider[k] != OFF and _gap(target[k], xi[k], speed[k]) <= tolerance:
            return True
    return False


@inner
def _is_finite(r, w):
    total = 0.0
    for a in range(r.shape[0]):
        for i in range(r.shape[1]):
            total += abs(r[a, i]) + abs(w[a, i])
    return np.isfinite(total)


@inner
def _is_parked(xi, length, speed):
    """Whether a load that stays on its line stands at an end of it and does not come back."""
    return (xi >= length and speed >= 0.0) or (xi <= 0.0 and speed <= 0.0)


@inner
def _drift_with_drag(drag, drift):
    """Way over velocity of a drift that drag slows down, s, and the part of the velocity that is left at its end."""
    if drag == 0.0:
        return drift, 1.0
    decay = np.exp(-drag * drift)
    return (1.0 - decay) / drag, decay


@inner
def _loss_shared(strands, loads, state, k):
    """Power lost at the contact of a shared load, W: between the links beyond its own."""
    s, i = loads.strand[k], link_of(strands, loads, state, k)
    if i == strands.first[s] or i == strands.first[s] + strands.links[s] - 1:
        return 0.0
    return contact_loss(strands.law[s], strands.rho[s], state.speed[k], state.r, state.X, i - 1, i + 1)


@inner
def _loss(strands, loads, state):
    """Power lost at all contacts, W."""
    total = 0.0
    for k in range(state.xi.size):
        s, b = loads.strand[k], state.rider[k]
        if b >= 0:
            total += contact_loss(strands.law[s], strands.rho[s], state.speed[k], state.r, state.X, b - 1, b)
        elif b == SHARED:
            total += _loss_shared(strands, loads, state, k)
    return total


@inner
def _sum_of_squares(w, i0, i1):
    """Sum of the squared velocities of the nodes between i0 and i1."""
    total = 0.0
    for a in range(w.shape[0]):
        for i in range(i0 + 1, i1):
            total += w[a, i] * w[a, i]
    return total


@kernel
def advance(strands, loads, state, buffers, kicks, drifts, until, longest, most):
    """Move `state` to the time `until`.

    The loop stands in one function, with arrays as local names, because a call that passes the whole state on costs
    as much as the work on a hundred nodes.

    Args:
        strands, loads, state, buffers: see mechanics/chain.py; state and buffers are changed.
        kicks, drifts: coefficients of the composition, m + 1 and m numbers.
        until: time to stop at, s.
        longest: largest step, s.
        most: largest number of steps.

    Returns:
        Status (RUNNING when `until` is reached, else what went wrong) and the number of steps taken.
    """
    first, links, h, rho, laws, damping, drag, gravity = strands
    strand, measure, contact, at_end, v_first, v_count, v_time, v_value, v_path, f_first, f_count, f_time, f_value = (
        loads
    )
    time, r, w, X, xi, speed, rider, hold, work = state
    per_length, q, f, ahead, target, dr, dw, _, _ = buffers
    dim, stages, steps = r.shape[0], drifts.size, 0
    end, tolerance = until - 1e-12 * max(1.0, abs(until)), ARRIVED * h[0]
    for s in range(1, first.size):
        tolerance = min(tolerance, ARRIVED * h[s])
    while time[0] < end:
        if _take_seats(strands, loads, state, buffers):
            return END_OF_LINE, steps
        dt = _plan(until - time[0], longest, target, xi, speed, rider)
        kick, t_w, over, before, following = kicks[0] * dt, time[0], False, 0.0, 0.0
        _copy(w, ahead)
        while not over:
            begin = time[0]
            for k in range(xi.size):  # half of the step before and half of this one
                s, b = strand[k], rider[k]
                if b >= 0:
                    lost = contact_loss(laws[s], rho[s], speed[k], r, X, b - 1, b)
                    work[CONTACT] += 0.5 * (before + dt) * lost
                elif b == SHARED:
                    i0, i1 = first[s], first[s] + links[s]
                    i = seat_of(X, xi[k], h[s], i0, i1)
                    if i0 < i < i1 - 1:  # as in _loss_shared
                        lost = contact_loss(laws[s], rho[s], speed[k], r, X, i - 1, i + 1)
                        work[CONTACT] += 0.5 * (before + dt) * lost
            for stage in range(stages + 1):
                if stage < stages:
                    drift = drifts[stage] * dt
                else:
                    # The step is done but for its last kick, which also begins the next step, if there is one.
                    steps += 1
                    time[0] = begin + dt
                    over = time[0] >= end or steps >= most or _is_due(target, xi, speed, rider, tolerance)
                    if not over:
                        following = _plan(until - time[0], longest, target, xi, speed, rider)
                        kick += kicks[0] * following
                        break
                    drift = 0.0
                # The velocities belong to t_w; damping wants them at the next instant at which it is evaluated.
                lead = (time[0] + drift - t_w - kick) / kick
                for s in range(first.size):
                    i, j, c = first[s], first[s] + links[s], damping[s]
                    for k in range(xi.size):  # beside a load, lengths change too fast for a guess
                        b = rider[k]
                        if i < b < j:
                            per_length[b - 1], per_length[b] = 1.0 / stretch(r, b - 1), 1.0 / stretch(r, b)
                    square = pull_again(laws[s], c, h[s], i, j, r, ahead, per_length, q)
                    for k in range(xi.size):
                        b = rider[k]
                        if i < b < j and c == 0.0:
                            q[b - 1] = pull_one_again(laws[s], X[b] - X[b - 1], r, per_length, b - 1)
                            q[b] = pull_one_again(laws[s], X[b + 1] - X[b], r, per_length, b)
                        elif i < b < j:
                            square += _pull_beside(laws[s], c, h[s], r, ahead, X, rider, speed, q, rider[k])
                    pull_vectors(i, j, r, q, f)
                    work[LINE_DAMPING] += kick * c * h[s] * square
                for k in range(xi.size):
                    b = rider[k]
                    if b >= 0:
                        for a in range(dim):
                            dr[a, k] = r[a, b + 1] - r[a, b - 1]
                            dw[a, k] = w[a, b + 1] - w[a, b - 1]
                for s in range(first.size):
                    i, j, m = first[s], first[s] + links[s], rho[s] * h[s]
                    way, decay = _drift_with_drag(drag[s], drift)
                    if damping[s] > 0.0:
                        _update_ahead(w, ahead, f, i, j, kick / m, gravity, kick, decay, lead)
                    _update(r, w, f, i, j, kick / m, gravity, kick, way, decay)
                    if drag[s] > 0.0:
                        # The drag takes exactly what the decay takes from the kinetic energy.
                        work[LINE_DAMPING] += 0.5 * m * (1.0 / decay**2 - 1.0) * _sum_of_squares(w, i, j)
                for k in range(xi.size):
                    b, s = rider[k], strand[k]
                    way, decay = _drift_with_drag(drag[s], drift)
                    if b >= 0:
                        _shift_weight(
                            h[s], first[s], first[s] + links[s], b, kick, way, decay, lead, r, w, ahead, gravity, X
                        )
                        work[LOAD_WORK] += _kick_rider(
                            f_time, f_value, f_first[k], f_count[k], time[0], rho[s] * h[s], speed[k], b, kick, way,
                            decay, lead, r, w, ahead, f, gravity, X, dr, dw, k,
                        )  # fmt: skip
                    elif b == SHARED:
                        work[LOAD_WORK] += _kick_shared(
                            f_time, f_value, f_first[k], f_count[k], time[0], rho[s] * h[s], h[s], speed[k], xi[k],
                            first[s], first[s] + links[s], kick, way, decay, lead, r, w, ahead, f, gravity, X,
                        )  # fmt: skip
                if drift != 0.0:
                    for k in range(xi.size):
                        b, s = rider[k], strand[k]
                        if b == OFF:
                            continue
                        way, decay = _drift_with_drag(drag[s], drift)
                        x = r[0, max(b, 0)] - way * w[0, max(b, 0)] / decay
                        if measure[k] == MATERIAL:
                            step_on = drift * v_value[v_first[k]]
                            if v_count[k] > 1:
                                step_on = look_up_integral(
                                    v_time, v_value, v_path, v_first[k], v_count[k], time[0] + drift
                                ) - look_up_integral(v_time, v_value, v_path, v_first[k], v_count[k], time[0])
                                speed[k] = look_up(v_time, v_value, v_first[k], v_count[k], time[0] + drift)
                            if at_end[k] == STAY and _is_parked(xi[k], links[s] * h[s], speed[k]):
                                step_on, speed[k] = 0.0, 0.0
                            xi[k] += step_on
                            if b >= 0:
                                _carry(r, X, dr, k, b, xi[k], step_on)
                        else:
                            _travel(strands, loads, state, dr, k, drift)
                        if contact[k] == FRICTIONLESS and b >= 0:
                            push, gained = _hold(rho[s] * h[s], speed[k], r, w, X, dr, k, b, x, drift)
                            hold[k] += push
                            work[HOLD_WORK] += gained
                    time[0] += drift
                t_w += kick
                if stage < stages:
                    kick = kicks[stage + 1] * dt
            before, dt = dt, following
            if steps % 64 == 0 and not _is_finite(r, w):
                return NOT_FINITE, steps
        work[CONTACT] += 0.5 * before * _loss(strands, loads, state)
        _even_out_all(strands, loads, state)
        if not _is_finite(r, w):
            return NOT_FINITE, steps
        if steps >= most:
            return TOO_MANY_STEPS, steps
    time[0] = until
    return RUNNING, steps
