"""Where contacts stand: the links and cells that they divide, and the slots that stand for these meanwhile."""

from __future__ import annotations

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import inlined, lean, lean_inner
from ropewalk.mechanics.rider import look_up
from ropewalk.webs.fabric import stored as stored_in_cell
from ropewalk.webs.geometry import distance
from ropewalk.webs.web import CELL_SLOTS, FORCE, GONE, LEAVES, LINK_SLOTS, MASS, OFF, ON_LINE, REFUSED, STOPPED

# A contact is taken to be no closer to a node or an edge than this part of its link or cell: it hops over what is left.
# Its mass does not, see `hold_on`.
CLEAR = 1e-3
# Two contacts are taken to be no closer than this part of a link.
TOUCHING = 1e-6


@lean
def place_at(course, k, t):
    """Place of contact k along its line or path at time t in m, and its speed in m/s."""
    first, count = course.first[k], course.knots[k]
    i = first
    while i + 1 < first + count and course.time[i + 1] <= t:
        i += 1
    tau = t - course.time[i]
    if tau < 0.0:
        tau = 0.0
    return (course.place[i] + tau * (course.speed[i] + 0.5 * course.slope[i] * tau),
            course.speed[i] + course.slope[i] * tau)  # fmt: skip


@lean_inner
def _on_link(web, k):
    """Find the link on which contact k stands, walking from where it was."""
    seats, xi = web.seats, web.seats.xi[k]
    first, base, count = seats.first[k], seats.first_station[k], seats.pieces[k]
    p = seats.cell[k] - first
    while p > 0 and xi < seats.station[base + p]:
        p -= 1
    while p < count - 1 and xi >= seats.station[base + p + 1]:
        p += 1
    seats.cell[k] = first + p
    length = seats.station[base + p + 1] - seats.station[base + p]
    part = (xi - seats.station[base + p]) / length
    true, part = part, min(max(part, CLEAR), 1.0 - CLEAR)
    seats.weight[k, 0], seats.weight[k, 1], seats.weight[k, 2] = 1.0 - part, part, 0.0
    seats.beyond[k, 0], seats.beyond[k, 1] = part - true, true - part


@inlined
def weights_in(plan, i, j, k, u, v):
    """Barycentric coordinates of a place in the plan."""
    ax, ay = plan[j, 0] - plan[i, 0], plan[j, 1] - plan[i, 1]
    bx, by = plan[k, 0] - plan[i, 0], plan[k, 1] - plan[i, 1]
    px, py = u - plan[i, 0], v - plan[i, 1]
    area = ax * by - ay * bx
    second, third = (px * by - py * bx) / area, (ax * py - ay * px) / area
    return 1.0 - second - third, second, third


@lean_inner
def _on_cell(web, k):
    """Find the cell on which contact k stands, walking from where it was from edge to edge."""
    seats, course, cells = web.seats, web.course, web.cells
    n = web.nodes + k
    first, count = course.way_first[k], course.way_count[k]
    u = look_up(course.way_mark, course.way_place[:, 0], first, count, seats.xi[k])
    v = look_up(course.way_mark, course.way_place[:, 1], first, count, seats.xi[k])
    e = seats.cell[k]
    for _ in range(seats.pieces[k] + 1):
        w = weights_in(seats.plan, cells.node[e, 0], cells.node[e, 1], cells.node[e, 2], u, v)
        worst = 0
        for c in range(1, 3):
            if w[c] < w[worst]:
                worst = c
        if w[worst] >= -1e-12 or seats.across[e, worst] < 0:
            break
        e = seats.across[e, worst]
    seats.cell[k] = e
    total = 0.0
    for c in range(3):
        seats.weight[k, c] = max(w[c], CLEAR)
        total += seats.weight[k, c]
    for b in range(2):
        seats.plan[n, b] = 0.0
    for c in range(3):
        seats.weight[k, c] /= total
        seats.beyond[k, c] = w[c] - seats.weight[k, c]
        for b in range(2):
            seats.plan[n, b] += seats.weight[k, c] * seats.plan[cells.node[e, c], b]


@lean
def seat(web, t):
    """Find where all contacts are at time t, and the forces on them; returns whether one has changed its seat."""
    seats, course = web.seats, web.course
    changed = False
    for k in range(seats.kind.size):
        xi, speed = place_at(course, k, t)
        kind = seats.wanted[k]
        slack = 1e-9 * course.length[k]
        if xi < course.low[k] - slack or xi > course.high[k] + slack:
            speed = 0.0
            if course.at_end[k] == LEAVES:
                course.at_end[k] = GONE
            elif course.at_end[k] == REFUSED:
                course.at_end[k] = STOPPED
        if course.at_end[k] == GONE:  # for good
            kind = OFF
        seats.xi[k], seats.speed[k] = min(max(xi, course.low[k]), course.high[k]), speed
        size = 0.0
        for a in range(3):
            F = look_up(course.force_time, course.force_value[a], course.force_first[k], course.force_count[k], t)
            seats.load[k, a] = F
            size += abs(F)
        if kind == FORCE and size == 0.0:
            kind = OFF  # a foot in the air
        was, before = seats.cell[k], seats.kind[k]
        seats.kind[k] = kind
        if kind != OFF:
            if seats.on[k] == ON_LINE:
                _on_link(web, k)
            else:
                _on_cell(web, k)
        changed = changed or kind != before or seats.cell[k] != was
    return changed


@lean_inner
def _divide_link(web, k):
    """Put slots between the nodes of a link and all contacts on it; k is the first of them."""
    links, seats = web.links, web.seats
    p = seats.cell[k]
    links.on[p] = 0
    behind, part, slot = links.one[p], 0.0, web.own_links + LINK_SLOTS * k
    following = k
    while following >= 0:
        here = following
        links.one[slot], links.other[slot], links.law[slot], links.on[slot] = behind, web.nodes + here, links.law[p], 1
        links.rest[slot] = max(seats.weight[here, 1] - part, TOUCHING) * links.rest[p]
        behind, part = web.nodes + here, seats.weight[here, 1]
        following = _next_on_link(seats, here)
        slot = web.own_links + LINK_SLOTS * (here if following < 0 else following) + (1 if following < 0 else 0)
    links.one[slot], links.other[slot], links.law[slot], links.on[slot] = behind, links.other[p], links.law[p], 1
    links.rest[slot] = (1.0 - part) * links.rest[p]


@inlined
def _is_before(seats, i, k):
    return seats.weight[i, 1] < seats.weight[k, 1] or (seats.weight[i, 1] == seats.weight[k, 1] and i < k)


@inlined
def _share_link(seats, i, k):
    return i != k and seats.kind[i] != OFF and seats.on[i] == ON_LINE and seats.cell[i] == seats.cell[k]


@lean_inner
def _next_on_link(seats, k):
    """The next contact ahead on the link of contact k, -1 if there is none."""
    found = -1
    for i in range(seats.kind.size):
        if _share_link(seats, i, k) and _is_before(seats, k, i) and (found < 0 or _is_before(seats, i, found)):
            found = i
    return found


@lean_inner
def _is_first(seats, k):
    first = True
    for i in range(seats.kind.size):
        first = first and not (_share_link(seats, i, k) and _is_before(seats, i, k))
    return first


@lean_inner
def _fill_cell(web, slot, i, j, k, fabric):
    """Make a slot the triangle of three nodes with places in the plan."""
    cells, plan = web.cells, web.seats.plan
    cells.node[slot, 0], cells.node[slot, 1], cells.node[slot, 2] = i, j, k
    cells.fabric[slot], cells.on[slot] = fabric, 1
    su, sv = cells.fabrics[fabric, 5], cells.fabrics[fabric, 6]
    ax, ay = su * (plan[j, 0] - plan[i, 0]), sv * (plan[j, 1] - plan[i, 1])
    bx, by = su * (plan[k, 0] - plan[i, 0]), sv * (plan[k, 1] - plan[i, 1])
    area = ax * by - ay * bx
    cells.area[slot] = 0.5 * area
    cells.inverse[slot, 0], cells.inverse[slot, 1] = by / area, -bx / area
    cells.inverse[slot, 2], cells.inverse[slot, 3] = -ay / area, ax / area


@lean_inner
def _divide_cell(web, k):
    """Divide the cell of contact k, or the part of it in which the contact stands, into three."""
    cells, seats = web.cells, web.seats
    n, first = web.nodes + k, web.own_cells + CELL_SLOTS * k
    e = seats.cell[k]
    if cells.on[e] == 0:  # divided already: take the part in which the contact is
        best, inside = -1, -1e300
        for other in range(k):
            if seats.kind[other] == OFF or seats.on[other] == ON_LINE or seats.cell[other] != e:
                continue
            for slot in range(web.own_cells + CELL_SLOTS * other, web.own_cells + CELL_SLOTS * (other + 1)):
                if cells.on[slot] == 1:
                    a, b, c = cells.node[slot, 0], cells.node[slot, 1], cells.node[slot, 2]
                    w = weights_in(seats.plan, a, b, c, seats.plan[n, 0], seats.plan[n, 1])
                    least = min(w[0], min(w[1], w[2]))
                    if least > inside:
                        best, inside = slot, least
        e = best
        a, b, c = cells.node[e, 0], cells.node[e, 1], cells.node[e, 2]
        w = weights_in(seats.plan, a, b, c, seats.plan[n, 0], seats.plan[n, 1])
        w0, w1, w2 = max(w[0], CLEAR), max(w[1], CLEAR), max(w[2], CLEAR)
        for x in range(2):
            seats.plan[n, x] = (w0 * seats.plan[a, x] + w1 * seats.plan[b, x] + w2 * seats.plan[c, x]) / (w0 + w1 + w2)
    cells.on[e] = 0
    a, b, c, fabric = cells.node[e, 0], cells.node[e, 1], cells.node[e, 2], cells.fabric[e]
    _fill_cell(web, first, a, b, n, fabric)
    _fill_cell(web, first + 1, b, c, n, fabric)
    _fill_cell(web, first + 2, c, a, n, fabric)


@lean
def join(web):
    """Switch all slots off, and on again what they stand for."""
    links, cells, seats = web.links, web.cells, web.seats
    for k in range(seats.kind.size):
        for slot in range(web.own_links + LINK_SLOTS * k, web.own_links + LINK_SLOTS * (k + 1)):
            links.on[slot] = 0
        for slot in range(web.own_cells + CELL_SLOTS * k, web.own_cells + CELL_SLOTS * (k + 1)):
            cells.on[slot] = 0
        if seats.divided[k] >= 0:
            if seats.on[k] == ON_LINE:
                links.on[seats.divided[k]] = 1
            else:
                cells.on[seats.divided[k]] = 1
        seats.divided[k] = -1


@lean
def divide(web):
    """Let all contacts divide what they stand on."""
    seats = web.seats
    for k in range(seats.kind.size):
        if seats.kind[k] == OFF:
            continue
        seats.divided[k] = seats.cell[k]
        for c in range(3):
            seats.before[k, c] = seats.weight[k, c]
        if seats.on[k] != ON_LINE:
            _divide_cell(web, k)
        elif _is_first(seats, k):
            _divide_link(web, k)


@lean
def hold_on(web, k):
    """Note what the mass of contact k holds on to: where it should be on the pieces around it."""
    seats = web.seats
    corners = 2 if seats.on[k] == ON_LINE else 3
    own = 1.0
    for c in range(corners):
        own = min(own, 1.0 + seats.beyond[k, c] / seats.weight[k, c])
    seats.hold[k, 0], seats.hold[k, 3] = own, 0.0
    for c in range(corners):
        seats.hold[k, 1 + c] = seats.weight[k, c] * (1.0 - own) + seats.beyond[k, c]


@inlined
def corner(web, k, e, c):
    """Node c of the link or cell e of contact k."""
    if web.seats.on[k] != ON_LINE:
        return web.cells.node[e, c]
    return web.links.one[e] if c == 0 else web.links.other[e]


@lean
def held_place(web, r, k, a):
    """Component a of the place that the mass of contact k holds on to, m."""
    seats = web.seats
    place = seats.hold[k, 0] * r[web.nodes + k, a]
    for c in range(2 if seats.on[k] == ON_LINE else 3):
        place += seats.hold[k, 1 + c] * r[corner(web, k, seats.divided[k], c), a]
    return place


@lean_inner
def energy_of_link(links, p, r):
    """Energy stored in a link, J."""
    strain = distance(r, links.one[p], links.other[p]) / links.rest[p] - 1.0
    return links.rest[p] * law.stored(links.laws[links.law[p]], strain)


@lean_inner
def energy_of_pieces(web, first_link, first_cell, r, F):
    """Energy stored in the links and cells that are on, from a first one of each, J."""
    links, cells = web.links, web.cells
    total = 0.0
    for p in range(first_link, links.on.size):
        if links.on[p] == 1:
            total += energy_of_link(links, p, r)
    for e in range(first_cell, cells.on.size):
        if cells.on[e] == 1:
            total += stored_in_cell(cells, e, r, F)
    return total


@lean_inner
def extra_energy(web, r, q, F):
    """Energy of the slots beyond that of what they stand for, and of the springs to masses at q, J."""
    links, cells, seats = web.links, web.cells, web.seats
    total = energy_of_pieces(web, web.own_links, web.own_cells, r, F)
    for k in range(seats.kind.size):
        e = seats.divided[k]
        if e < 0:
            continue
        if seats.wanted[k] == MASS:  # it may be about to leave
            for a in range(3):
                gap = q[k, a] - held_place(web, r, k, a)
                total += 0.5 * seats.grip[k] * gap * gap
        known = False
        for i in range(k):
            known = known or (seats.on[i] == seats.on[k] and seats.divided[i] == e)
        if known:
            continue
        if seats.on[k] == ON_LINE:
            total -= energy_of_link(links, e, r)
        else:
            total -= stored_in_cell(cells, e, r, F)
    return total
