"""Friction beside a load: what it needs, when it slips, what holds it then.

Weightless inextensible rope, X = 20, L = 22, load at xi = 19: a capstan needs mu = ln(T2/T1)/(a1 + a2) =
0.69429438018249; a block needs the slope of the load's path, which is |Fx|/W of the frictionless contact.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from ropewalk.model import Equilibrium, Inextensible, Line, MovingForce, Quasistatic, Scenario, Travel
from ropewalk.simulate import simulate

W = 700.0
CAPSTAN_19 = 0.69429438018249
Model = Literal["capstan", "block"]
both_models = pytest.mark.parametrize("model", ["capstan", "block"])


def rope(**changed: Any) -> Line:
    given: dict[str, Any] = {"start": (0.0, 0.0), "end": (20.0, 0.0), "length": 22.0, "mass": 1.0,
                             "law": Inextensible(), "elements": 11}  # fmt: skip
    return Line(**(given | changed))


def load(xi: float, contact: str = "clamped", **more: Any) -> MovingForce:
    speed = more.pop("speed", 1.0)
    return MovingForce(on="rope", force=(0.0, -W), contact=contact, travel=Travel(speed=speed, start=xi), **more)


def at_rest(*loads: MovingForce, gravity: float = 0.0, **changed: Any) -> xr.Dataset:
    on = {f"load {k}": one for k, one in enumerate(loads)}
    return simulate(Scenario(gravity=gravity, lines={"rope": rope(**changed)}, loads=on, run=Equilibrium()))


def turn_at_contact(result: xr.Dataset) -> float:
    """The angle by which the weightless rope turns at the contact."""
    x, z = result.contact_position.to_numpy()[0, 0]
    return float(np.arctan2(-z, x) + np.arctan2(-z, 20.0 - x))


def test_a_clamped_load_reports_the_coefficient_of_a_capstan() -> None:
    result = at_rest(load(19.0))
    assert float(result.contact_friction[0, 0]) == pytest.approx(CAPSTAN_19, rel=1e-10)
    assert float(at_rest(load(15.0)).contact_friction[0, 0]) == pytest.approx(0.19661651786242, rel=1e-10)


def test_a_clamped_load_reports_the_coefficient_of_a_block() -> None:
    """|T2 - T1|/(T1 + T2) = mu tan(angle/2)."""
    result = at_rest(load(19.0, friction_model="block"))
    first, second = result.contact_tension.to_numpy()[0, 0]
    exact = (second - first) / (first + second) / np.tan(0.5 * turn_at_contact(result))
    assert float(result.contact_friction[0, 0]) == pytest.approx(exact, rel=1e-10)


def test_on_a_slack_part_no_friction_suffices() -> None:
    result = at_rest(load(20.5))
    assert not float(result.contact_friction[0, 0]) < 1e3
    assert "leaves the part behind it slack" in result.attrs["warnings"]


def test_whether_a_given_coefficient_suffices_is_said() -> None:
    assert "more than the given" in at_rest(load(19.0, friction=0.6)).attrs["warnings"]
    assert "suffice" not in at_rest(load(19.0, friction=0.7)).attrs["warnings"]


@both_models
def test_with_enough_friction_a_load_stands_as_if_clamped(model: Model) -> None:
    stands, clamped = at_rest(load(19.0, "coulomb", friction=0.7, friction_model=model)), at_rest(load(19.0))
    assert stands.position.to_numpy() == pytest.approx(clamped.position.to_numpy(), abs=1e-12)
    assert stands.hold_force.to_numpy() == pytest.approx(np.zeros((1, 1, 2)), abs=0.0)


@both_models
@pytest.mark.parametrize("mu", [0.0, 0.1, 0.4])
def test_with_too_little_it_is_held_at_the_limit_of_friction(model: Model, mu: float) -> None:
    result = at_rest(load(19.0, "coulomb", friction=mu, friction_model=model))
    first, second = result.contact_tension.to_numpy()[0, 0]
    angle = turn_at_contact(result)
    if model == "capstan":
        assert np.log(second / first) == pytest.approx(mu * angle, rel=1e-9, abs=1e-9)
    else:
        assert (second - first) / (second + first) == pytest.approx(mu * np.tan(0.5 * angle), rel=1e-9, abs=1e-9)
    assert float(result.contact_friction[0, 0]) == pytest.approx(mu, rel=1e-8, abs=1e-9)
    assert float(result.hold_force[0, 0, 0]) > 0.0  # it would slide down to the middle
    assert "slips" in result.attrs["warnings"]


def test_without_friction_coulomb_is_frictionless() -> None:
    coulomb, frictionless = at_rest(load(17.0, "coulomb", friction=0.0)), at_rest(load(17.0, "frictionless"))
    for name in ("position", "hold_force", "contact_tension"):
        assert coulomb[name].to_numpy() == pytest.approx(frictionless[name].to_numpy(), abs=1e-9)


@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_a_dragged_load_feels_all_friction_against_its_travel(speed: float) -> None:
    result = at_rest(load(11.0, "dragged", friction=0.2, speed=speed), gravity=9.81, elements=22)
    behind, ahead = result.contact_tension.to_numpy()[0, 0]
    assert float(result.contact_friction[0, 0]) == pytest.approx(0.2, rel=1e-9)
    assert (behind - ahead) * speed > 0.0  # the part it comes from pulls more
    assert float(result.hold_force[0, 0, 0]) * speed > 0.0


def test_only_the_load_that_needs_it_is_held() -> None:
    """At the middle a load of any friction stands; near the support it slips."""
    result = at_rest(
        load(11.0, "coulomb", friction=0.3), load(21.0, "coulomb", friction=0.3), gravity=9.81, elements=44
    )
    hold = result.hold_force.to_numpy()[0, :, 0]
    assert hold[0] == 0.0
    assert hold[1] > 0.0
    used = result.contact_friction.to_numpy()[0]
    assert used[0] < 0.3
    assert used[1] == pytest.approx(0.3, rel=1e-8)


def test_a_load_that_would_slip_alone_stands_once_its_neighbour_is_held() -> None:
    """With both clamped, the second one needs 0.71, then 0.24: what holds the first one takes some of that off it."""
    both = load(1.4, "coulomb", friction=0.13), load(2.6, "coulomb", friction=0.25)
    free = at_rest(load(1.4), load(2.6)).contact_friction.to_numpy()[0]
    assert free[1] > 0.7
    result = at_rest(*both)
    hold, used = result.hold_force.to_numpy()[0, :, 0], result.contact_friction.to_numpy()[0]
    assert hold[0] < 0.0
    assert used[0] == pytest.approx(0.13, rel=1e-8)
    assert hold[1] == 0.0
    assert used[1] < 0.25


def test_along_a_path_it_slips_where_friction_ends_and_stands_in_between() -> None:
    scenario = Scenario(
        gravity=0.0, lines={"rope": rope()}, run=Quasistatic(positions=181),
        loads={"foot": load(2.0, "coulomb", friction=0.3)},
    )  # fmt: skip
    result = simulate(scenario)
    used, hold = result.contact_friction.to_numpy()[:, 0], result.hold_force.to_numpy()[:, 0, 0]
    assert used.max() == pytest.approx(0.3, rel=1e-8)
    assert np.array_equal(hold != 0.0, used > 0.3 * (1.0 - 1e-8))
    first = int(np.argmax(hold == 0.0))
    assert first > 0
    assert np.count_nonzero(hold == 0.0) > 50  # of 181 places
    assert np.all(hold[:first] < 0.0)
    assert np.all(np.diff(np.flatnonzero(hold == 0.0)) == 1)  # stands in one stretch around the middle


def slope_of_energy(xi: float, line: Line, h: float = 1e-4) -> tuple[float, float]:
    """Slope of the total energy along x, by differences, and the hold force of a frictionless load."""
    found = []
    for place in (xi - h, xi, xi + h):
        loads = {"bead": load(place, "coulomb", friction=0.0)}
        found.append(simulate(Scenario(lines={"rope": line}, loads=loads, run=Equilibrium())).isel(load_path=0))
    energy = [float(one.energy.sum()) + W * float(one.contact_position[0, 1]) for one in found]
    x = [float(one.contact_position[0, 0]) for one in found]
    return (energy[2] - energy[0]) / (x[2] - x[0]), float(found[1].hold_force[0, 0])


@settings(max_examples=25, deadline=None)
@given(xi=st.floats(3.0, 19.0), stiffness=st.floats(2e4, 1e7), height=st.floats(-5.0, 5.0))
def test_the_hold_force_is_the_slope_of_the_energy_for_equal_tensions(
    xi: float, stiffness: float, height: float
) -> None:
    """Nothing pulls a frictionless load along the rope: the hold force does all the work, dE = hold . dx.

    E is the energy of the elastic rope and the load's W z; of an inextensible one nothing but W z, so that the hold
    force is W times the slope of the load's path (the ellipse above).
    """
    line = rope(law={"kind": "hooke"}, axial_stiffness=stiffness, mass=1e-9, end=(20.0, height), elements=10)
    slope, hold = slope_of_energy(xi, line)
    assert slope == pytest.approx(hold, abs=1e-4 * W)  # central differences of energies with rounding errors


def test_with_weight_that_holds_to_the_first_order_of_the_links() -> None:
    """The masses beside a load are divided anew as it passes: what that changes of the energy is of the first order."""
    gaps = []
    for n in (20, 40, 80, 160):
        line = rope(law={"kind": "hooke"}, axial_stiffness=2e4, mass=5.0, elements=n)
        gaps.append(np.mean([abs(np.subtract(*slope_of_energy(xi, line))) for xi in np.linspace(12.0, 14.0, 9)]))
    orders = np.log2(np.array(gaps[:-1]) / gaps[1:])
    print("gaps", gaps, "orders", orders)
    assert gaps[-1] < 2e-3 * W
    assert np.mean(orders) == pytest.approx(1.1, abs=0.3)
