"""Bodies on modes: contact forces do not depend on output instants, and long computations are foreseen."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.effort import foreseen
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

NET = {"kind": "net", "corner": [0, 0, 0], "sides": [[4, 0, 0], [0, 3, 0]], "cells": [4, 3], "axial_stiffness": 1e3,
       "mass": 0.5, "tension": 100.0}  # fmt: skip
ROPE = {"start": [0, 0], "end": [20, 0], "length": 20.3, "mass": 1.0, "axial_stiffness": 1e5, "elements": 10}
OSCILLATOR: dict[str, Any] = {"kind": "oscillator", "on": "a", "mass": 5.0, "wheel_mass": 1.0, "stiffness": 2e3,
                              "damping": 5.0}  # fmt: skip


def scenario(name: str, every: float, **run: Any) -> Scenario:
    travel = {"speed": 0.01, "from": 1.2, "at_end": "leave"}
    structure: dict[str, Any] = {"lines": {"a": ROPE}}
    if name == "net":
        structure, travel = {"nets": {"a": NET}}, {**travel, "path": [[0.5, 1.5], [3.5, 1.5]]}
    how = {"kind": "linear", "until": 1.0, "every": every, **run}
    return Scenario.model_validate({**structure, "loads": {"w": {**OSCILLATOR, "travel": travel}}, "run": how})


@pytest.mark.parametrize("name", ["net", "rope"])
def test_contact_forces_do_not_depend_on_the_interval_of_output(name: str) -> None:
    few, many = (simulate(scenario(name, every)) for every in (1.0, 0.05))
    assert few.outcome == many.outcome == "completed"
    size = float(np.nanmax(np.abs(many.contact_force.values)))
    # 1 %: half the steps may change forces by 0.1 % of the largest one.
    assert few.contact_force.values[-1] == pytest.approx(many.contact_force.values[-1], abs=1e-2 * size)
    assert few.reaction.values[-1] == pytest.approx(many.reaction.values[-1], abs=1e-2 * size)


def test_a_check_foresees_that_bodies_on_modes_take_long() -> None:
    assert any("geometry: linearised" in one for one in foreseen(scenario("rope", 0.1))[1])
    other = scenario("rope", 0.1, kind="dynamic", geometry="linearised")
    assert not any("geometry: linearised" in one for one in foreseen(other)[1])
