"""Sections: names, steady arms, elasticity, several of them in one plan."""

from __future__ import annotations

import numpy as np
import pytest

from overhead_cases import EN_2002, SIMPLE_AC, formed, rested
from ropewalk.overhead.plan_view import PlanView
from ropewalk.overhead.section import Section, elasticity, joined
from ropewalk.wires.mesh import mesh_of
from ropewalk.wires.plan import Spot, Wire, WirePlan, WireTie
from ropewalk.wires.rest import rest_of


def test_parts_are_named_by_span_and_number() -> None:
    section = formed(EN_2002)
    index = section.droppers["section.3.5"]
    assert section.plan.ties[index].name == "section.3.5"
    assert section.stations[index] == pytest.approx(150.0)
    assert section.plan.watched["section.support.4"] == Spot(0, 240.0)
    assert section.plan.holds[section.holds["section.support.4"]].spot == Spot(1, 240.0)
    assert section.analysed == (240.0, 360.0)


def test_what_swings_is_free_along_the_line() -> None:
    for along, stiffness in (("swings", 0.0), ("held", 500e3)):
        supports = {"stiffness": "500 kN/m", "along": along}
        section = formed(SIMPLE_AC, messenger_supports=supports)
        hold = section.plan.holds[section.holds["section.support.1"]]
        assert hold.stiffness == (stiffness, 500e3, 500e3)


def test_arms_pull_the_wire_into_its_kinks_and_hold_it_level() -> None:
    section = formed(SIMPLE_AC, steady_arms={"stagger": 0.2, "mass_per_length": 0.73})
    level = formed(SIMPLE_AC, steady_arms={"mass_per_length": 0.73})
    rest, _ = rested(section)
    arm = section.arms["section.arm.3"]
    sideways, up = rest.tie_force[arm] * rest.tie_way[arm, 1:]
    assert sideways == pytest.approx(
        -22e3 * 2 * 0.4 / 55.0, rel=1e-6
    )  # of two spans that go from one to the other side
    assert up == pytest.approx(level.plan.holds[level.holds["section.arm.3"]].force[2], rel=1e-6)
    assert rest.tie_distance[arm] == pytest.approx(1.2 * (1.0 + rest.tie_force[arm] / 17e6), rel=1e-9)
    # The stiffness against small rises: the kink's pull over the arm's run, and the wire that yields sideways.
    z = elasticity(section, 1.0, stations=np.array([165.0]))[1][0]
    without = elasticity(level, 1.0, stations=np.array([165.0]))[1][0]
    T, way = rest.tie_force[arm], rest.tie_way[arm, 2]
    hangs = T / rest.tie_distance[arm] * (1.0 - way**2) + 22e3 * (2 / 55.0) * way**2
    # The force alone acts as far from the support as the springs; the neighbouring arms matter a little.
    assert 1.0 / z - 1.0 / without == pytest.approx(hangs, rel=0.02)


def test_where_the_wires_are_aside() -> None:
    section = formed(SIMPLE_AC, start=[0, 1.0, 5.0])
    np.testing.assert_allclose(section.aside(np.array([0.0, 27.5, 55.0])), [1.2, 1.0, 0.8])
    straight = formed(SIMPLE_AC, messenger_supports={"stagger": "straight"})
    np.testing.assert_allclose(straight.aside(np.array([0.0, 55.0]), wire=1), 0.0)


def single(ties: tuple[WireTie, ...] = (), wires: int = 1) -> Section:
    """Weightless wires of one span of 60 m."""
    both = (Wire("low", (0, 0, 0), (60, 0, 0), 20e3, 1.35), Wire("high", (0, 0, 1), (60, 0, 1), 16e3, 1.07))
    plan = WirePlan(both[:wires], ties, gravity=0.0)
    ends = np.array([0.0, 60.0])
    return Section("one", plan, 0.25, ends, (0.0, 60.0), PlanView(ends, np.zeros(2), np.zeros(0)))


def test_a_string_rises_as_by_hand() -> None:
    x, found = elasticity(single(), 50.0)
    # Between control points as well: the local compliance makes it exact.
    np.testing.assert_allclose(found, x * (60.0 - x) / (60.0 * 20e3), rtol=1e-3)


def test_two_strings_tied_at_one_point_bear_together_as_long_as_the_tie_is_tight() -> None:
    tie = WireTie("tie", Spot(0, 20.0), Spot(1, 20.0), 1e9, 1.0 - 1e-3)  # 1 mm too short
    x = np.array([20.0])
    z = elasticity(single((tie,), 2), 0.1, stations=x)[1][0]
    # Beside the spline the wire yields to the push alone, not to the tie at the same point: 0.3 % at this mesh.
    assert z == pytest.approx(20.0 * 40.0 / (60.0 * 36e3), rel=4e-3)
    # Beyond the force that relieves the tie of its pull the lower one is alone.
    pull = rest_of(mesh_of(single((tie,), 2).plan, 0.25)).tie_force[0]
    force = 100.0
    z = elasticity(single((tie,), 2), force, stations=x)[1][0]
    assert z * force == pytest.approx((force - pull) * 20.0 * 40.0 / (60.0 * 20e3), rel=1e-3)


def test_elasticity_is_symmetric_and_largest_in_the_middle_of_a_span() -> None:
    x, found = elasticity(formed(EN_2002), span=5)
    assert (x[0], x[-1]) == (240.0, 300.0)
    # The section is symmetric about 300 m only; ten spans make one in the middle nearly so.
    np.testing.assert_allclose(found, found[::-1], rtol=1e-6)
    assert 20.0 < x[found.argmax()] - 240.0 < 40.0
    assert 1.5 < found.max() / found.min() < 3.0


def test_a_push_slackens_droppers() -> None:
    section = formed(EN_2002)
    x = np.array([270.0])  # at a dropper of 86 N
    soft, stiff = (elasticity(section, force, stations=x)[1][0] for force in (500.0, 50.0))
    assert soft > 1.05 * stiff


def test_sections_stand_beside_each_other_in_one_plan() -> None:
    one, two = formed(EN_2002, spans=[60, 60], analysed_spans=None), formed(SIMPLE_AC)
    plan, offsets = joined([one, two])
    assert offsets == [0, 2]
    together = rest_of(mesh_of(plan, 0.5))
    np.testing.assert_allclose(together.tie_force[: len(one.plan.ties)], rest_of(one.mesh(0.5)).tie_force, atol=1e-6)
    np.testing.assert_allclose(together.tie_force[len(one.plan.ties) :], rest_of(two.mesh(0.5)).tie_force, atol=1e-6)
