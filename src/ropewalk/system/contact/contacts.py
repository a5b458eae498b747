"""Contacts: where loads touch their lines. One scheme, without events, for whatever touches and whatever line.

A contact at s has the point p of the spline of its run, and its direction t there. What touches has a place of its own,
p + d + e t. Across the line, d is the tip of the kink that links of finite length round off, held by the stiffness S of
`compliance.py` and lengthening the links below; along it, a line gives way by e as links do that are stretched before
the contact and shortened behind:

    N = S d + S_a e t on the line,   S_a = EA / (h AXIAL),
    K = |d|^2/2 h dS/dT,   V = |d|^2/2 (S - T dS/dT) + S_a e^2/2,   T: mean of h T/l of the links below.

As t turns with the nodes, N bears on them with its moment about p, too. Nets, which have no links below, and lines that
do not stretch or are linearised give way in all directions alike: there d has all of them.

Without a body the force is given and d follows; a body has its own place, N follows, and reaches it in turn. A kink
that is carried along at the speed U feels the tension T - rho U^2. What makes it softer than a kink at rest is a push
of its own, for only the latter has a potential with the links. Linearised, T is that of rest, K = 0, V = |d|^2/2 S.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.system.contact.contact_point import locate_point
from ropewalk.system.contact.contact_record import AWAY, BODY, FREE, ON
from ropewalk.system.contact.sharing import see_others
from ropewalk.system.contact.yielding import (
    across,
    axial_stiffness,
    bent,
    crushed,
    divide,
    eased,
    firmness_along,
    give_way,
    turned,
)
from ropewalk.system.elements.compliance import KINETIC, LEAST, compliance, kinetic, stiffness
from ropewalk.system.elements.profile import height_at
from ropewalk.system.elements.segments import bending_near, mass_near
from ropewalk.system.elements.spline import WIDTH, links_under, share, share_curvature

# Largest square of a speed over that of transverse waves with which a kink is carried along.
FASTEST = 0.9025
# Rounds in which a kink and the tension that it makes find each other, the part of the kink and of the force at the
# contact to which they do, for what it makes of tension grows with EA; and the part of what was missing a round before
# from which on that is rounding.
AGAIN, FOUND, ROUNDED = 40, 1e-9, 0.5
# Kink over h^2 of a given force with which it is sought from none, and beyond which it is not.
BEGIN, MOST = 5e-5, 5e5
# Step of Newton's method, over the kink, whose change of the stiffness its slope tells where nothing bends: what that
# misses is the square of it.
SMALL = 1e-4
TOGETHER = 1e-12  # the same of those that share links, where no last step of Newton's method makes it better


@inlined
def goes_on(lines, runs, run):
    """Whether a line goes on at the end of a run, and not with the link that a sheave divides."""
    return lines.begin[run + 1] - lines.begin[run] < (runs.links[run] + 0.5) * runs.h[run]


@lean_inner
def sit(structure, contacts, state, k, s):
    """Put contact k at s of its line, where that is now."""
    lines, runs, r, line = structure.lines, structure.runs, state.r, contacts[k].line
    run = lines.first[line]
    while run < lines.first[line] + lines.runs[line] - 1 and s >= lines.begin[run + 1]:
        run += 1
    n, h = runs.links[run], runs.h[run]
    x = min(max((s - lines.begin[run]) / h, 0.0), float(n))
    contacts[k].run, contacts[k].x = run, x
    base = runs.first[run] + share(x, n, contacts[k].weight, contacts[k].slope)
    contacts[k].near = base
    before = after = -1
    contacts[k].h[0] = contacts[k].h[1] = contacts[k].h[2] = h
    if run > lines.first[line] and goes_on(lines, runs, run - 1):
        before = runs.first[run - 1] + runs.links[run - 1] - 1
    if run < lines.first[line] + lines.runs[line] - 1 and goes_on(lines, runs, run):
        after = runs.first[run + 1]
    links_under(x, runs.first[run], n, before, after, contacts[k].link, contacts[k].part, contacts[k].change)
    for j in range(3):
        if contacts[k].link[j] < runs.first[run]:
            contacts[k].h[j] = runs.h[run - 1]
        elif contacts[k].link[j] >= runs.first[run] + n:
            contacts[k].h[j] = runs.h[run + 1]
    share_curvature(x, n, base - runs.first[run], contacts[k].second)
    contacts[k].rough = contacts[k].steep = 0.0
    if contacts[k].rolls == 1:
        contacts[k].rough, contacts[k].steep = height_at(lines.profiles, line, s)
    has_body = contacts[k].kind == BODY
    contacts[k].axial_stiffness = axial_stiffness(structure, contacts, k, has_body)
    contacts[k].easing = contacts[k].axial_stiffness if structure.runs.law[run, 0] == law.RIGID else 0.0
    locate_point(structure, contacts, k, r, has_body)


@inlined
def _tension_under(structure, buffers, contacts, k, kink):
    """Mean of h T/l of the links under a contact if a kink is added to them, and its change with that."""
    run, T, slope = contacts[k].run, 0.0, 0.0
    p, h = structure.runs.law[run], structure.runs.h[run]
    for j in range(3):
        q = contacts[k].part[j]
        if q > 0.0:
            if p[0] == law.RIGID:
                T += q * h / contacts[k].h[j] * buffers.tension[contacts[k].link[j]]
                continue
            square = buffers.length[contacts[k].link[j]] ** 2 + 2.0 * (q * kink + contacts[k].beside[j])
            length = np.sqrt(square)
            strain = length / contacts[k].h[j] - 1.0
            own = h * (law.tension(p, strain) - buffers.lag[0, contacts[k].link[j]]) / length
            T += q * own
            slope += q * q * (law.tangent(p, strain) * h / contacts[k].h[j] - own) / square
    return T, slope


@inlined
def soften(structure, contacts, table, out, k, T, again):
    """The same as of `_soften`; on inextensible lines in proportion to T."""
    run = contacts[k].run
    if structure.runs.law[run, 0] != law.RIGID:
        return _soften(structure, contacts, table, out, k, T, again)
    h, U = structure.runs.h[run], contacts[k].speed
    if again == 0:
        compliance(contacts[k].x, structure.runs.links[run], 0.0, table, out)
    kappa = max(out[0], LEAST)
    slope = 1.0 / (h * kappa)
    contacts[k].by_tension, contacts[k].firm, contacts[k].curve = slope, 0.0, 0.0
    contacts[k].turn, contacts[k].carried = slope * T * out[2] / (kappa * h), 0.0
    if U != 0.0 and contacts[k].travel != FREE and T > 0.0:
        moving = min(structure.runs.rho[run] * U * U, FASTEST * T)
        contacts[k].carried = slope * (T - (T - moving) / kinetic(moving / T, KINETIC)[0])
    contacts[k].moving = slope * T - contacts[k].carried
    return slope


@inlined
def _soften(structure, contacts, table, out, k, T, again):
    """Stiffness of contact k under the tension T, at rest and carried along.

    Args:
        again: more than 0: the contact is where `out` was found for it.

    Returns:
        dS/dT of the kink that is carried along.
    """
    run = contacts[k].run
    if structure.runs.firm[run] > 0.0:
        return _stay_firm(structure, contacts, k)
    h, n, U = structure.runs.h[run], structure.runs.links[run], contacts[k].speed
    if contacts[k].travel == FREE:  # its speed knows of every link that it passes
        U = 0.0
    bending = bending_near(structure.segments, structure.runs, run, contacts[k].x) / (h * h)
    free = contacts[k].least
    if contacts[k].kind == BODY:
        free += 0.5 * contacts[k].step ** 2 * (yields(structure, contacts, k) + contacts[k].light)
    whole = T + bending
    S, slope, taken, contacts[k].curve = stiffness(whole, bending, h, n, 1.0, contacts[k].x, free, again, table, out)
    contacts[k].by_tension, contacts[k].firm = slope, S - T * slope
    contacts[k].turn = S * taken * out[2] / (max(out[0], LEAST) * h)
    contacts[k].moving, contacts[k].carried = S, 0.0
    if U == 0.0 or whole <= 0.0:
        return slope
    moving = min(mass_near(structure.segments, structure.runs, run, contacts[k].x) * U * U, FASTEST * whole)
    less = max(T - moving, min(T, 0.0)) if bending > 0.0 else T - moving
    factor, change = kinetic(moving / whole, KINETIC)
    contacts[k].moving, slope, taken, _ = stiffness(
        less + bending, bending, h, n, factor, contacts[k].x, free, 1, table, out
    )
    contacts[k].carried = S - contacts[k].moving
    if bending == 0.0 and moving < FASTEST * whole:
        slope += contacts[k].moving / factor * change * moving / (whole * whole)
    return slope


@lean_inner
def _stay_firm(structure, contacts, k):
    """Stiffness of contact k on a net, whose patch below bears it without a kink; returns dS/dT."""
    free = 1.0 / structure.runs.firm[contacts[k].run] + contacts[k].least
    if contacts[k].kind == BODY:
        free += 0.5 * contacts[k].step ** 2 * (yields(structure, contacts, k) + contacts[k].light)
    contacts[k].moving = contacts[k].firm = 1.0 / free
    contacts[k].carried = contacts[k].by_tension = contacts[k].curve = contacts[k].turn = 0.0
    return 0.0


@lean_inner
def find_kink(structure, buffers, contacts, table, out, k, square, F):
    """Find the kink of contact k, and its stiffness under the tension that the kink makes, by Newton's method.

    Args:
        square: m^2, of d.
        F: N, a given force, which d follows: |d| = F / S; 0: it is as long as given.

    Returns:
        Changes of the stiffness with the tension, and of the tension with the kink; the square of d.
    """
    run, h = contacts[k].run, structure.runs.h[contacts[k].run]
    low, high, slope, change, step, before = 0.0, np.inf, 0.0, 0.0, 0.0, np.inf
    see_others(contacts, k, ON)
    compliance(contacts[k].x, structure.runs.links[run], 0.0, table, out)
    bends = bending_near(structure.segments, structure.runs, run, contacts[k].x) > 0.0
    _begin_with(contacts, k, square, F, h, out[0])
    for _ in range(AGAIN):
        K = contacts[k].kink
        T, change = _tension_under(structure, buffers, contacts, k, K)
        slope = soften(structure, contacts, table, out, k, T, 1)
        S, first, falls = contacts[k].moving, contacts[k].by_tension, -contacts[k].curve
        if F > 0.0:
            square = (F / S) ** 2 if S > 0.0 else np.inf
            falls += 2.0 * first * slope / S
        miss = K - 0.5 * square * h * first
        enough = abs(miss * change * slope) <= FOUND * abs(S) or abs(miss) >= ROUNDED * abs(before)
        found = abs(miss) <= FOUND * K and enough
        if found and contacts[k].shares_links == 0:
            break
        if miss > 0.0:
            high = K
        else:
            low = K
        rise = max(1.0 + 0.5 * square * h * falls * change, 1.0)
        if bends and step != 0.0 and 0.5 < (miss - before) / (step * rise) < 2.0:  # how one carried along depends on T
            rise = (miss - before) / step
        new = K - miss / rise
        if F > 0.0 and miss < -K:  # where links are slack, the first steps are wild
            if K / (h * h) > MOST:
                square = 2.0 * K / (h * first)
                break
            new = max(4.0 * K, BEGIN * h * h)
        contacts[k].kink = new if low <= new <= high else 0.5 * (low + high)
        step, before = contacts[k].kink - K, miss
        if abs(step) <= SMALL * K and not bends and S > 0.0 and structure.runs.firm[run] == 0.0:
            contacts[k].moving += slope * change * step
            contacts[k].carried += (first - slope) * change * step
            if F > 0.0:
                square = (F / contacts[k].moving) ** 2
            found = contacts[k].shares_links == 0
        if found:
            break
    return slope, change, square


@inlined
def _begin_with(contacts, k, square, F, h, kappa):
    """Kink with which that of contact k is sought: the last one, for where it is now under the same tension."""
    if contacts[k].kappa > 0.0:
        if F > 0.0:
            contacts[k].kink *= kappa / contacts[k].kappa
        else:
            contacts[k].kink = 0.5 * square * h * contacts[k].by_tension * contacts[k].kappa / max(kappa, LEAST)
    contacts[k].kappa = kappa


@lean_inner
def _stiffen_little(structure, buffers, contacts, table, out, k):
    """Stiffness of contact k under the tension of rest, which changes with s."""
    T, graded = 0.0, 0.0
    for j in range(3):
        T += structure.runs.h[contacts[k].run] * contacts[k].part[j] * buffers.pull[contacts[k].link[j]]
        graded += contacts[k].change[j] * buffers.pull[contacts[k].link[j]]
    _soften(structure, contacts, table, out, k, T, 0)
    contacts[k].firm += T * contacts[k].by_tension
    contacts[k].turn -= graded * contacts[k].by_tension


@lean_inner
def stiffen(structure, buffers, contacts, state, table, out, k):
    """Stiffness and kink of the contact of a body, where the body is now."""
    axes, h = state.r.shape[0], structure.runs.h[contacts[k].run]
    for a in range(axes):
        contacts[k].place[a] = state.u[contacts[k].first + a] + contacts[k].aside[a]
        contacts[k].d[a] = contacts[k].place[a] - contacts[k].p[a]
    contacts[k].apart = 0
    if contacts[k].lift != 0 and contacts[k].lift * _above(contacts, k, axes) > 0.0:
        contacts[k].apart = 1
        for a in range(axes):
            contacts[k].d[a] = 0.0
    divide(contacts, k, axes)
    if structure.about.links.size > 0:
        contacts[k].rise = 0.0
        _stiffen_little(structure, buffers, contacts, table, out, k)
        return
    slope, change, _ = find_kink(structure, buffers, contacts, table, out, k, bent(contacts, k, axes), 0.0)
    contacts[k].rise = slope * change * h * contacts[k].by_tension


@lean_inner
def bend_one(structure, buffers, contacts, state, table, out, k):
    """Find how far contact k is from its spline, with the kinks of others as they are."""
    axes = state.r.shape[0]
    if contacts[k].kind == BODY:
        stiffen(structure, buffers, contacts, state, table, out, k)
        if contacts[k].frictionless == 1 and contacts[k].step > 0.0:  # at rest `Holding` finds it
            _hold(structure, contacts, k, axes)
    elif structure.about.links.size > 0:
        _yield_little(structure, buffers, contacts, k, table, out, axes)
    else:
        _hold(structure, contacts, k, axes)
        F = across(contacts, k, axes)
        length = np.sqrt(find_kink(structure, buffers, contacts, table, out, k, 0.0, F)[2])
        give_way(contacts, k, axes, length / F if F > 0.0 else 0.0)


@lean_inner
def find_kinks(structure, buffers, contacts, state, table, out):
    """Find how far all contacts are from their splines; returns whether some were not found before."""
    for again in range(AGAIN):
        moved = False
        for k in range(contacts.size):
            before = contacts[k].kink
            if contacts[k].state == ON:
                bend_one(structure, buffers, contacts, state, table, out, k)
            if contacts[k].shares_links == 1 and abs(contacts[k].kink - before) > TOGETHER * contacts[k].kink:
                moved = True
        if not moved:
            return again > 0
    return True


@inlined
def bend(structure, buffers, contacts, state, table, out):
    """Find how far all contacts are from their splines, and let the kinks lengthen the links below."""
    find_kinks(structure, buffers, contacts, state, table, out)
    for k in range(contacts.size):
        if structure.about.links.size == 0 and (contacts[k].state == ON or contacts[k].kink > 0.0):
            for j in range(3):
                i = contacts[k].link[j]
                if contacts[k].part[j] > 0.0:
                    buffers.length[i] = np.sqrt(buffers.length[i] ** 2 + 2.0 * contacts[k].part[j] * contacts[k].kink)
                    buffers.strain[i] = buffers.length[i] / contacts[k].h[j] - 1.0


@lean_inner
def _hold(structure, contacts, k, axes):
    """Force of contact k, which is given, on its line; without friction it is held so as not to pull along that."""
    along, ahead, level = 0.0, 0.0, structure.runs.ahead[contacts[k].run]
    for a in range(axes):
        along += contacts[k].given[a] * contacts[k].along[a]
        ahead += level[a] * contacts[k].along[a]
    if contacts[k].frictionless == 1:
        contacts[k].hold = -along / ahead
    for a in range(axes):
        contacts[k].N[a] = contacts[k].given[a] + contacts[k].hold * level[a]


@lean_inner
def _yield_little(structure, buffers, contacts, k, table, out, axes):
    """Let contact k give way under its given force, which is held across the line at rest where it has no friction."""
    _stiffen_little(structure, buffers, contacts, table, out, k)
    level = structure.runs.ahead[contacts[k].run]
    if contacts[k].frictionless == 1:
        along, ahead = 0.0, 0.0
        for a in range(axes):
            slope = slope_at_rest(structure, contacts, k, a)
            along += contacts[k].given[a] * slope
            ahead += level[a] * slope
        contacts[k].hold = -along / ahead
    for a in range(axes):
        contacts[k].N[a] = contacts[k].given[a] + contacts[k].hold * level[a]
    across(contacts, k, axes)
    give_way(contacts, k, axes, 1.0 / contacts[k].moving)


@lean_inner
def slope_at_rest(structure, contacts, k, a):
    """Component a of the derivative of the spline by s at contact k, with the line at rest."""
    slope = 0.0
    for j in range(min(WIDTH, structure.runs.links[contacts[k].run] + 1)):
        slope += contacts[k].slope[j] * structure.about.shape[0, a, contacts[k].near + j]
    return slope / structure.runs.h[contacts[k].run]


@lean_inner
def _above(contacts, k, axes):
    """How far what touches is above its line, across it in its upright plane, m."""
    t, d, z = contacts[k].along, contacts[k].d, axes - 1
    along = square = 0.0
    for a in range(axes):
        along += t[a] * d[a]
        square += t[a] * t[a]
    return d[z] - along / square * t[z]


@inlined
def add_contact_forces(structure, buffers, contacts, state, table, out):
    """Forces of all contacts on their lines, added to those of the nodes; `room.pull` is known."""
    axes, is_little = state.r.shape[0], structure.about.links.size > 0
    for k in range(contacts.size):
        if contacts[k].state == AWAY:
            for a in range(axes):
                contacts[k].N[a] = 0.0
        if contacts[k].state != ON:
            continue
        T, pull, base = 0.0, 0.0, contacts[k].near
        run = contacts[k].run
        most = min(WIDTH, structure.runs.links[run] + 1)
        for j in range(3):
            link = contacts[k].link[j]
            own = buffers.tension[link] if is_little else buffers.pull[link] * buffers.length[link]
            T += contacts[k].part[j] * own
            pull += contacts[k].part[j] * buffers.pull[link]
        contacts[k].tension = T
        if is_little:
            _stiffen_little(structure, buffers, contacts, table, out, k)
        elif contacts[k].kind == BODY:
            soften(structure, contacts, table, out, k, structure.runs.h[run] * pull, 0)
        push = turned(contacts, k, axes)
        hauls = firmness_along(contacts, k) * contacts[k].axial + eased(contacts, k)
        if contacts[k].slips > 0.0:  # lengths were brought back since, by which e has jumped to and fro
            hauls += contacts[k].slips * (contacts[k].hauls - hauls)
        for j in range(3):
            push += contacts[k].change[j] * buffers.pull[contacts[k].link[j]] * contacts[k].kink / structure.runs.h[run]
        moment = (hauls - contacts[k].moving * contacts[k].axial) / (contacts[k].spread * structure.runs.h[run])
        crush = crushed(contacts, k) / structure.runs.h[run]
        for a in range(axes):
            if contacts[k].kind == BODY:
                contacts[k].N[a] = contacts[k].moving * contacts[k].d[a] + hauls * contacts[k].tangent[a]
            push -= contacts[k].N[a] * contacts[k].along[a]
            turns = moment * contacts[k].d[a] + crush * contacts[k].tangent[a]
            for j in range(most):
                buffers.force[a, base + j] += contacts[k].weight[j] * contacts[k].N[a] - contacts[k].slope[j] * turns
        contacts[k].push = push


@lean_inner
def yields(structure, contacts, k):
    """Displacement of the point of contact k by an impulse there, over the impulse and a time, 1/kg."""
    total, base = 0.0, contacts[k].near
    for j in range(min(WIDTH, structure.runs.links[contacts[k].run] + 1)):
        total += contacts[k].weight[j] ** 2 * structure.nodes.mobile[base + j]
    return total
