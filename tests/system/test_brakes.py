"""Brakes at the end of a line: eddy currents, with and without a limit, and a spring, beside closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk import calc
from ropewalk.errors import ScenarioError
from ropewalk.model import Brake, Scenario
from ropewalk.simulate import simulate

M, V, STRETCH = 80.0, 10.0, 1.002
HIGH = STRETCH * (40.0 / STRETCH - 25.0)  # m, where the brake begins
BEGIN = (HIGH - 5.0 * STRETCH) / V  # s


def slide(**brake: float) -> tuple[Any, Any, xr.Dataset]:
    """Times, places and the result of a mass of 80 kg that comes at 10 m/s along a taut, stiff, level rope."""
    line = {"start": [0, 0], "end": [40, 0], "tension": 20e3, "mass": 0.5, "axial_stiffness": 1e7, "elements": 20}
    travel = {"kind": "free", "from": 5.0, "speed": V, "brake": {**brake, "within": 25.0}}
    run = simulate(
        Scenario.model_validate(
            {
                "gravity": 0.0, "lines": {"rope": line},
                "loads": {"m": {"kind": "mass", "on": "rope", "mass": M, "travel": travel}},
                "run": {"kind": "dynamic", "until": 4.0, "every": 0.02},
            }
        )
    )  # fmt: skip
    assert run.attrs["outcome"] == "completed"
    assert abs(run.energy.sel(form="imbalance")).max() < 1e-5 * 0.5 * M * V**2
    return run.time.to_numpy(), run.contact_position.to_numpy()[:, 0, 0], run


def test_eddy_currents_slow_down_exponentially() -> None:
    """x = m v0/c (1 - exp(-c t/m)); the rope gives way by some mm, and speeds differ by its stretch of 0.2 %."""
    t, x, run = slide(rate=80.0)
    inside = t > BEGIN
    expected = HIGH + M * V / 80.0 * (1.0 - np.exp(-80.0 / M * (t[inside] - BEGIN)))
    assert x[inside] == pytest.approx(expected, abs=0.012)
    lost = 0.5 * M * (V**2 - (V * math.exp(-80.0 / M * (4.0 - BEGIN))) ** 2)
    assert float(run.energy.sel(form="friction")[-1]) == pytest.approx(lost, rel=1e-3)


def test_a_limit_makes_the_force_constant_first() -> None:
    """From 10 to 2.5 m/s at 500 N on 7.5 m in 1.2 s, then 1 m (1 - exp(-2.5 t)): for ever below 8.5 m."""
    t, x, _ = slide(rate=200.0, force=500.0)
    slowing = (t > BEGIN) & (t < BEGIN + 1.2)
    since = t[slowing] - BEGIN
    assert x[slowing] == pytest.approx(HIGH + V * since - 0.5 * 500.0 / M * since**2, abs=0.012)
    assert x[-1] == pytest.approx(HIGH + 7.5 + 1.0 - math.exp(-2.5 * (4.0 - BEGIN - 1.2)), abs=0.012)


def test_a_spring_gives_all_back() -> None:
    """Deepest at v0 sqrt(m/k), out again after half a period with -v0. Nothing is lost."""
    t, x, run = slide(stiffness=100.0)
    deepest = run.contact_xi.to_numpy()[:, 0].max() - HIGH / STRETCH
    assert deepest == pytest.approx(V * math.sqrt(M / 100.0), rel=2e-3)
    back = t > BEGIN + STRETCH * math.pi * math.sqrt(M / 100.0) + 0.02
    assert np.polyfit(t[back], x[back], 1)[0] == pytest.approx(-V, rel=2e-3)
    assert abs(float(run.energy.sel(form="friction")[-1])) < 1e-6 * 0.5 * M * V**2
    assert float(run.energy.sel(form="elastic").max()) - float(run.energy.sel(form="elastic")[0]) == pytest.approx(
        0.5 * M * V**2, rel=2e-3
    )


def test_a_brake_without_force_is_refused() -> None:
    with pytest.raises(ScenarioError, match=r"the brake has no force.*give force, rate"):
        Brake(within=10.0)


def test_the_calculator_of_zip_lines_beside_a_run() -> None:
    """The rope hangs as if the pulley stood there; waves and its own motion are left out."""
    line = {"start": [0, 14], "end": [150, 0], "length": 150.9, "mass": 0.55, "axial_stiffness": 6e6, "elements": 60,
            "drag": 0.5}  # fmt: skip
    travel = {"kind": "free", "from": 3.0, "rolling": 0.015, "brake": {"rate": 90.0, "force": 700.0, "within": 30.0}}
    load = {"kind": "mass", "on": "rope", "mass": 94.0, "travel": travel}
    run = simulate(
        Scenario.model_validate(
            {"lines": {"rope": line}, "loads": {"m": load},
             "run": {"kind": "dynamic", "until": 13.0, "every": 0.05, "start": {"with_loads": True}}}
        )
    )  # fmt: skip
    found = calc.zipline(
        span=150.0, height=-14.0, length=150.9, mass=0.55, axial_stiffness=6e6, load=94.0, rolling=0.015,
        brake_distance=30.0, margin=3.0,
    )  # fmt: skip
    xi, speed = run.contact_xi.to_numpy()[:, 0], run.contact_speed.to_numpy()[:, 0]
    arrives = int(np.argmax(xi > 120.9))
    assert float(run.time[arrives]) == pytest.approx(found.time, rel=0.03)
    assert speed[arrives - 1] == pytest.approx(found.arrival_speed, rel=0.02)
