"""Equilibrium from any drawing: lines that are as soft as their loads are heavy hang taut, then become stiffer.

A slack line that hardly stretches makes the energy a narrow, curved valley, and its links may fold. The same line with
an axial stiffness of the size of all loads is taut everywhere, and Newton's method finds its equilibrium from a rough
drawing; from there stiffness grows by a constant factor to what it is.
"""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from typing import Any

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array
from ropewalk.solve import minimum
from ropewalk.solve.search_budget import SearchBudgetError
from ropewalk.solve.sensitivity import not_noted
from ropewalk.solve.symmetric import Way
from ropewalk.system.elements.structure import Structure

# Least axial stiffness over all loads: lines that are softer hang far below where they are. And the factor of a step.
_LEAST, _FACTOR = 5.0, 5.0


def softened(structure: Structure, load: float = 0.0) -> Iterator[Structure]:
    """Yield a structure with softer lines, ever stiffer; none where all are soft, or run over saddles (they pass them).

    Args:
        structure: whose lines these are; those that bend stay.
        load: N, of what stands on them.
    """
    runs, restraints = structure.runs, structure.restraints
    if structure.saddles is not None:
        return
    least = _LEAST * (load + float(np.abs(structure.nodes.force).sum() + np.abs(restraints.force).sum()))
    stiffness = np.array([law.tangent(row, 1e-9) for row in runs.law])
    soft = (runs.law[:, 0] != law.RIGID) & (runs.law[:, 0] != law.TABLE) & (runs.bending == 0.0) & (stiffness > least)
    while least > 0.0 and (soft & (stiffness > least)).any():
        part = np.where(soft, np.minimum(least / np.where(soft, stiffness, 1.0), 1.0), 1.0)
        rows = runs.law.copy()
        rows[:, 2:] *= part[:, None]
        yield structure._replace(runs=runs._replace(law=rows))
        least *= _FACTOR


def stiffened(potential: Any, start: Array, load: float, way: Way) -> Iterator[Array]:
    """Yield the equilibrium next to a shape of softer lines that have become as stiff as they are nearly.

    Args:
        potential: `SystemPotential` of the structure.
        start: a shape, m.
        load: N, of what stands on the lines.
        way: of solving, see `solve/symmetric.py`.

    Raises:
        SearchBudgetError: that takes too long.
    """
    soft, near = copy(potential), start
    soft.approaches = lambda *_: iter(())
    for soft.structure in softened(potential.structure, load):
        try:
            with not_noted():
                near = minimum.settle(soft, near, way)
        except SearchBudgetError:
            raise
        except EquilibriumError:  # what has been found is closer all the same
            break
    if near is not start:
        yield near
