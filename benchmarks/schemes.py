"""Schemes that compute a motion: its frames, and the CPU time of the motion alone, without set-up and output."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import numpy as np

from ropewalk.chains.moving import Chain
from ropewalk.errors import RopewalkError
from ropewalk.model import Scenario
from ropewalk.results.frame import Frame, RunInfo
from ropewalk.results.running import MotionEngine, TimeHistory
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.system.equilibrium.form_finding import formed
from ropewalk.wires.frames import Wires
from ropewalk.wiring import task_of

from .core_motion import VARIANT, CoreMotion, CoreNet

Array = np.ndarray


class Timing(NamedTuple):
    """A motion that can be repeated."""

    repeat: Callable[[], float]
    """Returns CPU seconds."""
    steps: int
    """Evaluations of all links."""


class Scheme(Protocol):
    """What computes motions."""

    def __call__(self, scenario: Scenario, times: Array) -> list[Any]:
        """Return the frames at some instants, s."""

    def timing(self, scenario: Scenario) -> Timing:
        """Return the timing of a motion up to the end of its run."""


class Today:
    """An engine of today's, whichever would be chosen for a scenario."""

    def __init__(self, engine: Callable[[Scenario, RunInfo, Array], MotionEngine]) -> None:
        self._engine = engine

    def __call__(self, scenario: Scenario, times: Array) -> list[Frame]:
        """Return the frames at some instants, s.

        Raises:
            RopewalkError: the motion has ended early.
        """
        run_info = RunInfo()
        found = list(TimeHistory(self._engine(formed(scenario), run_info, times), run_info).frames())
        if run_info.outcome != "running":
            raise RopewalkError(run_info.outcome)
        return found

    def timing(self, scenario: Scenario) -> Timing:
        """Return the timing of a motion up to the end of its run."""
        run_info, scenario = RunInfo(), formed(scenario)
        engine = self._engine(scenario, run_info, np.array([0.0, scenario.run.until]))
        begin = engine.get_state()

        def repeat() -> float:
            engine.set_state(begin)
            engine.advance(0)
            start = clock.process_time()
            engine.advance(1)
            return clock.process_time() - start

        repeat()
        return Timing(repeat, run_info.steps * (11 if run_info.method == "rkn6" else 1))


class Core:
    """The compiled core, with one of its instruction sets."""

    _last: tuple[Scenario, CoreMotion] | None = None

    def __init__(self, variant: str = VARIANT) -> None:
        self._variant = variant

    @classmethod
    def _motion(cls, scenario: Scenario) -> CoreMotion:
        """Return the motion of a scenario, which all instruction sets share."""
        if cls._last is None or cls._last[0] is not scenario:
            cls._last = scenario, (CoreNet if scenario.nets else CoreMotion)(scenario)
        return cls._last[1]

    def __call__(self, scenario: Scenario, times: Array) -> list[Any]:
        """Return the frames at some instants, s."""
        return self._motion(scenario).frames(times, self._variant)

    def timing(self, scenario: Scenario) -> Timing:
        """Return the timing of a motion up to the end of its run."""
        moving = self._motion(scenario)

        def repeat() -> float:
            moving.restart()
            start = clock.process_time()
            moving.advance(scenario.run.until, self._variant)
            return clock.process_time() - start

        repeat()
        return Timing(repeat, moving.steps)


ROPES = Today(Chain)
SPLINES = Today(SystemMotion)
STIFF = Today(lambda scenario, run_info, times: Wires(task_of(scenario), times, run_info))
CORE = Core()
