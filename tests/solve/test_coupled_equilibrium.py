"""Rest with loads is rest: lines, wheels and vehicles stay where they begin, and share forces as theory says."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.errors import RopewalkError
from ropewalk.model import Dynamic, Elastic, Guided, Line, Scenario
from ropewalk.results.statistics import turnover
from ropewalk.simulate import simulate

GRAVITY = 9.81


def begun(loads: dict[str, Any], elements: int = 20, gravity: float = GRAVITY, **line: Any) -> xr.Dataset:
    """A rope of 20.3 m over 20 m, 1 kg/m and EA = 100 kN, with loads at rest on it."""
    rope = {"start": (0.0, 0.0), "end": (20.0, -1.0), "length": 20.3, "mass": 1.0, "axial_stiffness": 1e5, **line}
    run = Dynamic(until=0.5, every=0.05, start={"with_loads": True})
    return simulate(Scenario(gravity=gravity, lines={"rope": Line(elements=elements, **rope)}, loads=loads, run=run))


def standing(xi: float, **more: Any) -> dict[str, Any]:
    travel = {"speed": 0.0, "from": xi, **more.pop("travel", {})}
    return {"kind": "mass", "on": "rope", "mass": 40.0, "travel": travel, **more}


def carriage(spacing: float, stiffness: float, xi: float, speed: float = 0.0, **wheel: Any) -> dict[str, Any]:
    """A body of 7.6 t on four wheels of 0.1 t."""
    names = [f"w{i}" for i in range(4)]
    return {
        "kind": "vehicle", "on": "rope", "travel": {"speed": speed, "from": xi, "at_end": "leave"},
        "bodies": {"body": {"mass": 7600.0, "inertia": 16e3, "at": 1.5 * spacing}},
        "wheels": {name: {"mass": 100.0, "at": i * spacing, **wheel} for i, name in enumerate(names)},
        "springs": {f"s{i}": {"between": ["body", name], "stiffness": stiffness} for i, name in enumerate(names)},
        "lift_off": bool(wheel),
    }  # fmt: skip


def on_cable(elements: int, load: dict[str, Any], until: float = 0.5, *, with_loads: bool = True) -> xr.Dataset:
    line = Line(start=(0, 0), end=(60, 0), tension=500e3, mass=10.0, axial_stiffness=50e6, elements=elements)
    run = Dynamic(until=until, every=until / 50, start={"with_loads": with_loads})
    return simulate(Scenario(lines={"rope": line}, loads={"car": load}, run=run))


FORCE = {"kind": "force", "on": "rope", "force": (0.0, -300.0)}
SOFT = {"stiffness": 1e4, "contact_stiffness": 1e5, "lift_off": True}
CASES: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "mass within a link": ({"a": standing(7.3)}, {}),
    "mass beside a node": ({"a": standing(7.2)}, {}),
    "two masses in one link": ({"a": standing(7.3), "b": standing(7.7)}, {}),
    "mass and force in one link": ({"a": standing(7.3), "b": {**FORCE, "travel": {"speed": 0.0, "from": 7.6}}}, {}),
    "two forces in one link": (
        {"a": {**FORCE, "travel": {"speed": 0.0, "from": 7.5}}, "b": {**FORCE, "travel": {"speed": 0.0, "from": 7.6}}},
        {},
    ),
    "frictionless force": ({"a": {**FORCE, "travel": {"speed": 0.0, "from": 7.6}, "contact": "frictionless"}}, {}),
    "frictionless mass": ({"a": standing(7.3, contact="frictionless")}, {}),
    "mass at a given x": ({"a": standing(7.3, travel={"measured": "horizontal"})}, {}),
    "oscillator": ({"a": standing(7.3, kind="oscillator", wheel_mass=5.0, stiffness=1e4)}, {}),
    "oscillator on a soft contact": ({"a": standing(7.3, kind="oscillator", wheel_mass=5.0, **SOFT)}, {}),
    "beside both supports": ({"a": standing(0.1), "b": standing(0.4), "c": standing(20.2)}, {}),
    "an end on a spring": ({"a": standing(7.3), "b": standing(7.7)}, {"end_support": Elastic(stiffness=2e4)}),
    "a counterweight": ({"a": standing(7.3), "b": standing(19.5)}, {"end_support": Guided(along=(1, 0), force=600.0)}),
    "in space": ({"a": standing(7.3), "b": standing(7.7)}, {"start": (0, 0, 0), "end": (16, 12, -1)}),
    "slack": ({"a": standing(7.3), "b": standing(7.7)}, {"law": {"kind": "tension_only"}, "length": 21.0}),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_what_rests_with_its_loads_stays(case: str) -> None:
    loads, line = CASES[case]
    result = begun(loads, **line)
    place = result.position.values
    # Rounding of rest shapes (a counterweight is lent a spring whose place follows); it was 1 to 100 mm.
    assert np.abs(place - place[0]).max() < 1e-9
    assert np.abs(result.contact_position.values - result.contact_position.values[0]).max() < 1e-9
    weight = sum(
        load["mass"] + load.get("wheel_mass", 0.0) if "mass" in load else 300.0 / GRAVITY for load in loads.values()
    )
    assert result.contact_force.values[0, :, -1].sum() == pytest.approx(-weight * GRAVITY, rel=1e-6)
    restrained = result.hold_force.values[-1] if "frictionless" in case or "given x" in case else 0.0
    np.testing.assert_allclose((result.contact_force.values[-1] - restrained)[:, 0], 0.0, atol=1e-6)  # N


@pytest.mark.parametrize("elements", [20, 60, 240])
def test_a_carriage_shares_its_weight_as_on_a_string(elements: int) -> None:
    """Four wheels 1 m apart, links of 3, 1 and 1/4 m: two, one and none of them to a link."""
    places, stiffness = 30.3 + np.arange(4.0), 2e6
    result = on_cable(elements, carriage(1.0, stiffness, 30.3))
    assert np.abs(result.position.values - result.position.values[0]).max() < 1e-9
    tension, length = float(result.tension[0].mean()), 60.0
    # Heights under the forces N of the wheels, and springs below a body that settles and pitches.
    give = np.minimum.outer(places, places) * (length - np.maximum.outer(places, places)) / (tension * length)
    weight, arm = 100.0 * GRAVITY, places - places.mean()
    A = np.zeros((6, 6))
    A[:4, :4], A[:4, 4], A[:4, 5] = give + np.eye(4) / stiffness, -1.0, -arm
    A[4, :4], A[5, :4] = 1.0, arm
    N = np.linalg.solve(A, [*(-give @ np.full(4, weight)), 7600.0 * GRAVITY, 0.0])[:4] + weight
    found = -result.contact_force.values[0, :, -1]
    np.testing.assert_allclose(found.sum(), 8000.0 * GRAVITY, rtol=1e-9)
    # The sag of the string, its elasticity, and that a link of 3 m bends at its nodes and wheels only.
    np.testing.assert_allclose(found, N, atol=0.01 * 8000.0 * GRAVITY)


@pytest.mark.parametrize("wheel", [{}, {"contact_stiffness": 2e7}])
@pytest.mark.parametrize("xi", [0.3, 30.3])
def test_nearly_rigid_carriages_rest_too(xi: float, wheel: dict[str, Any]) -> None:
    result = on_cable(20, carriage(1.0, 2e9, xi, **wheel))
    assert np.abs(result.position.values - result.position.values[0]).max() < 1e-8  # m, springs of 2 GN/m
    assert result.contact_force.values[0, :, -1].sum() == pytest.approx(-8000.0 * GRAVITY, rel=1e-6)


def test_a_wheel_borne_by_the_support_stands_on_the_line_beside_others_in_its_link() -> None:
    """It was put on the straight link to the next node, and moved with what that node did before it was seated."""
    result = on_cable(20, carriage(1.0, 2e6, 0.3), until=2.0, with_loads=False)
    energy = result.energy
    missed = float(np.abs(energy.sel(form="imbalance")).max())
    assert missed < 0.01 * float(turnover(energy.values).max())  # 0.1 %; it was 23 %


def test_what_cannot_be_held_at_rest_is_said() -> None:
    with pytest.raises(RopewalkError, match=r"line rope: .*cannot be held so near to a support"):
        begun({"a": standing(0.9, contact="frictionless", mass=400.0)}, length=21.0)


def test_contacts_that_begin_in_one_link_are_remarked() -> None:
    found = on_cable(20, carriage(1.0, 2e6, 30.3), until=0.02).attrs["warnings"]
    assert "car.w0 and car.w1 begin 1 m apart, within one link of rope (2.97 m)" in found
    assert "raise lines.rope.elements (now 20) to 60" in found
    assert "within one link" not in on_cable(60, carriage(1.2, 2e6, 30.3), until=0.02).attrs["warnings"]
