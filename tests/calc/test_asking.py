"""What a calculator says when too little, too much or nonsense is given, and the command line."""

from __future__ import annotations

import json
from typing import Any

import pytest
from typer.testing import CliRunner

from ropewalk import calc
from ropewalk.cli.app import app
from ropewalk.errors import ScenarioError

WRONG: list[tuple[dict[str, Any], tuple[str, ...]]] = [
    ({"span": 63, "stretch": "18 %", "mass": 57}, ("standing_tension is to be given", "or instead")),
    ({"span": 63, "mass": 57}, ("2 more quantities are needed", "standing_tension, axial_stiffness are to be given")),
    ({"spann": 63}, ("no such quantity", "did you mean span")),
    ({"span": "63 kg"}, ("span", "expected a length", "63 kg")),
    ({"span": -63}, ("must be positive", "-63")),
    ({"place": 1.5}, ("between 0 and 1",)),
    (
        {"span": 63, "stretch": 0.18, "standing_tension": 1500, "mass": 57, "tension": "2.4 kN"},
        ("contradicts", "tension = 2.042 kN follows", "2.400 kN", "leave out one of"),
    ),
    ({"span": 63, "stretch": 0.18, "mass": 57, "tension": 10}, ("no standing_tension gives tension = 10.00 N",)),
]  # fmt: skip


@pytest.mark.parametrize(("known", "parts"), WRONG)
def test_what_is_wrong_is_told_with_what_to_do(known: dict[str, Any], parts: tuple[str, ...]) -> None:
    with pytest.raises(ScenarioError) as problem:
        calc.highline(**known)
    for part in parts:
        assert part in str(problem.value)


def test_rounded_numbers_that_agree_are_no_contradiction() -> None:
    found = calc.highline(span=63, stretch=0.18, standing_tension=1500, mass=57, tension="2.04 kN")
    assert found.tension == pytest.approx(2041.7, abs=1.0)


def test_an_unasked_default_that_contradicts_can_be_asked_for() -> None:
    known = {"span": 100.0, "mass": 2.0, "sag": 3.0, "largest_tension": "10 kN"}
    with pytest.raises(ScenarioError, match=r"height=\?"):
        calc.catenary(**known)
    found = calc.catenary(**known, height=None)
    assert found.largest_tension == pytest.approx(10e3, rel=1e-9)
    assert found.height == pytest.approx(abs(found.height), rel=1e-12) or found.messages


def test_a_second_answer_is_told() -> None:
    found = calc.catenary(span=100, mass=2, largest_tension="5 kN")
    assert found.length < 101.0
    (message,) = found.messages
    other = calc.catenary(span=100, mass=2, length=float(message.split()[2]))
    assert other.largest_tension == pytest.approx(5e3, rel=1e-3)


def test_choices_are_checked() -> None:
    with pytest.raises(ScenarioError, match="write one of simply_supported"):
        calc.beam(ends="hinged", length=3)


@pytest.mark.parametrize(
    ("arguments", "code", "parts"),
    [
        ([], 0, ("ropewalk calc span", "ropewalk calc beam")),
        (["span"], 0, ("bare_sag", "kg/m", "inextensible")),
        (["highline", "span=63m", "stretch=18%", "mass=57kg", "standing_tension=1.5kN", "sag=?"], 0, ("4.353 m",)),
        (["highlin"], 2, ("there is no calculator highlin", "did you mean highline")),
        (["span", "span"], 2, ("write for example span=63m",)),
        (["span", "span=1", "span=2"], 2, ("given twice",)),
    ],
)  # fmt: skip
def test_the_command(arguments: list[str], code: int, parts: tuple[str, ...]) -> None:
    run = CliRunner().invoke(app, ["calc", *arguments])
    assert run.exit_code == code
    for part in parts:
        assert part in run.output
    if arguments[-1:] == ["sag=?"]:
        assert "bounce_frequency" not in run.output


def test_the_command_in_json_and_other_units() -> None:
    known = ["calc", "string", "length=10m", "tension=20kN", "mass=1.35kg/m"]
    found = json.loads(CliRunner().invoke(app, [*known, "--json"]).stdout)
    assert found["quantities"]["wave_speed"] == {
        "value": pytest.approx((20e3 / 1.35) ** 0.5),
        "unit": "m/s",
        "given": False,
    }
    assert found["quantities"]["length"]["given"]
    assert "m/s  sqrt" in CliRunner().invoke(app, [*known, "--units", "SI"]).stdout
