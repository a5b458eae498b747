"""Pantographs as the constant force with which they press in the mean: a task that no scenario can say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ropewalk.compare.trace import Trace, load_of
from ropewalk.errors import RopewalkError
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.scenario import Scenario
from ropewalk.wires.plan import Array, Contact, TravellingLoad
from ropewalk.wires.prescribed_motion import PrescribedMotion
from ropewalk.wires.task import WireTask
from ropewalk.wiring import task_of


def pressing_task(scenario: Scenario, found: Mapping[str, Trace]) -> WireTask:
    """The task of a scenario with pantographs, each of which presses with its mean force and nothing else.

    Args:
        scenario: with overhead lines, in motion.
        found: what its contacts do in full, in the spans where statistics are made.

    Raises:
        RopewalkError: other loads travel as well.
    """
    task = task_of(scenario)
    if len(task.contacts) > len(task.prescribed_motions):
        raise RopewalkError(
            "pantographs with several contacts, below lines that overlap or with two strips, are not supported by "
            "compare; leave overlap and head out"
        )
    prescribed_motions = []
    for prescribed_motion, name in zip(task.prescribed_motions, task.contacts, strict=True):
        load = load_of(scenario, name)
        if not isinstance(load, Pantograph):
            raise RopewalkError(f"load {name} together with pantographs is not supported by compare; leave it out")
        mean = float(np.nanmean(found[name].force[:, -1]))
        prescribed_motions.append(_pressed(prescribed_motion, mean, load.ramp))
    return replace(task, prescribed_motions=tuple(prescribed_motions), displayed=())


def _pressed(prescribed_motion: PrescribedMotion, force: float, ramp: float) -> PrescribedMotion:
    """A constant force in N on the way of a pantograph, which grows as the forces on the pantograph do."""
    none = np.zeros((0, 0))
    contact = Contact(prescribed_motion.moving_load.contacts[0].wire, stiffness=0.0)
    moving_load = TravellingLoad(prescribed_motion.moving_load.name, none, none, none, (contact,))

    def given(times: Array) -> Array:
        grown = np.clip(times / ramp, 0.0, 1.0) if ramp > 0.0 else np.ones_like(times)
        return (force * grown)[:, None]

    return PrescribedMotion(moving_load, prescribed_motion.place, given=given)
