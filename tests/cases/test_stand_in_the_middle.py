"""Loads begin at a given x or in the middle of a span, and starts along the line that lie elsewhere are named."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk import load
from ropewalk.errors import ScenarioError
from ropewalk.model import Scenario
from ropewalk.results.contract import scenario_text
from ropewalk.scenario.loading import loads as loads_text
from ropewalk.simulate import simulate

FILE = Path(__file__).parent / "stand-in-the-middle.yaml"
WEB: dict[str, Any] = {
    "start": [0, 0], "end": [95, 0], "tension": 3e3, "mass": 0.065, "elements": 12,
    "law": {"kind": "table", "strain": [0, 0.06, 0.105, 0.145, 0.2], "tension": [0, 2e3, 4e3, 6e3, 10e3]},
}  # fmt: skip
ROPE: dict[str, Any] = {
    "start": [0, 0], "end": [20, 4], "length": 24, "mass": 1, "axial_stiffness": 1e5, "elements": 12
}  # fmt: skip
STILL: dict[str, Any] = {"kind": "equilibrium"}
MOVES: dict[str, Any] = {"kind": "dynamic", "until": 0.02, "every": 0.01}
WARNING = "is measured along the unstrained line"


def travels(start: Any, kind: str = "mass", **more: Any) -> dict[str, Any]:
    what: dict[str, Any] = {"mass": 85.0}
    if kind == "force":
        what = {"force": [0.0, -834.0]}
    if kind == "trolley":
        what = {"mass": 5.0, "payload": {"mass": 80.0, "length": 1.0, "stiffness": 1e5}}
    if kind == "oscillator":
        what = {"mass": 80.0, "stiffness": 1e4, "wheel_mass": 5.0}
    travel = {"speed": 0.0, "from": start, **more}
    return {"kind": kind, "on": "w", "travel": travel, **what}


def stands(line: dict[str, Any], one: dict[str, Any], run: dict[str, Any] = STILL, **more: Any) -> xr.Dataset:
    ask = {"lines": {"w": line}, "loads": {"p": one}, "run": run, **more}
    return simulate(Scenario.model_validate(ask))


def x_of(result: xr.Dataset, axis: int = 0) -> float:
    return float(result.contact_position.values[0, 0, axis])


def test_a_start_along_the_line_is_compared_with_x_and_both_remedies_work() -> None:
    text = next(text for text in str(simulate(load(FILE)).warnings).splitlines() if WARNING in text)
    assert text.startswith("load person starts at x = 51.48 m")
    assert "loads.person.travel.from: 47.5 m" in text
    assert "write from: {x: 47.5 m} to begin there, or from: middle" in text
    for start in ("{x: 47.5 m}", "middle"):
        result = simulate(load(FILE, [f"loads.person.travel.from={start}"]))
        assert x_of(result) == pytest.approx(47.5, abs=1e-4)  # the search ends at 1e-7 of the length
        assert WARNING not in result.warnings


@pytest.mark.parametrize("kind", ["force", "mass", "trolley", "oscillator"])
@pytest.mark.parametrize("line", [
    WEB, {**WEB, "start": [95, 0], "end": [0, 0]}, {**WEB, "start": [0, 0, 0], "end": [60, 20, 10]}, ROPE,
    {**ROPE, "bending_stiffness": 50.0},
], ids=["web", "backwards", "in space", "slack", "stiff"])  # fmt: skip
def test_every_load_stands_at_its_x(line: dict[str, Any], kind: str) -> None:
    middle = 0.5 * (line["start"][0] + line["end"][0])
    assert x_of(stands(line, travels("middle", kind))) == pytest.approx(middle, abs=1e-3)
    x = line["start"][0] + 0.3 * (line["end"][0] - line["start"][0])
    assert x_of(stands(line, travels({"x": x}, kind))) == pytest.approx(x, abs=1e-3)


@pytest.mark.parametrize("measured", ["material", "slip", "arc", "horizontal"])
def test_motions_begin_there_however_the_travel_is_measured(measured: str) -> None:
    found = x_of(stands(ROPE, travels({"x": 13.0}, "force", measured=measured), MOVES))
    assert found == pytest.approx(13.0, abs=0.03)  # between nodes a moving line is a smooth curve, 1.7 m long


def test_motions_with_loads_at_rest_begin_there_by_material_length_only() -> None:
    rests = {**MOVES, "start": {"with_loads": True}}
    assert x_of(stands(ROPE, travels({"x": 13.0}, "force"), rests)) == pytest.approx(13.0, abs=0.03)
    for measured, run in (("slip", rests), ("arc", STILL), ("horizontal", rests)):
        with pytest.raises(ScenarioError, match=f"not located where measured is {measured}"):
            Scenario(lines={"w": ROPE}, loads={"p": travels("middle", "force", measured=measured)}, run=run)  # type: ignore[dict-item,arg-type]


def test_a_free_load_and_a_walker_begin_there() -> None:
    free = {"kind": "mass", "on": "w", "mass": 85.0, "travel": {"kind": "free", "from": {"x": 8.0}}}
    assert x_of(stands(ROPE, free, MOVES)) == pytest.approx(8.0, abs=0.03)
    steps = {"kind": "footsteps", "on": "w", "mass": 75.0, "frequency": 2.0, "step_length": 0.7, "from": "middle"}
    assert np.nanmin(np.abs(stands(WEB, steps, MOVES).contact_position.values[0, :, 0] - 47.5)) < 0.1


def test_quasistatic_and_linear_runs_begin_there() -> None:
    one = travels({"x": 60.0}, "force", speed=1.0)
    assert x_of(stands(WEB, one, {"kind": "quasistatic", "positions": 3})) == pytest.approx(60.0, abs=1e-3)
    taut = {**ROPE, "length": 20.3}
    found = x_of(stands(taut, travels({"x": 6.0}, "force"), {"kind": "linear", "until": 0.1}))
    assert found == pytest.approx(6.0, abs=0.01)


def test_joined_lines_are_located_where_they_hang() -> None:
    half = {**ROPE, "end": [10, -2], "length": 12.0, "end_support": {"kind": "joined", "to": "k"}}
    lines = {"w": half, "o": {**half, "start": [20, 0], "length": 11.0}}
    ask = {"lines": lines, "joints": {"k": {"mass": 30.0}}, "loads": {"p": travels({"x": 4.0})}, "run": STILL}
    assert x_of(simulate(Scenario.model_validate(ask))) == pytest.approx(4.0, abs=1e-3)


def test_two_loads_are_located_together() -> None:
    ask = {"lines": {"w": WEB}, "loads": {"p": travels({"x": 30.0}), "q": travels("middle", "force")}, "run": STILL}
    result = simulate(Scenario.model_validate(ask))
    assert result.contact_position.values[0, :, 0] == pytest.approx([30.0, 47.5], abs=1e-3)


def test_the_file_that_results_keep_begins_there_too() -> None:
    scenario = load(FILE, ["loads.person.travel.from={x: 20 m}"])
    again = loads_text(scenario_text(scenario), "again.json")
    assert x_of(simulate(again)) == pytest.approx(20.0, abs=1e-4)


@pytest.mark.parametrize(
    ("start", "wrong"),
    [
        ({"x": 96.0}, "w reaches from x = 0 m to 95 m"),
        ({"x": -1.0}, "w reaches from x = 0 m to 95 m"),
        ({"y": 1.0}, r"expected a length, middle or \{x: ...\}"),
        ("start", "from"),
    ],
)
def test_an_x_beyond_the_line_is_refused(start: Any, wrong: str) -> None:
    with pytest.raises(ScenarioError, match=wrong):
        Scenario(lines={"w": WEB}, loads={"p": travels(start)}, run=STILL)  # type: ignore[dict-item,arg-type]


def test_vertical_lines_nets_and_starts_from_modes_need_a_length() -> None:
    upright = {**ROPE, "start": [0, 10], "end": [0, 0], "length": 10.1}
    mode = {**MOVES, "start": {"kind": "mode", "amplitude": 0.01}}
    for line, run, wrong in ((upright, STILL, "no horizontal extent"), (ROPE, mode, "start from rest")):
        with pytest.raises(ScenarioError, match=wrong):
            Scenario(lines={"w": line}, loads={"p": travels("middle")}, run=run)  # type: ignore[dict-item,arg-type]


@pytest.mark.parametrize(
    ("line", "start", "named"),
    [
        (WEB, 47.5, True),
        ({**WEB, "start": [95, 0], "end": [0, 0]}, 30.0, True),
        ({**WEB, "end": [80, 51]}, 40.0, False),  # it gives way along the slope
        ({**WEB, "end": [80, 51]}, 60.0, True),
        ({**WEB, "start": [0, 0, 0], "end": [0, 95, 0]}, 47.5, True),
        ({**WEB, "tension": None, "length": 88.0}, 47.5, True),
        (WEB, 0.5, False),
        (WEB, 43.9, True),  # half of its length: it stands at x = 47.5 m
        (ROPE, 12.0, False),  # the declared length is longer than the span
        (ROPE, 0.5 * 416**0.5, True),  # half of the span
        ({**ROPE, "length": 20.45}, 10.0, False),
    ],
)
def test_starts_along_the_line_that_lie_elsewhere_in_x_are_named(
    line: dict[str, Any], start: float, named: bool
) -> None:
    assert (WARNING in stands(line, travels(start, "force")).warnings) == named


def test_a_model_that_says_itself_where_it_is_has_no_start_to_ask_about() -> None:
    """It begins at 12 m by an option of its own."""
    options = {"start": 12.0, "speed": 0.0}
    own = {"kind": "stepper", "on": "s", "model": "external_cases:Sprung", "every": 0.01, "options": options}
    result = simulate(Scenario.model_validate({"lines": {"s": WEB}, "loads": {"own": own}, "run": MOVES}))
    assert WARNING not in result.warnings
