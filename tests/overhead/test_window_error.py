"""What a run tells of the error of its window, and the width that it finds for an accuracy.

Source: the same motion of the whole line, EN 50318:2002 with links of 0.5 m.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr

from overhead_cases import DAMPED, EN_2002, long_line
from ropewalk.checkpoint import from_bytes, to_bytes
from ropewalk.model import Scenario
from ropewalk.results.contact_statistics import filtered, samples
from ropewalk.results.frame import RunInfo
from ropewalk.simulate import simulate
from ropewalk.wires.frames import Wires
from ropewalk.wires.window_error import WindowError, WindowMeasure
from ropewalk.wiring import task_of

BELOW, ABOVE = 0.5, 3.0  # what is told over what is so: it may be that much too small, and too large


@cache
def ran(spans: int, window: float | str | None, geometry: str, speed: float, *, damped: bool, **run: Any) -> xr.Dataset:
    asked = {"geometry": geometry, "until": (60.0 * spans - 20.0) / (speed / 3.6), "every": 0.1} | run
    found = simulate(long_line(spans, window, DAMPED if damped else None, run=asked, speed=speed))
    assert found.attrs["outcome"] == "completed"
    return found


def differs(one: xr.Dataset, other: xr.Dataset, first: float = 0.0) -> tuple[float, float]:
    """Root mean squares of what heights under the contact in m and forces up to 20 Hz in N differ by, from then on."""
    a, b = (samples(result).isel(contact=0) for result in (one, other))
    late = a.time.values >= first if "time" in a.coords else np.arange(a.force.size) * 1e-3 >= first
    height = (a.height.values - b.height.values)[late]
    force = filtered(a.force.values - b.force.values, 1e-3)[late]
    return float(np.sqrt(np.nanmean(height**2))), float(np.sqrt(np.nanmean(force**2)))


def told(result: xr.Dataset) -> tuple[float, float]:
    return float(result.attrs["window_height_error"]), float(result.attrs["window_force_error"])


@pytest.mark.parametrize(
    ("spans", "window", "geometry", "speed", "damped"),
    [
        (30, 120.0, "linearised", 300.0, False), (30, 240.0, "linearised", 300.0, False),
        (30, 60.0, "linearised", 300.0, True), (30, 180.0, "linearised", 300.0, True),
        (30, 120.0, "linearised", 200.0, False), (30, 120.0, "linearised", 200.0, True),
        (14, 60.0, "nonlinear", 300.0, True), (14, 120.0, "nonlinear", 300.0, True),
    ],
)  # fmt: skip
def test_the_error_that_is_told_is_that_beside_the_whole_line(
    spans: int, window: float, geometry: str, speed: float, damped: bool
) -> None:
    cut, whole = (ran(spans, width, geometry, speed, damped=damped) for width in (window, None))
    ratios = np.array(told(cut)) / differs(cut, whole)
    print(f"told {told(cut)}, is {differs(cut, whole)}, ratios {ratios}")
    assert np.all((ratios > BELOW) & (ratios < ABOVE))
    assert "window_height_error" not in whole.attrs


def test_of_a_run_that_is_over_before_waves_come_back_three_times_it_is_no_estimate() -> None:
    cut, whole = (ran(20, width, "linearised", 300.0, damped=False, until=9.0) for width in (120.0, None))
    assert told(cut) == pytest.approx(differs(cut, whole, 3.0), rel=0.02)  # of the last two thirds; filtered to 9.1 s


@pytest.mark.parametrize(("accuracy", "damped"), [("1 mm", False), ("1 mm", True), ("0.4 mm", True)])
def test_a_window_becomes_as_wide_as_the_accuracy_takes(accuracy: str, damped: bool) -> None:
    cut = ran(30, "auto", "linearised", 300.0, damped=damped, accuracy=accuracy)
    whole, wanted = ran(30, None, "linearised", 300.0, damped=damped), 1e-3 * float(accuracy.split()[0])
    width, error = cut.attrs["window"], differs(cut, whole)[0]
    print(f"{width:g} m: told {told(cut)[0]:.2e} m, is {error:.2e} m")
    assert told(cut)[0] <= wanted
    assert error < wanted / BELOW
    assert 60.0 < width < 600.0
    assert f"{width:g} m around contacts move" in cut.attrs["reason"]


def test_one_millimetre_is_what_is_wanted_if_nothing_is_said() -> None:
    one, other = (task_of(long_line(4, "auto", run=run)).accuracy for run in ({}, {"accuracy": "1 mm"}))
    assert one == other == 1e-3


def test_a_line_that_is_too_short_for_the_accuracy_moves_as_a_whole() -> None:
    asked = {"geometry": "linearised", "accuracy": "1 um"}
    widths = (("auto", asked), (None, {"geometry": "linearised"}))
    found, whole = (simulate(long_line(4, width, run=run, speed=100.0)) for width, run in widths)
    assert found.attrs["window"] == np.inf
    assert told(found) == (0.0, 0.0)
    assert "; all moves" in found.attrs["reason"]
    np.testing.assert_array_equal(found.position.values, whole.position.values)


@pytest.mark.parametrize("geometry", ["linearised", "nonlinear"])
def test_the_motion_is_as_if_nothing_had_been_tried_before(geometry: str, monkeypatch: pytest.MonkeyPatch) -> None:
    asked, times = long_line(6, 60.0, run={"until": 1.5, "geometry": geometry}), np.arange(0.0, 1.5, 0.05)
    first = Wires(task_of(asked), times, RunInfo())
    monkeypatch.setattr(WindowMeasure, "of", lambda *_: WindowError(0.0, 0.0))
    second = Wires(task_of(asked), times, RunInfo())
    for i in range(20):
        first.advance(i)
        second.advance(i)
    np.testing.assert_array_equal(first.motion.position, second.motion.position)
    np.testing.assert_array_equal(first.motion.stepping.work, second.motion.stepping.work)


def test_a_longer_run_goes_on_in_the_window_that_was_found_for_the_shorter_one() -> None:
    asked = long_line(8, "auto", run={"until": 2.0, "geometry": "linearised", "accuracy": "2 mm"})
    longer = asked.model_copy(update={"run": asked.run.model_copy(update={"until": 4.0, "accuracy": 5e-4})})
    first = Wires(task_of(asked), np.arange(0.0, 2.0, 0.05), RunInfo())
    second = Wires(task_of(longer), np.arange(0.0, 4.0, 0.05), RunInfo())
    assert first.motion.window < second.motion.window
    for i in range(24):
        first.advance(i)
    second.set_state(from_bytes(to_bytes(first.get_state())))
    assert second.motion.window == first.motion.window
    for i in range(24, 36):
        first.advance(i)
        second.advance(i)
    np.testing.assert_array_equal(first.motion.position, second.motion.position)


LINE = {"start": [0, 0], "end": [20, 0], "mass": 1, "tension": 1e3, "axial_stiffness": 1e6, "bending_stiffness": 10.0}
PUSH = {"kind": "force", "on": "line", "force": [0, -1], "travel": {"speed": 1, "from": 1}}


@pytest.mark.parametrize(
    ("changed", "run", "said"),
    [
        ({}, {"window": "auto", "mesh_error": True}, "needs the same window on all meshes"),
        ({}, {"window": "180 m", "accuracy": "1 mm"}, "is not implemented for beams, lines on foundations and"),
        ({}, {"window": "automatic"}, "run.window"),
        ({}, {"window": "0 m"}, "write a value above 0 m, or auto"),
        (
            {"overhead_lines": {}, "lines": {"line": LINE}, "loads": {"push": PUSH}},
            {"window": "auto", "until": 1.0},
            "window: auto is not implemented for all but overhead lines; write a width",
        ),
        (
            {"loads": {}}, {"window": "auto", "until": 1.0},
            "window: auto is not implemented for overhead lines without loads",
        ),
    ],
)  # fmt: skip
def test_what_it_cannot_be_found_for_is_refused(changed: dict[str, Any], run: dict[str, Any], said: str) -> None:
    travel = {"speed": "300 km/h", "from": "10 m"}
    load = {"kind": "pantograph", "on": "line", "model": "en50318-2002", "travel": travel}
    tree = {"overhead_lines": {"line": EN_2002}, "loads": {"head": load}} | changed
    tree["run"] = {"kind": "dynamic", "until": 6.0, "geometry": "linearised"} | run
    with pytest.raises(ValueError, match=said):
        Scenario.model_validate(tree)
