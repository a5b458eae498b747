"""Loads whose friction counts, and vehicles, on ropes over sheaves at rest and in slow motion.

Sources: over a sheave on which it cannot slip, a span is a rope of its own, which the engine of ropes computes
otherwise (`solve/hold_forces.py`); without any friction T + T^2/(2 EA) - rho g z is the same all along a rope, for
dT = rho g dz/(1 + T/EA); Euler's law of belts.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.capabilities import ROPES, SYSTEM, engine_of
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

Tree = dict[str, Any]
FORCE: Tree = {"kind": "force", "force": [0.0, -400.0]}
TOP = [12.0, 1.0]
FAST = 50.0  # friction with which nothing slips


def over(load: Tree, at: float, friction: float, **run: Any) -> xr.Dataset:
    """A rope of 20.1 m over a sheave 12 m from its start."""
    rope = {
        "start": [0.0, 0.0], "end": [19.0, -1.0], "length": 20.1, "mass": 1.0, "axial_stiffness": 1e5, "elements": 60,
        "sheaves": {"tower": {"at": TOP, "friction": friction}},
    }  # fmt: skip
    return rest({"rope": rope}, load, at, SYSTEM, **run)


def rest(lines: Tree, load: Tree, at: float, engine: Any, **run: Any) -> xr.Dataset:
    own = {**load, "on": "rope", "travel": {"speed": 1.0, "from": at}}
    tree = {"lines": lines, "loads": {"load": own}, "run": {"kind": "equilibrium", **run}}
    scenario = Scenario.model_validate(tree)
    assert engine_of(scenario) is engine
    found = simulate(scenario)
    assert found.attrs["outcome"] == "completed", found.attrs["advice"]
    return found


def span_alone(load: Tree, at: float, station: float) -> xr.Dataset:
    """The span before the sheave as a rope of its own, with as many links."""
    rope = {"start": [0.0, 0.0], "end": TOP, "length": station, "mass": 1.0, "axial_stiffness": 1e5, "elements": 36}
    return rest({"rope": rope}, load, at, ROPES)


CONTACTS: dict[str, Tree] = {
    "frictionless": {"contact": "frictionless"},
    "coulomb that sticks": {"contact": "coulomb", "friction": 0.8},
    "coulomb that slips": {"contact": "coulomb", "friction": 0.05},
    "dragged": {"contact": "dragged", "friction": 0.2},
    "dragged block": {"contact": "dragged", "friction": 0.2, "friction_model": "block"},
}


@pytest.mark.parametrize("at", [3.0, 9.0])
@pytest.mark.parametrize("kind", CONTACTS)
def test_before_a_sheave_that_holds_the_rope_a_contact_holds_as_on_a_rope_of_its_own(kind: str, at: float) -> None:
    load = {**FORCE, **CONTACTS[kind]}
    both = over(load, at, FAST)
    alone = span_alone(load, at, float(both["sheave_station"].values[0, 0]))
    for name, size in (("hold_force", 400.0), ("contact_force", 400.0), ("contact_tension", 1000.0)):
        assert both[name].values[0, 0] == pytest.approx(alone[name].values[0, 0], abs=1e-4 * size)
    assert both["contact_position"].values == pytest.approx(alone["contact_position"].values, abs=1e-4)
    assert (abs(both["hold_force"].values[0, 0, 0]) > 0.1) == (kind != "coulomb that sticks")
    assert ("slips: friction 0.05 does not hold it" in both.attrs["warnings"]) == (kind == "coulomb that slips")


def test_without_any_friction_tension_changes_with_height_alone() -> None:
    found = over({**FORCE, "contact": "frictionless"}, 5.0, 0.0)
    behind, ahead = found["contact_tension"].values[0, 0]
    assert behind == pytest.approx(ahead, rel=1e-8)
    z, T = found["position"].values[0, :, 1], found["tension"].values[0]
    level = T + T**2 / 2e5 - 9.81 * 0.5 * (z[1:] + z[:-1])
    # Links at ends, where the load stands and at the sheave have lines of their own beside them.
    places = (0.0, 5.0, float(found["sheave_station"].values[0, 0]), 20.1)
    plain = [min(abs(0.5 * (a + b) - place) for place in places) > 1.2 for a, b in pairwise(found["xi"].values)]

    assert np.ptp(level[plain]) < 2e-3  # N of 600: a straight link is lower in its middle than its curve


def test_a_load_that_is_dragged_and_a_rope_that_slips_obey_the_law_of_belts() -> None:
    found = over({**FORCE, "contact": "dragged", "friction": 0.2}, 5.0, 0.1)
    behind, ahead = found["contact_tension"].values[0, 0]
    assert found["contact_friction"].values[0, 0] == pytest.approx(0.2, rel=1e-6)
    assert behind > ahead


def test_what_friction_is_asked_for_is_told() -> None:
    found = over({**FORCE, "friction": 0.05}, 3.0, FAST)
    needed = float(found["contact_friction"].values[0, 0])
    assert needed > 0.05
    assert f"needs a friction coefficient of {needed:.3g}" in found.attrs["warnings"]
    assert not over({**FORCE, "friction": 1.1 * needed}, 3.0, FAST).attrs["warnings"]


CAR: Tree = {
    "kind": "vehicle", "bodies": {"box": {"mass": 60.0, "inertia": 30.0}},
    "wheels": {"front": {"at": 0.8, "mass": 8.0}, "rear": {"at": -0.6, "mass": 10.0}},
    "springs": {"f": {"between": ["box", "front"], "stiffness": 2e4},
                "r": {"between": ["box", "rear"], "stiffness": 1e4}},
}  # fmt: skip
THREE: Tree = {
    **CAR, "wheels": {**CAR["wheels"], "middle": {"at": 0.1, "mass": 5.0}},
    "springs": {**CAR["springs"], "m": {"between": ["box", "middle"], "stiffness": 3e4}},
}  # fmt: skip


def test_a_vehicle_with_two_axles_rests_on_its_axle_loads() -> None:
    """By moments: 0.6/1.4 of the box on the front axle, whatever the rope does."""
    found = over(CAR, 5.0, 0.05)
    front = 9.81 * (8.0 + 60.0 * 0.6 / 1.4)
    force = found["contact_force"].values[0]
    assert force == pytest.approx(np.array([[0.0, -front], [0.0, -9.81 * 78.0 + front]]), abs=1e-6)
    place, box = found["contact_position"].values[0, :, 1], found["body_position"].values[0, 0]
    sunk = np.array([9.81 * 60.0 * 0.6 / 1.4 / 2e4, 9.81 * 60.0 * 0.8 / 1.4 / 1e4])
    above = (place - sunk) @ np.array([0.6, 0.8]) / 1.4
    assert box[1] == pytest.approx(above, abs=1e-8)


@pytest.mark.parametrize("load", [THREE, {"kind": "oscillator", "mass": 40.0, "stiffness": 1e4},
                                  {"kind": "trolley", "mass": 10.0, "payload": {"mass": 30.0, "length": 2.0}}],
                         ids=["three axles", "oscillator", "trolley"])  # fmt: skip
def test_what_stands_before_a_sheave_stands_as_on_a_rope_of_its_own(load: Tree) -> None:
    both = over(load, 5.0, FAST)
    alone = span_alone(load, 5.0, float(both["sheave_station"].values[0, 0]))
    for name, size in (("contact_force", 0.05), ("body_position", 1e-4), ("contact_position", 1e-4)):
        assert both[name].values == pytest.approx(alone[name].values, abs=size)
    stored = [float(found["energy"].sel(form="load_potential").values[0]) for found in (both, alone)]
    assert stored[0] == pytest.approx(stored[1], abs=0.1)


def test_a_vehicle_goes_slowly_up_to_a_sheave() -> None:
    rope = {
        "start": [0.0, 0.0], "end": [19.0, -1.0], "length": 20.1, "mass": 1.0, "axial_stiffness": 1e5, "elements": 60,
        "sheaves": {"tower": {"at": TOP, "friction": 0.05}},
    }  # fmt: skip
    tree = {
        "lines": {"rope": rope}, "loads": {"car": {**CAR, "on": "rope", "travel": {"speed": 1.0, "from": 8.0}}},
        "run": {"kind": "quasistatic", "positions": 9},
    }  # fmt: skip
    found = simulate(Scenario.model_validate(tree))
    assert "reached a sheave" in found.attrs["advice"]
    assert found.sizes["load_path"] > 1
    front = 9.81 * (8.0 + 60.0 * 0.6 / 1.4)
    assert found["contact_force"].values[:, 0, 1] == pytest.approx(-front, abs=1e-6)
    assert np.diff(found["body_position"].values[:, 0, 0]).min() > 0.3
