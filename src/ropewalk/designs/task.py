"""What a search asks of a design: the function and the limits at points, the best of them, and what stands around."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ropewalk.designs.certificate import Neighbour, around, judged
from ropewalk.designs.evaluation import Evaluated, Evaluation
from ropewalk.designs.limits import Limit
from ropewalk.designs.variables import number_of
from ropewalk.mechanics.chain import Array
from ropewalk.sweeps.case import FINE

STEPS = 12
"""Runs that it takes at most from a point before a limit to the limit."""


class Task:
    """What a search asks: the function and the limits at a point.

    Args:
        runs: computes points.
        objective: a quantity, or a key that varies.
        sign: 1 if it is to be small, -1 if large.
        limits: of quantities.
    """

    def __init__(self, runs: Evaluation, objective: str, sign: float, limits: tuple[Limit, ...]) -> None:
        self.runs, self.objective, self.sign, self.limits = runs, objective, sign, limits

    def of(self, found: Evaluated) -> tuple[float, Array]:
        """The function and the excess (limit,) of what was computed; NaN where there is no value."""
        keys = [one.key for one in self.runs.space.variables]
        if self.objective in keys:
            value = self.runs.space.amount(keys.index(self.objective), found.point)[0]
            value = value if found.outcome.outcome in FINE else np.nan
        else:
            value = number_of(found.outcome, self.objective)
        excess = [
            limit.excess(number_of(found.outcome, limit.name), found.outcome.values[limit.name][1])
            if limit.name in found.outcome.values
            else np.nan
            for limit in self.limits
        ]
        return self.sign * value, np.array(excess)

    def judge(self, point: Array) -> tuple[float, Array]:
        """The same of a point, computed here."""
        return self.of(self.runs.one(np.array(point)))

    def all(self, points: Sequence[Array]) -> list[tuple[float, Array]]:
        """The same of several points, computed side by side."""
        return [self.of(found) for found in self.runs.together(points)]

    def best(self) -> Evaluated | None:
        """The best point so far that keeps all limits, the first of equals."""
        values = [(self.of(found), found) for found in self.runs.course]
        kept = [(v, found) for (v, excess), found in values if np.isfinite(v) and (excess <= 0.0).all()]
        return min(kept, key=lambda pair: pair[0])[1] if kept else None

    def nearest(self) -> Evaluated | None:
        """The point so far that exceeds its limits least."""
        values = [(self.of(found), found) for found in self.runs.course]
        known = [(float(e.max(initial=0.0)), found) for (v, e), found in values if np.isfinite([v, *e]).all()]
        return min(known, key=lambda pair: pair[0])[1] if known else None

    def to_the_limit(self, near: float) -> None:
        """Go from the best point towards a better one beyond a limit, as far as the limits allow.

        Searches end on either side of a limit, a little before it or beyond; the root of what is most exceeded lies in
        between (the Illinois algorithm: M. Dowell and P. Jarratt, BIT 11, 1971).

        Args:
            near: of a limit, at which to stop.
        """
        best = self.best()
        if best is None:
            return
        value, excess = self.of(best)
        known = [(float(e.max()), found) for found in self.runs.course for v, e in [self.of(found)]
                 if np.isfinite([v, *e]).all() and v < value and (e > 0.0).any()]  # fmt: skip
        if not known:
            return
        beyond, other = min(known, key=lambda pair: pair[0])
        way = other.point - best.point
        gap = min(float(excess.max()), -1e-300)
        (a, fa), (b, fb) = (0.0, gap), (1.0, beyond)
        for _ in range(STEPS):
            if -near < gap:
                return
            part = (a * fb - b * fa) / (fb - fa)
            its = float(self.judge(best.point + part * way)[1].max())
            if not np.isfinite(its):
                return
            if its > 0.0:
                b, fb, fa = part, its, 0.5 * fa
            else:
                gap = min(its, -1e-300)
                a, fa, fb = part, gap, 0.5 * fb

    def neighbours(self, *steps: float) -> list[Neighbour]:
        """What stands around the best point, near and further away."""
        best = self.best()
        if best is None:
            return []
        value, found = self.of(best)[0], []
        beside = [pair for step in steps for pair in around(best.point, step)]
        for (k, point), (its, excess) in zip(beside, self.all([point for _, point in beside]), strict=True):
            found.append(judged(k, point, its, excess, value))
        return found
