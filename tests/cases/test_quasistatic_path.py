"""Quasi-static runs cover all loads until the last has left its line, whatever the order of keys and directions."""

from __future__ import annotations

from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.results.line_response import response_summary
from ropewalk.simulate import simulate

HERE = Path(__file__).parent
SPAN = {"start": [0, 0], "end": [30, 0]}
BEAM = {**SPAN, "length": 30, "mass": 100, "bending_stiffness": 1e9, "axial_stiffness": 1e9, "elements": 12}
ROPE = {**SPAN, "length": 30.2, "mass": 2.0, "axial_stiffness": 1e6, "elements": 12}
HANGER = {
    "start": [15, 8], "end": [15, 0], "length": 8, "mass": 1.0, "axial_stiffness": 1e6, "elements": 2,
    "end_support": {"kind": "joined", "to": "b", "at": 15.0},
}  # fmt: skip
PIER = {"pier": {"at": 10.0, "kind": "guided", "along": [1, 0]}}
STRUCTURES: dict[str, dict[str, Any]] = {
    "rope": {"b": ROPE},
    "beam": {"b": BEAM},
    "beam on a pier": {"b": {**BEAM, "supports": PIER}},
    "joined beam": {"b": BEAM, "h": HANGER},
    "joined ropes": {"b": ROPE, "h": HANGER},
}


def force(size: float, speed: Any, start: float, **travel: Any) -> dict[str, Any]:
    travel = {"speed": speed, "from": start, "at_end": "leave", **travel}
    return {"kind": "force", "on": "b", "force": [0, -size], "travel": travel}


def run(lines: dict[str, Any], loads: dict[str, Any], positions: int = 25) -> xr.Dataset:
    return simulate(
        Scenario.model_validate(
            {"lines": lines, "loads": loads, "run": {"kind": "quasistatic", "positions": positions}}
        )
    )


def largest(result: xr.Dataset, what: str) -> float:
    return abs(float(response_summary(result)["bridge"][what]["largest"]["value"]))


@pytest.mark.parametrize("order", [("car", "lorry"), ("lorry", "car")])
def test_the_slow_lorry_reaches_midspan_after_the_car_has_left(order: tuple[str, str]) -> None:
    asked = load(HERE / "quasistatic-unlike-speeds.yaml")
    found = simulate(asked.model_copy(update={"loads": {name: asked.loads[name] for name in order}}))
    assert largest(found, "moment") == pytest.approx(10.0e6, rel=0.009)  # P L / 4; half a step of 0.87 m of 50 m
    assert found.contact_position.values[-1, order.index("lorry"), 0] == pytest.approx(100.0, abs=1e-3)  # its strain
    assert found.load_path.values[-1] == pytest.approx(99.0 + 5.0 * (20.0 - 4.95))  # 20 s, the car 4.95 s of them


@pytest.mark.parametrize("structure", STRUCTURES)
def test_results_do_not_depend_on_the_order_of_loads(structure: str) -> None:
    """Three loads of unlike speeds and directions, one of which pauses, and two axles."""
    pause = {"time": [0, 1, 1.5, 2.5, 3], "value": [6, 6, 0, 0, 6]}
    loads = {
        "fast": force(100.0, 12.0, 2.0),
        "slow": force(900.0, -3.0, 28.0),
        "axles": {"kind": "axles", "on": "b", "forces": 200, "at": [0, 4], "travel": {"speed": 5.0, "from": -1.0}},
        "waits": force(50.0, pause, 1.0),
    }
    if structure == "rope":
        del loads["axles"]  # these take ropes to another engine
    found = {
        order: run(STRUCTURES[structure], {k: loads[k] for k in order}) for order in list(permutations(loads))[::9]
    }
    first, *others = found.items()
    for names, result in others:
        assert result.attrs["outcome"] == "completed"
        assert result.load_path.values == pytest.approx(first[1].load_path.values)
        assert result.reaction.values == pytest.approx(first[1].reaction.values, rel=1e-6, abs=1e-2)
        assert {*names} == {*loads}
    names, result = first
    places = {name: result.contact_position.sel(load=name).values for name in result["load"].values}
    assert np.nanmin(places["slow"][..., 0]) < 1.3  # a step of the slowest load
    assert np.isnan(places["fast"][-1, 0])


def test_a_load_that_stands_does_not_end_the_path() -> None:
    standing, moving = force(100.0, 0.0, 10.0, at_end="refuse"), force(100.0, 5.0, 1.0)
    found = run({"b": BEAM}, {"stands": standing, "moves": moving}, 5)
    assert found.load_path.values == pytest.approx(np.linspace(0.0, 29.0, 5))
    assert found.contact_position.values[:, 0, 0] == pytest.approx(10.0, abs=1e-3)


@pytest.mark.parametrize("structure", STRUCTURES)
def test_a_load_that_begins_at_the_very_end_goes_all_the_way_back(structure: str) -> None:
    length = STRUCTURES[structure]["b"]["length"]
    there, back = (run(STRUCTURES[structure], {"w": force(1e3, v, s)}, 9) for v, s in ((4.0, 0.0), (-4.0, length)))
    assert back.load_path.values == pytest.approx(there.load_path.values, rel=1e-9)
    assert back.reaction.values[::-1] == pytest.approx(
        there.reaction.values, rel=1e-4, abs=0.5
    )  # both ends: at supports


def test_impact_factors_backwards_are_those_forwards() -> None:
    asked = load(HERE / "impact-backwards.yaml", ["lines.b.elements=20", "run.every=20 ms"])
    found = {}
    for speed, start in ((-20.0, 50.0), (20.0, 0.0)):
        axles = asked.loads["t"]
        travel = axles.travel.model_copy(update={"speed": speed, "start": start})
        scenario = asked.model_copy(update={"loads": {"t": axles.model_copy(update={"travel": travel})}})
        entry = response_summary(simulate(scenario))["b"]
        found[speed] = [entry[key]["impact"]["value"] for key in ("deflection", "moment", "shear")]
    assert found[-20.0] == pytest.approx(found[20.0], rel=1e-6)
    assert found[-20.0] == pytest.approx([1.83, 1.65, 1.76], rel=0.03)  # with 50 elements; 20 miss 2 % of moments


def test_impact_factors_of_loads_of_unlike_speeds_do_not_depend_on_their_order() -> None:
    asked = load(HERE / "quasistatic-unlike-speeds.yaml", ["lines.bridge.elements=20"])
    run = {"kind": "dynamic", "geometry": "linearised", "until": 12.0, "every": 0.1}
    found = []
    for order in (("car", "lorry"), ("lorry", "car")):
        tree = {**asked.model_dump(by_alias=True, exclude_unset=True), "run": run, "outputs": {"impact": True}}
        tree["loads"] = {name: tree["loads"][name] for name in order}
        entry = response_summary(simulate(Scenario.model_validate(tree)))["bridge"]
        found.append([entry[key]["impact"]["value"] for key in ("deflection", "moment")])
    assert found[0] == pytest.approx(found[1], rel=1e-6)
    assert found[0] == pytest.approx([1.0, 1.0], abs=0.03)  # a lorry of 5 m/s is slow: the period is 0.4 s
