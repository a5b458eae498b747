"""Divided links: what the pieces of line between heavy wheels and nodes pull, and how a wheel slides along them."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.bodies import INSIDE, LOCATED
from ropewalk.mechanics.chain import BLOCK, STAY
from ropewalk.mechanics.compiled import lean_inner
from ropewalk.mechanics.link import stretch_rate, upward
from ropewalk.mechanics.moving_contact import look_up
from ropewalk.mechanics.moving_mass import beside, coordinate, place, travel_speed, velocity

# Steps of Newton's method for the place of a sliding wheel, and the change of it, as a part of the piece, that ends it.
MOST_STEPS, CLOSE = 25, 1e-13


@lean_inner
def _velocity(state, buffers, bodies, code, a):
    """Velocity of a point at the instant of the positions."""
    return buffers.ahead[a, code] if code >= 0 else bodies.wheels[-1 - code].ahead[a]


@lean_inner
def _strain_rate(state, buffers, bodies, one, two, length, rest):
    """Strain rate of the piece between two points, which may travel: (l' - l / rest (U2 - U1)) / rest."""
    along = 0.0
    for a in range(state.r.shape[0]):
        d = place(state, bodies, two, a) - place(state, bodies, one, a)
        along += d * (_velocity(state, buffers, bodies, two, a) - _velocity(state, buffers, bodies, one, a))
    return (along / length - (travel_speed(state, two) - travel_speed(state, one)) * length / rest) / rest


@lean_inner
def _length(state, bodies, one, two):
    square = 0.0
    for a in range(state.r.shape[0]):
        d = place(state, bodies, two, a) - place(state, bodies, one, a)
        square += d * d
    return np.sqrt(square)


@lean_inner
def _slot(bodies, node, p):
    """The code of a node: that of the wheel that carries it, if that is number p along the lines or next to it."""
    for q in (p - 1, p, p + 1):
        if 0 <= q < bodies.ordered[0]:
            k = bodies.order[q]
            if bodies.wheels[k].phase == LOCATED and bodies.wheels[k].at == node:
                return -1 - k
    return node


@lean_inner
def _add_link_force(strands, state, buffers, bodies, s, i, p):
    """Force vectors of the pieces of link i; the first wheel inside it, if there is one, is number p along the lines.

    Returns:
        What its damping adds to the sum of eps_t^2 over uniform links.
    """
    law_s, c, h = strands.law[s], strands.damping[s], strands.h[s]
    more = 0.0
    if c > 0.0:
        uniform = stretch_rate(state.r, buffers.ahead, i) / h
        more = -uniform * uniform
    one, before = _slot(bodies, i, p), -1
    while True:
        inside = (
            p < bodies.ordered[0]
            and bodies.wheels[bodies.order[p]].phase == INSIDE
            and bodies.wheels[bodies.order[p]].at == i
        )
        k = bodies.order[p] if inside else -1
        two = -1 - k if inside else _slot(bodies, i + 1, p)
        rest, length = coordinate(state, two) - coordinate(state, one), _length(state, bodies, one, two)
        T = law.tension(law_s, length / rest - 1.0)
        if c > 0.0:
            rate = _strain_rate(state, buffers, bodies, one, two, length, rest)
            T += c * rate
            more += rate * rate * rest / h
        for a in range(state.r.shape[0]):
            pull = T / length * (place(state, bodies, two, a) - place(state, bodies, one, a))
            if before < 0:
                buffers.f[a, i] = pull
            else:
                bodies.wheels[before].forth[a] = pull
            if inside:
                bodies.wheels[k].behind[a] = pull
        if not inside:
            return more
        one, before, p = two, k, p + 1


@lean_inner
def add_split_link_forces(strands, loads, state, buffers, bodies, kick):
    """Force vectors of all pieces of line beside heavy wheels: into `buffers.f` and `bodies.behind`, `bodies.forth`.

    For a divided link `buffers.f` holds the pull of its first piece on the node before it.

    Returns:
        What the damping of these pieces takes from the motion during a kick, J, beyond that of uniform links.
    """
    lost, done = 0.0, -1
    for p in range(bodies.ordered[0]):
        k = bodies.order[p]
        s, i = loads.strand[k], bodies.wheels[k].at
        more = 0.0
        if bodies.wheels[k].phase == INSIDE:
            if i > done:
                more = _add_link_force(strands, state, buffers, bodies, s, i, p)
                done = i
        else:
            if i - 1 > done:
                more = _add_link_force(strands, state, buffers, bodies, s, i - 1, p)
            more += _add_link_force(strands, state, buffers, bodies, s, i, p + 1)
            done = i
        lost += kick * strands.damping[s] * strands.h[s] * more
    for p in range(bodies.ordered[0]):
        k = bodies.order[p]
        if bodies.wheels[k].phase == LOCATED:
            one, two = beside(bodies, p, -1), beside(bodies, p, 1)
            b = bodies.wheels[k].at
            for a in range(state.r.shape[0]):
                inside = one < 0 and bodies.wheels[-1 - one].phase == INSIDE
                bodies.wheels[k].behind[a] = bodies.wheels[-1 - one].forth[a] if inside else buffers.f[a, b - 1]
                inside = two < 0 and bodies.wheels[-1 - two].phase == INSIDE
                bodies.wheels[k].forth[a] = bodies.wheels[-1 - two].behind[a] if inside else buffers.f[a, b]
    return lost


@lean_inner
def _piece(strands, s, length, rest):
    """Tension of a piece and its derivative by the unstrained length."""
    eps = length / rest - 1.0
    p = strands.law[s]
    return law.tension(p, eps), -law.tangent(p, eps) * length / (rest * rest)


@lean_inner
def _turn(state, bodies, k, one, two, l1, l2):
    """Angle by which the line turns at wheel k."""
    cosine = 0.0
    for a in range(state.r.shape[0]):
        middle = bodies.wheels[k].r[a]
        cosine += (middle - place(state, bodies, one, a)) * (place(state, bodies, two, a) - middle)
    return np.arccos(min(max(cosine / (l1 * l2), -1.0), 1.0))


@lean_inner
def _friction(loads, bodies, k, turn):
    """Friction over the sum of the tensions: of the contact, and of rolling."""
    mu, half = loads.friction[k], 0.5 * turn
    own = 0.0
    if mu > 0.0:
        own = mu * np.tan(half) if loads.friction_model[k] == BLOCK else np.tanh(mu * half)
    return own + bodies.wheels[k].rolling * np.sin(half)


@lean_inner
def drive_at(bodies, k, t):
    """Drive of wheel k at time t, N."""
    return look_up(bodies.drive_time, bodies.drive_value, bodies.wheels[k].drive_first, bodies.wheels[k].drive_count, t)


@lean_inner
def _carried(strands, state, bodies, k, s, one, two, l1, l2):
    """Weight along the line of the particle that wheel k carries: the line bears it, not the wheel, N."""
    if bodies.wheels[k].phase != LOCATED:
        return 0.0
    along = 0.0
    for a in range(state.r.shape[0]):
        middle = bodies.wheels[k].r[a]
        tangents = (middle - place(state, bodies, one, a)) / l1 + (place(state, bodies, two, a) - middle) / l2
        along += 0.5 * strands.gravity[a] * tangents
    return strands.rho[s] * strands.h[s] * along


@lean_inner
def _range(strands, loads, state, bodies, k, s, low, high):
    """How far wheel k may slide: not onto its neighbours, not beyond an end stop."""
    span, length = high - low, strands.links[s] * strands.h[s]
    least, most = low + 0.02 * span, high - 0.02 * span
    if loads.at_end[k] == STAY:
        xi, margin = state.xi[k], bodies.wheels[k].margin
        least, most = max(least, min(margin, xi)), min(most, max(length - margin, xi))
    return least, most


@lean_inner
def slide(strands, loads, state, buffers, bodies, p, speed, dt):
    """Find the place of a wheel that travels freely: where the pulls of the line and what acts along it agree.

    With T1 behind and T2 ahead, G the weight of the particle it carries, P the drive, R = kappa (T1 + T2) + brake the
    friction and U = d xi / dt,

        T2 - T1 + G = P - R sign U - viscous U       or  |T2 - T1 + G - P| <= R  and  U = 0.

    The unstrained length behind is the unknown, and both sides are monotone in it: one solution, found by Newton's
    method, at any step. A driver adds to P, within its limits, what lets it keep its speed.

    Returns:
        Work of the drive and loss by friction, J.
    """
    k = bodies.order[p]
    s, t = loads.strand[k], state.t[0]
    one, two = beside(bodies, p, -1), beside(bodies, p, 1)
    low, high, old = coordinate(state, one), coordinate(state, two), state.xi[k]
    l1, l2 = _length(state, bodies, one, -1 - k), _length(state, bodies, -1 - k, two)
    least, most = _range(strands, loads, state, bodies, k, s, low, high)
    kappa, c = _friction(loads, bodies, k, _turn(state, bodies, k, one, two, l1, l2)), strands.damping[s]
    brake = bodies.wheels[k].brake if (old > bodies.wheels[k].brake_end or old < bodies.wheels[k].brake_start) else 0.0
    viscous, P = bodies.wheels[k].viscous, drive_at(bodies, k, t)
    G = _carried(strands, state, bodies, k, s, one, two, l1, l2)
    U1, U2, rate1, rate2 = travel_speed(state, one), travel_speed(state, two), 0.0, 0.0
    if c > 0.0:
        for a in range(state.r.shape[0]):
            v, middle = bodies.wheels[k].v[a], bodies.wheels[k].r[a]
            rate1 += (middle - place(state, bodies, one, a)) * (v - _velocity(state, buffers, bodies, one, a)) / l1
            rate2 += (place(state, bodies, two, a) - middle) * (_velocity(state, buffers, bodies, two, a) - v) / l2

    T1, _ = _piece(strands, s, l1, old - low)
    T2, _ = _piece(strands, s, l2, high - old)
    stretch1, stretch2 = l1 / (old - low), l2 / (high - old)
    there = min(max(old + dt * state.speed[k], least), most)  # about where it will be, for stretches to look at
    mean = 0.5 * (l1 / (there - low) + l2 / (high - there))
    xi, sign = old, 0.0
    if bodies.wheels[k].driver > 0.0:
        U = speed / mean
        wanted = min(max(old + dt * U, least), most)
        T1, _ = _piece(strands, s, l1, wanted - low)
        T2, _ = _piece(strands, s, l2, high - wanted)
        U = (wanted - old) / dt
        s1, s2 = wanted - low, high - wanted
        if c > 0.0:
            T1 += c * (rate1 - (U - U1) * l1 / s1) / s1
            T2 += c * (rate2 - (U2 - U) * l2 / s2) / s2
        R = kappa * max(T1 + T2, 0.0) + brake
        needed = T2 - T1 + G + (R if U > 0.0 else (-R if U < 0.0 else 0.0)) + viscous * mean * U
        if abs(needed - P) <= bodies.wheels[k].driver:
            P, xi, sign = needed, wanted, 2.0
        else:
            P += bodies.wheels[k].driver if needed > P else -bodies.wheels[k].driver
            T1, _ = _piece(strands, s, l1, old - low)
            T2, _ = _piece(strands, s, l2, high - old)
    if sign == 0.0:
        if c > 0.0:
            T1 += c * (rate1 + U1 * stretch1) / (old - low)
            T2 += c * (rate2 - U2 * stretch2) / (high - old)
        pull, R = P - (T2 - T1 + G), kappa * max(T1 + T2, 0.0) + brake
        if abs(pull) > R or R == 0.0:  # without friction it slides, however little pulls at it
            sign = 1.0 if pull > 0.0 else -1.0
            lower, upper = (old, most) if sign > 0.0 else (least, old)
            for _ in range(MOST_STEPS):
                s1, s2, U = xi - low, high - xi, (xi - old) / dt
                T1, D1 = _piece(strands, s, l1, s1)
                T2, D2 = _piece(strands, s, l2, s2)
                D2 = -D2
                if c > 0.0:
                    T1 += c * (rate1 - (U - U1) * l1 / s1) / s1
                    T2 += c * (rate2 - (U2 - U) * l2 / s2) / s2
                    D1 -= c * l1 / (s1 * s1 * dt)
                    D2 += c * l2 / (s2 * s2 * dt)
                loud = sign * kappa if T1 + T2 > 0.0 else 0.0
                miss = T2 - T1 + G + loud * (T1 + T2) + sign * brake + viscous * mean * U - P
                slope = (1.0 + loud) * D2 - (1.0 - loud) * D1 + viscous * mean / dt
                if not slope > 0.0:
                    break  # the line is slack on both sides: nothing moves the wheel along it
                step = -miss / slope
                new = min(max(xi + step, lower), upper)
                close = abs(new - xi) <= CLOSE * (high - low)
                xi = new
                if close:
                    break
    state.xi[k] = xi
    if sign == 0.0:
        state.speed[k], bodies.wheels[k].driving = 0.0, P
        return 0.0, 0.0
    U = (xi - old) / dt if sign == 2.0 else sliding_speed(strands, loads, state, bodies, p, sign)
    state.speed[k] = U
    way = mean * (xi - old)
    lost = (kappa * max(T1 + T2, 0.0) + brake) * abs(way) + viscous * mean * U * way
    driven = 0.5 * (bodies.wheels[k].driving + P) * way
    bodies.wheels[k].driving = P
    return driven, lost


@lean_inner
def mean_stretch_at(state, bodies, p):
    """Mean of the stretches on the two sides of a wheel."""
    k = bodies.order[p]
    one, two = beside(bodies, p, -1), beside(bodies, p, 1)
    xi = state.xi[k]
    l1, l2 = _length(state, bodies, one, -1 - k), _length(state, bodies, -1 - k, two)
    return 0.5 * (l1 / (xi - coordinate(state, one)) + l2 / (coordinate(state, two) - xi))


@lean_inner
def sliding_speed(strands, loads, state, bodies, p, sign):
    """d xi / dt of a wheel that slides in the direction `sign`, at which the tensions keep in step.

    The change of xi over a step would not do: where a wheel takes or leaves a node, the piece beside it becomes another
    one, and xi jumps a little.
    """
    k = bodies.order[p]
    s, xi = loads.strand[k], state.xi[k]
    one, two = beside(bodies, p, -1), beside(bodies, p, 1)
    s1, s2 = xi - coordinate(state, one), coordinate(state, two) - xi
    l1, l2, rate1, rate2 = _length(state, bodies, one, -1 - k), _length(state, bodies, -1 - k, two), 0.0, 0.0
    for a in range(state.r.shape[0]):
        v, middle = bodies.wheels[k].v[a], bodies.wheels[k].r[a]
        rate1 += (middle - place(state, bodies, one, a)) * (v - velocity(state, bodies, one, a)) / l1
        rate2 += (place(state, bodies, two, a) - middle) * (velocity(state, bodies, two, a) - v) / l2
    _, D1 = _piece(strands, s, l1, s1)
    _, D2 = _piece(strands, s, l2, s2)
    loud = sign * _friction(loads, bodies, k, _turn(state, bodies, k, one, two, l1, l2))
    n1, n2 = -(1.0 - loud) * D1, -(1.0 + loud) * D2
    if not n1 + n2 > 0.0:
        return state.speed[k]
    own1, own2 = rate1 * s1 / l1 + travel_speed(state, one), rate2 * s2 / l2 - travel_speed(state, two)
    return (n1 * own1 - n2 * own2) / (n1 + n2)


@lean_inner
def hold(strands, loads, state, buffers, bodies, p):
    """Force that holds a wheel on its prescribed travel, N of work per m of unstrained line that it passes.

    T2 lam2 - W2 - (T1 lam1 - W1) - rho U^2 (lam2^2 - lam1^2) / 2: what it takes to pull the line through at different
    tensions (theory of the moving contact in docs/notes/moving-mass.md).
    """
    k = bodies.order[p]
    s, U = loads.strand[k], state.speed[k]
    one, two, law_s, c = beside(bodies, p, -1), beside(bodies, p, 1), strands.law[s], strands.damping[s]
    l1, l2 = _length(state, bodies, one, -1 - k), _length(state, bodies, -1 - k, two)
    jump = _carried(strands, state, bodies, k, s, one, two, l1, l2) * mean_stretch_at(state, bodies, p)
    for side in range(2):
        low, high = (one, -1 - k) if side == 0 else (-1 - k, two)
        rest = coordinate(state, high) - coordinate(state, low)
        length = _length(state, bodies, low, high)
        lam = length / rest
        T = law.tension(law_s, lam - 1.0)
        if c > 0.0:
            T += c * _strain_rate(state, buffers, bodies, low, high, length, rest)
        own = T * lam - law.stored(law_s, lam - 1.0) - 0.5 * strands.rho[s] * U * U * lam * lam
        jump += own if side == 1 else -own
    return jump


@lean_inner
def even_sides(state, bodies, p):
    """Move a wheel along x so that both sides are stretched alike: the frictionless contact at a given xi."""
    k = bodies.order[p]
    one, two, xi = beside(bodies, p, -1), beside(bodies, p, 1), state.xi[k]
    rest1, rest2 = xi - coordinate(state, one), coordinate(state, two) - xi
    for _ in range(20):
        l1, l2 = _length(state, bodies, one, -1 - k), _length(state, bodies, -1 - k, two)
        x = bodies.wheels[k].r[0]
        rate = (x - place(state, bodies, one, 0)) / (l1 * rest1) + (place(state, bodies, two, 0) - x) / (l2 * rest2)
        step = (l1 / rest1 - l2 / rest2) / rate
        bodies.wheels[k].r[0] -= step
        if abs(step) <= 1e-14 * (rest1 + rest2):
            return


@lean_inner
def correction(state, buffers, bodies, p, leading):
    """What the velocity along x of a wheel misses to keep both sides stretched alike, m/s.

    Args:
        leading: whether velocities extrapolated to the instant of the positions count, or those after the last kick.
    """
    k = bodies.order[p]
    one, two, rate, per_speed = beside(bodies, p, -1), beside(bodies, p, 1), 0.0, 0.0
    for side in range(2):
        low, high = (one, -1 - k) if side == 0 else (-1 - k, two)
        rest, length = coordinate(state, high) - coordinate(state, low), _length(state, bodies, low, high)
        own = -(travel_speed(state, high) - travel_speed(state, low)) * length / rest
        for a in range(state.r.shape[0]):
            if leading:
                v = _velocity(state, buffers, bodies, high, a) - _velocity(state, buffers, bodies, low, a)
            else:
                v = velocity(state, bodies, high, a) - velocity(state, bodies, low, a)
            own += (place(state, bodies, high, a) - place(state, bodies, low, a)) * v / length
        rate += own / rest if side == 0 else -own / rest
        per_speed += (place(state, bodies, high, 0) - place(state, bodies, low, 0)) / (length * rest)
    return -rate / per_speed


@lean_inner
def lifting(state, bodies, k):
    """Force with which the line pulls wheel k towards itself, N: if positive, a contact that only pushes lets go."""
    z = state.r.shape[0] - 1
    side, behind, forth = (1.0 if z == 2 else 0.0), bodies.wheels[k].behind, bodies.wheels[k].forth
    dx, dy, dz = behind[0] + forth[0], side * (behind[1] + forth[1]), behind[z] + forth[z]
    if not dx * dx + dy * dy + dz * dz > 0.0:
        return 0.0
    up = upward(dx, dy, dz, forth[0] - behind[0], side * (forth[1] - behind[1]), forth[z] - behind[z])
    return -bodies.wheels[k].lift * up
