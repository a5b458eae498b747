"""How a line gives way beside its nodes where something touches it: across itself by a kink, along itself by its links.

N = S d + S_a e t,   S_a = EA / (h AXIAL),   energy |d|^2/2 S + S_a e^2/2,   see `contacts.py`
"""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.compiled import inlined, kernel, lean_inner
from ropewalk.system.contact.contact_record import FREE, NOT, ON

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

    What gives way within a step bounds it, twice as much as S: both act on the same nodes. A line that does not stretch
    gives way by that alone to what travels freely or rubs: if e lengthened its links as d does, what is held back there
    would jerk all of it.
    """
    runs, run = structure.runs, contacts[k].run
    if runs.firm[run] > 0.0 or structure.about.links.size > 0:
        return 0.0
    within = contacts[k].step ** 2 * (1.0 / (runs.rho[run] * runs.h[run]) + contacts[k].light)
    if runs.law[run, 0] == law.RIGID:
        slides = has_body and (contacts[k].travel == FREE or contacts[k].rubs != NOT)
        return 0.5 / within if slides and within > 0.0 else 0.0
    EA = stiffness_at_rest(runs.law[run], runs.hysteresis[run])
    if EA <= 0.0:
        return 0.0
    soft = AXIAL * runs.h[run] / EA + contacts[k].least
    return 1.0 / (soft + within if has_body else soft)


@inlined
def keeps_length(structure, contacts, k):
    """Whether contact k is on a line that does not stretch, whose links its kink lengthens."""
    is_little = structure.about.links.size > 0
    return contacts[k].state == ON and structure.runs.law[contacts[k].run, 0] == law.RIGID and not is_little


@inlined
def has_hold(contacts, k):
    """Whether a horizontal force holds contact k where it does not bear all by friction."""
    return contacts[k].frictionless == 1 or contacts[k].rubs != NOT


@inlined
def firmness_along(contacts, k):
    """Stiffness of contact k along its line, N/m, if it has one: S_a, or S where the line has no direction."""
    lost = 1.0 - contacts[k].aligned
    return contacts[k].aligned * contacts[k].axial_stiffness + (lost * contacts[k].moving if lost > 0.0 else 0.0)


@inlined
def eased(contacts, k):
    """What damps how contact k gives way along its line, N, so that it does not swing there where only steps let it."""
    if contacts[k].easing == 0.0:
        return 0.0
    return contacts[k].aligned * contacts[k].easing * (contacts[k].axial - contacts[k].axial_before)


@inlined
def stored_along(contacts, k):
    """Energy of contact k by which its line gives way along itself, J."""
    return 0.5 * contacts[k].aligned * contacts[k].axial_stiffness * contacts[k].axial ** 2


@inlined
def bent(contacts, k, axes):
    """Square of the kink of contact k, m^2; e is a part of it as far as the line has no direction."""
    square = (1.0 - contacts[k].aligned) * contacts[k].axial ** 2
    for a in range(axes):
        square += contacts[k].d[a] ** 2
    return square


@inlined
def bent_by_body(contacts, k, a):
    """Change of half of `bent` with component a of where what touches is, m."""
    return contacts[k].d[a] + (1.0 - contacts[k].aligned) * contacts[k].axial * contacts[k].tangent[a]


@inlined
def bent_by_turning(contacts, k, a):
    """The same with component a of the derivative of the spline by s, m^2."""
    e, t = contacts[k].axial, contacts[k].tangent[a]
    return -e * (contacts[k].aligned * contacts[k].d[a] / contacts[k].spread + 0.5 * contacts[k].aligning * e * t)


@inlined
def crushed(contacts, k):
    """Change of the energy of contact k with `spread`, as its line loses its direction, J."""
    return 0.5 * contacts[k].aligning * (contacts[k].axial_stiffness - contacts[k].moving) * contacts[k].axial ** 2


@inlined
def stiffness_along(contacts, k):
    """By how much the force of contact k along its line grows with what touches going ahead, N/m."""
    return firmness_along(contacts, k) if contacts[k].axial_stiffness > 0.0 else max(contacts[k].moving, 0.0)


@inlined
def stiffness_between(contacts, k, a, b):
    """By how much component a of the force of contact k grows with component b of where what touches is, N/m."""
    S = contacts[k].moving if a == b else 0.0
    if contacts[k].axial_stiffness > 0.0:
        more = contacts[k].aligned * (contacts[k].axial_stiffness - contacts[k].moving)
        S += more * contacts[k].tangent[a] * contacts[k].tangent[b]
    return S


@inlined
def turned(contacts, k, axes):
    """Change of the energy of the kink of contact k with s, as its stiffness changes and its line turns, N."""
    turn = 0.0
    for a in range(axes):
        turn += contacts[k].d[a] * contacts[k].turns[a]
    change = -0.5 * bent(contacts, k, axes) * contacts[k].turn
    if contacts[k].axial_stiffness > 0.0:
        more = contacts[k].aligned * (contacts[k].axial_stiffness - contacts[k].moving)
        change += (more * contacts[k].axial + eased(contacts, k)) * turn + crushed(contacts, k) * contacts[k].spreading
    return change


@inlined
def stored_beside(contacts, k, axes):
    """Energy of the contact k that is not stored in links, J."""
    return stored_along(contacts, k) + 0.5 * contacts[k].firm * bent(contacts, k, axes)


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
