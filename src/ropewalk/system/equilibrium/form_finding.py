"""Form finding: how long hangers are, and where they are joined, so that what they hold rests as it is wanted.

Unknown are the length of each hanger and its place on the line above. A hanger is longer by as much as its foot is too
high, and its head goes back by as much as it is ahead of its foot; Broyden's method learns from each rest how far all
of them answer to that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array
from ropewalk.model.hangers import Hangers, hanger, unstrained
from ropewalk.model.line import Line, spatial
from ropewalk.model.scenario import Scenario
from ropewalk.system.equilibrium.rest import at_rest
from ropewalk.system.equilibrium.structures import structure_of

# Rests that are sought at most, and the part of the span within which feet are where they are wanted.
_ROUNDS, _NEAR = 40, 1e-8
# Part of a hanger, or of a span, by which it changes at once.
_FAR = 0.3


@dataclass(frozen=True)
class _Hanger:
    """One of a row."""

    name: str
    row: Hangers
    line: Line  # as guessed
    span: tuple[Array, Array]  # (3,) m, ends of the line below


def formed(scenario: Scenario) -> Scenario:
    """A scenario with its hangers as lines of their own, found at rest without loads.

    Raises:
        EquilibriumError: there is no rest, or none in which the line below is as wanted.
    """
    if not scenario.hangers:
        return scenario
    hung = [
        _Hanger(name, row, line, (np.array(spatial(below.start)), np.array(spatial(below.end))))
        for label, row in scenario.hangers.items()
        for name, line in scenario.hung(label).items()
        for below in [scenario.lines[row.below]]
    ]
    n, size = len(hung), max(float(np.ptp(one.span, axis=0).max()) for one in hung)
    taut = _by_tension(scenario)
    x = np.array(
        [
            *(one.line.length for one in hung),
            *(_head(one) for one in hung),
            *(unstrained(scenario.lines[name]) for name in taut),
        ],
        dtype=np.float64,
    )
    J = -np.eye(x.size)  # inverse of how what is missed changes with x
    before: tuple[Array, Array] | None = None
    for _ in range(_ROUNDS):
        missed = _missed(scenario, hung, x)
        if np.abs(missed).max() < _NEAR * size:
            return _with(scenario, hung, x)
        if before is not None:
            dx, dF = x - before[0], missed - before[1]
            share = J @ dF
            J += np.outer(dx - share, dx @ J) / (dx @ share)
        step = -J @ missed
        most = np.concatenate([_FAR * x[:n], np.full(x.size - n, _FAR * size / n)])
        before, x = (x, missed), x + step * min(1.0, float((most / np.maximum(np.abs(step), 1e-300)).min()))
    worst = int(np.abs(missed[: 2 * n]).argmax()) % n
    raise EquilibriumError(
        f"hangers.{next(k for k, row in scenario.hangers.items() if row is hung[worst].row)}: no lengths were found "
        f"with which {hung[worst].row.below} has the target shape in equilibrium ({np.abs(missed).max():.2g} m off); "
        "look whether "
        f"{hung[worst].row.above} hangs above it with all of its weight"
    )


def _head(one: _Hanger) -> float:
    at = getattr(one.line.start_support, "at", None)
    assert isinstance(at, float)
    return at


def _with(scenario: Scenario, hung: list[_Hanger], x: Array) -> Scenario:
    """The scenario with hangers of given lengths and places on the lines above, and lengths of lines below, x, m."""
    n, lines, taut = len(hung), dict(scenario.lines), _by_tension(scenario)
    for i, one in enumerate(hung):
        whole, foot, below = (
            unstrained(scenario.lines[one.row.above]),
            getattr(one.line.end_support, "at", 0.0),
            one.row.below,
        )
        if below in taut:  # feet keep their parts of a length that follows from the tension
            foot *= float(x[2 * n + taut.index(below)]) / unstrained(scenario.lines[below])
        head = float(np.clip(x[n + i], 1e-6 * whole, (1.0 - 1e-6) * whole))
        lines[one.name] = hanger(one.row, one.line.start, one.line.end, head, foot, float(x[i]))
    return scenario.model_copy(update={"lines": lines, "hangers": {}})


def _missed(scenario: Scenario, hung: list[_Hanger], x: Array) -> Array:
    """How far feet rest above where they are wanted, and how far ahead of them heads are, m."""
    assembled = structure_of(_with(scenario, hung, x), 0.0)
    gravity = np.zeros(len(assembled.axes))
    gravity[-1] = -scenario.gravity
    r, runs = at_rest(assembled.structure, gravity, assembled.near)[1], assembled.structure.runs
    high, ahead = [], []
    for one in hung:
        own = assembled.line.index(one.name)
        head, foot = r[:, runs.first[own]], r[:, runs.first[own] + runs.links[own]]
        start, end = (place[[0, 2]] if r.shape[0] == 2 else place for place in one.span)
        level = end[:-1] - start[:-1]
        part = float((foot[:-1] - start[:-1]) @ level / (level @ level))
        high.append(float(foot[-1] - start[-1] - part * (end[-1] - start[-1]) - one.row.rise(part)))
        ahead.append(float((head[:-1] - foot[:-1]) @ level) / float(np.linalg.norm(level)))
    found = dict(zip(scenario.lines, assembled.structure.lines.length.tolist(), strict=False))
    longer = [found[name] - x[2 * len(hung) + i] for i, name in enumerate(_by_tension(scenario))]
    return np.array(high + [-a for a in ahead] + longer)


def _by_tension(scenario: Scenario) -> list[str]:
    """Lines with hangers below others whose lengths follow from their tensions."""
    below = dict.fromkeys(row.below for row in scenario.hangers.values())
    return [name for name in below if scenario.lines[name].length is None]
