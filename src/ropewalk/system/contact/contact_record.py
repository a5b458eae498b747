"""A contact as a record: what touches, where it is on its line, and what acts there."""

from __future__ import annotations

import numpy as np

from ropewalk.system.elements.spline import WIDTH

FORCE, BODY = 0, 1  # what touches: a given force, or coordinates that move
AWAY, ON, GONE = 0, 1, 2  # not on its line, on it, off it with all of its load, for good
PRESCRIBED, FREE = 0, 1  # how it advances along its line
NOT, STANDS, DRAGGED = 0, 1, 2  # how a given force rubs: not at all, as far as it needs to, or in full

_REAL, _CODE, _VECTOR = "f8", "i8", ("f8", (3,))
CONTACT = np.dtype(
    [
        ("line", _CODE),
        ("load", _CODE),
        ("kind", _CODE),
        ("first", _CODE),  # of a body: its first coordinate, one for each axis; some contacts may carry the same one
        ("aside", *_VECTOR),  # m, from the body to what touches
        ("moved", _CODE),  # 1: its body is moved along x as prescribed, while it rolls
        ("origin", _REAL),  # m, where that is at time zero
        ("goes", _REAL),  # m/s, how fast it is moved
        ("lift", _CODE),  # 0: it cannot leave its line; 1: it runs above it, -1: below
        ("clear", _CODE),  # 1: off its line it touches nothing; 0: there is level ground
        ("apart", _CODE),  # 1: it has left its line and is in the air
        ("was_apart", _CODE),  # when it was last looked at
        ("flown", _REAL),  # s, for which it has been there
        ("frictionless", _CODE),  # of prescribed travel: 1: a horizontal force holds it across its line
        ("rolls", _CODE),  # 1: it follows the profile of its line
        ("rubs", _CODE),  # of a given force: how, see friction.py
        ("travel", _CODE),  # PRESCRIBED or FREE
        ("measure", _CODE),  # what its speed counts, see mechanics/chain.py
        ("begin", _REAL),  # m, what it counts from at time zero
        ("friction", _REAL),  # coefficient
        ("block", _CODE),  # 1: friction of a point, 0: of a line that bends around it
        ("rolling", _REAL),  # coefficient
        ("viscous", _REAL),  # N s/m
        ("driver", _REAL),  # N, the most that holds its speed
        ("brake", _REAL),  # N
        ("braking", _REAL),  # N s/m, of a brake whose force grows with speed up to that; 0: it is constant
        ("spring", _REAL),  # N/m, of the brake
        ("brake_low", _REAL),  # m, s below which it brakes
        ("brake_high", _REAL),  # m, s above which it brakes
        ("drive_first", _CODE),
        ("drive_count", _CODE),
        ("drive", _REAL),  # N along the line, of drive and driver
        ("speed_first", _CODE),  # where its tables begin, and how many entries they have
        ("speed_count", _CODE),
        ("force_first", _CODE),
        ("force_count", _CODE),
        ("margin", _REAL),  # m, that is left of the line where it leaves
        ("state", _CODE),
        ("led", _CODE),  # 1: a guide puts it on its line and takes it off
        ("stays", _CODE),  # 1: it stops at an end of its line, 0: it leaves there
        ("refuses", _CODE),  # 1: the motion ends where it would leave
        ("been", _CODE),  # 1: it has been on its line
        ("restrained", _CODE),  # 1: it is stopped at an end
        ("comes", _CODE),  # 1: it has just come there, -1: left
        ("stopped", _REAL),  # m/s, that it had when it was stopped
        ("overrun", _REAL),  # m, of s, by which it had gone on by then
        ("run", _CODE),
        ("near", _CODE),  # first node that shares its point
        ("x", _REAL),  # links along its run
        ("speed", _REAL),  # m/s along the line, of s
        ("measured", _REAL),  # m/s, the same as it is measured
        ("weight", "f8", (WIDTH,)),
        ("slope", "f8", (WIDTH,)),  # per link
        ("second", "f8", (WIDTH,)),  # per link squared
        ("link", "i8", (3,)),
        ("h", "f8", (3,)),  # m, of these
        ("part", "f8", (3,)),
        ("change", "f8", (3,)),  # of the parts, per link
        ("rough", _REAL),  # m, height of the profile there
        ("steep", _REAL),  # its slope
        ("p", *_VECTOR),  # m, point of the spline, and the profile above it
        ("along", *_VECTOR),  # its derivative by s
        ("tangent", *_VECTOR),  # unit vector t along the line, without its profile
        ("turns", *_VECTOR),  # 1/m, change of that with s
        ("spread", _REAL),  # length of the derivative by s, without its profile
        ("spreading", _REAL),  # 1/m, change of that with s
        ("aligned", _REAL),  # how far the line has a direction there: 1, less where its links are crushed
        ("aligning", _REAL),  # change of that with `spread`
        ("place", *_VECTOR),  # m, of what touches
        ("before", *_VECTOR),  # m, when it was last looked at
        ("last", *_VECTOR),  # N, given force then
        ("d", *_VECTOR),  # m, of the kink
        ("axial", _REAL),  # m, e: by which what touches is ahead along the line
        ("axial_stiffness", _REAL),  # N/m, S_a; 0: d has all directions
        ("easing", _REAL),  # N/m, by which e is damped where only steps let it be: over the step, N s/m
        ("axial_before", _REAL),  # m, e a step before
        ("axial_booked", _REAL),  # m, e when it was last looked at
        ("eased", _REAL),  # N, what damped it then
        ("slips", _REAL),  # part of its force along its line that friction and drives have found: of `hauls`, N
        ("hauls", _REAL),
        ("lent", _REAL),  # kg, of what has no mass on an inextensible line, which lends it; 0: it has its own
        ("given", *_VECTOR),  # N, given force
        ("hauled", *_VECTOR),  # N, what a hauling rope adds to it
        ("hold", _REAL),  # N, horizontal force that holds it across its line
        ("N", *_VECTOR),  # N on the line
        ("tension", _REAL),  # N, mean of the links below
        ("by_tension", _REAL),  # 1/m, dS/dT of a kink at rest
        ("curve", _REAL),  # 1/(m N), d2S/dT2 of a kink at rest
        ("firm", _REAL),  # N/m, S - T dS/dT: what is not stored in links
        ("moving", _REAL),  # N/m, S of the kink as it is carried along
        ("rise", _REAL),  # N/m^3, what N changes by as the tension rises, over the product of two components of d
        ("carried", _REAL),  # N/m, S at rest less S carried along
        ("was", *_VECTOR),  # m, d when it was last looked at
        ("lagged", *_VECTOR),  # N, `carried` times d then
        ("was_axial", _REAL),  # J, energy stored along the line then
        ("kink", _REAL),  # m^2, K
        ("kappa", _REAL),  # of its place without bending, for which it was sought last, see compliance.py
        ("beside", "f8", (3,)),  # m^2, what other kinks add to l^2/2 of the links below
        ("shares_links", _CODE),  # 1: others stand on these, too
        ("fade", _REAL),  # m^2/s, by which it straightens after the contact has left
        ("turn", _REAL),  # J/m, change of the energy of the kink with s, beside that of p
        ("push", _REAL),  # N, change of all energy with s: what it takes to move it along
        ("pushed", _REAL),  # N, when it was last looked at; as of the next ones
        ("was_at", _REAL),  # m, s
        ("driven", _REAL),  # N
        ("restrained_by", _REAL),  # N
        ("evened", _REAL),  # N, what holds a body without friction beside `hold`, as of late
        ("stretch", _REAL),  # of the line at the contact, as its speed is measured
        ("step", _REAL),  # s, of the motion: what gives way within it keeps a stiff contact stable
        ("light", _REAL),  # 1/kg, about what a force accelerates above it
        ("least", _REAL),  # m/N, by which a contact without mass gives way at a support
    ],
    align=True,
)
