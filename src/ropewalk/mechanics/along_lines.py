"""What a line has along it: means over the parts of it that belong to its nodes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.model.line import Line


def mean_along(line: Line, key: str, station: Array, of: Callable[[float], float] = float) -> Array:
    """Mean over the half links beside each node of what a line has along it, or of a function of that.

    Args:
        line: with or without segments.
        key: mass, bending_stiffness or foundation.
        station: (node,) m, evenly spaced from the start to the end.
        of: of the value, for example its inverse.
    """
    usual = float(getattr(line, key))
    half = 0.5 * (station[1] - station[0])
    low, high = np.maximum(station - half, station[0]), np.minimum(station + half, station[-1])
    out = np.full(station.size, of(usual))
    for segment in line.segments.values():
        inside = np.maximum(np.minimum(high, segment.end) - np.maximum(low, segment.start), 0.0) / (high - low)
        out += inside * (of(segment.value(key, usual)) - of(usual))
    return out


def bending_along(line: Line, station: Array) -> Array:
    """Bending stiffness at nodes in N m^2, (node,): what is there turns by the moment as both half links do together.

    Args:
        line: with bending stiffness.
        station: (node,) m, evenly spaced from the start to the end.
    """
    return 1.0 / mean_along(line, "bending_stiffness", station, lambda EI: 1.0 / EI)
