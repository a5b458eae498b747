"""Stepwise: a scenario made ready to be moved from outside, step by step."""

from __future__ import annotations

from collections.abc import Mapping

from ropewalk.capabilities import ROPES, WIRES
from ropewalk.cosim.chained import Chained
from ropewalk.cosim.outside import Outside, Stepwise
from ropewalk.errors import Problem, ScenarioError, did_you_mean
from ropewalk.model.capabilities import refusal
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario


def stepwise(scenario: Scenario, outside: Mapping[str, Outside], *, step: float | None = None) -> Stepwise:
    """Make a scenario ready to be moved from outside.

    Args:
        scenario: of kind dynamic.
        outside: its contacts from outside, by name.
        step: of wires (stiff and overhead lines): the step that it will be moved by, or a part of it; s.

    Raises:
        ScenarioError: the scenario is of another kind, or a contact is on no line of it.
        RopewalkError: it has no rest to begin with.
    """
    if not isinstance(scenario.run, Dynamic):
        wrong, remedy = "a run without a motion cannot be moved from outside", "write kind: dynamic"
        raise ScenarioError([Problem("run.kind", wrong, scenario.run.kind, remedy)])
    lines = [*scenario.lines, *scenario.overhead_lines, *scenario.nets]
    for name, contact in outside.items():
        if contact.on not in lines:
            remedy = did_you_mean(contact.on, lines)
            raise ScenarioError([Problem(f"contact {name}", "there is no such line", contact.on, remedy)])
        if name in scenario.loads:
            raise ScenarioError([Problem(f"contact {name}", "a load has that name", name, "give it another")])
    if scenario.is_network or scenario.parts.has_inextensible:
        from ropewalk.cosim.on_system import OnSystem  # lazy: as below

        return OnSystem(scenario, outside)
    if scenario.has_bending_stiffness:
        for found in WIRES.motion.unsupported(scenario.parts):
            raise refusal(found)
        from ropewalk.cosim.wired import Wired  # lazy: it needs kernels of its own

        return Wired(scenario, outside, step)
    for found in ROPES.motion.unsupported(scenario.parts):  # what the system moves
        raise refusal(found)
    return Chained(scenario, outside)
