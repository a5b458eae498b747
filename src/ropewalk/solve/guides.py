"""Guides: who decide on the way what loads do that have a gait, or a will of their own."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from ropewalk.checkpoint import Arrays, Tree, arrays_of, copied, put
from ropewalk.foreign.models import turns_of
from ropewalk.foreign.turns import Bearer, Push, Pushes, TravelEndedError, Turns
from ropewalk.mechanics.bodies import Bodies
from ropewalk.mechanics.chain import DRIVE, OFF, Loads, State
from ropewalk.mechanics.footfall import outwards
from ropewalk.model.fmu import Fmu
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.stepper import Stepper
from ropewalk.model.walker import Walker
from ropewalk.solve.balance import Upright
from ropewalk.solve.feet import Line, set_down, take_up
from ropewalk.solve.motion import Look
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

    def get_state(self) -> Tree:
        """How far the gait has come."""
        return {"number": self.number, "lifted": self.lifted, "gone": self._gone}

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self.number, self.lifted, self._gone = tree["number"], tree["lifted"], tree["gone"]

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
class Partner(Bearer):
    """A load that is a model of somebody else's, asked at equal intervals."""

    setting: Setting
    bodies: Bodies
    turns: Turns
    contacts: tuple[int, ...]
    ghosts: tuple[int, ...]  # coordinates that are the far ends of the interface's springs, one for each contact
    look: Look | None = None  # sends a copy of the state ahead; given when the motion begins
    _looked: bool = False
    _heights: list[float] = field(default_factory=list)  # m, where contacts were at the last exchange

    def begin(self, state: State) -> None:
        """Reset the model, and ask it for the first time."""
        self._line = Line(self.setting, state, int(self.setting.loads.strand[self.contacts[0]]))
        self.turns.begin(self._line)
        self.act(state)

    def next(self, t: float) -> float:
        """Its next step."""
        return t if self._has_not_looked else self.turns.next

    @property
    def _has_not_looked(self) -> bool:
        """Whether the first interval is to be agreed on, into which nobody could look before the motion began."""
        return self.look is not None and self.turns.exchange.scheme == "iterated" and not self._looked

    def act(self, state: State) -> None:
        """Ask the model, if it is time: where its contacts are, and with what they press."""
        t = float(state.t[0])
        if self._has_not_looked:
            self._looked = True
            self._press(self.turns.agree(t, self), self.setting.loads, state, self.bodies)
        if t < self.turns.next * (1.0 - 1e-12):
            return
        before = [self._height(k) for k in self.contacts] if self.ghosts else []
        pushes = self.turns.ask(t, self)
        for number, place in enumerate(before):
            state.work[DRIVE] += self._led(number, place, pushes[number])
        self._press(pushes, self.setting.loads, state, self.bodies)
        self._heights = [self._height(k) for k in self.contacts] if self.ghosts else []

    def get_state(self) -> Tree:
        """What is remembered of the exchange, and what the contacts are doing."""
        return {
            "turns": self.turns.get_state(lambda line: copied(arrays_of(line.state))), "looked": self._looked,
            "heights": list(self._heights), "given": copied(given(self.setting.loads, self.contacts)),
        }  # fmt: skip

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""

        def line(state: Tree) -> Line:
            then = self.line.state.copy()
            put(arrays_of(then), state)
            return Line(self.setting, then, self.line.strand)

        self.turns.set_state(tree["turns"], line)
        self._looked, self._heights = tree["looked"], list(tree["heights"])
        put(given(self.setting.loads, self.contacts), tree["given"])

    def _height(self, k: int) -> float:
        """Height of contact k, or where it was last, m."""
        if self.line.state.rider[k] == OFF:
            return float(self.bodies.wheels[k]["r"][len(self.setting.axes) - 1])
        return float(self.line.at(float(self.line.state.xi[k]))[0][-1])

    def _led(self, number: int, place: float, push: Push | None) -> float:
        """Work in J that has been done at the far end of an interface's spring since the last exchange, and now.

        It moved evenly; and now it is put where the model's contact has got to.
        """
        k, c, q = self.turns.exchange.stiffness, self.turns.exchange.damping, self.bodies.coordinates
        end, done = float(q["q"][self.ghosts[number]]), 0.0
        if self._heights:
            way = float(q["v"][self.ghosts[number]]) * self.turns.every
            apart = end - way - self._heights[number], end - place
            done = (0.5 * k * (apart[0] + apart[1]) + c * (apart[1] - apart[0]) / self.turns.every) * way
        to = place if push is None else push.height
        return done + 0.5 * k * ((to - place) ** 2 - (end - place) ** 2)

    @property
    def line(self) -> Line:
        """Its line."""
        return self._line

    def frozen(self) -> Line:
        """The line as it is now, to be looked at later."""
        return Line(self.setting, self.line.state.copy(), self.line.strand)

    def ahead(self, pushes: Pushes, h: float) -> Line | None:
        """The line as it would be after h seconds with these forces; it stays where it is."""
        if self.look is None:  # before the motion has begun
            return None
        loads, state, bodies = _own(self.setting.loads), self.line.state.copy(), self.bodies.copy()
        self._press(pushes, loads, state, bodies)
        self.look(loads, state, bodies, h)
        return Line(self.setting, state, self.line.strand)

    def _press(self, pushes: Pushes, loads: Loads, state: State, bodies: Bodies) -> None:
        for number, (k, push) in enumerate(zip(self.contacts, pushes, strict=True)):
            if push is not None:
                press(self.setting, loads, state, bodies, k, push, self.turns.every)
            elif state.rider[k] != OFF:
                take_up(self.setting, state, bodies, k)
            if self.ghosts and push is not None:
                lead(bodies, self.ghosts[number], push.height, push.rise)
            elif self.ghosts:
                lead(bodies, self.ghosts[number], float(bodies.wheels[k]["r"][state.r.shape[0] - 1]), 0.0)


def press(setting: Setting, loads: Loads, state: State, bodies: Bodies, k: int, push: Push, every: float) -> None:
    """Let contact k do what a push says for some seconds: it slides on to there, or is put down anew."""
    t, away = float(state.t[0]), push.xi - float(state.xi[k])
    if state.rider[k] == OFF or abs(away) > reach_on(setting, k):
        set_down(setting, state, bodies, k, push.xi)
        away = 0.0
    first = int(loads.force_first[k])
    loads.force_time[first], loads.force_time[first + 1] = t, t + every
    loads.force_value[:, first], loads.force_value[:, first + 1] = push.first, push.last
    loads.speed_value[loads.speed_first[k]] = push.speed + away / every  # catches up until then


def given(loads: Loads, contacts: Iterable[int]) -> Arrays:
    """What `press` writes for some contacts."""
    found: Arrays = {}
    for k in contacts:
        first, at = int(loads.force_first[k]), int(loads.speed_first[k])
        found[f"{k}.time"] = loads.force_time[first : first + 2]
        found[f"{k}.force"] = loads.force_value[:, first : first + 2]
        found[f"{k}.speed"] = loads.speed_value[at : at + 1]
    return found


def reach_on(setting: Setting, k: int) -> float:
    """How far from where it has slid to contact k may be said to be without being put down anew, m."""
    return SLIDES * float(setting.strands.h[setting.loads.strand[k]])


def _own(loads: Loads) -> Loads:
    """Loads whose forces and speeds may be changed without changing those of the others."""
    tables = ("speed_value", "force_time", "force_value")
    return loads._replace(**{name: getattr(loads, name).copy() for name in tables})


def lead(bodies: Bodies, ghost: int, height: float, rise: float) -> None:
    """Put the far end of an interface's spring somewhere, and let it go on from there."""
    record = bodies.coordinates[ghost]
    record["q"], record["v"], record["ahead"] = height, rise, rise


def guides_of(setting: Setting, scenario: Scenario, bodies: Bodies | None) -> list[Steps | Person | Partner]:
    """The guides of all loads that need one.

    Raises:
        RopewalkError: the model of a stepper cannot be made.
    """
    if bodies is None:
        return []
    guides: list[Steps | Person | Partner] = []
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
        elif isinstance(load, Stepper | Fmu):
            assert isinstance(scenario.run, Dynamic)
            turns = turns_of(name, load, scenario.run.until, len(setting.axes), reach_on(setting, on[0]))
            assert setting.fleet is not None
            guides.append(Partner(setting, bodies, turns, on, setting.fleet.ghosts.get(name, ())))
    return guides
