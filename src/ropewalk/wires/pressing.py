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
from ropewalk.wires.journey import Journey
from ropewalk.wires.mesh import Riders
from ropewalk.wires.plan import Array


@dataclass(frozen=True)
class Pressing:
    """All loads at one instant, as their contacts press: F = given - stiffness H, upwards on the wires."""

    given: Array  # (contact,) N
    stiffness: Array  # (contact, contact) N/m
    shift: Array  # (rider coordinate,) m, of all coordinates one after the other where all wires are at height 0
    follow: Array  # (rider coordinate, contact) by which they follow the heights of the wires

    def coordinates(self, height: Array) -> Array:
        """Coordinates of all riders, one rider after the other, m."""
        return self.shift + self.follow @ height


def pressing(
    journeys: Sequence[Journey],
    riders: Riders,
    t: float,
    local: Array,
    rough: Array,
    on: NDArray[np.bool_],
    ground: Array,
) -> Pressing:
    """How loads press at an instant.

    Args:
        journeys: all loads.
        riders: the same as arrays.
        t: s.
        local: (contact,) m/N, compliance of the wires beside their splines, as `riders.local_under` has it.
        rough: (contact,) m, heights that are added to the wires.
        on: (contact,) whether it touches a wire, or the ground; what does not presses with nothing.
        ground: (contact,) m, height of the ground under contacts beside their wires; NaN: it is on its wire.

    Raises:
        EquilibriumError: nothing determines how a load stands.
    """
    count, instant = riders.owner.size, np.array([t])
    given, stiffness = np.zeros(count), np.zeros((count, count))
    shift, follow = [], []
    for i, journey in enumerate(journeys):
        n = int(riders.size[i])
        mine = np.flatnonzero((riders.owner == i) & on)
        own = np.broadcast_to(journey.given(instant), (1, int((riders.owner == i).sum())))[0]
        own = own[on[riders.owner == i]]
        rest, row = riders.rest[mine], riders.row[mine, :n]
        given[mine] = own + (rest if n else 0.0)
        if not n:
            continue
        yields = local[mine] + 1.0 / riders.spring[mine]
        # K q + row' c = push;  row q - yields c = H + rough + local (rest + own) - base,  F = rest + own + c
        A = np.block([[riders.stiffness[i, :n, :n], row.T], [row, -np.diag(yields)]])
        push = np.broadcast_to(journey.push(instant), (1, n))[0]
        right = np.concatenate([push, rough[mine] + local[mine] * (rest + own) - riders.base[mine]])
        try:
            inverse = linalg.inv(A)
        except linalg.LinAlgError:
            raise EquilibriumError(
                f"load {journey.rider.name}: nothing keeps it where it stands; check its springs and wheels"
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
