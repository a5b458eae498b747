"""Contacts: where loads touch their lines. One scheme, without events, for whatever touches and whatever line.

A contact at s has the point p of the spline of its run. What touches has a place of its own; d, from p to there, is the
tip of the kink that links of finite length round off, and gives way with the compliance C of `compliance.py`:

    V = |d|^2 / (2 C),   N = d / C on the line,   kinks lengthen the three links below by  dV/dT = d^2/2 d(1/C)/dT.

Without a body the force is given and d follows; a body has its own place, N follows, and reaches it in turn. At speed U
along the line a kink feels the tension T - rho U^2.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.mechanics.rider import look_up, look_up_integral
from ropewalk.system.compliance import KINETIC, compliance, kinetic
from ropewalk.system.spline import WIDTH, links_under, share

# Largest square of a speed over that of transverse waves with which a kink is carried along.
FASTEST = 0.9025

# Rounds in which a kink and the tension that it makes find each other.
AGAIN = 3

FORCE, BODY = 0, 1  # what touches: a given force, or coordinates that move
AWAY, ON = 0, 1

_REAL, _CODE, _VECTOR = "f8", "i8", ("f8", (3,))
CONTACT = np.dtype(
    [
        ("line", _CODE),
        ("kind", _CODE),
        ("first", _CODE),  # of a body: its first coordinate, one for each axis
        ("lift", _CODE),  # 0: it cannot leave its line; 1: it runs above it, -1: below
        ("begin", _REAL),  # m, s at time zero
        ("speed_first", _CODE),  # where its tables begin, and how many entries they have
        ("speed_count", _CODE),
        ("force_first", _CODE),
        ("force_count", _CODE),
        ("state", _CODE),  # AWAY or ON
        ("run", _CODE),
        ("near", _CODE),  # first node that shares its point
        ("x", _REAL),  # links along its run
        ("speed", _REAL),  # m/s along the line
        ("weight", "f8", (WIDTH,)),
        ("slope", "f8", (WIDTH,)),  # per link
        ("link", "i8", (3,)),
        ("part", "f8", (3,)),
        ("change", "f8", (3,)),  # of the parts, per link
        ("p", *_VECTOR),  # m, point of the spline
        ("along", *_VECTOR),  # its derivative by s
        ("place", *_VECTOR),  # m, of what touches
        ("before", *_VECTOR),  # m, when it was last looked at
        ("last", *_VECTOR),  # N, given force then
        ("hold", _REAL),  # N, force along the line that moves it
        ("d", *_VECTOR),  # m
        ("given", *_VECTOR),  # N, given force
        ("N", *_VECTOR),  # N on the line
        ("tension", _REAL),  # N, mean of the links below
        ("soft", _REAL),  # C, m/N
        ("carried", _REAL),  # N/m, by which 1/C is less since the contact moves
        ("was", *_VECTOR),  # m, d when it was last looked at
        ("lagged", *_VECTOR),  # N, `carried` times d then
        ("rise", _REAL),  # N/m^3, over the product of two components of d: what N changes by as the tension rises
        ("hard", _REAL),  # N/m, 1/C with what gives way within a step
        ("firm", _REAL),  # part of 1/C that is not of the tension
        ("kink", _REAL),  # strain of the links below, all together
        ("turn", _REAL),  # J/m, change of the energy of the kink with s, beside that of p
    ],
    align=True,
)


@inlined
def give(tables, contacts, k, t, axes):
    """Note the given force on contact k at time t."""
    for a in range(axes):
        contacts[k].given[a] = look_up(
            tables.force_time, tables.force_value[a], contacts[k].force_first, contacts[k].force_count, t
        )


@lean_inner
def locate(structure, contacts, tables, state, t):
    """Put all contacts where they are along their lines at time t."""
    lines, runs, r = structure.lines, structure.runs, state.r
    for k in range(contacts.size):
        first, count = contacts[k].speed_first, contacts[k].speed_count
        contacts[k].speed = look_up(tables.speed_time, tables.speed_value, first, count, t)
        s = contacts[k].begin + look_up_integral(
            tables.speed_time, tables.speed_value, tables.speed_path, first, count, t
        )
        state.s[k] = s
        give(tables, contacts, k, t, r.shape[0])
        line = contacts[k].line
        contacts[k].state = ON if 0.0 <= s <= lines.length[line] else AWAY
        if contacts[k].state == AWAY:
            continue
        run = lines.first[line]
        while run < lines.first[line] + lines.runs[line] - 1 and s >= lines.begin[run + 1]:
            run += 1
        n, h = runs.links[run], runs.h[run]
        x = min(max((s - lines.begin[run]) / h, 0.0), float(n))
        contacts[k].run, contacts[k].x = run, x
        base = runs.first[run] + share(x, n, contacts[k].weight, contacts[k].slope)
        contacts[k].near = base
        links_under(x, runs.first[run], n, contacts[k].link, contacts[k].part, contacts[k].change)
        most = min(WIDTH, n + 1)
        for a in range(r.shape[0]):
            here, slope = 0.0, 0.0
            for j in range(most):
                here += contacts[k].weight[j] * r[a, base + j]
                slope += contacts[k].slope[j] * r[a, base + j]
            contacts[k].p[a], contacts[k].along[a] = here, slope / h


@lean_inner
def _tension_under(structure, room, contacts, k, kink):
    """Mean tension of the links under a contact if a kink adds to their strain, and its change with that."""
    p, T, slope = structure.runs.law[contacts[k].run], 0.0, 0.0
    for j in range(3):
        q, e = contacts[k].part[j], room.strain[contacts[k].link[j]]
        T += q * law.tension(p, e + q * kink)
        slope += q * q * law.tangent(p, e + q * kink)
    return T, slope


@lean_inner
def _soften(structure, contacts, table, out, k, T):
    """Compliance of contact k under the tension T; returns the strain that a square of d/h makes, over that."""
    run = contacts[k].run
    h, rho, U = structure.runs.h[run], structure.runs.rho[run], contacts[k].speed
    bending = structure.runs.bending[run] / (h * h)
    T = max(T, 0.0)
    moving = min(rho * U * U, FASTEST * (T + bending))
    square = moving / max(T + bending, 1e-300)
    taut = max(T - moving, 0.0) if bending > 0.0 else T - moving
    whole = taut + bending
    if whole <= 0.0:
        contacts[k].soft, contacts[k].turn, contacts[k].firm, contacts[k].carried = np.inf, 0.0, 0.0, 0.0
        compliance(contacts[k].x, structure.runs.links[run], 0.0, table, out)
        return 0.5 / max(out[0] * kinetic(FASTEST, KINETIC), 1e-9)
    zeta = bending / whole
    compliance(contacts[k].x, structure.runs.links[run], zeta, table, out)
    kappa = max(out[0], 0.0) * (1.0 + (1.0 - zeta) * (kinetic(square, KINETIC) - 1.0))
    contacts[k].soft = h / whole * kappa
    contacts[k].carried = moving / (h * max(kappa, 1e-9))
    contacts[k].turn = out[2] / (max(out[0], 1e-9) * h)
    part = 1.0 + zeta * out[1] / max(out[0], 1e-9)
    contacts[k].firm = 1.0 - part * (1.0 - zeta)
    return 0.5 * part / max(kappa, 1e-9)


@lean_inner
def stiffen(structure, room, contacts, state, table, out, k):
    """Compliance, kink and stiffness of the contact of a body, where the body is now."""
    axes, h, square = state.r.shape[0], structure.runs.h[contacts[k].run], 0.0
    for a in range(axes):
        contacts[k].place[a] = state.u[contacts[k].first + a]
        contacts[k].d[a] = contacts[k].place[a] - contacts[k].p[a]
    if contacts[k].lift != 0 and contacts[k].lift * _above(contacts, k, axes) > 0.0:
        for a in range(axes):
            contacts[k].d[a] = 0.0
    for a in range(axes):
        square += contacts[k].d[a] ** 2
    T, slope = _tension_under(structure, room, contacts, k, 0.0)
    part = _soften(structure, contacts, table, out, k, T)
    for _ in range(AGAIN):  # the kink raises the tension, and is less under more of it
        contacts[k].kink = part * square / (h * h)
        T, slope = _tension_under(structure, room, contacts, k, contacts[k].kink)
        part = _soften(structure, contacts, table, out, k, T)
    contacts[k].kink = part * square / (h * h)
    contacts[k].rise = (2.0 * part / h) ** 2 * slope / h


@lean_inner
def bend(structure, room, contacts, state, table, out):
    """Find how far all contacts are from their splines, and add the kinks to the strains of the links below."""
    axes = state.r.shape[0]
    for k in range(contacts.size):
        if contacts[k].state == AWAY:
            continue
        if contacts[k].kind == FORCE:
            h, F = structure.runs.h[contacts[k].run], 0.0
            for a in range(axes):
                F += contacts[k].given[a] ** 2
            F = np.sqrt(F)
            length = _yield(structure, room, contacts, k, table, out, F, h)
            for a in range(axes):
                contacts[k].d[a] = length * contacts[k].given[a] / F if F > 0.0 else 0.0
                contacts[k].place[a] = contacts[k].p[a] + contacts[k].d[a]
            continue
        stiffen(structure, room, contacts, state, table, out, k)
    for k in range(contacts.size):
        if contacts[k].state == ON:
            for j in range(3):
                room.strain[contacts[k].link[j]] += contacts[k].part[j] * contacts[k].kink


@lean_inner
def _above(contacts, k, axes):
    """How far what touches is above its line, across it in its upright plane, m."""
    t, d, z = contacts[k].along, contacts[k].d, axes - 1
    along = square = 0.0
    for a in range(axes):
        along += t[a] * d[a]
        square += t[a] * t[a]
    return d[z] - along / square * t[z]


@lean_inner
def _yield(structure, room, contacts, k, table, out, F, h):
    """Length of d under a given force F, where the kink itself raises the tension: d / C grows with d.

    Newton's method within a bracket.
    """
    contacts[k].kink = 0.0
    if F == 0.0:
        return 0.0
    low, high, length = 0.0, np.inf, 0.0
    for a in range(3):
        length += contacts[k].d[a] ** 2
    length = np.sqrt(length)
    if length == 0.0:
        length = 0.01 * h
    for _ in range(60):
        part = 0.5 / max(out[0], 1e-9)
        for _again in range(2):
            contacts[k].kink = part * length * length / (h * h)
            T, slope = _tension_under(structure, room, contacts, k, contacts[k].kink)
            part = _soften(structure, contacts, table, out, k, T)
        contacts[k].kink = part * length * length / (h * h)
        soft = contacts[k].soft
        if soft == 0.0:
            contacts[k].kink = 0.0
            return 0.0
        miss = length / soft - F
        if miss > 0.0:
            high = length
        else:
            low = length
        rise = 1.0 / soft + (2.0 * part * length / h) ** 2 * slope / h
        new = length - miss / rise if np.isfinite(rise) else np.inf
        if not low < new < high:
            new = 0.5 * (low + high) if np.isfinite(high) else 4.0 * length
        step, length = abs(new - length), new
        if step <= 1e-12 * length or length > 1e3 * h:
            break
    contacts[k].kink = part * length * length / (h * h)
    return length


@lean_inner
def press(structure, room, contacts, state, bodies, table, out, dt):
    """Forces of all contacts on their lines, added to those of the nodes; `room.tension` is known.

    Args:
        dt: s, of a step: what gives way within it keeps a stiff contact stable.
    """
    axes = state.r.shape[0]
    for k in range(contacts.size):
        if contacts[k].state == AWAY:
            for a in range(axes):
                contacts[k].N[a] = 0.0
            continue
        T, base, most = 0.0, contacts[k].near, min(WIDTH, structure.runs.links[contacts[k].run] + 1)
        for j in range(3):
            T += contacts[k].part[j] * room.tension[contacts[k].link[j]]
        contacts[k].tension = T
        if contacts[k].kind == FORCE:
            for a in range(axes):
                contacts[k].N[a] = contacts[k].given[a]
        else:
            give_way = yields(structure, contacts, k)
            _soften(structure, contacts, table, out, k, T)
            for a in range(axes):
                per_mass = bodies.per_mass[contacts[k].first + a]
                if per_mass > 0.0:
                    free = 0.5 * dt * dt * (give_way + per_mass)
                    contacts[k].N[a] = contacts[k].d[a] / (contacts[k].soft + free)
        for a in range(axes):
            for j in range(most):
                room.force[a, base + j] += contacts[k].weight[j] * contacts[k].N[a]


@lean_inner
def yields(structure, contacts, k):
    """Displacement of the point of contact k by an impulse there, over the impulse and a time, 1/kg."""
    total, base = 0.0, contacts[k].near
    for j in range(min(WIDTH, structure.runs.links[contacts[k].run] + 1)):
        total += contacts[k].weight[j] ** 2 * structure.nodes.light[base + j]
    return total
