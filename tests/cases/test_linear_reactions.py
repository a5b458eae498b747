"""Support forces of the linear theory: tension times slope plus shear, in balance with loads, weight and foundation."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

FILE = Path(__file__).parent / "linear-reactions.yaml"
G = 9.81
BEAM: dict[str, Any] = {
    "start": [0, 0], "end": [10, 0], "length": 10, "mass": 100.0, "bending_stiffness": 1.05e6,
    "axial_stiffness": 2.625e9, "elements": 16, "drag": 8.0,
}  # fmt: skip
TAUT = {**BEAM, "length": 9.99}
STRING = {"start": [0, 0], "end": [10, 0], "tension": 1e5, "mass": 1.0, "axial_stiffness": 1e7, "elements": 8}
LINEAR = {"kind": "linear", "until": 4.0, "every": 1.0}
LINEARISED = {**LINEAR, "kind": "dynamic", "geometry": "linearised"}
CLAMPED = {"kind": "fixed", "clamped": True}


def run(line: dict[str, Any], how: dict[str, Any] = LINEAR, gravity: float = 0.0, **load: Any) -> xr.Dataset:
    speed, start = load.pop("speed", 1e-6), load.pop("start", 3.1)
    own = {"kind": "force", "force": [0, -1000.0], **load}
    own |= {"on": "b", "travel": {"speed": speed, "from": start, "at_end": "leave"}}
    return simulate(
        Scenario.model_validate({"gravity": gravity, "lines": {"b": line}, "loads": {"w": own}, "run": how})
    )


def test_support_forces_of_a_hinged_beam_follow_the_slow_force() -> None:
    found = simulate(load(FILE)).reaction.values[..., 1]
    assert found[2] == pytest.approx([490.0, 510.0], rel=1e-3)  # 0.1 % is left of the swing from the start
    assert found[40, 1] == pytest.approx(702.0, abs=0.5)  # a number of three digits


@pytest.mark.parametrize("how", [LINEAR, LINEARISED], ids=["linear", "linearised"])
@pytest.mark.parametrize("place", [0.2, 3.1, 9.0])  # in the first element, within, near the far end
@pytest.mark.parametrize(
    ("line", "left"),
    [
        (BEAM, lambda a: 1.0 - a),
        (TAUT, lambda a: 1.0 - a),
        ({**BEAM, "end_support": {"kind": "guided", "along": [1, 0]}}, lambda a: 1.0 - a),
        ({**BEAM, "start_support": CLAMPED, "end_support": CLAMPED}, lambda a: (1.0 - a) ** 2 * (1.0 + 2.0 * a)),
        ({**BEAM, "start_support": CLAMPED}, lambda a: 1.0 - a**2 * (3.0 - a) / 2.0),
        ({**BEAM, "end_support": CLAMPED}, lambda a: (1.0 - a) ** 2 * (2.0 + a) / 2.0),
    ],
    ids=["hinged", "taut", "roller", "clamped", "clamped at the start", "clamped at the end"],
)
def test_support_forces_under_a_force_at_rest_are_static(
    line: dict[str, Any], left: Any, place: float, how: dict[str, Any]
) -> None:
    found = run(line, how, start=place).reaction.values[-1, :, 1]
    exact = 1000.0 * left(place / 10.0)
    # 4 s leave e^-16 of the swing; the mesh of 16 elements leaves 0.3 % of the load with clamped ends.
    assert found == pytest.approx([exact, 1000.0 - exact], abs=4.0)


@pytest.mark.parametrize("how", [LINEAR, LINEARISED], ids=["linear", "linearised"])
def test_an_inner_support_takes_its_part(how: dict[str, Any]) -> None:
    line = {**BEAM, "supports": {"pier": {"at": 5.0, "kind": "guided", "along": [1, 0]}}}
    a, found = 2.5 / 5.0, run(line, how, start=2.5).reaction.values[-1, :, 1]
    end = -1000.0 * a * (1.0 - a**2) / 4.0  # by the three-moment equation
    pier = 1000.0 * a * (3.0 - a**2) / 2.0
    assert found == pytest.approx([1000.0 - end - pier, end, pier], abs=4.0)  # the mesh, as above


def test_a_foundation_takes_the_rest_of_load_and_weight() -> None:
    found = run({**BEAM, "foundation": 1e5}, gravity=G)
    force, depth = found.reaction.values[-1, :, 1].sum(), -found.position.values[-1, :, 1]
    carried = 1e5 * 10.0 / 16.0 * depth.sum()
    weight = 100.0 * 10.0 * G
    # The trapezoidal rule is exact for the sines of the load, and misses 1 % of the load of the weight near the ends.
    assert force + carried == pytest.approx(1000.0 + weight, rel=3e-3)


@pytest.mark.parametrize("line", [BEAM, TAUT, STRING], ids=["beam", "taut beam", "string"])
@pytest.mark.parametrize("end", [[10, 0], [8, 6]], ids=["level", "inclined"])
def test_supports_carry_weight_and_load_at_rest(line: dict[str, Any], end: list[float]) -> None:
    found = run({**line, "end": end}, gravity=G, start=3.1)
    load, along = np.array([0.0, 1000.0]), np.array(end) / 10.0
    if line is STRING:  # it swings for ever: at first its supports have not felt the load but along it
        load = (load @ along) * along
    total = found.reaction.values[0 if line is STRING else -1].sum(axis=0)
    weight = [0.0, line["mass"] * 10.0 * G]
    assert total == pytest.approx(load + weight, rel=2e-3, abs=1.0)  # taut: 0.1 % less length, and mass


@pytest.mark.parametrize("line", [BEAM, TAUT, STRING], ids=["beam", "taut beam", "string"])
@pytest.mark.parametrize(
    "load",
    [{}, {"kind": "axles", "force": None, "forces": 500.0, "at": [0, 1, 2, 5]}, {"kind": "mass", "mass": 50.0}],
    ids=["force", "axles", "mass"],
)
def test_support_forces_of_the_mirrored_run_are_mirrored(line: dict[str, Any], load: dict[str, Any]) -> None:
    how = {**LINEAR, "until": 1.5, "every": 0.1}
    if load.get("kind") == "mass":
        load = {**load, "force": [0.0, 0.0]}
    there = _moved(line, load, how, 8.0, 0.0)
    back = _moved(line, load, how, -8.0, line.get("length", 10.0))
    assert np.abs(there).max() > 100.0
    assert back[1:, ::-1] == pytest.approx(there[1:], abs=1e-6 * np.abs(there).max())  # rounding of the modes


def _moved(line: dict[str, Any], load: dict[str, Any], how: dict[str, Any], speed: float, start: float) -> Any:
    own = {key: value for key, value in load.items() if value is not None}
    own = {"kind": "force", "force": [0, -1000.0]} | own if load.get("kind") != "axles" else own
    travel = {"speed": speed, "from": start} | ({} if load.get("kind") == "axles" else {"at_end": "leave"})
    given = {"gravity": G, "lines": {"b": line}, "loads": {"w": {**own, "on": "b", "travel": travel}}, "run": how}
    return simulate(Scenario.model_validate(given)).reaction.values[..., 1]


@pytest.mark.xfail(strict=True, reason="one engine, stage 2")
def test_an_elastic_end_bears_a_force_in_the_last_element_with_all_geometry() -> None:
    line = {**BEAM, "end_support": {"kind": "elastic", "stiffness": [1e9, 1e9]}}
    found = run(line, {**LINEAR, "kind": "dynamic"}, start=9.8).reaction.values[-1, :, 1]
    assert found == pytest.approx([20.0, 980.0], abs=10.0)  # 878 N at the end
