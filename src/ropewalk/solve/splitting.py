"""Explicit motion: symmetric compositions of kicks and drifts, the whole loop compiled.

A step is kick b1, drift a1, kick b2, ..., drift am, kick b1 with the coefficients of composition.py. The last kick of a
step and the first of the next need the same force, which is evaluated once. Steps end exactly where a load changes its
location on the chain and at the instants asked for.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import CONTACT, FRICTIONLESS, LINE_DAMPING, LOAD_WORK, OFF, SHARED
from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.mechanics.link import add_link_forces_again, stretch
from ropewalk.mechanics.moving_contact import (
    ARRIVED,
    even_out,
    even_velocity,
    force_at,
    location_of,
    material_speed,
    mesh_speed,
    near_supports,
    next_change,
    settle,
    slope,
    speed_at,
)
from ropewalk.mechanics.vehicles import have_dampers
from ropewalk.solve.ends import drive_ends, move_ends
from ropewalk.solve.multibody_step import (
    add_body_forces,
    begin_bodies,
    drift_vehicles,
    hold_bodies,
    is_body_due,
    kick_beside,
    location_bodies,
    move_bodies,
    settle_bodies,
)
from ropewalk.solve.split_operators import hold, kick_loads, move_loads, move_nodes

RUNNING, END_OF_LINE, NOT_FINITE, TOO_MANY_STEPS, NO_CONVERGENCE, MET, ASKED = 0, 1, 2, 3, 4, 5, 6


@inlined
def strain_rates(r, w, X, moving_load, speed, i, length, h):
    """Strain rate of link i, whose ends may ride with loads, and that of a link of h between ends that do not."""
    per_rest, along, carried = 1.0 / (X[i + 1] - X[i]), 0.0, 0.0
    U0, U1 = mesh_speed(moving_load, speed, i), mesh_speed(moving_load, speed, i + 1)
    for a in range(r.shape[0]):
        d = r[a, i + 1] - r[a, i]
        along += d * (w[a, i + 1] - w[a, i])
        if U1 != 0.0:
            carried += d * U1 * slope(r, X, i + 1, a)
        if U0 != 0.0:
            carried -= d * U0 * slope(r, X, i, a)
    return ((along + carried) / length - (U1 - U0) * length * per_rest) * per_rest, along / (length * h)


@inlined
def _look_beside(strands, loads, state, buffers, k):
    """Inverse lengths and tensions (`buffers.beside`) of the links beside the node of load k, which are not h long.

    Returns:
        What the damping of these two links adds to the sum of eps_t^2 over uniform links.
    """
    r, X, s, b = state.r, state.X, loads.strand[k], state.moving_load[k]
    c, h, more = strands.damping[s], strands.h[s], 0.0
    for side in range(2):
        i = b - 1 + side
        rest, length = X[i + 1] - X[i], stretch(r, i)
        T = law.tension(strands.law[s], length / rest - 1.0)
        if c > 0.0:
            rate, uniform = strain_rates(r, buffers.ahead, X, state.moving_load, state.speed, i, length, h)
            T += c * rate
            own = True  # a link between two loads is looked after by that behind
            for j in range(state.moving_load.size):
                own = own and (side == 1 or state.moving_load[j] != b - 1)
            if own:
                more += rate * rate * rest / h - uniform * uniform
        buffers.per_length[i], buffers.beside[side, k] = 1.0 / length, T
    return more


@lean_inner
def _even_out_all(strands, loads, state, buffers, kick):
    """Put all frictionless contacts where both tensions agree, at rates that keep them so.

    Args:
        kick: length of the kick that has just been, s; 0: locations have changed, which is a blow at an instant.
    """
    for k in range(state.xi.size):
        b = state.moving_load[k]
        if loads.contact[k] == FRICTIONLESS and b >= 0:
            even_out(state.r, state.X, b)
            if kick == 0.0:
                buffers.before[k], buffers.dr[0, k] = state.w[0, b], state.r[0, b + 1] - state.r[0, b - 1]
            hold(strands, loads, state, buffers, k, kick, even_velocity(state, state.w, b))


@lean_inner
def _copy(source, target):
    for a in range(source.shape[0]):
        for i in range(source.shape[1]):
            target[a, i] = source[a, i]


@inlined
def _gap(target, xi, speed):
    """Distance still to go to the next change of location; negative if the load has turned round since it was noted."""
    if speed == 0.0:
        return np.inf
    return -1.0 if np.isinf(target) else (target - xi if speed > 0.0 else xi - target)


@lean_inner
def _take_locations(strands, loads, state, buffers):
    """Let every load take the location that its place asks for, and note where it has to change next.

    Returns:
        True if a load has come to the end of its line and may go neither on nor off.
    """
    t = state.t[0]
    for k in range(state.xi.size):
        if state.moving_load[k] <= OFF:
            continue
        state.speed[k] = material_speed(strands, loads, state, k, speed_at(loads, k, t))
        target, tolerance = next_change(strands, loads, state, k), ARRIVED * strands.h[loads.strand[k]]
        if _gap(target, state.xi[k], state.speed[k]) <= tolerance or state.moving_load[k] == SHARED:
            if settle(strands, loads, state, k, buffers.point, buffers.velocity):
                return True
            if state.moving_load[k] != OFF:
                state.speed[k] = material_speed(strands, loads, state, k, speed_at(loads, k, t))
        buffers.target[k] = next_change(strands, loads, state, k)
    _even_out_all(strands, loads, state, buffers, 0.0)
    return False


@inlined
def _plan(rest, per_longest, target, xi, speed, moving_load):
    """Length of the next step: equal steps up to the next event or to the end, none above 1 / `per_longest`."""
    for k in range(xi.size):
        if moving_load[k] != OFF and speed[k] != 0.0:
            gap = _gap(target[k], xi[k], speed[k])
            if gap > 0.0:
                rest = min(rest, gap / abs(speed[k]))
    return rest / max(np.ceil(rest * per_longest - 1e-9), 1.0)


@inlined
def _is_due(target, xi, speed, moving_load, tolerance):
    """Whether some load has come to a place where its location has to change."""
    for k in range(xi.size):  # noqa: SIM110, a generator cannot be compiled
        if moving_load[k] != OFF and _gap(target[k], xi[k], speed[k]) <= tolerance:
            return True
    return False


@lean_inner
def _is_finite(r, w):
    total = 0.0
    for a in range(r.shape[0]):
        for i in range(r.shape[1]):
            total += abs(r[a, i]) + abs(w[a, i])
    return np.isfinite(total)


@lean_inner
def _loss_at(strands, loads, state, w, k, bodies=None):
    """Power lost at the contact of load k, W, see `loss`."""
    r, X, s, b, U = state.r, state.X, loads.strand[k], state.moving_load[k], state.speed[k]
    if b <= OFF or U == 0.0 or (b >= 0 and loads.contact[k] == FRICTIONLESS):  # its two sides are alike
        return 0.0
    behind, ahead, jump = b - 1, b, 0.0
    if b == SHARED:  # between the links beyond its own
        first, last = strands.first[s], strands.first[s] + strands.links[s]
        i = location_of(X, state.xi[k], strands.h[s], first, last)
        if i == first or i == last - 1:
            for a in range(r.shape[0]):
                F = force_at(loads, k, state.t[0], a) if bodies is None else bodies.wheels[k].on_line[a]
                jump += F * (r[a, i + 1] - r[a, i]) / (X[i + 1] - X[i])
            return U * jump
        behind, ahead = i - 1, i + 1
    p, c, h = strands.law[s], strands.damping[s], strands.h[s]
    for i in (behind, ahead):
        length = stretch(r, i)
        lam = length / (X[i + 1] - X[i])
        T = law.tension(p, lam - 1.0)
        if c > 0.0:
            T += c * strain_rates(r, w, X, state.moving_load, state.speed, i, length, h)[0]
        own = law.stored(p, lam - 1.0) - T * lam + 0.5 * strands.rho[s] * U * U * lam * lam
        jump += own if i == ahead else -own
    return U * jump


@lean_inner
def loss(strands, loads, state, w, bodies=None):
    """Power lost at all contacts, W: U [W - T lam + rho U^2 lam^2 / 2], between the links behind and ahead of each.

    It is negative where a contact hides a motor: a force that stays vertical while it advances. T is the whole tension,
    with that of the damping. On the link at a support, which is straight, the force is all that the contact feels: what
    it works by advancing along it is lost.

    Args:
        w: (axis, node) m/s, velocities of the material at the instant of the positions.
    """
    total = 0.0
    for k in range(state.xi.size):
        total += _loss_at(strands, loads, state, w, k, bodies)
    return total


@inlined
def _loss_at_forces(strands, loads, state, buffers, bodies):
    """`loss` when `_add_internal_forces` has just left the tensions of the links beside riding nodes."""
    total = 0.0
    for k in range(state.xi.size):
        b, U, s = state.moving_load[k], state.speed[k], loads.strand[k]
        if b < 0:
            total += _loss_at(strands, loads, state, buffers.ahead, k, bodies)
        elif loads.contact[k] != FRICTIONLESS:
            p, inertia = strands.law[s], 0.5 * strands.rho[s] * U * U
            behind = 1.0 / (buffers.per_length[b - 1] * (state.X[b] - state.X[b - 1]))
            ahead = 1.0 / (buffers.per_length[b] * (state.X[b + 1] - state.X[b]))
            total += U * (law.stored(p, ahead - 1.0) - buffers.beside[1, k] * ahead + inertia * ahead * ahead)
            total -= U * (law.stored(p, behind - 1.0) - buffers.beside[0, k] * behind + inertia * behind * behind)
    return total


@inlined
def _add_internal_forces(strands, loads, state, buffers, kick):
    """Force vectors of all links, into `buffers.f`.

    Returns:
        What the damping takes from the motion during a kick, J.
    """
    r, moving_load, f, lost = state.r, state.moving_load, buffers.f, 0.0
    for s in range(strands.first.size):
        p, c, h, first = strands.law[s], strands.damping[s], strands.h[s], strands.first[s]
        last, more = first + strands.links[s], 0.0
        if c > 0.0:
            for k in range(moving_load.size):  # equal tensions need equal rates of the stretch, too
                if loads.strand[k] == s and moving_load[k] >= 0 and loads.contact[k] == FRICTIONLESS:
                    buffers.ahead[0, moving_load[k]] = even_velocity(state, buffers.ahead, moving_load[k])
        for k in range(moving_load.size):  # beside a load, lengths change too fast for a guess
            if loads.strand[k] == s and moving_load[k] >= 0:
                more += _look_beside(strands, loads, state, buffers, k)
        square = add_link_forces_again(p, c, h, first, last, r, buffers.ahead, buffers.per_length, buffers.q, f)
        for k in range(moving_load.size):
            if loads.strand[k] == s and moving_load[k] >= 0:
                for side in range(2):
                    i = moving_load[k] - 1 + side
                    pull = buffers.beside[side, k] * buffers.per_length[i]
                    for a in range(r.shape[0]):
                        f[a, i] = pull * (r[a, i + 1] - r[a, i])
        square += more
        lost += kick * c * h * square
    return lost


@lean_inner
def advance_to(strands, loads, state, buffers, kicks, drifts, until, longest, most, ends=None, bodies=None):
    """Move `state` to the time `until`.

    Args:
        strands, loads, state, buffers: see mechanics/chain.py; state and buffers are changed.
        kicks, drifts: coefficients of the composition, m + 1 and m numbers.
        until: time to stop at, s.
        longest: largest step, s.
        most: largest number of steps.
        ends: what yields or moves, from `ends_of`; None: nothing does, and it is compiled without them.
        bodies: what has a mass of its own; None: nothing has.

    Returns:
        Status (RUNNING when `until` is reached, else what went wrong) and the number of steps taken.
    """
    time, r, w, xi, speed, moving_load, work = (
        state.t, state.r, state.w, state.xi, state.speed, state.moving_load, state.work,
    )  # fmt: skip
    target, stages, steps = buffers.target, drifts.size, 0
    if r.shape[0] != len(buffers.axes) or w.shape[0] != len(buffers.axes):  # it never is: the compiler learns a number
        return NOT_FINITE, 0
    end, tolerance = until - 1e-12 * max(1.0, abs(until)), np.inf
    for s in range(strands.h.size):
        tolerance = min(tolerance, ARRIVED * strands.h[s])
    if ends is not None:
        drive_ends(state, ends, time[0])
    led = 0
    if bodies is not None:
        led = have_dampers(bodies)
    while time[0] < end:
        if _take_locations(strands, loads, state, buffers):
            return END_OF_LINE, steps
        if bodies is not None:
            status = settle_bodies(strands, loads, state, buffers, bodies)
            if status != 0:
                return END_OF_LINE if status == 1 else (MET if status == 2 else ASKED), steps
        allowed = longest
        if ends is not None:
            allowed *= near_supports(strands, loads, state)
        per_longest = 1.0 / allowed
        dt = _plan(until - time[0], per_longest, target, xi, speed, moving_load)
        kick, t_w, over, before, following = kicks[0] * dt, time[0], False, 0.0, 0.0
        _copy(w, buffers.ahead)
        if bodies is not None:
            begin_bodies(strands, loads, state, buffers, bodies)
        while not over:
            begin = time[0]
            for stage in range(stages + 1):
                if stage < stages:
                    drift = drifts[stage] * dt
                else:
                    # The step is done but for its last kick, which also begins the next step, if there is one.
                    steps += 1
                    time[0] = begin + dt
                    over = time[0] >= end or steps >= most or _is_due(target, xi, speed, moving_load, tolerance)
                    if bodies is not None and not over:
                        over = is_body_due(strands, loads, state, bodies)
                    if not over:
                        following = _plan(until - time[0], per_longest, target, xi, speed, moving_load)
                        kick += kicks[0] * following
                        break
                    drift = 0.0
                # The velocities belong to t_w; damping wants them at the next instant at which it is evaluated.
                lead = (time[0] + drift - t_w - kick) / kick
                work[LINE_DAMPING] += _add_internal_forces(strands, loads, state, buffers, kick)
                if stage == 0:  # half the step before and half of this
                    work[CONTACT] += 0.5 * (before + dt) * _loss_at_forces(strands, loads, state, buffers, bodies)
                if bodies is not None:
                    add_body_forces(strands, loads, state, buffers, bodies, kick, lead)
                for k in range(xi.size):
                    b = moving_load[k]
                    if b >= 0:
                        for a in range(r.shape[0]):
                            buffers.dr[a, k] = r[a, b + 1] - r[a, b - 1]
                            buffers.dw[a, k] = w[a, b + 1] - w[a, b - 1]
                work[LINE_DAMPING] += move_nodes(strands, state, buffers, kick, drift, lead, led)
                if ends is not None:
                    move_ends(strands, loads, state, buffers, ends, kick, drift, lead)
                if bodies is not None:
                    kick_beside(strands, loads, state, buffers, bodies, kick, drift, lead)
                work[LOAD_WORK] += kick_loads(strands, loads, state, buffers, kick, drift, lead, ends, bodies)
                if drift != 0.0:
                    move_loads(strands, loads, state, buffers, kick, drift)
                    if bodies is not None:
                        move_bodies(strands, loads, state, buffers, bodies, drift)
                        drift_vehicles(strands, loads, state, bodies, drift)
                    time[0] += drift
                if bodies is not None:
                    location_bodies(strands, state, buffers, bodies)
                t_w += kick
                if stage < stages:
                    kick = kicks[stage + 1] * dt
            before, dt = dt, following
            if steps % 64 == 0 and not _is_finite(r, w):
                return NOT_FINITE, steps
        work[CONTACT] += 0.5 * before * loss(strands, loads, state, buffers.ahead, bodies)
        _even_out_all(strands, loads, state, buffers, kick)
        if bodies is not None:
            hold_bodies(loads, state, buffers, bodies)
            location_bodies(strands, state, buffers, bodies)
        if not _is_finite(r, w):
            return NOT_FINITE, steps
        if steps >= most and time[0] < end:
            return TOO_MANY_STEPS, steps
    time[0] = until
    return RUNNING, steps
