"""Lines that break where they pull too much, against waves in a bar whose end is drawn away."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.model import Scenario
from ropewalk.results.statistics import summary
from ropewalk.simulate import simulate

EA, RHO, LENGTH, TENSION, SPEED = 1e4, 0.1, 10.0, 180.0, 0.2
WAVE = float(np.sqrt(EA / RHO))  # m/s, along what is not stretched
AWAY = LENGTH / (1.0 + TENSION / EA) / WAVE  # s, from end to end
STEP = RHO * WAVE * SPEED  # N, by which tension rises where the front of the wave passes, to and fro


def drawn(until: float, **more: Any) -> xr.Dataset:
    """A straight line whose end moves away at a constant speed; its middle feels steps at (n - 1/2) L/c."""
    end = {"time": [0.0, 1.0], "value": [[0.0, 0.0], [SPEED, 0.0]]}
    line = {
        "start": [0, 0], "end": [LENGTH, 0], "tension": TENSION, "mass": RHO, "axial_stiffness": EA, "elements": 100,
        "end_support": {"kind": "moving", "displacement": end}, **more,
    }  # fmt: skip
    run = {"kind": "dynamic", "until": until, "every": 1e-3, "step": 5e-5}
    return simulate(Scenario.model_validate({"gravity": 0.0, "lines": {"bar": line}, "run": run}))


def test_a_line_breaks_as_the_wave_comes_that_it_does_not_bear_and_its_ends_fly_apart() -> None:
    strength = TENSION + 3.5 * STEP  # between the third step and the fourth
    run = drawn(0.14, cut={"at": 0.5 * LENGTH / (1.0 + TENSION / EA), "strength": strength})
    assert run.attrs["outcome"] == "completed", run.attrs["doubts"]
    node = int(np.argmin(np.abs(run.position.values[0, :, 0] - 0.5 * LENGTH)))
    gap, time = run.position.values[:, node + 1, 0] - run.position.values[:, node, 0], run.time.values
    assert gap[0] == 0.0
    # Fronts are a few links wide after 35 m, each of which takes 0.3 ms.
    broken = float(run.attrs["warnings"].partition("failed at t = ")[2].partition(" s")[0])
    assert broken == pytest.approx(3.5 * AWAY, abs=1e-3)
    # Each end flies off with T/(rho c), until what comes back from the far ends L/c later.
    free = (time > broken + 0.005) & (time < broken + 0.025)
    speed = np.polyfit(time[free], gap[free], 1)[0]
    assert speed == pytest.approx(2.0 * (TENSION + 3.5 * STEP) / (RHO * WAVE), rel=0.02)
    energy = summary(run)["energy"]
    assert abs(energy["largest_imbalance"]["value"]) < 2e-3 * TENSION**2 * LENGTH / (2.0 * EA)


def test_what_comes_first_parts_a_line() -> None:
    run = drawn(0.05, cut={"at": 4.0, "strength": 1e4, "time": 0.02})
    assert "broke" not in run.attrs["warnings"]
    apart = np.diff(run.position.values[:, :, 0], axis=1).max(axis=1)
    assert apart[20] < 0.11 < apart[30]


def test_a_line_that_feels_more_than_its_strength_is_doubted() -> None:
    run = drawn(0.05, strength=TENSION + 1.5 * STEP)
    assert run.attrs["outcome"] == "doubtful"
    doubt = run.attrs["doubts"]
    assert doubt.startswith("line bar would break")
    assert "(lines.bar.strength)" in doubt
    # The front comes back from the fixed end, from which on it is two steps there.
    assert float(doubt.partition("t = ")[2].partition(" s")[0]) == pytest.approx(AWAY, abs=1.5e-3)
    most = summary(run)["tension_over_strength"]["bar"]
    assert most["value"] == pytest.approx(float(run.tension.max()) / (TENSION + 1.5 * STEP))


def test_a_line_that_bears_what_it_feels_is_trusted() -> None:
    run = drawn(0.03, strength=2.0 * TENSION)
    assert run.attrs["outcome"] == "completed"
    assert 0.5 < summary(run)["tension_over_strength"]["bar"]["value"] < 0.6


def test_a_cut_says_when() -> None:
    with pytest.raises(ValueError, match="has no time"):
        drawn(0.01, cut={"at": 5.0})
