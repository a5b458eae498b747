"""A payload starts where `at` or `swing` says, whether its line is joined and whether the loads are in equilibrium."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.capabilities import SYSTEM, engine_of
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

ROPE = {"start": [0, 0], "end": [20, 0], "length": 20.3, "mass": 1, "axial_stiffness": 1e6, "axial_damping": 200,
        "elements": 20}  # fmt: skip
STAY = {"start": [10, 8], "end": [10, 0], "length": 9, "mass": 0.1, "axial_stiffness": 1e5, "elements": 4,
        "end_support": {"kind": "joined", "to": "rope", "at": 15}}  # fmt: skip
LINES: dict[str, dict[str, Any]] = {"alone": {"rope": ROPE}, "joined": {"rope": ROPE, "stay": STAY}}
PLACES = [({"at": [-0.3, -1.99]}, [-0.3, -1.99]), ({"swing": 0.3}, [np.sin(0.3), -np.cos(0.3)])]


def motion(lines: str, payload: dict[str, Any], *, with_loads: bool) -> xr.Dataset:
    load = {"kind": "trolley", "on": "rope", "mass": 1, "travel": {"speed": -3, "from": 8},
            "payload": {"mass": 3, "length": 2, "stiffness": 1e5, **payload}}  # fmt: skip
    run = {"kind": "dynamic", "until": 0.1, "every": 0.05, "start": {"with_loads": with_loads}}
    scenario = Scenario.model_validate({"lines": LINES[lines], "loads": {"one": load}, "run": run})
    assert (engine_of(scenario) is SYSTEM) == (lines == "joined")
    return simulate(scenario)


@pytest.mark.parametrize("with_loads", [True, False])
@pytest.mark.parametrize("lines", LINES)
@pytest.mark.parametrize(("payload", "direction"), PLACES)
def test_a_payload_starts_where_it_is_declared(
    payload: dict[str, Any], direction: list[float], lines: str, with_loads: bool
) -> None:
    found = motion(lines, payload, with_loads=with_loads)
    below = found.body_position.values[0, -1] - found.contact_position.values[0, 0]
    size = 1.0 if "at" in payload else np.hypot(*below) / np.hypot(*direction)
    np.testing.assert_allclose(below, size * np.array(direction), atol=1e-9)
    assert size == pytest.approx(1.0 if "at" in payload else 2.0, rel=1e-3)  # the stretch of its rope


@pytest.mark.parametrize("lines", LINES)
def test_a_payload_without_a_place_of_its_own_begins_in_equilibrium(lines: str) -> None:
    found = motion(lines, {}, with_loads=True)
    below = found.body_position.values[0, -1] - found.contact_position.values[0, 0]
    np.testing.assert_allclose(below, [0.0, -2.0 - 3 * 9.81 / 1e5], atol=1e-9)
