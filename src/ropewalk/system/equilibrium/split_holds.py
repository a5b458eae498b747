"""Hold forces on lines that are divided where loads stand: tensions beside these are those of the links there.

A contact without friction has the same tension behind and ahead. Friction lets them differ up to

    |log(T_behind / T_ahead)| = L,   L = mu angle  (capstan)  or  2 artanh(mu tan(angle/2))  (block),

`angle`: by which the line turns there. What friction does not hold is held by a level force, see `hold_forces.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import BLOCK, CAPSTAN, COULOMB, DRAGGED, FRICTIONLESS, Array, Integers
from ropewalk.solve.hold_forces import coefficient_used, log_ratio
from ropewalk.system.equilibrium.split_lines import SplitRest

# Logarithms of tensions come out to this: above the rounding of rest.
_EQUAL = 1e-9
_BALANCED = 1e-6  # residual of a level force; rounding on a line of 10 GN alone makes 1e-8


class Beside(NamedTuple):
    """What a line is beside a load."""

    behind: float  # N
    ahead: float  # N
    angle: float  # rad, by which it turns

    @staticmethod
    def of(rest: SplitRest, line: str, at: float) -> Beside:
        """That at a place along a line in m."""
        (behind, before), (ahead, after) = rest.beside(line, at)
        return Beside(behind, ahead, float(np.arccos(np.clip(before @ after, -1.0, 1.0))))

    @property
    def ratio(self) -> float:
        """Log of the ratio of both tensions; of a slack line none is known."""
        return float(np.log(self.behind / self.ahead)) if min(self.behind, self.ahead) > 0.0 else np.nan

    def needed(self, *, block: bool) -> float:
        """The friction coefficient that this needs at least."""
        known = np.isfinite(self.ratio) and self.angle > 0.0
        return float(coefficient_used(BLOCK if block else CAPSTAN, self.ratio, self.angle)) if known else np.nan


class SplitHolds:
    """The hold forces of contacts on lines that are divided there.

    Args:
        kind: (contact,) CLAMPED, FRICTIONLESS, COULOMB or DRAGGED.
        friction: (contact,) coefficients.
        block: (contact,) 1: friction of a point, 0: of a line that bends around it.
        ahead: (contact,) +1 or -1, the direction of travel.
    """

    def __init__(self, kind: Integers, friction: Array, block: Integers, ahead: Array) -> None:
        self._kind, self._friction, self._block, self._ahead = kind, friction, block, ahead

    def hold(
        self, inner: Sequence[int], weight: float, settle: Callable[[Array], SplitRest],
        beside: Callable[[SplitRest, int], Beside],
    ) -> tuple[SplitRest, Array]:  # fmt: skip
        """Rest with the level forces that contacts need, and these, (contact,) N.

        Args:
            inner: numbers of contacts between the ends of their lines.
            weight: N, about the forces there.
            settle: finds the rest under level forces of all contacts, (contact,) N.

        Raises:
            EquilibriumError: nothing holds one of them there, or there is no rest.
        """
        hold, sign = np.zeros(self._kind.size), np.where(self._kind == DRAGGED, self._ahead, 0.0)
        slides = [k for k in inner if self._kind[k] in (FRICTIONLESS, DRAGGED)]
        stands = [k for k in inner if self._kind[k] == COULOMB]
        while True:
            rest = self._balanced(slides, sign, hold, weight, settle, beside)
            slips = []
            for k in stands:
                seen = beside(rest, k)
                if k not in slides and abs(seen.ratio) > self._most(k, seen) + _EQUAL:
                    sign[k] = np.sign(seen.ratio)
                    slips.append(k)
            if not slips:
                return rest, hold
            slides = slides + slips

    def _most(self, k: int, seen: Beside) -> float:
        return float(log_ratio(BLOCK if self._block[k] else CAPSTAN, self._friction[k], seen.angle)[0])

    def _balanced(
        self, slides: list[int], sign: Array, hold: Array, weight: float, settle: Callable[[Array], SplitRest],
        beside: Callable[[SplitRest, int], Beside],
    ) -> SplitRest:  # fmt: skip
        """Rest in which friction bears all that it can, of contacts that slide; their level forces are changed."""
        if not slides or weight == 0.0:
            return settle(hold)
        found: list[SplitRest] = []

        def miss(level: Array) -> Array:
            hold[slides] = level * weight
            found[:] = [settle(hold)]
            seen = [beside(found[0], k) for k in slides]
            limits = [sign[k] * self._most(k, one) if sign[k] else 0.0 for k, one in zip(slides, seen, strict=True)]
            return np.array([one.ratio - limit for one, limit in zip(seen, limits, strict=True)])

        from scipy.optimize import root  # lazy: it takes long to import

        solved = root(miss, hold[slides] / weight, method="hybr", options={"xtol": 1e-12, "eps": 1e-8})
        if not np.abs(miss(solved.x)).max() <= _BALANCED:
            raise EquilibriumError("nothing holds a load there: the force that it takes grows beyond all bounds")
        return found[0]
