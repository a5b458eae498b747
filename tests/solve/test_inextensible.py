"""Inextensible lines: ellipse and clamped load without weight, catenary with it, limit of growing stiffness.

Numbers: weightless inextensible rope, X = 20, L = 22 (two right triangles; ellipse with semi-axes L/2 and
sqrt(L^2 - X^2)/2) and the catenary of the same length.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.model import Elastic, Equilibrium, Hooke, Inextensible, Line, MovingForce, Quasistatic, Scenario, Travel
from ropewalk.simulate import simulate
from ropewalk.theory.rope import catenary

W = 700.0


def rope(**changed: Any) -> Line:
    given: dict[str, Any] = {"start": (0.0, 0.0), "end": (20.0, 0.0), "length": 22.0, "mass": 1.0,
                             "law": Inextensible(), "elements": 22}  # fmt: skip
    return Line(**(given | changed))


def load(xi: float, contact: str = "clamped", **more: Any) -> MovingForce:
    return MovingForce(on="rope", force=(0.0, -W), contact=contact, travel=Travel(speed=1.0, start=xi), **more)


def at_rest(line: Line, *loads: MovingForce, gravity: float = 0.0) -> xr.Dataset:
    on = {f"load {k}": one for k, one in enumerate(loads)}
    result = simulate(Scenario(gravity=gravity, lines={"rope": line}, loads=on, run=Equilibrium()))
    return result.isel(load_path=0)


@pytest.mark.parametrize(
    ("xi", "place", "tensions"),
    [
        (15.0, (14.4, -4.2), (1.0, 1.2)),
        (19.0, (18.8, -2.7495454169735), (0.41461399144839, 1.0256240841092)),
        (20.5, (20.0, -1.5), (0.0, 1.0)),  # hangs from the support, the long part slack
    ],
)
def test_a_clamped_load_on_a_weightless_rope(
    xi: float, place: tuple[float, float], tensions: tuple[float, float]
) -> None:
    result = at_rest(rope(), load(xi))
    assert result.contact_position.to_numpy()[0] == pytest.approx(place, abs=1e-10)
    assert result.contact_tension.to_numpy()[0] / W == pytest.approx(tensions, abs=1e-10)


def test_a_frictionless_load_walks_on_the_ellipse_and_back_over_the_support() -> None:
    """Also beyond the support, x > X, up to the vertex of the ellipse at x = 21 m, where both parts lie on one line."""
    run = Quasistatic(positions=211)
    loads = {"bead": load(1.05, "frictionless")}
    result = simulate(Scenario(gravity=0.0, lines={"rope": rope()}, loads=loads, run=run))
    x, z = result.contact_position.to_numpy()[:, 0].T
    b = 0.5 * np.sqrt(22.0**2 - 20.0**2)
    assert ((x - 10.0) / 11.0) ** 2 + (z / b) ** 2 == pytest.approx(1.0, abs=1e-12)
    assert x[-1] == pytest.approx(21.0, abs=0.03)  # nearer than a step of 0.1 m: the last place that can be held
    assert result.attrs["outcome"] == "no rest shape"
    assert "hangs beyond the support" in result.attrs["warnings"]
    slope = -b * (x - 10.0) / 11.0**2 / np.sqrt(1.0 - ((x - 10.0) / 11.0) ** 2) * -1.0
    hold = result.hold_force.to_numpy()[:, 0, 0]
    fine = np.abs(x - 10.0) < 10.95  # the slope is infinite at the vertex
    assert hold[fine] == pytest.approx(W * slope[fine], rel=1e-9, abs=1e-7)


@pytest.mark.parametrize(
    ("x", "z", "tension", "hold"),
    [
        (5.0, 4.08180805829885, 1.11736182440039, -0.212594169703065),
        (18.0, 3.14524434400113, 0.984277308381305, 0.441437802666825),
        (20.0, 21.0 / 11.0, 0.913223140495868, 10.0 / 11.0),
        (20.5, 1.3659072001197, 0.994487151038526, 1.33414191639599),
    ],
)
def test_tension_and_hold_force_on_the_ellipse(x: float, z: float, tension: float, hold: float) -> None:
    result = at_rest(rope(elements=7), load(float(np.hypot(x, z)), "frictionless"))
    assert result.contact_position.to_numpy()[0] == pytest.approx([x, -z], abs=1e-9)
    assert result.contact_tension.to_numpy()[0] / W == pytest.approx([tension, tension], rel=1e-9)
    assert result.hold_force.to_numpy()[0, 0] / W == pytest.approx(hold, rel=1e-9)


def test_the_heavy_chain_converges_to_the_catenary_with_the_second_order() -> None:
    exact = catenary(span=20.0, length=22.0, weight=9.81)
    counts = [20, 40, 80, 160]
    sag = [-float(at_rest(rope(elements=n), gravity=9.81).position[:, 1].min()) for n in counts]
    orders = np.log2(np.abs(np.array(sag) - exact.sag)[:-1] / np.abs(np.array(sag) - exact.sag)[1:])
    print("orders", orders)
    assert orders == pytest.approx(2.0, abs=0.02)


def test_growing_stiffness_approaches_it_in_proportion() -> None:
    loads = load(14.0), load(5.0)
    exact = at_rest(rope(), *loads, gravity=9.81).position.to_numpy()
    gaps = [
        np.abs(at_rest(rope(law=Hooke(), axial_stiffness=EA), *loads, gravity=9.81).position.to_numpy() - exact).max()
        for EA in (1e6, 1e7, 1e8)
    ]
    assert gaps[0] / gaps[1] == pytest.approx(10.0, rel=0.01)
    assert gaps[1] / gaps[2] == pytest.approx(10.0, rel=0.01)
    assert gaps[2] < 1e-3


def test_the_tension_keeps_every_node_in_balance() -> None:
    result = at_rest(rope(elements=9), load(13.2), load(4.7), gravity=9.81)
    total = result.reaction.to_numpy().sum(axis=0) - np.array([0.0, 2.0 * W + 22.0 * 9.81])
    assert total == pytest.approx([0.0, 0.0], abs=1e-8)
    assert result.strain.to_numpy() == pytest.approx(np.zeros(9), abs=0.0)


def test_on_springs_it_may_be_shorter_than_the_distance() -> None:
    """Both springs share what is missing: two metres, one each."""
    soft = Elastic(stiffness=500.0)
    result = at_rest(rope(length=18.0, start_support=soft, end_support=soft))
    assert result.position.to_numpy()[[0, -1]] == pytest.approx(np.array([[1.0, 0.0], [19.0, 0.0]]), abs=1e-9)
    assert result.tension.to_numpy() == pytest.approx(np.full(22, 500.0), rel=1e-9)
