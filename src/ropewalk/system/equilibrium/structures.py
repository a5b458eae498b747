"""The structure of a scenario, about as it rests without its loads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.assembly import axes_of
from ropewalk.mechanics.chain import Array
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.solve.search_budget import search
from ropewalk.system.assembling.assembled import Assembled
from ropewalk.system.assembling.assembly import assembled_of
from ropewalk.system.assembling.laid import Laid, Over, lay
from ropewalk.system.assembling.overhead_lines import overhead_lines_of
from ropewalk.system.elements.structure import Structure
from ropewalk.system.equilibrium.constrained import nearly
from ropewalk.system.equilibrium.lengths import about, with_tensions
from ropewalk.system.equilibrium.over_saddles import laid_over_saddles
from ropewalk.system.equilibrium.rest import at_rest, tensions, with_ends
from ropewalk.system.equilibrium.split_lines import LineShape, SplitLines
from ropewalk.system.equilibrium.tracks import on_ends, with_tracks

# Part of a link within which a node is at a sheave, and how many elements more are tried.
_AT, _MORE = 3e-4, 4


def structure_of(scenario: Scenario, until: float, axes: tuple[str, ...] | None = None) -> Assembled:
    """The structure of a scenario, without its loads.

    Args:
        scenario: what is there.
        until: how long histories are needed, s.
        axes: names of the axes, if not those that the scenario needs.

    Raises:
        EquilibriumError: its lines have no rest, or not with their tensions.
    """
    if scenario.overhead_lines:
        return overhead_lines_of(scenario, axes)
    near, named, parts = nearly(on_ends(scenario)), axes or axes_of(scenario), scenario.parts

    def build(lengths: Mapping[str, float], beside: Assembled | None) -> Assembled:
        laid, places = _laid(near, lengths, until, named)
        found = with_tracks(scenario, assembled_of(scenario, laid, places, until, named))
        alike = beside is not None and not (scenario.tracks or parts.runs_over_sheaves or parts.has_saddles)
        r = beside.near if beside is not None and alike and beside.near.shape == found.near.shape else found.near
        return replace(found, near=found.structure.restraints.put(r))

    if any(line.length is None for line in scenario.lines.values()):
        return with_tensions(scenario, build)
    return build(about(scenario), None)


def rest_before_motion(scenario: Scenario, assembled: Assembled, gravity: Array) -> tuple[Structure, Array]:
    """A structure without loads and the places of its nodes (axis, node) in m at rest, or as drawn if none is needed.

    Raises:
        EquilibriumError: there is no rest, and motion does not begin with a stored instant.
    """
    structure, near = assembled.structure, assembled.near
    with search(assembled.line):
        try:
            return at_rest(structure, gravity, near)
        except EquilibriumError:
            if not begins_with_a_result(scenario):
                raise
    return with_ends(structure, gravity, tensions(structure, near)), near


def begins_with_a_result(scenario: Scenario) -> bool:
    """Whether motion begins with a stored instant, so that no equilibrium is needed."""
    return (
        isinstance(scenario.run, Dynamic)
        and scenario.run.start.kind == "result"
        and scenario.run.geometry != "linearised"
    )


def _laid(scenario: Scenario, lengths: Mapping[str, float], until: float, axes: tuple[str, ...]) -> tuple[Laid, Array]:
    """A scenario laid out, and about where its nodes rest, (node, 3) m."""

    def rest(over: Scenario) -> LineShape:
        return LineShape.of(SplitLines(over, lengths, until, axes).settle())

    if scenario.parts.has_saddles:
        return laid_over_saddles(scenario, lengths, rest)
    if scenario.parts.runs_over_sheaves:
        try:
            shape = rest(scenario)
        except EquilibriumError:
            if not begins_with_a_result(scenario):
                raise
            laid = lay(scenario, lengths)
            return laid, laid.place
        laid = _laid_beside_sheaves(scenario, lengths, shape.over)
        return laid, shape.on(laid)
    laid = lay(scenario, lengths)
    return laid, laid.place


def _laid_beside_sheaves(scenario: Scenario, lengths: Mapping[str, float], over: Over) -> Laid:
    """Lines over sheaves, with an element more where a node would rest right at a sheave: it can be on neither side."""
    lines = dict(scenario.lines)
    for _ in range(_MORE):
        laid = lay(scenario.model_copy(update={"lines": lines}), lengths, over=over)
        strands = {own.name: own.station for own in laid.strands}
        far = [(name, float(np.abs(strands[name] - place).min())) for (name, _), place in over.items()]
        at = {name for name, least in far if least < _AT * lengths[name] / lines[name].elements}
        if not at:
            break
        for name in at:
            lines[name] = lines[name].model_copy(update={"elements": lines[name].elements + 1})
    return laid
