"""The contact forces of a film as numbers, one line for each load, in a unit that stays the same."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ropewalk.results.display_units import DisplayUnits, decimals
from ropewalk.results.frame import Array

MOST = 6  # loads whose forces are written


class Meter:
    """Writes forces of fixed width, so that numbers do not jump.

    Args:
        names: of the loads; without names for one that is alone.
        forces: (frame, load) N, their sizes; NaN off the line.
        units: that they are shown in.
    """

    def __init__(self, names: Sequence[str], forces: Array, units: DisplayUnits | None = None) -> None:
        self._names, self._forces = names[:MOST], forces[:, :MOST]
        self._unit = (units or DisplayUnits.read(None)).of("N", [self._forces])
        kept = np.abs(self._forces[np.isfinite(self._forces)])
        largest = float(kept.max(initial=0.0)) / self._unit.size or 1.0
        self._decimals = decimals(largest, 3)
        self._width = len(f"{-largest:.{self._decimals}f}")
        self._longest = max(map(len, self._names), default=0)

    def label(self, k: int) -> str:
        """The forces in the k-th frame shown."""
        lines = []
        for name, force in zip(self._names, self._forces[k] / self._unit.size, strict=True):
            number = f"{force:{self._width}.{self._decimals}f}" if np.isfinite(force) else "–".rjust(self._width)
            lines.append(f"{name:{self._longest}} {number} {self._unit.symbol}")
        return "\n".join(lines)
