"""One at a time: how far quantities swing while one parameter goes through its values and all others stay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np

from ropewalk.mechanics.chain import Array

SWINGS = {
    "least": "least value of a quantity while only this parameter varies",
    "largest": "largest value of it",
}
"""Names of what is told, with what they are."""


def swings(levels: Sequence[int], values: Mapping[str, Array]) -> dict[str, Array]:
    """What quantities swing between, (quantity, parameter), by their names; NaN where a case has no value.

    Args:
        levels: how many values each parameter takes.
        values: (case,) by quantity: of the scenario as it is, then of each value of each parameter in turn.
    """
    ends = 1 + np.cumsum([0, *levels])
    out = {name: np.full((len(values), len(levels)), np.nan) for name in SWINGS}
    for i, given in enumerate(values.values()):
        for k, (first, last) in enumerate(pairwise(ends)):
            own = np.array([given[0], *given[first:last]])
            out["least"][i, k], out["largest"][i, k] = own.min(), own.max()
    return out
