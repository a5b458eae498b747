"""Estimate: how far a result is from the continuum, by itself on three meshes (L. F. Richardson)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.mechanics.chain import Array

LOWEST, HIGHEST = 0.5, 4.0
"""Orders of the mesh that are believed, and the largest that is used: sudden loads leave 1 in the mean over points and
instants (0.7 in the largest error), what is chaotic 0.4 and less; no engine has more than 4."""
STRETCHES = 4  # of the time, of whose orders the median is taken
NOTHING = 1e-3  # of all changes: a stretch in which less of them is says nothing
_HALVINGS = 60  # of the interval in which an order is sought


@dataclass(frozen=True)
class Estimate:
    """The error of the finest of three meshes.

    Args:
        error: m, the largest distance of a point from the continuum; of an order that is not believed, from the
            coarser meshes.
        order: with which the changes from mesh to mesh get smaller.
        alike: cosine of the angle between both changes: near one, the place that they lead to is better than that of
            the finest mesh.
        doubt: why it promises nothing; empty if it does.
    """

    error: float
    order: float
    alike: float
    doubt: str = ""

    def next(self, ratio: float) -> float:
        """What the error of a mesh with so many times the elements would be, m."""
        return self.error / float(ratio ** min(self.order, HIGHEST))

    @classmethod
    def of(cls, sizes: tuple[float, float, float], first: Array, second: Array) -> Estimate:
        """The estimate of changes.

        With the error `C h^p` changes are `C (h1^p - h2^p)` and `C (h2^p - h3^p)`: their quotient gives p, and the
        largest of the last ones then C. The order is that of all points and instants, in which what converges worst
        weighs most, or the median of four stretches of time if that is less: one in which a coarse mesh was
        far off, as at a sudden start, looks like a high order.

        Args:
            sizes: of the links, from coarse to fine, in any unit.
            first: (time, point, axis) m, from the first mesh to the second.
            second: the same from the second to the third.
        """
        both = min(len(first), len(second))
        first, second = first[:both], second[:both]
        there = np.isfinite(first) & np.isfinite(second)
        a, b = np.where(there, first, 0.0), np.where(there, second, 0.0)
        before, now = _size(a), _size(b)
        largest = [float(np.linalg.norm(change, axis=-1).max(initial=0.0)) for change in (a, b)]
        if now == 0.0:
            return cls(0.0, np.nan, np.nan)
        segments = zip(np.array_split(a, STRETCHES), np.array_split(b, STRETCHES), strict=True)
        orders = [_order(sizes, _size(x) / _size(y)) for x, y in segments if _size(y) > NOTHING * now]
        order = min(_order(sizes, before / now), float(np.median(orders)))
        alike = float((a * b).sum()) / (before * now) if before else 0.0
        if not order >= LOWEST:
            doubt = f"from mesh to mesh positions change by up to {largest[0]:.3g} m and then {largest[1]:.3g} m"
            return cls(max(largest), order, alike, f"{doubt}: they do not converge as meshes get finer")
        p = min(order, HIGHEST)
        rest = sizes[2] ** p / (sizes[1] ** p - sizes[2] ** p)
        return cls(rest * largest[1], order, alike)


def _size(change: Array) -> float:
    return float(np.linalg.norm(change))


def _order(sizes: tuple[float, float, float], quotient: float) -> float:
    """The order p that solves (h1^p - h2^p) / (h2^p - h3^p) = quotient; -inf below any that is looked for."""
    low, high = -8.0, 16.0

    def short(p: float) -> bool:
        h1, h2 = sizes[0] / sizes[2], sizes[1] / sizes[2]
        return bool((h1**p - h2**p) / (h2**p - 1.0) < quotient)

    if not short(low):
        return -np.inf
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if short(middle) else (low, middle)
    return 0.5 * (low + high)
