"""Asking: a motion that goes on from one question to the next."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ropewalk.checkpoint import Tree
from ropewalk.controllers.carrier import Controller
from ropewalk.controllers.steps import Steps
from ropewalk.errors import RopewalkError
from ropewalk.external.cosimulation_master import TravelEndedError
from ropewalk.system.dynamics import motion
from ropewalk.system.dynamics.carrier import SystemCarrier

# So often controllers may be asked without a step in between.
MOST_QUESTIONS = 100
# Part of a step by which instants differ that are meant to be the same.
NEXT_TO_NOTHING = 1e-6
# A load that could not go on.
FAILED = -1  # instead of what a kernel says


class Asking:
    """A motion whose loads decide on the way what they do.

    Args:
        carrier: what moves.
        controllers: who decide.
    """

    def __init__(self, carrier: SystemCarrier, controllers: Sequence[Controller]) -> None:
        self.carrier, self.controllers, self.message = carrier, controllers, ""
        self._idle = 0

    def begin(self) -> None:
        """Take the first decisions."""
        if not self.controllers:
            return
        for controller in self.controllers:
            controller.begin()
        self.carrier.system.contacts["before"] = float("nan")  # what presses from the beginning has done no work yet
        self.carrier.system.settle()
        self.carrier.looks_ahead = True

    def to(self, end: float) -> int:
        """Go on to a time in s; returns RUNNING, or why that ends before."""
        carrier = self.carrier
        if not self.controllers:
            return carrier.go(end)
        origin = carrier.t
        step = (end - origin) / max(1, math.ceil((end - origin) / carrier.longest - 1e-9))
        for controller in self.controllers:
            if isinstance(controller, Steps):
                controller.early = 0.5 * step
        while carrier.t < end:
            begin = carrier.t
            until = min([end, *(self._next(controller, begin, origin, step) for controller in self.controllers)])
            status = motion.ASKED
            if until - begin > NEXT_TO_NOTHING * carrier.longest:
                status = carrier.to(until)
            elif until > begin:  # instants that are meant to be the same: no step is so short
                carrier.system.state.t[0] = until
            if status in (motion.RUNNING, motion.ASKED):
                self._idle = self._idle + 1 if carrier.t == begin else 0
                status = self._ask()
            if status != motion.RUNNING:
                return status
        return motion.RUNNING

    def _next(self, controller: Controller, t: float, origin: float, step: float) -> float:
        """When a controller is asked next.

        Feet that keep time land where a step ends: hundreds of people would cut steps into pieces of all lengths, in
        which Verlet's method pumps energy into the fastest waves.
        """
        due = controller.next(t)
        if not isinstance(controller, Steps) or not math.isfinite(due):
            return due
        return origin + step * max(round((due - origin) / step), round((t - origin) / step) + 1)

    def get_state(self) -> Tree:
        """All that changes in who decides."""
        return {"idle": self._idle, "of": [controller.get_state() for controller in self.controllers]}

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self._idle = tree["idle"]
        for controller, own in zip(self.controllers, tree["of"], strict=True):
            controller.set_state(own)

    def _ask(self) -> int:
        if self._idle > MOST_QUESTIONS:
            self.message = "the controller of a load decides again and again without advancing"
            return FAILED
        try:
            for controller in self.controllers:
                controller.act()
        except TravelEndedError:
            return motion.AT_END
        except RopewalkError as error:
            self.message = str(error)
            return FAILED
        self.carrier.system.settle()
        return motion.RUNNING
