"""Axes of adequacy maps: their values, and ratios against numbers found by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from adequacy_cases import scenario
from ropewalk.compare.adequacy import scenario_at
from ropewalk.compare.axes import Axis
from ropewalk.compare.ratios import Pair
from ropewalk.errors import ScenarioError

TENSION = Axis.linear("lines.string.tension", 1e3, 2e3, 2)
MASS = {"kind": "mass", "mass": 2.0, "travel": {"speed": 50.0}}
# 1000 N, 0.1 kg/m, EA = 1 MN: an unstrained length of 10/1.001 m, and waves of 100 sqrt(1.001) m/s in space
STRETCH = 1.001


def test_steps_and_factors_are_equal():
    assert Axis.linear("gravity", 0, 1, 5).values == (0.0, 0.25, 0.5, 0.75, 1.0)
    log = Axis.parse("load ratio=0.001:1:4:log")
    # rounding of a power
    np.testing.assert_allclose(log.values, [1e-3, 1e-2, 1e-1, 1.0], rtol=1e-14)
    assert (log.key, log.scale) == ("load ratio", "log")


def test_an_axis_is_read_with_its_unit_and_its_load():
    axis = Axis.parse(" loads.cart.travel.speed = 10 km/h : 50 km/h : 3 ")
    assert (axis.key, axis.values, axis.unit, axis.scale) == (
        "loads.cart.travel.speed",
        (10.0, 30.0, 50.0),
        "km/h",
        "linear",
    )
    assert Axis.parse("lines.string.tension=1:2 kN:2").unit == "kN"
    assert (Axis.parse("speed-ratio of cart=0.1:1:3").key, Axis.parse("speed ratio of cart=0.1:1:3").load) == (
        "speed ratio",
        "cart",
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("lines.string.tension", "this is no axis, given 'lines.string.tension'; write KEY=FROM:TO:COUNT"),
        ("gravity=1:2", "this is no axis"),
        ("gravity=1:2:3:4:5", "this is no axis"),
        ("gravity=a:2:3", "no number with or without a unit, given 'a'"),
        ("gravity=1:2:x", "the number of values is no whole number, given 'x'"),
        ("gravity=1:2:1", "an axis has 2 to 1000 values, given 1"),
        ("gravity=2:1:3", "values must rise, given 1.5 after 2; begin with the smallest"),
        ("gravity=1:2:3:lag", "no such scale, given 'lag'; did you mean log?"),
        ("gravity=0:2:3:log", "a logarithmic axis has positive values only, given 0 to 2"),
        ("load ratio=0:2:3", "a ratio is positive, given 0; begin with a value above 0"),
        ("gravity=1 m/s^2:2 km/h:3", "both ends of an axis need the same unit, given m/s^2 and km/h"),
        ("lode ratio=1:2:3", "neither a key of a scenario nor a ratio, given 'lode ratio'; did you mean load ratio?"),
        ("mass=1:2:3", "neither a key of a scenario nor a ratio, given 'mass'"),
    ],
)
def test_what_is_no_axis_is_told(text, message):
    with pytest.raises(ScenarioError) as error:
        Axis.parse(text)
    assert message in str(error.value)


def test_the_speed_ratio_counts_waves_as_the_load_counts_its_way():
    # tolerance: the search for the length that gives the tension
    for measured, c in (("slip", 100.0 * math.sqrt(STRETCH)), ("material", 100.0 / math.sqrt(STRETCH))):
        load = {"kind": "force", "force": [0.0, -10.0], "travel": {"speed": 50.0, "measured": measured}}
        assert Pair.of(scenario(load), "speed ratio").value("speed ratio") == pytest.approx(50.0 / c, rel=1e-12)


def test_another_speed_ratio_is_the_same_passage_in_another_time():
    x = Axis.linear("speed ratio", 0.1, 0.2, 2)
    found = scenario_at(scenario(), x, TENSION, (0.1, 1e3))
    speed = 0.1 * 100.0 / math.sqrt(STRETCH)
    assert found.loads["cart"].travel.speed == pytest.approx(speed, rel=1e-12)
    assert found.run.until * speed == pytest.approx(0.08 * 50.0)
    assert found.run.every * speed == pytest.approx(0.001 * 50.0)
    # four times the tension are twice the wave speed; tolerance: the strain is four times as large
    fast = scenario_at(scenario(), x, TENSION, (0.1, 4e3))
    assert fast.loads["cart"].travel.speed == pytest.approx(2.0 * speed, rel=2e-3)
    table = {"time": [0.0, 1.0], "value": [0.0, -50.0]}
    message = scenario_at(
        scenario({"kind": "force", "force": [0.0, -1.0], "travel": {"speed": table, "from": 9.0}}),
        x,
        TENSION,
        (0.1, 1e3),
    )
    assert message.loads["cart"].travel.speed.value == pytest.approx((0.0, -speed))
    assert message.loads["cart"].travel.speed.time == pytest.approx((0.0, 50.0 / speed))


def test_load_and_mass_ratio_scale_the_load_as_a_whole():
    load = {
        "kind": "vehicle",
        "bodies": {"box": {"mass": 9.0, "inertia": 3.0}},
        "wheels": {"rear": {"at": -1.0}, "front": {"at": 1.0, "mass": 1.0}},
        "springs": {
            "one": {"between": ["box", "rear"], "stiffness": 100.0, "damping": 2.0},
            "two": {"between": ["box", "front"], "stiffness": 200.0},
        },
        "travel": {"speed": 5.0, "from": 2.0},
    }
    given = scenario(load, gravity=10.0)
    pair = Pair.of(given, "load ratio")
    assert pair.value("load ratio") == pytest.approx(10.0 * 10.0 / 1000.0)
    assert pair.value("mass ratio") == pytest.approx(10.0 / (0.1 * 10.0 / STRETCH), rel=1e-4)  # a sag of 12 mm
    for name, factor in (("load ratio", 0.1), ("mass ratio", 10.0 * STRETCH)):
        axis = Axis.linear(name, factor, 2.0 * factor, 2)
        cart = scenario_at(given, axis, Axis.linear("lines.string.drag", 0, 1, 2), (2.0 * factor, 0.0)).loads["cart"]
        box, front, one = cart.bodies["box"], cart.wheels["front"], cart.springs["one"]
        found = (box.mass, box.inertia, front.mass, one.stiffness, one.damping)
        assert found == pytest.approx((18.0, 6.0, 2.0, 200.0, 4.0), rel=1e-4)
        assert (cart.travel.speed, front.at) == (5.0, 1.0)


def test_forces_matrices_and_masses_have_a_weight():
    force = {
        "kind": "force",
        "force": {"time": [0.0, 1.0], "value": [[0.0, -3.0], [4.0, -3.0]]},
        "travel": {"speed": 1.0},
    }
    matrices = {
        "kind": "matrices", "coordinates": ["body", "wheel"], "mass": [[3.0, 0.0], [0.0, 1.0]],
        "stiffness": [[50.0, -50.0], [-50.0, 50.0]], "wheels": {"w": {"coordinate": "wheel"}}, "travel": {"speed": 1.0},
    }  # fmt: skip
    axis, other = Axis.linear("load ratio", 0.1, 0.2, 2), Axis.linear("lines.string.drag", 0, 1, 2)
    assert Pair.of(scenario(force), "load ratio").value("load ratio") == pytest.approx(5.0 / 1000.0)
    assert Pair.of(scenario(MASS, gravity=10.0), "load ratio").value("load ratio") == pytest.approx(20.0 / 1000.0)
    cart = scenario_at(scenario(force), axis, other, (0.01, 0.0)).loads["cart"]
    assert cart.force.value == (pytest.approx((0.0, -6.0)), pytest.approx((8.0, -6.0)))
    cart = scenario_at(scenario(matrices, gravity=10.0), axis, other, (0.08, 0.0)).loads["cart"]
    np.testing.assert_allclose(cart.mass, [[6.0, 0.0], [0.0, 2.0]])
    np.testing.assert_allclose(cart.stiffness, [[100.0, -100.0], [-100.0, 100.0]])


@pytest.mark.parametrize(
    ("given", "ratio", "message"),
    [
        (scenario(), "mass ratio", "a load of kind force has no mass"),
        (scenario(MASS), "load ratio", "cart weighs nothing"),
        (scenario(loads={}), "load ratio", "belongs to one load, given there is none"),
        (scenario({"kind": "footsteps", "mass": 80.0}, gravity=10.0), "speed ratio", "sets its own speed"),
        (scenario({**MASS, "travel": {"speed": 0.0}}), "speed ratio", "cart does not move"),
    ],
)
def test_a_load_without_the_ratio_is_told(given, ratio, message):
    with pytest.raises(ScenarioError, match=message):
        Pair.of(given, ratio).value(ratio)


def test_one_of_several_loads_must_be_named():
    loads = {name: {"on": "string", **MASS} for name in ("first", "second")}
    loads["second"]["travel"] = {"speed": 50.0, "from": 2.0}
    both = scenario(loads=loads)
    with pytest.raises(ScenarioError, match="there are first, second; name it: load ratio of first"):
        Axis.linear("load ratio", 1, 2, 2).resolved(both)
    with pytest.raises(ScenarioError, match="no such load, given secand; did you mean second"):
        Axis.linear("load ratio of secand", 1, 2, 2).resolved(both)
    axis = Axis.linear("load ratio of second", 1, 2, 2).resolved(both)
    assert axis.label == "load ratio W/P of second on string"


def test_labels_have_units_and_names():
    axis = TENSION.resolved(scenario())
    assert (axis.name, axis.label) == ("tension of string", "tension of string (N)")
    assert Axis.linear("loads.cart.travel.speed", 1, 2, 2).resolved(scenario()).label == "speed of cart (m/s)"
