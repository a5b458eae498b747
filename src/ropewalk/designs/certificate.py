"""Whether an optimum is one: what stands around it, and how its gradient stands against those of its limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.mechanics.chain import Array

WORSE, BETTER, BREAKS, NONE = "worse", "better", "breaks a limit", "no value"
SLACK = 1e-9  # of the function, below which two values are the same
BALANCED = 0.2  # of the gradient, that may be left where limits hold it back


@dataclass(frozen=True)
class Neighbour:
    """A point next to the best one, in one variable.

    Args:
        variable: its number.
        point: (variable,).
        value: of the function.
        excess: (limit,) of the limits.
        verdict: worse, better, breaks a limit or no value.
    """

    variable: int
    point: Array
    value: float
    excess: Array
    verdict: str


def around(best: Array, step: float) -> list[tuple[int, Array]]:
    """Points a step before and behind in each variable, as far as the bounds go."""
    found = []
    for k in range(best.size):
        for sign in (-1.0, 1.0):
            point = best.copy()
            point[k] = min(max(best[k] + sign * step, 0.0), 1.0)
            if point[k] != best[k]:
                found.append((k, point))
    return found


def judged(variable: int, point: Array, value: float, excess: Array, best: float) -> Neighbour:
    """Say what a neighbour is, where `best` is the function at the best point."""
    if not (np.isfinite(value) and np.isfinite(excess).all()):
        verdict = NONE
    elif (excess > 0.0).any():
        verdict = BREAKS
    else:
        verdict = BETTER if value < best - SLACK * abs(best) else WORSE
    return Neighbour(variable, point, value, excess, verdict)


def left_over(best: Array, value: float, excess: Array, neighbours: list[Neighbour], active: list[int]) -> float | None:
    """What active limits and bounds leave of the gradient, as a part of it (Karush, Kuhn and Tucker).

    At an optimum -grad f = sum of multipliers times gradients of what is active, with multipliers that are not
    negative. Gradients are differences between neighbours. None: they are unknown, or nothing is active.

    Args:
        best: (variable,) the point.
        value: of the function there.
        excess: (limit,) there.
        neighbours: of it.
        active: numbers of the limits that are reached.
    """
    from scipy.optimize import nnls

    slopes = np.zeros((1 + len(active), best.size))
    outward = list[Array]()
    for k in range(best.size):
        sides = [n for n in neighbours if n.variable == k and np.isfinite(n.value)]
        points = sorted([(n.point[k], n.value, *n.excess[active]) for n in sides] + [(best[k], value, *excess[active])])
        if len(points) < 2:
            return None
        first, last = np.array(points[0]), np.array(points[-1])
        slopes[:, k] = (last - first)[1:] / (last[0] - first[0])
        for bound, sign in ((0.0, -1.0), (1.0, 1.0)):
            if best[k] == bound:
                outward.append(sign * np.eye(best.size)[k])
    whole = float(np.linalg.norm(slopes[0]))
    if whole == 0.0 or not np.isfinite(slopes).all():
        return None
    balance = [row / (np.linalg.norm(row) or 1.0) for row in [*slopes[1:], *outward]]
    if not balance:
        return None
    return float(nnls(np.array(balance).T, -slopes[0] / whole)[1])
