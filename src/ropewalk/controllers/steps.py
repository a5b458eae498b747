"""Steps: feet of a given gait."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ropewalk.checkpoint import Tree
from ropewalk.controllers.balance import Upright
from ropewalk.controllers.carrier import Carrier
from ropewalk.external.cosimulation_master import TravelEndedError
from ropewalk.model.footsteps import Footsteps


@dataclass
class Steps:
    """Feet of a given gait: each stands at its own place, and the next one lands ahead of it.

    `upright` looks after where they stand to the side, if anybody does.
    """

    carrier: Carrier
    name: str
    gait: Footsteps
    feet: tuple[int, int]
    upright: Upright | None = None
    early: float = 0.0  # s, by which feet may land and take off before their time
    number: int = 0  # of the step that comes next
    lifted: int = 0  # how many feet have been taken up
    _came: bool = False
    _gone: bool = False

    def begin(self) -> None:
        """Put the first foot down."""
        self.act()

    def next(self, t: float) -> float:
        """The next landing or take-off."""
        return math.inf if self._gone else min(self._landing(), self._take_off())

    def _landing(self) -> float:
        return (self.number - self.gait.phase) / self.gait.frequency

    def _take_off(self) -> float:
        return (self.lifted + 1.0 + self.gait.overlap - self.gait.phase) / self.gait.frequency

    def act(self) -> None:
        """Land and take off what is due."""
        t = self.carrier.t * (1.0 + 1e-12) + 1e-12 + self.early
        while not self._gone and min(self._landing(), self._take_off()) <= t:
            if self._take_off() <= self._landing():
                self.carrier.take_up(self.feet[self.lifted % 2])
                self.lifted += 1
            else:
                self._land()

    def get_state(self) -> Tree:
        """How far the gait has come."""
        own = {"number": self.number, "lifted": self.lifted, "came": self._came, "gone": self._gone}
        return own | (self.upright.get_state() if self.upright is not None else {})

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self.number, self.lifted, self._came, self._gone = (tree[k] for k in ("number", "lifted", "came", "gone"))
        if self.upright is not None:
            self.upright.set_state(tree)

    def _land(self) -> None:
        gait, foot = self.gait, self.number % 2
        xi = gait.start + gait.onward * gait.step_length * self.number
        length = self.carrier.line(self.feet[foot]).length
        if gait.at_end == "again":
            xi %= length
        if not 0.0 <= xi <= length:
            if gait.at_end == "refuse":
                raise TravelEndedError(f"load {self.name} reaches the end of its line")
            if gait.at_end == "leave":
                if self._came:
                    self._leave()
                self.number += 1
                return
            xi = min(max(xi, 0.0), length)
        self.carrier.set_down(self.feet[foot], xi)
        self.number += 1
        if self.upright is not None:
            self._balance(foot)
        self._came = True

    def _balance(self, foot: int) -> None:
        """Place the foot that has landed to the side."""
        assert self.upright is not None
        if self._came:
            self.upright.check(self.name)
            self.upright.step(foot)
            return
        self.upright.begin(foot, 1.0 / self.gait.frequency, self._landing() - self.carrier.t)
        if self.carrier.t > 0.0:  # who comes brings energy along
            self.carrier.give(self.upright.energy)

    def _leave(self) -> None:
        self._gone = True
        if self.upright is not None:
            self.upright.rest()
            self.carrier.hold(self.upright.own)
        for k in self.feet:
            self.carrier.take_up(k)
