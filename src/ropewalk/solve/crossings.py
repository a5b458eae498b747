"""Instants at which loads come to their lines and leave them, found by bisection between looks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.chain import Array

LOOKS = 1000  # instants of a run at which it is asked who is on a line; who comes and goes in between is not seen
CLOSE = 1e-12  # of the time: how closely instants are found


def crossings(times: Array, seen: NDArray[np.bool_], is_on: Callable[[float], Any], close: float) -> Iterator[float]:
    """Find them.

    Args:
        times: s, of the looks.
        seen: (look, load) who is on a line then.
        is_on: (load,) the same at any instant in s.
        close: s, to which they are found.
    """
    for i, k in zip(*np.nonzero(seen[1:] != seen[:-1]), strict=True):
        low, high = float(times[i]), float(times[i + 1])
        while high - low > close:
            middle = 0.5 * (low + high)
            if is_on(middle)[k] == seen[i, k]:
                low = middle
            else:
                high = middle
        yield 0.5 * (low + high)
