"""Moving contacts: how a travelling load sits on the chain while it moves (docs/notes/travelling-node.md).

The node nearest to the load rides with it: it has the load's material coordinate xi, the two links beside it have
the unstrained lengths xi - X_a and X_c - xi (between h/2 and 3h/2), and all particles that the load passes take the
velocity jump [r_t] = -U [r'] through the flux terms

    r_b' = w_b + U (r_c - r_a) / (X_c - X_a)
    rho h w_b' = [T t] + F + rho h U (w_c - w_a) / (X_c - X_a)

where w is the velocity of the material, U = d xi / dt, and a, b, c are the nodes behind, at and ahead of the load.
Half-way between two nodes the load changes over to the next one. In the first half link of a line, close to its end,
and where another load is too close, the force is shared by the two nodes of its link instead.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import (
    ARC,
    LEAVE,
    MATERIAL,
    OFF,
    REFUSE,
    SHARED,
    SHARING,
    SLIP,
    STAY,
)
from ropewalk.mechanics.compiled import inlined, lean, lean_inner
from ropewalk.mechanics.link import growth, stretch

# A node is claimed only where this part of a link is left on both sides.
CAPACITY = 0.45
# A load rides where the tension is above this multiple of what its speed needs (a Mach number of 0.88).
SUBSONIC = 1.29
# The last node rides on until its load is this part of a link away from the support. Beside one that is held, that
# needs no smaller step; one that yields has a mass of half a link, and steps are this part of the others.
LAST, BESIDE_A_FREE_END = 0.25, 0.5
# A load counts as arrived when it is this part of a link away: far below any other error.
ARRIVED = 1e-6


@lean_inner
def _entry(time, first, count, t):
    """Index of the table entry at or before t (the first one before the table begins)."""
    low, high = first, first + count
    while high - low > 1:
        middle = (low + high) // 2
        if time[middle] <= t:
            low = middle
        else:
            high = middle
    return low


@inlined
def look_up(time, value, first, count, t):
    """A table's value at time t: linear between its entries, constant outside."""
    if count == 1:
        return value[first]
    i = _entry(time, first, count, t)
    if i == first + count - 1 or t <= time[i]:
        return value[i]
    return value[i] + (t - time[i]) / (time[i + 1] - time[i]) * (value[i + 1] - value[i])


@lean
def look_up_integral(time, value, integral, first, count, t):
    """The integral of a table from time 0 to t, given up to each entry."""
    if count == 1:
        return integral[first] + value[first] * (t - time[first])
    i = _entry(time, first, count, t)
    return integral[i] + 0.5 * (t - time[i]) * (value[i] + look_up(time, value, first, count, t))


@lean
def speed_at(loads, k, t):
    """Speed V(t) of load k in m/s, as measured."""
    return look_up(loads.speed_time, loads.speed_value, loads.speed_first[k], loads.speed_count[k], t)


@lean
def force_at(loads, k, t, a):
    """Component a of the given force of load k at time t in N."""
    return look_up(loads.force_time, loads.force_value[a], loads.force_first[k], loads.force_count[k], t)


@lean
def location_of(X, xi, h, i0, i1):
    """Link between the nodes i0 and i1 that holds the material coordinate xi."""
    i = i0 + min(max(int(xi / h), 0), i1 - i0 - 1)
    while i > i0 and X[i] > xi:
        i -= 1
    while i < i1 - 1 and X[i + 1] < xi:
        i += 1
    return i


@lean
def link_of(strands, loads, state, k):
    """Link on which a shared load stands."""
    s = loads.strand[k]
    first = strands.first[s]
    return location_of(state.X, state.xi[k], strands.h[s], first, first + strands.links[s])


@lean
def part_of(state, k, i):
    """Place of a shared load on link i: 0 at its first node, 1 at its second."""
    return (state.xi[k] - state.X[i]) / (state.X[i + 1] - state.X[i])


@inlined
def mesh_speed(moving_load, speed, i):
    """d X / dt of node i: the speed of the load that it carries, or zero."""
    for k in range(moving_load.size):
        if moving_load[k] == i:
            return speed[k]
    return 0.0


@inlined
def slope(r, X, b, a):
    """Component a of the mean tangent r' at the riding node b."""
    return (r[a, b + 1] - r[a, b - 1]) / (X[b + 1] - X[b - 1])


@inlined
def _velocity_of(state, w, i, a):
    """Component a of the velocity of node i itself, where the material has the velocities w."""
    U = mesh_speed(state.moving_load, state.speed, i)
    return w[a, i] + U * slope(state.r, state.X, i, a) if U != 0.0 else w[a, i]


@lean_inner
def node_velocity(state, i, a):
    """Component a of the velocity of node i itself: of the material, or of the load it rides with."""
    return _velocity_of(state, state.w, i, a)


@lean
def contact_point(strands, loads, state, k, out):
    """Position of the contact of load k."""
    b = state.moving_load[k]
    for a in range(state.r.shape[0]):
        if b >= 0:
            out[a] = state.r[a, b]
        else:
            i = link_of(strands, loads, state, k)
            part = part_of(state, k, i)
            out[a] = (1.0 - part) * state.r[a, i] + part * state.r[a, i + 1]


@lean_inner
def sides(strands, loads, state, k):
    """Links behind and ahead of load k, in the order of xi (the same link for a shared load)."""
    b = state.moving_load[k]
    if b >= 0:
        return b - 1, b
    i = link_of(strands, loads, state, k)
    return i, i


@lean
def mean_stretch(strands, loads, state, k):
    """Mean of the stretches 1 + eps on the two sides of load k."""
    i, j = sides(strands, loads, state, k)
    X = state.X
    return 0.5 * (stretch(state.r, i) / (X[i + 1] - X[i]) + stretch(state.r, j) / (X[j + 1] - X[j]))


@lean_inner
def _arc_speed(strands, loads, state, k, V):
    """U for a given rate V of the arc length from the start of the line to the load."""
    s = loads.strand[k]
    r, w = state.r, state.w
    i, _ = sides(strands, loads, state, k)
    first = strands.first[s]
    rate = growth(first, i, r, w)
    for m in range(state.moving_load.size):  # nodes that ride move along the material as well
        b = state.moving_load[m]
        for j in range(max(b - 1, first), min(b + 1, i)):
            part = state.speed[m] / stretch(r, j) * (1.0 if j < b else -1.0)
            for a in range(r.shape[0]):
                rate += part * (r[a, j + 1] - r[a, j]) * slope(r, state.X, b, a)
    b = state.moving_load[k]
    own, per_speed = 0.0, 0.0
    length = stretch(r, i)
    for a in range(r.shape[0]):
        t = (r[a, i + 1] - r[a, i]) / length
        own += t * (w[a, i + 1] - node_velocity(state, i, a))
        per_speed += t * (
            slope(state.r, state.X, b, a) if b >= 0 else (r[a, i + 1] - r[a, i]) / (state.X[i + 1] - state.X[i])
        )
    if b < 0:
        own *= part_of(state, k, i)
    return (V - rate - own) / per_speed


@lean_inner
def _horizontal_speed(strands, loads, state, k, V):
    """U for a given horizontal speed V of the contact."""
    b = state.moving_load[k]
    if b >= 0:
        return (V - state.w[0, b]) / slope(state.r, state.X, b, 0)
    i = link_of(strands, loads, state, k)
    part = part_of(state, k, i)
    w = (1.0 - part) * node_velocity(state, i, 0) + part * node_velocity(state, i + 1, 0)
    return (V - w) * (state.X[i + 1] - state.X[i]) / (state.r[0, i + 1] - state.r[0, i])


@inlined
def has_arrived(strands, loads, k, xi, speed):
    """Whether load k has come to the end of its line, or to its margin there."""
    h, n = strands.h[loads.strand[k]], strands.links[loads.strand[k]]
    near = loads.margin[k] + ARRIVED * h
    return (xi >= n * h - near and speed > 0.0) or (xi <= near and speed < 0.0)


@lean
def material_speed(strands, loads, state, k, V):
    """U = d xi / dt of load k for a speed V as measured."""
    if V == 0.0 and loads.measure[k] <= SLIP:
        return 0.0
    measure = loads.measure[k]
    if measure == MATERIAL:
        U = V
    elif measure == SLIP:
        U = V / mean_stretch(strands, loads, state, k)
    elif measure == ARC:
        U = _arc_speed(strands, loads, state, k, V)
    else:
        U = _horizontal_speed(strands, loads, state, k, V)
    if loads.at_end[k] == STAY and has_arrived(strands, loads, k, state.xi[k], U):
        return 0.0
    return U


@lean_inner
def next_change(strands, loads, state, k):
    """The xi, ahead on the travel, at which the load's location on the chain has to change."""
    s = loads.strand[k]
    h, n = strands.h[s], strands.links[s]
    b, U, xi, margin = state.moving_load[k], state.speed[k], state.xi[k], loads.margin[k]
    if b <= OFF or U == 0.0:
        return np.inf
    if b >= 0:
        number = b - strands.first[s]
        if U > 0.0:
            is_last = number == n - 1 and xi >= (n - 0.5 - ARRIVED) * h
            return min((n - LAST if is_last else number + 0.5) * h, n * h - margin)
        return max((LAST if number == 1 and xi <= (0.5 + ARRIVED) * h else number - 0.5) * h, margin)
    half = 0.5 * h  # shared: look again at every half link, and at the end
    if U > 0.0:
        return min(half * (np.floor(xi / half + ARRIVED) + 1.0), n * h - margin)
    return max(half * (np.ceil(xi / half - ARRIVED) - 1.0), margin)


@lean_inner
def near_supports(strands, loads, state):
    """Part of the largest step that may be made where ends yield: less while a node rides close to a support."""
    for k in range(state.xi.size):
        s, b, xi = loads.strand[k], state.moving_load[k], state.xi[k]
        first, n, h, onward = strands.first[s], strands.links[s], strands.h[s], ARRIVED * np.sign(state.speed[k])
        if (b == first + 1 and xi <= (0.5 - onward) * h) or (b == first + n - 1 and xi >= (n - 0.5 - onward) * h):
            return BESIDE_A_FREE_END
    return 1.0


@lean_inner
def _is_free(strands, state, s, j, xi):
    """Whether node j is inside its line, carries no load and leaves room for one at xi."""
    first, n, h = strands.first[s], strands.links[s], strands.h[s]
    if j <= first or j >= first + n:
        return False
    for k in range(state.moving_load.size):
        if state.moving_load[k] == j:
            return False
    return state.X[j + 1] - xi >= CAPACITY * h and xi - state.X[j - 1] >= CAPACITY * h


@lean_inner
def _is_subsonic(strands, state, s, i, j, U):
    """Whether transverse waves outrun a load at speed U between the links i and j: T / lam > rho U^2, in the mean.

    A load that outruns them meets a line at rest and has no kink to carry along.
    """
    mean = 0.0
    for link in (i, j):
        lam = stretch(state.r, link) / (state.X[link + 1] - state.X[link])
        mean += 0.5 * law.tension(strands.law[s], lam - 1.0) / lam
    return mean > SUBSONIC * strands.rho[s] * U * U


@lean
def put_back(strands, state, s, b, U):
    """Put the riding node b back to its own place, on the straight sub-link that holds it."""
    home = (b - strands.first[s]) * strands.h[s]
    X, r, w = state.X, state.r, state.w
    xi = X[b]
    if home <= xi:
        a, f = b - 1, (home - X[b - 1]) / (xi - X[b - 1])
    else:
        a, f = b + 1, (X[b + 1] - home) / (X[b + 1] - xi)
    for i in range(r.shape[0]):
        tangent = (r[i, b] - r[i, a]) / (xi - X[a])
        v = node_velocity(state, b, i)
        r[i, b] = r[i, a] + f * (r[i, b] - r[i, a])
        w[i, b] = (1.0 - f) * w[i, a] + f * (v - U * tangent)
    X[b] = home


@lean_inner
def _keep_kink(state, b, point, behind, ahead):
    """Let node b, which has been put back, stand where its links are stretched as the sub-links at `point` were.

    No other node takes over the kink that was there. Cut off, it would leave a link slack, and one that resists
    compression would throw the line about with what it stores.
    """
    X, r, square, gone = state.X, state.r, 0.0, 0.0
    rest1, rest2 = X[b] - X[b - 1], X[b + 1] - X[b]
    if min(stretch(r, b - 1) / rest1, stretch(r, b) / rest2) >= min(1.0, behind, ahead):
        return
    for a in range(r.shape[0]):
        d = r[a, b + 1] - r[a, b - 1]
        square += d * d
        gone += d * (point[a] - r[a, b - 1])
    one, two, across = behind * rest1, ahead * rest2, 0.0
    for a in range(r.shape[0]):
        across += (point[a] - r[a, b - 1] - gone / square * (r[a, b + 1] - r[a, b - 1])) ** 2
    part = 0.5 * (1.0 + (one * one - two * two) / square)
    height = one * one - part * part * square
    if not (height > 0.0 and across > 0.0):
        return
    for a in range(r.shape[0]):
        d = r[a, b + 1] - r[a, b - 1]
        normal = point[a] - r[a, b - 1] - gone / square * d
        r[a, b] = r[a, b - 1] + part * d + np.sqrt(height / across) * normal


@lean_inner
def _move(strands, loads, state, k, step, point, velocity):
    """Let load k change over from its node to the next one (step = 1 or -1), or share it where there is none (0)."""
    s, b, U = loads.strand[k], state.moving_load[k], state.speed[k]
    for a in range(state.r.shape[0]):
        point[a], velocity[a] = state.r[a, b], node_velocity(state, b, a)
    subsonic = _is_subsonic(strands, state, s, b - 1, b, U)
    X = state.X
    behind, ahead = stretch(state.r, b - 1) / (X[b] - X[b - 1]), stretch(state.r, b) / (X[b + 1] - X[b])
    put_back(strands, state, s, b, U)
    state.moving_load[k] = SHARED
    j = b + step
    if step == 0 or not _is_free(strands, state, s, j, state.xi[k]) or not subsonic:
        _keep_kink(state, b, point, behind, ahead)
        return
    state.moving_load[k] = j
    state.X[j] = state.xi[k]
    for a in range(state.r.shape[0]):
        state.r[a, j] = point[a]
    for a in range(state.r.shape[0]):
        state.w[a, j] = velocity[a] - U * slope(state.r, state.X, j, a)


@lean_inner
def _claim(strands, loads, state, k):
    """Let a shared load ride with the nearest node if that one is free."""
    if loads.contact[k] == SHARING:
        return
    s, U, xi = loads.strand[k], state.speed[k], state.xi[k]
    place = xi / strands.h[s]
    nearest = int(np.floor(place + 0.5 + ARRIVED)) if U >= 0.0 else int(np.ceil(place - 0.5 - ARRIVED))
    j = strands.first[s] + nearest
    if not _is_free(strands, state, s, j, xi):
        return
    i = link_of(strands, loads, state, k)
    if not _is_subsonic(strands, state, s, i, i, U):
        return
    part = part_of(state, k, i)
    r, w, X = state.r, state.w, state.X
    span = X[i + 1] - X[i]
    for a in range(r.shape[0]):
        tangent = (r[a, i + 1] - r[a, i]) / span
        point = (1.0 - part) * r[a, i] + part * r[a, i + 1]
        v = (1.0 - part) * w[a, i] + part * w[a, i + 1] + U * tangent
        r[a, j] = point
        w[a, j] = v  # of the contact; made a velocity of the material below
    X[j] = xi
    for a in range(r.shape[0]):
        w[a, j] -= U * slope(state.r, state.X, j, a)
    state.moving_load[k] = j


@lean_inner
def settle(strands, loads, state, k, point, velocity):
    """Change the location of load k if it has come to a place where it must.

    Returns:
        True if the load has come to the end of its line and may go neither on nor off.
    """
    s, b, U = loads.strand[k], state.moving_load[k], state.speed[k]
    if b <= OFF:
        return False
    h, n = strands.h[s], strands.links[s]
    tol, margin, xi = ARRIVED * h, loads.margin[k], state.xi[k]
    arrived = has_arrived(strands, loads, k, xi, U)
    if arrived and loads.at_end[k] == STAY:
        state.speed[k], state.xi[k] = 0.0, n * h - margin if U > 0.0 else margin
        if b >= 0:
            state.X[b] = state.xi[k]
        return False
    if b >= 0:
        number = b - strands.first[s]
        if arrived:
            _move(strands, loads, state, k, 0, point, velocity)
        elif U > 0.0 and xi >= ((n - LAST) if number == n - 1 else number + 0.5) * h - tol:
            _move(strands, loads, state, k, 1, point, velocity)
        elif U < 0.0 and xi <= (LAST if number == 1 else number - 0.5) * h + tol:
            _move(strands, loads, state, k, -1, point, velocity)
    if arrived:
        if loads.at_end[k] == LEAVE:
            state.moving_load[k] = OFF
        return loads.at_end[k] == REFUSE
    if b < 0:
        _claim(strands, loads, state, k)
    return False


@lean_inner
def even_out(r, X, b):
    """Move the riding node b along x so that both sides are stretched alike: the frictionless contact."""
    behind, ahead = X[b] - X[b - 1], X[b + 1] - X[b]
    for _ in range(20):
        l1, l2 = stretch(r, b - 1), stretch(r, b)
        gap = l1 / behind - l2 / ahead
        rate = (r[0, b] - r[0, b - 1]) / (l1 * behind) + (r[0, b + 1] - r[0, b]) / (l2 * ahead)
        step = gap / rate
        r[0, b] -= step
        if abs(step) <= 1e-14 * (behind + ahead):
            return


@lean_inner
def even_velocity(state, w, b):
    """Velocity of the material along x at the riding node with which both sides stay stretched alike, m/s.

    Args:
        w: (axis, node) m/s, the velocities of the material otherwise.
    """
    r, X = state.r, state.X
    U = mesh_speed(state.moving_load, state.speed, b)
    behind, ahead = X[b] - X[b - 1], X[b + 1] - X[b]
    l1, l2 = stretch(r, b - 1), stretch(r, b)
    # d/dt (l1 / behind - l2 / ahead) is linear in the x-velocity of the contact: value at the present one, slope.
    value = -(l1 / behind) * U / behind - (l2 / ahead) * U / ahead
    for a in range(r.shape[0]):
        v = _velocity_of(state, w, b, a)
        value += (r[a, b] - r[a, b - 1]) * (v - _velocity_of(state, w, b - 1, a)) / (l1 * behind)
        value -= (r[a, b + 1] - r[a, b]) * (_velocity_of(state, w, b + 1, a) - v) / (l2 * ahead)
    return w[0, b] - value / ((r[0, b] - r[0, b - 1]) / (l1 * behind) + (r[0, b + 1] - r[0, b]) / (l2 * ahead))
