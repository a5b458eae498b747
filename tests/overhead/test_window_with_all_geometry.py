"""A window on the nonlinear motion of overhead lines: only what is near the pantographs moves.

Source: the same motion of the whole line, EN 50318:2002 at 300 km/h, with links of 0.5 m.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import xarray as xr

from overhead_cases import DAMPED, long_line, off, runs_that_go_on
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

HELD = {"messenger_supports": {"along": "held"}}


@cache
def ran(spans: int, window: float | None = None, *, damped: bool = False, held: bool = False) -> xr.Dataset:
    found = simulate(long_line(spans, window, DAMPED if damped else None, **(HELD if held else {})))
    assert found.attrs["outcome"] == "completed"
    return found


def test_ten_spans_are_as_without_a_window() -> None:
    # A wave that leaves the pantograph comes back after 5.5 s: what is left is of the ends, which waves along reach.
    found = off(ran(10, 180.0), ran(10), 240.0, 360.0)
    assert found["mean"] < 0.05
    assert found["sigma"] < 0.4
    assert max(found["largest"], found["smallest"], found["rms"]) < 1.8
    assert found["uplift"] < 0.5


def test_twenty_damped_spans_are_as_without_a_window_for_longer_than_waves_take_to_come_back() -> None:
    found = off(ran(20, 180.0, damped=True), ran(20, damped=True), 240.0, 1080.0)
    assert found["mean"] < 0.05
    assert found["sigma"] < 0.5  # what in the whole line comes back from further away than the window
    assert found["uplift"] < 1.5  # of 52 mm; it is the largest in 14 s


def test_the_error_falls_with_the_width_of_the_window() -> None:
    whole = ran(20, damped=True)
    errors = [off(ran(20, width, damped=True), whole, 240.0, 960.0)["rms"] for width in (60.0, 120.0, 240.0)]
    assert errors[0] > 1.5 * errors[1] > 1.5 * 1.5 * errors[2]


def test_a_messenger_that_is_held_at_its_supports_is_so_beyond_the_window() -> None:
    found = off(ran(10, 180.0, held=True), ran(10, held=True), 240.0, 360.0)
    assert found["sigma"] < 0.2
    assert found["rms"] < 1.0


def test_a_staggered_line_moves_sideways_in_its_window() -> None:
    asked = {"steady_arms": {"stagger": "200 mm", "mass": 1 / 3}}
    whole, cut = (simulate(long_line(8, window, DAMPED, **asked)) for window in (None, 150.0))
    found = off(cut, whole, 120.0, 360.0)
    assert found["sigma"] < 0.2
    assert found["rms"] < 1.5
    missed = [float(np.abs(result.energy.sel(form="imbalance")).max()) for result in (whole, cut)]
    assert missed[1] < 2.0 * missed[0]  # J; both 0.1 of more than 50


def test_what_leaves_the_window_is_in_the_account_of_energy() -> None:
    whole, cut = ran(10), ran(10, 120.0)
    missed = [float(np.abs(result.energy.sel(form="imbalance")).max()) for result in (whole, cut)]
    lost = float(cut.energy.sel(form="line_damping")[-1])  # J; the line itself has no damping
    print(missed, lost)
    assert float(whole.energy.sel(form="line_damping")[-1]) == 0.0
    assert 20.0 < lost < 100.0  # of 116 J that the pantograph gives
    assert missed[1] < 1.5 * missed[0]  # J, of more than 100 J that are turned over


def test_far_from_the_pantograph_everything_rests() -> None:
    result = ran(20, 120.0)
    early = result.isel(time=20)  # 1 s: the pantograph is at 93 m
    x = result.position.values[0, :, 0]
    far = x > 500.0
    np.testing.assert_array_equal(early.position.values[far, -1], result.position.values[0, far, -1])
    np.testing.assert_array_equal(early.velocity.values[far], 0.0)
    ties = early.tie_force.values - result.tie_force.values[0]
    reach = np.abs(ties) > 0.0
    print(reach.sum(), "droppers are felt")
    assert 30 < reach.sum() < 60  # of 180: nine in each of four spans and more
    supports = early.reaction.values - result.reaction.values[0]
    assert (np.abs(supports[:, -1]) < 1e-6).mean() > 0.5


def test_a_run_goes_on_in_its_window() -> None:
    first, second = runs_that_go_on(long_line(6, 90.0, run={"until": 2.0}))
    np.testing.assert_array_equal(first.motion.position, second.motion.position)


def test_it_says_when_waves_come_back() -> None:
    reason = ran(10, 180.0).attrs["reason"]
    print(reason)
    c, v = np.sqrt(16e3 / 1.07), 300.0 / 3.6  # m/s, the messenger, and the pantograph
    back = 360.0 * c / (c**2 - v**2)
    assert f"180 m around contacts move, waves return from its boundaries after {back:.3g} s" in reason


def test_lines_whose_tensions_are_joined_far_away_are_refused() -> None:
    said = "overhead lines with ends: anchored"
    with pytest.raises(ValueError, match=f"a window with geometry: nonlinear is not implemented for {said}"):
        long_line(4, 60.0, ends="anchored")


STITCHED: dict[str, Any] = {"stitch_wire": {"length": "18 m", "tension": "2.8 kN"}, "system_height": "1.8 m"}


@pytest.mark.parametrize("more", [{}, {"radius": "1500 m", "steady_arms": {"mass": 1 / 3, "stagger": [0.2] * 11}}])
def test_lines_with_stitch_wires_are_as_without_a_window(more: dict[str, Any]) -> None:
    """As the same line without them: 1.2 N of force, 0.3 mm of uplift, 1.2 J."""
    whole, cut = (simulate(long_line(10, window, DAMPED, **STITCHED, **more)) for window in (None, 180.0))
    for result in (whole, cut):
        assert result.attrs["outcome"] == "completed"
        assert not result.attrs.get("doubts")
    found = off(cut, whole, 240.0, 360.0)
    assert found["mean"] < 0.2
    assert found["sigma"] < 0.5
    assert found["rms"] < 2.0
    assert found["uplift"] < 1.0
    missed = [float(np.abs(result.energy.sel(form="imbalance")).max()) for result in (whole, cut)]
    assert missed[1] < 3.0 * missed[0]  # J; 0.3 and 0.5, on the curve 0.02 and 0.01
    assert cut.attrs["window_force_error"] < 3.0 * found["rms"]


def test_stitch_wires_beyond_the_window_are_led_along_with_their_messenger() -> None:
    """At rest they pull with 2.8 kN; in the whole line waves along the wires change that by some 300 N."""
    cut = simulate(long_line(10, 90.0, **STITCHED))
    place = cut.position.sel(axis="x").values
    for line in (f"line.stitch.{i}" for i in range(1, 10)):
        nodes, links = cut.line.values == line, cut.link_line.values == line
        at = float(place[0, nodes].mean())
        messenger = int(np.abs(place[0] - at + 1e9 * (cut.line.values != "line.messenger")).argmin())
        contact = cut.contact_position.sel(axis="x").values[:, 0]
        beyond = np.abs(contact - at) > 90.0 + 9.0 + 30.0
        assert beyond.sum() > 20
        assert np.abs(cut.tension.values[beyond][:, links] / 2.8e3 - 1.0).max() < 0.35
        ahead = beyond & (contact < at)
        moved = place[:, nodes].mean(axis=1) - at, place[:, messenger] - place[0, messenger]
        assert np.abs(moved[0] - moved[1])[ahead].max(initial=0.0) < 1e-5  # m, of some mm


def test_other_lines_are_refused() -> None:
    line = {"start": [0, 0], "end": [20, 0], "mass": 1, "axial_stiffness": 1e6, "tension": 1e3}
    load = {"kind": "force", "on": "line", "force": [0, -1], "travel": {"speed": 1, "from": 1}}
    run = {"kind": "dynamic", "until": 1, "window": 5}
    for more in ({}, {"bending_stiffness": 10.0}):
        with pytest.raises(ValueError, match="nonlinear is not implemented for all but overhead lines"):
            Scenario.model_validate({"lines": {"line": line | more}, "loads": {"push": load}, "run": run})
