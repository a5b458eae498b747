"""Cable runs: links with their axial laws, bending and an elastic foundation, from one potential.

    V = sum h W(l/h - 1) + sum 1/2 EI/h^3 (|D|^2 + |D' - D|^2 / 6) + sum 1/2 bed h (z - level)^2,
    l^2 = |r(i+1) - r(i)|^2 + (|D(i)|^2 + |D(i+1)|^2 + c |D(i+1) - D(i)|^2) / 24 + 2 K,
    D(i) = r(i-1) - 2 r(i) + r(i+1).

A link is an arc, longer than its chord by what a circle through its neighbours is: waves across a run are right to the
fourth order of the mesh, for tension as for bending; c stiffens the shortest ones. Squares of lengths are added and not
lengths, so that a link has a direction of its force, T/l times its chord, also where it is slack and folded up. What
contacts add to the links under them, K, comes from `contacts.py`. All forces are gradients of V, but for Kelvin-Voigt
damping and wind.

Linearised about rest, V is the second-order expansion of this: with u from rest and g u the first-order change of
l^2/2, a link pulls by T/l of rest at the places of now, and by the change of T/l with g u at the places of rest. Second
differences and what they bend are linear as they are; l is the length at rest, and kinks lengthen nothing.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import inlined, lean_inner
from ropewalk.mechanics.moving_contact import look_up
from ropewalk.system.elements.compliance import ARC, SHORT_ARC, SMOOTH
from ropewalk.system.elements.hysteresis import let_off, stored_in_hysteresis
from ropewalk.system.elements.inertia import hold_back
from ropewalk.system.elements.segments import bed_at, stiffness_at, stiffness_within, vary
from ropewalk.system.elements.sheaves import add_wind_over, exist


@lean_inner
def _alike(structure, s):
    """Last of the runs from s on whose nodes follow each other and whose links are alike: one loop goes through all.

    A loop for each costs as much as tens of nodes before its vectors begin and after they end; runs may have few.
    """
    runs = structure.runs
    alone = exist(structure.sheaves) or vary(structure.segments)  # those divide the links between runs
    while s + 1 < runs.first.size and not alone:
        alike = runs.first[s + 1] == runs.first[s] + runs.links[s] + 1 and runs.h[s + 1] == runs.h[s]
        alike = alike and runs.arcs[s + 1] == runs.arcs[s] and runs.bending[s + 1] == runs.bending[s]
        for i in range(runs.law.shape[1]):
            alike = alike and runs.law[s + 1, i] == runs.law[s, i]
        if not alike:
            break
        s += 1
    return s


@lean_inner
def _bend(x, bent, begin, n):
    """Second differences of one component between the first and the last node."""
    a, d = x[begin : begin + n + 1], bent[begin : begin + n + 1]
    for i in range(1, n):
        d[i] = (a[i + 1] - a[i]) - (a[i] - a[i - 1])


@lean_inner
def _stretch(x, y, z, bx, by, bz, length, begin, n, arcs):
    """Lengths of all links, arcs included, by places of nodes and their second differences."""
    a, c = x[begin : begin + n + 1], z[begin : begin + n + 1]
    p, q = bx[begin : begin + n + 1], bz[begin : begin + n + 1]
    c0 = length[begin : begin + n]
    if y is not None:
        b, o = y[begin : begin + n + 1], by[begin : begin + n + 1]
    arc, short = 2.0 * arcs * ARC, 2.0 * arcs * SHORT_ARC
    for i in range(n):
        dx, dz, turn_x, turn_z = a[i + 1] - a[i], c[i + 1] - c[i], p[i + 1] - p[i], q[i + 1] - q[i]
        chord, bent = dx * dx + dz * dz, p[i] * p[i] + p[i + 1] * p[i + 1] + q[i] * q[i] + q[i + 1] * q[i + 1]
        change = turn_x * turn_x + turn_z * turn_z
        if y is not None:
            dy, turn_y = b[i + 1] - b[i], o[i + 1] - o[i]
            chord += dy * dy
            bent += o[i] * o[i] + o[i + 1] * o[i + 1]
            change += turn_y * turn_y
        c0[i] = np.sqrt(chord + arc * bent + short * change)


@lean_inner
def _stretch_little(structure, buffers, r):
    """Strains of all links, whose second differences are known, to the first order about rest."""
    runs, links, rest, bent = structure.runs, structure.about.links, structure.about.shape[0], structure.about.shape[1]
    for s in range(runs.first.size):
        arc, short = 2.0 * runs.arcs[s] * ARC, 2.0 * runs.arcs[s] * SHORT_ARC
        for i in range(runs.first[s], runs.first[s] + runs.links[s]):
            change = 0.0
            for a in range(r.shape[0]):
                chord = rest[a, i + 1] - rest[a, i]
                change += chord * ((r[a, i + 1] - r[a, i]) - chord)
                d, e = bent[a, i], bent[a, i + 1]
                one, two = buffers.bent[a, i] - d, buffers.bent[a, i + 1] - e
                change += arc * (d * one + e * two) + short * (e - d) * (two - one)
            buffers.length[i], buffers.pull[i] = links[i].length, links[i].pull
            buffers.strain[i] = links[i].strain + change / (links[i].length * runs.h[s])


@inlined
def stretch_all(structure, buffers, r):
    """Lengths of all links without kinks, of what is linearised their strains; second differences of the nodes."""
    runs, last, bent, s = structure.runs, r.shape[0] - 1, buffers.bent, 0
    while s < runs.first.size:
        end = _alike(structure, s)
        begin = runs.first[s]
        n = runs.first[end] + runs.links[end] - begin
        for a in range(last + 1):
            _bend(r[a], bent[a], begin, n)
            for j in range(s, end + 1):
                i, k = runs.first[j], runs.first[j] + runs.links[j]
                bent[a, i] = 2.0 * (r[a, i + 1] - r[a, i] - runs.turned[j, 0, a]) if runs.clamped[j, 0] == 1 else 0.0
                bent[a, k] = 2.0 * (r[a, k - 1] - r[a, k] - runs.turned[j, 1, a]) if runs.clamped[j, 1] == 1 else 0.0
        if structure.about.links.size == 0:
            if last == 1:
                _stretch(r[0], None, r[1], bent[0], None, bent[1], buffers.length, begin, n, runs.arcs[s])
            else:
                _stretch(r[0], r[1], r[2], bent[0], bent[1], bent[2], buffers.length, begin, n, runs.arcs[s])
            for j in range(s, end):  # what is between two runs is no link
                buffers.length[runs.first[j + 1] - 1] = 0.0
        s = end + 1
    if structure.about.links.size > 0:
        _stretch_little(structure, buffers, r)


@lean_inner
def find_strains(structure, buffers):
    """Strains of all links, whose lengths are known."""
    runs = structure.runs
    if structure.about.links.size == 0:
        for s in range(runs.first.size):
            _strains(buffers.length, buffers.strain, runs.first[s], runs.links[s], runs.h[s])


@lean_inner
def _strains(length, strain, begin, n, h):
    e, L, inverse = strain[begin : begin + n], length[begin : begin + n], 1.0 / h
    for i in range(n):
        e[i] = L[i] * inverse - 1.0


@lean_inner
def _pull_at_once(p, length, pull, begin, n, h):
    """Tension over length of a cubic law in one go."""
    L, q, inverse = length[begin : begin + n], pull[begin : begin + n], 1.0 / h
    floor, c1, c2, c3 = p[1], p[2], p[3], p[4]
    for i in range(n):
        x = max(L[i] * inverse - 1.0, floor)
        q[i] = x * (c1 + x * (c2 + x * c3)) / max(L[i], 1e-300)


@lean_inner
def _tensions(p, strain, tension, begin, n):
    e, T = strain[begin : begin + n], tension[begin : begin + n]
    if p[0] == law.CUBIC:
        floor, c1, c2, c3 = p[1], p[2], p[3], p[4]
        for i in range(n):
            x = max(e[i], floor)
            T[i] = x * (c1 + x * (c2 + x * c3))
        return
    if p[0] == law.RIGID:  # its tension keeps its length, see `constraints.py`
        return
    for i in range(n):
        T[i] = law.tension(p, e[i])


@lean_inner
def _add_drag(c, h, strain, before, rate, tension, begin, n, dt):
    """Add Kelvin-Voigt tension c de/dt; returns the power it takes, W."""
    e, o, u, T = (
        strain[begin : begin + n], before[begin : begin + n], rate[begin : begin + n], tension[begin : begin + n],
    )  # fmt: skip
    lost = 0.0
    for i in range(n):
        if dt > 0.0:
            u[i] = (e[i] - o[i]) / dt
            o[i] = e[i]
        T[i] += c * u[i]
        lost += u[i] * u[i]
    return c * h * lost


@lean_inner
def _over_length(tension, length, pull, begin, n):
    """Tension over length."""
    T, L, q = tension[begin : begin + n], length[begin : begin + n], pull[begin : begin + n]
    for i in range(n):
        q[i] = T[i] / max(L[i], 1e-300)


@lean_inner
def _moments(bent, moment, pull, begin, n, stiff, arcs):
    """Moments at inner nodes over the length of a link, of one component."""
    d, q, m = bent[begin : begin + n + 1], pull[begin : begin + n], moment[begin : begin + n + 1]
    arc, short, smooth = 2.0 * arcs * ARC, 2.0 * arcs * SHORT_ARC, stiff * SMOOTH
    for i in range(1, n):
        m[i] = (
            (stiff + arc * (q[i - 1] + q[i])) * d[i]
            + (smooth + short * q[i - 1]) * (d[i] - d[i - 1])
            + (smooth + short * q[i]) * (d[i] - d[i + 1])
        )


@lean_inner
def _moments_along(segments, bent, moment, pull, begin, n, stiff, arcs):
    """The same of a run that may have segments; `stiff` is that of the value 1 there."""
    if segments is None or segments.rho.size == 0:
        _moments(bent, moment, pull, begin, n, stiff, arcs)
        return
    d, q, m = bent[begin : begin + n + 1], pull[begin : begin + n], moment[begin : begin + n + 1]
    own, within = segments.bending[begin : begin + n + 1], segments.smooth[begin : begin + n]
    arc, short, smooth = 2.0 * arcs * ARC, 2.0 * arcs * SHORT_ARC, stiff * SMOOTH
    for i in range(1, n):
        m[i] = (
            (stiff * own[i] + arc * (q[i - 1] + q[i])) * d[i]
            + (smooth * within[i - 1] + short * q[i - 1]) * (d[i] - d[i - 1])
            + (smooth * within[i] + short * q[i]) * (d[i] - d[i + 1])
        )


@lean_inner
def _pull(x, force, moment, pull, begin, n):
    """Add the forces of links and of moments, which are nothing at ends, to one component."""
    a, f = x[begin : begin + n + 1], force[begin : begin + n + 1]
    q, m = pull[begin : begin + n], moment[begin : begin + n + 1]
    f[0] += q[0] * (a[1] - a[0]) - m[1]
    f[n] -= q[n - 1] * (a[n] - a[n - 1]) + m[n - 1]
    for i in range(1, n):
        f[i] += (q[i] * (a[i + 1] - a[i]) - q[i - 1] * (a[i] - a[i - 1])) - (m[i - 1] - 2.0 * m[i] + m[i + 1])


@lean_inner
def _turn_ends(force, bent, pull, begin, n, stiff, other, arcs, clamp0, clamp1):
    """Add what holds the direction of a run at its ends, stiff as is given, to one component of the forces."""
    f, d, q = force[begin : begin + n + 1], bent[begin : begin + n + 1], pull[begin : begin + n]
    arc, short = 2.0 * arcs * ARC, 2.0 * arcs * SHORT_ARC
    if clamp0 == 1:
        end = 2.0 * ((0.5 * stiff + arc * q[0]) * d[0] + (stiff * SMOOTH + short * q[0]) * (d[0] - d[1]))
        f[0] += end
        f[1] -= end
    if clamp1 == 1:
        end = 2.0 * ((0.5 * other + arc * q[n - 1]) * d[n] + (other * SMOOTH + short * q[n - 1]) * (d[n] - d[n - 1]))
        f[n] += end
        f[n - 1] -= end


@lean_inner
def _tensions_little(links, buffers, begin, n):
    """Tensions to the first order about rest."""
    for i in range(begin, begin + n):
        buffers.tension[i] = links[i].tension + links[i].slope * (buffers.strain[i] - links[i].strain)


@lean_inner
def _changes(links, buffers, begin, n, h):
    """By how much tension over length has changed since rest, to the first order: to `room.change`."""
    for i in range(begin, begin + n):
        longer = h * (buffers.strain[i] - links[i].strain)
        buffers.change[i] = (buffers.tension[i] - links[i].tension - links[i].pull * longer) / links[i].length


@inlined
def add_internal_forces(structure, buffers, r, dt):
    """Add the forces of all runs, whose lengths are known, to `room.force`.

    Args:
        dt: s, since strains were looked at before; 0: nothing has moved since, and strains and tensions of all
            links are found, too, which hardly anybody asks for between outputs.

    Returns:
        Power that Kelvin-Voigt damping takes, W, and what hysteresis has lost since strains were looked at before, J.
    """
    runs, about, last, lost, rubbed, s = structure.runs, structure.about, r.shape[0] - 1, 0.0, 0.0, 0
    small = about.links.size > 0
    while s < runs.first.size:
        end = _alike(structure, s)
        begin, h = runs.first[s], runs.h[s]
        n = runs.first[end] + runs.links[end] - begin
        at_once = dt != 0.0 and not small and runs.law[s, 0] == law.CUBIC
        for j in range(s, end + 1):
            at_once = at_once and runs.damping[j] == 0.0 and runs.hysteresis[j, 0] == 0.0
        if small:
            for j in range(s, end + 1):
                if runs.law[j, 0] != law.RIGID:
                    _tensions_little(about.links, buffers, runs.first[j], runs.links[j])
        elif at_once:
            _pull_at_once(runs.law[s], buffers.length, buffers.pull, begin, n, h)
        else:
            _strains(buffers.length, buffers.strain, begin, n, h)
            _tensions(runs.law[s], buffers.strain, buffers.tension, begin, n)
        for j in range(s, end + 1):
            if runs.hysteresis[j, 0] > 0.0:
                rubbed += let_off(runs.hysteresis[j], h, buffers.strain, buffers.lag, buffers.tension, runs.first[j],
                                  runs.links[j], dt)  # fmt: skip
            if runs.damping[j] > 0.0:
                lost += _add_drag(runs.damping[j], h, buffers.strain, buffers.before, buffers.rate, buffers.tension,
                                runs.first[j],
                                runs.links[j], dt)  # fmt: skip
            if small:
                _changes(about.links, buffers, runs.first[j], runs.links[j], h)
        if not (small or at_once):
            _over_length(buffers.tension, buffers.length, buffers.pull, begin, n)
        x, bent, pull, stiff = r, buffers.bent, buffers.pull, 1.0 / (h * h * h)
        if not vary(structure.segments):
            stiff = runs.bending[s] / (h * h * h)
        for again in range(2 if small else 1):
            if again == 1:  # by what changes, links pull at the places of rest
                x, bent, pull, stiff = about.shape[0], about.shape[1], buffers.change, 0.0
            for j in range(s, end):  # what is between two runs is no link
                i = runs.first[j + 1] - 1
                buffers.strain[i] = buffers.tension[i] = pull[i] = 0.0
            for a in range(last + 1):
                _moments_along(structure.segments, bent[a], buffers.moment, pull, begin, n, stiff, runs.arcs[s])
                for j in range(s, end + 1):
                    buffers.moment[runs.first[j]] = buffers.moment[runs.first[j] + runs.links[j]] = 0.0
                _pull(x[a], buffers.force[a], buffers.moment, pull, begin, n)
                for j in range(s, end + 1):
                    if runs.clamped[j, 0] == 1 or runs.clamped[j, 1] == 1:
                        one, other = stiff, stiff
                        if vary(structure.segments):
                            one *= stiffness_at(structure.segments, runs, j, runs.first[j])
                            other *= stiffness_at(structure.segments, runs, j, runs.first[j] + runs.links[j])
                        _turn_ends(buffers.force[a], bent[a], pull, runs.first[j], runs.links[j], one, other,
                                   runs.arcs[s], runs.clamped[j, 0], runs.clamped[j, 1])  # fmt: skip
        for j in range(s, end + 1):
            if runs.bed[j] > 0.0 or vary(structure.segments):
                for i in range(runs.first[j], runs.first[j] + runs.links[j] + 1):
                    part = 0.5 if i in (runs.first[j], runs.first[j] + runs.links[j]) else 1.0
                    k = part * h * bed_at(structure.segments, runs, j, i)
                    buffers.force[last, i] -= k * (r[last, i] - structure.nodes.level[i])
        s = end + 1
    return lost, rubbed


@lean_inner
def _stored_little(structure, buffers, r, i, s):
    """Energy of a link of run s to the second order about rest, J."""
    rest, bent, link, h = (
        structure.about.shape[0],
        structure.about.shape[1],
        structure.about.links[i],
        structure.runs.h[s],
    )
    longer, square = buffers.strain[i] - link.strain, 0.0
    for a in range(r.shape[0]):
        chord = (r[a, i + 1] - r[a, i]) - (rest[a, i + 1] - rest[a, i])
        d, e = buffers.bent[a, i] - bent[a, i], buffers.bent[a, i + 1] - bent[a, i + 1]
        square += 0.5 * chord * chord + structure.runs.arcs[s] * (ARC * (d * d + e * e) + SHORT_ARC * (e - d) ** 2)
    stored = h * (law.stored(structure.runs.law[s], link.strain) + link.tension * longer)
    stored += 0.5 * h * link.slope * longer * longer
    return stored + link.pull * (square - 0.5 * (h * longer) ** 2)


@lean_inner
def energy_of(structure, buffers, r):
    """Energy stored in all runs, whose strains are known with kinks, J; `room.bent` holds second differences."""
    runs, last, total = structure.runs, r.shape[0] - 1, 0.0
    for s in range(runs.first.size):
        begin, n, h = runs.first[s], runs.links[s], runs.h[s]
        for i in range(begin, begin + n):
            if structure.about.links.size > 0:
                total += _stored_little(structure, buffers, r, i, s)
            else:
                total += h * law.stored(runs.law[s], buffers.strain[i])
            if runs.hysteresis[s, 0] > 0.0:
                total += h * stored_in_hysteresis(runs.hysteresis[s], buffers.strain[i], buffers.lag[0, i])
        if runs.bending[s] > 0.0:
            stiff, segments = 0.5 / h**3, structure.segments
            for a in range(last + 1):
                for i in range(begin, begin + n):
                    one, other = stiffness_at(segments, runs, s, i), stiffness_at(segments, runs, s, i + 1)
                    within = stiffness_within(segments, runs, s, i)
                    d, e = buffers.bent[a, i], buffers.bent[a, i + 1]
                    total += stiff * (0.5 * (one * d * d + other * e * e) + SMOOTH * within * (e - d) ** 2)
        if runs.bed[s] > 0.0 or vary(structure.segments):
            for i in range(begin, begin + n + 1):
                part = 0.25 if i in (begin, begin + n) else 0.5
                k = part * h * bed_at(structure.segments, runs, s, i)
                total += k * (r[last, i] - structure.nodes.level[i]) ** 2
    return total


@lean_inner
def add_wind_forces(structure, buffers, r, v, t, h):
    """Add the forces of the wind at the velocities in the middle of a kick of the length h; returns their power, W."""
    axes, light, power = r.shape[0], structure.nodes.light, 0.0
    for a in range(axes):
        for i in range(r.shape[1]):
            buffers.guess[a, i] = v[a, i]
    for again in range(2):
        for a in range(axes):
            for i in range(r.shape[1]):
                buffers.air[a, i] = 0.0
        power = _push(structure, r, buffers.guess, t, buffers.air)
        if again == 0:
            for a in range(axes):
                for i in range(r.shape[1]):
                    buffers.guess[a, i] = v[a, i] + 0.5 * h * light[i] * (buffers.force[a, i] + buffers.air[a, i])
            if structure.inertia.along.shape[1] > 0:
                hold_back(structure, buffers.guess, v)
            _guess_restrained(structure, buffers, h)
    for a in range(axes):
        for i in range(r.shape[1]):
            buffers.force[a, i] += buffers.air[a, i]
    return power


@lean_inner
def guess(structure, buffers, v, h):
    """Guess the velocities in the middle of a kick of the length h by the forces that are known, to `room.guess`."""
    for a in range(v.shape[0]):
        for i in range(v.shape[1]):
            buffers.air[a, i] = 0.0
            buffers.guess[a, i] = v[a, i] + 0.5 * h * structure.nodes.light[i] * buffers.force[a, i]
    _guess_restrained(structure, buffers, h)


@lean_inner
def _guess_restrained(structure, buffers, h):
    """Guess how fast what is held is in the middle of a kick."""
    restrained, nodes, axes = structure.restraints, structure.nodes, buffers.force.shape[0]
    for e in range(restrained.mass.size):
        mine = restrained.node[restrained.first[e] : restrained.first[e] + restrained.nodes[e]]
        for a in range(axes):
            M, gained = restrained.mass[e], 0.0
            for n in mine:
                M += nodes.mass[n]
            if M == 0.0:  # a sheave that stands fast
                continue
            for c in range(axes):
                F = restrained.force[e, c]
                for n in mine:
                    F += buffers.force[c, n] + buffers.air[c, n]
                gained += 0.5 * h * restrained.free[e, a, c] * F / M
            for n in mine:
                buffers.guess[a, n] += gained


@inlined
def _share(v, air, end, way, F, shift):
    """Let the nodes beside an end bear some of the load F on its link; returns what that adds to its power, W."""
    air[end] -= (shift[0] + shift[1]) * F
    air[end + way] += shift[0] * F
    air[end + 2 * way] += shift[1] * F
    return F * (shift[0] * (v[end + way] - v[end]) + shift[1] * (v[end + 2 * way] - v[end]))


@lean_inner
def _push(structure, r, v, t, air):
    """Add the forces of the wind, half of each link's to each of its nodes; returns their power, W."""
    runs, wind, axes, power = structure.runs, structure.wind, r.shape[0], 0.0
    speed = look_up(wind.time, wind.speed, 0, wind.time.size, t)
    for s in range(runs.first.size):
        if runs.width[s] == 0.0:
            continue
        last = runs.first[s] + runs.links[s] - 1
        for i in range(runs.first[s], last + 1):
            along = square = length = 0.0
            for a in range(axes):
                length += (r[a, i + 1] - r[a, i]) ** 2
            length = np.sqrt(length)
            for a in range(axes):
                u = speed * wind.direction[a] - 0.5 * (v[a, i] + v[a, i + 1])
                along += u * (r[a, i + 1] - r[a, i]) / length
                square += u * u
            k = 0.25 * wind.density * runs.width[s] * length * np.sqrt(max(square - along * along, 0.0))
            for a in range(axes):
                u = speed * wind.direction[a] - 0.5 * (v[a, i] + v[a, i + 1])
                F = k * (u - along * (r[a, i + 1] - r[a, i]) / length)
                air[a, i] += F
                air[a, i + 1] += F
                power += F * (v[a, i] + v[a, i + 1])
                if i == runs.first[s] and runs.links[s] > 1:
                    power += _share(v[a], air[a], i, 1, 2.0 * F, runs.shift[s, 0])
                if i == last and runs.links[s] > 1:
                    power += _share(v[a], air[a], i + 1, -1, 2.0 * F, runs.shift[s, 1])
    return power + add_wind_over(structure.sheaves, runs, wind, r, v, speed, air)
