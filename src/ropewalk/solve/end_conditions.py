"""The two ends of a strand at an instant: where they are held, how softly, and what else pulls at them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ropewalk.mechanics.chain import Array, Supports

# Stiffness lent to a direction in which nothing holds an end, as a part of that of the line: the place of the spring
# follows the end until it carries nothing.
LENT = 1e-6


@dataclass(frozen=True)
class EndConditions:
    """The ends of a strand: entries 0 and 1 for its start and its end."""

    place: Array  # (2, axis) m
    stiffness: Array  # (2, axis, axis) N/m, within the free directions
    free: Array  # (2, axis, axis) projections onto the directions in which the ends may move
    force: Array  # (2, axis) N, constant forces and weights of the masses there

    @staticmethod
    def fast(start: Array, end: Array) -> EndConditions:
        """Two points that do not move, (axis,) m each."""
        dim = start.size
        nothing = np.zeros((2, dim, dim))
        return EndConditions(np.stack([start, end]), nothing, nothing, np.zeros((2, dim)))

    @cached_property
    def is_fast(self) -> bool:
        """Whether neither end can move."""
        return not self.free.any()

    @cached_property
    def rigid(self) -> Array:
        """Compliances of two points that do not move: nothing (2, axis, axis)."""
        return np.zeros_like(self.stiffness)

    def compliance(self, scale: float) -> tuple[Array, Array]:
        """Compliances (2, axis, axis) in m/N, and projections (2, axis, axis) onto directions held by nothing.

        Args:
            scale: stiffness of the line, N/m, of which a part is lent to directions held by nothing.
        """
        soft, loose = np.zeros_like(self.stiffness), np.zeros_like(self.stiffness)
        for end in range(2):
            if not self.free[end].any():
                continue
            sizes, axes = np.linalg.eigh(self.free[end])
            axes = axes[:, sizes > 0.5]
            values, vectors = np.linalg.eigh(axes.T @ self.stiffness[end] @ axes)
            for value, vector in zip(values, (axes @ vectors).T, strict=True):
                ray = np.outer(vector, vector)
                if value > 1e-12 * scale:
                    soft[end] += ray / value
                else:
                    soft[end] += ray / (LENT * scale)
                    loose[end] += ray
        return soft, loose


def ends_at(supports: Supports, s: int, t: float, gravity: Array) -> EndConditions:
    """What holds strand s at time t in s."""
    both = slice(2 * s, 2 * s + 2)
    place = supports.place[both].copy()
    for end, entry in enumerate((2 * s, 2 * s + 1)):
        table = slice(supports.motion_first[entry], supports.motion_first[entry] + supports.motion_count[entry])
        place[end] += [np.interp(t, supports.motion_time[table], row[table]) for row in supports.motion_value]
    weight = supports.mass[both, None] * gravity
    return EndConditions(place, supports.stiffness[both], supports.free[both], supports.force[both] + weight)
