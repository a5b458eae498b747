"""One number that is known from elsewhere, and how ropewalk finds the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

Kind = Literal["closed form", "series", "published number", "published range", "other program", "other route"]


@dataclass(frozen=True)
class KnownNumber:
    """A number of a case.

    Args:
        name: its own name within its case.
        what: what is measured.
        unit: of both numbers; empty: none.
        kind: what the reference is.
        reference: gives the number, or the smallest and the largest of a range.
        ours: finds ours in the answer of the case.
        reason: why the two may differ by the tolerance.
        relative: tolerance as a part of the reference.
        absolute: tolerance in the unit; the larger of the two counts.
        order: least observed order of convergence; 0: it is not looked at.
        fault: settings that must make the row fail; empty: those of its case.
    """

    name: str
    what: str
    unit: str
    kind: Kind
    reference: Callable[[], float | tuple[float, float]]
    ours: Callable[[Any], float]
    reason: str
    relative: float = 0.0
    absolute: float = 0.0
    order: float = 0.0
    fault: tuple[str, ...] = ()
