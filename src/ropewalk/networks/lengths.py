"""Unstrained lengths of lines that are given by their tension at rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.assembly import pack
from ropewalk.model.joint import Joined
from ropewalk.model.scenario import Scenario
from ropewalk.model.support import Guided
from ropewalk.networks.assembly import Laid, lay
from ropewalk.networks.network import Array
from ropewalk.networks.rest import leave, settle
from ropewalk.results.frame import RunInfo

_ROUNDS, _NEAR = 60, 1e-9
_SLACK = 1e-10  # tension over EA of a line at rest that nothing pulls at
_FAR = 0.02  # of its length, by which a line is cut shorter or longer at once


def laid_at_rest(
    scenario: Scenario, until: float, lengths: Mapping[str, float] | None = None, *, near: float = _NEAR
) -> tuple[Laid, Array]:
    """A network at rest without its loads: lines of given tension are cut so that they have it in the mean.

    Args:
        scenario: what is there.
        until: how long the histories of the loads are needed, s.
        lengths: of all lines without strain, m, if they are known.
        near: part of a tension to which it is found.

    Returns:
        The network, and the places of its nodes and contacts (node, 3) in m.

    Raises:
        EquilibriumError: there is no rest, or not with these tensions.
    """
    given = {}
    lengths = dict(lengths or {})
    for name, line in scenario.lines.items():
        if name in lengths:
            continue
        if line.length is not None:
            lengths[name] = line.length
            continue
        assert line.tension is not None
        packed = pack(line.law, line.axial_stiffness)
        given[name] = packed, line.tension, law.strain(packed, line.tension)
        lengths[name] = line.distance / (1.0 + given[name][2])
    start: Array | None = None
    last: dict[str, tuple[float, float]] = {}
    for _ in range(_ROUNDS):
        laid = lay(scenario, lengths, until)
        leave(laid.network)
        contacts = laid.network.locations.kind.size
        first = (
            np.concatenate([laid.place, np.zeros((contacts, 3))]) if start is None else _restrained_there(laid, start)
        )
        start = settle(laid.network, first)
        if not given:
            return laid, start
        worst = 0.0
        for strand in laid.strands:
            if strand.name not in given:
                continue
            packed, wanted, strain = given[strand.name]
            segments = np.linalg.norm(np.diff(start[strand.node], axis=0), axis=1)
            rest = np.diff(strand.station)
            tension = law.tensions(packed, segments / rest - 1.0)
            mean, length = float((tension * rest).sum() / rest.sum()), lengths[strand.name]
            worst = max(worst, abs(mean / wanted - 1.0))
            # As long as its shape hardly changes, this is what leaves it the wanted strain.
            better = float(segments.sum()) / (1.0 + strain)
            if strand.name in last:  # where sag decides, not stretch, the secant knows better
                before, then = last[strand.name]
                slope = (mean - then) / (length - before) if length != before else 0.0
                if slope < 0.0:
                    better = length + float(np.clip((wanted - mean) / slope, -_FAR * length, _FAR * length))
            last[strand.name] = length, mean
            lengths[strand.name] = better
        if worst < near:
            if near == _NEAR:
                check_joined(scenario, lengths)
            return laid, start
    raise EquilibriumError(not_found(scenario, {name: mean for name, (_, mean) in last.items()}))


def _restrained_there(laid: Laid, start: Array) -> Array:
    """A shape (node, 3) m with what is held where it is held: places of inner supports go with the length of a line."""
    restrained, out = laid.network.restrained, start.copy()
    out[restrained.fixed] = laid.place[restrained.fixed]
    along = ((start[restrained.rail] - laid.place[restrained.rail]) * restrained.along).sum(axis=1)
    out[restrained.rail] = laid.place[restrained.rail] + along[:, None] * restrained.along
    return out


def check_joined(scenario: Scenario, lengths: Mapping[str, float]) -> None:
    """Refuse ends that are joined to a line beyond the length that its tension gives it, and supports there."""
    for name, line in scenario.lines.items():
        for key, inner in line.supports.items():
            if lengths[name] <= inner.at * (1.0 + 1e-9):
                raise EquilibriumError(
                    f"lines.{name}.supports.{key}.at: {inner.at:g} m is not between the ends of the line, which with "
                    f"its tension is {lengths[name]:.6g} m long; stay within that"
                )
        for key, support in (("start_support", line.start_support), ("end_support", line.end_support)):
            if not isinstance(support, Joined) or not isinstance(support.at, float):
                continue
            if (length := lengths[support.to]) * (1.0 + 1e-9) < support.at:
                raise EquilibriumError(
                    f"lines.{name}.{key}.at: {support.at:g} m is off the line {support.to}, which with its tension is "
                    f"{length:.6g} m long; stay within that"
                )


def not_found(scenario: Scenario, found: Mapping[str, float]) -> str:
    """Why lines do not have their given tension at rest: the one furthest from it, and what may set it instead."""
    given = {name: line.tension or 0.0 for name, line in scenario.lines.items() if line.length is None}
    name = max(given, key=lambda key: abs(found[key] / given[key] - 1.0))
    guided = [
        f"lines.{other}.{key}"
        for other, it in scenario.lines.items()
        for key in ("start_support", "end_support")
        if isinstance(getattr(it, key), Guided)
    ]
    remedy = f"give length instead of lines.{name}.tension"
    if guided:
        remedy += f", or change {' and '.join(guided)}: an end that is free along its rail sets the tension itself"
    tried = f"{len(given)} lines with a given tension do not come to rest with it" if len(given) > 1 else (
        f"line {name} does not come to rest with its tension")  # fmt: skip
    return f"lines.{name}.tension: {tried}: {found[name]:.5g} N instead of {given[name]:g} N; {remedy}"


def doubt_slack(scenario: Scenario, run_info: RunInfo, on: Sequence[str], tension: Array) -> None:
    """Doubt shapes of lines without stiffness that nothing pulls at: without weight any other is as good.

    Args:
        scenario: what is there.
        run_info: takes the doubts.
        on: (link,) names of the lines of links.
        tension: (link,) N, at rest.
    """
    if scenario.gravity != 0.0:
        return
    for name, line in scenario.lines.items():
        if line.has_bending_stiffness:
            continue
        mine = np.array([own == name for own in on])
        if not line.has_bending_stiffness and np.abs(tension[mine]).max() < _SLACK * (line.axial_stiffness or 1.0):
            run_info.doubt(
                f"line {name} is slack and has no weight: its shape at rest is one of many",
                "it is longer than the way between what holds it, and gravity is 0", f"lines.{name}.length",
                "give gravity, or make it shorter",
            )  # fmt: skip
