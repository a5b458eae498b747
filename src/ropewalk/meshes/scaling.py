"""Scaling: the same scenario on a finer or a coarser mesh."""

from __future__ import annotations

from typing import Any

from ropewalk.errors import RopewalkError
from ropewalk.model.division import links_of_line
from ropewalk.model.mesh import OF_BEAMS
from ropewalk.model.run import Linear
from ropewalk.model.scenario import Scenario

IN_TIME = 0.1  # of a wanted accuracy, what steps may miss


def begun(scenario: Scenario, links: int) -> Scenario:
    """The coarsest mesh from which one is chosen: links of about one length, with nodes where inner supports are.

    Steps are to miss a part of the wanted accuracy, where they are chosen for one.

    Args:
        scenario: with elements that are to be found.
        links: of the longest line.

    Raises:
        RopewalkError: what is asked for does not go with it.
    """
    lengths = {name: line.length or line.distance for name, line in scenario.lines.items()}
    lines = {}
    for name, line in scenario.lines.items():
        coarse = max(OF_BEAMS, round(links * lengths[name] / max(lengths.values())))
        lines[name] = line.model_copy(update={"elements": coarse})
        lines[name] = line.model_copy(update={"elements": links_of_line(lines[name])})
    run = scenario.run
    assert not isinstance(run, Linear)
    try:
        accuracy = None if run.accuracy is None else IN_TIME * run.accuracy
        return _remade(scenario, lines=lines, run=run.model_copy(update={"accuracy": accuracy}))
    except RopewalkError:  # steps are as long as they are stable
        return _remade(scenario, lines=lines, run=run.model_copy(update={"accuracy": None}))


def scaled(scenario: Scenario, times: float, *, mesh_error: bool = False) -> Scenario:
    """The same with so many times the elements of all lines, cells of nets, and elements of overhead lines.

    Raises:
        RopewalkError: what is asked for does not go with it.
    """
    lines = {
        name: line.model_copy(update={"elements": round(times * line.elements)})
        for name, line in scenario.lines.items()
    }
    nets = {
        name: net.model_copy(update={"cells": tuple(round(times * n) for n in net.cells or ())})
        for name, net in scenario.nets.items()
    }
    overhead = {
        name: line.model_copy(update={"element": line.element / times})
        for name, line in scenario.overhead_lines.items()
    }
    run = scenario.run.model_copy(update={"mesh_error": mesh_error})
    return _remade(scenario, lines=lines, nets=nets, overhead_lines=overhead, run=run)


def links_in(scenario: Scenario) -> int:
    """The number of links of all lines."""
    return sum(line.elements for line in scenario.lines.values())


def _remade(scenario: Scenario, **changes: Any) -> Scenario:
    """A scenario with changes, checked anew.

    Raises:
        ScenarioError: it is refused.
    """
    own = {name: getattr(scenario, name) for name in type(scenario).model_fields}
    return Scenario(**(own | changes))
