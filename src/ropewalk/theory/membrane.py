"""Pre-stressed membranes and nets with a fixed rim, small deflections: rectangle and square mesh.

``mass w_tt = N_x w_xx + N_y w_yy + q`` with the tension per width N, in N/m, the same everywhere and in one direction
another than in the other if two are given, and the mass per area in kg/m^2. A net of taut strings obeys it in the mean,
with N the tension of a string by the distance to the next; its exact answers are here, too. Under a point load the
deflection of a membrane grows without bound as ``-F ln(distance) / (2 pi sqrt(N_x N_y))``: a net yields to a force as
much as a membrane to one on a patch of about the size of a cell. Rectangles are 0..a by 0..b. Rayleigh, The Theory of
Sound I, ch. 9; sums derived here.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _arguments

__all__ = [
    "net_deflection",
    "rectangle_frequency",
]

FloatArray = NDArray[np.float64]
Pair = tuple[float, float]


def rectangle_frequency(m: ArrayLike, n: ArrayLike, *, sides: Pair, tension: float | Pair, mass: float) -> FloatArray:
    """Return the natural angular frequency of mode (m, n) of a rectangle, in rad/s.

    ``m`` and ``n``, half waves along x and y, at least 1, broadcast. ``sides`` (a, b) in m, ``tension`` in N/m, one for
    both directions or (N_x, N_y), ``mass`` in kg/m^2. `ValueError` out of range. ``pi sqrt((N_x m^2/a^2 + N_y
    n^2/b^2)/mass)``; the mode is ``sin(m pi x/a) sin(n pi y/b)``.
    """
    (a, b), (nx, ny) = _rectangle(sides, tension)
    _arguments.positive(mass=mass)
    m, n = np.asarray(m, dtype=np.float64), np.asarray(n, dtype=np.float64)
    if not (np.all(m >= 1) and np.all(n >= 1)):
        raise ValueError("m and n must be at least 1")
    return np.asarray(np.pi * np.sqrt((nx * (m / a) ** 2 + ny * (n / b) ** 2) / mass))


def net_deflection(
    *, cells: tuple[int, int], at: tuple[int, int], force: float, spacing: Pair, tension: float | Pair
) -> FloatArray:
    """Return the static deflection of a rectangular net under a force at one node, in m, (cells_x + 1, cells_y + 1).

    ``at`` is the node (i, j) that is loaded, inside; ``force`` in N; the rest as in `net_frequencies`. `ValueError` out
    of range. Small deflections across taut strings: ``4 F/(cells_x cells_y) sum_pq s_p(i) s_q(j) s_p(i_0) s_q(j_0) /
    k_pq`` with ``s_p(i) = sin(p pi i/cells_x)`` and k the mass times square of the frequency; a finite sum, exact.
    """
    squares = _net_squares(cells, spacing, tension)
    _arguments.finite(force=force)
    if not all(0 < place < count for place, count in zip(at, cells, strict=True)):
        raise ValueError(f"the force must be at a node inside the net of {cells} cells, not at {at}")
    one, two = (np.sin(np.pi * np.outer(np.arange(c + 1), np.arange(1, c)) / c) for c in cells)
    one[[0, -1]], two[[0, -1]] = 0.0, 0.0
    amplitude = np.outer(one[at[0]], two[at[1]]) / squares
    return np.asarray(4.0 * force / (cells[0] * cells[1]) * (one @ amplitude @ two.T))


def _net_squares(cells: tuple[int, int], spacing: Pair, tension: float | Pair) -> FloatArray:
    """Mass times square of frequency of every mode, N/m."""
    if not all(count >= 2 for count in cells):
        raise ValueError(f"a net needs at least 2 cells each way, not {cells}")
    tx, ty = _pair(tension)
    _arguments.positive(spacing_along_x=spacing[0], spacing_along_y=spacing[1])
    _arguments.positive(tension_along_x=tx, tension_along_y=ty)
    one, two = (
        4.0 * T / h * np.sin(0.5 * np.pi * np.arange(1, count) / count) ** 2
        for T, h, count in zip((tx, ty), spacing, cells, strict=True)
    )
    return np.asarray(one[:, np.newaxis] + two)


def _pair(tension: float | Pair) -> Pair:
    return tension if isinstance(tension, tuple) else (tension, tension)


def _rectangle(sides: Pair, tension: float | Pair) -> tuple[Pair, Pair]:
    _arguments.vectors(2, sides=sides)
    nx, ny = _pair(tension)
    _arguments.positive(side_along_x=sides[0], side_along_y=sides[1], tension_along_x=nx, tension_along_y=ny)
    return sides, (nx, ny)
