"""Adaptive Gauss quadrature of many functions at once: panels are halved until whole and halves agree."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Integrand", "adaptive"]

FloatArray = NDArray[np.float64]
Integrand = Callable[[FloatArray], NDArray[np.complexfloating[Any, Any]]]  # (n,) to (n, points)

NODES, WEIGHTS = np.polynomial.legendre.leggauss(10)
CHUNK = 200_000  # numbers held at once
ROUNDING = 1e-15  # of the whole: what halving a panel cannot improve
MOST_HALVINGS, MOST_PANELS = 40, 50_000  # then the remainder counts as error


def adaptive(
    f: Integrand, edges: FloatArray, tolerance: float, known: FloatArray | float, least: float = 0.0
) -> tuple[FloatArray, float]:
    """Return the integral of the real part of ``f`` and the sum of the differences of the last halvings.

    ``f`` maps q of shape (n,) to (n, points); ``edges`` are the ends of the panels to begin with; ``tolerance`` is
    relative to the largest magnitude of ``known`` and the integral together, or to ``least``.
    """
    low, high = edges[:-1], edges[1:]
    share = 0.1 * tolerance / len(low)
    whole = _gauss(f, low, high)
    total, error = np.zeros(whole.shape[1]), 0.0
    for depth in range(MOST_HALVINGS + 1):
        middle = 0.5 * (low + high)
        left = _gauss(f, low, middle)
        right = _gauss(f, middle, high)
        difference = np.max(np.abs(left + right - whole), axis=1)
        scale = max(float(np.max(np.abs(known + total + np.sum(left + right, axis=0)))), least)
        done = difference <= max(share, ROUNDING) * scale
        if depth == MOST_HALVINGS or len(low) > MOST_PANELS:
            done[:] = True
        total = total + np.sum((left + right)[done], axis=0)
        error += float(np.sum(difference[done]))
        if np.all(done):
            break
        low, high = np.append(low[~done], middle[~done]), np.append(middle[~done], high[~done])
        whole = np.concatenate([left[~done], right[~done]])
    return total, error


def _gauss(f: Integrand, low: FloatArray, high: FloatArray) -> FloatArray:
    """Real parts of the integrals over the panels, (panels, points)."""
    half = 0.5 * (high - low)
    nodes = 0.5 * (high + low)[:, None] + half[:, None] * NODES
    points = f(nodes[0]).shape[1]
    step = max(CHUNK // (10 * points), 1)
    parts = []
    for j in range(0, len(low), step):
        values = f(nodes[j : j + step].ravel()).real.reshape(-1, 10, points)
        weights = WEIGHTS * half[j : j + step, None]
        parts.append(np.einsum("ij,ijk->ik", weights, values))
    return np.concatenate(parts)
