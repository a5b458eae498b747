"""A model as plain arrays: strands of nodes and links, the loads on them, and their state.

All lines are kept in one array of nodes, one strand after the other; node i of a strand and node i + 1 share
link i. Between the last node of one strand and the first of the next lies a link that does not exist and whose
force stays zero, so that loops may run over everything at once. The first and the last node of a strand stand on
supports.

State: `r` are positions (axis, node). `w` are velocities **of the material** (axis, node). A node that rides with
a load has the material coordinate `X` of the load; all others keep theirs. See docs/notes/travelling-node.md.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

MATERIAL, SLIP, ARC, HORIZONTAL = 0, 1, 2, 3
REFUSE, LEAVE, STAY = 0, 1, 2
CLAMPED, FRICTIONLESS = 0, 1
# Clamped, but never riding: the force is always shared by the two nodes of its link. This converges to a wrong limit
# and is here to be compared with.
SHARING = 2
# Held by friction, as far as it suffices; sliding with friction in full. Slow motion only.
COULOMB, DRAGGED = 3, 4
CAPSTAN, BLOCK = 0, 1
OFF, SHARED = -2, -1  # values of `moving_load` for a load off the line, or shared by the two nodes of its link

# Entries of `work`: what has been done or lost since the start, in J.
LINE_DAMPING, LOAD_WORK, HOLD_WORK, CONTACT, SUPPORT_WORK = 0, 1, 2, 3, 4
FRICTION, DRIVE, LOAD_DAMPING = 5, 6, 7  # of bodies: lost along the line, given by drives, lost in dampers and air
WORKS = 8


class Strands(NamedTuple):
    """What does not change while the lines move: one entry for each line."""

    first: Integers  # index of the first node
    links: Integers  # number of links
    h: Array  # unstrained length of a link, m
    rho: Array  # mass per unstrained length, kg/m
    law: Array  # (strand, parameter), see law.py
    damping: Array  # Kelvin-Voigt c, N s
    drag: Array  # mass-proportional damping, 1/s
    gravity: Array  # (axis,) m/s^2


class Loads(NamedTuple):
    """What does not change while the loads travel: one entry for each load, tables one after the other."""

    strand: Integers
    measure: Integers
    contact: Integers
    at_end: Integers
    margin: Array  # m, distance from a support at which the line ends for a load that has no place of its own
    speed_first: Integers  # where the load's speed table begins
    speed_count: Integers
    speed_time: Array
    speed_value: Array
    speed_path: Array  # integral of the speed up to each entry
    force_first: Integers
    force_count: Integers
    force_time: Array
    force_value: Array  # (axis, entry)
    friction: Array  # coefficient, NaN where none is given
    friction_model: Integers


class Supports(NamedTuple):
    """What holds the ends of the strands: entries 2 s and 2 s + 1 for the start and the end of strand s."""

    place: Array  # (end, axis) m
    free: Array  # (end, axis, axis) projection onto the directions in which the end may move
    stiffness: Array  # (end, axis, axis) N/m, within the free directions
    damping: Array  # (end, axis, axis) N s/m
    mass: Array  # (end,) kg
    force: Array  # (end, axis) N, constant
    motion_first: Integers  # where the support's table begins
    motion_count: Integers
    motion_time: Array
    motion_value: Array  # (axis, entry) m, displacement from `place`


class ChainState(NamedTuple):
    """All that changes: the state of motion and what has been done so far."""

    t: Array  # (1,) s
    r: Array  # (axis, node) m
    w: Array  # (axis, node) m/s, of the material
    X: Array  # (node,) m, material coordinate
    xi: Array  # (load,) m
    speed: Array  # (load,) m/s, d xi / dt
    moving_load: Integers  # (load,) node that rides with the load, or SHARED, or OFF
    hold: Array  # (load,) N s, impulse of the hold force (along x) since the start
    work: Array  # (WORKS,) J

    def copy(self) -> ChainState:
        """An independent copy."""
        return ChainState(*(array.copy() for array in self))  # type: ignore[arg-type]


class ChainBuffers(NamedTuple):
    """Room for a step, so that the loop allocates nothing."""

    per_length: Array  # (link,) 1/m, one over the length of each link when it was last looked at
    q: Array  # (link,) N/m, tension over length of each link, of laws that are no cubic
    f: Array  # (axis, link) N, force vector of each link
    ahead: Array  # (axis, node) m/s, velocities extrapolated to the instant of the positions (damped lines only)
    target: Array  # (load,) m, xi at which the load's location on the chain has to change next
    dr: Array  # (axis, load) m, r_c - r_a before a drift
    dw: Array  # (axis, load) m/s, w_c - w_a before a kick
    beside: Array  # (2, load) N, tension of the links behind and ahead of a riding node
    before: Array  # (load,) m/s, w along x of riding nodes before a kick
    point: Array  # (axis,)
    velocity: Array  # (axis,)
    axes: tuple[int, ...]  # their numbers: how many there are is known when the loop is compiled

    @staticmethod
    def for_state(state: ChainState) -> ChainBuffers:
        """Buffers of the right size."""
        dim, loads = state.r.shape[0], state.xi.size
        location, one, axes = np.zeros((dim, loads)), np.zeros(loads), np.zeros(dim)
        return ChainBuffers(
            np.zeros(state.X.size),
            np.zeros(state.X.size),
            np.zeros_like(state.r),
            state.w.copy(),
            one,
            location,
            location.copy(),
            np.zeros((2, loads)),
            one.copy(),
            axes,
            axes.copy(),
            tuple(range(dim)),
        )
