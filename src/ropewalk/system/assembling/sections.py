"""Sections of lines, each of which is a run: they end where something is joined or a line turns, and beside sheaves."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.model.capabilities import refusal
from ropewalk.model.scenario import Scenario
from ropewalk.system.assembling.laid import Laid
from ropewalk.system.capabilities import between_nodes
from ropewalk.system.elements.structure import Sheaves


def sections_of(scenario: Scenario, laid: Laid, corners: set[int]) -> Iterator[tuple[str, Integers, Array]]:
    """Runs of all lines: names, nodes as laid out, stations in m.

    They end where something is joined or a line turns, and beside sheaves.

    Args:
        scenario: what is there.
        laid: the same laid out.
        corners: nodes in which edge cables turn.
    """
    uses = np.bincount(np.concatenate([[0], *(strand.node for strand in laid.strands)]), minlength=laid.place.shape[0])
    uses[0] -= 1
    turns = corners | laid.split
    for strand in laid.strands:
        line, last = scenario.lines.get(strand.name), strand.node.size - 1
        supports = line.supports.values() if line is not None else ()
        places = [support.at for support in supports]
        places += [line.cut.at] if line is not None and line.cut is not None else []
        restrained = {int(np.abs(strand.station - at).argmin()) for at in places}
        inner = [
            i for i in range(1, last) if uses[strand.node[i]] > 1 or i in restrained or int(strand.node[i]) in turns
        ]
        if line is not None and line.bending_stiffness:  # it does not end where something is joined to it
            if np.ptp(np.diff(strand.station)) > 1e-9 * strand.station[-1]:
                raise refusal(between_nodes(strand.name, line.elements))
            inner = []
        over = np.array([s.link for s in laid.sheaves if s.line == strand.name and s.link >= 0], dtype=np.int64)
        for i, j in pairwise(sorted({0, last, *inner})):
            marks = [i, *(p + k for p in sorted(over[(i <= over) & (over < j)].tolist()) for k in (0, 1)), j]
            for begin, end in zip(marks[::2], marks[1::2], strict=True):
                if begin == end:
                    raise EquilibriumError(
                        f"lines: {strand.name}: elements: a sheave stands next to another one, or to where something "
                        "is joined to the line; write more elements"
                    )
                yield strand.name, strand.node[begin : end + 1], strand.station[begin : end + 1]


def sheaves_of(laid: Laid, sections: list[tuple[str, Integers, Array]], weight: Array, first: int) -> Sheaves | None:
    """Sheaves over which lines run, as they are laid out.

    Args:
        laid: the lines.
        sections: their runs.
        weight: (section, axis) N/m.
        first: the first of the nodes of all sheaves.
    """
    own = [sheave for sheave in laid.sheaves if sheave.link >= 0]
    if not own:
        return None
    ends, starts = ([(name, int(nodes[at])) for name, nodes, _ in sections] for at in (-1, 0))
    pairs, lines = list(zip(ends[:-1], starts[1:], strict=True)), {strand.name: strand.node for strand in laid.strands}
    run = np.array(
        [pairs.index(((s.line, int(lines[s.line][s.link])), (s.line, int(lines[s.line][s.link + 1])))) for s in own],
        dtype=np.int64,
    )
    return Sheaves(
        first + np.arange(run.size), run, np.array([s.ahead for s in own]), np.array([s.friction for s in own]),
        np.zeros((run.size, 2)), np.zeros(run.size), weight[run],
    )  # fmt: skip
