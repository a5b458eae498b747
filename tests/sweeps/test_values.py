"""What parameters take, and how it is combined."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ropewalk.errors import ScenarioError
from ropewalk.sweeps.combining import combined
from ropewalk.sweeps.keys import short_names
from ropewalk.sweeps.parameters import Parameter, numbers

KEY = "loads.train.travel.speed"


@pytest.mark.parametrize(
    ("text", "levels"),
    [
        ("100:110:5km/h", ("100 km/h", "105 km/h", "110 km/h")),
        ("100 km/h : 112 km/h : 5 km/h", ("100 km/h", "105 km/h", "110 km/h")),
        ("0:0.3:0.1", ("0", "0.1", "0.2", "0.3")),  # as decimal numbers, where 3 * 0.1 is 0.30000000000000004
        ("3:1:-1 m", ("3 m", "2 m", "1 m")),
        ("550kN,600kN", ("550kN", "600kN")),
        ("[0 N, -1 N], [0, -2]", ("[0 N, -1 N]", "[0, -2]")),
        ("linear(1 kN, 2 kN, 3)", ("1 kN", "1.5 kN", "2 kN")),
        ("log(1, 100, 3)", ("1", "10", "100")),
        ("person.py:walker", ("person.py:walker",)),
        ([1, "2 m", [0, 1]], (1, "2 m", [0, 1])),
        (np.array([1.5, 2.5]), (1.5, 2.5)),
    ],
)
def test_values_are_read(text, levels):
    assert Parameter.read(KEY, text).levels == levels


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("100:50:5", "does not lead from the first value to the last"),
        ("1:2:0", "does not lead"),
        ("1 m:2 km:1 m", "need the same unit"),
        ("0:1:1e-9", "more than 100000 values"),
        ("1,,2", "these are no values"),
        ("uniform(2, 1)", "not above the lower one"),
        ("gaussian(2, 1)", "no such values"),
        ("normal(2 m)", "do not match"),
        ("normal(2 m, 0 m)", "not positive"),
        ("log(0, 1, 3)", "positive values only"),
        ("linear(0, 1, 2.5)", "no whole number"),
        ("lognormal(2 m, 0.1 m)", "has no unit"),
        ([], "these are no values"),
        ([None], "these are no values"),
    ],
)
def test_what_is_no_value_is_refused(text, wrong):
    with pytest.raises(ScenarioError, match=wrong):
        Parameter.read(KEY, text)


def test_values_are_numbers_in_one_unit_or_none():
    assert numbers(["100 km/h", "105 km/h"], "m/s") == ([100.0, 105.0], "km/h")
    assert numbers(["36 km/h", 20], "m/s") == ([10.0, 20.0], "m/s")
    assert numbers(["hooke", "inextensible"], "") is None
    assert numbers([True, False], "") is None


def test_a_grid_has_each_with_each_and_a_zip_the_first_with_the_first():
    a, b = Parameter("a", (1, 2)), Parameter("b", (3, 4))
    assert combined([a, b], "grid", None, 0) == [(1, 3), (1, 4), (2, 3), (2, 4)]
    assert combined([a, b], "zip", None, 0) == [(1, 3), (2, 4)]
    with pytest.raises(ScenarioError, match="have the same length"):
        combined([a, Parameter("b", (3,))], "zip", None, 0)
    with pytest.raises(ScenarioError, match="drawn from a distribution"):
        combined([a, Parameter.read("b", "normal(0, 1)")], "grid", None, 0)
    with pytest.raises(ScenarioError, match="more than 1000000 cases"):
        combined([Parameter("a", tuple(range(1001)))] * 2, "grid", None, 0)


def test_a_latin_hypercube_has_one_value_in_each_interval():
    names = [Parameter.read("a", "uniform(0, 1)"), Parameter.read("b", "uniform(0, 1)")]
    points = np.array(combined(names, "latin_hypercube", 40, 3), dtype=float)
    for values in points.T:
        assert sorted(np.floor(values * 40).astype(int)) == list(range(40))


@pytest.mark.parametrize("how", ["random", "sobol"])
def test_the_first_cases_stay_where_there_are_to_be_more(how):
    names = [Parameter.read("a", "normal(1 m, 0.1 m)"), Parameter("b", (1, 2, 3))]
    assert combined(names, how, 12, 5) == combined(names, how, 30, 5)[:12]
    assert combined(names, how, 12, 5) != combined(names, how, 12, 6)


def test_sobol_points_are_even():
    points = np.array(combined([Parameter.read("a", "uniform(0, 1)")] * 2, "sobol", 16, 1), dtype=float)
    cells = np.floor(points * 4).astype(int)
    assert len({tuple(cell) for cell in cells}) == 16  # a (0, 4, 2)-net: one point in each of 4 x 4 squares


@pytest.mark.parametrize(
    ("text", "mean", "deviation"),
    [
        ("normal(3, 2)", 3.0, 2.0),
        ("uniform(1, 4)", 2.5, 3.0 / math.sqrt(12.0)),
        ("loguniform(1, 4)", 3.0 / math.log(4.0), math.sqrt(7.5 / math.log(4.0) - (3.0 / math.log(4.0)) ** 2)),
        ("lognormal(2, 0.5)", 2.0 * math.exp(0.125), 2.0 * math.exp(0.125) * math.sqrt(math.expm1(0.25))),
    ],
)
def test_distributions_have_their_moments(text, mean, deviation):
    """Of 4096 stratified values; their own errors in mean and deviation are below 1 %."""
    values = np.array(combined([Parameter.read("a", text)], "latin_hypercube", 4096, 2), dtype=float)
    assert values.mean() == pytest.approx(mean, rel=1e-2)
    assert values.std() == pytest.approx(deviation, rel=1e-2)


def test_names_are_as_short_as_they_may_be():
    keys = ["loads.train.travel.speed", "loads.tram.travel.speed", "lines.rope.mass", "loads.train.force.1"]
    assert short_names(keys) == ["train.travel.speed", "tram.travel.speed", "mass", "force.1"]
    assert short_names(["a.reason"], ("reason",)) == ["a.reason"]
