"""Friction of prescribed travel: a given force that rubs, and is held by a horizontal force where that is not enough.

As at rest (`hold_forces.py`), the force along the line is what it takes to move the contact along it, and friction
bears up to R of the force N across, with half the angle by which the line turns there:

    sin(half) = |N| / (2 (T + EI/h^2)),   R = tanh(mu half) / sin(half)  (capstan)  or  mu / cos(half)  (block).

Friction that stands bears what it can; friction that is dragged acts in full against the travel. The kink of the
contact, the tension that it makes and the hold force are found together at each instant. A net does not bend around a
contact: there R = mu.
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import lean_inner
from ropewalk.system.contact.contact_record import DRAGGED, STANDS
from ropewalk.system.contact.contacts import find_kink, slope_at_rest
from ropewalk.system.contact.yielding import across, give_way, turned
from ropewalk.system.elements.segments import bending_near

# Rounds in which a hold force is found, and the part of the force on the line to which it is: as kinks are.
ROUNDS, FOUND = 50, 1e-8
# Half the angle below which a line does not turn, and the least cosine of it.
STRAIGHT, SHARP = 1e-6, 1e-3


@lean_inner
def friction_demand(mu, block, half):
    """Largest force of friction over the force across the line, R, where the line turns by twice an angle in rad."""
    if mu <= 0.0:
        return 0.0
    if block == 1:
        return mu / max(np.cos(half), SHARP)
    return np.tanh(mu * half) / np.sin(half) if half > STRAIGHT else mu


@lean_inner
def _pressed(structure, buffers, contacts, state, table, out, k, hold):
    """Force of contact k along the line, the one across it and what friction bears of that, N, with a hold force in N.

    Returns:
        Also the part of the hold force that acts along, the part of it across, and the tension.
    """
    axes, small = state.r.shape[0], structure.about.links.size > 0
    run, h = contacts[k].run, structure.runs.h[contacts[k].run]
    along = square = first = aside = whole = 0.0
    level = structure.runs.ahead[run]
    for a in range(axes):
        contacts[k].N[a] = contacts[k].given[a] + hold * level[a]
        way = slope_at_rest(structure, contacts, k, a) if small else contacts[k].along[a]
        along += contacts[k].N[a] * way
        square += way * way
        first += level[a] * way
        aside += level[a] * contacts[k].N[a]
        whole += contacts[k].N[a] ** 2
    stretch, T, change = 0.0, 0.0, 0.0
    if small:
        stretch = np.sqrt(square)
        for j in range(3):
            T += contacts[k].part[j] * structure.about.links[contacts[k].link[j]].tension
    else:
        F = across(contacts, k, axes)
        length = np.sqrt(find_kink(structure, buffers, contacts, table, out, k, 0.0, F)[2])
        give_way(contacts, k, axes, length / F if F > 0.0 else 0.0)
        for j in range(3):
            link, q = contacts[k].link[j], contacts[k].part[j]
            longer = np.sqrt(buffers.length[link] ** 2 + 2.0 * max(q, 0.0) * contacts[k].kink)
            own = law.tension(structure.runs.law[run], longer / contacts[k].h[j] - 1.0) - buffers.lag[0, link]
            T += q * own
            stretch += q * longer / contacts[k].h[j]
            change += contacts[k].change[j] / h * contacts[k].kink / max(longer, 1e-300) * own
        change += turned(contacts, k, axes)
    normal = np.sqrt(max(whole - along * along / square, 0.0))
    aside -= along / square * first
    bending = bending_near(structure.segments, structure.runs, run, contacts[k].x) / (h * h)
    whole, half = 2.0 * (T + bending), 0.5 * np.pi
    if structure.runs.firm[run] > 0.0:
        half, stretch = 0.0, np.sqrt(square)
    elif normal < whole:
        half = np.arcsin(normal / whole)
    R = friction_demand(contacts[k].friction, contacts[k].block, half)
    return (along - change) / stretch, R * normal, first / stretch, R * aside / max(normal, 1e-300)


@lean_inner
def rub(structure, buffers, contacts, state, table, out, k):
    """Find the hold force of contact k, a given force that rubs; if nothing holds it, that is not a number."""
    hold = contacts[k].hold if contacts[k].rubs == DRAGGED else 0.0
    along, most, ahead, more = _pressed(structure, buffers, contacts, state, table, out, k, hold)
    sign = 1.0 if contacts[k].measured >= 0.0 else -1.0
    if contacts[k].rubs == STANDS:
        sign = 1.0 if along > 0.0 else -1.0
        if abs(along) <= most:
            contacts[k].hold = 0.0
            return
    size, change, before, found = 0.0, 0.0, 0.0, False
    for a in range(state.r.shape[0]):
        size += contacts[k].given[a] ** 2
    size = np.sqrt(size)
    for _ in range(ROUNDS):
        miss, slope = along - sign * most, ahead - sign * more
        if abs(slope) < 0.1 * abs(ahead):
            slope = 0.1 * ahead
        if change != 0.0 and 0.2 < (miss - before) / (change * slope) < 5.0:  # as it was in the last round
            slope = (miss - before) / change
        change, before = -miss / slope, miss
        hold += change
        along, most, ahead, more = _pressed(structure, buffers, contacts, state, table, out, k, hold)
        found = abs(along - sign * most) <= FOUND * size
        if found:
            break
    contacts[k].hold = hold if found or size == 0.0 else np.nan
