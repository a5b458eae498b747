"""Bodies that pass each other on one line and wheels that an end draws together make a run doubtful; remedies work."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.model import Scenario
from ropewalk.simulate import simulate

SPAN = {"start": [0, 0], "end": [30, 0], "axial_stiffness": 1e9, "elements": 12}
BEAM = {**SPAN, "length": 30, "mass": 200, "bending_stiffness": 1e9}
ROPE = {**SPAN, "tension": 2e4, "mass": 2, "axial_stiffness": 1e7, "axial_damping": 50}
LINES = {"beam": BEAM, "rope": ROPE}


def run(line: dict[str, Any], loads: dict[str, Any], until: float = 1.3, **more: Any) -> xr.Dataset:
    how = {"kind": "dynamic", "until": until, "every": 0.1, **more}
    return simulate(Scenario.model_validate({"lines": {"b": line}, "loads": loads, "run": how}))


def car(**travel: Any) -> dict[str, Any]:
    wheels = {"rear": {"at": -1.0}, "front": {"at": 1.0}}
    springs = {name: {"between": ["box", name], "stiffness": 1e4, "damping": 100} for name in wheels}
    bodies = {"box": {"mass": 10, "inertia": 5}}
    return {
        "kind": "vehicle", "on": "b", "bodies": bodies, "wheels": wheels, "springs": springs,
        "travel": {"at_end": "stay", **travel},
    }  # fmt: skip


@pytest.mark.parametrize("geometry", ["nonlinear", "linearised"])
@pytest.mark.parametrize("line", LINES)
@pytest.mark.parametrize("travel", [{"speed": 10.0, "from": 20.0}, {"speed": -10.0, "from": 10.0}])
def test_wheels_that_an_end_draws_together_are_named(line: str, geometry: str, travel: dict[str, Any]) -> None:
    found = run(LINES[line], {"car": car(**travel)}, geometry=geometry)
    assert found.outcome in ("doubtful", "loads met")
    assert "wheels of load car decreases between t = 0.8 and 0.9 s" in found.doubts
    assert "(loads.car.travel.at_end); write at_end: leave, or end the run before t = 0.8 s" in found.doubts
    left, ended = car(**travel, at_end="leave"), run(LINES[line], {"car": car(**travel)}, 0.79, geometry=geometry)
    assert "decreases" not in ended.doubts + run(LINES[line], {"car": left}, geometry=geometry).doubts


@pytest.mark.xfail(strict=True, reason="one engine, stage 3")
def test_a_vehicle_stops_as_a_whole() -> None:
    found = run(BEAM, {"car": car(speed=10.0, **{"from": 20.0})}).contact_position.values[-1, :, 0]
    assert found[1] - found[0] == pytest.approx(2.0, abs=1e-3)  # the beam hardly bends


def mass(start: float, speed: float, measured: str = "material", **more: Any) -> dict[str, Any]:
    return {
        "kind": "mass",
        "mass": 1,
        "on": "b",
        "travel": {"speed": speed, "from": start, "measured": measured},
        **more,
    }


@pytest.mark.parametrize(
    ("one", "two"),
    [
        (mass(2.0, 10.0), mass(17.0, -8.0, "horizontal")),
        (mass(17.0, -8.0, "horizontal"), mass(2.0, 10.0)),
        (mass(2.0, 16.0, "slip"), {**mass(8.0, 2.0), "kind": "oscillator", "wheel_mass": 0.1, "stiffness": 1e3}),
        (mass(2.0, 16.0, "horizontal"), {"kind": "force", "on": "b", "force": [0, -10],
                                         "travel": {"speed": 2.0, "from": 8.0}}),
    ],
)  # fmt: skip
def test_bodies_that_pass_each_other_by_places_measured_otherwise_are_named(one: Any, two: Any) -> None:
    found = run(BEAM, {"one": one, "two": two}, 1.0)
    assert found.outcome == "doubtful"
    assert "loads one and two pass each other between t =" in found.doubts
    begin = float(found.doubts.partition("end the run before t = ")[2].partition(" s")[0])
    assert "pass each other" not in run(BEAM, {"one": one, "two": two}, begin).doubts
    weights = {
        name: {"kind": "force", "on": "b", "force": [0, -9.81], "travel": each["travel"]}
        for name, each in {"one": one, "two": two}.items()
    }
    assert "pass each other" not in run(BEAM, weights, 1.0).doubts


def test_bodies_that_keep_their_order_are_not_named() -> None:
    found = run(
        BEAM, {"one": mass(2.0, 10.0), "two": mass(5.0, 10.0, "horizontal"), "car": car(**{"speed": 5, "from": 15})}
    )
    assert "pass each other" not in found.doubts
    assert "decreases" not in found.doubts
    assert np.diff(found.contact_position.values[-1, :2, 0])[0] == pytest.approx(3.0, abs=0.01)  # it hardly bends


def test_masses_that_run_by_themselves_cannot_be_forces() -> None:
    free = {
        name: {"kind": "mass", "mass": 5, "on": "b", "travel": {"kind": "free", "from": start, "speed": speed}}
        for name, start, speed in (("one", 5, 8), ("two", 10, 0))
    }
    found = run({**ROPE, "end": [30, 8], "bending_stiffness": 100}, free, 1.0)
    assert "loads one and two pass each other between t = " in found.doubts
    assert "kind: force" not in found.doubts
