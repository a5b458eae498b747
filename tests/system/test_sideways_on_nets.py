"""Who walks on nets and membranes pushes and balances to the side, level and across her way.

Sources: the published force of both feet together; balance on still ground (`ropewalk.theory.lateral_balance`); the
same scenario turned about a vertical axis.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
import xarray as xr

from closed_forms import lateral_steps
from gait_cases import GAIT
from ropewalk.errors import ScenarioError
from ropewalk.mechanics.sideways import Sideways
from ropewalk.model import Scenario
from ropewalk.scenario import loads
from ropewalk.simulate import simulate

Tree = dict[str, Any]
PATH = [[0.5, 1.4], [3.5, 1.6]]
CORNER = [[0.5, 0.7], [2.5, 0.7], [2.5, 2.5]]
STEPPING: Tree = {"kind": "footsteps", "mass": 10.0, "frequency": 2.5, "step_length": 0.5, "lateral": "bachmann"}
BALANCING: Tree = {**{key: value for key, value in STEPPING.items() if key != "lateral"}, "balance": {}}
LEGS: Tree = {"leg_stiffness": 1750.0, "leg_damping": 20.0, "foot_mass": 0.2}
WALKER: Tree = {"kind": "walker", "mass": 10.0, **LEGS, "balance": {}}


def case(load: Tree, until: float, every: float, turned: float = 0.0, net: Tree | None = None, **run: Any) -> Scenario:
    """A net, turned about a vertical axis by an angle in rad."""
    c, s = np.cos(turned), np.sin(turned)
    sheet = {
        "kind": "membrane", "corner": [0.0, 0.0, 0.0], "sides": [[4.0 * c, 4.0 * s, 0.0], [-3.0 * s, 3.0 * c, 0.0]],
        "cells": [10, 8], "stiffness": 1e5, "mass": 0.5, "damping": 20.0, "tension": 3e3, **(net or {}),
    }  # fmt: skip
    sheet = {key: value for key, value in sheet.items() if value is not None}
    tree = {"nets": {"net": sheet}, "loads": {"her": {"on": "net", "path": PATH, **load}}}
    return loads(json.dumps({**tree, "run": {"kind": "dynamic", "until": until, "every": every, **run}}))


def pushes(result: xr.Dataset) -> np.ndarray:
    """Forces (time, foot, axis) on the net, N; none of a foot in the air."""
    return np.asarray(result.contact_force.fillna(0.0).values)


@pytest.fixture(scope="module")
def stepping() -> xr.Dataset:
    return simulate(case({**STEPPING, "path": CORNER}, 1.9, 0.02))


def test_both_feet_together_push_with_the_published_force(stepping: xr.Dataset) -> None:
    """On the first piece of her path, which runs along x, and on the second along y; a foot stands on one of them."""
    assert stepping.attrs["outcome"] == "completed", stepping.attrs["advice"]
    t, force = stepping.time.values, pushes(stepping).sum(axis=1)
    given = 98.1 * 0.1 * (np.sin(2.5 * np.pi * t) + np.sin(7.5 * np.pi * t))
    first, last = t < 4.0 / 2.5 - 0.03, t > 4.2 / 2.5 + 0.03  # foot 4 lands at the corner, and is borne by then
    assert force[first, 1] == pytest.approx(given[first], abs=0.02)  # linear between 200 samples a step
    assert np.abs(force[first, 0]).max() < 1e-9
    assert force[last, 0] == pytest.approx(-given[last], abs=0.02)
    assert np.abs(force[last, 1]).max() < 1e-9


def test_each_foot_pushes_across_the_piece_on_which_it_stands(stepping: xr.Dataset) -> None:
    force, xi = pushes(stepping), stepping.contact_xi.values
    beyond = xi >= 2.0 - 1e-9
    assert (beyond.any(axis=1) & (xi < 1.9).any(axis=1)).any()  # both at the same time
    assert np.abs(force[beyond][:, 1]).max() < 1e-9
    assert np.abs(force[xi < 1.9][:, 0]).max() < 1e-9
    assert np.abs(stepping.energy.sel(form="imbalance").values).max() < 0.01


@pytest.mark.parametrize("load", [STEPPING, WALKER, BALANCING],
                         ids=["footsteps", "walker", "balance"])  # fmt: skip
def test_a_turned_scenario_gives_the_turned_answer(load: Tree) -> None:
    angle, until = np.radians(40.0), 0.9
    turn = np.array([[np.cos(angle), np.sin(angle), 0.0], [-np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
    plain, turned = (simulate(case(load, until, 0.05, a)) for a in (0.0, angle))
    assert plain.attrs["outcome"] == turned.attrs["outcome"] == "completed"
    assert np.abs(pushes(plain)[:, :, 1]).max() > 1.0  # N
    # A foot lands within 3e-10 of a leg, and turned rest is found to 1e-9 of the force.
    assert turned.position.values == pytest.approx(plain.position.values @ turn, abs=1e-7)
    assert pushes(turned) == pytest.approx(pushes(plain) @ turn, abs=1e-3)


def test_on_a_net_that_hardly_moves_she_balances_as_on_still_ground() -> None:
    """The walker of `tests/solve/test_lateral_walking.py`, 80 kg, on a sheet of 2 t/m^2 under 100 MN/m."""
    sides = [[6.0, 0.0, 0.0], [0.0, 3.0, 0.0]]
    ground = {"stiffness": 1e10, "mass": 2e3, "tension": 1e8, "damping": 0.0, "sides": sides, "cells": [6, 3]}
    load = {"kind": "walker", "speed": GAIT.speed, "balance": {}, "path": [[0.5, 1.5], [5.5, 1.5]]}
    found = simulate(case(load, 2.2, 0.01, net=ground))
    assert found.attrs["outcome"] == "completed", found.attrs["advice"]
    side = pushes(found)[:, :, 1].sum(axis=1)
    peak = float(lateral_steps.peak_force(mass=80.0, step_time=GAIT.step_time, margin=0.0157, leg_length=1.17))
    assert np.abs(side[found.time.values > 1.0]).max() == pytest.approx(peak, rel=0.15)  # as on lines
    y = found.body_position.sel(axis="y").values[:, 0]
    width = float(lateral_steps.step_width(step_time=GAIT.step_time, margin=0.0157, leg_length=1.17))
    assert 0.05 * width < np.ptp(y) < width
    pushed = np.trapezoid(side, found.time.values) + 80.0 * np.diff(
        found.body_velocity.sel(axis="y").values[[0, -1], 0]
    )
    assert np.abs(pushed) < 1.0  # N s: what the net gets the body loses, but for jumps of 50 N between two frames
    assert np.abs(found.energy.sel(form="imbalance").values).max() < 0.1


def test_sideways_is_level_on_a_net_that_is_inclined_and_skew() -> None:
    outline = [[1.0, 2.0, 0.0], [5.0, 2.0, 1.0], [5.0, 5.0, 1.0], [1.0, 5.0, 0.0]]
    for net, path, left in (
        ({"sides": [[4.0, 0.0, 3.0], [1.0, 3.0, 0.0]]}, [[0.0, 0.0], [1.0, 0.0]], [0.0, 1.0]),
        ({"sides": [[4.0, 0.0, 3.0], [1.0, 3.0, 0.0]]}, [[0.0, 1.0], [0.0, 2.0]], [-3.0, 1.0]),
        ({"sides": None, "corner": None, "cells": None, "boundary": outline, "spacing": 0.5},
         [[0.0, 1.0], [0.0, 2.0]], [-1.0, 0.0]),
    ):  # fmt: skip
        scenario = case({**STEPPING, "path": path}, 0.1, 0.1, net=net)
        found = Sideways.of(scenario, scenario.loads["her"], "left").side
        assert found[0] == pytest.approx(np.array(left) / np.linalg.norm(left), abs=1e-12)
        assert Sideways.of(scenario, scenario.loads["her"], "right").side == pytest.approx(-found)


def test_who_balances_needs_a_straight_path() -> None:
    with pytest.raises(ScenarioError, match=r"loads\.her\.balance: is not implemented for paths that turn"):
        simulate(case({**WALKER, "path": CORNER}, 0.1, 0.1))
    with pytest.raises(ScenarioError, match="straight path"):
        simulate(case({**WALKER, "path": [[0.5, 1.0], [2.0, 1.0], [1.0, 1.0]]}, 0.1, 0.1))
