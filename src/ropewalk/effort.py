"""Steps and time that a run takes, estimated before it begins.

As a run begins its seconds are steps times the time of one: a constant, and a part for each node and contact, by
engine, from the measurements of docs/notes/speed.md. `check` computes the first part of the run instead, and
extrapolates its steps and its time of the processor. Compilation is no part of either.
"""

from __future__ import annotations

import math
import time
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.capabilities import SUPERPOSED, SYSTEM, WIRES, engine_of
from ropewalk.errors import RopewalkError
from ropewalk.model.consistency import nodes_of
from ropewalk.model.load import ExternalModel
from ropewalk.model.mesh import is_asked_for
from ropewalk.model.plausibility import implausible
from ropewalk.model.run import Dynamic, Linear, Quasistatic
from ropewalk.results.frame import RunInfo
from ropewalk.results.running import TimeHistory

if TYPE_CHECKING:
    from ropewalk.model.scenario import Scenario
    from ropewalk.results.running import Run

# us of a step, of a node in it and of a contact in it.
_OF_SYSTEM, _OF_NETS, _OF_WIRES, _OF_CHAINS = (
    (1.0, 0.008, 2.5),
    (30.0, 0.065, 2.5),
    (1.0, 0.0014, 0.5),
    (0.4, 0.008, 0.4),
)
_PILOT = 0.7  # s of the processor, that the first part of a run takes
_LONGEST = 2.0  # s, that an output interval may take at most to be computed for this
MOST_NODES = 20_000  # of a motion that is made ready to see how long it will be: more take a minute and gigabytes
_BODIES = ("mass", "oscillator", "vehicle", "train", "matrices", "pantograph")
_LARGE = 20.0  # times as much of a node of wires whose motion is not linearised: inner steps


@dataclass(frozen=True)
class Effort:
    """What is to be expected of a motion.

    Args:
        steps: how many; None where the method finds their length on the way.
        step: s, of the largest one.
        nodes: of all lines.
        seconds: that it takes, about, kernels compiled; None where that cannot be known.
        adaptive: whether the method finds the length of its steps on the way.
    """

    steps: int | None
    step: float
    nodes: int
    seconds: float | None
    adaptive: bool = False

    def __str__(self) -> str:
        if self.steps is None:
            return f"{self.nodes} nodes, in steps of adaptive length"
        size = f"{1e6 * self.step:.3g} us" if self.step < 1e-3 else f"{1e3 * self.step:.3g} ms"
        steps = f"about {_rounded(self.steps)} steps of {'at most ' if self.adaptive else ''}{size}"
        return f"{steps} for {self.nodes} nodes, {about(self.seconds)}"


def effort_of(scenario: Scenario, run: Run, run_info: RunInfo) -> Effort | None:
    """What is to be expected of a run that is ready to begin; None of one that is no motion.

    Args:
        scenario: the scenario.
        run: of it.
        run_info: of it, where its engine has noted method and step.
    """
    if not isinstance(run, TimeHistory):
        return None
    times, step, layout = run.engine.times, run_info.step, run.layout
    nodes, contacts = len(layout.node_line), len(layout.contact_load)
    if step is None or not 0.0 < step < float(times[-1]) or run_info.method == "implicit":
        return Effort(None, 0.0, nodes, None)
    steps = int(np.ceil(np.diff(times) / step - 1e-9).clip(1.0).sum())
    engine = engine_of(scenario)
    own, of_node, of_contact = _OF_WIRES if engine is WIRES else _OF_CHAINS
    if engine is SYSTEM:
        own, of_node, of_contact = _OF_NETS if scenario.nets else _OF_SYSTEM
    if engine is WIRES and isinstance(scenario.run, Dynamic) and scenario.run.geometry == "nonlinear":
        of_node *= _LARGE
    if run_info.method == "rkn6":  # forces are found eleven times in a step
        own, of_node, of_contact = 11.0 * own, 11.0 * of_node, 11.0 * of_contact
    return Effort(steps, step, nodes, 1e-6 * steps * (own + of_node * nodes + of_contact * contacts))


def foreseen(scenario: Scenario) -> tuple[str, list[str]]:
    """Describe the work of a run, whose first part is computed for that, and list warnings about its scenario.

    Runs whose kernels are not compiled yet, with models of others or on several meshes are not prepared.

    Raises:
        RopewalkError: the run would not begin.
    """
    from ropewalk.simulate import sample_warnings  # lazy: as below

    warnings = [*sample_warnings(scenario), *implausible(scenario)]
    work, more = _prepared(scenario)
    return work, warnings + [warning for warning in more if warning not in warnings]


def _prepared(scenario: Scenario) -> tuple[str, list[str]]:
    """Describe the work of a run, and list what its engine warns of when it is made ready."""
    from ropewalk.simulate import must_compile, run_of  # lazy: who asks about a run that has begun needs neither

    run = scenario.run
    if isinstance(run, Quasistatic):
        return f"{run.positions} equilibria", []
    if isinstance(run, Linear):
        if engine_of(scenario) is not SUPERPOSED or not any(load.kind in _BODIES for load in scenario.loads.values()):
            return "closed-form or modal solution, no time steps", []
        return "modal superposition; steps of the bodies are halved until the results converge", [
            "bodies on modes of a structure take 10 to 100 times as long as direct integration; for a shorter run, "
            "write run: {kind: dynamic, geometry: linearised}"
        ]
    if not isinstance(run, Dynamic):
        return "one equilibrium", []
    if any(isinstance(load, ExternalModel) for load in scenario.loads.values()):
        return "dynamic: external models, run time not estimated", []
    if is_asked_for(scenario.parts):
        return "dynamic: on several meshes", []
    if (nodes := nodes_of(scenario.parts)) > MOST_NODES:
        return f"dynamic: {nodes} nodes, step size determined at the start", []
    if how_long := must_compile(scenario):
        return f"dynamic: steps and run time are estimated once its kernels are compiled (once, {how_long})", []
    run_info = RunInfo()
    ready = run_of(scenario, run_info)
    effort, warnings = effort_of(scenario, ready, run_info), list(run_info.warnings)
    if effort is None or not isinstance(ready, TimeHistory):
        return "dynamic", warnings
    return f"dynamic: {_piloted(effort, ready, run_info)}", warnings


def _piloted(effort: Effort, run: TimeHistory, run_info: RunInfo) -> Effort:
    """What a run will be, from its first part, which is computed for about a second.

    Time per step is that of the second half of that part: kernels are loaded in the first. Where steps are adaptive
    their rate falls from there towards one per output interval as damping calms the motion: their geometric mean holds.
    """
    times = run.engine.times
    if effort.seconds is not None and effort.seconds > _LONGEST * (times.size - 1):
        return effort
    noted = [(0.0, 0, 0.0)]  # s of the motion, steps, s of the processor
    begun = time.process_time()
    with suppress(RopewalkError):
        for frames in run.blocks():
            noted.append((float(frames.path[-1]), run_info.steps, time.process_time() - begun))
            if noted[-1][2] > _PILOT:
                break
    reached, taken, _ = noted[-1]
    half = max((one for one in noted if one[0] <= 0.5 * reached), key=lambda one: one[0])
    span, steps, spent = (last - before for last, before in zip(noted[-1], half, strict=True))
    if not span > 0.0 or not steps:
        return effort
    count, largest = effort.steps, float(np.diff(times).max())
    if count is None:
        lowest, rate = (times.size - 1) / float(times[-1]), steps / span
        count = int(taken + (float(times[-1]) - reached) * math.sqrt(max(rate, lowest) * lowest))
    step = min(effort.step or largest, largest)
    return replace(effort, steps=count, step=step, seconds=count * spent / steps, adaptive=effort.steps is None)


def about(seconds: float | None) -> str:
    """A time in words, no finer than it is known."""
    if seconds is None:
        return "for an unknown time"
    if seconds < 1.5:
        return "about a second" if seconds > 0.5 else "less than a second"
    for unit, size in (("s", 1.0), ("min", 60.0), ("h", 3600.0)):
        if seconds < 99.5 * size or unit == "h":
            return f"about {_rounded(seconds / size)} {unit}"
    raise AssertionError


def _rounded(number: float) -> str:
    """Two digits of a number, with spaces between thousands."""
    size = 10.0 ** max(np.floor(np.log10(max(float(number), 1.0))) - 1.0, 0.0)
    return f"{round(number / size) * size:,.0f}".replace(",", " ")
