"""Simpler models on nets: the linear theory is right as loads vanish; a vehicle becomes its static wheel loads."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.compare import distances, model_hierarchy
from ropewalk.compare.paths_on_nets import paths_on_nets
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

NET = {"kind": "net", "corner": [0, 0, 0], "sides": [[4, 0, 0], [0, 3, 0]], "cells": [8, 6], "axial_stiffness": 1e4,
       "mass": 0.05, "tension": 100.0}  # fmt: skip
PATH = [[0.5, 1.4], [3.5, 1.6]]


def on_net(load: dict[str, Any], until: float = 0.1) -> Scenario:
    load = {"on": "net", "travel": {"speed": 6.0, "from": 0.4, "path": PATH}} | load
    run = {"kind": "dynamic", "until": until, "every": until / 20.0}
    return Scenario.model_validate({"nets": {"net": NET}, "loads": {"load": load}, "run": run})


def test_the_linear_theory_is_right_as_the_load_vanishes() -> None:
    found = []
    for size in (8.0, 2.0):
        off = distances(on_net({"kind": "force", "force": [0, 0, -size]}), ["linear"])["linear"]
        found.append([off["deflection"], off["path"]])
    print(found)
    small = np.array(found, dtype=float)
    assert (small[1] < 5e-3).all()
    assert (small[1] < 0.4 * small[0]).all()


def test_deflections_count_from_where_the_net_rests_under_the_path() -> None:
    """Where a contact that hardly presses is, all along its way."""
    scenario = on_net({"kind": "force", "force": [0, 0, -1e-6]})
    result = simulate(scenario)
    path = paths_on_nets(scenario)["load"]
    rest = path.rest(result.contact_xi.values[:, 0], result.position.values[0])
    sag = np.ptp(result.position.values[0][:, 2])
    assert rest == pytest.approx(result.contact_position.values[:, 0], abs=0.03 * sag)  # a spline of a few links


def test_a_vehicle_on_a_net_is_compared_with_its_static_wheel_loads() -> None:
    frame = {"mass": 2.0, "inertia": 0.3, "at": -0.3}
    wheels = {"front": {"mass": 0.2, "at": 0.0}, "rear": {"mass": 0.2, "at": -0.6}}
    springs = {name: {"between": ["frame", name], "stiffness": 2e3, "damping": 20.0} for name in wheels}
    vehicle = {"kind": "vehicle", "bodies": {"frame": frame}, "wheels": wheels, "springs": springs}
    found = model_hierarchy(on_net(vehicle | {"travel": {"speed": 6.0, "from": 1.2, "path": PATH}}))
    assert {name: step.reason for name, step in found.models.items() if step.reason} == {}
    forces = found.models["moving force"].quantities
    assert forces is not None
    # Half of its weight on each.
    assert forces.wheels["load.front"]["contact_force"]["value"] == pytest.approx(1.2 * 9.81, rel=1e-6)
    assert forces.lines["net"]["tension"]["value"] > 200.0  # N/m, what it is laid out with
