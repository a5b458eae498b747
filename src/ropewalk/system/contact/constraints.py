"""Inextensible links: the tensions that keep their lengths, found after each drift (SHAKE).

With the square of a link's length as everywhere (`cables.py`), arcs and kinks included, a link is a constraint

    phi_i = (l_i^2 - h^2) / 2 = 0,    T_i = h mu_i,

whose multiplier mu_i pulls as T/l of an elastic link does. A kink under a contact of a body has the stiffness
S = S' T, linear in T, and K = |d|^2/2 h S' does not depend on T: nodes and bodies together are a system with holonomic
constraints, which stores nothing. What touches without a mass (given forces, some wheels) would make K depend on T, and
on nothing else where T is small: there the line lends it half the mass of a link.

A step kicks with the tensions that the last two lead to. What is missing after the drift are impulses x along the
gradients of phi at the places of the kick:

    phi(r - dt M^-1 G' x) = 0,

by Newton's method with the matrix of the kick, whose equations conjugate gradients solve; the band that links of a run
make among themselves is factored and preconditions them, so that one round does for a line alone. Joints, bodies and
contacts take some more. Linearised about rest, phi is its first-order change there, to which kinks add nothing.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import lean_inner
from ropewalk.mechanics.moving_contact import look_up
from ropewalk.system.contact.contact_record import ON
from ropewalk.system.contact.contacts import sit, soften
from ropewalk.system.contact.yielding import bent, bent_by_body, bent_by_turning, divide, keeps_length
from ropewalk.system.elements.cables import stretch_all
from ropewalk.system.elements.compliance import ARC, SHORT_ARC
from ropewalk.system.elements.spline import WIDTH
from ropewalk.system.elements.structure import MOVED

# Rounds of Newton's method and of conjugate gradients; the part of h^2/2 to which lengths are kept, and of the misses
# of a round to which its equations are solved.
ROUNDS, MORE, CLOSE, ENOUGH = 40, 200, 1e-12, 1e-8
BAND = 4  # links next to each other share nodes


@lean_inner
def note_kick(tight, h):
    """Note for how long tensions have kicked."""
    if tight is None or tight.h.size == 0:
        return
    tight.time[0] += h


@lean_inner
def draw(tight, structure, buffers, contacts, bodies, state, table, out, since):
    """Bring links to their lengths after a drift of the length `since` in s; 0: nothing has moved.

    `room.tension` has the tensions for the kicks to come afterwards.
    """
    if tight is None or tight.h.size == 0:
        return
    if since > 0.0 and tight.time[0] > 0.0:
        _draw(tight, structure, buffers, contacts, bodies, state, table, out, since)
    _take_gradients(tight, structure, buffers, state.r)


@lean_inner
def is_too_long(tight, dt):
    """Whether a step of the length dt in s is about too long for the transverse waves of lines under such tensions."""
    if tight is None or tight.h.size == 0:
        return False
    return tight.time[2] * dt * dt > tight.time[3]


@lean_inner
def _draw(tight, structure, buffers, contacts, bodies, state, table, out, dt):
    """Find the impulses of links, and move everything by them."""
    n, kicked, ahead = tight.x.size, tight.time[0], tight.time[1]
    for i in range(n):
        tight.guess[i] = tight.found[i] = buffers.tension[i]
        buffers.tension[i] += ahead * (tight.guess[i] - tight.before[i])
    worst = _miss(tight, structure, buffers, contacts, state, table, out)
    _factor(tight, structure, contacts, bodies, dt)
    for _ in range(ROUNDS):
        if not worst > CLOSE:
            break
        _solve(tight, structure, contacts, bodies, state, dt)
        _push(tight, structure, contacts, bodies, state, tight.x)
        for a in range(state.r.shape[0]):
            for i in range(n):
                state.v[a, i] += tight.move[a, i]
                state.r[a, i] += dt * tight.move[a, i]
        for c in range(state.u.size):
            if bodies.per_mass[c] > 0.0:
                state.w[c] += bodies.old[c]
                state.u[c] += dt * bodies.old[c]
        for i in range(n):
            tight.found[i] += tight.h[i] * tight.x[i] / kicked
            buffers.tension[i] = tight.found[i] + ahead * (tight.found[i] - tight.before[i])
        worst = _miss(tight, structure, buffers, contacts, state, table, out)
    if worst > 1e3 * CLOSE:
        state.r[0, 0] = np.nan  # lengths cannot be kept in such a step
    _lift(tight, structure, state, dt)
    fastest = 0.0
    for i in range(n):
        tight.before[i] = tight.found[i]
        if tight.h[i] > 0.0:
            fastest = max(fastest, tight.fast[i] * buffers.tension[i])
    tight.time[0], tight.time[1], tight.time[2] = 0.0, 1.0, fastest


@lean_inner
def _lift(tight, structure, state, dt):
    """Book the work that supports which move as prescribed do against what tensions were not as guessed."""
    restrained, t = structure.restraints, state.t[0] - dt
    for e in range(restrained.mass.size):
        if (
            restrained.entries[e] <= 1
            or restrained.free[e, 0, 0] + restrained.free[e, state.r.shape[0] - 1, state.r.shape[0] - 1] > 0.0
        ):
            continue
        for a in range(state.r.shape[0]):
            first, count, rate = restrained.table[e], restrained.entries[e], 0.0
            rate += look_up(restrained.time, restrained.moved[a], first, count, t + 0.5 * dt)
            rate -= look_up(restrained.time, restrained.moved[a], first, count, t - 0.5 * dt)
            rate /= dt
            for i in range(restrained.first[e], restrained.first[e] + restrained.nodes[e]):
                node = restrained.node[i]
                for m in range(4):
                    link = node + 1 - m
                    if 0 <= link < tight.x.size and tight.h[link] > 0.0 and tight.g[a, m, link] != 0.0:
                        x = (tight.found[link] - tight.guess[link]) * tight.time[0] / tight.h[link]
                        state.work[MOVED] += x * tight.g[a, m, link] * rate


@lean_inner
def _miss(tight, structure, buffers, contacts, state, table, out):
    """phi of all links at the places of now, to `tight.miss`; returns the largest one over h^2/2."""
    r, worst = state.r, 0.0
    stretch_all(structure, buffers, r)
    links, is_little = structure.about.links, structure.about.links.size > 0
    for i in range(tight.x.size):
        if tight.h[i] == 0.0:
            tight.miss[i] = 0.0
        elif is_little:
            tight.miss[i] = links[i].length * tight.h[i] * (buffers.strain[i] - links[i].strain)
        else:
            tight.miss[i] = 0.5 * (buffers.length[i] ** 2 - tight.h[i] ** 2)
    for k in range(contacts.size):
        if keeps_length(structure, contacts, k):
            sit(structure, contacts, state, k, state.s[k])
            soften(structure, contacts, table, out, k, 0.0, 0)
            for a in range(r.shape[0]):
                way = state.u[contacts[k].first + a] - contacts[k].p[a]
                contacts[k].d[a] = way if contacts[k].apart == 0 else 0.0
            divide(contacts, k, r.shape[0])
            square, h = bent(contacts, k, r.shape[0]), structure.runs.h[contacts[k].run]
            contacts[k].kink = 0.5 * square * h * contacts[k].by_tension
        if (contacts[k].state == ON or contacts[k].kink > 0.0) and not is_little:
            for j in range(3):
                if tight.h[contacts[k].link[j]] > 0.0:
                    tight.miss[contacts[k].link[j]] += contacts[k].part[j] * contacts[k].kink
    for i in range(tight.x.size):
        if tight.h[i] > 0.0:
            miss = 2.0 * abs(tight.miss[i]) / tight.h[i] ** 2
            worst = miss if not miss <= worst else worst
    return worst


@lean_inner
def _take_gradients(tight, structure, buffers, r):
    """Change of phi with the four nodes about each link, of what is linearised at rest, to `tight.g`.

    Second differences are known.
    """
    runs, g, bent = structure.runs, tight.g, buffers.bent
    if structure.about.links.size > 0:
        r, bent = structure.about.shape[0], structure.about.shape[1]
    for s in range(runs.first.size):
        if runs.law[s, 0] != law.RIGID:
            continue
        begin, last = runs.first[s], runs.first[s] + runs.links[s]
        for a in range(r.shape[0]):
            for i in range(begin, last):
                d, e = bent[a, i], bent[a, i + 1]
                one = 2.0 * (ARC * d - SHORT_ARC * (e - d)) if i > begin else 0.0
                two = 2.0 * (ARC * e + SHORT_ARC * (e - d)) if i + 1 < last else 0.0
                chord = r[a, i + 1] - r[a, i]
                g[a, 0, i], g[a, 1, i] = one, two - 2.0 * one - chord
                g[a, 2, i], g[a, 3, i] = chord + one - 2.0 * two, two


@lean_inner
def _push(tight, structure, contacts, bodies, state, x):
    """What impulses x of links change velocities by: of nodes to `tight.move`, of bodies to `bodies.old`."""
    axes, n, g, move, restrained = state.r.shape[0], tight.x.size, tight.g, tight.move, structure.restraints
    for a in range(axes):
        for i in range(n):
            move[a, i] = 0.0
        for i in range(n):
            if tight.h[i] > 0.0:
                for m in range(4):
                    if g[a, m, i] != 0.0:
                        move[a, i - 1 + m] -= x[i] * g[a, m, i]
    for c in range(bodies.f.size):
        bodies.f[c] = bodies.old[c] = 0.0
    for k in range(contacts.size):
        if keeps_length(structure, contacts, k):
            pull = 0.0
            for j in range(3):
                pull += contacts[k].part[j] * x[contacts[k].link[j]]
            h = structure.runs.h[contacts[k].run]
            pull *= h * contacts[k].by_tension
            for a in range(axes):
                d, turns = bent_by_body(contacts, k, a), bent_by_turning(contacts, k, a) / h
                bodies.f[contacts[k].first + a] -= pull * d
                for j in range(min(WIDTH, structure.runs.links[contacts[k].run] + 1)):
                    move[a, contacts[k].near + j] += pull * (contacts[k].weight[j] * d - contacts[k].slope[j] * turns)
    for e in range(restrained.mass.size):
        for a in range(axes):
            tight.whole[e, a] = 0.0
            for b in range(axes):
                for i in range(restrained.first[e], restrained.first[e] + restrained.nodes[e]):
                    tight.whole[e, a] += tight.mobile[e, a, b] * move[b, restrained.node[i]]
    for a in range(axes):
        for i in range(n):
            move[a, i] *= structure.nodes.light[i]
        for e in range(restrained.mass.size):
            for i in range(restrained.first[e], restrained.first[e] + restrained.nodes[e]):
                move[a, restrained.node[i]] = tight.whole[e, a]
    for c in range(bodies.f.size):
        if bodies.alone[c] == 1:
            bodies.old[c] = bodies.f[c] * bodies.per_mass[c]
    for p in range(bodies.size.size):
        for i in range(bodies.size[p]):
            for j in range(bodies.size[p]):
                bodies.old[bodies.at[p, i]] += bodies.inverse[0, p, i, j] * bodies.f[bodies.at[p, j]]


@lean_inner
def _apply(tight, structure, contacts, bodies, state, x, y, dt):
    """How much impulses x of links shorten them, to y: dt G M^-1 G' x."""
    axes, n, g = state.r.shape[0], tight.x.size, tight.g
    _push(tight, structure, contacts, bodies, state, x)
    for i in range(n):
        y[i] = x[i] if tight.h[i] == 0.0 else 0.0
    for a in range(axes):
        for i in range(n):
            if tight.h[i] > 0.0:
                for m in range(4):
                    if g[a, m, i] != 0.0:
                        y[i] -= dt * g[a, m, i] * tight.move[a, i - 1 + m]
    for k in range(contacts.size):
        if not keeps_length(structure, contacts, k):
            continue
        longer, h = 0.0, structure.runs.h[contacts[k].run]
        for a in range(axes):
            way, turn = bodies.old[contacts[k].first + a], 0.0
            for j in range(min(WIDTH, structure.runs.links[contacts[k].run] + 1)):
                way -= contacts[k].weight[j] * tight.move[a, contacts[k].near + j]
                turn += contacts[k].slope[j] * tight.move[a, contacts[k].near + j]
            longer += dt * (bent_by_body(contacts, k, a) * way + bent_by_turning(contacts, k, a) * turn / h)
        longer *= h * contacts[k].by_tension
        for j in range(3):
            if tight.h[contacts[k].link[j]] > 0.0:
                y[contacts[k].link[j]] -= contacts[k].part[j] * longer


@lean_inner
def _factor(tight, structure, contacts, bodies, dt):
    """Factor the band of the matrix that links of a run make, L D L', to `tight.band`."""
    B, g, n, mobile = tight.band, tight.g, tight.x.size, structure.nodes.mobile
    for i in range(n):
        for k in range(BAND):
            B[k, i] = 1.0 if k == 0 and tight.h[i] == 0.0 else 0.0
            if i + k < n and tight.h[i] > 0.0 and tight.h[i + k] > 0.0:
                for a in range(g.shape[0]):
                    for m in range(k, 4):
                        if g[a, m, i] != 0.0:
                            B[k, i] += dt * mobile[i - 1 + m] * g[a, m, i] * g[a, m - k, i + k]
    for k in range(contacts.size):
        if not keeps_length(structure, contacts, k):
            continue
        square, h = 0.0, structure.runs.h[contacts[k].run]
        for a in range(g.shape[0]):
            square += bent_by_body(contacts, k, a) ** 2 * bodies.per_mass[contacts[k].first + a]
        gain = dt * square * (h * contacts[k].by_tension) ** 2
        for i in range(3):
            for j in range(3):
                apart = contacts[k].link[j] - contacts[k].link[i]
                if 0 <= apart < BAND and tight.h[contacts[k].link[i]] > 0.0:
                    B[apart, contacts[k].link[i]] += gain * contacts[k].part[i] * contacts[k].part[j]
    for i in range(n):
        for k in range(1, BAND):
            if i + k < n:
                factor = B[k, i] / B[0, i]
                for j in range(k, BAND):
                    if i + j < n:
                        B[j - k, i + k] -= factor * B[j, i]
        for k in range(1, BAND):
            B[k, i] /= B[0, i]


@lean_inner
def _precondition(tight, b, z):
    """Solve the equations of the band, z = (L D L')^-1 b."""
    B, n = tight.band, b.size
    for i in range(n):
        z[i] = b[i]
    for i in range(n):
        for k in range(1, BAND):
            if i + k < n:
                z[i + k] -= B[k, i] * z[i]
    for i in range(n):
        z[i] /= B[0, i]
    for i in range(n - 1, -1, -1):
        for k in range(1, BAND):
            if i + k < n:
                z[i] -= B[k, i] * z[i + k]


@lean_inner
def _solve(tight, structure, contacts, bodies, state, dt):
    """Find impulses `tight.x` of links that take `tight.miss` away, by conjugate gradients."""
    x, left, p, y, z = tight.x, tight.miss, tight.p, tight.y, tight.z
    _precondition(tight, left, z)
    size = 0.0
    for i in range(x.size):
        x[i], p[i] = 0.0, z[i]
        size += left[i] * z[i]
    least = ENOUGH**2 * abs(size)
    for _ in range(MORE):
        if not size > least:
            break
        _apply(tight, structure, contacts, bodies, state, p, y, dt)
        bent = 0.0
        for i in range(x.size):
            bent += p[i] * y[i]
        if not bent > 0.0:
            break
        step, last = size / bent, size
        for i in range(x.size):
            x[i] += step * p[i]
            left[i] -= step * y[i]
        _precondition(tight, left, z)
        size = 0.0
        for i in range(x.size):
            size += left[i] * z[i]
        for i in range(x.size):
            p[i] = z[i] + size / last * p[i]
