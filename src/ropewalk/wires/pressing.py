"""How loads at rest press on their wires, as a function of the heights of these.

The forces are linear in the heights H: F = given - stiffness H. All springs, rigid contacts and levers of a load have
gone into the two, and so has what a wire yields beside its spline.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg as linalg
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.wires.mesh import MovingLoads
from ropewalk.wires.plan import Array
from ropewalk.wires.prescribed_motion import PrescribedMotion


@dataclass(frozen=True)
class Pressing:
    """All loads at one instant, as their contacts press: F = given - stiffness H, upwards on the wires."""

    given: Array  # (contact,) N
    stiffness: Array  # (contact, contact) N/m
    shift: Array  # (moving load coordinate,) m, of all coordinates one after the other where all wires are at height 0
    follow: Array  # (moving load coordinate, contact) by which they follow the heights of the wires

    def coordinates(self, height: Array) -> Array:
        """Coordinates of all moving loads, one moving load after the other, m."""
        return self.shift + self.follow @ height


def pressing(
    prescribed_motions: Sequence[PrescribedMotion],
    moving_loads: MovingLoads,
    t: float,
    local: Array,
    rough: Array,
    aside: Array,
    on: NDArray[np.bool_],
    ground: Array,
) -> Pressing:
    """How loads press at an instant.

    Args:
        prescribed_motions: all loads.
        moving_loads: the same as arrays.
        t: s.
        local: (contact,) m/N, compliance of the wires beside their splines, as `moving_loads.local_under` has it.
        rough: (contact,) m, heights that are added to the wires.
        aside: (contact,) m, how far the wires are to the left of the middle of their loads.
        on: (contact,) whether it touches a wire, or the ground; what does not presses with nothing.
        ground: (contact,) m, height of the ground under contacts beside their wires; NaN: it is on its wire.

    Raises:
        EquilibriumError: nothing determines how a load stands.
    """
    count, instant = moving_loads.owner.size, np.array([t])
    given, stiffness = np.zeros(count), np.zeros((count, count))
    shift, follow = [], []
    for i, prescribed_motion in enumerate(prescribed_motions):
        n = int(moving_loads.size[i])
        mine = np.flatnonzero((moving_loads.owner == i) & on)
        own = np.broadcast_to(prescribed_motion.given(instant), (1, int((moving_loads.owner == i).sum())))[0]
        own = own[on[moving_loads.owner == i]]
        rest, row = moving_loads.rest[mine], moving_loads.rows(aside)[mine, :n]
        given[mine] = own + (rest if n else 0.0)
        if not n:
            continue
        yields = local[mine] + 1.0 / moving_loads.spring[mine]
        # K q + row' c = push;  row q - yields c = H + rough + local (rest + own) - base,  F = rest + own + c
        A = np.block([[moving_loads.stiffness[i, :n, :n], row.T], [row, -np.diag(yields)]])
        push = np.broadcast_to(prescribed_motion.push(instant), (1, n))[0]
        right = np.concatenate([push, rough[mine] + local[mine] * (rest + own) - moving_loads.base[mine]])
        try:
            inverse = linalg.inv(A)
        except linalg.LinAlgError:
            raise EquilibriumError(
                f"load {prescribed_motion.moving_load.name}: nothing keeps it where it stands; check its "
                f"springs and wheels"
            ) from None
        given[mine] += (inverse @ right)[n:]
        stiffness[np.ix_(mine, mine)] = -inverse[n:, n:]
        shift.append((inverse @ right)[:n])
        follow.append(np.zeros((n, count)))
        follow[-1][:, mine] = inverse[:n, n:]
    moved, all_follow = np.concatenate([np.zeros(0), *shift]), np.concatenate([np.zeros((0, count)), *follow])
    beside = np.isfinite(ground)
    given -= stiffness[:, beside] @ ground[beside]
    moved = moved + all_follow[:, beside] @ ground[beside]
    stiffness[beside], stiffness[:, beside], given[beside], all_follow[:, beside] = 0.0, 0.0, 0.0, 0.0
    return Pressing(given, stiffness, moved, all_follow)
