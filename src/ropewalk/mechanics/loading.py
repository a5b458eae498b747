"""The loads of a scenario as arrays, whatever mesh they travel on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.mechanics.assembly import axes_of, loads_of
from ropewalk.mechanics.chain import Array, Loads, Strands
from ropewalk.mechanics.contact_points import ContactPoint, wheels_of
from ropewalk.mechanics.multibody_system import MultibodySystem, multibody_system_of
from ropewalk.model.load import GivenForces
from ropewalk.model.scenario import Scenario


@dataclass(frozen=True)
class Loading:
    """All loads."""

    axes: tuple[str, ...]
    gravity: Array  # (axis,) m/s^2
    wheels: tuple[ContactPoint, ...]
    loads: Loads
    multibody_system: MultibodySystem | None  # what has a mass; None if nothing has


def loading_of(
    scenario: Scenario, until: float, strands: Strands | None = None, axes: tuple[str, ...] | None = None
) -> Loading:
    """Put together all loads of a scenario.

    Args:
        scenario: what is there.
        until: how long their histories are needed, s.
        strands: chains that they travel on, if they do; some of what they are there depends on the mesh.
        axes: names of the axes, if not those that the scenario needs.

    Raises:
        RopewalkError: the matrices of a load cannot be used.
    """
    axes, wheels = axes or axes_of(scenario), tuple(wheels_of(scenario))
    gravity = np.zeros(len(axes))
    gravity[-1] = -scenario.gravity
    forces_only = all(isinstance(load, GivenForces) for load in scenario.loads.values())
    multibody_system = None if forces_only else multibody_system_of(scenario, wheels, strands, axes, until)
    return Loading(axes, gravity, wheels, loads_of(scenario, wheels, until, axes), multibody_system)
