"""Unstrained lengths of lines that are given by their tension: with these they have it in the mean at rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.assembly import pack
from ropewalk.mechanics.chain import Array
from ropewalk.model.joint import Joined
from ropewalk.model.law import Inextensible
from ropewalk.model.line import Line
from ropewalk.model.scenario import Scenario
from ropewalk.model.support import Guided
from ropewalk.system.assembling.assembled import Assembled
from ropewalk.system.elements.structure import Structure
from ropewalk.system.equilibrium.rest import at_rest, tensions

# Rests that are sought at most, and the part of a tension to which it is found; what rounding may leave of it.
_ROUNDS, _NEAR, _ROUNDING = 30, 1e-9, 1e-6
# Of its length, by which a line is cut shorter or longer at once.
_FAR = 0.02


Build = Callable[[Mapping[str, float], Assembled | None], Assembled]
"""Makes a structure with given lengths of all lines, m, and about its rest, where that of others is known."""


def with_tensions(scenario: Scenario, build: Build) -> Assembled:
    """A structure whose lines are as long as their tensions want them, and about how it rests.

    Lengths are found by Broyden's method, which begins with what a line by itself would answer by its stretch and sag.

    Args:
        scenario: what is there.
        build: makes the structure.

    Raises:
        EquilibriumError: there is no rest, or not with these tensions.
    """
    names = list(scenario.lines)
    given = [name for name, line in scenario.lines.items() if line.length is None]
    at = [names.index(name) for name in given]
    wanted = np.array([scenario.lines[name].tension for name in given])
    assembled, found = _rested(scenario, build(about(scenario), None))
    lengths, miss = assembled.structure.lines.length[: len(names)].copy(), found[at] / wanted - 1.0
    H = np.diag([-_answer(scenario.lines[name], scenario.gravity) for name in given])
    for _ in range(_ROUNDS):
        largest = float(np.abs(miss).max())
        if largest < _NEAR:
            break
        step = np.clip(-H @ miss, -_FAR * lengths[at], _FAR * lengths[at])
        lengths[at] += step
        assembled, found = _rested(scenario, build(dict(zip(names, lengths.tolist(), strict=True)), assembled))
        before, miss = miss, found[at] / wanted - 1.0
        if float(np.abs(miss).max()) >= largest and largest < _ROUNDING:
            break
        change = H @ (miss - before)
        if (size := float(step @ change)) != 0.0:
            H += np.outer(step - change, step @ H) / size
    else:
        raise EquilibriumError(_not_found(scenario, dict(zip(given, found[at].tolist(), strict=True))))
    _check_joined(scenario, dict(zip(names, lengths.tolist(), strict=True)))
    return assembled


def about(scenario: Scenario) -> dict[str, float]:
    """Unstrained lengths of all lines, m: those that are given, and those of straight lines with their tension."""
    found = {}
    for name, line in scenario.lines.items():
        if line.length is not None:
            found[name] = line.length
            continue
        assert line.tension is not None
        stretch = 0.0
        if not isinstance(line.law, Inextensible):
            stretch = float(law.strain(pack(line.law, line.axial_stiffness), line.tension))
        found[name] = line.distance / (1.0 + stretch)
    return found


def _rested(scenario: Scenario, assembled: Assembled) -> tuple[Assembled, Array]:
    """A structure with the places of its nodes at rest, and the mean tensions of its lines, (line,) N."""
    gravity = np.zeros(len(assembled.axes))
    gravity[-1] = -scenario.gravity
    structure, rest = at_rest(assembled.structure, gravity, assembled.near, within=scenario.is_plane)
    return replace(assembled, near=rest), mean_tensions(structure, rest)


def mean_tensions(structure: Structure, rest: Array) -> Array:
    """Tensions of all lines at rest (axis, node), in the mean over their lengths without strain, (line,) N."""
    runs, lines, T = structure.runs, structure.lines, tensions(structure, rest)
    over = set() if structure.sheaves is None else set(structure.sheaves.run.tolist())
    out = np.zeros(lines.first.size)
    for i, (first, count) in enumerate(zip(lines.first, lines.runs, strict=True)):
        total = whole = 0.0
        for s in range(first, first + count):
            links = int(runs.links[s]) + (s in over)
            total += float(T[runs.first[s] : runs.first[s] + links].sum() * runs.h[s])
            whole += links * float(runs.h[s])
        out[i] = total / whole if whole else 0.0
    return out


def _answer(line: Line, gravity: float) -> float:
    """By how much a line by itself is shorter for a tension that is larger by all of it, m: stretch, and sag."""
    assert line.tension is not None
    strain, stretch, T, span = 0.0, 0.0, line.tension, line.distance
    if not isinstance(line.law, Inextensible):
        packed = pack(line.law, line.axial_stiffness)
        strain = float(law.strain(packed, T))
        stretch = T / float(law.tangent(packed, strain))
    weight = line.mass * gravity * span
    return span * (stretch / (1.0 + strain) ** 2 + (weight / T) ** 2 / 12.0)


def _check_joined(scenario: Scenario, lengths: Mapping[str, float]) -> None:
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


def _not_found(scenario: Scenario, found: Mapping[str, float]) -> str:
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
    far = f"{found[name]:.5g} N instead of {given[name]:g} N"
    if (missed := abs(found[name] / given[name] - 1.0)) < 1e-4:  # digits that are printed are the same
        far = f"of {given[name]:g} N the search misses {missed:.1e}"
    return f"lines.{name}.tension: {tried}: {far}; {remedy}"
