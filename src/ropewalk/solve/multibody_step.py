"""Kicks and drifts of bodies: the flows of splitting.py for what has a mass of its own."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.bodies import (
    ALONG_X,
    AWAY,
    CARRIED,
    EVEN,
    FLYING,
    FREE,
    INSIDE,
    LOCATED,
    MOVING_WITH,
    PARKED,
    STANDS,
    SWINGS,
    WAITING,
)
from ropewalk.mechanics.chain import (
    ARC,
    CONTACT,
    DRIVE,
    FRICTION,
    HOLD_WORK,
    HORIZONTAL,
    LINE_DAMPING,
    LOAD_DAMPING,
    LOAD_WORK,
    MATERIAL,
    OFF,
    SHARED,
    SLIP,
    STAY,
)
from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.mechanics.contact_detection import bring_above, project
from ropewalk.mechanics.link import stretch, stretch_rate
from ropewalk.mechanics.meeting import have_met
from ropewalk.mechanics.moving_contact import ARRIVED, force_at, look_up_integral, speed_at
from ropewalk.mechanics.moving_mass import beside, land, let_go, on_straight, sort, take_places
from ropewalk.mechanics.split_links import (
    add_split_link_forces,
    correction,
    even_sides,
    hold,
    lifting,
    mean_stretch_at,
    slide,
    sliding_speed,
)
from ropewalk.mechanics.vehicles import is_fast, kick_vehicles, tether_square, wheel_place
from ropewalk.solve.ends import STRONGEST


@inlined
def _is_on(bodies, k):
    return bodies.wheels[k].phase == INSIDE or bodies.wheels[k].phase == LOCATED


@lean_inner
def _swap_last(strands, loads, buffers, bodies):
    """Let the force vector of a divided last link be that of its last piece, which pulls at the support."""
    for p in range(bodies.ordered[0]):
        k = bodies.order[p]
        s, i = loads.strand[k], bodies.wheels[k].at
        if bodies.wheels[k].phase == INSIDE and i == strands.first[s] + strands.links[s] - 1:
            for a in range(buffers.f.shape[0]):
                buffers.f[a, i] = bodies.wheels[k].forth[a]


@lean_inner
def add_body_forces(strands, loads, state, buffers, bodies, kick, lead):
    """Forces and impulses of all that has a mass, before the nodes are kicked; heavy wheels and vehicles are kicked."""
    state.work[LINE_DAMPING] += add_split_link_forces(strands, loads, state, buffers, bodies, kick)
    _swap_last(strands, loads, buffers, bodies)
    kick_vehicles(strands, loads, state, buffers, bodies, kick, lead)
    for k in range(state.xi.size):
        if bodies.wheels[k].phase == PARKED:
            for a in range(state.r.shape[0]):
                weight = bodies.wheels[k].mass[a] * strands.gravity[a]
                bodies.wheels[k].on_line[a] = (
                    force_at(loads, k, state.t[0], a) + weight + bodies.wheels[k].push[a] / kick
                )
        if state.moving_load[k] != CARRIED or is_fast(bodies, k):
            continue
        s, t = loads.strand[k], state.t[0]
        m, square, before = strands.rho[s] * strands.h[s], 0.0, 0.0
        for a in range(state.r.shape[0]):
            M, F = bodies.wheels[k].mass[a], force_at(loads, k, t, a)
            total = F + M * strands.gravity[a]
            if _is_on(bodies, k):
                total += bodies.wheels[k].forth[a] - bodies.wheels[k].behind[a]
                if bodies.wheels[k].phase == LOCATED:
                    total += m * strands.gravity[a]
            gain = (kick * total + bodies.wheels[k].push[a]) / M
            old = bodies.wheels[k].v[a]
            bodies.wheels[k].v[a] = old + gain
            bodies.wheels[k].ahead[a] = old + gain + lead * gain
            state.work[LOAD_WORK] += kick * F * (old + 0.5 * gain)
            square += bodies.wheels[k].v[a] ** 2
            before += 0.5 * M * bodies.wheels[k].v[a] ** 2
        if bodies.wheels[k].air_drag > 0.0:
            slower = 1.0 / (1.0 + kick * bodies.wheels[k].air_drag * np.sqrt(square) / bodies.wheels[k].mass[0])
            for a in range(state.r.shape[0]):
                bodies.wheels[k].v[a] *= slower
            state.work[LOAD_DAMPING] += before * (1.0 - slower * slower)


@lean_inner
def _drag_particle(strands, state, bodies, k, s, drift):
    """Slow down the particle that wheel k carries, instead of the node, which has the velocity of the wheel."""
    if strands.drag[s] == 0.0:
        return
    decay, m, b = np.exp(-min(strands.drag[s] * drift, STRONGEST)), strands.rho[s] * strands.h[s], bodies.wheels[k].at
    for a in range(state.r.shape[0]):
        taken = 0.5 * m * (1.0 / decay**2 - 1.0) * state.w[a, b] ** 2
        lost = 0.5 / m * (1.0 - decay**2) * bodies.wheels[k].store[a] ** 2
        state.work[LINE_DAMPING] += lost - taken
        bodies.wheels[k].store[a] *= decay


@lean_inner
def kick_beside(strands, loads, state, buffers, bodies, kick, drift, lead):
    """Give the node on the other side of each divided link, which has been kicked with the pull of the wrong piece,
    that of its own."""
    for p in range(bodies.ordered[0]):
        k = bodies.order[p]
        if bodies.wheels[k].phase == LOCATED:
            _drag_particle(strands, state, bodies, k, loads.strand[k], drift)
        if bodies.wheels[k].phase != INSIDE:
            continue
        s, i = loads.strand[k], bodies.wheels[k].at
        first, last = strands.first[s], strands.first[s] + strands.links[s]
        is_last = i == last - 1
        one, two = beside(bodies, p, -1), beside(bodies, p, 1)
        node = i if is_last else i + 1
        if (is_last and one != i) or (not is_last and two != i + 1) or not first < node < last:
            continue  # the neighbour is a wheel, which knows its own pieces, or a support
        drag = strands.drag[s]
        decay = np.exp(-min(drag * drift, STRONGEST))
        way = drift if drag == 0.0 else (1.0 - decay) / drag
        per_mass = kick / (strands.rho[s] * strands.h[s])
        for a in range(state.r.shape[0]):
            wrong = buffers.f[a, i]
            extra = per_mass * (bodies.wheels[k].behind[a] - wrong if is_last else wrong - bodies.wheels[k].forth[a])
            state.w[a, node] += decay * extra
            buffers.ahead[a, node] += decay * (1.0 + lead) * extra
            state.r[a, node] += way * extra


@lean_inner
def _arc_rate(strands, loads, state, bodies, p):
    """Rate at which the material between the start of the line and a wheel gets longer, m/s."""
    k = bodies.order[p]
    s, i, rate = loads.strand[k], bodies.wheels[k].at, 0.0
    first = strands.first[s]
    last = i - 1 if bodies.wheels[k].phase == LOCATED else i
    for j in range(first, last):
        rate += stretch_rate(state.r, state.w, j)
    if last > first:  # the piece beside the wheel stretches as the link behind it does
        rest = state.X[last] - state.X[last - 1]
        rate += stretch_rate(state.r, state.w, last - 1) / rest * (state.xi[k] - state.X[last])
    return rate


@lean_inner
def _prescribed(strands, loads, state, bodies, p, t):
    """d xi / dt of a wheel for its prescribed speed."""
    k = bodies.order[p]
    V, s = speed_at(loads, k, t), loads.strand[k]
    if loads.at_end[k] == STAY:
        xi, margin, length = (
            state.xi[k],
            bodies.wheels[k].margin + ARRIVED * strands.h[s],
            strands.links[s] * strands.h[s],
        )
        if (V > 0.0 and xi >= length - margin) or (V < 0.0 and xi <= margin):
            return 0.0
    if loads.measure[k] == SLIP:
        return V / mean_stretch_at(state, bodies, p)
    if loads.measure[k] == ARC:
        return (V - _arc_rate(strands, loads, state, bodies, p)) / mean_stretch_at(state, bodies, p)
    return V


@lean_inner
def _way_at(loads, k, t):
    """Integral of the speed of load k from 0 to t, m."""
    first, count = loads.speed_first[k], loads.speed_count[k]
    return look_up_integral(loads.speed_time, loads.speed_value, loads.speed_path, first, count, t)


@lean_inner
def _parked_speed(loads, state, bodies, k, t):
    """d xi / dt of a parked wheel for its prescribed speed: the link that it stands on is straight."""
    V, i = speed_at(loads, k, t), bodies.wheels[k].at
    rest = state.X[i + 1] - state.X[i]
    if loads.measure[k] == MATERIAL:
        return V
    if loads.measure[k] == HORIZONTAL:
        return V * rest / (state.r[0, i + 1] - state.r[0, i])
    return V * rest / stretch(state.r, i)


@lean_inner
def _hold(state, bodies, k, speed):
    """Give a wheel another velocity along x, and note what that takes: the force acts from drift to drift."""
    impulse = bodies.wheels[k].mass[0] * (speed - bodies.wheels[k].v[0])
    state.hold[k] += impulse
    state.work[HOLD_WORK] += impulse * 0.5 * (bodies.wheels[k].drift_speed + speed)
    bodies.wheels[k].v[0] = bodies.wheels[k].drift_speed = speed


@lean_inner
def _drift_one(strands, loads, state, bodies, k, drift):
    """Move wheel k in space."""
    phase = bodies.wheels[k].phase
    if phase in (WAITING, PARKED):
        t = state.t[0] + drift
        state.speed[k] = _parked_speed(loads, state, bodies, k, t) if phase == PARKED else speed_at(loads, k, t)
        state.xi[k] += drift * state.speed[k]
    if phase == PARKED:
        return  # it follows the line, which has not come to its new place yet
    if bodies.wheels[k].travel == ALONG_X and _is_on(bodies, k):
        _hold(state, bodies, k, speed_at(loads, k, state.t[0] + 0.5 * drift))
        bodies.wheels[k].ahead[0] = speed_at(loads, k, state.t[0] + drift)
    for a in range(state.r.shape[0]):
        bodies.wheels[k].r[a] += drift * bodies.wheels[k].v[a]
    if phase == FLYING:
        bodies.wheels[k].in_air += drift


@inlined
def _slides(bodies, k):
    return bodies.wheels[k].travel == FREE or bodies.wheels[k].travel == ALONG_X


@lean_inner
def _advance_prescribed(strands, loads, state, buffers, bodies, drift):
    """Let all wheels on the line whose place on it is given travel: all of them, before forces are looked at again."""
    t = state.t[0]
    for p in range(bodies.ordered[0]):
        k = bodies.order[p]
        bodies.wheels[k].gone = 0.0
        if not _slides(bodies, k):  # so that stretches, on which speeds may depend, are looked at where the wheels are
            bodies.wheels[k].gone = state.speed[k] * drift
            state.xi[k] += bodies.wheels[k].gone
    for p in range(bodies.ordered[0]):
        k = bodies.order[p]
        U = state.speed[k]
        if _slides(bodies, k) or (U == 0.0 and speed_at(loads, k, t + drift) == 0.0):
            continue
        new = _prescribed(strands, loads, state, bodies, p, t + drift)
        step = 0.5 * (U + new) * drift
        if loads.measure[k] == MATERIAL and loads.speed_count[k] > 1 and (new != 0.0 or loads.at_end[k] != STAY):
            step = _way_at(loads, k, t + drift) - _way_at(loads, k, t)  # also where the speed jumps
        state.xi[k] += step - bodies.wheels[k].gone
        state.speed[k], bodies.wheels[k].gone = new, step
    for p in range(bodies.ordered[0]):
        k = bodies.order[p]
        if bodies.wheels[k].travel == EVEN:  # equal tensions do no work on the travel, only the push along x does
            x = bodies.wheels[k].r[0]
            even_sides(state, bodies, p)
            _hold(state, bodies, k, bodies.wheels[k].v[0] + (bodies.wheels[k].r[0] - x) / drift)
            if strands.damping[loads.strand[k]] > 0.0:
                bodies.wheels[k].ahead[0] += correction(state, buffers, bodies, p, True)
            continue
        if bodies.wheels[k].gone == 0.0:
            continue
        force = hold(strands, loads, state, buffers, bodies, p)
        state.work[HOLD_WORK] += 0.5 * (bodies.wheels[k].hold + force) * bodies.wheels[k].gone
        bodies.wheels[k].hold = force


@lean_inner
def hold_bodies(loads, state, buffers, bodies):
    """Give the wheels that are held along x the velocities that the hold force leaves after the last kick."""
    for p in range(bodies.ordered[0]):
        k = bodies.order[p]
        if bodies.wheels[k].travel == EVEN:
            _hold(state, bodies, k, bodies.wheels[k].v[0] + correction(state, buffers, bodies, p, False))
        elif bodies.wheels[k].travel == ALONG_X:
            _hold(state, bodies, k, speed_at(loads, k, state.t[0]))


@lean_inner
def move_bodies(strands, loads, state, buffers, bodies, drift):
    """Let all wheels that bodies look after move and travel for the time of a drift."""
    t = state.t[0]
    for k in range(state.xi.size):
        if state.moving_load[k] == CARRIED or bodies.wheels[k].phase == AWAY:
            _drift_one(strands, loads, state, bodies, k, drift)
        else:  # where a light wheel is when it leaves the line
            for a in range(state.r.shape[0]):
                place = wheel_place(strands, loads, state, bodies, k, a)
                bodies.wheels[k].v[a] = (place - bodies.wheels[k].r[a]) / drift
                bodies.wheels[k].r[a] = place
    _advance_prescribed(strands, loads, state, buffers, bodies, drift)
    for p in range(bodies.ordered[0]):
        k = bodies.order[p]
        if _slides(bodies, k):
            V = speed_at(loads, k, t + drift)
            driven, lost = slide(strands, loads, state, buffers, bodies, p, V, drift)
            state.work[DRIVE] += driven
            state.work[FRICTION] += lost
            bodies.wheels[k].power = lost / drift


@lean_inner
def location_bodies(strands, state, buffers, bodies):
    """Put the nodes that are carried along where their wheels are, and parked wheels where the line is."""
    for k in range(state.xi.size):
        if bodies.wheels[k].phase == LOCATED:
            b = bodies.wheels[k].at
            state.X[b] = state.xi[k]
            for a in range(state.r.shape[0]):
                state.r[a, b], state.w[a, b] = bodies.wheels[k].r[a], bodies.wheels[k].v[a]
                buffers.ahead[a, b] = bodies.wheels[k].ahead[a]
    for k in range(state.xi.size):
        if bodies.wheels[k].phase == PARKED:
            on_straight(strands, state, bodies, k)
            for a in range(state.r.shape[0]):
                bodies.wheels[k].ahead[a] = bodies.wheels[k].v[a]


@lean_inner
def drift_vehicles(strands, loads, state, bodies, drift):
    """Move the coordinates of all vehicles, and let legs grow that are stretched."""
    for e in range(bodies.tethers.size):
        leg = bodies.tethers[e]
        if leg.growth > 0.0 and leg.on == 1 and leg.length < leg.full:
            square = tether_square(strands, loads, state, bodies, e)
            before = max(leg.length - np.sqrt(square), 0.0)
            new = min(leg.length + leg.growth * drift, leg.full)
            after = max(new - np.sqrt(square), 0.0)
            state.work[DRIVE] += 0.5 * leg.stiffness * (after * after - before * before)
            bodies.tethers[e].length = new
    for d in range(bodies.coordinates.size):
        bodies.coordinates[d].q += drift * bodies.coordinates[d].v


@lean_inner
def _height_above_line(strands, state, bodies, s, tether):
    """Height of the foot of a leg that swings above strand s, which does not turn back; the link below it is noted."""
    first, last = strands.first[s], strands.first[s] + strands.links[s] - 1
    i, r, top = min(max(tether.near, first), last), state.r, state.r.shape[0] - 1
    # Level and in the plane of the legs; where they act in space, the axis along which the line runs further.
    ex, ey = 1.0, 0.0
    if top == 2 and (tether.across[0] != 0.0 or tether.across[1] != 0.0):
        ex, ey = tether.across[1], -tether.across[0]
    elif top == 2 and abs(r[1, last + 1] - r[1, first]) > abs(r[0, last + 1] - r[0, first]):
        ex, ey = 0.0, 1.0
    forward = 1 if ex * (r[0, last + 1] - r[0, first]) + ey * (r[1, last + 1] - r[1, first]) > 0.0 else -1
    x = bodies.coordinates[tether.first].q + tether.reach[0]
    y = bodies.coordinates[tether.first + 1].q + tether.reach[1]
    z = bodies.coordinates[tether.first + top].q + tether.reach[top]
    while i < last and (ex * (x - r[0, i + 1]) + ey * (y - r[1, i + 1])) * forward > 0.0:
        i += 1
    while i > first and (ex * (x - r[0, i]) + ey * (y - r[1, i])) * forward < 0.0:
        i -= 1
    tether.near = i
    part = (ex * (x - r[0, i]) + ey * (y - r[1, i])) / (ex * (r[0, i + 1] - r[0, i]) + ey * (r[1, i + 1] - r[1, i]))
    return z - r[top, i] - part * (r[top, i + 1] - r[top, i])


@lean_inner
def is_leg_due(strands, loads, state, bodies):
    """Whether the foot of a leg that swings has come down to the line, or a leg that stands no longer pushes."""
    for e in range(bodies.tethers.size):
        leg = bodies.tethers[e]
        if leg.watch == SWINGS:
            if _height_above_line(strands, state, bodies, loads.strand[leg.wheel], leg) <= 0.0:
                return True
        elif leg.watch == STANDS:
            square = tether_square(strands, loads, state, bodies, e)
            if square >= leg.length * leg.length:
                return True
    return False


@lean_inner
def is_body_due(strands, loads, state, bodies):
    """Whether a wheel leaves the line, lands on it, comes to its start or to another, or a leg lands or takes off."""
    if is_leg_due(strands, loads, state, bodies) or have_met(strands, loads, state, bodies):
        return True
    for k in range(state.xi.size):
        if bodies.wheels[k].phase == WAITING and state.xi[k] >= 0.0:
            return True
        if bodies.wheels[k].lift == 0:
            continue
        if bodies.wheels[k].phase == FLYING:
            if project(strands, loads, state, bodies, k) <= 0.0:
                return True
        elif _is_on(bodies, k) and lifting(state, bodies, k) > 0.0:
            return True
    return False


@lean_inner
def _enter(strands, loads, state, bodies, k):
    """Let a wheel that waited before its line come onto it."""
    first = strands.first[loads.strand[k]]
    if bodies.wheels[k].heavy == 1:
        bodies.wheels[k].phase, bodies.wheels[k].at = PARKED, first
        on_straight(strands, state, bodies, k)
    else:
        bodies.wheels[k].phase, state.moving_load[k] = MOVING_WITH, SHARED


@lean_inner
def _stop_falling(strands, loads, state, bodies, k):
    """Let a wheel that has left its line run on over level ground."""
    z = state.r.shape[0] - 1
    state.work[CONTACT] += 0.5 * bodies.wheels[k].mass[z] * bodies.wheels[k].v[z] ** 2
    bodies.wheels[k].v[z] = bodies.wheels[k].ahead[z] = 0.0


@lean_inner
def settle_bodies(strands, loads, state, buffers, bodies):
    """Let every wheel change to what it is due for, and note where it changes next.

    Returns:
        0; 1 if a load has come to the end of its line and may go neither on nor off; 2 if two loads have met; 3 if a
        leg lands or takes off, which its guide looks after.
    """
    t = state.t[0]
    if is_leg_due(strands, loads, state, bodies):
        return 3
    for k in range(state.xi.size):
        s, phase = loads.strand[k], bodies.wheels[k].phase
        if phase == WAITING and state.xi[k] >= -ARRIVED * strands.h[s]:
            state.xi[k] = max(state.xi[k], 0.0)
            _enter(strands, loads, state, bodies, k)
        elif phase == FLYING:
            if project(strands, loads, state, bodies, k) <= 0.0:
                bring_above(state, bodies, k)
                land(strands, loads, state, bodies, k)
        elif bodies.wheels[k].lift != 0 and _is_on(bodies, k) and lifting(state, bodies, k) > 0.0:
            let_go(strands, state, bodies, k, s)
            bodies.wheels[k].phase = FLYING
            state.speed[k] = 0.0
        elif phase == MOVING_WITH and state.moving_load[k] == OFF:
            bodies.wheels[k].phase = AWAY
            _stop_falling(strands, loads, state, bodies, k)
    sort(loads, state, bodies)
    _find_speeds(strands, loads, state, bodies, t)
    status = take_places(strands, loads, state, bodies, buffers.target)
    for k in range(state.xi.size):
        if (
            bodies.wheels[k].phase == AWAY
            and bodies.wheels[k].heavy == 1
            and bodies.wheels[k].v[state.r.shape[0] - 1] != 0.0
        ):
            _stop_falling(strands, loads, state, bodies, k)
        if bodies.wheels[k].phase == WAITING:
            buffers.target[k] = 0.0 if state.speed[k] > 0.0 else np.inf
    location_bodies(strands, state, buffers, bodies)
    return status


@lean_inner
def begin_bodies(strands, loads, state, buffers, bodies):
    """Forget what has been extrapolated before places changed, and note the forces that hold prescribed travels."""
    for k in range(state.xi.size):
        for a in range(state.r.shape[0]):
            bodies.wheels[k].ahead[a] = bodies.wheels[k].v[a]
    for d in range(bodies.coordinates.size):
        bodies.coordinates[d].ahead = bodies.coordinates[d].v
    for p in range(bodies.ordered[0]):
        k = bodies.order[p]
        bodies.wheels[k].hold = hold(strands, loads, state, buffers, bodies, p)
        bodies.wheels[k].drift_speed = bodies.wheels[k].v[0]


@lean_inner
def _find_speeds(strands, loads, state, bodies, t):
    """Speeds of all wheels whose travel is prescribed, which may have a corner here."""
    for p in range(bodies.ordered[0]):
        k = bodies.order[p]
        if _is_on(bodies, k) and bodies.wheels[k].travel != FREE and bodies.wheels[k].travel != ALONG_X:
            state.speed[k] = _prescribed(strands, loads, state, bodies, p, t)
        elif _is_on(bodies, k) and state.speed[k] != 0.0 and bodies.wheels[k].driver == 0.0:
            state.speed[k] = sliding_speed(strands, loads, state, bodies, p, np.sign(state.speed[k]))
    for k in range(state.xi.size):
        if bodies.wheels[k].phase == WAITING:
            state.speed[k] = speed_at(loads, k, t)
        elif bodies.wheels[k].phase == PARKED:
            state.speed[k] = _parked_speed(loads, state, bodies, k, t)
            on_straight(strands, state, bodies, k)
