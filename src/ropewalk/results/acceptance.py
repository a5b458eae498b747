"""Ranges of published reference models of current collection, and limits of standards, compared with a run.

The standards are not open. Marks say where a range comes from: F, found in a public secondary source; R, recalled, not
seen in the standard's own text. To meet the ranges is evidence, and no certificate. All limits of EN 50367, EN 50119
and the TSI Energy were recalled (R), but for sigma, which public secondary sources quote (F).

    mean force, N, v in km/h      at least            at most
    AC        up to 200 km/h      0.00047 v^2 + 60    0.00047 v^2 + 90
    AC        above               0.00047 v^2 + 60    0.00097 v^2 + 70
    DC 3 kV                       0.00112 v^2 + 70    0.00097 v^2 + 110
    DC 1.5 kV up to 200 km/h      0.00112 v^2 + 70    0.00228 v^2 + 90
    DC 1.5 kV above               0.00112 v^2 + 70    0.00097 v^2 + 140
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ropewalk.results.contact_statistics import CUTOFF, ContactStatistics

if TYPE_CHECKING:
    from ropewalk.model import Scenario
    from ropewalk.model.limits import Limits, System
    from ropewalk.model.overhead import OverheadLine
    from ropewalk.model.pantograph import Pantograph

_SAME = 1e-6  # relative: data that differ by more belong to another model
_LEVEL = 1e-6  # m
_QUANTITIES = {  # name of the statistic: what it is, its unit and its scale here
    "mean": ("mean force Fm", "N", 1.0),
    "deviation": ("standard deviation sigma", "N", 1.0),
    "deviation_low": ("sigma, 0 to 5 Hz", "N", 1.0),
    "deviation_high": ("sigma, 5 to 20 Hz", "N", 1.0),
    "statistical_maximum": ("Fm + 3 sigma", "N", 1.0),
    "statistical_minimum": ("Fm - 3 sigma", "N", 1.0),
    "maximum": ("largest force", "N", 1.0),
    "minimum": ("smallest force", "N", 1.0),
    "uplift": ("largest uplift at a support", "mm", 1e3),
    "loss": ("without contact", "%", 1e2),
    "long_loss": ("without contact, 5 ms and more", "%", 1e2),
}


@dataclass(frozen=True)
class Check:
    """A quantity and the range in which it should lie."""

    quantity: str  # name of the statistic
    what: str
    unit: str  # of value, low and high
    value: float
    low: float
    high: float
    mark: str  # F or R

    @property
    def is_inside(self) -> bool:
        """Whether it does; never, if it is NaN."""
        return self.low <= self.value <= self.high


@dataclass(frozen=True)
class Acceptance:
    """Quantities of a reference model and their ranges."""

    title: str
    remark: str
    provisional: bool
    checks: tuple[Check, ...]

    @property
    def is_met(self) -> bool:
        """Whether all of them are inside."""
        return all(check.is_inside for check in self.checks)


_Ranges = dict[str, tuple[float, float]]

EN50318_2002: dict[int, _Ranges] = {
    250: {
        "mean": (110, 120), "deviation": (26, 31), "statistical_maximum": (190, 210), "statistical_minimum": (20, 40),
        "maximum": (175, 210), "minimum": (50, 75), "uplift": (48, 55), "loss": (0, 0),
    },
    300: {
        "mean": (110, 120), "deviation": (32, 40), "statistical_maximum": (210, 230), "statistical_minimum": (-5, 20),
        "maximum": (190, 225), "minimum": (30, 55), "uplift": (55, 65), "loss": (0, 0),
    },
}  # fmt: skip
"""EN 50318:2002, for wires without bending stiffness, by speed in km/h (F)."""

SIMPLE_AC: dict[int, _Ranges] = {
    275: {
        "mean": (141.5, 146.5), "deviation": (31.9, 34.8), "deviation_low": (26.4, 28.9),
        "deviation_high": (16.2, 22.4), "maximum": (211.9, 244), "minimum": (71, 86), "uplift": (39, 48),
    },
    320: {
        "mean": (166.5, 171.5), "deviation": (49.5, 62.9), "deviation_low": (38.7, 44.4),
        "deviation_high": (29.0, 46.2), "maximum": (295, 343), "minimum": (55, 82), "uplift": (59, 64),
    },
}  # fmt: skip
"""Benchmark of Bruni et al. (2015), taken up by EN 50318:2018, by speed in km/h (R: provisional)."""

_NOTES = {
    "F": "ranges [F]: from public secondary sources, not from the standard; not a certification",
    "R": "ranges [R]: provisional, not verified against the standard; not a certification",
}


def against_en50318_2002(statistics: ContactStatistics, speed: float) -> Acceptance:
    """Compare the eight quantities of the reference model of EN 50318:2002 with their ranges.

    Args:
        statistics: of a run of that model.
        speed: m/s; there are ranges for 250 and 300 km/h.

    Raises:
        ValueError: there are none for this speed.
    """
    return _against("EN 50318:2002 reference model", EN50318_2002, "F", statistics, speed)


def against_simple_ac(statistics: ContactStatistics, speed: float) -> Acceptance:
    """Compare quantities of the "simple AC" benchmark with their provisional ranges, at 275 or 320 km/h.

    Raises:
        ValueError: there are none for this speed.
    """
    return _against("Simple AC benchmark", SIMPLE_AC, "R", statistics, speed)


def _against(
    title: str, ranges: dict[int, _Ranges], mark: str, statistics: ContactStatistics, speed: float
) -> Acceptance:
    at = _tabled(speed, ranges)
    if at is None:
        there = " and ".join(f"{v} km/h" for v in ranges)
        raise ValueError(f"{title}: no ranges for {3.6 * speed:g} km/h; there are some for {there}")
    checks = []
    for quantity, (low, high) in ranges[at].items():
        what, unit, scale = _QUANTITIES[quantity]
        checks.append(Check(quantity, what, unit, scale * getattr(statistics, quantity), low, high, mark))
    return Acceptance(f"{title} at {at} km/h", _NOTES[mark], mark == "R", tuple(checks))


def _tabled(speed: float, ranges: Iterable[int]) -> int | None:
    return next((v for v in ranges if _is_same(3.6 * abs(speed), v)), None)


def acceptance_of(scenario: Scenario | None, name: str, statistics: ContactStatistics) -> Acceptance | None:
    """Compare a pantograph's run with the ranges of the reference model that it is of, if it is of one.

    That is judged by its data: masses, tensions and bending stiffness of the wires, spans, places and stiffness of the
    droppers, the pantograph and its speed. What is a choice of modelling (elements, steps, geometry, whether droppers
    push) is free.

    Args:
        scenario: of the run.
        name: of the pantograph.
        statistics: of the pantograph.
    """
    from ropewalk.model.pantograph import Pantograph

    load = None if scenario is None else scenario.loads.get(name)
    if scenario is None or not isinstance(load, Pantograph) or not isinstance(load.travel.speed, float):
        return None
    if not statistics.complete:  # a part of the analysed spans is another question
        return None
    line, speed = scenario.overhead_lines[load.on], load.travel.speed
    if _tabled(speed, EN50318_2002) and _is_en50318_2002(line, load):
        return against_en50318_2002(statistics, speed)
    if _tabled(speed, SIMPLE_AC) and _is_simple_ac(line, load):
        return against_simple_ac(statistics, speed)
    return None


def _is_en50318_2002(line: OverheadLine, load: Pantograph) -> bool:
    at = (5.0, 10.5, 17.0, 23.5, 30.0, 36.5, 43.0, 49.5, 55.0)
    return (
        _is_pantograph(load, "en50318-2002")
        and load.wanted_mean is None
        and _is_same(load.pressed_with, 120.0)
        and load.aerodynamic == 0.0
        and len(line.span_lengths) == 10
        and line.analysed == (5, 6)
        and _is_line(line, 60.0, (1.35, 20e3, 0.0), (1.07, 16e3, 0.0), at, 100e3)
        and all(abs(sag) < _LEVEL for row in line.sags for sag in row)
    )


def _is_simple_ac(line: OverheadLine, load: Pantograph) -> bool:
    at = (4.5, 10.25, 16.0, 21.75, 27.5, 33.25, 39.0, 44.75, 50.5)
    return (
        _is_pantograph(load, "simple-ac")
        and load.wanted_mean == "ac"
        and len(line.span_lengths) >= 20
        and _is_line(line, 55.0, (1.35, 22e3, 195.0), (1.08, 16e3, 131.7), at, 200e3)
    )


def _is_pantograph(load: Pantograph, model: str) -> bool:
    from ropewalk.model.pantographs import PUBLISHED

    own, wanted = load.parts, PUBLISHED[model]
    same = len(own.masses) == len(wanted.masses) and all(
        _is_same(a, b)
        for key in ("masses", "stiffness", "damping")
        for a, b in zip(getattr(own, key), getattr(wanted, key), strict=True)
    )
    return (
        same
        and _is_same(load.contact_stiffness, wanted.contact_stiffness)
        and load.irregularity is None
        and load.head is None
    )


def _is_line(
    line: OverheadLine,
    span: float,
    contact: tuple[float, float, float],
    messenger: tuple[float, float, float],
    at: tuple[float, ...],
    stiffness: float,
) -> bool:
    """Whether spans, wires (mass, tension, EI) and droppers are these."""
    own = [
        v
        for wire in (line.contact_wire, line.messenger_wire)
        for v in (wire.mass, wire.tension, wire.bending_stiffness)
    ]
    places = line.dropper_places
    return (
        all(_is_same(length, span) for length in line.span_lengths)
        and all(map(_is_same, own, (*contact, *messenger)))
        and all(len(row) == len(at) and all(map(_is_same, row, at)) for row in places)
        and _is_same(line.droppers.stiffness, stiffness)
        and line.stitch_wire is None
        and line.condition is None
    )


def _is_same(value: float, wanted: float) -> bool:
    return abs(value - wanted) <= _SAME * abs(wanted)


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
    inf = math.inf
    rows = [
        ("mean", low, high, "R", varies or coarse, f"EN 50367; simulations are good to {_MARGIN:g} N"),
        ("deviation", -inf, _SHARE * found.mean, "F", coarse, f"{_SHARE:g} Fm, TSI"),
        ("maximum", -inf, largest, "R", varies or coarse, own),
        ("statistical_maximum", -inf, largest, "R", varies or coarse, own),
        ("minimum", 0.0, inf, "R", coarse, "EN 50119"),
        ("long_loss", -inf, arcs, "R", varies, "for arcing NQ, TSI"),
    ]
    if limits.uplift_space is not None:
        factor = 1.5 if limits.uplift_limited else 2.0
        rows.append(("uplift", -inf, 1e3 * limits.uplift_space / factor, "R", "", f"space / {factor:g}, EN 50119"))
    checks = []
    for quantity, least, most, mark, unknown, source in rows:
        what, unit, scale = _QUANTITIES[quantity]
        value = scale * getattr(found, quantity)
        margin = _MARGIN if quantity == "mean" else 0.0
        why = general or unknown or ("" if math.isfinite(value) else "the result has no value")
        inside = least - margin <= value <= most + margin and not (quantity == "minimum" and value <= 0.0)
        verdict = UNKNOWN if why else PASS if inside else FAIL
        checks.append(LimitCheck(quantity, what, unit, value, least, most, mark, verdict, why or source))
    name = {"ac": "AC", "dc_3kv": "DC 3 kV", "dc_1.5kv": "DC 1.5 kV"}[limits.system]
    return Judgement(f"Limits of EN 50367 and EN 50119, {name}", _REMARK, tuple(checks))


_REMARK = "limits [R] are not verified against the standards; not a certification"
