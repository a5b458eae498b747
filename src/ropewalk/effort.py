"""How much work a run will be, from the step that its engine has chosen: told before it begins.

Seconds are steps times what one takes: a part of its own, and one for each node and contact, by engine, from the
measurements of docs/notes/speed.md (what a run will take). Machines differ, and one that is busy takes longer.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.capabilities import SUPERPOSED, SYSTEM, WIRES, engine_of
from ropewalk.model.load import ExternalModel
from ropewalk.model.mesh import is_asked_for
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
_BODIES = ("mass", "oscillator", "vehicle", "train", "matrices", "pantograph")
_LARGE = 20.0  # times as much of a node of wires whose motion is not linearised: inner steps


@dataclass(frozen=True)
class Effort:
    """What is to be expected of a motion.

    Args:
        steps: how many; None where the method finds their length on the way.
        step: s, of one.
        nodes: of all lines.
        seconds: that it takes, about, kernels compiled; None where that cannot be known.
    """

    steps: int | None
    step: float
    nodes: int
    seconds: float | None

    def __str__(self) -> str:
        if self.steps is None:
            return f"{self.nodes} nodes, in steps whose length is found on the way"
        steps = f"about {_rounded(self.steps)} steps of {1e6 * self.step:.3g} us"
        return f"{steps} for {self.nodes} nodes, {about(self.seconds)}"


def effort_of(scenario: Scenario, run: Run, run_info: RunInfo) -> Effort | None:
    """What is to be expected of a run that is ready to begin; None of one that is no motion.

    Args:
        scenario: what is computed.
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
    """What a run will be, in words, and what is to be remarked of how it begins; it is made ready for that.

    Nothing is made ready whose kernels are not compiled yet, nor models of others, nor several meshes.

    Raises:
        RopewalkError: the run would not begin.
    """
    from ropewalk.simulate import must_compile, run_of  # lazy: who asks about a run that has begun needs neither

    run = scenario.run
    if isinstance(run, Quasistatic):
        return f"{run.positions} equilibria", []
    if isinstance(run, Linear):
        if engine_of(scenario) is not SUPERPOSED or not any(load.kind in _BODIES for load in scenario.loads.values()):
            return "closed forms or modes, without steps", []
        return "modes, and bodies in steps that are halved until results stay the same", [
            "bodies on modes of a structure take 10 to 100 times as long as steps of the whole motion; to wait less, "
            "write run: {kind: dynamic, geometry: linearised}"
        ]
    if not isinstance(run, Dynamic):
        return "one equilibrium", []
    if any(isinstance(load, ExternalModel) for load in scenario.loads.values()):
        return "a motion with models of others, which are not asked here", []
    if is_asked_for(scenario.parts):
        return "a motion on several meshes", []
    if how_long := must_compile(scenario):
        return (
            f"a motion; its steps are told once kernels are compiled (once for each kind of structure, {how_long})",
            [],
        )
    run_info = RunInfo()
    effort = effort_of(scenario, run_of(scenario, run_info), run_info)
    return "a motion" if effort is None else f"a motion: {effort}", run_info.warnings


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
    size = 10.0 ** max(np.floor(np.log10(max(number, 1.0))) - 1.0, 0.0)
    return f"{round(number / size) * size:,.0f}".replace(",", " ")
