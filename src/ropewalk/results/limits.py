"""Limits of EN 50367, EN 50119 and the TSI Energy beside the statistics of a pantograph.

The standards are not open: all numbers here were recalled and not checked against their text (mark R), but for sigma,
which public secondary sources quote (mark F).

    mean force, N, v in km/h      at least            at most
    AC        up to 200 km/h      0.00047 v^2 + 60    0.00047 v^2 + 90
    AC        above               0.00047 v^2 + 60    0.00097 v^2 + 70
    DC 3 kV                       0.00112 v^2 + 70    0.00097 v^2 + 110
    DC 1.5 kV up to 200 km/h      0.00112 v^2 + 70    0.00228 v^2 + 90
    DC 1.5 kV above               0.00112 v^2 + 70    0.00097 v^2 + 140
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ropewalk.results.acceptance import Check
from ropewalk.results.contact_statistics import CUTOFF, ContactStatistics

if TYPE_CHECKING:
    from ropewalk.model.limits import Limits, System

PASS, FAIL, UNKNOWN = "pass", "FAIL", "no verdict"
SEPARATOR = "; "  # names of limits, some of which have commas
_MARGIN = 2.5  # N, what EN 50318:2018 asks simulations to be good to in the mean force (R)
_SHARE = 0.3  # sigma over mean force
_ABOUT = 1.0 + 1e-6  # speeds are found from stations and instants
_SLOW, _MEDIUM, _FAST = 160.0 * _ABOUT, 200.0 * _ABOUT, 250.0 / _ABOUT  # km/h


@dataclass(frozen=True)
class LimitCheck(Check):
    """A quantity and its limits, of which the lower one may be -inf, and what comes of it."""

    verdict: str  # pass, FAIL, no verdict
    why: str  # there is no verdict, or what the limit is


@dataclass(frozen=True)
class Judgement:
    """A pantograph below an overhead line and the limits of its system."""

    title: str
    remark: str
    checks: tuple[LimitCheck, ...]

    @property
    def verdict(self) -> str:
        """FAIL if one fails; pass if all of them do."""
        verdicts = [check.verdict for check in self.checks]
        return FAIL if FAIL in verdicts else UNKNOWN if UNKNOWN in verdicts else PASS

    @property
    def broken(self) -> tuple[str, ...]:
        """Names of the quantities that fail."""
        return tuple(check.what for check in self.checks if check.verdict == FAIL)


def mean_range(system: System, speed: float) -> tuple[float, float]:
    """Least and largest mean contact force, N.

    Args:
        system: kind of current.
        speed: m/s.
    """
    square, slow = (3.6 * speed) ** 2, 3.6 * abs(speed) <= _MEDIUM
    if system == "ac":
        return 0.00047 * square + 60.0, 0.00047 * square + 90.0 if slow else 0.00097 * square + 70.0
    low = 0.00112 * square + 70.0
    if system == "dc_3kv":
        return low, 0.00097 * square + 110.0
    return low, 0.00228 * square + 90.0 if slow else 0.00097 * square + 140.0


def maximum_force(system: System, speed: float) -> float:
    """Largest contact force of EN 50119, N: 300 up to 200 km/h, above 350 with AC and 400 with DC."""
    if 3.6 * abs(speed) <= _MEDIUM:
        return 300.0
    return 350.0 if system == "ac" else 400.0


def arcing_share(system: System, speed: float) -> float:
    """Largest share of the time with arcs of at least 5 ms (TSI Energy), 1."""
    v = 3.6 * abs(speed)
    return 1e-3 if v <= _SLOW or (v < _FAST and system == "ac") else 2e-3


def judged(limits: Limits, found: ContactStatistics, *, steady: bool, doubtful: bool) -> Judgement:
    """Compare a pantograph with the limits.

    There is no verdict on a run that is doubtful or does not go through all of the analysed spans, nor on forces whose
    samples do not hold 20 Hz, nor on limits of one speed where it varies.

    Args:
        limits: as declared.
        found: statistics within the analysed spans.
        steady: whether its speed is constant.
        doubtful: whether the results of the run are unreliable.
    """
    general = "the results of the run are unreliable" if doubtful else ""
    general = general or ("" if found.complete else "the pantograph did not pass all analysed spans")
    coarse = "" if found.fastest >= CUTOFF else f"samples are too far apart for {CUTOFF:g} Hz"
    varies = "" if steady else "the speed varies"
    low, high = mean_range(limits.system, found.speed)
    largest = limits.maximum_force or maximum_force(limits.system, found.speed)
    own = "as declared" if limits.maximum_force else "EN 50119"
    arcs = 100.0 * arcing_share(limits.system, found.speed)
    inf, loss = math.inf, 100.0 * found.long_loss
    rows = [
        ("mean", "mean force Fm", "N", found.mean, low, high, "R",
         varies or coarse, f"EN 50367; simulations are good to {_MARGIN:g} N"),
        ("deviation", "standard deviation sigma", "N", found.deviation, -inf, _SHARE * found.mean, "F", coarse,
         f"{_SHARE:g} Fm, TSI"),
        ("maximum", "largest force", "N", found.maximum, -inf, largest, "R", varies or coarse, own),
        ("statistical_maximum", "Fm + 3 sigma", "N", found.statistical_maximum, -inf, largest, "R",
         varies or coarse, own),
        ("minimum", "smallest force", "N", found.minimum, 0.0, inf, "R", coarse, "EN 50119"),
        ("long_loss", "without contact, 5 ms and more", "%", loss, -inf, arcs, "R", varies, "for arcing NQ, TSI"),
    ]  # fmt: skip
    if limits.uplift_space is not None:
        factor = 1.5 if limits.uplift_limited else 2.0
        rows.append(("uplift", "largest uplift at a support", "mm", 1e3 * found.uplift, -inf,
                     1e3 * limits.uplift_space / factor, "R", "", f"space / {factor:g}, EN 50119"))  # fmt: skip
    checks = []
    for quantity, what, unit, value, least, most, mark, unknown, source in rows:
        margin = _MARGIN if quantity == "mean" else 0.0
        why = general or unknown or ("" if math.isfinite(value) else "the result has no value")
        inside = least - margin <= value <= most + margin and not (quantity == "minimum" and value <= 0.0)
        verdict = UNKNOWN if why else PASS if inside else FAIL
        checks.append(LimitCheck(quantity, what, unit, value, least, most, mark, verdict, why or source))
    name = {"ac": "AC", "dc_3kv": "DC 3 kV", "dc_1.5kv": "DC 1.5 kV"}[limits.system]
    return Judgement(f"Limits of EN 50367 and EN 50119, {name}", _REMARK, tuple(checks))


_REMARK = "limits [R] are not verified against the standards; not a certification"
