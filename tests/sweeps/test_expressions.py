"""Values that follow from others: right with units, and nothing but arithmetic."""

from __future__ import annotations

import pytest

from ropewalk.errors import Refused
from ropewalk.sweeps.expressions import Amount, evaluated, resolved
from ropewalk.units import to_si

WRITTEN = {
    "lines.bridge.length": "36.0 m", "lines.bridge.mass": "2.0 kg/m", "lines.bridge.tension": "800.0 N",
    "loads.train.travel.speed": "72 km/h", "loads.train.force.1": "-10.0 N", "lines.other.length": "4.0 m",
    "lines.bridge.law.kind": "hooke",
}  # fmt: skip


def value(text, unit, given=None):
    return to_si(resolved({"x": text}, given or {}, WRITTEN)["x"], unit)


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("bridge.length / speed + 2 s", "s", 3.8),
        ("bridge.length/speed", "s", 1.8),
        ("sqrt(tension / bridge.mass)", "m/s", 20.0),
        ("2 * 3 m/s * 2 s", "m", 12.0),
        ("2e3 mm + 1 m - .5 m", "m", 2.5),
        ("-force[1] * 2", "N", 20.0),
        ("max(bridge.length, other.length, 40 m) ** 2", "m^2", 1600.0),
        ("abs(train.force[1]) / (9.81 m/s^2)", "kg", 10.0 / 9.81),
        ("2 * pi", "dimensionless", 6.283185307179586),
        ("(tension / 2 N) ** 0.5", "dimensionless", 20.0),
        ("3 %", "dimensionless", 0.03),
    ],
)
def test_expressions_are_computed_with_their_units(text, unit, expected):
    assert value(text, unit) == pytest.approx(expected, rel=1e-15)  # a few roundings


def test_what_a_case_gives_comes_before_what_the_file_says():
    given = {"loads.train.travel.speed": "36 km/h"}
    assert value("bridge.length / speed", "s", given) == 3.6
    assert value("bridge.length / speed", "s", {"loads.train.travel.speed": 10}) == 3.6  # a bare number is SI


def test_expressions_may_use_each_other_in_any_order():
    found = resolved({"run.every": "until / 100", "run.until": "bridge.length / speed"}, {}, WRITTEN)
    assert found == {"run.every": "0.018000000000000002 s", "run.until": "1.8 s"}


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("bridge.length + speed", "m and m\\*s\\^-1 do not add up"),
        ("length / speed", "length may be lines.bridge.length or lines.other.length"),
        ("bridge.lenght / speed", "unknown name bridge.lenght; did you mean"),
        ("__import__('os').system('true')", "cannot stand in an expression|no such function"),
        ("(lambda: 1)()", "cannot stand in an expression"),
        ("[1, 2][0]", "this is no name"),
        ("open(1)", "no such function"),
        ("speed.__class__", "unknown name"),
        ("'a' * 9", "cannot stand in an expression"),
        ("True", "cannot stand in an expression"),
        ("1 +", "this is no expression"),
        ("2 furlongz", "unknown unit furlongz"),
        ("2 m*speed", "unknown unit m\\*speed"),
        ("1 / 0", "no finite value"),
        ("9 ** 9 ** 9", "no finite value"),
        ("(-2) ** 0.5", "no finite value"),
        ("1e400", "no finite value"),
        ("kind * 2", "is no quantity"),
        ("2 m ** speed", "an exponent has a unit"),
        ("x + 1", "depend on each other"),
        ("(" * 300 + "1" + ")" * 300, "characters|no expression"),
    ],
)
def test_everything_else_is_refused(text, wrong):
    with pytest.raises(Refused, match=wrong):
        resolved({"x": text}, {}, WRITTEN)


def test_a_broken_power_cannot_be_written():
    with pytest.raises(Refused, match="broken power"):
        evaluated("sqrt(2 m)", lambda _: Amount(1.0))
