"""One parameter at a time: what a rope hangs by, beside runs of its own, and the tornado diagram."""

from __future__ import annotations

import json

import numpy as np
import pytest

import ropewalk
import sweep_cases as cases
from ropewalk.errors import ScenarioError
from ropewalk.sweeps.command import plain
from ropewalk.sweeps.dataset import effects_table
from ropewalk.sweeps.swings import swings

LENGTH, FORCE = "lines.rope.length", "loads.man.force.1"
OVER = {LENGTH: ["10.2 m", "10.4 m", "10.8 m"], FORCE: [-200, 0], "lines.rope.law.kind": ["tension_only"]}


@pytest.fixture(scope="module")
def found():
    return ropewalk.sweep(cases.scenario(), OVER, record="max tension, largest_sag", combine="one_at_a_time", workers=0)


def test_each_case_differs_from_the_scenario_in_one_value(found):
    assert found["length"].values.tolist() == [10.5, 10.2, 10.4, 10.8, 10.5, 10.5, 10.5]
    assert found["force.1"].values.tolist() == [-100.0] * 4 + [-200.0, 0.0, -100.0]
    assert found["kind"].values.tolist() == ["hooke"] * 6 + ["tension_only"]
    with ropewalk.simulate(cases.scenario()) as run:
        assert float(found["max tension"][0]) == ropewalk.summary(run)["largest_tension"]["value"]


def test_what_a_quantity_swings_between_is_that_of_runs_beside(found):
    grid = ropewalk.sweep(cases.scenario(), {LENGTH: ["10.5 m", *OVER[LENGTH]]}, record="max tension", workers=0)
    own = found.sel(quantity="max tension", parameter="length")
    assert (float(own["least"]), float(own["largest"])) == (grid["max tension"].min(), grid["max tension"].max())
    assert float(own["least"]) < float(found["max tension"][0]) < float(own["largest"])
    same = found.sel(parameter="kind")  # a rope that is taut all along
    np.testing.assert_allclose(same["largest"], same["least"], rtol=1e-12)
    assert [row["parameter"] for row in plain(found)["effects"]] == ["length", "force.1", "kind"] * 2
    json.dumps(plain(found))
    assert effects_table(found) is not None


def test_the_scenario_as_it_is_counts_and_what_is_missing_leaves_a_gap():
    found = swings([1, 2], {"q": np.array([1.0, 2.0, 3.0, np.nan])})
    np.testing.assert_array_equal(found["least"], [[1.0, np.nan]])
    np.testing.assert_array_equal(found["largest"], [[2.0, np.nan]])


def test_the_longest_bar_is_on_top_and_goes_from_the_scenario_to_the_ends(found):
    upper, lower = ropewalk.sweep_figure(found).axes
    names = [[tick.get_text().split()[0] for tick in ax.get_yticklabels()] for ax in (upper, lower)]
    assert names == [["kind", "length", "force.1"], ["kind", "force.1", "length"]]
    usual, force = float(found["max tension"][0]), found["max tension"].values[4:6]
    top = [bar for bar in upper.patches if bar.get_y() > 1.0]
    assert [(bar.get_x(), bar.get_x() + bar.get_width()) for bar in top] == [(usual, pytest.approx(f)) for f in force]


def test_what_is_no_value_of_the_scenario_is_refused():
    with pytest.raises(ScenarioError, match=r"lines\.rope\.end.*no single value"):
        ropewalk.sweep(cases.scenario(), {"lines.rope.end": [[9, 0]]}, combine="one_at_a_time", workers=0)
