"""A window on the linearised motion of overhead lines, with layers that take up waves across.

Source: the same motion of the whole line, EN 50318:2002 at 300 km/h, with links of 0.5 m.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import xarray as xr

from overhead_cases import DAMPED, long_line, off, runs_that_go_on
from ropewalk.simulate import simulate
from ropewalk.wires import absorbing_layer


@cache
def ran(window: float | None = None, *, damped: bool, layers: bool = True) -> xr.Dataset:
    run = {"geometry": "linearised", "every": 0.1}
    with pytest.MonkeyPatch.context() as patch:
        if not layers:
            patch.setattr(absorbing_layer, "_STRENGTH", 0.0)
        found = simulate(long_line(20, window, DAMPED if damped else None, run=run))
    assert found.attrs["outcome"] == "completed"
    return found


@pytest.mark.parametrize(("damped", "width", "rms"), [(False, 180.0, 0.6), (True, 180.0, 0.8), (False, 120.0, 0.65)])
def test_layers_make_the_error_smaller(damped: bool, width: float, rms: float) -> None:
    """What is left comes back from supports and droppers beyond the window: the whole line feels that."""
    bare, layered = (
        off(ran(width, damped=damped, layers=layers), ran(damped=damped), 240.0, 960.0) for layers in (False, True)
    )
    assert layered["rms"] < rms * bare["rms"]
    assert layered["uplift"] < 0.6 * bare["uplift"]
    assert layered["mean"] < 0.03  # N


@pytest.mark.parametrize("damped", [False, True])
def test_the_error_falls_with_the_width(damped: bool) -> None:
    errors = [off(ran(width, damped=damped), ran(damped=damped), 240.0, 960.0)["rms"] for width in (60.0, 120.0, 240.0)]
    assert errors[0] > 2.0 * errors[1] > 4.0 * 1.6 * errors[2]


@pytest.mark.parametrize("damped", [False, True])
def test_what_leaves_the_window_is_in_the_account_of_energy(damped: bool) -> None:
    """Waves that layers take, and the kinetic energy of what the window leaves, are lost; all else is there."""
    whole, cut = ran(damped=damped), ran(180.0, damped=damped)
    missed = [float(np.abs(result.energy.sel(form="imbalance")).max()) for result in (whole, cut)]
    lost = [float(result.energy.sel(form="line_damping")[-1]) for result in (whole, cut)]  # J
    print("missed, J:", missed, "lost, J:", lost, "driven, J:", float(whole.energy.sel(form="hold_work")[-1]))
    assert missed[1] < 1.1 * missed[0]  # 3 J of 250; with ties near borders left out it was 40 and 28 J
    assert lost[1] > lost[0] + 10.0


def test_far_from_the_pantograph_everything_rests() -> None:
    result = ran(120.0, damped=False)
    early = result.isel(time=10)  # 1 s: the pantograph is at 93 m
    far = result.position.values[0, :, 0] > 300.0
    np.testing.assert_array_equal(early.position.values[far, -1], result.position.values[0, far, -1])
    np.testing.assert_array_equal(early.velocity.values[far], 0.0)
    behind = result.isel(time=100)  # 10 s: it is at 843 m
    x = result.position.values[0, :, 0]
    np.testing.assert_array_equal(behind.velocity.values[x < 700.0], 0.0)


def test_a_run_goes_on_in_its_window() -> None:
    first, second = runs_that_go_on(long_line(6, 90.0, run={"until": 2.0, "geometry": "linearised"}))
    np.testing.assert_array_equal(first.motion.position, second.motion.position)
    np.testing.assert_array_equal(first.motion.stepping.work, second.motion.stepping.work)


def test_stitch_wires_that_the_window_has_left_stand_still() -> None:
    """All of them, their last nodes, too."""
    stitched = {"stitch_wire": {"length": "18 m", "tension": "2.8 kN"}, "system_height": "1.8 m"}
    result = simulate(long_line(8, 60.0, run={"geometry": "linearised", "every": 0.1}, **stitched))
    late = result.isel(time=-1)  # the pantograph is at 470 m
    stitch = late.line.str.startswith("line.stitch").values & (result.position.values[0, :, 0] < 380.0)
    assert stitch.sum() > 6 * 33
    np.testing.assert_array_equal(late.velocity.values[stitch], 0.0)
