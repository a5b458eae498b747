"""Winches that keep the tension of a line, against closed forms and a guided end that a weight pulls."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.model import Scenario
from ropewalk.simulate import simulate, spectrum_of

SET, RISE, LIMIT, BAND = 10e3, 4e3, 1.0, 500.0  # N, N s/m, m/s, N
EA, LENGTH = 1e6, 50.0
ELASTIC: dict[str, Any] = {"length": LENGTH / (1.0 + SET / EA), "axial_stiffness": EA, "axial_damping": 2e3}
INEXTENSIBLE: dict[str, Any] = {"length": LENGTH, "law": {"kind": "inextensible"}}
WINCH = {
    "kind": "guided", "along": [1, 0], "force": SET, "damping": RISE,
    "winch": {"speed_limit": LIMIT, "dead_band": BAND},
}  # fmt: skip


def pulled(
    speed: float, winch: dict[str, Any], until: float = 3.0, *, rope: dict[str, Any] | None = None, **run: Any
) -> xr.Dataset:
    """A rope without weight; its start is drawn away from its winch at a speed, or let in."""
    drawn = {"time": [0.0, 1.0, 1.0 + until], "value": [[0, 0], [-0.5 * speed, 0], [-speed * (0.5 + until), 0]]}
    line = {
        "start": [0, 0], "end": [LENGTH, 0], "mass": 0.05, "elements": 10, "end_support": winch,
        "start_support": {"kind": "moving", "displacement": drawn}, **(rope or ELASTIC),
    }  # fmt: skip
    run = {"kind": "dynamic", "until": 1.0 + until, "every": 0.1, **run}
    return simulate(Scenario.model_validate({"gravity": 0, "lines": {"rope": line}, "run": run}))


def paid_out(result: xr.Dataset) -> np.ndarray:
    """How far the end has run towards the start, m."""
    x = result.position.sel(axis="x").values[:, -1]
    return np.asarray(x[0] - x)


@pytest.mark.parametrize("speed", [0.6, -0.6])
@pytest.mark.parametrize(
    ("rope", "run"), [(ELASTIC, {}), (ELASTIC, {"geometry": "linearised"}), (INEXTENSIBLE, {})],
    ids=["elastic", "linearised", "inextensible"],
)  # fmt: skip
def test_below_its_speed_a_winch_follows_the_line_at_its_tension(
    speed: float, rope: dict[str, Any], run: dict[str, Any]
) -> None:
    """T = T0 + c v + band: dead band below, so much more for each m/s at which it pays out, or less as it takes in."""
    result = pulled(speed, WINCH, rope=rope, **run)
    wanted = SET + RISE * speed + np.sign(speed) * BAND
    assert result.tension.values[-10:] == pytest.approx(wanted, rel=1e-4)
    assert np.diff(paid_out(result)[-10:]) / 0.1 == pytest.approx(speed, rel=1e-4)
    energy = result.energy.isel(time=-1)
    turned = float(abs(energy.sel(form="support_work")))
    missed = 1e-4 if rope is ELASTIC else 5e-3  # where the start begins to move, tensions are found a step too late
    assert float(abs(energy.sel(form="imbalance"))) < missed * turned


def test_faster_than_its_speed_limit_the_line_is_stretched() -> None:
    """What is not paid out stretches the rope: T' = EA (v - limit) / L."""
    result = pulled(1.5, WINCH, until=2.0)
    assert np.diff(paid_out(result)[-10:]) / 0.1 == pytest.approx(LIMIT, rel=1e-3)
    rate = np.gradient(result.tension.values.mean(axis=1), 0.1)[-10:-1]
    assert rate == pytest.approx(EA * 0.5 / (LENGTH / (1.0 + SET / EA)), rel=1e-3)


def test_within_its_dead_band_a_winch_stands_still() -> None:
    """A stretch that changes the tension by 400 N moves nothing; the rope is a spring."""
    result = pulled(400.0 * LENGTH / EA / 3.5, WINCH)
    assert np.abs(paid_out(result)).max() == 0.0
    assert result.tension.values[-1] == pytest.approx(SET + 400.0, abs=6.0)


def test_a_winch_without_limits_is_a_guided_end_with_a_damper() -> None:
    """Another route: the same rail, force and damper, kicked otherwise; under a force that runs along the rope."""

    def swung(more: dict[str, Any]) -> xr.Dataset:
        end = {"kind": "guided", "along": [1, 0], "force": SET, "damping": 2e4, **more}
        rope = {"start": [0, 0], "end": [LENGTH, 0], "length": LENGTH, "mass": 1.0, "axial_stiffness": EA,
                "elements": 80, "end_support": end}  # fmt: skip
        load = {"kind": "force", "on": "rope", "force": [0, -800.0], "travel": {"speed": 10.0, "from": 5.0}}
        run = {"kind": "dynamic", "until": 2.0, "every": 0.1}
        return simulate(Scenario.model_validate({"lines": {"rope": rope}, "loads": {"push": load}, "run": run}))

    one, other = swung({"winch": {"speed_limit": 100.0}}), swung({})
    assert np.ptp(paid_out(other)) > 0.045
    assert paid_out(one) == pytest.approx(paid_out(other), abs=2e-4)  # contacts differ: 0.43 mm with a quarter of links
    works = (run.energy.isel(time=-1).sel(form=form) for run, form in ((one, "support_work"), (other, "line_damping")))
    given, taken = (float(work) for work in works)
    assert -given == pytest.approx(taken, rel=5e-3)
    assert float(abs(one.energy.sel(form="imbalance")).max()) < 1e-3 * taken


def test_at_rest_a_winch_is_the_force_that_it_is_set_to() -> None:
    """An elastic catenary between ends of one height: x = 2 H/w asinh(w L/(2 H)) + H L/EA."""
    rope = {"start": [0, 0], "end": [LENGTH, 0], "length": LENGTH, "mass": 20.0, "axial_stiffness": EA, "elements": 400,
            "end_support": WINCH}  # fmt: skip
    result = simulate(Scenario.model_validate({"lines": {"rope": rope}, "run": {"kind": "equilibrium"}}))
    w = 20.0 * 9.81
    wanted = 2.0 * SET / w * np.arcsinh(0.5 * w * LENGTH / SET) + SET * LENGTH / EA
    assert float(result.position.sel(axis="x")[0, -1]) == pytest.approx(wanted, rel=1e-5)


@pytest.mark.parametrize(("band", "quarters"), [(BAND, 2.0), (None, 1.0)], ids=["dead band", "none"])
def test_small_motion_stays_within_a_dead_band(band: float | None, quarters: float) -> None:
    """Waves along a rope between ends that stand have half its length, with a free one a quarter: f = n c/(4 L)."""
    winch = WINCH | {"damping": 0.0, "winch": {"speed_limit": LIMIT, "dead_band": band}}
    rope = {"start": [0, 0], "end": [LENGTH, 0], "mass": 0.5, "elements": 40, "end_support": winch, **ELASTIC}
    tree = {"gravity": 0, "lines": {"rope": rope | {"axial_damping": 0.0}}, "run": {"kind": "equilibrium"}}
    modes = spectrum_of(Scenario.model_validate(tree), how_many=60).modes
    assert modes is not None
    along = np.abs(modes.shape[:, :, 0]).max(axis=1) > 0.99
    wanted = quarters * 2.0 * np.pi * np.sqrt(EA / 0.5) / (4.0 * ELASTIC["length"])
    assert modes.frequency[along].min() == pytest.approx(wanted, rel=2e-3)  # 40 links


WRONG: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    ({"force": 0.0}, {}, "tension that the winch maintains"),
    ({"stiffness": 1e3}, {}, "a winch has no spring"),
    ({"winch": {"speed_limit": 0.0}}, {}, "speed_limit"),
    ({}, {"kind": "quasistatic", "positions": 3}, "within its dead band the position of a winch"),
    ({}, {"kind": "linear", "until": 1.0}, "no linear spring"),
    ({}, {"method": "rkn6"}, "not implemented for lines that a winch pulls at"),
]


@pytest.mark.parametrize(("change", "run", "message"), WRONG)
def test_what_no_winch_can_be_is_refused(change: dict[str, Any], run: dict[str, Any], message: str) -> None:
    rope = {"start": [0, 0], "end": [LENGTH, 0], "length": LENGTH, "mass": 1.0, "axial_stiffness": EA}
    motion = {"kind": "dynamic", "until": 1.0} if "kind" not in run else {}
    tree = {"lines": {"rope": {**rope, "end_support": WINCH | change}}, "run": motion | run}
    with pytest.raises(ValueError, match=message):
        Scenario.model_validate(tree)
