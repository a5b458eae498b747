"""Pantographs as riders: their matrices, the force that presses them, and where they begin."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from overhead_cases import EN_2002, formed
from ropewalk.errors import RopewalkError
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.pantographs import mean_force
from ropewalk.overhead.pantograph_loads import Above, expected_lift, moving_load_of, push_of, start_of
from ropewalk.overhead.plan_view import PlanView
from ropewalk.overhead.section import Section
from ropewalk.wires.plan import Wire, WirePlan
from ropewalk.wires.rest import rest_of

TRAVEL = {"speed": "250 km/h", "from": "10 m"}
OWN = {"masses": [15, 7.2], "stiffness": [50, 4200], "damping": [90, 10]}


def pantograph(**keys: Any) -> Pantograph:
    return Pantograph.model_validate({"on": "section", "travel": TRAVEL} | keys)


def test_the_published_two_masses_are_those_written_out() -> None:
    for one in (pantograph(model="en50318-2002"), pantograph(**OWN, static_force=120)):
        moving_load = moving_load_of("first", one)
        np.testing.assert_array_equal(moving_load.mass, np.diag([15.0, 7.2]))
        np.testing.assert_array_equal(moving_load.stiffness, [[4250.0, -4200.0], [-4200.0, 4200.0]])
        np.testing.assert_array_equal(moving_load.damping, [[100.0, -10.0], [-10.0, 10.0]])
        (contact,) = moving_load.contacts
        assert contact.row == (0.0, 1.0)
        assert (contact.stiffness, contact.below, contact.lifts_off) == (50e3, True, True)
        assert push_of(one, 0.0)(1.0, 70.0).tolist() == [120.0, 0.0]


def test_three_masses_stand_on_each_other() -> None:
    moving_load = moving_load_of("first", pantograph(model="simple-ac"))
    expected = [[15660.0, -15500.0, 0.0], [-15500.0, 22500.0, -7000.0], [0.0, -7000.0, 7000.0]]
    np.testing.assert_array_equal(moving_load.stiffness, expected)
    assert moving_load.contacts[0].row == (0.0, 0.0, 1.0)


@pytest.mark.parametrize(
    ("target", "speed", "force"),
    [
        # 0.00097 v^2 + 70, 110, 140, with v in km/h; ranges for AC at 275 and 320 km/h: 141.5-146.5, 166.5-171.5.
        ("ac", 275.0, 143.36),
        ("ac", 320.0, 169.33),
        ("dc_3kv", 200.0, 148.80),
        ("dc_1.5kv", 200.0, 178.80),
    ],
)
def test_mean_forces_asked_for(target: str, speed: float, force: float) -> None:
    assert mean_force(target, speed / 3.6) == pytest.approx(force, abs=0.005)  # rounded
    push = push_of(pantograph(**OWN, mean_force=target), 0.0)
    assert push(1.0, speed / 3.6)[0] == pytest.approx(force * (1.0 + 50.0 / 4200.0 + 50.0 / 50e3), abs=0.01)


def test_all_forces_grow_along_the_ramp() -> None:
    push = push_of(pantograph(**OWN, static_force=100, aerodynamic=0.01, aerodynamic_on="head", ramp=0.4), 0.0)
    found = push(np.array([0.0, 0.1, 0.4, 2.0]), np.array([50.0, 50.0, 50.0, 100.0]))
    np.testing.assert_allclose(found, [[0.0, 0.0], [25.0, 6.25], [100.0, 25.0], [100.0, 100.0]])
    frame = push_of(pantograph(**OWN, static_force=100, aerodynamic=0.01, ramp=0), 0.0)
    np.testing.assert_allclose(frame(0.0, 50.0), [125.0, 0.0])


@pytest.mark.parametrize("model", ["en50318-2002", "simple-ac"])
def test_a_wanted_mean_force_presses_a_wire_that_stands_at_the_expected_height(model: str) -> None:
    one, level, lift = pantograph(model=model, mean_force="150 N"), 5.08, 0.04
    moving_load, force = moving_load_of("first", one), push_of(one, level, lift)(10.0, 70.0)
    # K q = push - F at the head, F = k (q_head - height): the contact's spring added to the head.
    K, head = moving_load.stiffness.copy(), np.zeros(moving_load.size)
    head[-1] = one.contact_stiffness
    K[-1, -1] += one.contact_stiffness
    q = np.linalg.solve(K, force + head * (level + lift))
    assert one.contact_stiffness * (q[-1] - level - lift) == pytest.approx(150.0, rel=1e-9)


def test_it_starts_where_it_just_touches_and_nothing_moves_it() -> None:
    section, one = formed(EN_2002, start=[0, 5.08], pre_sag=0.03), pantograph(model="en50318-2002")
    mesh = section.mesh()
    rest = rest_of(mesh)
    q = start_of(one, mesh, rest)
    # 10 m is beside the dropper at 10.5 m, where the parabola is 11.8 mm low; the wire sags little in between.
    assert q[0] == pytest.approx(5.08 - 0.03 * (1.0 - (19.5 / 25.0) ** 2), abs=1.5e-3)
    out = push_of(one, section.level)(0.0, 70.0) - moving_load_of("first", one).stiffness @ q
    # All that is left is the spring of the base, 50 N/m, which is without force at the height of the supports.
    np.testing.assert_allclose(out, [50.0 * (5.08 - q[0]), 0.0], atol=1e-9)
    assert start_of(one, mesh, rest, above=Above(rough=lambda x: np.full_like(x, 0.01)))[0] == pytest.approx(
        q[0] + 0.01
    )


def test_a_pantograph_cannot_start_off_the_line() -> None:
    section = formed(EN_2002, spans=[60, 60], analysed_spans=None)
    one = pantograph(model="en50318-2002", travel={"speed": 70, "from": 121})
    mesh = section.mesh()
    with pytest.raises(RopewalkError, match="starts at 121 m, off the overhead line of 120 m; write"):
        start_of(one, mesh, rest_of(mesh))


def test_the_expected_lift_of_a_string_is_that_by_hand() -> None:
    plan = WirePlan((Wire("low", (0, 0, 5), (60, 0, 5), 20e3, 1.35),), gravity=0.0)
    ends = np.array([0.0, 60.0])
    section = Section("one", plan, 0.25, ends, (0.0, 60.0), PlanView(ends, np.zeros(2), np.zeros(0)))
    # Mean of x (L - x) / (T L) is L / (6 T); nine points in place of all miss 1 / (2 9^2) of it.
    assert expected_lift(section, 100.0) == pytest.approx(100.0 * 60.0 / (6.0 * 20e3), rel=0.01)
