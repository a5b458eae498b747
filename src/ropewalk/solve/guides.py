"""Guides: who decide on the way what loads do that have a gait, or a will of their own."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.bodies import AWAY, RIDING, STANDS, SWINGS, Bodies
from ropewalk.mechanics.chain import DRIVE, LOAD_DAMPING, OFF, SHARED, Array, State
from ropewalk.mechanics.rider import contact_point, put_back, seat_of
from ropewalk.mechanics.wheels import named
from ropewalk.model.footsteps import Footsteps
from ropewalk.model.scenario import Scenario
from ropewalk.model.stepper import Stepper
from ropewalk.model.walker import Walker
from ropewalk.solve.motion import TravelEndedError
from ropewalk.solve.start import Setting

# A leg begins upright and compressed by this part of the weight, as in the gaits of theory/gait.py.
UPRIGHT_FORCE = 0.52
# A walker whose body is lower than this part of a leg above the line has fallen.
FALLEN = 0.4
# What the kernel has found due is due here, too, but for rounding: as a part of a leg.
NEAR = 1e-9
# How much further ahead a foot lands for every m/s that the body is too fast, s, beyond what is nothing to mind, m/s:
# a hundredth of a second before it lands on firm ground, a body is slower by 0.015 m/s.
STEERING, EASY = 0.4, 0.03
# A foot lands no sooner than the body has passed the other one by this part of the reach of a leg.
PASSED, LATEST = 0.4, 0.55
# Time in which a leg that has landed bent is stretched, and between two looks, s.
STRETCHING, LOOK = 0.25, 0.01
# The most by which a leg pushes off, as a part of it, and the part of a line at its ends where nobody steps.
LONGEST_PUSH, MARGIN = 0.05, 1e-3
# Part of a link up to which a contact of a model slides to where it is said to be; mass of who is on firm ground, kg.
SLIDES, FIRM = 0.5, 1e30
# How far ahead of the body a foot may land, as a part of a leg.
SHORTEST, LONGEST = -0.5, 0.7
# Lead of the body over its foot, as a part of the reach, at which a pendulum is as fast as the walker of theory/gait.py
# when the other foot lands (he leads by 0.435 then).
USUAL_LEAD = 0.39


@dataclass
class Line:
    """The line as a load sees it while the motion goes on."""

    setting: Setting
    state: State
    strand: int

    @property
    def length(self) -> float:
        """Unstrained length, m."""
        return float(self.setting.strands.links[self.strand] * self.setting.strands.h[self.strand])

    def at(self, xi: float) -> tuple[Array, Array]:
        """Position in m and velocity in m/s of the line at the unstrained length xi in m from its start, (axis,)."""
        i, part = self._place(xi)
        r, w = self.state.r, self.state.w
        return r[:, i] + part * (r[:, i + 1] - r[:, i]), w[:, i] + part * (w[:, i + 1] - w[:, i])

    def below(self, x: float) -> float:
        """The xi in m of the line above or below a horizontal place x in m."""
        first, last = self.ends
        row, X = self.state.r[0, first : last + 1], self.state.X[first : last + 1]
        return float(np.interp(x, row, X) if row[-1] > row[0] else np.interp(-x, -row, X))

    def height(self, x: float) -> float:
        """Height of the line in m at a horizontal place in m; beyond its ends it goes on straight, as in the kernel."""
        first, last = self.ends
        row, z = self.state.r[0, first : last + 1], self.state.r[-1, first : last + 1]
        onward = 1.0 if row[-1] > row[0] else -1.0
        i = min(max(int(np.searchsorted(onward * row, onward * x)) - 1, 0), row.size - 2)
        return float(z[i] + (x - row[i]) / (row[i + 1] - row[i]) * (z[i + 1] - z[i]))

    @property
    def ends(self) -> tuple[int, int]:
        """Numbers of its first and last node."""
        first = int(self.setting.strands.first[self.strand])
        return first, first + int(self.setting.strands.links[self.strand])

    def _place(self, xi: float) -> tuple[int, float]:
        first, last = self.ends
        X = self.state.X
        i = int(seat_of(X, xi, self.setting.strands.h[self.strand], first, last))
        return i, (xi - X[i]) / (X[i + 1] - X[i])


def _set_down(setting: Setting, state: State, bodies: Bodies, k: int, xi: float) -> None:
    """Let contact k stand on its line at xi."""
    _take_up(setting, state, bodies, k)
    s = int(setting.loads.strand[k])
    state.xi[k], state.rider[k], state.speed[k] = xi, SHARED, 0.0
    record, dim = bodies.wheels[k], state.r.shape[0]
    before = _foot_energy(setting, bodies, k)
    record["phase"] = RIDING
    place = np.zeros(dim)
    contact_point(setting.strands, setting.loads, state, k, place)
    _, speed = Line(setting, state, s).at(xi)
    record["r"][:dim], record["v"][:dim] = place, speed  # a foot is set down as fast as the line moves
    state.work[DRIVE] += _foot_energy(setting, bodies, k) - before


def _foot_energy(setting: Setting, bodies: Bodies, k: int) -> float:
    """Energy of the mass of a foot, which its owner lifts, lowers and moves, J."""
    z, record = len(setting.axes) - 1, bodies.wheels[k]
    height = -float(record["mass"][z] * setting.strands.gravity[z] * record["r"][z])
    return height + 0.5 * float((record["mass"] * record["v"] ** 2).sum())


def _take_up(setting: Setting, state: State, bodies: Bodies, k: int) -> None:
    """Take contact k off its line."""
    b = int(state.rider[k])
    if b >= 0:
        put_back(setting.strands, state, int(setting.loads.strand[k]), b, float(state.speed[k]))
    record = bodies.wheels[k]
    if state.rider[k] != OFF:  # the foot stops, and is held where it is
        state.work[LOAD_DAMPING] += 0.5 * float((record["mass"] * record["v"] ** 2).sum())
    state.rider[k], state.speed[k] = OFF, 0.0
    record["phase"], record["v"] = AWAY, 0.0


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
                _take_up(self.setting, state, self.bodies, self.feet[self.lifted % 2])
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
                    _take_up(self.setting, state, self.bodies, k)
                self._gone = True
                return
            xi = min(max(xi, 0.0), length)
        _set_down(self.setting, state, self.bodies, foot, xi)
        self.number += 1


@dataclass
class Person:
    """A walker on spring legs, who looks where to put the next foot a hundred times a second.

    On firm ground it is the spring-mass walker of theory/gait.py: the leg that swings lands at the angle of attack, a
    leg that no longer pushes takes off. On a line that gives way, the foot lands no sooner than the body has passed the
    other one, further ahead the faster the body is, and the leg, bent where the line comes up to meet it, is stretched
    again while it stands. The leg behind is longer by what makes up for the energy that the line has taken.
    """

    setting: Setting
    bodies: Bodies
    name: str
    walker: Walker
    feet: tuple[int, int]
    legs: tuple[int, int]  # numbers of the tethers
    standing: list[int] = field(default_factory=list)  # feet on the line, the one behind first
    energy: float = 0.0  # J, wanted, above the place where the foot stands
    looked: float = 0.0  # s, when it last looked
    gone: bool = False

    def begin(self, state: State) -> None:
        """Stand upright on one leg, and move on."""
        w, dim = self.walker, state.r.shape[0]
        _set_down(self.setting, state, self.bodies, self.feet[0], w.start)
        g = -float(self.setting.strands.gravity[-1])
        height = w.leg_length - UPRIGHT_FORCE * w.mass * g / w.leg_stiffness
        own = self._own(dim)
        self.bodies.coordinates["q"][own] = self._sole(state, 0)
        self.bodies.coordinates["q"][own.stop - 1] += height
        self.bodies.coordinates["v"][own.start] = self._forward(state) * w.speed
        self.bodies.coordinates["ahead"][own] = self.bodies.coordinates["v"][own]
        self.energy = 0.5 * w.mass * w.speed**2 + 0.5 * w.leg_stiffness * (w.leg_length - height) ** 2
        self.energy += w.mass * g * height
        self._stand(0, w.leg_length)
        self._look(state)

    def next(self, t: float) -> float:
        """The next look."""
        return math.inf if self.gone else self.looked + LOOK

    def act(self, state: State) -> None:
        """Land and take off what is due, and look where to land next."""
        if self.gone:
            return
        dim = state.r.shape[0]
        for foot in list(self.standing):
            leg = self.bodies.tethers[self.legs[foot]]
            length = float(np.linalg.norm(self._body(dim) - self._sole(state, foot)))
            if leg["watch"] == STANDS and length >= float(leg["length"]) * (1.0 - NEAR):
                self._lift(state, foot)
        for foot in (0, 1):
            if self.bodies.tethers[self.legs[foot]]["watch"] == SWINGS and self._is_down(state, foot):
                self._land(state, foot)
        if not self.gone:
            self._look(state)

    def _look(self, state: State) -> None:
        """Decide where the leg that swings will land, and which legs may take off."""
        self.looked = float(state.t[0])
        w, dim, forward = self.walker, state.r.shape[0], self._forward(state)
        body = self._body(dim)
        speed = forward * float(self.bodies.coordinates["v"][self._own(dim)][0])
        passed = [forward * float(body[0] - self._sole(state, foot)[0]) for foot in self.standing]
        for foot, way in zip(list(self.standing), passed, strict=True):
            if way > 0.0:
                self.bodies.tethers[self.legs[foot]]["watch"] = STANDS
        reach = w.leg_length * math.cos(w.angle_of_attack)
        g = -float(self.setting.strands.gravity[-1])
        lead = passed[-1] if passed else 0.0
        landing = math.hypot(w.speed, math.sqrt(g / w.leg_length) * USUAL_LEAD * reach)
        fast = speed - landing
        ahead = reach + STEERING * math.copysign(max(abs(fast) - EASY, 0.0), fast)
        ahead = min(max(ahead, SHORTEST * w.leg_length), LONGEST * w.leg_length)
        for foot in (0, 1):
            if foot in self.standing:
                continue
            leg = self.bodies.tethers[self.legs[foot]]
            leg["reach"] = 0.0
            leg["reach"][0] = forward * ahead
            leg["reach"][dim - 1] = -math.sqrt(w.leg_length**2 - ahead**2)
            leg["on"] = 0
            lead_now = math.copysign(lead, lead * speed)
            leg["watch"] = SWINGS if not passed or lead_now >= PASSED * reach else 0
            if passed and lead_now >= LATEST * reach:
                self._land(state, foot)
                break
        if len(self.standing) == 2 and abs(passed[0]) >= reach and not self.gone:
            self._drop(state, self.standing[0])
        line = self._line(state)
        end = line.at(line.length if self.walker.towards == "end" else 0.0)[0]
        if forward * float(body[0] - end[0]) > 0.0:
            self._leave(state)
            return
        below = float(line.at(line.below(float(body[0])))[0][-1])
        if float(body[-1]) - below < FALLEN * w.leg_length:
            raise RopewalkError(
                f"load {self.name} has fallen: this gait does not suit the line; change speed, angle_of_attack or "
                "leg_stiffness, or tighten the line"
            )

    def _own(self, dim: int) -> slice:
        first = int(self.bodies.tethers[self.legs[0]]["first"])
        return slice(first, first + dim)

    def _body(self, dim: int) -> Array:
        return np.array(self.bodies.coordinates["q"][self._own(dim)])

    def _line(self, state: State) -> Line:
        return Line(self.setting, state, int(self.setting.loads.strand[self.feet[0]]))

    def _forward(self, state: State) -> float:
        """Direction of walking along x."""
        first, last = self._line(state).ends
        run = float(state.r[0, last] - state.r[0, first])
        return math.copysign(1.0, run) * (1.0 if self.walker.towards == "end" else -1.0)

    def _sole(self, state: State, foot: int) -> Array:
        place = np.zeros(state.r.shape[0])
        contact_point(self.setting.strands, self.setting.loads, state, self.feet[foot], place)
        return place

    def _stand(self, foot: int, length: float) -> None:
        leg, w = self.bodies.tethers[self.legs[foot]], self.walker
        leg["on"], leg["watch"], leg["length"], leg["full"] = 1, 0, length, w.leg_length
        leg["growth"] = max(w.leg_length - length, 0.0) / STRETCHING
        self.standing.append(foot)

    def _is_down(self, state: State, foot: int) -> bool:
        leg, dim = self.bodies.tethers[self.legs[foot]], state.r.shape[0]
        sole = self._body(dim) + leg["reach"][:dim]
        height = self._line(state).height(float(sole[0]))
        return bool(sole[-1] <= height + NEAR * self.walker.leg_length)

    def _lift(self, state: State, foot: int) -> None:
        _take_up(self.setting, state, self.bodies, self.feet[foot])
        leg = self.bodies.tethers[self.legs[foot]]
        leg["on"], leg["watch"] = 0, 0
        self.standing.remove(foot)

    def _drop(self, state: State, foot: int) -> None:
        """Take up a foot although its leg still pushes; what it has stored is lost."""
        leg = self.bodies.tethers[self.legs[foot]]
        short = float(leg["length"]) - float(np.linalg.norm(self._body(state.r.shape[0]) - self._sole(state, foot)))
        state.work[LOAD_DAMPING] += 0.5 * self.walker.leg_stiffness * max(short, 0.0) ** 2
        self._lift(state, foot)

    def _land(self, state: State, foot: int) -> None:
        leg, dim, w = self.bodies.tethers[self.legs[foot]], state.r.shape[0], self.walker
        sole = self._body(dim) + leg["reach"][:dim]
        line = self._line(state)
        xi = line.below(float(sole[0]))
        if not MARGIN * line.length < xi < (1.0 - MARGIN) * line.length:
            self._leave(state)
            return
        _set_down(self.setting, state, self.bodies, self.feet[foot], xi)
        length = float(np.linalg.norm(self._body(dim) - self._sole(state, foot)))
        self._stand(foot, min(length, w.leg_length))
        self._push_off(state, foot)

    def _push_off(self, state: State, landed: int) -> None:
        """Let the leg behind be longer, as if it had stored the energy that is missing."""
        behind = [foot for foot in self.standing if foot != landed]
        if not behind:
            return
        w, dim = self.walker, state.r.shape[0]
        g = -float(self.setting.strands.gravity[-1])
        body, v = self._body(dim), np.array(self.bodies.coordinates["v"][self._own(dim)])
        leg = self.bodies.tethers[self.legs[behind[0]]]
        back, front = self._sole(state, behind[0]), self._sole(state, landed)
        short = max(float(leg["length"]) - float(np.linalg.norm(body - back)), 0.0)
        have = 0.5 * w.mass * float(v @ v) + 0.5 * w.leg_stiffness * short**2
        have += w.mass * g * (float(body[-1]) - 0.5 * float(back[-1] + front[-1]))
        wanted = short**2 + 2.0 * w.push_off * (self.energy - have) / w.leg_stiffness
        longer = min(math.sqrt(max(wanted, 0.0)), short + LONGEST_PUSH * w.leg_length) - short
        state.work[DRIVE] += 0.5 * w.leg_stiffness * ((short + longer) ** 2 - short**2)
        leg["length"] += longer
        leg["full"] = leg["length"]

    def _leave(self, state: State) -> None:
        if self.walker.at_end == "refuse":
            raise TravelEndedError(f"load {self.name} comes to the end of its line")
        self.gone = True
        for leg in self.legs:
            self.bodies.tethers[leg]["watch"] = 0
        own = self._own(state.r.shape[0])
        if self.walker.at_end == "leave":
            for foot in list(self.standing):
                self._drop(state, foot)
            self._stop(state, own)
        else:  # upright by herself, going up and down
            self._stop(state, slice(own.start, own.stop - 1))

    def _stop(self, state: State, own: slice) -> None:
        """Let some coordinates of the body stand as on firm ground: nothing moves what has no end of mass."""
        state.work[LOAD_DAMPING] += 0.5 * self.walker.mass * float((self.bodies.coordinates["v"][own] ** 2).sum())
        self.bodies.coordinates["v"][own] = self.bodies.coordinates["ahead"][own] = 0.0
        vehicle = int(np.flatnonzero(self.bodies.vehicles["first"] == own.start)[0])
        np.fill_diagonal(self.bodies.M[vehicle][: own.stop - own.start], FIRM)


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
                _take_up(self.setting, state, self.bodies, k)

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
                    _take_up(self.setting, state, self.bodies, k)
                return
            xi = min(max(xi, 0.0), self.line.length)
        loads = self.setting.loads
        away = xi - float(state.xi[k])
        if state.rider[k] == OFF or abs(away) > SLIDES * float(self.setting.strands.h[loads.strand[k]]):
            _set_down(self.setting, state, self.bodies, k, xi)
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
            guides.append(Person(setting, bodies, name, load, (on[0], on[1]), (legs[0], legs[1])))
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
