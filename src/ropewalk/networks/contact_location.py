"""Where contacts stand: the links that they divide, and the slots that stand for these meanwhile."""

from __future__ import annotations

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import inlined, lean, lean_inner
from ropewalk.mechanics.moving_contact import look_up
from ropewalk.networks.geometry import distance
from ropewalk.networks.network import FORCE, GONE, LEAVES, LINK_SLOTS, OFF

# A contact is taken to be no closer to a node than this part of its link: it hops over what is left.
CLEAR = 1e-3
# Two contacts are taken to be no closer than this part of a link.
TOUCHING = 1e-6


@lean
def place_at(course, k, t):
    """Place of contact k along its line at time t in m, and its speed in m/s."""
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
def _on_link(network, k):
    """Find the link on which contact k stands, walking from where it was."""
    locations, xi = network.locations, network.locations.xi[k]
    first, base, count = locations.first[k], locations.first_station[k], locations.segments[k]
    p = locations.cell[k] - first
    while p > 0 and xi < locations.station[base + p]:
        p -= 1
    while p < count - 1 and xi >= locations.station[base + p + 1]:
        p += 1
    locations.cell[k] = first + p
    length = locations.station[base + p + 1] - locations.station[base + p]
    part = (xi - locations.station[base + p]) / length
    part = min(max(part, CLEAR), 1.0 - CLEAR)
    locations.weight[k, 0], locations.weight[k, 1] = 1.0 - part, part


@lean
def location(network, t):
    """Find where all contacts are at time t, and the forces on them."""
    locations, course = network.locations, network.course
    for k in range(locations.kind.size):
        xi, speed = place_at(course, k, t)
        kind = locations.wanted[k]
        slack = 1e-9 * course.length[k]
        if xi < course.low[k] - slack or xi > course.high[k] + slack:
            speed = 0.0
            if course.at_end[k] == LEAVES:
                course.at_end[k] = GONE
        if course.at_end[k] == GONE:  # for good
            kind = OFF
        locations.xi[k], locations.speed[k] = min(max(xi, course.low[k]), course.high[k]), speed
        size = 0.0
        for a in range(3):
            F = look_up(course.force_time, course.force_value[a], course.force_first[k], course.force_count[k], t)
            locations.load[k, a] = F
            size += abs(F)
        if kind == FORCE and size == 0.0:
            kind = OFF  # a foot in the air
        locations.kind[k] = kind
        if kind != OFF:
            _on_link(network, k)


@lean_inner
def _divide_link(network, k):
    """Put slots between the nodes of a link and all contacts on it; k is the first of them."""
    links, locations = network.links, network.locations
    p = locations.cell[k]
    links.on[p] = 0
    behind, part, slot = links.one[p], 0.0, network.own_links + LINK_SLOTS * k
    following = k
    while following >= 0:
        here = following
        links.one[slot], links.other[slot], links.law[slot], links.on[slot] = (
            behind,
            network.nodes + here,
            links.law[p],
            1,
        )
        links.rest[slot] = max(locations.weight[here, 1] - part, TOUCHING) * links.rest[p]
        behind, part = network.nodes + here, locations.weight[here, 1]
        following = _next_on_link(locations, here)
        slot = network.own_links + LINK_SLOTS * (here if following < 0 else following) + (1 if following < 0 else 0)
    links.one[slot], links.other[slot], links.law[slot], links.on[slot] = behind, links.other[p], links.law[p], 1
    links.rest[slot] = (1.0 - part) * links.rest[p]


@inlined
def _is_before(locations, i, k):
    return locations.weight[i, 1] < locations.weight[k, 1] or (
        locations.weight[i, 1] == locations.weight[k, 1] and i < k
    )


@inlined
def _share_link(locations, i, k):
    return i != k and locations.kind[i] != OFF and locations.cell[i] == locations.cell[k]


@lean_inner
def _next_on_link(locations, k):
    """The next contact ahead on the link of contact k, -1 if there is none."""
    found = -1
    for i in range(locations.kind.size):
        if (
            _share_link(locations, i, k)
            and _is_before(locations, k, i)
            and (found < 0 or _is_before(locations, i, found))
        ):
            found = i
    return found


@lean_inner
def _is_first(locations, k):
    first = True
    for i in range(locations.kind.size):
        first = first and not (_share_link(locations, i, k) and _is_before(locations, i, k))
    return first


@lean
def join(network):
    """Switch all slots off, and on again what they stand for."""
    links, locations = network.links, network.locations
    for k in range(locations.kind.size):
        for slot in range(network.own_links + LINK_SLOTS * k, network.own_links + LINK_SLOTS * (k + 1)):
            links.on[slot] = 0
        if locations.split_link[k] >= 0:
            links.on[locations.split_link[k]] = 1
        locations.split_link[k] = -1


@lean
def divide(network):
    """Let all contacts divide what they stand on."""
    locations = network.locations
    for k in range(locations.kind.size):
        if locations.kind[k] == OFF:
            continue
        locations.split_link[k] = locations.cell[k]
        if _is_first(locations, k):
            _divide_link(network, k)


@lean_inner
def energy_of_segments(network, r):
    """Energy stored in all links that are on, slots included, J."""
    links, total = network.links, 0.0
    for p in range(links.on.size):
        if links.on[p] == 1:
            strain = distance(r, links.one[p], links.other[p]) / links.rest[p] - 1.0
            total += links.rest[p] * law.stored(links.laws[links.law[p]], strain)
    return total


@lean
def neighbours(network, k):
    """Slots of links behind and ahead of contact k on a line."""
    links, n = network.links, network.nodes + k
    behind, ahead = -1, -1
    for p in range(network.own_links, links.on.size):
        if links.on[p] == 1:
            if links.other[p] == n:
                behind = p
            if links.one[p] == n:
                ahead = p
    return behind, ahead
