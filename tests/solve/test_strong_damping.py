"""Strong damping: a motion goes on with it, or says which key is to blame."""

from __future__ import annotations

import pytest
import xarray as xr

from ropewalk.model import Scenario
from ropewalk.simulate import simulate


def _taut(load: str, **line: float) -> xr.Dataset:
    rope = {"start": [0, 0], "end": [10, 0], "tension": 1e3, "mass": 1.0, "axial_stiffness": 1e6, "elements": 20}
    loads = {"a": {"kind": load, "mass": 1.0, "on": "rope", "travel": {"speed": 1.0}}} if load else {}
    run = {"kind": "dynamic", "until": 2e-3, "every": 1e-3}
    return simulate(Scenario.model_validate({"lines": {"rope": rope | line}, "loads": loads, "run": run}))


@pytest.mark.parametrize("load", ["", "mass"])
def test_the_largest_drag_still_has_a_motion_and_an_audit(load: str) -> None:
    """The sixth order goes back in time within a step, where drag drives; and what is left of a speed may vanish."""
    result = _taut(load, drag=1e9)
    assert (result.attrs["outcome"], result.attrs["doubts"]) == ("completed", "")
    assert result.attrs["method"] == "verlet"
    assert abs(result["position"][-1] - result["position"][0]).max() < 1e-6


def test_a_damping_that_makes_steps_much_shorter_is_named() -> None:
    message = _taut("mass", axial_damping=1e5).attrs["warnings"]
    assert "lines.rope.axial_damping reduces the stable step by a factor of 8e+02" in message
    assert not _taut("mass", axial_damping=10.0).attrs["warnings"]
