"""A walker on spring legs, and how she decides on the way where to put her feet."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.controllers.balance import Upright
from ropewalk.controllers.carrier import Carrier, CarrierLine
from ropewalk.errors import RopewalkError
from ropewalk.external.cosimulation_master import TravelEndedError
from ropewalk.mechanics.bodies import STANDS, SWINGS, Records
from ropewalk.mechanics.chain import Array
from ropewalk.model.walker import Walker

# A leg begins upright and compressed by this part of the weight, as in the periodic gaits of Geyer et al. (2006).
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
# How far ahead of the body a foot may land, as a part of a leg.
SHORTEST, LONGEST = -0.5, 0.7
# Way of the body in a usual step on firm ground, and what is left of it when a walker begins, upright over one foot, as
# parts of the reach of a leg (Geyer et al.).
USUAL_STEP, LEFT_AT_START = 1.435, 0.435
# Lead of the body over its foot, as a part of the reach, at which a pendulum is as fast as the walker of Geyer et al.
# when the other foot lands (he leads by 0.435 then).
USUAL_LEAD = 0.39


@dataclass
class SpringLegWalker:
    """A walker on spring legs, who looks where to put the next foot a hundred times a second.

    On firm ground it is the spring-mass walker of Geyer et al.: the leg that swings lands at the angle of attack, a
    leg that no longer pushes takes off. On a line that yields, the foot lands no sooner than the body has passed the
    other one, further ahead the faster the body is, and the leg, bent where the line comes up to meet it, is stretched
    again while it stands. The leg behind is longer by what makes up for the energy that the line has taken. All this
    is in the upright plane through the line's chord; `upright` looks after what is across it, if anybody does.
    """

    carrier: Carrier
    name: str
    walker: Walker
    feet: tuple[int, int]
    legs: tuple[int, int]  # numbers of the tethers
    own: slice  # coordinates of the body, one for each axis
    loaded: list[int] = field(default_factory=list)  # feet on the line, the one behind first
    energy: float = 0.0  # J, wanted, above the place where the foot stands
    looked: float = 0.0  # s, when it last looked
    gone: bool = False
    upright: Upright | None = None

    def begin(self) -> None:
        """Stand upright on one leg, and move on."""
        w, g = self.walker, self.carrier.gravity
        self.carrier.set_down(self.feet[0], w.start)
        height = w.leg_length - UPRIGHT_FORCE * w.mass * g / w.leg_stiffness
        self.carrier.q[self.own] = self._sole(0)
        self.carrier.q[self.own.stop - 1] += height
        self.carrier.launch(self.own, self._forward() * w.speed)
        self.energy = 0.5 * w.mass * w.speed**2 + 0.5 * w.leg_stiffness * (w.leg_length - height) ** 2
        self.energy += w.mass * g * height
        self._stand(0, w.leg_length)
        if self.upright is not None:
            reach = w.leg_length * math.cos(w.angle_of_attack)
            self.upright.begin(0, USUAL_STEP * reach / w.speed, LEFT_AT_START * reach / w.speed)
        self._look()

    def next(self, t: float) -> float:
        """The next look."""
        return math.inf if self.gone else self.looked + LOOK

    def act(self) -> None:
        """Land and take off what is due, and look where to land next."""
        if self.gone:
            return
        for foot in list(self.loaded):
            leg = self._leg(foot)
            length = self._distance(foot)
            if leg["watch"] == STANDS and length >= float(leg["length"]) * (1.0 - NEAR):
                self._lift(foot)
        for foot in (0, 1):
            if self._leg(foot)["watch"] == SWINGS and self._is_down(foot):
                self._land(foot)
        if not self.gone:
            self._look()

    def get_state(self) -> Tree:
        """Which feet stand, when she looked, and on which foot she balances."""
        own = {"standing": list(self.loaded), "energy": self.energy, "looked": self.looked, "gone": self.gone}
        upright = self.upright
        return own | (upright.get_state() if upright is not None else {})

    def set_state(self, tree: Tree) -> None:
        """Walk on from there."""
        self.loaded, self.energy = list(tree["standing"]), tree["energy"]
        self.looked, self.gone = tree["looked"], tree["gone"]
        if self.upright is not None:
            self.upright.set_state(tree)

    def _look(self) -> None:
        """Decide where the leg that swings will land, and which legs may take off."""
        self.looked = self.carrier.t
        if self.upright is not None:
            self.upright.check(self.name)
        w, forward, body = self.walker, self._forward(), self._body()
        dim = body.size
        speed = float(forward @ self.carrier.v[self.own])
        passed = [float(forward @ (body - self._sole(foot))) for foot in self.loaded]
        for foot, way in zip(list(self.loaded), passed, strict=True):
            if way > 0.0:
                self._leg(foot)["watch"] = STANDS
        reach = w.leg_length * math.cos(w.angle_of_attack)
        g = self.carrier.gravity
        lead = passed[-1] if passed else 0.0
        landing = math.hypot(w.speed, math.sqrt(g / w.leg_length) * USUAL_LEAD * reach)
        fast = speed - landing
        ahead = reach + STEERING * math.copysign(max(abs(fast) - EASY, 0.0), fast)
        ahead = min(max(ahead, SHORTEST * w.leg_length), LONGEST * w.leg_length)
        for foot in (0, 1):
            if foot in self.loaded:
                continue
            leg = self._leg(foot)
            leg["reach"][:dim] = forward * ahead
            leg["reach"][dim - 1] = -math.sqrt(w.leg_length**2 - ahead**2)
            leg["on"] = 0
            lead_now = math.copysign(lead, lead * speed)
            leg["watch"] = SWINGS if not passed or lead_now >= PASSED * reach else 0
            if passed and lead_now >= LATEST * reach:
                self._land(foot)
                break
        if len(self.loaded) == 2 and abs(passed[0]) >= reach and not self.gone:
            self._drop(self.loaded[0])
        line = self._line()
        end = line.at(line.length if self.walker.towards == "end" else 0.0)[0]
        if float(forward @ (body - end)) > 0.0:
            self._leave()
            return
        below = float(line.at(line.below(*self._level(body)))[0][-1])
        if float(body[-1]) - below < FALLEN * w.leg_length:
            raise RopewalkError(
                f"load {self.name} has fallen: this gait does not suit the line; change speed, angle_of_attack or "
                "leg_stiffness, or tighten the line"
            )

    def _body(self) -> Array:
        return np.array(self.carrier.q[self.own])

    def _leg(self, foot: int) -> Records:
        return self.carrier.legs[self.legs[foot]]  # type: ignore[no-any-return]

    def _line(self) -> CarrierLine:
        return self.carrier.line(self.feet[0])

    def _forward(self) -> Array:
        """Level unit vector in the direction of walking, (axis,)."""
        run = self._line().chord
        run[-1] = 0.0
        return np.asarray(run / np.linalg.norm(run) * (1.0 if self.walker.towards == "end" else -1.0))

    def _level(self, place: Array) -> tuple[float, Array]:
        """How far a place is along a level direction, m, and this: as in the kernel that waits for a foot to land."""
        way = np.zeros(place.size - 1)
        way[0] = 1.0
        across = self.carrier.legs[self.legs[0]]["across"]
        if across.any():
            way = np.array([across[1], -across[0]])
        elif way.size == 2:
            run = np.abs(self._line().chord[:2])
            way = np.array([0.0, 1.0]) if run[1] > run[0] else way
        return float(way @ place[:-1]), way

    def _aside(self, foot: int) -> Array:
        """How far the body is across the place of the line where a foot stands, (axis,) m."""
        way = self._body() - self._sole(foot)
        across = self._leg(foot)["across"][: way.size]
        return np.asarray(across @ way * across)

    def _distance(self, foot: int) -> float:
        """Distance between body and foot as the leg sees it, m."""
        way = self._body() - self._sole(foot)
        return float(np.linalg.norm(way - self._aside(foot)))

    def _sole(self, foot: int) -> Array:
        return self.carrier.motion(self.feet[foot])[0]

    def _stand(self, foot: int, length: float) -> None:
        leg, w = self._leg(foot), self.walker
        leg["on"], leg["watch"], leg["length"], leg["full"] = 1, 0, length, w.leg_length
        leg["growth"] = max(w.leg_length - length, 0.0) / STRETCHING
        self.loaded.append(foot)

    def _is_down(self, foot: int) -> bool:
        sole = self._body()
        sole += self._leg(foot)["reach"][: sole.size]
        height = self._line().height(*self._level(sole))
        return bool(sole[-1] <= height + NEAR * self.walker.leg_length)

    def _lift(self, foot: int) -> None:
        self.carrier.take_up(self.feet[foot])
        leg = self._leg(foot)
        leg["on"], leg["watch"] = 0, 0
        self.loaded.remove(foot)
        if self.upright is not None:
            self.upright.lift(foot, self.loaded)

    def _drop(self, foot: int) -> None:
        """Take up a foot although its leg still pushes; what it has stored is lost."""
        leg = self._leg(foot)
        short = float(leg["length"]) - self._distance(foot)
        self.carrier.lose(0.5 * self.walker.leg_stiffness * max(short, 0.0) ** 2)
        self._lift(foot)

    def _land(self, foot: int) -> None:
        line, sole = self._line(), self._body()
        sole += self._leg(foot)["reach"][: sole.size]
        xi = line.below(*self._level(sole))
        if not MARGIN * line.length < xi < (1.0 - MARGIN) * line.length:
            self._leave()
            return
        self.carrier.set_down(self.feet[foot], xi)
        self._stand(foot, min(self._distance(foot), self.walker.leg_length))
        if self.upright is not None:
            self.upright.step(foot)
        self._push_off(foot)

    def _push_off(self, landed: int) -> None:
        """Let the leg behind be longer, as if it had stored the energy that is missing."""
        behind = [foot for foot in self.loaded if foot != landed]
        if not behind:
            return
        w, g = self.walker, self.carrier.gravity
        body, v = self._body(), np.array(self.carrier.v[self.own])
        across = self._leg(landed)["across"][: v.size]
        v -= across @ v * across
        leg = self._leg(behind[0])
        back, front = self._sole(behind[0]), self._sole(landed)
        short = max(float(leg["length"]) - self._distance(behind[0]), 0.0)
        have = 0.5 * w.mass * float(v @ v) + 0.5 * w.leg_stiffness * short**2
        have += w.mass * g * (float(body[-1]) - 0.5 * float(back[-1] + front[-1]))
        wanted = short**2 + 2.0 * w.push_off * (self.energy - have) / w.leg_stiffness
        longer = min(math.sqrt(max(wanted, 0.0)), short + LONGEST_PUSH * w.leg_length) - short
        self.carrier.give(0.5 * w.leg_stiffness * ((short + longer) ** 2 - short**2))
        leg["length"] += longer
        leg["full"] = leg["length"]
        if wanted <= 0.0:  # nothing is left to push with; else rounding decided whether the leg takes off
            self._lift(behind[0])

    def _leave(self) -> None:
        if self.walker.at_end == "refuse":
            raise TravelEndedError(f"load {self.name} reaches the end of its line")
        self.gone = True
        for foot in (0, 1):
            self._leg(foot)["watch"] = 0
        if self.walker.at_end == "leave":
            for foot in list(self.loaded):
                self._drop(foot)
            self.carrier.hold(self.own)
        else:  # upright by herself, going up and down
            if self.upright is not None:
                self.upright.rest()
            self.carrier.hold(slice(self.own.start, self.own.stop - 1))
