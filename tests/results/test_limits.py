"""Limits of EN 50367 and EN 50119: statistics that can be told by hand get the verdict that they deserve, or none."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from ropewalk.errors import ScenarioError
from ropewalk.model import Limits
from ropewalk.results import html_report, named_numbers, summary, text
from ropewalk.results.acceptance import FAIL, PASS, UNKNOWN, Judgement, arcing_share, judged, maximum_force, mean_range
from ropewalk.results.contact_statistics import ContactStatistics, contact_statistics
from ropewalk.scenario import loads
from ropewalk.simulate import simulate
from ropewalk.sweeps.quantities import broken_limits

KMH = 1.0 / 3.6
GOOD = ContactStatistics(
    line="line", first=0.0, last=60.0, complete=True, speed=250.0 * KMH, fastest=500.0, target=math.nan, mean=120.0,
    deviation=30.0, deviation_low=20.0, deviation_high=22.0, maximum=200.0, maximum_at=30.0, minimum=40.0,
    minimum_at=50.0, loss=0.0, long_loss=0.0, lowest=0.0, highest=0.06, uplift=0.05, raw_deviation=40.0,
    raw_maximum=230.0, raw_minimum=20.0,
)  # fmt: skip
AC = {"system": "ac", "uplift_space": "110 mm"}


def judge(limits: dict[str, Any] = AC, *, steady: bool = True, doubtful: bool = False, **changes: Any) -> Judgement:
    found = dataclasses.replace(GOOD, **changes)
    return judged(Limits.model_validate(limits), found, steady=steady, doubtful=doubtful)


def verdict(judgement: Judgement, quantity: str) -> str:
    return next(check.verdict for check in judgement.checks if check.quantity == quantity)


# EN 50367:2012 and EN 50119:2009 as recalled, by hand: 0.00047 * 160^2 + 90 = 102.032 and so on.
@pytest.mark.parametrize(
    ("system", "speed", "low", "high", "largest", "arcs"),
    [
        ("ac", 160.0, 72.032, 102.032, 300.0, 1e-3),
        ("ac", 200.0, 78.8, 108.8, 300.0, 1e-3),  # from below and above the same 108.8 N
        ("ac", 200.001, 78.8, 108.8, 350.0, 1e-3),
        ("ac", 300.0, 102.3, 157.3, 350.0, 2e-3),
        ("dc_3kv", 200.0, 114.8, 148.8, 300.0, 2e-3),
        ("dc_3kv", 250.0, 140.0, 170.625, 400.0, 2e-3),
        ("dc_1.5kv", 160.0, 98.672, 148.368, 300.0, 1e-3),
        ("dc_1.5kv", 220.0, 124.208, 186.948, 400.0, 2e-3),
    ],
)
def test_limits_are_those_of_the_system_and_the_speed(
    system: Any, speed: float, low: float, high: float, largest: float, arcs: float
) -> None:
    assert mean_range(system, speed * KMH) == pytest.approx((low, high), abs=1e-3)
    assert maximum_force(system, speed * KMH) == largest
    assert arcing_share(system, speed * KMH) == arcs


def test_what_keeps_all_limits_passes() -> None:
    found = judge()
    assert {check.quantity for check in found.checks} == {
        "mean", "deviation", "maximum", "statistical_maximum", "minimum", "long_loss", "uplift",
    }  # fmt: skip
    assert [check.verdict for check in found.checks] == [PASS] * 7
    assert found.verdict == PASS


# At 250 km/h with AC: mean 89.4 to 130.6 N, with 2.5 N that simulations are good to; sigma 36 N; 350 N; 0.2 %; 55 mm.
@pytest.mark.parametrize(
    ("quantity", "inside", "outside"),
    [
        ("mean", {"mean": 133.1}, {"mean": 133.2}),
        ("mean", {"mean": 86.9}, {"mean": 86.8}),
        ("deviation", {"deviation": 35.9}, {"deviation": 36.1}),
        ("maximum", {"maximum": 350.0}, {"maximum": 350.1}),
        ("statistical_maximum", {"deviation": 76.6}, {"deviation": 76.7}),
        ("minimum", {"minimum": 0.1}, {"minimum": 0.0}),
        ("long_loss", {"long_loss": 0.002}, {"long_loss": 0.0021}),
        ("uplift", {"uplift": 0.0549}, {"uplift": 0.0551}),
    ],
)
def test_each_limit_is_told_from_what_is_beyond_it(
    quantity: str, inside: dict[str, float], outside: dict[str, float]
) -> None:
    assert verdict(judge(**inside), quantity) == PASS
    beyond = judge(**outside)
    assert verdict(beyond, quantity) == FAIL
    assert beyond.verdict == FAIL


def test_a_limited_uplift_takes_less_space_and_a_declared_force_goes_before_that_of_the_standard() -> None:
    assert verdict(judge({**AC, "uplift_limited": True}, uplift=0.073), "uplift") == PASS  # 110 mm / 1.5 = 73.3 mm
    assert verdict(judge({**AC, "uplift_limited": True}, uplift=0.074), "uplift") == FAIL
    assert verdict(judge({"system": "ac", "maximum_force": "250 N"}, maximum=251.0), "maximum") == FAIL


def test_there_is_no_verdict_on_what_is_not_known() -> None:
    for found in (judge(doubtful=True), judge(complete=False)):
        assert {check.verdict for check in found.checks} == {UNKNOWN}
        assert found.verdict == UNKNOWN
    coarse = judge(fastest=10.0, long_loss=math.nan)
    assert [check.quantity for check in coarse.checks if check.verdict == PASS] == ["uplift"]
    varying = judge(steady=False)
    assert [check.quantity for check in varying.checks if check.verdict == UNKNOWN] == [
        "mean", "maximum", "statistical_maximum", "long_loss",
    ]  # fmt: skip
    assert judge(steady=False, uplift=0.2).verdict == FAIL  # what fails for sure


def test_limits_of_nothing_to_be_limited_are_refused() -> None:
    with pytest.raises(ScenarioError, match=r"limits\.uplift_limited: the uplift has no limit"):
        loads(SCENARIO.replace("uplift_space: 1 mm", "uplift_limited: true"))


SCENARIO = """
    title: Two below a short line
    overhead_lines:
      line:
        spans: {count: 4, length: 50 m}
        droppers: {per_span: 4}
        element: 1 m
        analysed_spans: [3, 3]
        limits: {system: ac, uplift_space: 1 mm}
    loads:
      first: {kind: pantograph, on: line, model: en50318-2002, travel: {speed: 50 m/s, from: 45 m}}
      second: {kind: pantograph, on: line, model: en50318-2002, travel: {speed: 50 m/s, from: 10 m}}
    run: {kind: dynamic, geometry: linearised, until: 2.2 s, every: 50 ms}
"""


def test_summary_table_and_report_set_every_pantograph_beside_the_limits_of_its_line() -> None:
    result = simulate(loads(SCENARIO))
    found = summary(result)
    # The second one comes to 120 m only: it leaves the analysed span unseen.
    first, second = (found["pantographs"][name]["limits"] for name in ("first", "second"))
    assert second["verdict"] == UNKNOWN
    assert first["verdict"] == FAIL
    failed = sum(check["verdict"] == FAIL for check in first["checks"])
    assert (first["failures"]["value"], second["failures"]["value"]) == (failed, None)
    assert named_numbers(result)["pantographs.first.limits.failures"] == (failed, "1")
    names = [check["what"] for check in first["checks"] if check["verdict"] == FAIL]
    assert "largest uplift at a support" in names
    counts = ["first.limits.failures", "second.limits.failures", "largest_tension"]
    assert broken_limits(result, counts) == {counts[0]: "; ".join(names), counts[1]: ""}
    uplift = next(check for check in first["checks"] if check["quantity"] == "uplift")
    assert uplift["verdict"] == FAIL
    assert uplift["high"] == pytest.approx(0.5)  # mm
    assert uplift["value"] == pytest.approx(1e3 * contact_statistics(result)["first"].uplift)
    table, page = text(found), html_report(result)
    assert "Limits of EN 50367 and EN 50119, AC: first" in table
    assert 'class="outside">FAIL' in page
    line = next(row for row in table.splitlines() if row.startswith("largest uplift at a support"))
    assert "FAIL  at most 0.500" in line


def test_long_losses_are_those_of_five_milliseconds() -> None:
    from ropewalk.results.contact_statistics import _long_loss

    force = np.full(1000, 100.0)
    force[100:104] = 0.0  # 4 ms do not count
    force[200:205] = 0.0
    force[300:320] = 0.0
    assert _long_loss(force, 1e-3) == pytest.approx(0.025)
    assert math.isnan(_long_loss(force, 6e-3))
