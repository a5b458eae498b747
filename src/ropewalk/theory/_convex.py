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
        change = -np.linalg.solve(derivative, residual)
        change *= min(1.0, longest / max(float(np.max(np.abs(change))), 1e-300))
        descent = float(residual @ change)
        fraction = 1.0
        trial, trial_derivative = gradient(place + change)
        # beyond the minimum the slope turns positive; a comparison with NaN is false
        while not float(trial @ change) <= -0.5 * descent and fraction > 1e-12:
            fraction *= 0.5
            trial, trial_derivative = gradient(place + fraction * change)
        settled = bool(
            np.max(np.abs(change)) <= 1e-13 * np.max(np.abs(place)) or np.max(np.abs(residual)) <= 1e-15 * scale
        )
        # near the end Newton's method squares the error; where it does not even halve it, roundings are left
        small = np.max(np.abs(change)) <= 1e-9 * np.max(np.abs(place))
        if settled or (small and not np.max(np.abs(trial)) < 0.5 * np.max(np.abs(residual))):
            return place + fraction * change
        place, residual, derivative = place + fraction * change, trial, trial_derivative
    raise ValueError("no equilibrium found: the data are too extreme for double precision")
