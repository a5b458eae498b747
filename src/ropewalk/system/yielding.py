"""How a line gives way beside its nodes where something touches it: across itself by a kink, along itself by its links.

N = S d + S_a e t,   S_a = EA / (h AXIAL),   energy |d|^2/2 S + S_a e^2/2,   see `contacts.py`
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import inlined, kernel, lean_inner

# By how much a line gives way along itself under a contact, over h/EA, and the strain at which EA is taken. About that
# of straight links, without their arcs.
AXIAL, LITTLE = 0.3, 1e-6


@kernel
def stiffness_at_rest(p, lag):
    """EA of a line of the law p that hardly stretches, with what hysteresis `lag` adds to it, N."""
    return law.tangent(p, LITTLE) + lag[0]


@lean_inner
def axial_stiffness(structure, contacts, k, has_body):
    """Stiffness of contact k along its line, the same all along a run; 0: it has none by itself.

    What gives way within a step bounds it, twice as much as S: both act on the same nodes.
    """
    runs, run = structure.runs, contacts[k].run
    if runs.law[run, 0] == law.RIGID or runs.firm[run] > 0.0 or structure.about.links.size > 0:
        return 0.0
    EA = stiffness_at_rest(runs.law[run], runs.hysteresis[run])
    if EA <= 0.0:
        return 0.0
    soft = AXIAL * runs.h[run] / EA + contacts[k].least
    if has_body and contacts[k].step > 0.0:
        soft += contacts[k].step ** 2 * (1.0 / (runs.rho[run] * runs.h[run]) + contacts[k].light)
    return 1.0 / soft


@inlined
def stiffness_along(contacts, k):
    """By how much the force of contact k along its line grows with what touches going ahead, N/m."""
    return contacts[k].axial_stiffness if contacts[k].axial_stiffness > 0.0 else max(contacts[k].moving, 0.0)


@inlined
def stiffness_between(contacts, k, a, b):
    """By how much component a of the force of contact k grows with component b of where what touches is, N/m."""
    S, more = contacts[k].moving if a == b else 0.0, contacts[k].axial_stiffness - contacts[k].moving
    if contacts[k].axial_stiffness > 0.0:
        S += more * contacts[k].tangent[a] * contacts[k].tangent[b]
    return S


@inlined
def turned(contacts, k, axes):
    """Change of the energy of the kink of contact k with s, as its stiffness changes and its line turns, N."""
    square, turn = 0.0, 0.0
    for a in range(axes):
        square += contacts[k].d[a] ** 2
        turn += contacts[k].d[a] * contacts[k].turns[a]
    change = -0.5 * square * contacts[k].turn
    if contacts[k].axial_stiffness > 0.0:
        change += (contacts[k].axial_stiffness - contacts[k].moving) * contacts[k].axial * turn
    return change


@inlined
def stored_beside(contacts, k, axes):
    """Energy of the contact k that is not stored in links, J."""
    stored = 0.5 * contacts[k].axial_stiffness * contacts[k].axial ** 2
    for a in range(axes):
        stored += 0.5 * contacts[k].d[a] ** 2 * contacts[k].firm
    return stored


@inlined
def divide(contacts, k, axes):
    """Divide d of contact k into parts across its line and along it."""
    contacts[k].axial = 0.0
    if contacts[k].axial_stiffness > 0.0:
        for a in range(axes):
            contacts[k].axial += contacts[k].d[a] * contacts[k].tangent[a]
        for a in range(axes):
            contacts[k].d[a] -= contacts[k].axial * contacts[k].tangent[a]


@lean_inner
def across(contacts, k, axes):
    """Force of contact k across its line, N, whose part along it makes the line give way by e, which is noted."""
    along, square = 0.0, 0.0
    for a in range(axes):
        along += contacts[k].N[a] * contacts[k].tangent[a]
        square += contacts[k].N[a] ** 2
    contacts[k].axial = 0.0
    if contacts[k].axial_stiffness > 0.0:
        contacts[k].axial = along / contacts[k].axial_stiffness
        square = 0.0
        for a in range(axes):
            square += (contacts[k].N[a] - along * contacts[k].tangent[a]) ** 2
    return np.sqrt(square)


@lean_inner
def give_way(contacts, k, axes, soft):
    """Let contact k give way to its given force, across its line by `soft` in m/N; `across` has been found."""
    for a in range(axes):
        along = contacts[k].axial * contacts[k].tangent[a]
        N = contacts[k].N[a] - contacts[k].axial_stiffness * along
        contacts[k].d[a] = soft * N
        contacts[k].place[a] = contacts[k].p[a] + contacts[k].d[a] + along
