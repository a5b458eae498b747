"""Crabs: trolleys on several lines, against catenaries, and against one line with the mass and stiffness of all."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from pydantic import ValidationError

from crab_routes import G, hung, shares
from ropewalk.compare.constant import ConstantForces
from ropewalk.decouple import without_feedback
from ropewalk.errors import RopewalkError, ScenarioError
from ropewalk.model import Scenario
from ropewalk.results.statistics import summary
from ropewalk.simulate import simulate

HAULED = {"from": 30.0, "speed": {"time": [0.0, 0.5], "value": [0.0, 2.0]}, "measured": "horizontal"}
SET_DOWN: dict[str, Any] = {"start": {"kind": "rest"}}
PAYLOAD = {"mass": 6000.0, "length": 20.0, "swing": 0.1, "stiffness": 2e6, "hoist": 0.5}

LIGHT: dict[str, Any] = {"mass": 500.0, "payload": {**PAYLOAD, "mass": 800.0}}


def rope(EA: float, mass: float = 12.0, y: float | None = None, **more: Any) -> dict[str, Any]:
    ends = ([0.0, 0.0], [100.0, 0.0]) if y is None else ([0.0, y, 0.0], [100.0, y, 0.0])
    return {"start": ends[0], "end": ends[1], "length": 100.4, "mass": mass, "axial_stiffness": EA, "elements": 10,
            **more}  # fmt: skip


def taut(EA: float, mass: float = 12.0, **more: Any) -> dict[str, Any]:
    return rope(EA, mass, length=None, tension=2e4 * mass, **more)  # all of these sag alike


def crab(*ropes: str, travel: dict[str, Any], **more: Any) -> dict[str, Any]:
    also = {"also_on": list(ropes[1:])} if ropes[1:] else {}
    return {"kind": "trolley", "on": ropes[0], **also, "mass": 2000.0, "payload": PAYLOAD, "travel": travel, **more}


def run(lines: dict[str, Any], load: dict[str, Any], until: float = 0.5, **asked: Any) -> xr.Dataset:
    tree = {"kind": "dynamic", "until": until, "every": 0.05, "start": {"with_loads": True}, **asked}
    result = simulate(Scenario.model_validate({"title": "crabs", "lines": lines, "loads": {"crab": load}, "run": tree}))
    assert result.attrs["outcome"] == "completed", result.attrs["doubts"]
    return result


def energy(result: xr.Dataset, form: str) -> np.ndarray:
    return np.asarray(result.energy.sel(form=form).values)


def test_two_equal_ropes_are_one_with_the_mass_and_stiffness_of_both() -> None:
    """A crab that rolls freely under all that acts along ropes: the same equations, each asked twice."""
    travel = {"kind": "free", "from": 30.0, "speed": 3.0, "rolling": 0.01, "viscous": 100.0, "drive": 2000.0,
              "friction": 0.05, "brake": {"force": 500.0, "within": 69.0}}  # fmt: skip
    asked = SET_DOWN | {"step": 1e-3}
    acts = {"force": [300.0, -500.0], "air_drag": 20.0}
    one = run({"a": rope(440e6, mass=24.0)}, crab("a", travel=travel, **acts), **asked)
    two = run({"a": rope(220e6), "b": rope(220e6)}, crab("a", "b", travel=travel, **acts), **asked)
    whole = one.contact_force.values[:, 0]
    # Rounding, which slack links multiply as they are pulled taut.
    assert two.contact_position.values[:, 1] == pytest.approx(one.contact_position.values[:, 0], abs=1e-7)
    assert two.body_position.values == pytest.approx(one.body_position.values, abs=1e-7)
    assert two.contact_force.values == pytest.approx(np.stack([0.5 * whole, 0.5 * whole], axis=1), abs=1e-2)
    assert np.abs(whole).max() > 1e4
    assert two.energy.values == pytest.approx(one.energy.values, abs=1.0)


def test_wheels_of_what_is_moved_from_outside_have_no_friction() -> None:
    """Beside a mass of both on one rope that a level force holds, by the engine of single ropes, and its own mesh."""
    apart = []
    for elements in (10, 20):
        half, weight = taut(220e6, elements=elements), {"mass": 1e-3, "length": 1.0}
        two = run({"a": half, "b": half}, crab("a", "b", travel=HAULED, payload=weight, mass=1000.0), **SET_DOWN)
        mass = {"kind": "mass", "on": "a", "mass": 1000.0, "travel": HAULED, "contact": "frictionless"}
        one = run({"a": taut(440e6, 24.0, elements=elements)}, mass, **SET_DOWN)
        apart.append(two.contact_position.values[:, 0] - one.contact_position.values[:, 0])
    coarse, fine = np.array(apart)
    assert np.abs(fine[:, 0]).max() < 1e-6  # both are where they are told to be
    # What their meshes miss of 2 m, by which they fall, is of the first order: without that they are alike.
    assert 0.01 < np.abs(fine[:, 1]).max() < 0.6 * np.abs(coarse[:, 1]).max()
    assert np.abs(2.0 * fine[:, 1] - coarse[:, 1]).max() < 5e-3


@pytest.mark.parametrize("x", [10.0, 50.0])
def test_each_rope_bears_what_it_does_of_two_catenaries(x: float) -> None:
    exact, missed = hung(x, (220e6, 110e6), 8000.0 * G, span=100.0, length=100.4, mass=12.0), []
    for elements in (10, 20):
        lines = {"a": rope(220e6, elements=elements), "b": rope(110e6, elements=elements)}
        stands = {"from": x, "speed": 0.0, "measured": "horizontal"}
        result = run(lines, crab("a", "b", travel=stands, payload={"mass": 6000.0, "length": 20.0}), 0.01, every=0.01)
        missed.append(np.abs(shares(result)[0] - exact.share).max())
    assert result.contact_position.values[0, :, 0] == pytest.approx(x, abs=1e-9)
    assert result.contact_position.values[0, :, 1] == pytest.approx(exact.height, abs=5e-4)
    assert result.contact_force.values[0, :, -1].sum() == pytest.approx(-8000.0 * G, rel=1e-7)
    # Its wheels stand where nothing pushes them along, and something holds it there, with 11 kN near the end.
    assert result.hold_force.values[0, :, 0].sum() == pytest.approx(exact.pull, abs=10.0)
    assert missed[1] < 1e-4
    assert missed[1] < 0.6 * missed[0]  # of the first order in the mesh, as all contacts of lines


def test_shares_change_on_the_way() -> None:
    """Slowly, and with dampers, beside catenaries at each place; what is left swings by some per cent."""
    damped = {"axial_damping": 2e5, "drag": 1.0}
    slow = {"from": 10.0, "speed": 2.0, "measured": "horizontal"}
    payload = {"mass": 6000.0, "length": 20.0, "stiffness": 2e6, "damping": 1e5}
    lines = {"a": rope(220e6, **damped), "b": rope(110e6, **damped)}
    result = run(lines, crab("a", "b", travel=slow, payload=payload), 20.0, every=1.0)
    x, found = result.contact_position.values[:, 0, 0], shares(result)
    exact = np.array([
        hung(at, (220e6, 110e6), 8000.0 * G, span=100.0, length=100.4, mass=12.0).share for at in x[::5]
    ])  # fmt: skip
    assert found[::5] == pytest.approx(exact, abs=3e-3)
    assert np.ptp(exact[:, 0]) > 0.04


def test_ropes_may_be_exchanged() -> None:
    lines, asked = {"a": taut(220e6), "b": taut(110e6)}, SET_DOWN | {"step": 1e-3}
    one, other = (run(lines, crab(*names, travel=HAULED, **LIGHT), **asked) for names in (("a", "b"), ("b", "a")))
    assert list(one["load"].values) == ["crab.a", "crab.b"]
    assert one.contact_force.values == pytest.approx(other.contact_force.values[:, ::-1], rel=1e-5, abs=1e-2)


def test_four_ropes_beside_one_another_are_two_of_twice_the_size() -> None:
    """In space its wheels stand aside of it, its payload hangs in the middle."""
    stiffness, y = {"a": 220e6, "b": 110e6, "c": 110e6, "d": 220e6}, {"a": -1.0, "b": -0.5, "c": 0.5, "d": 1.0}
    four = {name: taut(EA, y=y[name]) for name, EA in stiffness.items()}
    two, asked = {"a": taut(440e6, 24.0), "b": taut(220e6, 24.0)}, SET_DOWN | {"step": 1e-3}
    wide = run(four, crab("a", "b", "c", "d", travel=HAULED, **LIGHT), 0.3, **asked)
    flat = run(two, crab("a", "b", travel=HAULED, **LIGHT), 0.3, **asked)
    force = wide.contact_force.values[:, :, -1]
    assert force[:, [0, 1]] == pytest.approx(force[:, [3, 2]], rel=1e-6)
    assert 2.0 * force[:, :2] == pytest.approx(flat.contact_force.values[:, :, -1], rel=1e-5)
    assert wide.contact_position.values[:, :, 1] == pytest.approx(np.tile([-1.0, -0.5, 0.5, 1.0], (7, 1)), abs=1e-9)
    assert wide.body_position.values[:, 0, [0, 2]] == pytest.approx(flat.body_position.values[:, 0], abs=1e-6)
    seen = summary(wide)["payloads"]["crab"]
    assert seen["sway"]["value"] == pytest.approx(summary(flat)["payloads"]["crab"]["sway"]["value"], abs=1e-6)


def test_the_hauling_rope_does_what_is_missing_of_energy_and_momentum() -> None:
    """It starts with 4 m/s^2 while its payload swings and is hoisted; what is missed falls with the step."""
    lines, missed = {"a": taut(220e6), "b": taut(110e6)}, []
    for step in (2e-3, 1e-3):
        load = crab("a", "b", travel=HAULED, **LIGHT)
        result = run(lines, load, 1.0, step=step, every=0.004, **SET_DOWN)
        missed.append(float(np.abs(energy(result, "imbalance")).max()))
    assert missed[1] < 1e-3 * np.abs(energy(result, "hold_work")).max()
    assert missed[1] < 0.45 * missed[0]
    # d/dt (m u + m' u') = H - N, along x; the crab has 2 m/s, and its payload what it has got.
    along = (result.hold_force.values[:, :, 0] - result.contact_force.values[:, :, 0]).sum(axis=1)
    gained = 500.0 * 2.0 + 800.0 * (result.body_velocity.values[-1, 0, 0] - result.body_velocity.values[0, 0, 0])
    assert np.trapezoid(along, result.time.values) == pytest.approx(gained, rel=5e-3)


def test_a_rope_that_is_drawn_up_is_doubted() -> None:
    high = rope(110e6, mass=1.0) | {"length": 100.01}
    tree = {"title": "crabs", "lines": {"a": rope(220e6), "b": high | {"start": [0.0, -2.0], "end": [100.0, -2.0]}},
            "loads": {"crab": crab("b", "a", travel=HAULED, payload={"mass": 1.0, "length": 1.0}, mass=1.0)},
            "run": {"kind": "dynamic", "until": 0.01, "every": 0.01, "start": {"with_loads": True}}}  # fmt: skip
    result = simulate(Scenario.model_validate(tree))
    assert result.attrs["outcome"] == "doubtful"
    assert "wheel a of crab would leave its rope" in result.attrs["doubts"]


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"also_on": ["c"]}, "no such line"),
        ({"also_on": ["a"]}, "it stands on that line already"),
        ({"travel": {"from": 30.0, "speed": 1.0}}, "lines that stretch differently"),
        ({"travel": {**HAULED, "at_end": "leave"}}, "all of its lines carry it"),
        ({"travel": {**HAULED, "at_end": "stay"}}, "its drive would pull it over"),
        ({"travel": {"kind": "free", "driver": {"speed": 1.0, "force": 1e3}}}, "a driver acts along one line"),
        ({"lift_off": True}, "is not implemented for loads on several lines"),
    ],
)
def test_what_cannot_be_of_crabs_is_refused(more: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        run({"a": rope(220e6), "b": rope(110e6)}, crab("a", "b", travel=HAULED) | more)


@pytest.mark.parametrize(
    ("other", "message"),
    [
        ({"start": [100.0, 0.0], "end": [0.0, 0.0]}, "does not run in that of x"),
        ({"start": [0.0, 1.0, 0.0], "end": [100.0, 2.0, 0.0]}, "does not run in that of x"),
        ({"start": [0.0, -9.0], "end": [100.0, -9.0]}, "there b is -9 m above a"),
        ({"start": [40.0, 0.0], "end": [140.0, 0.0]}, "and b runs from 40 to 140 m"),
        ({"axial_stiffness": None, "law": {"kind": "inextensible"}}, "is not implemented for loads on several lines"),
    ],
)
def test_ropes_that_carry_no_crab_together_are_refused(other: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        run({"a": rope(220e6), "b": rope(110e6) | other}, crab("a", "b", travel=HAULED))


def test_at_rest_alone_they_are_refused_and_loads_on_other_lines_of_theirs_are_met() -> None:
    tree = {"title": "crabs", "lines": {"a": rope(220e6), "b": rope(110e6)},
            "loads": {"crab": crab("a", "b", travel=HAULED)}, "run": {"kind": "equilibrium"}}  # fmt: skip
    with pytest.raises(ValidationError, match="a load on several lines is not implemented for all but motions"):
        Scenario.model_validate(tree)
    other = {"kind": "mass", "on": "b", "mass": 1.0, "travel": HAULED}
    both = {**tree, "loads": {**tree["loads"], "other": other}, "run": {"kind": "dynamic", "until": 0.1}}
    with pytest.raises(ValidationError, match="starts at the same place as load"):
        Scenario.model_validate(both)


def test_without_feedback_and_as_constant_forces_a_crab_is_refused_with_its_reason() -> None:
    """What each rope bears follows from how it yields, and rigid ground does not."""
    load = crab("a", "b", travel={"from": 30.0, "speed": 1.0, "measured": "horizontal"})
    tree = {
        "lines": {"a": rope(220e6), "b": rope(110e6)},
        "loads": {"crab": load},
        "run": {"kind": "dynamic", "until": 1},
    }
    asked = Scenario.model_validate(tree)
    with pytest.raises(ScenarioError, match=r"loads\.crab\.also_on: on rigid ground"):
        without_feedback(asked)
    with pytest.raises(RopewalkError, match="load crab: the distribution of its weight"):
        ConstantForces(asked, {}).forces()
