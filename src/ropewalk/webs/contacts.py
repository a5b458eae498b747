"""Contacts in motion: the stiff little pieces around them, solved together and implicitly.

The parts of a divided link are as stiff as they are short. All nodes next to contacts therefore move by the
implicit midpoint rule as far as these pieces are concerned, and by explicit kicks otherwise (Stern and Grinspun,
Multiscale Model. Simul. 7, 1779, 2009). A contact has no mass of its own: it is where its forces balance. With z the
place at the middle of the step,

    f(z) = 4 m / h^2 (z - x - h v / 2)  for nodes,      f(z) + F - rho U^2 [r'] = 0  for contacts,

where F is the given force or that of a stiff spring to the mass that travels, and rho U^2 [r'] the momentum that a
line hands over where a contact passes along it at the speed U. The particle that it passes gets U [r'] in return, see
`pass_node`.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.compiled import inlined, lean, lean_inner
from ropewalk.webs.geometry import distance
from ropewalk.webs.pull import link_stiffness, pull_links
from ropewalk.webs.seats import corner, energy_of_pieces, held_place
from ropewalk.webs.web import FORCE, MASS, OFF

MOST_ITERATIONS = 100
# Changes of places at which they count as found, over the size of the pieces; and which are enough where threads that
# go slack and taut by turns keep Newton's method from getting closer.
SETTLED, ENOUGH = 1e-11, 1e-5
# Held components of nodes on rails move as if they had this much more mass.
HEAVY = 1e9


@inlined
def pressed(web, room, k, z, a):
    """Component a of the force of contact k on its line or net: the given one, or that of the spring to its mass, N."""
    if web.seats.kind[k] == FORCE:
        return web.seats.load[k, a]
    return room.grip[k] * (room.q[k, a] - held_place(web, z, k, a))


@lean_inner
def _press(web, room, k, z):
    """Add the force of contact k to the right side, and its stiffness."""
    seats = web.seats
    if seats.kind[k] == FORCE:
        for a in range(3):
            room.b[3 * room.row[web.nodes + k] + a] += seats.load[k, a]
        return
    for c in range(3):
        i = _held_row(web, room, k, c)
        if i < 0:
            continue
        for a in range(3):
            room.b[3 * i + a] += seats.hold[k, c] * pressed(web, room, k, z, a)
        for d in range(3):
            j = _held_row(web, room, k, d)
            if j >= 0:
                for a in range(3):
                    room.J[3 * i + a, 3 * j + a] += room.grip[k] * seats.hold[k, c] * seats.hold[k, d]


@lean_inner
def _held_row(web, room, k, c):
    """Row of contact k (0) or of a node of its link; -1: none."""
    if c == 0:
        return room.row[web.nodes + k]
    return room.row[corner(web, web.seats.divided[k], c - 1)]


@lean_inner
def _collect(web, room, still):
    """List the nodes that are solved for: contacts, and unless `still` the nodes of their pieces that may move."""
    links, seats = web.links, web.seats
    count = 0
    for k in range(seats.kind.size):
        if seats.kind[k] != OFF:
            room.node[count] = web.nodes + k
            room.row[web.nodes + k] = count
            count += 1
    if still:
        return count
    for p in range(web.own_links, links.on.size):
        if links.on[p] == 1:
            count = _add(web, room, links.one[p], count)
            count = _add(web, room, links.other[p], count)
    return count


@lean_inner
def _add(web, room, n, count):
    if room.row[n] < 0 and room.movable[n] > 0:
        room.node[count] = n
        room.row[n] = count
        return count + 1
    return count


@lean_inner
def _forces(web, room, count, z):
    """Forces of the slots on all nodes that they touch, at places z, to room.f; and their stiffness to room.J."""
    links = web.links
    for i in range(3 * count):
        for j in range(3 * count):
            room.J[i, j] = 0.0
    for p in range(web.own_links, links.on.size):
        if links.on[p] == 1:
            for a in range(3):
                room.f[links.one[p], a] = 0.0
                room.f[links.other[p], a] = 0.0
    pull_links(links, web.own_links, links.on.size, z, room.f)
    for p in range(web.own_links, links.on.size):
        if links.on[p] == 1:
            link_stiffness(links, p, z, room.K)
            i, j = room.row[links.one[p]], room.row[links.other[p]]
            for a in range(3):
                for b in range(3):
                    if i >= 0:
                        room.J[3 * i + a, 3 * i + b] += room.K[a, b]
                    if j >= 0:
                        room.J[3 * j + a, 3 * j + b] += room.K[a, b]
                    if i >= 0 and j >= 0:
                        room.J[3 * i + a, 3 * j + b] -= room.K[a, b]
                        room.J[3 * j + a, 3 * i + b] -= room.K[a, b]


@lean
def neighbours(web, k):
    """Slots of links behind and ahead of contact k on a line."""
    links, n = web.links, web.nodes + k
    behind, ahead = -1, -1
    for p in range(web.own_links, links.on.size):
        if links.on[p] == 1:
            if links.other[p] == n:
                behind = p
            if links.one[p] == n:
                ahead = p
    return behind, ahead


@lean_inner
def _flux(web, room, k, i, z):
    """Add what the passing line takes from contact k (row i): force and stiffness; returns nothing."""
    seats, links, n = web.seats, web.links, web.nodes + k
    if seats.speed[k] == 0.0:
        return
    behind, ahead = neighbours(web, k)
    one, two = links.rest[behind], links.rest[ahead]
    q = seats.density[k] * seats.speed[k] * seats.speed[k]
    j, m = links.one[behind], links.other[ahead]
    for a in range(3):
        kink = (z[m, a] - z[n, a]) / two - (z[n, a] - z[j, a]) / one
        room.f[n, a] -= q * kink
        room.drawn[k, a] = -q * kink
        row = 3 * i + a
        room.J[row, row] -= q * (1.0 / one + 1.0 / two)
        if room.row[j] >= 0:
            room.J[row, 3 * room.row[j] + a] += q / one
        if room.row[m] >= 0:
            room.J[row, 3 * room.row[m] + a] += q / two


@lean_inner
def _eliminate(J, b, n):
    """Solve J x = b in place by Gaussian elimination with partial pivoting; False if J is singular."""
    for c in range(n):
        pivot = c
        for i in range(c + 1, n):
            if abs(J[i, c]) > abs(J[pivot, c]):
                pivot = i
        if J[pivot, c] == 0.0 or not np.isfinite(J[pivot, c]):
            return False
        if pivot != c:
            for j in range(c, n):
                J[c, j], J[pivot, j] = J[pivot, j], J[c, j]
            b[c], b[pivot] = b[pivot], b[c]
        for i in range(c + 1, n):
            factor = J[i, c] / J[c, c]
            if factor != 0.0:
                for j in range(c + 1, n):
                    J[i, j] -= factor * J[c, j]
                b[i] -= factor * b[c]
    for c in range(n - 1, -1, -1):
        total = b[c]
        for j in range(c + 1, n):
            total -= J[c, j] * b[j]
        b[c] = total / J[c, c]
    return True


@lean_inner
def solve(web, state, room, h, still):
    """Find the middles z of a step of length h of all nodes next to contacts (`still`: of contacts without mass alone).

    Returns:
        Number of nodes; negative: no solution was found. room.z holds the middles, room.f the forces of slots there.
    """
    seats, body, r, v, z = web.seats, web.body, state.r, state.v, room.z
    for k in range(seats.kind.size):
        room.grip[k] = seats.grip[k]
        if seats.kind[k] == MASS and not still:  # the mass moves by the midpoint rule, too
            room.grip[k] /= 1.0 + 0.25 * h * h * seats.grip[k] / seats.mass[k]
        for a in range(3):
            room.q[k, a] = state.q[k, a] + (0.0 if still else 0.5 * h * state.u[k, a])
    count = _collect(web, room, still)
    size = 0.0
    for p in range(web.own_links, web.links.on.size):
        if web.links.on[p] == 1:
            size = max(size, web.links.rest[p])
            one, other, far = web.links.one[p], web.links.other[p], 0.0 if still else 0.5 * h
            for a in range(3):  # nodes that are not solved for stand, or move as prescribed
                z[one, a], z[other, a] = r[one, a] + far * v[one, a], r[other, a] + far * v[other, a]
    for i in range(count):
        n = room.node[i]
        for a in range(3):
            z[n, a] = r[n, a] + (0.0 if still else 0.5 * h * v[n, a])
    found = count == 0
    best, shift, merit, stiffest = np.inf, 0.0, 0.0, 0.0
    if still and count > 0:
        merit = _merit(web, room, z)
    for _ in range(MOST_ITERATIONS):
        if found:
            break
        _forces(web, room, count, z)
        for i in range(count):
            n, k = room.node[i], room.node[i] - web.nodes
            if k >= 0:
                _flux(web, room, k, i, z)
            for a in range(3):
                row = 3 * i + a
                room.b[row] = room.f[n, a]
                if k < 0:
                    m = 4.0 * body.mass[n] / (h * h)
                    room.b[row] -= m * (z[n, a] - r[n, a] - 0.5 * h * v[n, a])
                    room.J[row, row] += m
        for k in range(seats.kind.size):
            if seats.kind[k] != OFF:
                _press(web, room, k, z)
        for i in range(count):
            n = room.node[i]
            for a in range(3):
                row = 3 * i + a
                stiffest = max(stiffest, abs(room.J[row, row]))
            rail = room.movable[n] - 2
            if rail >= 0:
                _hold_on_rail(web.held.along[rail], room, i, HEAVY * stiffest)
        if stiffest == 0.0:  # everything around contacts is slack: they go where they are pushed until it is taut
            for i in range(3 * count):
                stiffest = max(stiffest, abs(room.b[i]) / size)
            if stiffest == 0.0:
                stiffest = 1.0
        for i in range(3 * count):
            room.J[i, i] += (1e-13 + shift) * stiffest
            room.pull[i] = room.b[i]
        if not _eliminate(room.J, room.b, 3 * count):  # all threads around a contact are slack
            shift = max(1e-3, 4.0 * shift)
            if not shift < 1e9:
                break
            continue
        largest = 0.0
        for i in range(3 * count):
            largest = max(largest, abs(room.b[i]))
        if not np.isfinite(largest):
            break
        cut = min(1.0, 0.3 * size / max(largest, 1e-300))
        downhill = 0.0
        for i in range(count):
            for a in range(3):
                z[room.node[i], a] += cut * room.b[3 * i + a]
                downhill += room.pull[3 * i + a] * room.b[3 * i + a]
        if still and largest > 1e-7 * size:  # of several places where forces balance, that of least energy nearby
            tried = _merit(web, room, z)
            if downhill < 0.0 or tried > merit:
                for i in range(count):
                    for a in range(3):
                        z[room.node[i], a] -= cut * room.b[3 * i + a]
                shift = max(1e-3, 4.0 * shift)
                if shift > 1e9:
                    break
                continue
            merit, shift = tried, (0.25 * shift if shift > 1e-3 else 0.0)
        # The last step is one that rounding alone makes.
        if (shift == 0.0 and largest < SETTLED * size) or (largest < 1e-7 * size and largest >= 0.5 * best):
            found = True
        best = min(best, largest)
    found = found or best < ENOUGH * size
    if found and count > 0:
        _forces(web, room, count, z)
        for k in range(seats.kind.size):
            if seats.kind[k] != OFF and room.row[web.nodes + k] >= 0:
                _flux(web, room, k, room.row[web.nodes + k], z)
    for i in range(count):
        room.row[room.node[i]] = -1
    return count if found else -1


@lean_inner
def _merit(web, room, z):
    """Potential energy of the slots, the loads on their contacts, and what passing lines take from these, J."""
    links, seats = web.links, web.seats
    total = energy_of_pieces(web, web.own_links, z)
    for k in range(seats.kind.size):
        if seats.kind[k] == OFF:
            continue
        for a in range(3):
            if seats.kind[k] == FORCE:
                total -= seats.load[k, a] * z[web.nodes + k, a]
            else:
                gap = room.q[k, a] - held_place(web, z, k, a)
                total += 0.5 * seats.grip[k] * gap * gap
        if seats.speed[k] != 0.0:
            behind, ahead = neighbours(web, k)
            q = 0.5 * seats.density[k] * seats.speed[k] * seats.speed[k]
            for p in (behind, ahead):
                length = distance(z, links.one[p], links.other[p])
                total -= q * length * length / links.rest[p]
    return total


@lean_inner
def _hold_on_rail(along, room, i, stiff):
    """Leave the node of row i the direction of its rail only."""
    push = 0.0
    for a in range(3):
        push += along[a] * room.b[3 * i + a]
    for a in range(3):
        room.b[3 * i + a] = push * along[a]
        for b in range(3):
            room.J[3 * i + a, 3 * i + b] += stiff * ((1.0 if a == b else 0.0) - along[a] * along[b])


@lean_inner
def pass_node(web, state, room, k):
    """Give the particle that contact k has come to the momentum that it has drawn since it passed the last one.

    Of a kink that moves evenly this is the jump of velocity |U| [r'] of what it passes.

    Returns:
        Kinetic energy lost, J.
    """
    seats, links = web.seats, web.links
    behind, ahead = neighbours(web, k)
    j = links.other[ahead] if seats.speed[k] > 0.0 else links.one[behind]
    m, M = web.body.mass[j] if j < web.nodes else 0.0, seats.mass[k]
    lost = 0.0
    if j < web.nodes and room.movable[j] > 0:
        rail, along = room.movable[j] - 2, 0.0
        for a in range(3):
            lost += 0.5 * m * state.v[j, a] ** 2
            gain = room.owed[k, a] / m
            if seats.kind[k] == MASS:
                u, slope = state.u[k, a], room.slope[k, a]
                new = (m * state.v[j, a] + M * u + room.owed[k, a] - M * seats.speed[k] * slope) / (m + M)
                gain = new - state.v[j, a]
                push = new + seats.speed[k] * slope - u
                lost -= M * push * (u + 0.5 * push)
                state.u[k, a] += push
                state.pushed[k, a] -= M * push
            state.v[j, a] += gain
        for a in range(3):
            along += web.held.along[rail, a] * state.v[j, a] if rail >= 0 else 0.0
        for a in range(3):
            if rail >= 0:
                state.v[j, a] = along * web.held.along[rail, a]
            lost -= 0.5 * m * state.v[j, a] ** 2
    for a in range(3):
        room.owed[k, a] = 0.0
    return lost
