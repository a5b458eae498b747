"""Hauling ropes of carriages: what they pull with at both of their ends, from the forces on their carriages."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.hanging_rope import hang_by_tension_entry
from ropewalk.model.carriage import Haul
from ropewalk.results.frame import Array


class Hauling(NamedTuple):
    """Tensions of a hauling rope and its counter rope, (instant,) N."""

    pull: Array  # of the hauling rope at the carriage
    drive: Array  # of the same at the drive
    counter: Array  # of the counter rope at the carriage
    slack_side: Array  # at the drive, on the side of the counter weight

    @property
    def ratio(self) -> Array:
        """Tension of the one side of the drive over that of the other, 1 or more, (instant,)."""
        one, other = np.maximum(self.drive, 1e-300), np.maximum(self.slack_side, 1e-300)
        return np.asarray(np.maximum(one / other, other / one))


def hauling(haul: Haul, gravity: float, force: Array, place: Array, line: Array) -> Hauling:
    """Tell the forces of both ropes at a carriage apart, and give those at the drive.

    Along a rope that hangs, T + T^2/(2 EA) - w z is the same; on rollers T - w z is.

    Args:
        haul: what is declared.
        gravity: m/s^2.
        force: (instant, axis) N, on the carriage, of both ropes together.
        place: (instant, axis) m, the middle of its wheels.
        line: (instant, node, axis) m.
    """
    to = 1.0 if haul.to == "end" else -1.0
    drive, station = (line[:, -1], line[:, 0]) if haul.to == "end" else (line[:, 0], line[:, -1])
    w, rise = haul.mass * gravity, drive[:, -1] - place[:, -1]
    back = np.zeros_like(force)
    tension = v = 0.0
    if haul.counter is not None:
        tension, v = haul.counter.tension, haul.counter.mass * gravity
        back = _counter_pull(haul, tension, v, station - place)
    if haul.sags:
        pull = np.linalg.norm(force - back, axis=1)
        constant = pull + pull**2 / (2.0 * haul.axial_stiffness) + w * rise
        at_drive = 2.0 * constant / (1.0 + np.sqrt(1.0 + 2.0 * constant / haul.axial_stiffness))
    else:  # both along the line, in opposite directions
        ahead = np.sign((force * (line[:, -1] - line[:, 0])).sum(axis=1))
        pull = to * ahead * np.linalg.norm(force, axis=1) + np.linalg.norm(back, axis=1)
        at_drive = pull + w * rise
    counter = np.linalg.norm(back, axis=1)
    return Hauling(pull, at_drive, counter, tension + v * (drive[:, -1] - station[:, -1]))


def _counter_pull(haul: Haul, tension: float, weight: float, away: Array) -> Array:
    """Pull of a counter rope at a carriage whose station is so far away in m, (instant, axis) N."""
    if not haul.sags:
        pull = np.maximum(tension - weight * away[:, -1], 0.0)
        return np.asarray(pull[:, None] * away / np.linalg.norm(away, axis=1)[:, None])
    far = np.linalg.norm(away[:, :-1], axis=1)
    both = [hang_by_tension_entry(x, z, tension, weight) for x, z in zip(far, away[:, -1], strict=True)]
    level, up = np.array(both).T
    return np.column_stack([(level / far)[:, None] * away[:, :-1], up])
