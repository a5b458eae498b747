"""Ties that fail at rest and in slow motion: what is left takes over, until nothing more fails."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.wires.bearing import Bearing, Borne
from ropewalk.wires.mesh import WireTies
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.rest import ROUNDING

_ALIKE = 1e-6  # of a ratio of force to strength: what is as close to the largest fails with it, and rounding has no say


class Failure(NamedTuple):
    """A tie that has failed."""

    tie: int
    t: float  # s
    force: float  # N, under which it did


@dataclass(frozen=True)
class BorneByTheRest:
    """Wires and loads at rest by what has not failed."""

    borne: Borne
    failed: NDArray[np.bool_]  # (tie,) whether it pulls no more
    failures: tuple[Failure, ...]  # up to here, in their order


def stand_while_ties_fail(bearing: Bearing, t: float, near: Array, before: tuple[Failure, ...] = ()) -> BorneByTheRest:
    """Rest at an instant in s: ties fail one after the other, each under the forces that those before it left.

    What was cut up to then fails first; then that which bears most of its strength, as long as it bears more than all.

    Args:
        t: s.
        near: (3, node) m, a shape close by.
    """
    ties, failures = bearing.mesh.ties, before
    failed = np.zeros(ties.length.size, dtype=np.bool_)
    failed[[failure.tie for failure in before]] = True
    while True:
        found = bearing.stand(t, near, failed)
        which = _next(ties, failed, found.tie_force, t)
        if not which.size:
            return BorneByTheRest(found, failed, failures)
        failures += tuple(Failure(int(i), t, float(found.tie_force[i])) for i in which)
        failed, near = failed.copy(), found.position
        failed[which] = True


def _next(ties: WireTies, failed: NDArray[np.bool_], force: Array, t: float) -> Integers:
    """Which ties are the next ones to fail under some forces in N at t in s."""
    due = np.where(failed, np.inf, ties.fails_at * (1.0 - ROUNDING))
    if due.min(initial=np.inf) <= t:
        return np.flatnonzero(due == due.min())
    part = np.where(failed, 0.0, force / ties.strength)
    most = float(part.max(initial=0.0))
    return np.flatnonzero(part >= (1.0 - _ALIKE) * most) if most > 1.0 else np.empty(0, dtype=np.int64)
