"""Lines that are cut on the way."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.simulate import simulate

G = 9.81
LAW = {"kind": "tension_only"}


def hanging(spare: float) -> dict[str, Any]:
    """60 kg on a rope of 10 m, which is cut after 50 ms, and on a longer one beside it, both light."""
    main = {
        "start": [0, 0], "end": [0, -10.0], "length": 10.0, "mass": 2e-3, "axial_stiffness": 1e5, "law": LAW,
        "elements": 4, "end_support": {"kind": "joined", "to": "person"}, "cut": {"at": 5.0, "time": 0.05},
    }  # fmt: skip
    backup = {**main, "start": [0.05, 0], "length": 10.0 + spare, "mass": 5e-3, "axial_stiffness": 6e4, "elements": 6}
    del backup["cut"]
    return {
        "joints": {"person": {"mass": 60.0}}, "lines": {"main": main, "backup": backup},
        "run": {"kind": "dynamic", "until": 1.0, "every": 0.005},
    }  # fmt: skip


def test_a_backup_catches_as_a_mass_falls_on_a_slack_spring() -> None:
    """F = m g (1 + sqrt(1 + 2 k h/(m g))) above k = EA/L, h from where it hung; lines of 0.1 % of the mass."""
    spare = 1.0
    tree = hanging(spare)
    # Undamped light links that go slack and taut meet the kink of the law at any phase of a step: near the largest
    # stable step the last bits decide how much energy that makes, and whether the run is to be trusted.
    tree["run"]["step"] = 1e-4
    run = simulate(Scenario.model_validate(tree))
    assert run.attrs["outcome"] == "completed"
    joint = run.position.where(run.line == "backup", drop=True).isel(node=-1).sel(axis="z").to_numpy()
    stretched = 60.0 * G / 1e5 * 10.0
    h, k = spare - stretched, 6e4 / (10.0 + spare)
    peak = 60.0 * G * (1.0 + math.sqrt(1.0 + 2.0 * k * h / (60.0 * G)))
    assert float(run.tension.max()) == pytest.approx(peak, rel=0.02)
    assert -joint.min() == pytest.approx(10.0 + spare + peak / k, rel=2e-3)
    t = run.time.to_numpy()
    falling = (t > 0.1) & (t < 0.4)  # 0.05 s + sqrt(2 h/g) = 0.49 s
    expected = joint[0] - 0.5 * G * (t[falling] - 0.05) ** 2
    assert joint[falling] == pytest.approx(expected, abs=0.004)  # the recoil of 10 g of rope pushes on 60 kg
    # 0.9e-4 to 1.2e-4 for spares of 0.999 to 1.001 m, of first order in the step and above
    assert float(abs(run.energy.sel(form="imbalance")).max()) < 2e-4 * 60.0 * G * -joint.min()


def test_what_is_cut_is_in_one_piece_before_and_in_two_after() -> None:
    run = simulate(Scenario.model_validate(hanging(0.5) | {"run": {"kind": "dynamic", "until": 0.1, "every": 0.01}}))
    main = run.position.where(run.line == "main", drop=True).to_numpy()
    assert main.shape[1] == 4 + 1 + 1  # a node on each side of the cut
    gap = np.linalg.norm(main[:, 3] - main[:, 2], axis=-1)
    assert gap[:6] == pytest.approx(0.0, abs=1e-12)
    assert gap[7:].min() > 0.01
    links = run.tension.where(run.link_line == "main", drop=True).to_numpy()
    assert np.all(links[:, 2] == 0.0)
    assert links[0, [0, 1, 3, 4]] == pytest.approx(60.0 * G, rel=0.1)


def test_a_cut_costs_no_energy() -> None:
    """All that is stored goes on; what steps through sharp waves miss is of the second order."""
    run = simulate(
        Scenario.model_validate(hanging(0.5) | {"run": {"kind": "dynamic", "until": 0.06, "every": 0.01, "step": 1e-5}})
    )
    energy = run.energy
    before, after = energy.isel(time=4), energy.isel(time=6)
    assert float(abs(before.sel(form="imbalance"))) < 1e-9
    assert float(abs(after.sel(form="imbalance"))) < 1e-3 * float(before.sel(form="elastic"))


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"cut": {"at": 12.0, "time": 1.0}}, "not between the ends of the line"),
    ({"cut": {"at": 5.0, "time": 0.0}}, "time"),
    ({"bending_stiffness": 10.0}, "not implemented for a cut line"),
    ({"law": {"kind": "inextensible"}, "axial_stiffness": None}, "not implemented for a cut line"),
]


@pytest.mark.parametrize(("change", "message"), WRONG)
def test_what_cannot_be_cut_is_refused(change: dict[str, Any], message: str) -> None:
    scenario = hanging(0.5)
    scenario["lines"]["main"] |= change
    with pytest.raises(ValueError, match=message):
        Scenario.model_validate(scenario)


@pytest.mark.parametrize(
    "run",
    [{"kind": "equilibrium"}, {"kind": "dynamic", "until": 1, "geometry": "linearised"},
     {"kind": "dynamic", "until": 1, "method": "implicit"}],
)  # fmt: skip
def test_runs_in_which_nothing_can_fly_are_refused(run: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="cut"):
        Scenario.model_validate(hanging(0.5) | {"run": run})


def test_nothing_is_joined_where_a_line_is_cut() -> None:
    scenario = hanging(0.5)
    scenario["lines"]["side"] = {
        "start": [0, -5], "end": [3, -5], "length": 3.2, "mass": 0.1, "axial_stiffness": 1e5,
        "start_support": {"kind": "joined", "to": "main", "at": 5.0},
    }  # fmt: skip
    with pytest.raises(ValueError, match="main is cut just there"):
        Scenario.model_validate(scenario)


def test_a_load_does_not_pass_a_cut() -> None:
    line = {"start": [0, 0], "end": [20, 0], "tension": 2e3, "mass": 0.1, "axial_stiffness": 1e5, "law": LAW,
            "elements": 20, "cut": {"at": 15.0, "time": 0.1}}  # fmt: skip
    load = {"kind": "force", "on": "rope", "force": [0, -100], "travel": {"speed": 10.0, "from": 13.0}}
    run = simulate(
        Scenario.model_validate(
            {"lines": {"rope": line}, "loads": {"f": load}, "run": {"kind": "dynamic", "until": 0.5, "every": 0.02}}
        )
    )
    assert run.attrs["outcome"] == "travel ended"
    assert "reached the cut of line rope" in run.attrs["advice"]
    assert 0.18 < float(run.time[-1]) <= 0.22
