"""Loads with a mass at rest and in slow motion: they press with their weights, vehicles as their springs share them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.model import Scenario
from ropewalk.simulate import simulate

ROPE = {"start": [0, 0], "end": [19, 3], "length": 20, "mass": 1.0, "axial_stiffness": 1e5, "elements": 80}
WEIGHT = 98.1  # N
TRAVEL = {"speed": 1.0, "from": 2.0}
SLOW = {"kind": "quasistatic", "positions": 9}


def run(load: dict[str, Any], how: dict[str, Any], **line: Any) -> xr.Dataset:
    tree = {
        "lines": {"rope": {**ROPE, **line}},
        "loads": {"load": {"on": "rope", "travel": TRAVEL, **load}},
        "run": how,
    }
    return simulate(Scenario.model_validate(tree))


def vehicle(*places: float, stiffness: float = 1e4, speed: float = 1.0) -> dict[str, Any]:
    names = [f"wheel {i}" for i in range(len(places))]
    return {
        "kind": "vehicle", "bodies": {"box": {"mass": 1000.0, "inertia": 500.0}},
        "wheels": {name: {"at": at, "mass": 10.0} for name, at in zip(names, places, strict=True)},
        "springs": {name: {"between": ["box", name], "stiffness": stiffness * (i + 1)} for i, name in enumerate(names)},
        "travel": {"speed": speed, "from": 5.0},
    }  # fmt: skip


@pytest.mark.parametrize("load", [
    {"kind": "mass", "mass": 10.0}, {"kind": "oscillator", "mass": 8.0, "wheel_mass": 2.0, "stiffness": 1e3},
    {"kind": "mass", "mass": 4.0, "force": [0.0, -6.0 * 9.81]},
    {"kind": "trolley", "mass": 3.0, "payload": {"mass": 7.0, "length": 2.0, "stiffness": 7e4}},
    {"kind": "matrices", "coordinates": ["y"], "mass": [[10.0]], "stiffness": [[0.0]],
     "wheels": {"w": {"coordinate": "y"}}},
], ids=["mass", "oscillator", "mass with a force", "trolley", "matrices"])  # fmt: skip
@pytest.mark.parametrize("how", [SLOW, {"kind": "equilibrium"}], ids=["slow", "rest"])
def test_a_weight_is_a_weight(load: dict[str, Any], how: dict[str, Any]) -> None:
    force = run({"kind": "force", "force": [0.0, -WEIGHT]}, how)
    found = run(load, how)
    assert found.attrs["outcome"] == "completed"
    np.testing.assert_allclose(found.contact_position, force.contact_position, atol=1e-9)
    np.testing.assert_allclose(found.contact_force.values[..., 1], -WEIGHT, rtol=1e-9)


def test_bodies_stand_on_their_springs_and_payloads_hang() -> None:
    found = run({"kind": "oscillator", "mass": 8.0, "wheel_mass": 2.0, "stiffness": 1e3}, SLOW)
    sunk = (found.body_position.values - found.contact_position.values)[:, 0]
    np.testing.assert_allclose(sunk, np.tile([0.0, -8.0 * 9.81 / 1e3], (9, 1)), atol=1e-9)
    found = run({"kind": "trolley", "mass": 3.0, "payload": {"mass": 7.0, "length": 2.0, "stiffness": 7e3}}, SLOW)
    hung = (found.body_position.values - found.contact_position.values)[:, 0]
    np.testing.assert_allclose(hung, np.tile([0.0, -2.0 - 7.0 * 9.81 / 7e3], (9, 1)), atol=1e-9)


@pytest.mark.parametrize("places", [(1.0, -1.0), (1.5, 0.0, -1.5)], ids=["two wheels", "three wheels"])
def test_a_vehicle_stands_as_where_motion_with_loads_begins(places: tuple[float, ...]) -> None:
    """The same rest by the equilibrium alone, and by that of motion: wheels between nodes, weights shared."""
    rest = run(vehicle(*places), {"kind": "equilibrium"})
    begun = run(
        vehicle(*places, speed=0.0), {"kind": "dynamic", "until": 0.01, "every": 0.01, "start": {"with_loads": True}}
    )
    np.testing.assert_allclose(rest.contact_position[0], begun.contact_position[0], atol=1e-6)
    np.testing.assert_allclose(rest.contact_force[0], begun.contact_force[0], rtol=1e-6, atol=1e-3)
    np.testing.assert_allclose(rest.body_position[0], begun.body_position[0], atol=1e-6)
    total = (1000.0 + 10.0 * len(places)) * 9.81
    assert float(rest.contact_force[0, :, 1].sum()) == pytest.approx(-total, rel=1e-9)


def test_three_wheels_agree_with_their_springs_everywhere() -> None:
    """Height and pitch of the box follow from the wheels: its springs then press with the forces that are found."""
    found = run(vehicle(1.5, 0.0, -1.5), SLOW)
    assert found.attrs["outcome"] == "completed"
    z, force = found.contact_position.values[:, :, 1], -found.contact_force.values[:, :, 1] - 10.0 * 9.81
    k, at, weight = 1e4 * np.arange(1.0, 4.0), np.array([1.5, 0.0, -1.5]), 1000.0 * 9.81
    for heights, shares in zip(z, force, strict=True):
        # sum k (y + q s - z) = -weight, and of the moments zero
        K = np.array([[k.sum(), k @ at], [k @ at, k @ at**2]])
        y, q = np.linalg.solve(K, [k @ heights - weight, (k * at) @ heights])
        np.testing.assert_allclose(-k * (y + q * at - heights), shares, rtol=1e-6)


def test_people_are_for_motion() -> None:
    walker = {"kind": "walker", "on": "rope", "mass": 70.0}
    with pytest.raises(ValueError, match="not implemented for equilibria and quasi-static runs of ropes"):
        Scenario.model_validate({"lines": {"rope": ROPE}, "loads": {"w": walker}, "run": SLOW})
