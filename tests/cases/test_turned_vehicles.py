"""A vehicle moves alike on a line in any direction, with its wheels in any order, and given by its matrices."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

FILE = Path(__file__).parent / "vehicle-turned.yaml"
M, I, K, C, G = 20.0, 20.0, 1e4, 50.0, 9.81
WHEELS = {"front": {"at": 1.0, "mass": 1.0}, "rear": {"at": -1.0, "mass": 1.0}}
CAR: dict[str, Any] = {
    "kind": "vehicle", "bodies": {"box": {"mass": M, "inertia": I}}, "wheels": WHEELS,
    "springs": {name: {"between": ["box", name], "stiffness": K, "damping": C} for name in WHEELS},
}  # fmt: skip
STRING = {"tension": 2e4, "mass": 2.0, "axial_stiffness": 1e7, "elements": 20}
ROPE = {"length": 20.6, "mass": 2.0, "axial_stiffness": 1e6, "elements": 20}
CABLE = {**ROPE, "bending_stiffness": 200.0}
RUNS = {
    "linear": {"kind": "linear", "until": 0.4, "every": 0.1},
    "linearised": {"kind": "dynamic", "geometry": "linearised", "until": 0.4, "every": 0.1},
}


def run(how: str, line: dict[str, Any], start: list[float], end: list[float], car: dict[str, Any] = CAR) -> xr.Dataset:
    own = {**car, "on": "a", "travel": {"speed": 10.0, "from": 4.0, "at_end": "leave"}}
    given = {"lines": {"a": {**line, "start": start, "end": end}}, "loads": {"car": own}, "run": RUNS[how]}
    return simulate(Scenario.model_validate(given))


def contacts(result: xr.Dataset) -> Any:
    """Vertical forces, front wheel first."""
    return result.contact_force.sel(load=["car.front", "car.rear"]).values[..., -1]


def test_the_box_of_a_vehicle_is_above_its_line_in_plan() -> None:
    found = simulate(load(FILE, ["run.every=1 s"])).body_position.values[-1, 0]
    assert found[:2] == pytest.approx([11.224, 8.418], abs=4e-3)  # the sag shifts wheels by 4 mm
    back = simulate(load(FILE, ["run.every=1 s", "lines.string.start=[20, 0, 0]", "lines.string.end=[0, 0, 0]"]))
    assert back.body_position.values[-1, 0, 0] == pytest.approx(5.970, abs=4e-3)


@pytest.mark.parametrize("how", RUNS)
@pytest.mark.parametrize("line", [STRING, ROPE, CABLE], ids=["string", "rope", "stiff cable"])
def test_results_turn_with_the_line(line: dict[str, Any], how: str) -> None:
    base = run(how, line, [0, 0, 0], [20, 0, 1])
    for way in ([12, 16, 1], [-20, 0, 1]):
        found = run(how, line, [0, 0, 0], [*map(float, way)])
        along = np.array(way[:2]) / 20.0
        assert contacts(found) == pytest.approx(contacts(base), rel=1e-6, abs=1e-6)  # rounding
        box, same = found.body_position.values[:, 0], base.body_position.values[:, 0]
        assert box[:, :-1] == pytest.approx(same[:, :1] * along[: box.shape[1] - 1], abs=1e-6)
        assert box[:, -1] == pytest.approx(same[:, -1], abs=1e-6)


@pytest.mark.parametrize("how", RUNS)
@pytest.mark.parametrize("line", [ROPE, CABLE], ids=["rope", "stiff cable"])
def test_the_order_of_wheels_changes_nothing(line: dict[str, Any], how: str) -> None:
    base, other = (
        run(how, line, [0, 0], [20, 1], {**CAR, "wheels": {name: WHEELS[name] for name in order}})
        for order in (("front", "rear"), ("rear", "front"))
    )
    assert contacts(other) == pytest.approx(contacts(base), rel=1e-6, abs=1e-6)  # rounding
    assert other.body_position.values == pytest.approx(base.body_position.values, abs=1e-6)


@pytest.mark.parametrize("how", RUNS)
@pytest.mark.parametrize("line", [STRING, ROPE, CABLE], ids=["string", "rope", "stiff cable"])
def test_matrices_of_a_vehicle_are_the_vehicle(line: dict[str, Any], how: str) -> None:
    rows = {"front": [1.0, 1.0, -1.0, 0.0], "rear": [1.0, -1.0, 0.0, -1.0]}
    product = sum(np.outer(row, row) for row in rows.values())
    matrices = {
        "kind": "matrices", "coordinates": ["box", "pitch", "front", "rear"],
        "mass": np.diag([M, I, 1.0, 1.0]).tolist(), "stiffness": (K * product).tolist(),
        "damping": (C * product).tolist(), "weight": [M * G, 0.0, G, G],
        "wheels": {name: {"at": each["at"], "coordinate": name} for name, each in WHEELS.items()},
    }  # fmt: skip
    base, other = (run(how, line, [0, 0], [20, 1], car) for car in (CAR, matrices))
    assert contacts(other) == pytest.approx(contacts(base), rel=1e-6, abs=1e-6)  # rounding
    assert other.position.values == pytest.approx(base.position.values, abs=1e-7)
