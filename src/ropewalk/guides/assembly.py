"""The guides of a scenario."""

from __future__ import annotations

import numpy as np

from ropewalk.foreign.models import turns_of
from ropewalk.guides.balance import Upright
from ropewalk.guides.carrier import Carrier
from ropewalk.guides.partner import Partner
from ropewalk.guides.person import Person
from ropewalk.guides.steps import Steps
from ropewalk.mechanics.fleet import Fleet
from ropewalk.mechanics.footfall import outwards
from ropewalk.mechanics.loading import Loading
from ropewalk.model.fmu import Fmu
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.stepper import Stepper
from ropewalk.model.walker import Walker


def guides_of(carrier: Carrier, loading: Loading, scenario: Scenario) -> list[Steps | Person | Partner]:
    """The guides of all loads that need one.

    Raises:
        RopewalkError: the model of a stepper cannot be made.
    """
    fleet = loading.fleet
    if fleet is None:
        return []
    guides: list[Steps | Person | Partner] = []
    for name, load in scenario.loads.items():
        on = tuple(k for k, wheel in enumerate(loading.wheels) if wheel.load == name)
        if isinstance(load, Footsteps):
            guides.append(Steps(carrier, name, load, (on[0], on[1])))
        elif isinstance(load, Walker):
            guides.append(_person(carrier, fleet, scenario, name, load, (on[0], on[1])))
        elif isinstance(load, Stepper | Fmu):
            assert isinstance(scenario.run, Dynamic)
            turns = turns_of(name, load, scenario.run.until, len(loading.axes), carrier.reach(on[0]))
            guides.append(Partner(carrier, turns, on, fleet.ghosts.get(name, ())))
    return guides


def _person(
    carrier: Carrier, fleet: Fleet, scenario: Scenario, name: str, load: Walker, feet: tuple[int, int]
) -> Person:
    legs = [e for e, tether in enumerate(fleet.bodies.tethers) if tether["wheel"] in feet]
    first = int(fleet.bodies.tethers[legs[0]]["first"])
    vehicle = int(np.flatnonzero(fleet.bodies.vehicles["first"] == first)[0])
    dim = int(fleet.bodies.vehicles[vehicle]["coordinates"]) - (load.balance is not None)
    own = slice(first, first + dim)
    person = Person(carrier, name, load, feet, (legs[0], legs[1]), own)
    if load.balance is not None:
        left = np.append(outwards(scenario.lines[load.on], load.towards, "left"), 0.0)
        person.upright = Upright(carrier, load, load.balance, feet, own, vehicle, left)
    return person
