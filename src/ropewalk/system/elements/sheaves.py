"""Sheaves: lines bend over points and slip as far as friction lets them; their nodes pass from side to side.

A line is a run up to the sheave and another one beyond. The link between the two is divided at the sheave into straight
pieces, which share its unstrained length h:

    V = s W(l1/s - 1) + (h - s) W(l2/(h - s) - 1) + what the pieces weigh.

Without friction s is where V is least, so that both tensions are equal at any time. With friction it slips as soon as
one of them exceeds exp(mu theta) times the other (Euler and Eytelwein), and until it no longer does. When a node comes
to the sheave, it is handed over from one run to the other.

To the first order about rest, s goes with the places of the three nodes where there is no friction; where there is any,
the line sticks, for it takes a finite motion to overcome it. No node comes to a sheave then.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import inlined, lean, lean_inner
from ropewalk.system.elements.compliance import ARC, SHORT_ARC
from ropewalk.system.elements.elements_about_rest import (
    add_forces_about_rest,
    gather_about_rest,
    is_little,
    stored_about_rest,
)
from ropewalk.system.elements.structure import RUBBED

# How lines slip: without friction, with it, not at all, or as in small motion: not where there is any.
SLIPS, RUBS, STICKS, LITTLE = 0, 1, 2, 3
# What of a sheave goes with places in small motion: rows of `Sheaves.rest`.
BEHIND, AHEAD, SLIPPED, STRAIN, MEAN = range(5)
# A sheave is taken to be no closer to a node than this part of the link over which it stands.
CLOSEST = 1e-9
# Rounds in which a slip is found, and the part of a link to which it is.
ROUNDS, FOUND = 60, 1e-15
# Links on either side of a sheave whose energy changes as a node passes.
AROUND = 3


@inlined
def exist(sheaves):
    """Whether there are any: asked where a call would hand all arrays on."""
    if sheaves is None:
        return False
    return sheaves.node.size > 0


@inlined
def _distance(r, i, j):
    square = 0.0
    for a in range(r.shape[0]):
        square += (r[a, j] - r[a, i]) ** 2
    return np.sqrt(square)


@inlined
def _turning_angle(r, i, j, k, l1, l2):
    cosine = 0.0
    for a in range(r.shape[0]):
        cosine += (r[a, j] - r[a, i]) * (r[a, k] - r[a, j])
    return np.arccos(min(max(cosine / (l1 * l2), -1.0), 1.0))


@lean_inner
def _excess(p, l1, l2, h, s, behind, ahead, w1, w2):
    """How much more a line is pulled ahead of a sheave than behind, which grows with s, and its change with s.

    Args:
        behind, ahead: factors of the tensions; both zero: without friction the change of all energy with s counts.
        w1, w2: N, of the weights of the pieces.
    """
    stretch1, stretch2 = l1 / s, l2 / (h - s)
    e1, e2 = stretch1 - 1.0, stretch2 - 1.0
    one, two = law.tension(p, e1), law.tension(p, e2)
    k1, k2 = law.tangent(p, e1) * stretch1 / s, law.tangent(p, e2) * stretch2 / (h - s)
    if ahead == 0.0:
        miss = two * stretch2 - law.stored(p, e2) - w2 - (one * stretch1 - law.stored(p, e1) - w1)
        return miss, k1 * stretch1 + k2 * stretch2
    return ahead * (two - w2) - behind * (one - w1), ahead * k2 + behind * k1


@lean_inner
def _slipped(p, l1, l2, h, s, ratio, w1, w2):
    """Unstrained length behind a sheave once its line has slipped as far as friction lets it.

    Args:
        p: axial law.
        l1, l2: m, lengths behind and ahead of the sheave.
        h: m, unstrained length of both together.
        s: m, of the piece behind before.
        ratio: of the larger tension to the smaller one from which on it slips; 1: there is no friction.
        w1, w2: as of `_excess`.
    """
    low, high = CLOSEST * h, (1.0 - CLOSEST) * h
    s, behind, ahead = min(max(s, low), high), 0.0, 0.0
    if ratio > 1.0:
        one, two = law.tension(p, l1 / s - 1.0) - w1, law.tension(p, l2 / (h - s) - 1.0) - w2
        if two > one * ratio:
            behind, ahead = ratio, 1.0
        elif one > two * ratio:
            behind, ahead = 1.0, ratio
        else:
            return s
    for _ in range(ROUNDS):
        miss, slope = _excess(p, l1, l2, h, s, behind, ahead, w1, w2)
        if miss == 0.0:
            break
        if miss > 0.0:
            high = s
        else:
            low = s
        new = s - miss / slope if slope > 0.0 else -1.0
        if not low < new < high:
            new = 0.5 * (low + high)
        step, s = abs(new - s), new
        if step <= FOUND * h:
            break
    return s


@lean_inner
def _near_rest(sheaves, q, row):
    """What is in a row of `Sheaves.rest`, to the first order of how far the nodes of sheave q are from there."""
    value = sheaves.rest[q, row]
    for n in range(sheaves.about.away.size):
        value += sheaves.changes[q, row, n] * sheaves.about.away[n]
    return value


@lean_inner
def slip(sheaves, runs, r, how):
    """Let lines slip over their sheaves, SLIPS, RUBS, STICKS or LITTLE; returns what friction takes, J."""
    lost = 0.0
    if sheaves is None:
        return lost
    if is_little(sheaves.about):
        for q in range(sheaves.node.size):
            gather_about_rest(sheaves.about, q, r)
            sheaves.tension[q, 0] = _near_rest(sheaves, q, BEHIND)
            sheaves.tension[q, 1] = _near_rest(sheaves, q, AHEAD)
            sheaves.ahead[q] = _near_rest(sheaves, q, SLIPPED)
        return lost
    for q in range(sheaves.node.size):
        run, b, w1, w2 = sheaves.run[q], sheaves.node[q], 0.0, 0.0
        e, h, p, was = runs.first[run] + runs.links[run], runs.h[run], runs.law[run], sheaves.ahead[q]
        l1, l2 = max(_distance(r, e, b), CLOSEST * h), max(_distance(r, b, e + 1), CLOSEST * h)
        for a in range(r.shape[0]):
            w1 += 0.5 * sheaves.weight[q, a] * (r[a, b] - r[a, e])
            w2 += 0.5 * sheaves.weight[q, a] * (r[a, b] - r[a, e + 1])
        if how != STICKS and (how != LITTLE or sheaves.friction[q] == 0.0):
            ratio = np.exp(sheaves.friction[q] * _turning_angle(r, e, b, e + 1, l1, l2)) if how == RUBS else 1.0
            s = _slipped(p, l1, l2, h, was, ratio, w1, w2)
            if how == RUBS and sheaves.friction[q] > 0.0:
                drive = -_excess(p, l1, l2, h, s, 0.0, 0.0, w1, w2)[0]
                lost += 0.5 * (drive + sheaves.drive[q]) * (s - was)  # it has changed while it slipped
                sheaves.drive[q] = drive
            sheaves.ahead[q] = s
        s = sheaves.ahead[q]
        sheaves.tension[q, 0] = law.tension(p, l1 / s - 1.0)
        sheaves.tension[q, 1] = law.tension(p, l2 / (h - s) - 1.0)
    return lost


@lean_inner
def stretch_over(sheaves, runs, buffers, r):
    """Lengths of all links that sheaves divide, and their strains in the mean."""
    if sheaves is None:
        return
    if is_little(sheaves.about):
        for q in range(sheaves.node.size):
            gather_about_rest(sheaves.about, q, r)
            e = sheaves.about.node[q, 0]
            buffers.strain[e] = _near_rest(sheaves, q, STRAIN)
            buffers.length[e] = runs.h[sheaves.run[q]] * (1.0 + buffers.strain[e])
        return
    for q in range(sheaves.node.size):
        run, b = sheaves.run[q], sheaves.node[q]
        e = runs.first[run] + runs.links[run]
        buffers.length[e] = _distance(r, e, b) + _distance(r, b, e + 1)
        buffers.strain[e] = buffers.length[e] / runs.h[run] - 1.0


@lean_inner
def _lag(buffers, e, c, since):
    """Tension of the damper of link e, N, whose strain has been looked at `since` s ago."""
    if since > 0.0:
        buffers.rate[e] = (buffers.strain[e] - buffers.before[e]) / since
        buffers.before[e] = buffers.strain[e]
    return c * buffers.rate[e]


@lean_inner
def _add_forces_near_rest(sheaves, runs, buffers, r, since):
    """The same to the first order about rest."""
    lost, axes, about = 0.0, r.shape[0], sheaves.about
    add_forces_about_rest(about, r, buffers.force)
    for q in range(sheaves.node.size):
        e, h, c = about.node[q, 0], runs.h[sheaves.run[q]], runs.damping[sheaves.run[q]]
        gather_about_rest(about, q, r)
        buffers.tension[e] = _near_rest(sheaves, q, MEAN)
        if c > 0.0:
            viscous = _lag(buffers, e, c, since)
            lost += viscous * h * buffers.rate[e]
            buffers.tension[e] += viscous
            for i in range(3):
                for a in range(axes):
                    buffers.force[a, about.node[q, i]] -= h * viscous * sheaves.changes[q, STRAIN, i * axes + a]
    return lost


@lean_inner
def add_sheave_forces(sheaves, runs, buffers, r, since):
    """Add the forces of all pieces, whose strains and slip are known, to `room.force`; returns what they damp, W.

    Args:
        since: s, since strains were looked at before; 0: nothing has moved since.
    """
    lost = 0.0
    if sheaves is None:
        return lost
    if is_little(sheaves.about):
        return _add_forces_near_rest(sheaves, runs, buffers, r, since)
    for q in range(sheaves.node.size):
        run, b, s, viscous = sheaves.run[q], sheaves.node[q], sheaves.ahead[q], 0.0
        e, h, c = runs.first[run] + runs.links[run], runs.h[run], runs.damping[run]
        l1, l2 = max(_distance(r, e, b), CLOSEST * h), max(_distance(r, b, e + 1), CLOSEST * h)
        if c > 0.0:
            viscous = _lag(buffers, e, c, since)
            lost += viscous * h * buffers.rate[e]
        buffers.tension[e] = law.tension(runs.law[run], buffers.strain[e]) + viscous
        q1, q2 = (sheaves.tension[q, 0] + viscous) / l1, (sheaves.tension[q, 1] + viscous) / l2
        for a in range(r.shape[0]):
            w = 0.5 * sheaves.weight[q, a]
            one, two = q1 * (r[a, b] - r[a, e]) - w * (h - s), q2 * (r[a, b] - r[a, e + 1]) - w * s
            buffers.force[a, e] += one
            buffers.force[a, e + 1] += two
            buffers.force[a, b] -= one + two
    return lost


@lean_inner
def add_wind_over(sheaves, runs, wind, r, v, speed, air):
    """Add the forces of the wind on all pieces, half of each to its ends; returns their power, W."""
    power = 0.0
    if sheaves is None:
        return power
    for q in range(sheaves.node.size):
        run, b = sheaves.run[q], sheaves.node[q]
        e = runs.first[run] + runs.links[run]
        for side in range(2):
            i, j = (e, b) if side == 0 else (b, e + 1)
            length = max(_distance(r, i, j), CLOSEST * runs.h[run])
            along = square = 0.0
            for a in range(r.shape[0]):
                u = speed * wind.direction[a] - 0.5 * (v[a, i] + v[a, j])
                along += u * (r[a, j] - r[a, i]) / length
                square += u * u
            k = 0.25 * wind.density * runs.width[run] * length * np.sqrt(max(square - along * along, 0.0))
            for a in range(r.shape[0]):
                u = speed * wind.direction[a] - 0.5 * (v[a, i] + v[a, j])
                F = k * (u - along * (r[a, j] - r[a, i]) / length)
                air[a, i] += F
                air[a, j] += F
                power += F * (v[a, i] + v[a, j])
    return power


@lean_inner
def stored_at(sheaves, runs, r):
    """Energy stored in all pieces as they have slipped, J."""
    total = 0.0
    if sheaves is None:
        return total
    if is_little(sheaves.about):  # without what `gravitational` has
        total = stored_about_rest(sheaves.about, r)
        for q in range(sheaves.node.size):
            e, b, j = sheaves.about.node[q, 0], sheaves.about.node[q, 1], sheaves.about.node[q, 2]
            h, s = runs.h[sheaves.run[q]], sheaves.ahead[q]
            for a in range(r.shape[0]):
                total -= 0.5 * sheaves.weight[q, a] * ((h - s) * r[a, e] + s * r[a, j] - h * r[a, b])
        return total
    for q in range(sheaves.node.size):
        run, b, s = sheaves.run[q], sheaves.node[q], sheaves.ahead[q]
        e, h, p = runs.first[run] + runs.links[run], runs.h[run], runs.law[run]
        l1, l2 = max(_distance(r, e, b), CLOSEST * h), max(_distance(r, b, e + 1), CLOSEST * h)
        total += s * law.stored(p, l1 / s - 1.0) + (h - s) * law.stored(p, l2 / (h - s) - 1.0)
    return total


@lean_inner
def _bend(runs, run, r, a, i):
    """Second difference of component a at node i of one of two runs; none at their ends."""
    for k in range(run, run + 2):
        if runs.first[k] < i < runs.first[k] + runs.links[k]:
            return (r[a, i + 1] - r[a, i]) - (r[a, i] - r[a, i - 1])
    return 0.0


@lean_inner
def _stored_around(sheaves, runs, r, q, low, high):
    """Energy stored in the links from `low` to `high` about sheave q, the one over which it stands in the mean, J."""
    run, total = sheaves.run[q], 0.0
    e, h, b = runs.first[run] + runs.links[run], runs.h[run], sheaves.node[q]
    for i in range(low, high + 1):
        square = 0.0
        for a in range(r.shape[0]):
            one, two = _bend(runs, run, r, a, i), _bend(runs, run, r, a, i + 1)
            square += (r[a, i + 1] - r[a, i]) ** 2 + 2.0 * ARC * (one * one + two * two)
            square += 2.0 * SHORT_ARC * (two - one) ** 2
        length = np.sqrt(square) if i != e else _distance(r, e, b) + _distance(r, b, e + 1)
        total += h * law.stored(runs.law[run], length / h - 1.0)
    return total


@lean_inner
def _shift(sheaves, lines, runs, q, way):
    """Let one node pass sheave q, from behind it (-1) or from ahead of it (1)."""
    run = sheaves.run[q]
    runs.links[run] += way
    runs.first[run + 1] += way
    runs.links[run + 1] -= way
    lines.begin[run + 1] += way * runs.h[run]


@lean_inner
def _turn_inertia(inertia, near, beyond, v, was, square, turned):
    """Let a node that passes be heavier along the line beyond; returns v^2 before and after with what that adds.

    Args:
        was: m/s, along its line before.
    """
    ends, now = True, 0.0
    for a in range(v.shape[0]):
        ends = ends and inertia.along[a, beyond] == 0.0
    for a in range(v.shape[0]):
        if not ends:  # the end of a line, which has no way of its own
            inertia.along[a, near] = inertia.along[a, beyond]
        now += inertia.along[a, near] * v[a, near]
    more = inertia.factor - 1.0
    return square + more * was * was, turned + more * now * now


@lean_inner
def pass_nodes(sheaves, lines, runs, mass, inertia, r, v, work):
    """Let nodes that have come to a sheave pass to its other side; what that takes goes to `work`.

    A node takes the direction of the piece beyond: its velocity turns from that behind, so that speeds along the line
    and across it stay. What it is heavier by along its line (`inertia.py`) turns to where the node before it has that.
    Arcs do not reach over a sheave: there are others beside it then.

    Returns:
        False where a line has come to its end, or to another sheave.
    """
    if sheaves is None:
        return True
    if is_little(sheaves.about):
        return True
    for q in range(sheaves.node.size):
        b, run = sheaves.node[q], sheaves.run[q]
        for side in range(2):
            e = runs.first[run] + runs.links[run]
            near, beyond, way = (e, e + 1, -1) if side == 0 else (e + 1, e, 1)
            far, passed = near + way, 0.0
            for a in range(r.shape[0]):
                passed += (r[a, near] - r[a, b]) * (r[a, near] - r[a, far])
            if passed <= 0.0:
                continue
            if runs.links[run + side] < 2:
                return False
            low = max(e - AROUND, runs.first[run])
            high = min(e + AROUND, runs.first[run + 1] + runs.links[run + 1] - 1)
            length, away = _distance(r, far, near), _distance(r, b, beyond)
            over, along, ahead, turn, square, turned, was = passed / length, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0
            for a in range(r.shape[0]):
                one, other = (r[a, near] - r[a, far]) / length, (r[a, beyond] - r[a, b]) / away
                along += (v[a, near] - v[a, b]) * one
                ahead += (v[a, near] - v[a, b]) * other
                turn += one * other
            for a in range(r.shape[0]):
                one, other = (r[a, near] - r[a, far]) / length, (r[a, beyond] - r[a, b]) / away
                square += v[a, near] * v[a, near]
                if inertia.along.shape[1] > 0:
                    was += inertia.along[a, near] * v[a, near]
                v[a, near] += 2.0 * along * other - (along + ahead) / max(turn, CLOSEST) * (one + other)
                turned += v[a, near] * v[a, near]
            for a in range(r.shape[0]):
                r[a, near] = r[a, b]
            if inertia.along.shape[1] > 0:
                square, turned = _turn_inertia(inertia, near, beyond, v, was, square, turned)
            before = _stored_around(sheaves, runs, r, q, low, high)
            _shift(sheaves, lines, runs, q, way)
            after = _stored_around(sheaves, runs, r, q, low, high)
            work[RUBBED] += 0.5 * mass[near] * (square - turned) + before - after
            for a in range(r.shape[0]):
                r[a, near] = r[a, b] + over * (r[a, beyond] - r[a, b]) / away
            e += way
            behind, ahead = _distance(r, e, b), _distance(r, b, e + 1)
            sheaves.ahead[q] = runs.h[run] * behind / (behind + ahead)
            break
    return True


@lean
def pass_nodes_entry(sheaves, lines, runs, mass, inertia, r, v, work):
    """`pass_nodes` as Python calls it."""
    return pass_nodes(sheaves, lines, runs, mass, inertia, r, v, work)
