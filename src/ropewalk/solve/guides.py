"""Guides: who decide on the way what loads do that have a gait, or a will of their own."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.bodies import Bodies
from ropewalk.mechanics.chain import OFF, State
from ropewalk.mechanics.footfall import outwards
from ropewalk.mechanics.wheels import named
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.scenario import Scenario
from ropewalk.model.stepper import Stepper
from ropewalk.model.walker import Walker
from ropewalk.solve.balance import Upright
from ropewalk.solve.feet import Line, set_down, take_up
from ropewalk.solve.motion import TravelEndedError
from ropewalk.solve.person import Person
from ropewalk.solve.start import Setting

# Part of a link up to which a contact of a model slides to where it is said to be.
SLIDES = 0.5


@dataclass
class Steps:
    """Feet of a given gait: each stands at its own place, and the next one lands ahead of it."""

    setting: Setting
    bodies: Bodies
    name: str
    gait: Footsteps
    feet: tuple[int, int]
    number: int = 0  # of the step that comes next
    lifted: int = 0  # how many feet have been taken up
    _gone: bool = False

    def begin(self, state: State) -> None:
        """Put the first foot down."""
        self.act(state)

    def next(self, t: float) -> float:
        """The next landing or take-off."""
        return math.inf if self._gone else min(self._landing(), self._take_off())

    def _landing(self) -> float:
        return self.number / self.gait.frequency

    def _take_off(self) -> float:
        return (self.lifted + 1.0 + self.gait.overlap) / self.gait.frequency

    def act(self, state: State) -> None:
        """Land and take off what is due."""
        t = float(state.t[0]) * (1.0 + 1e-12) + 1e-12
        while not self._gone and min(self._landing(), self._take_off()) <= t:
            if self._take_off() <= self._landing():
                take_up(self.setting, state, self.bodies, self.feet[self.lifted % 2])
                self.lifted += 1
            else:
                self._land(state)

    def _land(self, state: State) -> None:
        foot, other = self.feet[self.number % 2], self.feet[(self.number + 1) % 2]
        sign = 1.0 if self.gait.towards == "end" else -1.0
        xi = self.gait.start + sign * self.gait.step_length * self.number
        length = Line(self.setting, state, int(self.setting.loads.strand[foot])).length
        if not 0.0 <= xi <= length:
            if self.gait.at_end == "refuse":
                raise TravelEndedError(f"load {self.name} comes to the end of its line")
            if self.gait.at_end == "leave":
                for k in (foot, other):
                    take_up(self.setting, state, self.bodies, k)
                self._gone = True
                return
            xi = min(max(xi, 0.0), length)
        set_down(self.setting, state, self.bodies, foot, xi)
        self.number += 1


@dataclass
class Model:
    """A load that is a Python object of the user's own, asked at equal intervals."""

    setting: Setting
    bodies: Bodies
    name: str
    stepper: Stepper
    contacts: tuple[int, ...]
    model: Any
    asked: int = 0

    def begin(self, state: State) -> None:
        """Reset the model, and ask it for the first time."""
        self.line = Line(self.setting, state, int(self.setting.loads.strand[self.contacts[0]]))
        if hasattr(self.model, "reset"):
            self.model.reset(self.line)
        self.act(state)

    def next(self, t: float) -> float:
        """Its next step."""
        return self.asked * self.stepper.every

    def act(self, state: State) -> None:
        """Ask the model, if it is time: where its contacts are, and with what they press."""
        t, h = float(state.t[0]), self.stepper.every
        if t < self.asked * h * (1.0 - 1e-12):
            return
        self.asked += 1
        try:
            answer = list(self.model.step(t, h, self.line))
        except RopewalkError:
            raise
        except Exception as error:
            raise RopewalkError(
                f"load {self.name}: its model failed at t = {t:g} s ({type(error).__name__}: {error})"
            ) from error
        if len(answer) > len(self.contacts):
            raise RopewalkError(
                f"load {self.name}: its model has {len(answer)} contacts at t = {t:g} s, but said contacts = "
                f"{len(self.contacts)}; give the class an attribute contacts with the most it may have"
            )
        for number, k in enumerate(self.contacts):
            if number < len(answer):
                self._press(state, k, answer[number], t)
            elif state.rider[k] != OFF:
                take_up(self.setting, state, self.bodies, k)

    def _press(self, state: State, k: int, answer: Any, t: float) -> None:
        try:
            xi, force = float(answer[0]), answer[1]
            speed = float(answer[2]) if len(answer) > 2 else 0.0
            values = [float(component) for component in force]
        except (TypeError, ValueError, IndexError) as error:
            raise RopewalkError(
                f"load {self.name}: at t = {t:g} s its model gave {answer!r}; each contact is (xi, [Fx, Fz]) or "
                "(xi, [Fx, Fz], speed)"
            ) from error
        if len(values) != state.r.shape[0] or not all(map(math.isfinite, (xi, speed, *values))):
            raise RopewalkError(
                f"load {self.name}: at t = {t:g} s its model gave {answer!r}; wanted are finite numbers and "
                f"{state.r.shape[0]} components of the force"
            )
        if not 0.0 <= xi <= self.line.length:
            if self.stepper.at_end == "refuse":
                raise TravelEndedError(f"load {self.name} comes to the end of its line")
            if self.stepper.at_end == "leave":
                if state.rider[k] != OFF:
                    take_up(self.setting, state, self.bodies, k)
                return
            xi = min(max(xi, 0.0), self.line.length)
        loads = self.setting.loads
        away = xi - float(state.xi[k])
        if state.rider[k] == OFF or abs(away) > SLIDES * float(self.setting.strands.h[loads.strand[k]]):
            set_down(self.setting, state, self.bodies, k, xi)
            away = 0.0
        loads.force_value[:, loads.force_first[k]] = values
        loads.speed_value[loads.speed_first[k]] = speed + away / self.stepper.every  # catches up until the next step


def guides_of(setting: Setting, scenario: Scenario, bodies: Bodies | None) -> list[Steps | Person | Model]:
    """The guides of all loads that need one.

    Raises:
        RopewalkError: the model of a stepper cannot be made.
    """
    if bodies is None:
        return []
    guides: list[Steps | Person | Model] = []
    for name, load in scenario.loads.items():
        on = tuple(k for k, wheel in enumerate(setting.wheels) if wheel.load == name)
        if isinstance(load, Footsteps):
            guides.append(Steps(setting, bodies, name, load, (on[0], on[1])))
        elif isinstance(load, Walker):
            legs = tuple(e for e, tether in enumerate(bodies.tethers) if tether["wheel"] in on)
            person = Person(setting, bodies, name, load, (on[0], on[1]), (legs[0], legs[1]))
            if load.balance is not None:
                left = np.append(outwards(scenario.lines[load.on], load.towards, "left"), 0.0)
                vehicle = int(np.flatnonzero(bodies.vehicles["first"] == bodies.tethers[legs[0]]["first"])[0])
                person.upright = Upright(setting, bodies, load, load.balance, (on[0], on[1]), vehicle, left)
            guides.append(person)
        elif isinstance(load, Stepper):
            guides.append(Model(setting, bodies, name, load, on, model_of(name, load)))
    return guides


def model_of(name: str, stepper: Stepper) -> Any:
    """The model of a stepper: the object itself, or made from what its text names.

    Raises:
        RopewalkError: there is no such thing, or it cannot be made.
    """
    if not isinstance(stepper.model, str):
        return stepper.model
    made = named(name, stepper.model)
    try:
        made = made(**stepper.options) if callable(made) else made
    except Exception as error:
        raise RopewalkError(f"load {name}: its model {stepper.model} cannot be made ({error})") from error
    if not callable(getattr(made, "step", None)):
        raise RopewalkError(f"load {name}: {stepper.model} has no method step(t, h, line)")
    return made
