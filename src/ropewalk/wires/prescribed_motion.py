"""Prescribed motions: where moving loads are and what is put on them, at any time; from them, what drives a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from ropewalk.wires.plan import Array, TravellingLoad, WirePlan
from ropewalk.wires.step_inputs import ABSENT, ON_GROUND, ON_WIRE, StepInputs


def _nothing(times: Array) -> Array:
    return np.zeros((times.size, 1))


@dataclass(frozen=True)
class PrescribedMotion:
    """What a moving load does, of which the wires know nothing. Times in s."""

    moving_load: TravellingLoad
    place: Callable[[Array], Array]  # times to the station of the moving load, m
    push: Callable[[Array], Array] = _nothing  # times to forces on the coordinates, (time, coordinate or 1) N
    given: Callable[[Array], Array] = _nothing  # times to forces upwards on the wire, (time, contact or 1) N
    first: Array = field(default_factory=lambda: np.zeros(0))  # (coordinate,) m at the beginning
    rate: Array = field(default_factory=lambda: np.zeros(0))  # (coordinate,) m/s at the beginning
    stands: bool = False  # whether both are those of a load at rest on its contacts, which follow the wires at rest
    settled: float = 0.0  # s, from which the speed is constant
    beside: int = ABSENT  # before the start of the wire and beyond its end: ABSENT, or ON_GROUND


def inputs_of(plan: WirePlan, prescribed_motions: Sequence[PrescribedMotion], times: Array) -> StepInputs:
    """What is given at times, s."""
    most = max((prescribed_motion.moving_load.size for prescribed_motion in prescribed_motions), default=0)
    station, where, rough, given, aside = [], [], [], [], []
    push = np.zeros((times.size, len(prescribed_motions), most))
    for i, prescribed_motion in enumerate(prescribed_motions):
        place, contacts = prescribed_motion.place(times), prescribed_motion.moving_load.contacts
        push[:, i, : prescribed_motion.moving_load.size] = prescribed_motion.push(times)
        own = np.broadcast_to(prescribed_motion.given(times), (times.size, len(contacts)))
        for k, contact in enumerate(contacts):
            here, length = place - contact.behind, plan.wires[contact.wire].length
            on = (here >= 0.0) & (here <= length)
            station.append(here)
            where.append(np.where(on, ON_WIRE, prescribed_motion.beside))
            rough.append(np.where(on, contact.rough(here), 0.0))
            aside.append(np.where(on, contact.aside(here), 0.0))
            given.append(np.where(on, own[:, k], 0.0))
    none = np.zeros((times.size, 0))
    return StepInputs(
        np.column_stack([none, *station]), np.column_stack([none, *where]).astype(np.int64),
        np.column_stack([none, *rough]), np.column_stack([none, *given]), push,
        np.array(times, dtype=np.float64), np.column_stack([none, *aside]),
    )  # fmt: skip


__all__ = ["ABSENT", "ON_GROUND", "PrescribedMotion", "inputs_of"]
