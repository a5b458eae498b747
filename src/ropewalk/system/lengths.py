"""Unstrained lengths of lines that are given by their tension: with these they have it in the mean at rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.assembly import pack
from ropewalk.mechanics.chain import Array
from ropewalk.model.law import Inextensible
from ropewalk.model.line import Line
from ropewalk.model.scenario import Scenario
from ropewalk.networks.lengths import check_joined, not_found
from ropewalk.system.assembled import Assembled
from ropewalk.system.rest import at_rest, tensions
from ropewalk.system.structure import Structure

# Rests that are sought at most, and the part of a tension to which it is found; what rounding may leave of it.
_ROUNDS, _NEAR, _ROUNDING = 30, 1e-9, 1e-6
# Of its length, by which a line is cut shorter or longer at once.
_FAR = 0.02


Build = Callable[[Mapping[str, float] | None, Assembled | None], Assembled]
"""Makes a structure with given lengths of all lines, m, and about its rest, where that of others is known."""


def with_tensions(scenario: Scenario, build: Build) -> Assembled:
    """A structure whose lines are as long as their tensions want them, and about how it rests.

    Lengths are found by Broyden's method, which begins with what a line by itself would answer by its stretch and sag.

    Args:
        scenario: what is there.
        build: makes the structure; without lengths it finds about the right ones.

    Raises:
        EquilibriumError: there is no rest, or not with these tensions.
    """
    names = list(scenario.lines)
    given = [name for name, line in scenario.lines.items() if line.length is None]
    at = [names.index(name) for name in given]
    wanted = np.array([scenario.lines[name].tension for name in given])
    assembled, found = _rested(scenario, build(None, None))
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
        raise EquilibriumError(not_found(scenario, dict(zip(given, found[at].tolist(), strict=True))))
    check_joined(scenario, dict(zip(names, lengths.tolist(), strict=True)))
    return assembled


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
