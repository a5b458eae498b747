"""Feet on the system: which of them stand where a table says, and which are put down by a controller."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.mechanics.footfall import footfalls
from ropewalk.mechanics.loading import Loading
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.load import AnyLoad, ExternalModel
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.walker import Walker
from ropewalk.system.contact.tables import Tables
from ropewalk.system.elements.structure import Structure


def steps_by_table(load: AnyLoad) -> bool:
    """Whether it is known beforehand where the feet of a load stand, and nothing of it stands on them."""
    return isinstance(load, Footsteps) and load.balance is None


def is_led(load: AnyLoad) -> bool:
    """Whether a controller puts down and takes up the contacts of a load."""
    return isinstance(load, Walker | ExternalModel | Footsteps) and not steps_by_table(load)


def with_steps(scenario: Scenario, loading: Loading, structure: Structure, contacts: Any, tables: Tables) -> Tables:
    """Add the places of feet, which stand where they have landed, and are nowhere while in the air."""
    for name, load in scenario.loads.items():
        if not (isinstance(load, Footsteps) and steps_by_table(load)):
            continue
        feet = [k for k, wheel in enumerate(loading.wheels) if wheel.load == name]
        length = float(structure.lines.length[contacts[feet[0]]["line"]])
        for number, k in enumerate(feet):
            time, place = footfalls(load, number, length, _until(scenario))
            contacts[k]["speed_first"], contacts[k]["speed_count"] = tables.speed_time.size, time.size
            contacts[k]["begin"] = 0.0
            tables = tables._replace(
                speed_time=np.concatenate([tables.speed_time, time]),
                speed_value=np.concatenate([tables.speed_value, np.zeros(time.size)]),
                speed_path=np.concatenate([tables.speed_path, place]),
            )
    return tables


def _until(scenario: Scenario) -> float:
    return scenario.run.until if isinstance(scenario.run, Dynamic) else 0.0
