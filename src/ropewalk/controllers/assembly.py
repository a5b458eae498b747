"""The controllers of a scenario."""

from __future__ import annotations

import numpy as np

from ropewalk.controllers.balance import Upright
from ropewalk.controllers.carrier import Carrier
from ropewalk.controllers.partner import Partner
from ropewalk.controllers.spring_leg_walker import SpringLegWalker
from ropewalk.controllers.steps import Steps
from ropewalk.external.models import cosimulation_of
from ropewalk.mechanics.loading import Loading
from ropewalk.mechanics.multibody_system import MultibodySystem
from ropewalk.mechanics.sideways import Sideways
from ropewalk.model.fmu import Fmu
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.stepper import Stepper
from ropewalk.model.walker import Walker


def controllers_of(carrier: Carrier, loading: Loading, scenario: Scenario) -> list[Steps | SpringLegWalker | Partner]:
    """The controllers of all loads that need one.

    Raises:
        RopewalkError: the model of a stepper cannot be made.
    """
    multibody_system = loading.multibody_system
    if multibody_system is None:
        return []
    controllers: list[Steps | SpringLegWalker | Partner] = []
    wheels: dict[str, list[int]] = {}
    for k, wheel in enumerate(loading.wheels):
        wheels.setdefault(wheel.load, []).append(k)
    for name, load in scenario.loads.items():
        on = tuple(wheels.get(name, ()))
        if isinstance(load, Footsteps):
            feet = (on[0], on[1])
            upright = _upright(carrier, multibody_system, scenario, load, feet)
            controllers.append(Steps(carrier, name, load, feet, upright))
        elif isinstance(load, Walker):
            controllers.append(_spring_leg_walker(carrier, multibody_system, scenario, name, load, (on[0], on[1])))
        elif isinstance(load, Stepper | Fmu):
            assert isinstance(scenario.run, Dynamic)
            cosimulation = cosimulation_of(name, load, scenario.run.until, len(loading.axes), carrier.reach(on[0]))
            controllers.append(Partner(carrier, cosimulation, on, multibody_system.interface_coordinates.get(name, ())))
    return controllers


def _spring_leg_walker(
    carrier: Carrier,
    multibody_system: MultibodySystem,
    scenario: Scenario,
    name: str,
    load: Walker,
    feet: tuple[int, int],
) -> SpringLegWalker:
    legs = [e for e, tether in enumerate(multibody_system.bodies.tethers) if tether["wheel"] in feet]
    first = int(multibody_system.bodies.tethers[legs[0]]["first"])
    vehicle = int(np.flatnonzero(multibody_system.bodies.vehicles["first"] == first)[0])
    dim = int(multibody_system.bodies.vehicles[vehicle]["coordinates"]) - (load.balance is not None)
    upright = _upright(carrier, multibody_system, scenario, load, feet)
    own = slice(first, first + dim)
    return SpringLegWalker(carrier, name, load, feet, (legs[0], legs[1]), own, upright=upright)


def _upright(
    carrier: Carrier, multibody_system: MultibodySystem, scenario: Scenario, load: Walker | Footsteps,
    feet: tuple[int, int],
) -> Upright | None:  # fmt: skip
    """Who keeps a person upright to the side, if anybody does."""
    if load.balance is None:
        return None
    bodies = multibody_system.bodies
    stands = bodies.vehicles["wheels"][:, None] > np.arange(bodies.wheel.shape[1])
    vehicle = int(np.flatnonzero(((bodies.wheel == feet[0]) & stands).any(axis=1))[0])
    first, count = (int(bodies.vehicles[vehicle][key]) for key in ("first", "coordinates"))
    left = np.append(Sideways.of(scenario, load, "left").side[0], 0.0)
    to_left = left if isinstance(load, Walker) else np.ones(1)
    own = slice(first, first + count - 1)
    return Upright(carrier, load.balance, load.mass, load.first_foot, feet, own, vehicle, left, to_left)
