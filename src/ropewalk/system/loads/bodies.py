"""Bodies: coordinates with masses, dampers and springs between them, which stand on the line at their contacts.

    M u'' + C u' + K u = force - N,   u = (places of contacts, coordinates).

A contact without mass has no equation of motion: there the springs above are in balance with the line below.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.bodies import Records
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.mechanics.elimination import solve
from ropewalk.mechanics.moving_contact import look_up
from ropewalk.mechanics.multibody_system import FIRM
from ropewalk.system.contact.contact_record import AWAY, FORCE, FREE, GONE, ON
from ropewalk.system.contact.contacts import find_kinks, stiffen
from ropewalk.system.contact.travel import travelled
from ropewalk.system.contact.yielding import firmness_along, has_hold, stiffness_between
from ropewalk.system.elements.profile import height_at
from ropewalk.system.elements.spline import WIDTH
from ropewalk.system.elements.structure import DRIVEN, IN_BODIES, LOADED, RESTRAINED, STRUCK
from ropewalk.system.loads.carriages import Carriages, add_bar_forces, roll, taken_by_bars
from ropewalk.system.loads.hauling_ropes import drift_ropes, kick_ropes
from ropewalk.system.loads.tethers import bear, hang

# Rounds of Newton's method for contacts without mass, and the part of a link to which their places are found.
ROUNDS, SETTLED = 40, 1e-11
# Rounds in which forces on wheels beside their lines are found: dampers couple them by h C/m, which is small.
_AGAIN = 8


# Part of a link before and behind a contact between which its profile bends.
BENDS = 1e-3
# Part of a link from an end within which a kink is softer than the line is.
SOFT = 0.25

# A load: some of its contacts are still to come or on their lines; all have left them since the step before; for good.
STAYS, LEAVES, GONE_FOR_GOOD = 0, 1, 2

BLOWN = np.dtype([("first", "i8"), ("drag", "f8")], align=True)  # a particle, and kg/m, force over speed squared
PUSHED = np.dtype([("coordinate", "i8"), ("first", "i8"), ("count", "i8")], align=True)  # by a force with a history


class BodyArrays(NamedTuple):
    """All of them; a part is a set of coordinates that springs, dampers or a mass matrix join."""

    mass: Array  # (coordinate,) kg, where it is lumped
    per_mass: Array  # (coordinate,) 1/kg, about what a force on it accelerates; 0: without mass
    force: Array  # (coordinate,) N, weights
    contact: Integers  # (coordinate,) the contact whose place it is, -1: none
    axis: Integers  # (coordinate,)
    alone: Integers  # (coordinate,) 1: it belongs to no part
    size: Integers  # (part,) number of coordinates
    at: Integers  # (part, size)
    M: Array  # (part, size, size) kg, with lumped masses
    C: Array  # N s/m
    K: Array  # N/m
    inverse: Array  # (2, part, size, size) 1/kg, of M + h/2 C for kicks of the length h: a step, and half a step
    weightless: Integers  # (part,) number of its coordinates that have no mass
    A: Array  # (size, size) room
    b: Array  # (size,)
    f: Array  # (coordinate,) N
    old: Array  # (coordinate,) m
    load: Integers  # (coordinate,) the load whose it is
    gone: Integers  # (load,) STAYS, LEAVES or GONE_FOR_GOOD
    tethers: Records
    blown: Records
    pushed: Records
    push_time: Array  # s, of forces on coordinates
    push_value: Array  # N
    hoist_time: Array  # s, speeds at which ropes of payloads are taken in
    hoist_value: Array  # m/s
    hoist_path: Array  # m, since time zero
    carriages: Carriages


def with_step(bodies: BodyArrays, dt: float) -> BodyArrays:
    """The same for steps of a given length in s."""
    return bodies._replace(inverse=_inverse(dt, bodies.M.shape, bodies.M.tobytes(), bodies.C.tobytes()))


@lru_cache(maxsize=16)
def _inverse(dt: float, shape: tuple[int, ...], M: bytes, C: bytes) -> Array:
    """Inverses of M + h/2 C for a step and half a step; between outputs steps are as long as ever, but for rounding."""
    mass, damping = np.frombuffer(M).reshape(shape), np.frombuffer(C).reshape(shape)
    heavy = np.diagonal(mass, axis1=1, axis2=2) > 0.0
    both, one, inverse = heavy[:, :, None] & heavy[:, None, :], np.eye(shape[1]), np.zeros((2, *shape))
    for i, h in enumerate((dt, 0.5 * dt)):
        inverse[i][both] = np.linalg.inv(np.where(both, mass + 0.5 * h * damping, one))[both]
    return inverse


@lean_inner
def _balance(structure, buffers, contacts, bodies, state, table, out, p, rate):
    """Balance one part, beside the kinks of others as they are; returns whether some of its contacts share links."""
    A, b, n, shares_links = bodies.A, bodies.b, bodies.size[p], False
    for _ in range(ROUNDS):
        for i in range(n):
            c = bodies.at[p, i]
            k, a = bodies.contact[c], bodies.axis[c]
            for j in range(n):
                A[i, j] = 0.0
            if bodies.per_mass[c] > 0.0 or (k >= 0 and contacts[k].state != ON and contacts[k].clear == 0):
                A[i, i], b[i] = 1.0, state.u[c]
                continue
            b[i] = bodies.force[c] + (contacts[k].given[a] if k >= 0 else 0.0)
            for j in range(n):
                d = bodies.at[p, j]
                A[i, j] = bodies.K[p, i, j]
                if bodies.per_mass[d] > 0.0 or rate == 0.0:
                    b[i] -= bodies.C[p, i, j] * state.w[d]
                else:
                    A[i, j] += bodies.C[p, i, j] * rate
                    b[i] += bodies.C[p, i, j] * rate * bodies.old[d]
            if k >= 0 and contacts[k].state == ON:
                stiffen(structure, buffers, contacts, state, table, out, k)
                for j in range(n):  # N changes by S and by the tension that the kink makes
                    d = bodies.at[p, j]
                    if bodies.contact[d] == k:
                        stiff = contacts[k].rise * contacts[k].d[a] * contacts[k].d[bodies.axis[d]]
                        if contacts[k].apart == 0:
                            stiff += stiffness_between(contacts, k, a, bodies.axis[d])
                        A[i, j] += stiff
                        b[i] += stiff * state.u[d]
                along = firmness_along(contacts, k) * contacts[k].axial * contacts[k].tangent[a]
                b[i] -= contacts[k].moving * contacts[k].d[a] + along
                bear(contacts, bodies, state, A, b, p, i, rate)
            if A[i, i] == 0.0 and k >= 0:  # in the air, where no spring holds it
                A[i, i], b[i] = 1.0, contacts[k].p[a] if contacts[k].state == ON else state.u[c]
        solve(A, b, n)
        most = 0.0
        for i in range(n):
            c = bodies.at[p, i]
            k = bodies.contact[c]
            if bodies.per_mass[c] == 0.0:
                if k >= 0 and contacts[k].state == ON:
                    most = max(most, abs(b[i] - state.u[c]) / structure.runs.h[contacts[k].run])
                    shares_links = shares_links or contacts[k].shares_links == 1
                state.u[c] = b[i]
        if most < SETTLED:
            break
    return shares_links


@lean_inner
def balance(structure, buffers, contacts, bodies, state, table, out, since):
    """Put coordinates without mass where springs above and the line below are in balance, by Newton's method.

    Args:
        since: s, since this was done before; 0: nothing has moved since, and velocities are known.
    """
    rate = 1.0 / since if since > 0.0 else 0.0
    for c in range(bodies.mass.size):
        if bodies.alone[c] == 1 and bodies.per_mass[c] == 0.0 and contacts[bodies.contact[c]].state == ON:
            state.u[c] = contacts[bodies.contact[c]].p[bodies.axis[c]]  # nothing above moves or holds it
    for c in range(bodies.mass.size):
        bodies.old[c] = state.u[c]
    for _ in range(ROUNDS):
        shares_links = False
        for p in range(bodies.size.size):
            here = bodies.weightless[p] > 0 and bodies.gone[bodies.load[bodies.at[p, 0]]] == STAYS
            if here and _balance(structure, buffers, contacts, bodies, state, table, out, p, rate):
                shares_links = True
        if not shares_links or not find_kinks(structure, buffers, contacts, state, table, out):
            break
    for p in range(bodies.size.size):
        if bodies.weightless[p] > 0 and bodies.gone[bodies.load[bodies.at[p, 0]]] == STAYS:
            for i in range(bodies.size[p]):
                c = bodies.at[p, i]
                if bodies.per_mass[c] == 0.0 and rate > 0.0 and not is_beside(contacts, bodies.contact[c]):
                    state.w[c] = (state.u[c] - bodies.old[c]) * rate


@inlined
def kick(structure, contacts, bodies, state, h, half):
    """Kick all bodies for the time h; those of a load that has just left its line, up to now.

    Args:
        half: 1 for half a step, 0 for a whole one.
    """
    f, u, w, old = bodies.f, state.u, state.w, bodies.old
    for c in range(f.size):
        k = bodies.contact[c]
        f[c], old[c] = bodies.force[c], w[c]
        if k >= 0:
            f[c] += contacts[k].given[bodies.axis[c]] - contacts[k].N[bodies.axis[c]]
            if has_hold(contacts, k):
                f[c] += contacts[k].hold * structure.runs.ahead[contacts[k].run, bodies.axis[c]]
    for e in range(bodies.pushed.size):
        f[bodies.pushed[e].coordinate] += pushed_with(bodies, e, state.t[0])
    for k in range(contacts.size):  # further ones that carry the same body
        if contacts[k].kind != FORCE and bodies.contact[contacts[k].first] != k:
            for a in range(state.r.shape[0]):
                f[contacts[k].first + a] += contacts[k].given[a] - contacts[k].N[a]
    hang(contacts, bodies, state)
    if roll(bodies.carriages):
        add_bar_forces(bodies.carriages, u, w, f, state.r.shape[0])
    for p in range(bodies.size.size):
        n, lost = bodies.size[p], 0.0
        stage = bodies.gone[bodies.load[bodies.at[p, 0]]]
        if stage == GONE_FOR_GOOD:
            continue
        shorter = 1 if stage == LEAVES else half
        own = h if shorter == half else 0.5 * h
        for i in range(n):
            c = bodies.at[p, i]
            for j in range(n):
                d = bodies.at[p, j]
                f[c] -= bodies.K[p, i, j] * u[d] + bodies.C[p, i, j] * w[d]
        state.work[RESTRAINED] += own * _bear_beside(contacts, bodies, f, w, shorter, p)
        for i in range(n):
            gain = 0.0
            for j in range(n):
                gain += bodies.inverse[shorter, p, i, j] * f[bodies.at[p, j]]
            k = bodies.contact[bodies.at[p, i]]
            bodies.b[i] = own * gain if not is_beside(contacts, k) else 0.0  # the ground moves it
        for i in range(n):
            c = bodies.at[p, i]
            for j in range(n):
                d = bodies.at[p, j]
                lost += (w[c] + 0.5 * bodies.b[i]) * bodies.C[p, i, j] * (w[d] + 0.5 * bodies.b[j])
        for i in range(n):
            w[bodies.at[p, i]] += bodies.b[i]
        state.work[IN_BODIES] += own * lost
    for c in range(f.size):
        stage, k = bodies.gone[bodies.load[c]], bodies.contact[c]
        if stage == GONE_FOR_GOOD or (k >= 0 and contacts[k].state == AWAY):
            continue
        if k >= 0 and contacts[k].moved == 1 and bodies.axis[c] == 0:
            contacts[k].evened = -f[c]
            state.work[RESTRAINED] -= h * f[c] * contacts[k].goes
        elif bodies.alone[c] == 1:
            w[c] += (h if stage == STAYS or half == 1 else 0.5 * h) * f[c] * bodies.per_mass[c]
            if k >= 0 and has_hold(contacts, k):
                level = structure.runs.ahead[contacts[k].run, bodies.axis[c]]
                state.work[RESTRAINED] += 0.5 * h * contacts[k].hold * level * (w[c] + old[c])
    for e in range(bodies.pushed.size):
        c = bodies.pushed[e].coordinate
        if bodies.gone[bodies.load[c]] == STAYS:
            state.work[LOADED] += 0.5 * h * pushed_with(bodies, e, state.t[0]) * (w[c] + old[c])
    for e in range(bodies.tethers.size):
        first, own = bodies.tethers[e].first, contacts[bodies.tethers[e].contact].first
        if bodies.gone[bodies.load[first]] == STAYS:
            for a in range(state.r.shape[0]):
                rate = 0.5 * (w[first + a] + old[first + a] - w[own + a] - old[own + a])
                state.work[IN_BODIES] += h * bodies.tethers[e].damper * bodies.tethers[e].span[a] * rate
            winch = h * bodies.tethers[e].damper * bodies.tethers[e].grows
            state.work[IN_BODIES] -= winch
            state.work[DRIVEN] -= winch
    if roll(bodies.carriages):
        state.work[IN_BODIES] += h * taken_by_bars(bodies.carriages, w, old, state.r.shape[0])
        kick_ropes(bodies.carriages, h)
    _push_by_wind(structure.wind, bodies, state, h)
    for i in range(bodies.gone.size):
        if bodies.gone[i] == LEAVES:
            bodies.gone[i] = GONE_FOR_GOOD


@inlined
def pushed_with(bodies, e, t):
    """Force of number e with a history at time t in s, N."""
    first, count = bodies.pushed[e].first, bodies.pushed[e].count
    return look_up(bodies.push_time, bodies.push_value, first, count, t)


@inlined
def is_beside(contacts, k):
    """Whether contact k, -1: none, is on the ground before or behind its line."""
    return k >= 0 and contacts[k].state == AWAY and contacts[k].clear == 0


@lean_inner
def _bear_beside(contacts, bodies, f, w, half, p):
    """Add to the forces on part p what the ground before and behind lines bears: nothing else moves wheels there.

    Returns:
        The power of the ground that moves what is at rest in itself, W.
    """
    n, power = bodies.size[p], 0.0
    for i in range(n):
        if is_beside(contacts, bodies.contact[bodies.at[p, i]]):
            power -= f[bodies.at[p, i]] * w[bodies.at[p, i]]
    for _ in range(_AGAIN):
        most = 0.0
        for i in range(n):
            c, own = bodies.at[p, i], bodies.inverse[half, p, i, i]
            if own > 0.0 and is_beside(contacts, bodies.contact[c]):
                gain = 0.0
                for j in range(n):
                    gain += bodies.inverse[half, p, i, j] * f[bodies.at[p, j]]
                f[c] -= gain / own
                most = max(most, abs(gain))
        if most == 0.0:
            break
    return power


@lean_inner
def _push_by_wind(wind, bodies, state, h):
    """Let the air slow down or take along what it drags: by the velocity of each as the air sees it.

    What is lost of the kinetic energy as the air sees it is dissipated; the change of momentum times the velocity of
    the air is its work.
    """
    blows = look_up(wind.time, wind.speed, 0, wind.time.size, state.t[0])
    for e in range(bodies.blown.size):
        first, square = bodies.blown[e].first, 0.0
        if bodies.gone[bodies.load[first]] != STAYS:
            continue
        m = 1.0 / bodies.per_mass[first]
        for a in range(state.r.shape[0]):
            square += (state.w[first + a] - blows * wind.direction[a]) ** 2
        slower = 1.0 / (1.0 + h * bodies.blown[e].drag * np.sqrt(square) / m)
        for a in range(state.r.shape[0]):
            change = (slower - 1.0) * (state.w[first + a] - blows * wind.direction[a])
            state.w[first + a] += change
            state.work[LOADED] += m * change * blows * wind.direction[a]
        state.work[IN_BODIES] += 0.5 * m * square * (1.0 - slower * slower)


@lean_inner
def ground(structure, contacts, state, k):
    """Put contact k, which is off its line, on firm ground where that ends now, with its profile, if there is any."""
    if contacts[k].clear == 1:
        return
    lines, runs, line = structure.lines, structure.runs, contacts[k].line
    run = lines.first[line]
    node = runs.first[run]
    if state.s[k] > 0.0:
        run += lines.runs[line] - 1
        node = runs.first[run] + runs.links[run]
    for a in range(state.r.shape[0]):
        state.u[contacts[k].first + a], state.w[contacts[k].first + a] = state.r[a, node], 0.0
    if contacts[k].rolls == 1:
        top, (rough, steep) = contacts[k].first + state.r.shape[0] - 1, height_at(lines.profiles, line, state.s[k])
        state.u[top] += rough
        state.w[top] = steep * contacts[k].speed


@lean_inner
def approach(structure, contacts, bodies, state):
    """Let contacts before and behind their lines follow the profile there; the ground does the work on their masses."""
    for k in range(contacts.size):
        rough = contacts[k].rolls == 1 and structure.lines.profiles.knots[contacts[k].line] > 0
        if rough and contacts[k].state == AWAY and contacts[k].led == 0:  # a foot in the air is where its owner has it
            top = contacts[k].first + state.r.shape[0] - 1
            before = state.w[top]
            ground(structure, contacts, state, k)
            if bodies.per_mass[top] > 0.0:
                state.work[RESTRAINED] += 0.5 / bodies.per_mass[top] * (state.w[top] ** 2 - before**2)


@lean_inner
def arrive(structure, buffers, contacts, bodies, state, table, out):
    """Put what comes to its line on it, with the speed along it, what leaves it on the ground; stop what is to stay.

    A mass comes with the force that the ground has borne. What moves contacts along does the work; what moves by itself
    loses it to the stop.
    """
    axes = state.r.shape[0]
    for k in range(contacts.size):
        stopped, comes = contacts[k].stopped, contacts[k].comes
        contacts[k].comes, contacts[k].stopped = 0, 0.0
        if contacts[k].kind == FORCE or contacts[k].state == GONE or (comes == 0 and stopped == 0.0):
            continue
        before, kinked, overrun = energy_of_bodies(bodies, state), 0.0, 0.0
        if contacts[k].travel == FREE and comes == 0:
            stopped = max(stopped * _speed_along(structure, contacts, state, k), 0.0) / stopped
        if comes == 0 and contacts[k].axial_stiffness > 0.0:  # within its last step it has gone on
            overrun = contacts[k].overrun
        for a in range(axes):
            c = contacts[k].first + a
            if comes > 0 and contacts[k].clear == 1:  # it comes below its line, as high as it is
                state.u[c] = contacts[k].p[a] if a < axes - 1 else state.u[c]
            elif comes > 0:
                state.u[c] = contacts[k].p[a]
                state.w[c] = contacts[k].speed * contacts[k].along[a]
            elif comes == 0:
                state.w[c] -= stopped * contacts[k].along[a]
                state.u[c] -= overrun * contacts[k].along[a]
        if comes < 0:
            ground(structure, contacts, state, k)
        elif comes > 0 and bodies.per_mass[contacts[k].first + axes - 1] > 0.0 and contacts[k].been == 1:
            kinked = _bear(structure, buffers, contacts, bodies, state, table, out, k)
        gained = energy_of_bodies(bodies, state) - before + kinked
        if contacts[k].travel == FREE and comes == 0:
            state.work[STRUCK] -= gained
        else:
            state.work[RESTRAINED] += gained


@lean_inner
def _bear(structure, buffers, contacts, bodies, state, table, out, k):
    """Let the line bear at once, by its kink, what the ground has borne of the mass at contact k; the kink's energy, J.

    N = weight and springs above - m r'' U^2. Without it a light mass would fall into its contact, and ring there. At an
    end a line gives way by nothing, and a kink by a quarter of what it does within the run: what a heavy mass, which
    is past that before it swings, were to be put down by, it would be too deep, and be thrown up by the kink.
    """
    top, line, h = contacts[k].first + state.r.shape[0] - 1, contacts[k].line, structure.runs.h[contacts[k].run]
    N = bodies.force[top] + contacts[k].given[state.r.shape[0] - 1]
    for p in range(bodies.size.size):
        for i in range(bodies.size[p]):
            if bodies.at[p, i] == top:
                for j in range(bodies.size[p]):
                    d = bodies.at[p, j]
                    N -= bodies.K[p, i, j] * state.u[d] + bodies.C[p, i, j] * state.w[d]
    if contacts[k].rolls == 1:
        step = BENDS * h
        ahead = height_at(structure.lines.profiles, line, state.s[k] + step)[1]
        behind = height_at(structure.lines.profiles, line, state.s[k] - step)[1]
        N -= (ahead - behind) / (2.0 * step) * contacts[k].speed ** 2 / bodies.per_mass[top]
    z, lowered, borne = state.r.shape[0] - 1, 0.0, 0.0
    for _ in range(_AGAIN):  # a kink is the stiffer, the more it tightens its links
        stiffen(structure, buffers, contacts, state, table, out, k)
        S = contacts[k].moving
        if S <= 0.0 or contacts[k].apart == 1:
            return 0.0
        past = SOFT * h / max(abs(contacts[k].speed), 1e-300)  # s, until it is where lines give way
        swings = (S * bodies.per_mass[top] * past**2) ** 2
        borne = N * (swings / (1.0 + swings) if swings < 1e12 else 1.0)
        for a in range(z + 1):
            along = contacts[k].tangent[a] * contacts[k].tangent[z] if contacts[k].axial_stiffness > 0.0 else 0.0
            lowered = borne / S * ((1.0 if a == z else 0.0) - along)
            lowered += borne * along / max(firmness_along(contacts, k), 1e-300)
            state.u[contacts[k].first + a] = contacts[k].p[a] + lowered
    return 0.5 * borne * lowered


@lean_inner
def _speed_along(structure, contacts, state, k):
    """Speed of the body at contact k along its line, in unstrained length, m/s."""
    base, along, square = contacts[k].near, 0.0, 0.0
    for a in range(state.r.shape[0]):
        v = state.w[contacts[k].first + a]
        for j in range(min(WIDTH, structure.runs.links[contacts[k].run] + 1)):
            v -= contacts[k].weight[j] * state.v[a, base + j]
        along += v * contacts[k].along[a]
        square += contacts[k].along[a] ** 2
    return along / square


@lean_inner
def energy_of_bodies(bodies, state):
    """Kinetic energy of all bodies, their springs' and that of their weights, but for tethers, J."""
    total, u, w = 0.0, state.u, state.w
    for c in range(u.size):
        total -= bodies.force[c] * u[c]
        if bodies.alone[c] == 1:
            total += 0.5 * bodies.mass[c] * w[c] * w[c]
    for p in range(bodies.size.size):
        for i in range(bodies.size[p]):
            c = bodies.at[p, i]
            for j in range(bodies.size[p]):
                d = bodies.at[p, j]
                total += 0.5 * u[c] * bodies.K[p, i, j] * u[d]
                if bodies.M[p, i, j] < FIRM:  # only its owner moves that
                    total += 0.5 * w[c] * bodies.M[p, i, j] * w[d]
    return total


@lean_inner
def lead(contacts, tables, bodies, state, h):
    """Give bodies that are moved along x the speeds that bring them to their places in the time h.

    What moves them changes their kinetic energy; its work against forces is booked where these act.
    """
    for k in range(contacts.size):
        c, t = contacts[k].first, state.t[0] + h
        if contacts[k].moved == 0 or bodies.contact[c] != k:
            continue
        before, faster = state.w[c], -contacts[k].goes
        state.w[c] = (contacts[k].origin + travelled(tables, contacts, k, t) - state.u[c]) / h
        state.work[RESTRAINED] += 0.5 / bodies.per_mass[c] * (state.w[c] ** 2 - before**2)
        contacts[k].goes = look_up(
            tables.speed_time, tables.speed_value, contacts[k].speed_first, contacts[k].speed_count, t
        )
        contacts[k].hold = (faster + contacts[k].goes) / (bodies.per_mass[c] * h)  # beside what balances forces


@inlined
def drift(bodies, state, h):
    """Move all bodies for the time h, but those of loads that are gone, and hauling ropes."""
    for c in range(state.u.size):
        if bodies.per_mass[c] > 0.0 and bodies.gone[bodies.load[c]] == STAYS:
            state.u[c] += h * state.w[c]
    if roll(bodies.carriages):
        drift_ropes(bodies.carriages, h)
