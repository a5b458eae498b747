"""From a case to the verdicts on its rows."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable
from typing import Any

from ropewalk.errors import RopewalkError
from ropewalk.validation.known_case import KnownCase
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.row_result import AGREES, DIFFERS, FAILED, MISSING, RowResult


def judged(case: KnownCase, names: Iterable[str], settings: Iterable[str] = ()) -> list[RowResult]:
    """Compute a case, and compare rows of it; whatever goes wrong is told by them.

    Args:
        case: the scenario.
        names: of the rows.
        settings: more settings of the scenario, to see the rows fail.
    """
    rows = [row for row in case.rows if row.name in set(names)]
    if not case.there:
        return [RowResult(f"{case.id}.{row.name}", MISSING, reason=f"{case.needs} is not installed") for row in rows]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            answer = case.solved(settings)
            coarse = case.solved((*case.coarser, *settings)) if any(row.order for row in rows) else None
            return [_compared(case, row, answer, coarse) for row in rows]
    except (RopewalkError, RuntimeError) as error:
        reason = "; ".join(str(error).splitlines())
    except Exception as error:  # a fault in one case does not take the others with it
        reason = f"a fault of ropewalk: {type(error).__name__}: {error}"
    return [RowResult(f"{case.id}.{row.name}", FAILED, reason=reason) for row in rows]


def _compared(case: KnownCase, row: KnownNumber, answer: Any, coarse: Any) -> RowResult:
    reference = row.reference()
    low, high = reference if isinstance(reference, tuple) else (reference, reference)
    ours = float(row.ours(answer))
    allowed = max(row.absolute, row.relative * max(abs(low), abs(high)))
    order = math.nan
    if row.order:
        errors = [abs(float(row.ours(one)) - low) for one in (coarse, answer)]
        order = math.log(errors[0] / errors[1], case.ratio) if min(errors) > 0.0 else math.nan
    found = RowResult(f"{case.id}.{row.name}", AGREES, low, high, ours, allowed, order)
    reasons = []
    if not abs(found.difference) <= allowed:
        reasons.append(f"{found.difference:.3g} apart, {allowed:.3g} allowed")
    if row.order and not order >= row.order:
        reasons.append(f"order {order:.2f}, at least {row.order:g} expected")
    if not reasons:
        return found
    return RowResult(found.id, DIFFERS, low, high, ours, allowed, order, "; ".join(reasons))
