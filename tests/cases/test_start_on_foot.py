"""A motion of people on foot begins in equilibrium with them where this is asked for, on every rope."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.model import Scenario
from ropewalk.simulate import simulate

ROPE: dict[str, Any] = {"start": [0, 0], "end": [12, 0], "length": 12.15, "mass": 1.9, "axial_stiffness": 1e6}
WALK = {"kind": "footsteps", "mass": 60, "frequency": 2, "step_length": 0.7, "on": "rope", "from": 3, "phase": 0.3}
BEGIN = {"kind": "dynamic", "until": 0.01, "every": 0.01, "start": {"with_loads": True}}


def run(loads: dict[str, Any], how: dict[str, Any], **line: Any) -> xr.Dataset:
    tree = {"lines": {"rope": {**ROPE, "elements": 30, **line}}, "loads": loads, "run": how}
    return simulate(Scenario.model_validate(tree))


@pytest.mark.parametrize("others", [{}, {"bob": {"kind": "mass", "mass": 40, "on": "rope", "travel": {"from": 7}}}])
@pytest.mark.parametrize("line", [{}, {"supports": {"none": {"kind": "elastic", "at": 8.1, "stiffness": 0}}}])
def test_footsteps_press_on_the_line_at_first(others: dict[str, Any], line: dict[str, Any]) -> None:
    """As a force that is theirs at t = 0 does; a mesh of 30 links knows a kink to a quarter of a link."""
    others = {name: {**load, "travel": {**load["travel"], "speed": 0}} for name, load in others.items()}
    first = run({"walk": WALK, **others}, BEGIN, **line)
    force = first.contact_force.values[0, 0].tolist()
    assert force[1] < -300.0
    still = {"kind": "force", "force": force, "on": "rope", "travel": {"speed": 0, "from": 3}}
    right = run({"walk": still, **others}, {"kind": "equilibrium"}, **line)
    assert first.position.values[0] == pytest.approx(right.position.values[0], abs=0.02)
    bare = run(others, {"kind": "equilibrium"}, **line)
    assert np.abs(first.position.values[0] - bare.position.values[0]).max() > 0.1
