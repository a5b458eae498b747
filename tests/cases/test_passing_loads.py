"""Forces that meet or overtake one another pass, and add up; what has a mass is refused with a remedy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

HERE = Path(__file__).parent
SPAN = {"start": [0, 0], "end": [20, 0]}
BEAM = {
    **SPAN, "length": 20, "mass": 100, "bending_stiffness": 1e7, "axial_stiffness": 1e9, "elements": 16,
    "end_support": {"kind": "guided", "along": [1, 0]},
}  # fmt: skip
ROPE = {**SPAN, "tension": 1e5, "mass": 5, "axial_stiffness": 1e6, "elements": 20, "axial_damping": 20}
HANGER = {
    "start": [10, 10], "end": [10, 0], "tension": 1e3, "mass": 1, "axial_stiffness": 1e5, "elements": 2,
    "end_support": {"kind": "joined", "to": "b", "at": 10},
}  # fmt: skip
PIER = {"pier": {"at": 8, "kind": "guided", "along": [1, 0]}}
STRUCTURES: dict[str, dict[str, Any]] = {
    "beam": {"b": BEAM}, "pier": {"b": {**BEAM, "supports": PIER}}, "rope": {"b": ROPE},
    "joined": {"b": BEAM, "h": HANGER},
}  # fmt: skip
WAYS = {"meet": ((10.0, 2.0), (-8.0, 17.0)), "overtake": ((12.0, 1.0), (3.0, 6.0))}


def force(size: float, speed: float, start: float) -> dict[str, Any]:
    return {"kind": "force", "on": "b", "force": [0, -size], "travel": {"speed": speed, "from": start}}


def axles(size: float, speed: float, start: float) -> dict[str, Any]:
    travel = {"speed": speed, "from": start}
    return {"kind": "axles", "on": "b", "forces": max(size, 1e-9), "at": [0, 2], "travel": travel}


def run(structure: str, loads: dict[str, Any], geometry: str = "linearised") -> xr.Dataset:
    how = {"kind": "dynamic", "until": 1.3, "every": 0.1, "geometry": geometry}
    return simulate(Scenario.model_validate({"lines": STRUCTURES[structure], "loads": loads, "run": how}))


@pytest.mark.parametrize("kind", [force, axles])
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("structure", STRUCTURES)
def test_two_forces_that_pass_are_their_superposition(structure: str, way: str, kind: Any) -> None:
    one, two = WAYS[way]
    sizes = ((1e3, 2e3), (1e3, 0.0), (0.0, 2e3), (0.0, 0.0))
    both, first, second, none = (run(structure, {"one": kind(a, *one), "two": kind(c, *two)}) for a, c in sizes)
    assert both.attrs["outcome"] == "completed"
    for name in ("position", "reaction"):
        found, sum_ = (both[name] - none[name]).values, (first[name] + second[name] - 2.0 * none[name]).values
        np.testing.assert_allclose(found, sum_, rtol=0.0, atol=1e-7 * np.abs(found).max())  # rounding of EA


@pytest.mark.parametrize("structure", STRUCTURES)
def test_the_order_of_loads_that_pass_makes_no_difference(structure: str) -> None:
    """With nonlinear geometry, too, where the energy audit of every run closes."""
    one, two = WAYS["meet"]
    loads = {"one": force(1e3, *one), "two": force(2e3, *two)}
    same(*(run(structure, dict(items), "nonlinear") for items in (loads.items(), reversed(loads.items()))))


SLACK = {**SPAN, "end": [20, 1], "length": 20.5, "mass": 3, "axial_stiffness": 5e5, "axial_damping": 100}


@pytest.mark.parametrize("elements", [12, 48])
@pytest.mark.parametrize("line", [ROPE, SLACK])
@pytest.mark.parametrize("behind", [(8.0, 3.0), (3.0, 5.9), (-4.0, 9.0)])
def test_the_order_of_forces_close_to_each_other_makes_no_difference(
    behind: tuple[float, float], line: dict[str, Any], elements: int
) -> None:
    """A rope without bending stiffness rang by a quarter of its tension where nodes changed from force to force."""
    loads = {"one": force(200, 3.0, 6.0), "two": force(100, *behind)}
    how = {"kind": "dynamic", "until": 0.9, "every": 0.1, "start": {"with_loads": True}}
    lines = {"b": {**line, "elements": elements}}
    same(*(
        simulate(Scenario.model_validate({"lines": lines, "loads": dict(items), "run": how}))
        for items in (loads.items(), reversed(loads.items()))
    ))  # fmt: skip


def same(one: xr.Dataset, two: xr.Dataset) -> None:
    assert one.attrs["outcome"] == two.attrs["outcome"] == "completed"
    size = np.abs((one.position - one.position[0]).values).max()
    np.testing.assert_allclose(two.position, one.position, rtol=0.0, atol=1e-9 * size)  # rounding


def test_a_lorry_and_a_car_meet_on_a_bridge() -> None:
    found = simulate(load(HERE / "loads-that-meet.yaml", ["lines.bridge.elements=20", "run.until=12 s"]))
    assert found.attrs["outcome"] == "completed"


MASSES = {
    "one": {"kind": "mass", "on": "b", "mass": 1, "travel": {"speed": 10.0, "from": 2.0}},
    "two": {"kind": "mass", "on": "b", "mass": 1, "travel": {"speed": -8.0, "from": 17.0}},
}


def test_masses_that_meet_are_refused_and_the_remedy_works() -> None:
    with pytest.raises(ValueError, match=r"meets load one at 0.8333 s.*kind: force .contact: clamped. with its weight"):
        run("beam", MASSES)
    weights = {name: {**mass, "kind": "force", "force": [0, -9.81]} for name, mass in MASSES.items()}
    found = run("beam", {name: {k: v for k, v in own.items() if k != "mass"} for name, own in weights.items()})
    assert found.attrs["outcome"] == "completed"


@pytest.mark.xfail(strict=True, reason="one engine, stage 3", raises=ValueError)
def test_two_light_masses_that_pass_are_the_superposition_of_their_weights() -> None:
    one, two = WAYS["meet"]
    weights = run("beam", {"one": force(9.81, *one), "two": force(9.81, *two)})
    passing = run("beam", MASSES)
    size = np.abs((weights.position - weights.position[0]).values).max()
    np.testing.assert_allclose(passing.position, weights.position, rtol=0.0, atol=0.02 * size)  # 2 kg of 2000 kg
