"""Minimum of a convex function by Newton's method with a line search on the slope."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

__all__ = ["minimise"]

FloatArray = NDArray[np.float64]


def minimise(
    gradient: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    start: FloatArray,
    scale: float,
    longest: float = np.inf,
) -> FloatArray:
    """Return where the gradient vanishes; ``gradient`` gives it with its derivative, not finite where forbidden.

    ``scale`` is the size of the gradient's terms, whose roundings end the search; no component of a step is larger
    than ``longest``. `ValueError` if there is no end.
    """
    place = start
    residual, derivative = gradient(place)
    for _ in range(200):
        change = np.asarray(-np.linalg.solve(derivative, residual), dtype=np.float64)
        change *= min(1.0, longest / max(_largest(change), 1e-300))
        descent, miss = float(residual @ change), _largest(residual)
        fraction = 1.0
        trial, trial_derivative = gradient(place + change)
        # Beyond the minimum the slope turns positive; a comparison with NaN is false. Close to it roundings across the
        # valley hide the slope along it, and a smaller gradient is good enough.
        while not (float(trial @ change) <= -0.5 * descent or _largest(trial) <= min(0.5 * miss, 1e-9 * scale)):
            fraction *= 0.5
            trial, trial_derivative = gradient(place + fraction * change)
            if fraction <= 1e-12:
                break
        settled = _largest(change) <= 1e-13 * _largest(place) or miss <= 1e-15 * scale
        # near the end Newton's method squares the error; where it does not even halve it, roundings are left
        small = _largest(change) <= 1e-9 * _largest(place) or miss <= 1e-12 * scale
        if settled or (small and not _largest(trial) < 0.5 * miss):
            return place + fraction * change
        place, residual, derivative = place + fraction * change, trial, trial_derivative
    raise ValueError("no equilibrium found: the data are too extreme for double precision")


def _largest(vector: FloatArray) -> float:
    return float(np.max(np.abs(vector)))
