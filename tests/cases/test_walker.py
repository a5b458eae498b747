"""A walker takes the same steps, however many instants of it are kept."""

from __future__ import annotations

import numpy as np
import pytest

import ropewalk

SCENARIO = {
    "gravity": 9.81,
    "lines": {"rope": {"start": [0.0, 0.0], "end": [13.111195656352823, -3.727615029718366],
                       "end_support": {"kind": "guided", "along": [0.0, 1.0], "stiffness": 83637.47550159691},
                       "tension": 16727.495100319382, "mass": 1.5909641159410208, "axial_stiffness": 1812684.1386997462,
                       "elements": 32}},
    "loads": {"walker": {"kind": "walker", "on": "rope", "mass": 21.133650343655063, "leg_stiffness": 3698.388810139636,
                         "leg_damping": 42.267300687310126, "foot_mass": 0.4226730068731013,
                         "from": 4.73311442947675},
              "mass": {"kind": "mass", "on": "rope", "mass": 14.319552848436281,
                       "travel": {"speed": 20.50761989121062, "from": 7.050349535931117, "measured": "horizontal"}}},
    "run": {"kind": "dynamic", "until": 0.19940092730640943, "every": 0.02492511591330118,
            "start": {"with_loads": True}},
}  # fmt: skip


@pytest.fixture(scope="module")
def result():
    return ropewalk.simulate(ropewalk.Scenario(**SCENARIO))


def test_a_leg_that_has_nothing_left_to_push_with_takes_off_when_the_other_foot_lands(result) -> None:
    """The line gives the body more energy than the gait has, so that the leg behind is left without compression."""
    left, right = result["contact_state"].values[:, :2].T
    np.testing.assert_array_equal(left == 0, right != 0)


@pytest.mark.parametrize("parts", [2, 3, 12])
def test_steps_do_not_depend_on_the_interval_of_output(result, parts: int) -> None:
    run = {**SCENARIO["run"], "every": SCENARIO["run"]["every"] / parts}
    finer = ropewalk.simulate(ropewalk.Scenario(**{**SCENARIO, "run": run}))
    np.testing.assert_array_equal(finer["contact_state"].values[::parts], result["contact_state"].values)
    apart = np.abs(finer["body_position"].values[::parts] - result["body_position"].values)
    assert apart.max() < 1e-6  # m; the error of the time steps is 2e-7, a foot that stays makes 6e-4
