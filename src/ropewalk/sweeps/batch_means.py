"""How far a mean or a deviation of a stationary record is known: by the means of batches.

Neighbouring instants are alike, so that many of them tell no more than few. Means of batches that are longer than the
memory of the record are as good as independent, and their scatter tells how far the mean of all is known (G. S.
Fishman, Grouping observations in digital simulation, Management Science 24, 1978; from memory, not looked up).
"""

from __future__ import annotations

import numpy as np

from ropewalk.results.frame import Array

BATCHES = (64, 32, 16)  # that are tried, one after the other
_ALIKE = 1.645  # deviations of the correlation of independent neighbours, one-sided 5 %
_LEAST = 4  # values in a batch


def half_width(values: Array, of: str = "mean") -> float | None:
    """Half the width of an interval of 95 % for the mean or the standard deviation of a stationary record.

    Args:
        values: (instant,) at even instants.
        of: mean or std.

    Returns:
        None if the record is too short for its memory, has gaps, or drifts: then even long batches are not independent.
    """
    from scipy.special import stdtrit

    if not np.isfinite(values).all() or not values.size:
        return None
    spread = float(values.std())
    if spread == 0.0:
        return 0.0
    looked = values if of == "mean" else (values - values.mean()) ** 2 / (2.0 * spread)  # whose mean varies as std does
    for count in BATCHES:
        size = values.size // count
        if size < _LEAST:
            continue
        means = looked[values.size - count * size :].reshape(count, size).mean(axis=1)
        apart = means - means.mean()
        whole = float(apart @ apart)
        if whole == 0.0:
            return 0.0
        alike = float(apart[1:] @ apart[:-1]) / whole + 1.0 / count
        if alike < _ALIKE / np.sqrt(count):
            return float(stdtrit(count - 1, 0.975) * np.sqrt(whole / (count - 1) / count))
    return None
