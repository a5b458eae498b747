"""What is told of loads that go by themselves: how they begin, where they have come to, what their feet need."""

from __future__ import annotations

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.results import summary, text
from ropewalk.results.own_way import friction_of_steps
from ropewalk.simulate import simulate

STRING = {"start": [0, 0], "end": [10, 0], "tension": 1000.0, "mass": 0.1, "axial_stiffness": 1e5, "elements": 20}


class Feet:
    """Two feet, of which the second one bears nothing; their force may grow."""

    contacts = 2

    def __init__(self, grows: float = 0.0) -> None:
        self.grows = grows

    def step(self, t, h, line):
        force = min(t / self.grows, 1.0) if self.grows else 1.0
        return [(4.0 if t < 0.03 else 6.0, (0.0, -50.0 * force)), (5.0, (0.0, 0.0))]


def ran(load, until=0.05):
    tree = {"lines": {"string": STRING}, "loads": {"load": {"on": "string", **load}},
            "run": {"kind": "dynamic", "until": until, "every": 0.005}}  # fmt: skip
    return simulate(Scenario.model_validate(tree))


@pytest.mark.parametrize("grows", [0.0, 0.02])
def test_a_stepper_that_presses_at_once_is_remarked_and_one_whose_force_grows_is_not(grows: float) -> None:
    remarks = ran({"kind": "stepper", "model": Feet(grows)}).attrs["warnings"]
    assert ("set down suddenly at t = 0, 4 m along string" in remarks) == (grows == 0.0)
    assert "with_loads" not in remarks  # which runs with steppers refuse
    assert ("let its force grow from zero" in remarks) == (grows == 0.0)


def test_the_last_place_of_what_steps_is_where_it_stands_and_of_what_rolls_with_its_speed() -> None:
    result = ran({"kind": "stepper", "model": Feet()})
    place = summary(result)["contacts"]["load.1"]["last_place"]
    assert (place["xi"], place["time"], place["speed"]["value"]) == (6.0, 0.05, None)
    assert place["value"] == pytest.approx(6.06, abs=5e-3)  # x, by the strain of 1 %
    rolling = ran({"kind": "mass", "mass": 1.0, "travel": {"kind": "free", "from": 5.0, "speed": 4.0}})
    place = summary(rolling)["contacts"]["load"]["last_place"]
    assert place["value"] == pytest.approx(5.05 + 4.0 * 0.05, abs=5e-3)
    assert place["speed"]["value"] == pytest.approx(4.0, rel=0.02)
    line = next(row for row in text(summary(rolling)).splitlines() if row.startswith("last place"))
    assert "x = 5.2" in line
    assert "along the line" in line
    prescribed = ran({"kind": "mass", "mass": 1.0, "travel": {"from": 5.0, "speed": 4.0}})
    assert summary(prescribed)["contacts"]["load"]["last_place"] is None


def test_how_far_a_load_and_its_payload_fall_stands_in_the_summary() -> None:
    """The trolley goes down with the string, the payload by 0.2 m more, by which its leash is slack at first."""
    payload = {"mass": 2.0, "length": 0.5, "stiffness": 1e4, "at": [0.0, -0.3]}
    load = {"kind": "trolley", "mass": 0.1, "payload": payload, "travel": {"from": 5.0, "speed": 0.0}}
    result = ran(load, until=0.3)
    found = summary(result)
    here, below = found["contacts"]["load"]["lowest_place"], found["payloads"]["load"]["lowest_place"]
    z = result["body_position"].values[:, result["body"].values.tolist().index("load.payload"), -1]
    assert here["value"] == result["contact_position"].values[:, 0, -1].min()
    assert below["value"] == z.min()
    assert below["below"]["value"] == z[0] - z.min() > 0.2
    assert below["time"] == result["time"].values[z.argmin()]
    rows = [row for row in text(found).splitlines() if row.startswith("lowest place")]
    assert len(rows) == 2
    assert "m below its start" in rows[0]


def test_a_foot_needs_friction_only_while_it_presses() -> None:
    force = np.array([[0.0, -100.0], [0.0, -11.0], [0.0, -9.0], [np.nan, np.nan]])
    found = friction_of_steps(np.array([0.1, 0.2, 5.0, 3.0]), force)
    assert np.nanmax(found) == 0.2
    assert np.isnan(found[2:]).all()
    contact = summary(ran({"kind": "stepper", "model": Feet()}))["contacts"]
    assert contact["load.1"]["friction_needed"]["value"] > 0.0
