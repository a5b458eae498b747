"""Travel: where contacts are along their lines, as prescribed or as the forces on them demand.

A contact has no inertia along its line: what touches has it. As `push` is the change of all energy with s,

    push = stretch (P - R sign U - viscous stretch U)     or    |push - stretch P| <= stretch R   and   U = 0,

with the drive P and the friction R on what travels freely; an implicit step of it is stable at any length. A prescribed
travel is given in one of four measures: s, the length of the line up to there, x, or s times how the line is stretched;
of lines that are linearised, as they are at rest.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import ARC, HORIZONTAL, MATERIAL, SLIP
from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.mechanics.moving_contact import look_up, look_up_integral
from ropewalk.system.contact.brakes import eddy, is_braked, pressed
from ropewalk.system.contact.contact_record import AWAY, BODY, DRAGGED, FREE, GONE, NOT, ON, STANDS
from ropewalk.system.contact.contacts import bend_one, goes_on, sit, slope_at_rest, stiffen, yields
from ropewalk.system.contact.friction import friction_demand
from ropewalk.system.contact.yielding import eased, firmness_along, has_hold, stiffness_along, stored_along, turned
from ropewalk.system.elements.spline import WIDTH
from ropewalk.system.elements.structure import RESTRAINED, STRUCK

# Rounds in which a place is found, the part of a link to which it is, and the most that it moves in a round.
ROUNDS, CLOSE, FAR = 60, 1e-12, 0.5
# Stiffness that keeps a free contact where its body is while its line is slack, over the largest one of a step.
SLACK = 1e-9
# Parts of a link over which what holds a body without friction is averaged.
KNOTS = 16.0


@inlined
def give(tables, contacts, k, t, axes):
    """Note the given force on contact k at time t."""
    for a in range(axes):
        contacts[k].given[a] = look_up(
            tables.force_time, tables.force_value[a], contacts[k].force_first, contacts[k].force_count, t
        )
        contacts[k].given[a] += contacts[k].hauled[a]


@inlined
def travelled(tables, contacts, k, t):
    """What contact k has travelled since time zero as its speed is measured, m."""
    return look_up_integral(
        tables.speed_time, tables.speed_value, tables.speed_path, contacts[k].speed_first, contacts[k].speed_count, t
    )


@inlined
def locate(structure, buffers, contacts, tables, state, table, out, since):
    """Put all contacts where they are along their lines now.

    Args:
        since: s, since that was done before; 0: nothing has moved.
    """
    lines, t = structure.lines, state.t[0]
    _measure_lines(structure, buffers, contacts)
    for k in range(contacts.size):
        give(tables, contacts, k, t, state.r.shape[0])
        was, length = contacts[k].state, lines.length[contacts[k].line]
        if was == GONE or (contacts[k].led == 1 and was == AWAY):
            continue
        if contacts[k].travel == FREE:
            contacts[k].drive = look_up(
                tables.drive_time, tables.drive_value, contacts[k].drive_first, contacts[k].drive_count, t
            )
        speed = look_up(tables.speed_time, tables.speed_value, contacts[k].speed_first, contacts[k].speed_count, t)
        old, contacts[k].measured = state.s[k], speed
        if since > 0.0:
            contacts[k].axial_before, contacts[k].slips = contacts[k].axial, 0.0
        flies = contacts[k].apart == 1 and was == ON
        if flies:
            contacts[k].flown += since
        if flies and contacts[k].clear == 0:
            s = _below(structure, contacts, state, k, old)
            if since > 0.0:
                contacts[k].speed = (s - old) / since
            if contacts[k].measure != SLIP:  # it goes on from where it lands
                landed = _measured(structure, buffers, contacts, state, k, s)
                contacts[k].begin = landed - travelled(tables, contacts, k, t)
        elif contacts[k].travel == FREE:
            s = old
            if since > 0.0 and was == ON:
                s = _slide(structure, buffers, contacts, state, table, out, k, speed, since)
                contacts[k].speed = (s - old) / since
            elif since == 0.0 and contacts[k].been == 0:
                s = contacts[k].begin
        else:
            s = _prescribed(structure, buffers, contacts, tables, state, table, out, k, speed, since)
        U = contacts[k].speed
        low = contacts[k].margin if U < 0.0 else 0.0
        high = length - (contacts[k].margin if U > 0.0 else 0.0)
        if contacts[k].stays == 1 and (s > high or (s < low and contacts[k].been == 1)):
            end = high if s > high else low
            if contacts[k].been == 1 and contacts[k].restrained == 0:
                contacts[k].stopped, contacts[k].overrun = U, s - end
            contacts[k].restrained, contacts[k].speed, s = 1, 0.0, end
        elif since > 0.0:  # else it is where it was, and still stopped
            contacts[k].restrained = 0
        state.s[k] = s
        contacts[k].state = ON if low <= s <= high else AWAY
        if contacts[k].state == AWAY:
            if was == ON:
                contacts[k].comes = -1
                _straighten(structure, contacts, state, k)
            continue
        contacts[k].been = 1
        if was == AWAY:
            contacts[k].comes = 1
        sit(structure, contacts, state, k, s)
        if contacts[k].kind == BODY and has_hold(contacts, k):
            if contacts[k].apart == 1 or was != ON:
                contacts[k].hold = contacts[k].evened = 0.0
            elif since > 0.0:
                _even_out(structure, buffers, contacts, state, table, out, k, since)
        if contacts[k].slips > 0.0 and since > 0.0:
            stiffen(structure, buffers, contacts, state, table, out, k)
            contacts[k].hauls = firmness_along(contacts, k) * contacts[k].axial + eased(contacts, k)
        if contacts[k].travel == FREE or contacts[k].restrained == 1:
            square = 0.0
            for a in range(state.r.shape[0]):
                square += contacts[k].along[a] ** 2
            slides = contacts[k].travel == FREE and contacts[k].stretch > 0.0
            contacts[k].measured = contacts[k].speed * (contacts[k].stretch if slides else np.sqrt(square))


@lean_inner
def _even_out(structure, buffers, contacts, state, table, out, k, since):
    """Put the body of contact k where it takes no more to move the contact along its line than it rubs.

    It moves level, as the force does that holds it, which is noted. One that stands lets go of that where friction
    bears what is left.
    """
    axes, first, s, gone, rate = state.r.shape[0], contacts[k].first, state.s[k], 0.0, 0.0
    h, level = structure.runs.h[contacts[k].run], structure.runs.ahead[contacts[k].run]
    slack, sign = _least_stiffness(structure, contacts, k), 0.0
    if contacts[k].rubs == DRAGGED:
        sign = -1.0 if contacts[k].measured >= 0.0 else 1.0
    if contacts[k].rubs == STANDS:
        gone = -contacts[k].hold * contacts[k].light * since * since
        for a in range(axes):
            state.u[first + a] += gone * level[a]
    for _ in range(ROUNDS):
        push, R, stretch, _ = _resistance(structure, buffers, contacts, state, table, out, k, s, since)
        if contacts[k].rubs == STANDS and sign == 0.0:
            if abs(push) <= R * stretch:
                break
            sign = 1.0 if push > 0.0 else -1.0
        push -= sign * R * stretch
        slope = 0.0
        for a in range(axes):
            slope += (stiffness_along(contacts, k) + contacts[k].easing + slack) * contacts[k].along[a] * level[a]
        step = min(max(push / slope, -FAR * h), FAR * h) if slope != 0.0 else 0.0
        gone += step
        for a in range(axes):
            state.u[first + a] += step * level[a]
        if abs(step) <= CLOSE * h:
            break
    contacts[k].slips = 1.0 if contacts[k].easing > 0.0 and sign != 0.0 else 0.0
    change = gone / since
    for a in range(axes):
        state.w[first + a] += change * level[a]
        rate += state.w[first + a] * level[a]
    state.work[RESTRAINED] += change / contacts[k].light * (rate - 0.5 * change)
    found = change / (contacts[k].light * since)
    if contacts[k].rubs != NOT:  # the next step begins with it
        contacts[k].hold += found
        return
    # Of the passage of some knots of the table: at each the body is moved by microns, and stopped a step later.
    part = min(KNOTS * abs(contacts[k].speed) * since / h, 1.0) if contacts[k].speed != 0.0 else 1.0
    contacts[k].evened += part * (found - contacts[k].evened)


@inlined
def _straighten(structure, contacts, state, k):
    """Let the kink of contact k, which has left, go as if the contact, or a wave, went on over a quarter of a link.

    A kink that went at once would push its links together. Of what is linearised kinks lengthen none, and it is lost.
    """
    if structure.about.links.size > 0:
        for a in range(state.r.shape[0]):
            state.work[STRUCK] += 0.5 * contacts[k].firm * contacts[k].d[a] ** 2
    run = contacts[k].run
    state.work[STRUCK] += stored_along(contacts, k)
    waves = np.sqrt(max(contacts[k].tension, 0.0) / max(structure.runs.rho[run], 1e-300))
    speed = max(abs(contacts[k].speed), waves)
    contacts[k].fade = 4.0 * contacts[k].kink * speed / structure.runs.h[run]
    if structure.runs.law[run, 0] == law.RIGID:  # over two links: these cannot give way, and would push
        contacts[k].fade = 0.5 * contacts[k].kink * waves / structure.runs.h[run]


@inlined
def fade(buffers, contacts, since):
    """Let the kinks of contacts that have left straighten for a time in s; returns what their links lose by it, J."""
    lost = 0.0
    for k in range(contacts.size):
        if contacts[k].state == ON or contacts[k].kink == 0.0:
            continue
        less = min(contacts[k].fade * since, contacts[k].kink)
        contacts[k].kink -= less
        for j in range(3):
            lost += buffers.pull[contacts[k].link[j]] * contacts[k].part[j] * less
    return lost


@lean_inner
def place(structure, buffers, contacts, tables, state):
    """Put contacts, which have not moved yet, where they stand at the time of the state."""
    _measure_lines(structure, buffers, contacts)
    for k in range(contacts.size):
        give(tables, contacts, k, state.t[0], state.r.shape[0])
        s = contacts[k].begin
        if contacts[k].travel != FREE:
            s += travelled(tables, contacts, k, state.t[0])
            if contacts[k].measure != MATERIAL:
                s = _find(structure, buffers, contacts, state, k, s)
        state.s[k] = s
        contacts[k].state = ON if 0.0 <= s <= structure.lines.length[contacts[k].line] else AWAY
        if contacts[k].state == ON:
            sit(structure, contacts, state, k, s)


@inlined
def _measure_lines(structure, buffers, contacts):
    """Lengths of all lines up to each of their nodes, to `room.path`, if any contact measures them."""
    lines, runs, measured = structure.lines, structure.runs, False
    for k in range(contacts.size):
        measured = measured or contacts[k].measure in (SLIP, ARC)
    if not measured:
        return
    for line in range(lines.first.size):
        gone, last = 0.0, lines.first[line] + lines.runs[line] - 1
        for s in range(lines.first[line], last + 1):
            begin = runs.first[s]
            buffers.path[begin] = gone
            for i in range(begin, begin + runs.links[s]):
                gone += buffers.length[i]
                buffers.path[i + 1] = gone
            if s < last and not goes_on(lines, runs, s):
                gone += buffers.length[begin + runs.links[s]]


@lean_inner
def _measured(structure, buffers, contacts, state, k, s):
    """Put contact k at s of its line, and look up its place as its speed is measured; m.

    Notes how the line is stretched as it is measured.
    """
    sit(structure, contacts, state, k, s)
    if contacts[k].measure == HORIZONTAL and structure.about.links.size > 0:
        x = 0.0
        for j in range(min(WIDTH, structure.runs.links[contacts[k].run] + 1)):
            x += contacts[k].weight[j] * structure.about.shape[0, 0, contacts[k].near + j]
        contacts[k].stretch = slope_at_rest(structure, contacts, k, 0)
        return x
    if contacts[k].measure == HORIZONTAL:
        contacts[k].stretch = contacts[k].along[0]
        return contacts[k].p[0]
    if contacts[k].measure == MATERIAL:
        contacts[k].stretch = 1.0
        return s
    run, base, value, slope = contacts[k].run, contacts[k].near, 0.0, 0.0
    for j in range(min(WIDTH, structure.runs.links[run] + 1)):
        value += contacts[k].weight[j] * buffers.path[base + j]
        slope += contacts[k].slope[j] * buffers.path[base + j]
    contacts[k].stretch = slope / structure.runs.h[run]
    return value


@lean_inner
def _find(structure, buffers, contacts, state, k, wanted):
    """Find s of contact k, where its place as measured is as wanted; beyond the ends, the ground is not stretched."""
    length = structure.lines.length[contacts[k].line]
    first = _measured(structure, buffers, contacts, state, k, 0.0)
    last = _measured(structure, buffers, contacts, state, k, length)
    sign = 1.0 if last > first else -1.0
    if sign * (wanted - first) < 0.0:
        return -abs(wanted - first)
    if sign * (wanted - last) > 0.0:
        return length + abs(wanted - last)
    s, low, high = state.s[k], 0.0, length
    if not low <= s <= high:
        s = 0.5 * length
    for _ in range(ROUNDS):
        miss = sign * (_measured(structure, buffers, contacts, state, k, s) - wanted)
        if miss > 0.0:
            high = s
        else:
            low = s
        slope = sign * contacts[k].stretch
        new = s - miss / slope if slope > 0.0 else -1.0
        if not low <= new <= high:
            new = 0.5 * (low + high)
        step, s = abs(new - s), new
        if step <= CLOSE * length:
            break
    return s


@lean_inner
def _find_load(structure, buffers, contacts, state, table, out, k, wanted):
    """The same, where it is measured at what touches, which is level with its point or leans with its line."""
    s = _find(structure, buffers, contacts, state, k, wanted)
    known = contacts[k].kind != BODY or contacts[k].state == ON  # where it is
    if contacts[k].measure != HORIZONTAL or not known or contacts[k].axial_stiffness == 0.0:
        return s
    lean, length = 0.0, structure.lines.length[contacts[k].line]
    for _ in range(ROUNDS):
        if not 0.0 <= s <= length:
            break
        sit(structure, contacts, state, k, s)
        bend_one(structure, buffers, contacts, state, table, out, k)
        before, lean = lean, contacts[k].d[0]
        if contacts[k].kind != BODY:  # a body has its own place along its line
            lean += contacts[k].axial * contacts[k].tangent[0]
        if abs(lean - before) <= CLOSE * length:
            break
        s = _find(structure, buffers, contacts, state, k, wanted - lean)
    return s


@lean_inner
def _prescribed(structure, buffers, contacts, tables, state, table, out, k, speed, since):
    """Place of contact k at time t as its travel prescribes; notes its speed along the line."""
    t, old = state.t[0], state.s[k]
    wanted = contacts[k].begin + travelled(tables, contacts, k, t)
    if contacts[k].measure == MATERIAL:
        contacts[k].speed = speed
        return wanted
    if contacts[k].measure == SLIP and (contacts[k].been == 1 or since > 0.0):
        way = travelled(tables, contacts, k, t) - travelled(tables, contacts, k, t - since)
        stretch, before = 1.0, contacts[k].stretch
        if contacts[k].state == ON:
            stretch = 0.0
            for j in range(3):
                q = contacts[k].part[j]
                stretch += (
                    q
                    * np.sqrt(buffers.length[contacts[k].link[j]] ** 2 + 2.0 * q * contacts[k].kink)
                    / contacts[k].h[j]
                )
        contacts[k].speed = speed / stretch
        if since > 0.0:  # as stretched as in the middle of the step, from the two instants before
            contacts[k].stretch = stretch
            return old + way * (1.5 / stretch - 0.5 / before if before > 0.0 else 1.0 / stretch)
        return old
    s = _find_load(structure, buffers, contacts, state, table, out, k, wanted)
    stretch = contacts[k].stretch if 0.0 <= s <= structure.lines.length[contacts[k].line] else 1.0
    if since > 0.0:
        contacts[k].speed = (s - old) / since
    elif contacts[k].been == 0:
        contacts[k].speed = speed / stretch
    contacts[k].stretch = 0.0
    return s


@lean_inner
def _below(structure, contacts, state, k, s):
    """Place s on the line of contact k that is next to its body, from the one where it was."""
    length, h = structure.lines.length[contacts[k].line], structure.runs.h[contacts[k].run]
    for _ in range(ROUNDS):
        sit(structure, contacts, state, k, s)
        ahead = square = 0.0
        for a in range(state.r.shape[0]):
            ahead += (state.u[contacts[k].first + a] - contacts[k].p[a]) * contacts[k].along[a]
            square += contacts[k].along[a] ** 2
        new = s + min(max(ahead / square, -FAR * h), FAR * h)
        if new < 0.0 or new > length:  # beyond the ends, and not pulled back
            return new
        step, s = abs(new - s), new
        if step <= CLOSE * h:
            break
    return s


@lean_inner
def _least_stiffness(structure, contacts, k):
    """Stiffness that keeps contact k where its body is while its line is slack, N/m."""
    return SLACK / max(0.5 * contacts[k].step ** 2 * (yields(structure, contacts, k) + contacts[k].light), 1e-300)


@lean_inner
def _resistance(structure, buffers, contacts, state, table, out, k, s, since):
    """Put contact k at s of its line, where it comes after a time in s.

    Returns:
        `push` there, N, the friction R, N, the stretch of the line, and by how much dampers stiffen `push`, N/m.
    """
    sit(structure, contacts, state, k, s)
    stiffen(structure, buffers, contacts, state, table, out, k)
    run, h = contacts[k].run, structure.runs.h[contacts[k].run]
    T, stretch, along, square = 0.0, 0.0, 0.0, 0.0
    push, tangent, damper = 0.0, 0.0, 0.0
    tight = contacts[k].moving / contacts[k].by_tension  # of inextensible links: what it differs by is of a step ago
    for j in range(3):
        link, q = contacts[k].link[j], contacts[k].part[j]
        if q <= 0.0 and contacts[k].change[j] == 0.0:
            continue
        kinks = q * contacts[k].kink + contacts[k].beside[j]
        length = np.sqrt(buffers.length[link] ** 2 + 2.0 * kinks)
        stretch += q * length / contacts[k].h[j]  # not of the spline, which cuts the corner
        own = tight
        if structure.runs.law[run, 0] != law.RIGID:
            own = law.tension(structure.runs.law[run], length / contacts[k].h[j] - 1.0)
        T += q * own
        lengthens = contacts[k].change[j] / h * contacts[k].kink / max(length, 1e-300)
        push += lengthens * own
        if structure.runs.damping[run] > 0.0 and lengthens != 0.0:
            # As the link is damped where it is sought: with the rate of the step before, a kink whose damper
            # stiffens it more than its contact does is thrown back and forth, further at each step.
            c = structure.runs.damping[run] / since
            push += lengthens * c * (length / contacts[k].h[j] - 1.0 - buffers.before[link])
            damper += c * lengthens**2 / contacts[k].h[j]
    slack, axes = _least_stiffness(structure, contacts, k), state.r.shape[0]
    push += turned(contacts, k, axes)
    damped = eased(contacts, k)
    for a in range(axes):
        ahead = contacts[k].axial * contacts[k].tangent[a]
        N = contacts[k].moving * contacts[k].d[a] + contacts[k].axial_stiffness * ahead
        N += damped * contacts[k].tangent[a]
        push -= (N + slack * (contacts[k].d[a] + ahead)) * contacts[k].along[a]
        tangent += contacts[k].along[a] ** 2
        along += N * contacts[k].along[a]
        square += N * N
    contacts[k].stretch = stretch
    normal = np.sqrt(max(square - along * along / tangent, 0.0))
    half = 0.0 if structure.runs.firm[run] > 0.0 else np.pi / 2  # a net does not bend around a contact
    whole = 2.0 * (T + structure.runs.bending[run] / (h * h))
    if normal < whole:
        half = np.arcsin(normal / whole)
    R = (friction_demand(contacts[k].friction, contacts[k].block, half) + contacts[k].rolling) * normal
    if is_braked(contacts, k, s) and contacts[k].braking == 0.0:
        R += contacts[k].brake
    push += contacts[k].spring * pressed(contacts, k, s)
    return push, R, stretch, damper


@lean_inner
def _slide(structure, buffers, contacts, state, table, out, k, speed, since):
    """Find the place s of contact k, which travels freely, after a time; notes its speed and its drive.

    Args:
        speed: that its driver wants to hold, m/s along the line.
        since: s.
    """
    h, old, P = structure.runs.h[contacts[k].run], state.s[k], contacts[k].drive
    length, viscous, driver = structure.lines.length[contacts[k].line], contacts[k].viscous, contacts[k].driver
    push, R, stretch, damper = _resistance(structure, buffers, contacts, state, table, out, k, old, since)
    if driver > 0.0:
        wanted = min(max(old + since * speed / stretch, 0.0), length)
        needed, own, there, _ = _resistance(structure, buffers, contacts, state, table, out, k, wanted, since)
        U = (wanted - old) / since
        needed = needed / there + own * np.sign(U) + viscous * there * U + eddy(contacts, k, wanted, there * U)[0]
        if abs(needed - P) <= driver:
            contacts[k].drive = needed
            return wanted
        P += driver if needed > P else -driver
        contacts[k].drive = P
    miss = push - P * stretch
    if abs(miss) <= R * stretch and R > 0.0:
        return old
    sign = -1.0 if miss > 0.0 else 1.0
    low, high, s = (old, np.inf, old) if sign > 0.0 else (-np.inf, old, old)
    miss += sign * R * stretch
    for _ in range(ROUNDS):
        if miss > 0.0:
            high = min(high, s)
        else:
            low = max(low, s)
        growing = viscous + eddy(contacts, k, s, stretch * (s - old) / since)[1]
        slope = (stiffness_along(contacts, k) + contacts[k].easing) * stretch**2 + growing * stretch**2 / since + damper
        slope += _least_stiffness(structure, contacts, k) + contacts[k].spring
        new = min(max(s - miss / slope, s - FAR * h), s + FAR * h)
        if not low <= new <= high:
            new = 0.5 * (low + high)
        step, s = abs(new - s), new
        if step <= CLOSE * h or s < 0.0 or s > length:
            break
        push, R, stretch, damper = _resistance(structure, buffers, contacts, state, table, out, k, s, since)
        miss = push - P * stretch + sign * R * stretch + viscous * stretch**2 * (s - old) / since
        miss += stretch * eddy(contacts, k, s, stretch * (s - old) / since)[0]
    if contacts[k].easing > 0.0:  # drag holds it by so much for the time of a step
        grows = (viscous + eddy(contacts, k, s, stretch * (s - old) / since)[1]) / since
        contacts[k].slips = 1.0 - grows / (grows + stiffness_along(contacts, k) + contacts[k].easing)
    return s
