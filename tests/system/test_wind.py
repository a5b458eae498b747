"""Wind on lines: rho/2 d |v_n| v_n per length, against closed forms and in the audit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from motion_cases import order
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

LINE: dict[str, Any] = {
    "start": [0, 0, 0], "end": [20, 0, 0], "tension": 2e3, "mass": 0.5, "axial_stiffness": 1e6, "wind_drag": 0.03,
    "elements": 40,
}  # fmt: skip


def blown(line: dict[str, Any], wind: dict[str, Any], until: float, **more: Any) -> xr.Dataset:
    run = {"kind": "dynamic", "until": until, **more.pop("run", {})}
    return simulate(Scenario.model_validate({"lines": {"line": {**LINE, **line}}, "wind": wind, "run": run, **more}))


def form(result: xr.Dataset, name: str) -> np.ndarray:
    return np.asarray(result.energy.sel(form=name).values)


def test_a_taut_line_in_side_wind_comes_to_rest_as_a_parabola() -> None:
    """w L^2 / (8 T) in the middle, once what drag leaves of its swing is gone."""
    wind = {"direction": [0, 2, 0], "speed": 20.0}
    result = blown({"drag": 4.0}, wind, 6.0, gravity=0.0, run={"every": 0.5})
    w = 0.5 * 1.225 * 0.03 * 20.0**2
    y = result.position.sel(axis="y").values[-1]
    x = np.linspace(0.0, 20.0, 41)
    tension = result.tension.values[-1].mean()
    # Corners of the polygon lie on the parabola; exp(-2 * 6) of the swing of 0.18 m is left.
    assert y == pytest.approx(w * x * (20.0 - x) / (2.0 * tension), abs=1e-4)
    assert y[20] == pytest.approx(w * 400.0 / (8.0 * tension), rel=1e-3)
    assert np.abs(result.position.sel(axis="z").values).max() < 1e-9
    assert result.reaction.values[-1].sum(axis=0)[1] == pytest.approx(-w * 20.0, rel=2e-3)


def test_equilibrium_is_that_in_the_wind() -> None:
    """w L^2 / (8 T) to the side; wind was left out, and its force shown by the supports all the same."""
    wind = {"direction": [0, 2, 0], "speed": {"time": [0, 1], "value": [20.0, 0.0]}}
    scenario = {"lines": {"line": {**LINE, "drag": 4.0}}, "wind": wind, "gravity": 0.0}
    result = simulate(Scenario.model_validate({**scenario, "run": {"kind": "equilibrium"}}))
    w = 0.5 * 1.225 * 0.03 * 20.0**2
    y, tension = result.position.sel(axis="y").values[0], result.tension.values[0].mean()
    x = np.linspace(0.0, 20.0, 41)
    # Wind across the line only: less by about the square of its slope, 4e-4 in the mean.
    assert y == pytest.approx(w * x * (20.0 - x) / (2.0 * tension), abs=1e-4)
    assert result.reaction.values[0].sum(axis=0) == pytest.approx([0.0, -w * 20.0, 0.0], abs=1e-3 * w * 20.0)


def test_slow_motion_is_that_in_the_wind_of_its_time() -> None:
    """The load is at 5 m at 1 s and at 15 m at 3 s: no wind yet, and 20 m/s."""
    wind = {"direction": [0, 1, 0], "speed": {"time": [2.0, 2.0], "value": [0.0, 20.0]}}
    load = {"kind": "force", "on": "line", "force": [0, 0, -100], "travel": {"speed": 5.0}}
    run = {"kind": "quasistatic", "positions": 5}
    given = {"lines": {"line": LINE}, "wind": wind, "loads": {"p": load}, "run": run}
    result = simulate(Scenario.model_validate(given))
    sideways = result.reaction.sel(axis="y").values.sum(axis=1)
    w = 0.5 * 1.225 * 0.03 * 20.0**2
    assert sideways[1] == pytest.approx(0.0, abs=1e-6)
    assert sideways[3] == pytest.approx(-w * 20.0, rel=2e-2)  # the line is a little longer than 20 m, and slopes


def test_wind_along_a_line_does_nothing() -> None:
    result = blown({}, {"direction": [1, 0, 0], "speed": 30.0}, 0.3, gravity=0.0)
    assert np.abs(result.position.values - result.position.values[0]).max() == pytest.approx(0.0, abs=1e-12)


def test_a_wind_of_nothing_changes_nothing() -> None:
    """A mass at 0.8 of the wave speed: 1351 N and 3 J missed without, 7318 N and 635 J in a wind of 0 m/s."""
    line = {"start": [0, 0], "end": [10, 0], "tension": 1e3, "mass": 0.1, "axial_stiffness": 1e5, "elements": 40}
    load = {"kind": "mass", "on": "line", "mass": 1.0, "travel": {"speed": 80.0, "at_end": "leave"}}
    run = {"kind": "dynamic", "until": 0.12, "every": 0.01}
    calm = {"direction": [1, 0], "speed": {"time": [0, 1], "value": [0, 0]}}
    one, two = (
        simulate(Scenario.model_validate({"lines": {"line": line}, "loads": {"m": load}, "run": run, **wind}))
        for wind in ({}, {"wind": calm})
    )
    for name in ("position", "tension", "energy", "contact_force"):
        assert np.array_equal(one[name].values, two[name].values, equal_nan=True), name


def test_still_air_damps_a_line_that_feels_it() -> None:
    """v' = -k v^2 across, k = rho d / (2 m): v = v0 / (1 + k v0 t) of what a gust of 0.1 s has left."""
    ends = {"kind": "guided", "along": [0, 0, 1], "stiffness": 1e-6}
    line = {"start_support": ends, "end_support": ends, "mass": 0.2, "wind_drag": 0.5, "elements": 10}
    gust = {"time": [0.0, 0.1, 0.1], "value": [30.0, 30.0, 0.0]}
    result = blown(line, {"direction": [0, 0, 1], "speed": gust}, 1.0, gravity=0.0, run={"every": 0.1})
    v, t, k = result.velocity.sel(axis="z").values[:, 5], result.time.values, 0.5 * 1.225 * 0.5 / 0.2
    after = t > 0.15
    first = v[after][0]
    assert v[after] == pytest.approx(first / (1.0 + k * first * (t[after] - t[after][0])), rel=2e-3)


def test_wind_takes_a_line_along_as_fast_as_its_drag_says() -> None:
    """Both ends on guides across the wind: v' = k (V - v)^2, so v = V - V / (1 + k V t), k = rho d / (2 m)."""
    ends = {"kind": "guided", "along": [0, 0, 1], "stiffness": 1e-6}
    line = {"start_support": ends, "end_support": ends, "mass": 0.2, "wind_drag": 0.5, "elements": 10}
    m, speed = 0.2, 2.5
    table = {"time": [0.0, 50.0], "value": [speed, speed]}
    result = blown(line, {"direction": [0, 0, 1], "speed": table}, 2.0, gravity=0.0, run={"every": 0.1})
    t = result.time.values
    v = result.velocity.sel(axis="z").values[:, 5]
    k = 0.5 * 1.225 * 0.5 / m
    assert v == pytest.approx(speed * (1.0 - 1.0 / (1.0 + k * speed * t)), abs=2e-3 * speed)


def audit(step: float) -> float:
    """Part of the work of a gust that the audit misses."""
    gust = {"time": [0.0, 0.2, 0.4, 0.41], "value": [0.0, 40.0, 40.0, 0.0]}
    line = {"axial_stiffness": 2e4, "tension": 500.0}
    result = blown(line, {"direction": [0.1, 1, 0.3], "speed": gust}, 1.0, run={"every": 0.02, "step": step})
    work = form(result, "load_work")
    assert np.ptp(form(result, "kinetic")) > 5.0  # J
    return float(np.abs(form(result, "imbalance")).max() / np.abs(work).max())


def test_the_work_of_a_gust_is_in_the_audit() -> None:
    steps = [8e-4, 4e-4, 2e-4]
    missed = [audit(step) for step in steps]
    print(missed)
    assert missed[-1] < 1e-3
    assert order(steps, missed) > 0.9


def test_a_gust_table_blows_when_it_says() -> None:
    wind = {"direction": [0, 1, 0], "speed": {"time": [0.1, 0.1, 0.2, 0.2], "value": [0.0, 30.0, 30.0, 0.0]}}
    result = blown({}, wind, 0.2, gravity=0.0, run={"every": 0.01})
    y, t = result.position.sel(axis="y").values[:, 20], result.time.values
    assert np.abs(y[t < 0.0999]).max() < 1e-12
    # In the middle no wave has come from the supports yet, 63 m/s: v' = k (V - v)^2.
    k = 0.5 * 1.225 * 0.03 / 0.5
    assert y[-1] == pytest.approx(
        30.0 * 0.1 - np.log(1.0 + k * 30.0 * 0.1) / k, rel=6e-3
    )  # the gust begins within a step of 0.4 ms


def test_a_hanging_line_leans_in_the_wind_by_drag_over_weight() -> None:
    """A slack cable that swings out as a whole: tan = rho/2 d (V cos)^2 / (m g), as only wind across it counts.

    It lies in a plane through its supports, along x, and turns about them; the part along the line is small.
    """
    line = {"tension": None, "length": 20.02, "drag": 3.0}
    result = blown(line, {"direction": [0, 1, 0], "speed": 15.0}, 8.0, run={"every": 1.0})
    y, z = result.position.values[-1, 20, 1:]
    lean = 0.5 * 1.225 * 0.03 * 15.0**2 / (0.5 * 9.81)
    assert y / -z == pytest.approx(lean, rel=2e-3)  # exp(-1.5 * 8) of the swing is left
