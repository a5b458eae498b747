"""Hauling ropes of carriages: what they pull with at both of their ends, and what slips over their drives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.results.frame import Array


class Hauling(NamedTuple):
    """Tensions of a hauling rope and its counter rope, (instant,) N."""

    pull: Array  # of the hauling rope at the carriage
    drive: Array  # of the same at the drive
    counter: Array  # of the counter rope at the carriage
    slack_side: Array  # at the drive, on the side of the counter weight

    @staticmethod
    def of(tensions: Array) -> Hauling:
        """Those of one carriage, (instant, end of the rope) N."""
        return Hauling(*tensions.T)

    @property
    def ratio(self) -> Array:
        """Tension of the one side of the drive over that of the other, 1 or more, (instant,)."""
        one, other = np.maximum(self.drive, 1e-300), np.maximum(self.slack_side, 1e-300)
        return np.asarray(np.maximum(one / other, other / one))
