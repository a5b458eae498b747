"""What became of a row."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

VERDICTS = AGREES, DIFFERS, FAILED, MISSING = "agrees", "differs", "failed", "not computed"


@dataclass(frozen=True)
class RowResult:
    """Both numbers and the verdict.

    Args:
        id: of the row.
        verdict: agrees, differs, failed (nothing came out) or not computed (a package is missing).
        low: the reference, or its smallest value.
        high: the same, or its largest value.
        ours: NaN if there is none.
        allowed: difference that is allowed, in the unit.
        order: observed order of convergence; NaN: not looked at.
        reason: why there is no number, or what else is wrong.
    """

    id: str
    verdict: str
    low: float = math.nan
    high: float = math.nan
    ours: float = math.nan
    allowed: float = math.nan
    order: float = math.nan
    reason: str = ""

    @property
    def difference(self) -> float:
        """Of ours from the reference, or from the nearest end of its range; 0 within it."""
        return self.ours - min(max(self.ours, self.low), self.high)

    def as_dict(self) -> dict[str, Any]:
        """As plain values that fit into JSON; what there is not is null."""
        found: dict[str, Any] = {
            "id": self.id,
            "verdict": self.verdict,
            "reference": self.low if self.low == self.high else [self.low, self.high],
            "ours": self.ours,
            "difference": self.difference,
            "allowed": self.allowed,
            "observed_order": self.order,
            "reason": self.reason,
        }
        if math.isnan(self.low):
            found["reference"] = None
        return {key: None if isinstance(value, float) and math.isnan(value) else value for key, value in found.items()}
