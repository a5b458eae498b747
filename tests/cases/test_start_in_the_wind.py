"""Motions begin in equilibrium in the wind where this is asked for, and otherwise a warning names the sudden wind."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk import load
from ropewalk.errors import ScenarioError
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

FILE = Path(__file__).parent / "start-in-the-wind.yaml"
WIND = {"direction": [0, 1, 0], "speed": 10.0}
ROPE: dict[str, Any] = {
    "start": [0, 0, 0], "end": [20, 0, 0], "length": 20.2, "mass": 0.5, "axial_stiffness": 1e5, "wind_drag": 0.03,
    "elements": 8,
}  # fmt: skip
HALF = {**ROPE, "length": 10.1, "end": [10, 0, -1], "end_support": {"kind": "joined", "to": "middle"}}
OTHER = {**HALF, "start": [20, 0, 0]}
STRUCTURES: dict[str, dict[str, Any]] = {
    "rope": {"lines": {"a": ROPE}},
    "sloped rope": {"lines": {"a": {**ROPE, "end": [16, 2, 12]}}},
    "inextensible rope": {"lines": {"a": {k: v for k, v in ROPE.items() if k != "axial_stiffness"} | {
        "law": {"kind": "inextensible"}}}},
    "beam": {"lines": {"a": {**ROPE, "length": 20.0, "bending_stiffness": 2e3}}},
    "rope over a sheave": {"lines": {"a": {**ROPE, "length": 20.4, "sheaves": {"s": {"at": [8, 0, 1]}}}}},
    "joined ropes": {"joints": {"middle": {"mass": 5.0}}, "lines": {"a": HALF, "b": OTHER}},
}  # fmt: skip


def run(structure: dict[str, Any], **more: Any) -> xr.Dataset:
    return simulate(Scenario.model_validate({"wind": WIND, **structure, **more}))


def warned(result: xr.Dataset) -> bool:
    return "acts suddenly at t = 0" in result.warnings


def test_the_wind_is_said_to_act_suddenly_and_the_remedy_ends_the_transient() -> None:
    sudden = simulate(load(FILE))
    steady = simulate(load(FILE, ["run.start={in_wind: true}"]))
    aside = [float(np.abs(each.position.sel(axis="y")).max()) for each in (sudden, steady)]
    # 2-figure sizes of the case: the first swing reaches 1.67 times the static deflection.
    assert aside == pytest.approx([3.21, 1.92], abs=0.01)
    assert warned(sudden)
    assert "write run.start: {in_wind: true}" in sudden.warnings
    assert not warned(steady)


@pytest.mark.parametrize("name", STRUCTURES)
def test_what_begins_in_equilibrium_in_the_wind_stays_there(name: str) -> None:
    ask: dict[str, Any] = {"kind": "dynamic", "until": 0.4, "every": 0.1}
    steady = run(STRUCTURES[name], run={**ask, "start": {"in_wind": True}})
    sudden = run(STRUCTURES[name], run=ask)
    speeds = [float(np.abs(each.velocity[1:]).max()) for each in (steady, sudden)]
    # What is left is rounding of the equilibrium, and the lag of its forces by a step.
    assert speeds[0] < 1e-3 * speeds[1]
    still = run(STRUCTURES[name], run={"kind": "equilibrium"})
    # Over a sheave the two kinds of run share a coarse mesh of weights differently, in calm air as well.
    assert steady.position.values[0] == pytest.approx(still.position.values[0], abs=0.02 if "sheave" in name else 1e-6)
    assert warned(sudden)
    assert not warned(steady)


def test_a_breeze_that_hardly_moves_a_line_is_not_said_to_act_suddenly() -> None:
    ask = {"kind": "dynamic", "until": 0.2, "every": 0.1}
    for speed, named in ((0.3, False), (1.0, True)):  # 0.3 and 3.7 thousandths of the weight
        assert warned(run(STRUCTURES["rope"], run=ask, wind={**WIND, "speed": speed})) == named


def test_loads_rest_in_the_wind_too() -> None:
    loads = {"w": {"kind": "mass", "on": "a", "mass": 20.0, "air_drag": 0.5, "travel": {"speed": 0.0, "from": 10.1}}}
    ask = {"kind": "dynamic", "until": 0.4, "every": 0.1, "start": {"in_wind": True, "with_loads": True}}
    moved = run({"lines": {"a": ROPE}}, loads=loads, run=ask)
    aside = moved.contact_position.values[0, 0, 1]
    # The drag of the moving mass is that of the equilibrium but for 0.03 N, which moves it by 0.03 % of the way.
    assert aside > 0.4
    assert np.ptp(moved.contact_position.values, axis=0).max() < 1e-3 * aside


@pytest.mark.parametrize(
    ("speed", "sudden"),
    [
        ({"time": [0.0, 5.0], "value": [0.0, 10.0]}, False),
        ({"time": [0.0, 5.0], "value": [5.0, 10.0]}, True),
        ({"time": [5.0, 6.0], "value": [10.0, 0.0]}, True),
        ({"time": [-1.0, 0.0, 5.0], "value": [10.0, 0.0, 10.0]}, False),
        (0.0, False),
        (-3.0, True),
    ],
)
def test_wind_that_grows_from_zero_is_not_sudden(speed: Any, sudden: bool) -> None:
    ask = {"kind": "dynamic", "until": 0.01}
    assert warned(run({"lines": {"a": ROPE}}, wind={**WIND, "speed": speed}, run=ask)) == sudden


def test_linear_theory_in_steady_wind_begins_in_calm_air_and_says_so() -> None:
    result = run({"lines": {"a": ROPE}}, run={"kind": "linear", "until": 0.1})
    assert warned(result)
    assert "write kind: dynamic with start: {in_wind: true}" in result.warnings


def test_only_wind_that_acts_on_something_can_be_begun_in() -> None:
    lines: Any = {"a": {**ROPE, "wind_drag": 0.0}}
    with pytest.raises(ScenarioError, match=r"run\.start\.in_wind"):
        Scenario(lines=lines, run={"kind": "dynamic", "until": 1.0, "start": {"in_wind": True}})  # type: ignore[arg-type]
