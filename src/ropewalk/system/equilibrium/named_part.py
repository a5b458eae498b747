"""Names of parts of a structure, for messages about its equilibrium."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.solve.search_budget import names_of_runs
from ropewalk.system.elements.structure import Structure


def named_part(structure: Structure, shape: Array, way: Array, places: tuple[int, ...]) -> str:
    """Return the line of the node that moves most with a change of a shape, and where it is.

    Args:
        structure: whose part it is.
        shape, way: places of nodes and coordinates of loads, and their change, m.
        places: (axis, node) how many places of nodes there are.
    """
    count, far = int(np.prod(places)), np.abs(way)
    if far[:count].max(initial=0.0) < far[count:].max(initial=0.0):
        return "a body of a load"
    node = int(far[:count].reshape(places).max(axis=0).argmax())
    at = ", ".join(f"{x:.4g}" for x in shape[:count].reshape(places)[:, node])
    runs, names = structure.runs, names_of_runs()
    own = np.flatnonzero((runs.first <= node) & (node <= runs.first + runs.links))
    line = f"line {names[own[0]]}" if own.size and own[0] < len(names) else "the structure"
    return f"{line} near ({at}) m"
