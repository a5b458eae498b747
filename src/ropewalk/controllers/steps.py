"""Steps: feet of a given gait."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ropewalk.checkpoint import Tree
from ropewalk.controllers.carrier import Carrier
from ropewalk.external.cosimulation_master import TravelEndedError
from ropewalk.model.footsteps import Footsteps


@dataclass
class Steps:
    """Feet of a given gait: each stands at its own place, and the next one lands ahead of it."""

    carrier: Carrier
    name: str
    gait: Footsteps
    feet: tuple[int, int]
    number: int = 0  # of the step that comes next
    lifted: int = 0  # how many feet have been taken up
    _gone: bool = False

    def begin(self) -> None:
        """Put the first foot down."""
        self.act()

    def next(self, t: float) -> float:
        """The next landing or take-off."""
        return math.inf if self._gone else min(self._landing(), self._take_off())

    def _landing(self) -> float:
        return self.number / self.gait.frequency

    def _take_off(self) -> float:
        return (self.lifted + 1.0 + self.gait.overlap) / self.gait.frequency

    def act(self) -> None:
        """Land and take off what is due."""
        t = self.carrier.t * (1.0 + 1e-12) + 1e-12
        while not self._gone and min(self._landing(), self._take_off()) <= t:
            if self._take_off() <= self._landing():
                self.carrier.take_up(self.feet[self.lifted % 2])
                self.lifted += 1
            else:
                self._land()

    def get_state(self) -> Tree:
        """How far the gait has come."""
        return {"number": self.number, "lifted": self.lifted, "gone": self._gone}

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self.number, self.lifted, self._gone = tree["number"], tree["lifted"], tree["gone"]

    def _land(self) -> None:
        foot, other = self.feet[self.number % 2], self.feet[(self.number + 1) % 2]
        sign = 1.0 if self.gait.towards == "end" else -1.0
        xi = self.gait.start + sign * self.gait.step_length * self.number
        length = self.carrier.line(foot).length
        if not 0.0 <= xi <= length:
            if self.gait.at_end == "refuse":
                raise TravelEndedError(f"load {self.name} comes to the end of its line")
            if self.gait.at_end == "leave":
                for k in (foot, other):
                    self.carrier.take_up(k)
                self._gone = True
                return
            xi = min(max(xi, 0.0), length)
        self.carrier.set_down(foot, xi)
        self.number += 1
