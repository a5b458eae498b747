"""Carrying: how a mass sits on the chain while it moves (docs/notes/moving-mass.md).

A heavy wheel has its own place. Inside a link it divides it in two pieces, neither of them shorter than D0 h: when it
comes that close to a node it takes the place of that node and carries its particle along, as a momentum; where it
passes the place that is the particle's own, the particle takes the velocity on the other side of the wheel; and beyond
D0 h the wheel puts it back. The momentum of wheel and particle together is kept each time:

    absorb    p = rho h w_c
    cross     v' = w - U r'  of the particle just past the wheel,  m v + p = m w + rho h v'
    release   r_j, v_j on the straight piece that holds it,  m v + p = m w + rho h v_j

Two wheels may stand in one link, and a node is handed over to the wheel that comes nearer to it.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.bodies import AWAY, CARRIED, FLYING, FREE, INSIDE, LOCATED, PARKED
from ropewalk.mechanics.chain import CONTACT, HOLD_WORK, LEAVE, OFF, REFUSE
from ropewalk.mechanics.compiled import inlined, lean, lean_inner
from ropewalk.mechanics.meeting import have_met
from ropewalk.mechanics.moving_contact import ARRIVED, location_of

# A node is carried along while it is closer to a wheel than this part of a link.
D0 = 0.25
# It is put back a little further away, so that it is not taken again at once.
RELEASE = 1.02 * D0


@lean
def sort(loads, state, bodies):
    """Note the order of the heavy wheels along the lines."""
    count, order = 0, bodies.order
    for k in range(state.xi.size):
        if bodies.wheels[k].heavy == 0 or (bodies.wheels[k].phase != INSIDE and bodies.wheels[k].phase != LOCATED):
            continue
        p = count
        while p > 0 and (
            loads.strand[order[p - 1]] > loads.strand[k]
            or (loads.strand[order[p - 1]] == loads.strand[k] and state.xi[order[p - 1]] > state.xi[k])
        ):
            order[p] = order[p - 1]
            p -= 1
        order[p] = k
        count += 1
    bodies.ordered[0] = count


@lean_inner
def beside(bodies, p, side):
    """The point behind (side -1) or ahead (1) of the wheel that is number p along the lines.

    Returns:
        A node, or -1 - k for wheel k.
    """
    k = bodies.order[p]
    link = bodies.wheels[k].at
    if bodies.wheels[k].phase == LOCATED and side < 0:
        link -= 1
    node = link + 1 if side > 0 else link
    q = p + side
    if 0 <= q < bodies.ordered[0]:
        j = bodies.order[q]
        if (bodies.wheels[j].phase == INSIDE and bodies.wheels[j].at == link) or (
            bodies.wheels[j].phase == LOCATED and bodies.wheels[j].at == node
        ):
            return -1 - j
    return node


@inlined
def coordinate(state, code):
    """Material coordinate of a point given by its code."""
    return state.X[code] if code >= 0 else state.xi[-1 - code]


@inlined
def place(state, bodies, code, a):
    """Position of a point."""
    return state.r[a, code] if code >= 0 else bodies.wheels[-1 - code].r[a]


@inlined
def velocity(state, bodies, code, a):
    """Velocity of a point."""
    return state.w[a, code] if code >= 0 else bodies.wheels[-1 - code].v[a]


@inlined
def travel_speed(state, code):
    """d xi / dt of a point."""
    return 0.0 if code >= 0 else state.speed[-1 - code]


@lean_inner
def _number(bodies, k):
    """Which one wheel k is along the lines."""
    for p in range(bodies.ordered[0]):
        if bodies.order[p] == k:
            return p
    return -1


@inlined
def _home(strands, s, node):
    return (node - strands.first[s]) * strands.h[s]


@lean_inner
def _location(strands, state, bodies, k):
    """Put the node that wheel k carries where the wheel is."""
    b = bodies.wheels[k].at
    state.X[b] = state.xi[k]
    for a in range(state.r.shape[0]):
        state.r[a, b], state.w[a, b] = bodies.wheels[k].r[a], bodies.wheels[k].v[a]


@lean_inner
def _absorb(strands, state, bodies, k, s, node):
    """Let wheel k take the place of a node."""
    m = strands.rho[s] * strands.h[s]
    for a in range(state.r.shape[0]):
        bodies.wheels[k].store[a] = m * state.w[a, node]
    bodies.wheels[k].phase, bodies.wheels[k].at = LOCATED, node
    bodies.wheels[k].passed = 1 if state.xi[k] > _home(strands, s, node) else 0
    _location(strands, state, bodies, k)


@lean_inner
def _outruns(strands, state, bodies, k, s, one, two):
    """Whether wheel k between two points is faster than the transverse waves on both sides: rho U^2 lam > T > 0."""
    low, high, xi = coordinate(state, one), coordinate(state, two), state.xi[k]
    square1, square2 = 0.0, 0.0
    for a in range(state.r.shape[0]):
        square1 += (bodies.wheels[k].r[a] - place(state, bodies, one, a)) ** 2
        square2 += (place(state, bodies, two, a) - bodies.wheels[k].r[a]) ** 2
    lam1, lam2 = np.sqrt(square1) / abs(xi - low), np.sqrt(square2) / abs(high - xi)
    T1, T2 = law.tension(strands.law[s], lam1 - 1.0), law.tension(strands.law[s], lam2 - 1.0)
    # A slack line has no waves: what is noise there must not decide where a heavy wheel goes.
    return min(T1, T2) > 0.0 and max(T1, T2) < strands.rho[s] * state.speed[k] ** 2 * min(lam1, lam2)


@lean_inner
def _tangent(state, bodies, one, two, a):
    """Component a of the direction from one point to another."""
    square = 0.0
    for b in range(state.r.shape[0]):
        d = place(state, bodies, two, b) - place(state, bodies, one, b)
        square += d * d
    return (place(state, bodies, two, a) - place(state, bodies, one, a)) / np.sqrt(square)


@lean_inner
def _from_behind(state, bodies, k, behind, U, m, rest, a):
    """Velocity of wheel k once the particle it carries moves as the line behind it does."""
    relative = -U * (bodies.wheels[k].r[a] - place(state, bodies, behind, a)) / rest
    M = bodies.wheels[k].mass[a]
    return (M * bodies.wheels[k].v[a] + bodies.wheels[k].store[a] - m * relative) / (M + m)


@lean_inner
def _from_front(state, bodies, k, front, U, left, a):
    """Velocity of wheel k on the line ahead of it, which knows nothing of it yet."""
    return velocity(state, bodies, front, a) + U * (place(state, bodies, front, a) - bodies.wheels[k].r[a]) / left


@lean_inner
def _cross(strands, state, bodies, k, s, p):
    """Let wheel k pass the particle of its node: m v + p = m w + rho h (w + v'), v' = -U r' past the wheel.

    A wheel that outruns the waves across the line follows the line ahead, and the particle takes the rest.
    """
    m, U, xi = strands.rho[s] * strands.h[s], state.speed[k], state.xi[k]
    behind, front = beside(bodies, p, -1 if U > 0.0 else 1), beside(bodies, p, 1 if U > 0.0 else -1)
    rest, left, outruns, along = xi - coordinate(state, behind), coordinate(state, front) - xi, False, 0.0
    if _outruns(strands, state, bodies, k, s, behind, front):
        outruns = True
        for a in range(state.r.shape[0]):
            along += _tangent(state, bodies, behind, front, a) * (
                _from_behind(state, bodies, k, behind, U, m, rest, a) - _from_front(state, bodies, k, front, U, left, a)
            )
    for a in range(state.r.shape[0]):
        if outruns:
            v = _from_front(state, bodies, k, front, U, left, a) + along * _tangent(state, bodies, behind, front, a)
        else:
            v = _from_behind(state, bodies, k, behind, U, m, rest, a)
        bodies.wheels[k].store[a] += bodies.wheels[k].mass[a] * (bodies.wheels[k].v[a] - v)
        bodies.wheels[k].v[a] = v
    bodies.wheels[k].passed = 1 if U > 0.0 else 0
    _location(strands, state, bodies, k)


@lean_inner
def _release(strands, state, bodies, k, s, p):
    """Put the particle of wheel k back to its node, on the straight piece that holds it."""
    b, m, xi, U = bodies.wheels[k].at, strands.rho[s] * strands.h[s], state.xi[k], state.speed[k]
    home, side = _home(strands, s, b), -1 if bodies.wheels[k].passed == 1 else 1
    other = beside(bodies, p, side)
    far = coordinate(state, other)
    f, V = (home - far) / (xi - far), travel_speed(state, other)
    front, outruns, across = beside(bodies, p, -side), False, 0.0
    if U * side < 0.0 and _outruns(strands, state, bodies, k, s, other, front):
        outruns = True
    for a in range(state.r.shape[0]):
        q, M = place(state, bodies, other, a), bodies.wheels[k].mass[a]
        d = bodies.wheels[k].r[a] - q
        v0 = (1.0 - f) * velocity(state, bodies, other, a) - ((1.0 - f) * V + f * U) * d / (xi - far)
        v = v0 + f * (M * bodies.wheels[k].v[a] + bodies.wheels[k].store[a] - m * v0) / (M + m * f)
        state.r[a, b], state.w[a, b] = q + f * d, v
        if outruns:
            across += _tangent(state, bodies, other, front, a) * (v - bodies.wheels[k].store[a] / m)
    for a in range(state.r.shape[0]):
        if outruns:  # it keeps what it has got across the line
            state.w[a, b] = bodies.wheels[k].store[a] / m + across * _tangent(state, bodies, other, front, a)
        bodies.wheels[k].v[a] += (bodies.wheels[k].store[a] - m * state.w[a, b]) / bodies.wheels[k].mass[a]
    state.X[b] = home
    bodies.wheels[k].phase, bodies.wheels[k].at = INSIDE, b if side < 0 else b - 1


@lean_inner
def let_go(strands, state, bodies, k, s):
    """Take wheel k off the line: its particle goes back to its node and moves on with the wheel's velocity.

    The node is put on the straight piece that it lies on: beside a kink any other place would stretch that piece.
    """
    b, m, xi, U = bodies.wheels[k].at, strands.rho[s] * strands.h[s], state.xi[k], state.speed[k]
    if bodies.wheels[k].phase != LOCATED:
        return
    way = _home(strands, s, b) - xi
    a0, a1 = state.X[b - 1], state.X[b + 1]
    side = b - 1 if way < 0.0 else b + 1
    for a in range(state.r.shape[0]):
        slope = (state.r[a, side] - bodies.wheels[k].r[a]) / (state.X[side] - xi)
        if way == 0.0:
            slope = (state.r[a, b + 1] - state.r[a, b - 1]) / (a1 - a0)
        v = bodies.wheels[k].v[a] - U * slope
        bodies.wheels[k].v[a] += (bodies.wheels[k].store[a] - m * v) / bodies.wheels[k].mass[a]
        state.r[a, b] = bodies.wheels[k].r[a] + way * slope
        state.w[a, b] = v
    state.X[b] += way
    bodies.wheels[k].at = b if way <= 0.0 else b - 1


@lean
def land(strands, loads, state, bodies, k):
    """Put wheel k, whose xi is known, onto the line: in its link, or in the place of a node that is close."""
    s, xi = loads.strand[k], state.xi[k]
    first, n, h = strands.first[s], strands.links[s], strands.h[s]
    i = location_of(state.X, xi, h, first, first + n)
    bodies.wheels[k].phase, bodies.wheels[k].at = INSIDE, i
    for node in (i, i + 1):
        if abs(_home(strands, s, node) - xi) < D0 * h and _is_free(strands, state, bodies, s, node, k):
            _absorb(strands, state, bodies, k, s, node)
            return


@lean_inner
def _is_free(strands, state, bodies, s, node, k):
    """Whether wheel k may carry a node: one inside the line that nothing else has taken."""
    first = strands.first[s]
    if node <= first or node >= first + strands.links[s]:
        return False
    for j in range(state.moving_load.size):
        if state.moving_load[j] == node or (
            j != k and bodies.wheels[j].phase == LOCATED and bodies.wheels[j].at == node
        ):
            return False
    return True


@lean_inner
def _holder(bodies, node):
    """The wheel that carries a node, -1 if none does."""
    for k in range(bodies.wheels.size):
        if bodies.wheels[k].phase == LOCATED and bodies.wheels[k].at == node:
            return k
    return -1


@lean_inner
def _around(state, bodies, k):
    """The points behind and ahead of parked wheel k: nodes, or -1 - j for wheel j."""
    i = bodies.wheels[k].at
    one, two = i, i + 1
    for j in range(bodies.wheels.size):
        if bodies.wheels[j].phase == LOCATED and bodies.wheels[j].at == i:
            one = -1 - j
        elif bodies.wheels[j].phase == LOCATED and bodies.wheels[j].at == i + 1:
            two = -1 - j
    for j in range(bodies.wheels.size):
        if bodies.wheels[j].phase == INSIDE and bodies.wheels[j].at == i:
            if coordinate(state, one) < state.xi[j] < state.xi[k]:
                one = -1 - j
            elif state.xi[k] < state.xi[j] < coordinate(state, two):
                two = -1 - j
    return one, two


@lean
def on_straight(strands, state, bodies, k):
    """Put a parked wheel on the straight piece that it stands on, and let it move with it.

    The support holds it there: what changes the energy of the wheel's own mass is the support's work.
    """
    one, two = _around(state, bodies, k)
    low, xi, gained = coordinate(state, one), state.xi[k], 0.0
    rest = coordinate(state, two) - low
    part = (xi - low) / rest
    U = state.speed[k] - (1.0 - part) * travel_speed(state, one) - part * travel_speed(state, two)
    for a in range(state.r.shape[0]):
        M, g, behind = bodies.wheels[k].mass[a], strands.gravity[a], place(state, bodies, one, a)
        slope = (place(state, bodies, two, a) - behind) / rest
        r, v = behind + part * rest * slope, U * slope
        v += (1.0 - part) * velocity(state, bodies, one, a) + part * velocity(state, bodies, two, a)
        gained += M * (0.5 * (v * v - bodies.wheels[k].v[a] ** 2) - g * (r - bodies.wheels[k].r[a]))
        bodies.wheels[k].r[a], bodies.wheels[k].v[a] = r, v
    state.work[HOLD_WORK] += gained


@lean_inner
def _leave_support(strands, loads, state, bodies, k):
    """Let a parked wheel become a mass on the line, far enough from the support."""
    s, xi, U = loads.strand[k], state.xi[k], state.speed[k]
    length = strands.links[s] * strands.h[s]
    clearance = bodies.wheels[k].clearance * (1.0 - 1e-9)
    if min(xi, length - xi) < clearance:
        return
    if (U > 0.0 and xi > length - clearance) or (U < 0.0 and xi < clearance):
        return
    on_straight(strands, state, bodies, k)
    land(strands, loads, state, bodies, k)


@lean_inner
def _change(strands, loads, state, bodies, k):
    """Absorb, cross or release, where wheel k has come to a place for it. True if something has changed."""
    s, xi, U, p = loads.strand[k], state.xi[k], state.speed[k], _number(bodies, k)
    h = strands.h[s]
    tol = ARRIVED * h
    if bodies.wheels[k].phase == INSIDE:
        i = bodies.wheels[k].at
        node = i + 1 if U > 0.0 else i
        gap = abs(_home(strands, s, node) - xi)
        if gap > D0 * h + tol:
            return False
        if _is_free(strands, state, bodies, s, node, k):
            q = p + (1 if U > 0.0 else -1)
            if (
                0 <= q < bodies.ordered[0]
                and bodies.wheels[bodies.order[q]].phase == INSIDE
                and bodies.wheels[bodies.order[q]].at == i
            ):
                return False  # another wheel stands between
            _absorb(strands, state, bodies, k, s, node)
            return True
        j = _holder(bodies, node)
        if (
            j < 0
            or abs(state.xi[j] - _home(strands, s, node)) < gap - tol
            or bodies.wheels[j].passed != (1 if U > 0.0 else 0)
        ):
            return False
        # The particle lies between the two and is nearer to this one: it is handed over.
        _release(strands, state, bodies, j, s, _number(bodies, j))
        _absorb(strands, state, bodies, k, s, node)
        return True
    home = _home(strands, s, bodies.wheels[k].at)
    ahead = xi - home  # how far the wheel is beyond the particle
    passed = bodies.wheels[k].passed == 1
    if (not passed and U > 0.0 and ahead >= -tol) or (passed and U < 0.0 and ahead <= tol):
        _cross(strands, state, bodies, k, s, p)
        return True
    if (passed and ahead >= RELEASE * h - tol) or (not passed and ahead <= -RELEASE * h + tol):
        _release(strands, state, bodies, k, s, p)
        return True
    return False


@lean_inner
def _next(strands, loads, state, bodies, k):
    """The xi, ahead on its travel, at which wheel k has to change its node."""
    s, xi, U = loads.strand[k], state.xi[k], state.speed[k]
    h, length = strands.h[s], strands.links[s] * strands.h[s]
    if U == 0.0 or bodies.wheels[k].phase == FLYING:
        return np.inf
    forward, last = U > 0.0, length - bodies.wheels[k].margin
    end = last if forward else bodies.wheels[k].margin
    if (forward and xi >= end) or (not forward and xi <= end):
        end = length if forward else 0.0
    phase, sign = bodies.wheels[k].phase, 1.0 if forward else -1.0
    if phase == PARKED:
        clearance = bodies.wheels[k].clearance
        target = clearance if forward else length - clearance
        return target if (target - xi) * sign > 0.0 else end
    if phase == INSIDE:
        node = bodies.wheels[k].at + (1 if forward else 0)
        home = _home(strands, s, node)
        target = home - sign * D0 * h
        if (target - xi) * sign <= ARRIVED * h:  # the node is not free: when it is handed over
            j = _holder(bodies, node)
            other = abs(state.xi[j] - home) if j >= 0 else 0.0
            gap = abs(home - xi)
            target = xi + sign * max(0.5 * (gap - other), 0.05 * gap)
    else:
        home = _home(strands, s, bodies.wheels[k].at)
        before = bodies.wheels[k].passed == (0 if forward else 1)
        target = home if before else home + sign * RELEASE * h
    return min(target, end) if forward else max(target, end)


@lean_inner
def _at_end(strands, loads, state, bodies, k):
    """Whether wheel k has come to the distance from a support at which the line ends for it."""
    s, xi, U = loads.strand[k], state.xi[k], state.speed[k]
    length, tol = strands.links[s] * strands.h[s], ARRIVED * strands.h[s]
    return (U > 0.0 and xi >= length - bodies.wheels[k].margin - tol) or (
        U < 0.0 and xi <= bodies.wheels[k].margin + tol
    )


@lean_inner
def _stored(strands, state, bodies, s, one, two):
    """Strain energy of the piece between two points, J."""
    rest, square = coordinate(state, two) - coordinate(state, one), 0.0
    for a in range(state.r.shape[0]):
        square += (place(state, bodies, two, a) - place(state, bodies, one, a)) ** 2
    return rest * law.stored(strands.law[s], np.sqrt(square) / rest - 1.0)


@lean_inner
def take_off(strands, loads, state, bodies, k):
    """Take wheel k off the line for good.

    What the pieces beside it lose is lost: at a prescribed speed the last of them may have been stretched manifold.
    """
    s, p, located, b = loads.strand[k], _number(bodies, k), bodies.wheels[k].phase == LOCATED, bodies.wheels[k].at
    lost, on_line = 0.0, bodies.wheels[k].phase == INSIDE or located
    if on_line:
        m, one, two = strands.rho[s] * strands.h[s], beside(bodies, p, -1), beside(bodies, p, 1)
        lost = _stored(strands, state, bodies, s, one, -1 - k) + _stored(strands, state, bodies, s, -1 - k, two)
        if located:
            for a in range(state.r.shape[0]):
                mass = bodies.wheels[k].mass[a]
                lost += 0.5 * (bodies.wheels[k].store[a] ** 2 / m + mass * bodies.wheels[k].v[a] ** 2)
    let_go(strands, state, bodies, k, s)
    bodies.wheels[k].phase = AWAY
    state.moving_load[k] = OFF
    if located:
        lost -= _stored(strands, state, bodies, s, one, b) + _stored(strands, state, bodies, s, b, two)
        for a in range(state.r.shape[0]):
            lost -= 0.5 * (m * state.w[a, b] ** 2 + bodies.wheels[k].mass[a] * bodies.wheels[k].v[a] ** 2)
    elif on_line:
        lost -= _stored(strands, state, bodies, s, one, two)
    state.work[CONTACT] += lost
    bodies.wheels[k].parting = lost


@lean
def take_places(strands, loads, state, bodies, target):
    """Let every heavy wheel take the place that its xi asks for, and note where it has to change next.

    Returns:
        0; 1 if a load has come to the end of its line and may go neither on nor off; 2 if two loads have met.
    """
    for k in range(state.xi.size):
        if state.moving_load[k] != CARRIED:
            continue
        if bodies.wheels[k].phase == PARKED:
            _leave_support(strands, loads, state, bodies, k)
        if bodies.wheels[k].phase != FLYING and _at_end(strands, loads, state, bodies, k):
            if loads.at_end[k] == REFUSE:
                return 1
            if loads.at_end[k] == LEAVE:
                take_off(strands, loads, state, bodies, k)
            elif bodies.wheels[k].travel != FREE or bodies.wheels[k].phase == PARKED:
                state.speed[k] = 0.0
    sort(loads, state, bodies)
    changed, rounds = True, 0
    while changed and rounds < 4:
        changed, rounds = False, rounds + 1
        for k in range(state.xi.size):
            if bodies.wheels[k].phase == INSIDE or bodies.wheels[k].phase == LOCATED:
                changed = _change(strands, loads, state, bodies, k) or changed
    if have_met(strands, loads, state, bodies):
        return 2
    for k in range(state.xi.size):
        if state.moving_load[k] == CARRIED:
            target[k] = _next(strands, loads, state, bodies, k)
    return 0
