"""The controllers of a scenario."""

from __future__ import annotations

import numpy as np

from ropewalk.controllers.balance import Upright
from ropewalk.controllers.carrier import Carrier
from ropewalk.controllers.partner import Partner
from ropewalk.controllers.spring_leg_walker import SpringLegWalker
from ropewalk.controllers.steps import Steps
from ropewalk.external.models import cosimulation_of
from ropewalk.mechanics.footfall import outwards
from ropewalk.mechanics.loading import Loading
from ropewalk.mechanics.multibody_system import MultibodySystem
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
    for name, load in scenario.loads.items():
        on = tuple(k for k, wheel in enumerate(loading.wheels) if wheel.load == name)
        if isinstance(load, Footsteps):
            controllers.append(Steps(carrier, name, load, (on[0], on[1])))
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
    own = slice(first, first + dim)
    spring_leg_walker = SpringLegWalker(carrier, name, load, feet, (legs[0], legs[1]), own)
    if load.balance is not None:
        left = np.append(outwards(scenario.lines[load.on], load.towards, "left"), 0.0)
        spring_leg_walker.upright = Upright(carrier, load, load.balance, feet, own, vehicle, left)
    return spring_leg_walker
