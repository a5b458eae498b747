"""Loads that stay at the end of their line stand there in quasi-static runs, on all lines, and vehicles as a whole."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

HERE = Path(__file__).parent
LINES: dict[str, dict[str, Any]] = {
    "rope": {"tension": 2e4, "mass": 2, "axial_stiffness": 1e7, "elements": 12},
    "beam": {"length": 30, "mass": 200, "bending_stiffness": 1e9, "axial_stiffness": 1e9, "elements": 12},
    "rope in wind": {"tension": 2e4, "mass": 2, "axial_stiffness": 1e7, "elements": 12, "wind_drag": 0.01},
}
WIND = {"speed": 0.1, "direction": [1, 0]}


def run(line: str, own: dict[str, Any], positions: int, **more: Any) -> xr.Dataset:
    given = {"b": {"start": [0, 0], "end": [30, 0], **LINES[line], **more}}
    tree: dict[str, Any] = {
        "lines": given, "loads": own, "run": {"kind": "quasistatic", "positions": positions},
    }  # fmt: skip
    if "wind_drag" in given["b"]:
        tree["wind"] = WIND
    return simulate(Scenario.model_validate(tree))


def test_the_second_force_stands_at_the_end_while_the_first_comes_up() -> None:
    found = simulate(load(HERE / "quasistatic-stay.yaml"))
    assert found.contact_position.values[:, 1, 0] == pytest.approx([12.0, 20.0, 28.0, 30.0], abs=1e-4)  # shortening
    total = found.reaction.values[..., 1].sum(axis=1)
    assert total == pytest.approx(2000 * 9.81 * 30 + 2e4, rel=1e-6)  # both loads, always


@pytest.mark.parametrize("line", LINES)
@pytest.mark.parametrize("speed", [5.0, -5.0])
def test_forces_stay_at_either_end(line: str, speed: float) -> None:
    def force(start: float) -> dict[str, Any]:
        travel = {"speed": speed, "from": start if speed > 0 else 29.9 - start, "at_end": "stay"}
        return {"kind": "force", "on": "b", "force": [0, -1e3], "travel": travel}

    found = run(line, {"a": force(6.0), "c": force(12.0)}, 4)
    assert found.contact_position.values[-1, :, 0] == pytest.approx(30.0 if speed > 0 else 0.0, abs=1e-3)
    total = found.reaction.values[..., 1].sum(axis=1)
    assert total == pytest.approx(total[0], rel=1e-5)  # what is at the end is on its support


@pytest.mark.parametrize("line", LINES)
def test_a_vehicle_stops_when_its_front_wheel_is_at_the_end(line: str) -> None:
    wheels = {"rear": {"at": -1.0}, "front": {"at": 1.0}}
    springs = {name: {"between": ["box", name], "stiffness": 1e4} for name in wheels}
    car = {
        "kind": "vehicle", "on": "b", "bodies": {"box": {"mass": 10, "inertia": 5}}, "wheels": wheels,
        "springs": springs, "travel": {"speed": 5.0, "from": 20.0, "at_end": "stay"},
    }  # fmt: skip
    found = run(line, {"car": car, "f": {"kind": "force", "on": "b", "force": [0, -1e2],
                                         "travel": {"speed": 5.0, "from": 8.0, "at_end": "stay"}}}, 5)  # fmt: skip
    assert found.contact_position.values[-1, :2, 0] == pytest.approx([28.0, 30.0], abs=0.01)  # strain of the line
    assert found.body_position.values[-1, 0, 0] == pytest.approx(29.0, abs=0.01)
