"""Motion of a structure and of all that it carries: one loop of kicks and drifts, the whole of it compiled.

A step is kick b1, drift a1, kick b2, ..., drift am, kick b(m+1) with the coefficients of `solve/composition.py`. The
last kick of a step and the first of the next need the same forces, which are found once.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.mechanics.elimination import solve_definite
from ropewalk.mechanics.moving_contact import look_up
from ropewalk.system.contact.at_sheaves import is_at_sheave
from ropewalk.system.contact.brakes import pressed_energy
from ropewalk.system.contact.constraints import draw, is_too_long, note_kick
from ropewalk.system.contact.contact_record import AWAY, BODY, FREE, GONE, NOT, ON
from ropewalk.system.contact.contacts import add_contact_forces, bend
from ropewalk.system.contact.friction import rub
from ropewalk.system.contact.travel import fade, locate
from ropewalk.system.contact.yielding import eased, stored_along, stored_beside
from ropewalk.system.elements.cables import (
    add_internal_forces,
    add_wind_forces,
    energy_of,
    find_strains,
    guess,
    stretch_all,
)
from ropewalk.system.elements.inertia import kick_along
from ropewalk.system.elements.saddles import (
    add_saddle_forces,
    bear_on,
    carried_along,
    go_along,
    lie_on,
    rub_on_saddles,
    stored_in_saddles,
)
from ropewalk.system.elements.sheaves import (
    RUBS,
    add_sheave_forces,
    exist,
    pass_nodes,
    slip,
    stored_at,
    stretch_over,
)
from ropewalk.system.elements.structure import (
    CARRIED,
    DAMPED,
    DRIVEN,
    LAGGED,
    LOADED,
    MOVED,
    RESTRAINED,
    RUBBED,
    STRUCK,
)
from ropewalk.system.elements.surfaces import (
    add_surface_forces,
    damp_surfaces,
    distribute_forces,
    follow,
    is_damped,
    stored_in,
)
from ropewalk.system.elements.ties import add_tie_forces, are_damped, damp_ties, stored_in_ties, tie_up
from ropewalk.system.elements.winches import LIMIT, kick_winch
from ropewalk.system.loads.bodies import LEAVES, STAYS, approach, arrive, balance, drift, ground, kick, lead
from ropewalk.system.loads.carriages import roll
from ropewalk.system.loads.hauling_ropes import haul
from ropewalk.system.loads.tethers import gap, grow, hoist

RUNNING, NOT_FINITE, AT_END, ASKED, AT_SHEAVE, LINE_OUT, TOO_LONG = 0, 1, 2, 3, 4, 5, 6
GIVEN, SETTLE, LOCATE, LOOK = -3, -2, -1, 0  # instead of a number of steps


@inlined
def _displaced(restraints, e, a, t):
    """Component a of where a restraint stands, or its springs are without force."""
    return restraints.place[e, a] + look_up(
        restraints.time, restraints.moved[a], restraints.table[e], restraints.entries[e], t
    )


@inlined
def _look(structure, buffers, contacts, tables, bodies, state, table, out, dt, since, windy, steps):
    """All forces at the places of now: on nodes to `room.force`, of contacts to their records.

    Args:
        dt: s, for which the wind will kick.
        since: s, since they were looked at before; 0: what damps does not act; negative: they have gone back in time.
        steps: as of `advance`.

    Returns:
        Powers of what damps and of the wind, W, and the energy stored in all runs, J, if nothing is to move.
    """
    stored = 0.0
    for a in range(state.r.shape[0]):
        for i in range(state.r.shape[1]):
            buffers.force[a, i] = structure.nodes.force[a, i]
    follow(structure.surfaces, state.r, state.v)
    stretch_all(structure, buffers, state.r)
    if exist(structure.sheaves):
        stretch_over(structure.sheaves, structure.runs, buffers, state.r)
    locate(structure, buffers, contacts, tables, state, table, out, since)
    if steps == LOCATE:
        for k in range(contacts.size):
            if contacts[k].kind == BODY and contacts[k].state == AWAY:
                ground(structure, contacts, state, k)
        return 0.0, 0.0, 0.0
    if roll(bodies.carriages):
        haul(bodies.carriages, structure, buffers, contacts, tables, state, since)
    if since > 0.0:
        state.work[STRUCK] += fade(buffers, contacts, since)
    if steps != GIVEN:
        _let_go(contacts, bodies)
    if steps != GIVEN and bodies.mass.size > 0:  # a call hands all arrays on, which costs as much as fifty nodes
        arrive(structure, buffers, contacts, bodies, state, table, out)
        approach(structure, contacts, bodies, state)
    draw(buffers.tight, structure, buffers, contacts, bodies, state, table, out, since)
    if steps != GIVEN and bodies.mass.size > 0:
        balance(structure, buffers, contacts, bodies, state, table, out, since)
    for k in range(contacts.size):
        if contacts[k].rubs != NOT and contacts[k].state == ON and contacts[k].kind != BODY:
            rub(structure, buffers, contacts, state, table, out, k)
    bend(structure, buffers, contacts, state, table, out)
    if exist(structure.sheaves):
        state.work[RUBBED] += slip(structure.sheaves, structure.runs, state.r, RUBS)
    if steps <= LOOK:
        find_strains(structure, buffers)
        stored = energy_of(structure, buffers, state.r) + stored_in(structure.surfaces, state.r)
        stored += stored_at(structure.sheaves, structure.runs, state.r) + stored_in_ties(structure.ties, state.r)
        stored += stored_in_saddles(structure.saddles, state.r)
        for k in range(contacts.size):
            if contacts[k].state == ON:
                stored += stored_beside(contacts, k, state.r.shape[0])
                if contacts[k].travel == FREE and contacts[k].spring > 0.0:
                    stored += pressed_energy(contacts, k, state.s[k])
    (lost, rubbed), blown = add_internal_forces(structure, buffers, state.r, since), 0.0
    state.work[LAGGED] += rubbed
    add_contact_forces(structure, buffers, contacts, state, table, out)
    distribute_forces(structure.surfaces, buffers.force)
    add_surface_forces(structure.surfaces, state.r, buffers.force)
    if lie_on(structure.saddles):
        add_saddle_forces(structure.saddles, state.r, buffers.force)
    if tie_up(structure.ties):
        add_tie_forces(structure.ties, state.r, buffers.force)
    if exist(structure.sheaves):
        lost += add_sheave_forces(structure.sheaves, structure.runs, buffers, state.r, since)
    if since > 0.0 and (is_damped(structure.surfaces) or are_damped(structure.ties)):
        guess(structure, buffers, state.v, dt)
        lost += damp_surfaces(structure.surfaces, state.r, buffers.guess, buffers.force)
        lost += damp_ties(structure.ties, buffers.guess, buffers.force)
    if windy:
        blown = add_wind_forces(structure, buffers, state.r, state.v, state.t[0], dt)
    return lost, blown, stored


@inlined
def _kick_nodes(structure, buffers, state, h, dragged):
    """Kick all nodes that no restraint moves; returns what drag takes, J."""
    nodes, v, lost = structure.nodes, state.v, 0.0
    for a in range(v.shape[0]):
        w, F, light = v[a], buffers.force[a], nodes.light
        if not dragged:
            for i in range(w.size):
                w[i] += h * light[i] * F[i]
            continue
        for i in range(w.size):
            x = 0.5 * h * nodes.drag[i]
            new = ((1.0 - x) * w[i] + h * light[i] * F[i]) / (1.0 + x)
            mean = 0.5 * (new + w[i])
            if light[i] > 0.0:
                lost += nodes.drag[i] * nodes.mass[i] * mean * mean
                w[i] = new
    return h * lost


@inlined
def _kick_restraints(structure, buffers, state, h, dt, A, b):
    """Kick what is held: (M + h/2 C + dt^2/4 K) dv = h (F - C (v - v')), in the directions that are free."""
    restrained, nodes, r, v, t = structure.restraints, structure.nodes, state.r, state.v, state.t[0]
    axes = r.shape[0]
    for e in range(restrained.mass.size):
        first = restrained.node[restrained.first[e]]
        M, drag = restrained.mass[e], 0.0
        for a in range(axes):
            b[a] = restrained.force[e, a]
        for i in range(restrained.first[e], restrained.first[e] + restrained.nodes[e]):
            n = restrained.node[i]
            M += nodes.mass[n]
            drag += nodes.mass[n] * nodes.drag[n]
            for a in range(axes):
                b[a] += buffers.force[a, n]
        moves = restrained.entries[e] > 1
        rank = 0.0
        for a in range(axes):
            rank += restrained.free[e, a, a]
        for a in range(axes):
            buffers.reaction[e, a] = restrained.force[e, a] - b[a]
        if restrained.winch[e, LIMIT] > 0.0:
            kick_winch(restrained, v, buffers.reaction, buffers.tight, state.work, e, b, M, drag, h)
            continue
        if rank == 0.0:
            if moves:  # places half a kick before and after
                for a in range(axes):
                    way = _displaced(restrained, e, a, t + 0.5 * h) - _displaced(restrained, e, a, t - 0.5 * h)
                    state.work[MOVED] -= b[a] * way
            continue
        gives = drag != 0.0 or M <= 0.0 or structure.inertia.restrained.shape[0] > 0 or rank < axes
        for a in range(axes):
            for c in range(axes):
                gives = gives or restrained.damping[e, a, c] != 0.0 or restrained.stiffness[e, a, c] != 0.0
        if not gives:  # nothing but inertia
            for a in range(axes):
                change = h * b[a] / M
                buffers.reaction[e, a] += (M - restrained.mass[e]) * change / h
                for i in range(restrained.first[e], restrained.first[e] + restrained.nodes[e]):
                    v[a, restrained.node[i]] += change
            continue
        for a in range(axes):
            F = b[a]
            for c in range(axes):
                rate = (
                    (_displaced(restrained, e, c, t + 0.5 * h) - _displaced(restrained, e, c, t - 0.5 * h)) / h
                    if moves
                    else 0.0
                )
                F -= restrained.damping[e, a, c] * (v[c, first] - rate)
                if restrained.stiffness[e, a, c] != 0.0:
                    F += restrained.stiffness[e, a, c] * (_displaced(restrained, e, c, t) - r[c, first])
            A[a, axes] = h * (F - drag * v[a, first])
        # within the free directions: P A P + (1 - P)
        for a in range(axes):
            b[a] = 0.0
            for c in range(axes):
                b[a] += restrained.free[e, a, c] * A[c, axes]
        for a in range(axes):
            for c in range(axes):
                A[a, c] = 0.5 * h * restrained.damping[e, a, c] + 0.25 * dt * dt * restrained.stiffness[e, a, c]
                A[a, c] += (
                    (M + 0.5 * h * drag) * restrained.free[e, a, c]
                    + (1.0 if a == c else 0.0)
                    - restrained.free[e, a, c]
                )
        if structure.inertia.restrained.shape[0] > 0:
            for a in range(axes):
                for c in range(axes):
                    A[a, c] += structure.inertia.restrained[e, a, c]
        if lie_on(structure.saddles):
            for a in range(axes):
                for c in range(axes):
                    A[a, c] += carried_along(structure.saddles, e, a, c)
        solve_definite(A, b, axes)
        lost = 0.0
        for a in range(axes):
            rate_a, way = v[a, first] + 0.5 * b[a], 0.0
            if moves:
                way = _displaced(restrained, e, a, t + 0.5 * h) - _displaced(restrained, e, a, t - 0.5 * h)
                rate_a -= way / h
            for c in range(axes):
                rate_c = v[c, first] + 0.5 * b[c]
                if moves:
                    rate_c -= (
                        _displaced(restrained, e, c, t + 0.5 * h) - _displaced(restrained, e, c, t - 0.5 * h)
                    ) / h
                    spring = restrained.stiffness[e, a, c] * (_displaced(restrained, e, c, t) - r[c, first])
                    state.work[MOVED] += way * (spring - restrained.damping[e, a, c] * rate_c)
                lost += rate_a * restrained.damping[e, a, c] * rate_c
            lost += drag * (v[a, first] + 0.5 * b[a]) ** 2
        state.work[DAMPED] += h * lost
        for a in range(axes):
            buffers.reaction[e, a] += (M - restrained.mass[e]) * b[a] / h + drag * (v[a, first] + 0.5 * b[a])
            if structure.inertia.restrained.shape[0] > 0:
                for c in range(axes):
                    buffers.reaction[e, a] += structure.inertia.restrained[e, a, c] * b[c] / h
            if lie_on(structure.saddles):
                for c in range(axes):
                    buffers.reaction[e, a] += carried_along(structure.saddles, e, a, c) * b[c] / h
        for i in range(restrained.first[e], restrained.first[e] + restrained.nodes[e]):
            for a in range(axes):
                v[a, restrained.node[i]] += b[a]


@inlined
def _drift(structure, state, h):
    """Move all nodes for the time h; what moves as prescribed comes to its place."""
    r, v, restrained = state.r, state.v, structure.restraints
    for a in range(r.shape[0]):
        x, w = r[a], v[a]
        for i in range(x.size):
            x[i] += h * w[i]
    for e in range(restrained.mass.size):
        rank = 0.0
        for a in range(r.shape[0]):
            rank += restrained.free[e, a, a]
        if restrained.entries[e] > 1 and rank == 0.0:
            for i in range(restrained.first[e], restrained.first[e] + restrained.nodes[e]):
                n = restrained.node[i]
                for a in range(r.shape[0]):
                    place = _displaced(restrained, e, a, state.t[0] + h)
                    v[a, n] += (place - r[a, n]) / h  # which has gone on with v: its speed is that of all of its way
                    r[a, n] = place


@inlined
def _let_go(contacts, bodies):
    """Note loads all of whose contacts have left their lines."""
    for i in range(bodies.gone.size):
        if bodies.gone[i] == STAYS:
            bodies.gone[i] = LEAVES
    for k in range(contacts.size):
        is_away = contacts[k].state == AWAY and contacts[k].been == 1 and contacts[k].led == 0
        if not is_away and contacts[k].state != GONE:
            bodies.gone[contacts[k].load] = STAYS
    for k in range(contacts.size):
        if bodies.gone[contacts[k].load] == LEAVES:
            contacts[k].state = GONE


@lean_inner
def _along(contacts, k, axes):
    """Energy that contact k had stored along its line when it was last looked at, J."""
    along = square = 0.0
    for a in range(axes):
        along += contacts[k].was[a] * contacts[k].along[a]
        square += contacts[k].along[a] ** 2
    return 0.5 * contacts[k].moving * along * along / square + contacts[k].was_axial


@inlined
def _book(structure, contacts, state):
    """Works at all contacts since the last look: of given forces, of what moves contacts along, of friction."""
    axes = state.r.shape[0]
    for k in range(contacts.size):
        if contacts[k].state != ON:
            for a in range(axes):
                contacts[k].before[a] = np.nan
            continue
        for a in range(axes):
            way = contacts[k].place[a] - contacts[k].before[a]
            if np.isfinite(way):
                state.work[LOADED] += 0.5 * (contacts[k].given[a] + contacts[k].last[a]) * way
                if contacts[k].kind != BODY:
                    level = structure.runs.ahead[contacts[k].run, a]
                    state.work[RESTRAINED] += 0.5 * (contacts[k].hold + contacts[k].restrained_by) * level * way
            push = contacts[k].carried * contacts[k].d[a]
            if np.isfinite(way):
                state.work[CARRIED] += 0.5 * (push + contacts[k].lagged[a]) * (contacts[k].d[a] - contacts[k].was[a])
            contacts[k].lagged[a] = push
        if contacts[k].apart == 1 and contacts[k].was_apart == 0:  # what held it along the line snaps back
            state.work[STRUCK] += _along(contacts, k, axes)
        contacts[k].was_apart = contacts[k].apart
        contacts[k].was_axial = stored_along(contacts, k)
        for a in range(axes):
            contacts[k].was[a] = contacts[k].d[a]
        damped = eased(contacts, k)
        if contacts[k].easing > 0.0 and np.isfinite(contacts[k].before[0]):
            longer = contacts[k].axial - contacts[k].axial_booked
            state.work[RUBBED] += 0.5 * (damped + contacts[k].eased) * longer
        contacts[k].axial_booked, contacts[k].eased = contacts[k].axial, damped
        way = state.s[k] - contacts[k].was_at
        if np.isfinite(contacts[k].before[0]) and way != 0.0:
            work = 0.5 * (contacts[k].push + contacts[k].pushed) * way
            if contacts[k].rubs != NOT:
                state.work[RUBBED] -= work
            elif contacts[k].kind != BODY:  # nobody holds a given force: what its contact draws from the line is lost
                state.work[STRUCK] -= work
            elif contacts[k].travel == FREE:
                driven = 0.5 * (contacts[k].drive + contacts[k].driven) * contacts[k].stretch * way
                state.work[DRIVEN] += driven
                state.work[RUBBED] += driven - work
                if contacts[k].spring > 0.0:
                    state.work[RUBBED] -= pressed_energy(contacts, k, state.s[k])
                    state.work[RUBBED] += pressed_energy(contacts, k, contacts[k].was_at)
            else:
                state.work[RESTRAINED] += work
        contacts[k].was_at, contacts[k].pushed = state.s[k], contacts[k].push
        contacts[k].driven, contacts[k].restrained_by = contacts[k].drive, contacts[k].hold
        for a in range(axes):
            contacts[k].before[a], contacts[k].last[a] = contacts[k].place[a], contacts[k].given[a]


@inlined
def _is_refused(contacts, state):
    """Whether a load that was to stay on its line has come to an end of it."""
    found = False
    for k in range(contacts.size):
        is_off = contacts[k].state != ON and np.isfinite(state.s[k])
        found = found or (contacts[k].refuses == 1 and contacts[k].been == 1 and is_off)
    return found


@lean_inner
def _is_finite(r, v):
    total = 0.0
    for a in range(r.shape[0]):
        for i in range(r.shape[1]):
            total += abs(r[a, i]) + abs(v[a, i])
    return np.isfinite(total)


@inlined
def _is_any(values):
    """Whether any is not zero. Kernels that are handed a `False` as it is written are compiled once more for that."""
    found = False
    for i in range(values.size):
        found = found or values[i] != 0.0
    return found


@lean_inner
def advance_by(structure, buffers, contacts, tables, bodies, state, table, out, A, b, method, dt, steps):
    """Move a state by some steps of the length dt in s.

    Args:
        method: its kicks and drifts.
        steps: LOOK: nothing moves, and forces are found at the places of now; SETTLE: the same after contacts have been
            put down, taken up or pressed elsewise, which does work; LOCATE: contacts are located only; GIVEN: as LOOK,
            with coordinates without mass where they are.

    Returns:
        RUNNING, or what went wrong; and, if nothing moves, the energy stored in all runs with their kinks, J.
    """
    (kicks, drifts), lines, runs = method, structure.lines, structure.runs
    windy, dragged = _is_any(structure.wind.direction), _is_any(structure.nodes.drag)
    runs_out, stored, stages = False, 0.0, drifts.size
    begin, since, gone, last = state.t[0], 0.0, 0.0, max(steps, 0) * stages
    yielding = dt if stages == 1 else 0.0  # springs of supports give way within a step of the second order
    for i in range(last + 1):
        step, stage = i // stages, i % stages
        half = 1 if i in (0, last) else 0
        part = kicks[stage] if half == 1 or stage > 0 else kicks[stages] + kicks[0]
        h = part * dt
        lost, blown, stored = _look(
            structure, buffers, contacts, tables, bodies, state, table, out, h, since, windy, steps
        )
        if steps <= LOOK:
            break
        whole = i > 0 and stage == 0
        ends = whole and _is_refused(contacts, state)
        asked = whole and bodies.tethers.size > 0 and gap(lines, runs, contacts, bodies, state) <= 0.0
        too_long = whole and is_too_long(buffers.tight, dt)
        stands = exist(structure.sheaves) and is_at_sheave(structure.sheaves, structure, contacts, state)
        if ends or asked or stands or runs_out or too_long:
            half, h = 1, kicks[stages] * dt
        state.work[DAMPED] += h * lost
        state.work[LOADED] += h * blown
        _book(structure, contacts, state)
        if lie_on(structure.saddles):
            bear_on(structure.saddles, state.v, structure.nodes.drag, structure.nodes.mass, buffers.force)
        if structure.inertia.along.shape[1] > 0:
            state.work[DAMPED] += kick_along(structure, buffers, state, h)
        else:
            state.work[DAMPED] += _kick_nodes(structure, buffers, state, h, dragged)
        if lie_on(structure.saddles):
            state.work[RUBBED] += rub_on_saddles(
                structure.saddles, structure.inertia, structure.nodes.light, state.r, state.v, buffers.force, h
            )
        _kick_restraints(structure, buffers, state, h, yielding, A, b)
        if lie_on(structure.saddles):
            go_along(structure.saddles, state.v)
        note_kick(buffers.tight, h)
        if bodies.mass.size > 0:
            kick(structure, contacts, bodies, state, h, half)
        if i < last and not (asked or stands or runs_out or too_long):
            since = drifts[stage] * dt
            gone = (gone if stage > 0 else 0.0) + drifts[stage]
            state.work[DRIVEN] += grow(contacts, bodies, state, since)
            _drift(structure, state, since)
            lead(contacts, tables, bodies, state, since)
            drift(bodies, state, since)
            state.work[DRIVEN] += hoist(bodies, contacts, state, since)
            state.t[0] = begin + (step + (gone if stage < stages - 1 else 1.0)) * dt
            if exist(structure.sheaves):
                mass, inertia = structure.nodes.mass, structure.inertia
                runs_out = not pass_nodes(structure.sheaves, lines, runs, mass, inertia, state.r, state.v, state.work)
        if stage == 0 and step % 64 == 0 and not _is_finite(state.r, state.v):
            return NOT_FINITE, stored
        if ends:
            return AT_END, stored
        if runs_out:
            return LINE_OUT, stored
        if stands:
            return AT_SHEAVE, stored
        if asked:
            return ASKED, stored
        if too_long:
            return TOO_LONG, stored
    if steps == SETTLE:
        _book(structure, contacts, state)
    return (RUNNING if _is_finite(state.r, state.v) else NOT_FINITE), stored
