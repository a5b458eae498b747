"""Search for roots over wide ranges: of one quantity by sign changes on a grid, of several from many beginnings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise, product
from math import inf, isfinite

import numpy as np

from ropewalk.calc.answer import CalcValue

EXACT = 1e-9
"""Part of the wanted value by which a root may miss it."""


def single(
    function: Callable[[float], float], wanted: float, quantity: CalcValue, alike: Sequence[float], points: int
) -> list[tuple[float]]:
    """Find all values of one quantity within its range for which a function has a wanted value, rising.

    Args:
        function: of the value; what raises ValueError there is no value.
        wanted: value of it.
        quantity: sought.
        alike: known quantities, near which the grid is fine: a rope is about as long as its span.
        points: of the grid.
    """
    from scipy.optimize import brentq, minimize_scalar

    size = max(abs(wanted), 1e-12)

    def miss(x: float) -> float:
        try:
            value = function(x)
        except (ValueError, ZeroDivisionError, OverflowError):
            return inf
        return value - wanted if isfinite(value) else inf

    grid = trial_values(quantity, alike, points)
    misses = [miss(x) for x in grid]
    roots: list[float] = [x for x, y in zip(grid, misses, strict=True) if y == 0.0]
    for (a, fa), (b, fb) in pairwise(zip(grid, misses, strict=True)):
        if isfinite(fa) and isfinite(fb) and fa * fb < 0.0:
            root = float(brentq(miss, a, b, xtol=1e-15 * max(abs(a), abs(b)), rtol=1e-14, maxiter=300))
            if abs(miss(root)) <= 1e-6 * size + 1e-9 * abs(fb - fa):  # a pole changes its sign, too
                roots.append(root)
    if not roots:  # a value that is reached, but not passed
        k = int(np.argmin(np.abs(misses)))
        a, b = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
        best = minimize_scalar(lambda x: abs(miss(x)), bounds=(a, b), method="bounded", options={"xatol": 1e-13 * b})
        nearest = min((float(best.x), grid[k]), key=lambda x: abs(miss(x)))
        roots = [nearest] if abs(miss(nearest)) <= EXACT * size else []
    kept: list[float] = []
    for root in sorted(roots):
        if not kept or abs(root - kept[-1]) > 1e-6 * abs(root):
            kept.append(root)
    return [(root,) for root in kept]


def trial_values(quantity: CalcValue, alike: Sequence[float], points: int) -> list[float]:
    """A rising grid over the range of a quantity, finer near others of its size."""
    low, high = quantity.search
    positive = np.geomspace(max(low, 1e-9), high, points) if high > 0.0 else np.zeros(0)
    values = [positive]
    if quantity.low < 0.0:
        values += [-positive, np.zeros(1)]
    if isfinite(quantity.high):
        values.append(np.linspace(max(quantity.low, low), quantity.high, points // 4 + 2))
    if quantity.unit == "m":
        near = np.geomspace(1e-8, 0.5, points // 8)
        lengths = [abs(value) for value in alike if low < abs(value) < high]
        values += [length * (1.0 + sign * near) for length in lengths for sign in (1.0, -1.0)]
    joined = np.unique(np.concatenate(values))
    return [float(x) for x in joined if max(quantity.low, -inf) <= x <= quantity.high]


def several(
    function: Callable[[Sequence[float]], list[float]], wanted: Sequence[float], quantities: Sequence[CalcValue],
    alike: Sequence[float],
) -> list[tuple[float, ...]]:  # fmt: skip
    """Find values of several positive quantities for which functions have wanted values: the first that is found."""
    from scipy.optimize import least_squares

    scale = np.array([max(abs(value), 1e-12) for value in wanted])

    def miss(logs: np.ndarray) -> np.ndarray:
        try:
            found = np.asarray(function([float(x) for x in np.exp(logs)]))
        except (ValueError, ZeroDivisionError, OverflowError):
            return np.full(scale.size, 1e3)
        gap = (found - wanted) / scale
        return np.where(np.isfinite(gap), np.clip(gap, -1e3, 1e3), 1e3)

    begin = [_beginnings(quantity, alike) for quantity in quantities]
    low = np.log([max(q.search[0], 1e-12) for q in quantities])
    high = np.log([min(q.search[1], q.high) for q in quantities])
    for start in product(*begin):
        logs = np.clip(np.log(np.maximum(start, 1e-12)), low + 1e-9, high - 1e-9)
        if np.all(np.abs(miss(logs)) >= 1e3):
            continue
        found = least_squares(miss, logs, bounds=(low, high), xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=200)
        if np.max(np.abs(found.fun)) <= 1e-8:
            return [tuple(float(x) for x in np.exp(found.x))]
    return []


def _beginnings(quantity: CalcValue, alike: Sequence[float]) -> list[float]:
    """Values at which a search begins: lengths are near others, most other things are of their usual size."""
    largest = sorted({abs(value) for value in alike if value != 0.0}, reverse=True)[:2]
    if quantity.unit == "m" and largest:
        return [value * (1.0 + part) for value in largest for part in (1e-3, 0.03, -0.01)]
    return [quantity.typical * part for part in (1.0, 10.0, 0.1)]
