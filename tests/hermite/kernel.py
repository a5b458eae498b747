"""The compiled steps of the Hermite formulation: Newmark's rule, and scalar problems for whatever has a law of its own.

A step solves for the wires alone with the forces of the step before, finds all forces together by projected
Gauss-Seidel with the compliances within a step, and solves again with these.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.compiled import lean, lean_inner

from .sweeps import CR, CU, LANES, ROW, H, R, U, V, Y, column, move, predict, weigh

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

_MOST_SWEEPS = 500
_CLOSE = 1e-9  # of the largest force: the scalar problems have converged
_COLOURS = 3
# A contact that never yields would swing from step to step and grow: the rule has no damping for it. It gets a spring
# of this part of the stiffness of what it joins, within a step, and damping to match; both vanish with dt^2.
_RIGID = 0.25


class Links(NamedTuple):
    """Ties and elastic holds: scalar springs on one or two nodes; one entry each."""

    node: Integers  # (link, 2)
    at: Integers  # (link, 2) where the rise of the node stands in the row of field 0
    way: Array  # (link, 2) elongation per rise of the nodes
    stretched: Array  # m, elongation at rest
    force: Array  # N at rest
    stiffness: Array  # N/m
    pushes: Array  # N/m when compressed
    damping: Array  # N s/m
    both: NDArray[np.bool_]  # obeys `stiffness` and `damping` when it pushes, too
    yields: Array  # m/N, compliance of the wires
    start: Integers  # (link + 1,) first of its neighbours in
    near: Integers  # links that its force moves
    felt: Array  # m/N


class Touch(NamedTuple):
    """Contacts; one entry each."""

    moving_load: Integers
    wire: Integers
    row: Array  # (contact, coordinate)
    side: Array  # 1: below the wire, -1: above
    stiffness: Array
    damping: Array
    lifts: NDArray[np.bool_]
    given: NDArray[np.bool_]  # its force is given
    zero: Array  # m, height from which those of its rider count


class Bodies(NamedTuple):
    """Riders, padded with coordinates that stand still."""

    mass: Array  # (rider, coordinate, coordinate)
    damping: Array
    yields: Array  # inverse of the step matrix
    q: Array  # (rider, coordinate), changed by the run
    speed: Array
    acceleration: Array
    fresh: Array  # q at the end of a step
    forced: Array  # N


class Course(NamedTuple):
    """What the riders do, at every step."""

    station: Array  # (step, contact)
    rough: Array  # (step, contact)
    given: Array  # (step, contact)
    push: Array  # (step, rider, coordinate)


class Result(NamedTuple):
    """What is recorded of every step."""

    contact_force: Array  # (step, contact)
    contact_height: Array  # (step, contact)
    q: Array  # (step, rider, coordinate)
    tie_force: Array  # (step, tie)
    watched: Array  # (step, watched)


class Nodes(NamedTuple):
    """The wires in their natural order."""

    first: Integers  # (wire + 1,)
    station: Array  # (node,)
    free: Array  # (node, 2) 1, or 0 for what is held fast
    rest: Array  # (node, 2) height and slope at rest
    W: Array  # (node, 2, 2)
    D: Array  # (node, 2, 2), inverse
    at: Integers  # (node, 2) where its unknowns stand in the rows
    lumps: Array  # (node,) kg
    lumped: Integers  # nodes with lumps
    restrained: Integers  # places of what is held fast


class Strain(NamedTuple):
    """Links in motion."""

    longer: Array  # m than at rest
    rate: Array
    force: Array  # N over that of rest
    sent: Array  # N, that the first solution of a step knows
    before: Array  # m at the step before
    rate_before: Array
    past: Array  # N, share of the step before in the law
    stiff: Array  # N/m, with what damping adds
    less: Array  # 1 / (1 + stiff times compliance)


class Location(NamedTuple):
    """Contacts in motion."""

    on: NDArray[np.bool_]
    place: Integers  # first node of its element
    lo: Integers  # first and last node that feel it
    hi: Integers
    shape: Array  # (contact, 4)
    columns: Array  # (contact, node from lo on, 2) m/N
    sprung: Array  # m, pressing without rise of wire and rider
    press: Array  # m, how far pressed together
    last: Array  # the same one and two steps before
    earlier: Array
    force: Array  # N
    message: Array  # N, that the first solution of a step knows
    ago: Integers  # first node of its element one step before, or -1
    ago_shape: Array
    mutual: Array  # (contact, contact) m/N
    moves: Array  # (contact, link) m/N
    near: Integers  # (contact, link) links that it moves
    nears: Integers  # their number


@lean_inner
def _where(first, station, s):
    """Element of the nodes from `first` on in which s lies."""
    low, high = first[0], first[1] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if station[middle] <= s:
            low = middle
        else:
            high = middle
    return low


@lean_inner
def _shape(station, i, s, shape):
    l = station[i + 1] - station[i]
    q = (s - station[i]) / l
    shape[0], shape[1] = (1.0 - q) ** 2 * (1.0 + 2.0 * q), l * q * (1.0 - q) ** 2
    shape[2], shape[3] = q * q * (3.0 - 2.0 * q), l * q * q * (q - 1.0)


@lean_inner
def _not_pulled(links, k, free):
    """Force over that of rest of a link that does not pull, and is `free` longer than at rest under that of rest."""
    free += links.stretched[k] + links.yields[k] * links.force[k]
    if links.pushes[k] > 0.0 and free < 0.0:
        return links.pushes[k] * free / (1.0 + links.pushes[k] * links.yields[k]) - links.force[k]
    return -links.force[k]


@lean_inner
def _press(touch, k, free, yields, before, earlier, dt):
    """Force of a contact that would be pressed together by `free` without it, and was by `before` and `earlier`."""
    stiff, damping = touch.stiffness[k], touch.damping[k]
    if stiff == np.inf:
        stiff, damping = _RIGID / yields, _RIGID * dt / yields
    d = damping / (2.0 * dt) if before == before and earlier == earlier else 0.0
    past = d * (earlier - 4.0 * before) if d > 0.0 else 0.0
    stiff += 3.0 * d
    force = (stiff * free + past) / (1.0 + stiff * yields)
    return max(0.0, force) if touch.lifts[k] else force


@lean_inner
def _put(t, at, i, shape, force):
    for b in range(4):
        t[at[i + b // 2, b % 2] + R * LANES] += shape[b] * force


@lean_inner
def _ride(bodies, course, n, c):
    """Where the riders would be without contacts."""
    size = bodies.q.shape[1]
    for r in range(bodies.q.shape[0]):
        for a in range(size):
            forced = course.push[n, r, a]
            for b in range(size):
                drift = c * bodies.q[r, b] + bodies.speed[r, b]
                forced += bodies.mass[r, a, b] * (c * (drift + bodies.speed[r, b]) + bodies.acceleration[r, b])
                forced += bodies.damping[r, a, b] * drift
            bodies.forced[r, a] = forced
        for a in range(size):
            bodies.fresh[r, a] = 0.0
            for b in range(size):
                bodies.fresh[r, a] += bodies.yields[r, a, b] * bodies.forced[r, b]


@lean_inner
def _sit(nodes, touch, course, location, n, reach):
    """Find the elements under the contacts and what moves when they push."""
    for k in range(location.on.size):
        w, s = touch.wire[k], course.station[n, k]
        first = nodes.first[w : w + 2]
        location.on[k] = nodes.station[first[0]] <= s <= nodes.station[first[1] - 1]
        if not location.on[k]:
            location.force[k], location.press[k], location.nears[k] = 0.0, np.nan, 0
            continue
        i = _where(first, nodes.station, s)
        _shape(nodes.station, i, s, location.shape[k])
        location.place[k], location.lo[k], location.hi[k] = (
            i,
            max(first[0], i - reach),
            min(first[1] - 1, i + 1 + reach),
        )
        location.sprung[k] = touch.zero[k] - course.rough[n, k]
        for b in range(4):
            location.sprung[k] -= location.shape[k, b] * nodes.rest[i + b // 2, b % 2]
            location.shape[k, b] *= nodes.free[i + b // 2, b % 2]
        if touch.given[k]:
            location.force[k] = course.given[n, k]
        else:
            column(nodes.W, nodes.D, i, location.shape[k], location.lo[k], location.hi[k], location.columns[k])


@lean_inner
def _couple(links, touch, bodies, location):
    """Compliances between contacts, and between contacts and links."""
    for k in range(location.on.size):
        if not location.on[k] or touch.given[k]:
            continue
        for m in range(location.on.size):
            location.mutual[k, m] = 0.0
            if not location.on[m] or touch.given[m]:
                continue
            moved = 0.0
            if touch.wire[k] == touch.wire[m]:
                for b in range(4):
                    j = location.place[m] + b // 2
                    if location.lo[k] <= j <= location.hi[k]:
                        moved += location.shape[m, b] * location.columns[k, j - location.lo[k], b % 2]
            if touch.moving_load[k] == touch.moving_load[m]:
                moved += _yield(touch, bodies, k, m)
            location.mutual[k, m] = moved * touch.side[k] * touch.side[m]
        location.nears[k] = 0
        for m in range(links.yields.size):
            a, b = links.node[m, 0], links.node[m, 1]
            moved = 0.0
            if location.lo[k] <= a <= location.hi[k]:
                moved += links.way[m, 0] * location.columns[k, a - location.lo[k], 0]
            if location.lo[k] <= b <= location.hi[k]:
                moved += links.way[m, 1] * location.columns[k, b - location.lo[k], 0]
            location.moves[k, m] = touch.side[k] * moved
            if moved != 0.0:
                location.near[k, location.nears[k]] = m
                location.nears[k] += 1


@lean_inner
def _yield(touch, bodies, k, m):
    """Rise of contact k of a rider under a force on its contact m."""
    moved, r = 0.0, touch.moving_load[k]
    for a in range(bodies.q.shape[1]):
        for b in range(bodies.q.shape[1]):
            moved += touch.row[k, a] * bodies.yields[r, a, b] * touch.row[m, b]
    return moved


@lean_inner
def _load(t, nodes, carried, links, touch, strain, location, first):
    """Complete the right side: the rule takes the forces before and after a step, here twice those before."""
    for j in nodes.lumped:
        t[nodes.at[j, 0] + R * LANES] += nodes.lumps[j] * t[nodes.at[j, 0] + H * LANES]
    if first:
        for j in range(nodes.at.shape[0]):
            for b in range(2):
                t[nodes.at[j, b] + R * LANES] += carried[j, b]
    for at in nodes.restrained:
        t[at + R * LANES] = 0.0
    for k in range(links.yields.size):
        for b in range(2):
            t[links.at[k, b] + R * LANES] -= 2.0 * links.way[k, b] * strain.force[k]
        strain.sent[k] = strain.force[k]
    for k in range(location.on.size):
        if location.ago[k] >= 0:
            _put(t, nodes.at, location.ago[k], location.ago_shape[k], touch.side[k] * location.message[k])
        if location.on[k]:
            _put(t, nodes.at, location.place[k], location.shape[k], touch.side[k] * location.force[k])
        location.message[k] = location.force[k]


@lean_inner
def _read(t, nodes, links, touch, bodies, strain, location, c):
    """Elongations and pressings with the forces of the step before."""
    for k in range(links.yields.size):
        e, rate = strain.longer[k], strain.rate[k]
        strain.before[k], strain.rate_before[k] = e, rate
        past = links.stiffness[k] * links.stretched[k] - links.force[k]
        strain.past[k] = past - links.damping[k] * (c * e + rate)
        e = 0.0
        for b in range(2):
            e += links.way[k, b] * t[links.at[k, b] + Y * LANES]
        strain.longer[k] = e
    for k in range(location.on.size):
        if not location.on[k] or touch.given[k]:
            continue
        height = location.sprung[k]
        for b in range(4):
            height -= location.shape[k, b] * t[nodes.at[location.place[k] + b // 2, b % 2] + Y * LANES]
        for a in range(bodies.q.shape[1]):
            height += touch.row[k, a] * bodies.fresh[touch.moving_load[k], a]
        for m in range(location.on.size):  # the solution knows what the forces do to the wires, not to the riders
            if location.on[m] and not touch.given[m] and touch.moving_load[m] == touch.moving_load[k]:
                height -= _yield(touch, bodies, k, m) * touch.side[m] * location.force[m]
        location.press[k] = touch.side[k] * height


@lean_inner
def _balance(links, touch, strain, location, dt):
    """Find the forces of all links and contacts together by projected Gauss-Seidel; whether it has converged."""
    for _ in range(_MOST_SWEEPS):
        change, largest = 0.0, 1.0
        for colour in range(_COLOURS):  # neighbours one after the other would wait for each other
            for k in range(colour, links.yields.size, _COLOURS):
                e, f = strain.longer[k], strain.force[k]
                new = f + (strain.stiff[k] * e + strain.past[k] - f) * strain.less[k]
                if new + links.force[k] <= 0.0 and not links.both[k]:
                    new = _not_pulled(links, k, e + links.yields[k] * f)
                d = new - f
                if d != 0.0:
                    strain.force[k] = new
                    change, largest = max(change, abs(d)), max(largest, abs(new))
                    for q in range(links.start[k], links.start[k + 1]):
                        strain.longer[links.near[q]] -= links.felt[q] * d
                    for m in range(location.on.size):
                        if location.nears[m] > 0:
                            location.press[m] += location.moves[m, k] * d
        for k in range(location.on.size):
            if not location.on[k] or touch.given[k]:
                continue
            yields = location.mutual[k, k]
            new = _press(
                touch,
                k,
                location.press[k] + yields * location.force[k],
                yields,
                location.last[k],
                location.earlier[k],
                dt,
            )
            d = new - location.force[k]
            location.force[k] = new
            change, largest = max(change, abs(d)), max(largest, abs(new))
            for m in range(location.on.size):
                if location.on[m] and not touch.given[m]:
                    location.press[m] -= location.mutual[k, m] * d
            for q in range(location.nears[k]):
                m = location.near[k, q]
                strain.longer[m] += location.moves[k, m] * d
        if change <= _CLOSE * largest:
            return True
        if not change < np.inf:
            return False
    return False


@lean_inner
def _settle(t, nodes, links, touch, bodies, strain, location, c):
    """Give the forces found to wires and riders."""
    for k in range(links.yields.size):
        d = strain.force[k] - strain.sent[k]
        for b in range(2):
            t[links.at[k, b] + R * LANES] -= links.way[k, b] * d
        strain.rate[k] = c * (strain.longer[k] - strain.before[k]) - strain.rate_before[k]
    size = bodies.q.shape[1]
    for k in range(location.on.size):
        location.earlier[k], location.last[k] = location.last[k], location.press[k]
        location.ago[k] = -1
        if location.on[k]:
            _put(
                t,
                nodes.at,
                location.place[k],
                location.shape[k],
                touch.side[k] * (location.force[k] - location.message[k]),
            )
            location.ago[k] = location.place[k]
            for b in range(4):
                location.ago_shape[k, b] = location.shape[k, b]
            if not touch.given[k]:
                r, force = touch.moving_load[k], touch.side[k] * location.force[k]
                for a in range(size):
                    for b in range(size):
                        bodies.fresh[r, a] -= bodies.yields[r, a, b] * touch.row[k, b] * force
        location.message[k] = location.force[k]
    for r in range(bodies.q.shape[0]):
        for a in range(size):
            gone = c * (bodies.fresh[r, a] - bodies.q[r, a])
            bodies.acceleration[r, a] = c * (gone - 2.0 * bodies.speed[r, a]) - bodies.acceleration[r, a]
            bodies.speed[r, a] = gone - bodies.speed[r, a]
            bodies.q[r, a] = bodies.fresh[r, a]


@lean_inner
def _record(t, nodes, links, touch, bodies, course, strain, location, watched, n, result):
    for r in range(bodies.q.shape[0]):
        for a in range(bodies.q.shape[1]):
            result.q[n, r, a] = bodies.q[r, a]
    for k in range(location.on.size):
        result.contact_force[n, k] = location.force[k]
        height = touch.zero[k] - course.rough[n, k] - location.sprung[k] if location.on[k] else np.nan
        if location.on[k]:
            for b in range(4):
                height += location.shape[k, b] * t[nodes.at[location.place[k] + b // 2, b % 2] + U * LANES]
        result.contact_height[n, k] = height
    for k in range(result.tie_force.shape[1]):
        result.tie_force[n, k] = links.force[k] + strain.force[k]
    for k in range(watched.size):
        result.watched[n, k] = t[watched[k] + U * LANES]


@lean
def march(t, reach, part, nodes, carried, links, touch, bodies, course, strain, location, watched, dt, result):
    """Take all steps of a run.

    Args:
        t: rows of fields, with the start; receives the end.
        reach: nodes within which the inverse of the step matrix decays.
        part: nodes of a lane.
        carried: (node, 2) what the start adds to the first right side, N; receives the same of the end.
        watched: (watched,) places like those of links.

    Returns:
        How many steps have been taken: fewer than asked for if the scalar problems were not solved.
    """
    steps, c = course.station.shape[0], 2.0 / dt
    for k in range(links.yields.size):
        for b in range(2):
            strain.longer[k] += links.way[k, b] * t[links.at[k, b] + U * LANES]
            strain.rate[k] += links.way[k, b] * t[links.at[k, b] + V * LANES]
    for j in range(nodes.at.shape[0]):
        for b in range(2):
            at = nodes.at[j, b]
            t[at + H * LANES] = t[at // ROW * ROW + at % LANES + CU * LANES] * t[at + U * LANES]
            t[at + H * LANES] += 2.0 * c * t[at + V * LANES]
    for n in range(1, steps):
        weigh(t, reach, part)
        _ride(bodies, course, n, c)
        _sit(nodes, touch, course, location, n, reach)
        _couple(links, touch, bodies, location)
        _load(t, nodes, carried, links, touch, strain, location, n == 1)
        predict(t, reach, part)
        _read(t, nodes, links, touch, bodies, strain, location, c)
        if not _balance(links, touch, strain, location, dt):
            return n
        _settle(t, nodes, links, touch, bodies, strain, location, c)
        move(t, reach, part, c)
        _record(t, nodes, links, touch, bodies, course, strain, location, watched, n, result)
    if steps > 1:
        _carry_on(t, nodes, carried, links, touch, strain, location)
    return steps


@lean_inner
def _carry_on(t, nodes, carried, links, touch, strain, location):
    """What the end adds to the next right side."""
    for j in range(nodes.at.shape[0]):
        for b in range(2):
            at = nodes.at[j, b]
            t[at + R * LANES] *= t[at // ROW * ROW + at % LANES + CR * LANES]
    for k in range(links.yields.size):
        for b in range(2):
            t[links.at[k, b] + R * LANES] -= links.way[k, b] * strain.force[k]
    for k in range(location.on.size):
        if location.ago[k] >= 0:
            _put(t, nodes.at, location.ago[k], location.ago_shape[k], touch.side[k] * location.force[k])
    for j in range(nodes.at.shape[0]):
        for b in range(2):
            carried[j, b] = t[nodes.at[j, b] + R * LANES]
