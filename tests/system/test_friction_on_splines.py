"""Friction and hold forces of loads that stand on networks, stiff lines and lines in calm air.

Sources: the rest of one elastic rope under a load with a place of its own, `solve/hold_forces.py`, whose tests hold it
to closed forms; the capstan equation; the derivative of the energy by the place of the load.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.capabilities import ROPES, SYSTEM, engine_of
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

ROPE = {"start": [0, 0], "end": [30, 2], "length": 31.0, "mass": 0.5, "axial_stiffness": 1e6}
SLOWLY = {"kind": "quasistatic", "positions": 4}
CONTACTS: dict[str, dict[str, Any]] = {
    "frictionless": {"contact": "frictionless"},
    "coulomb": {"contact": "coulomb", "friction": 0.2},
    "dragged": {"contact": "dragged", "friction": 0.2},
    "dragged block": {"contact": "dragged", "friction": 0.2, "friction_model": "block"},
}
W = 800.0


def load(contact: dict[str, Any], **travel: Any) -> dict[str, Any]:
    force = {"kind": "force", "on": "r", "force": [0, -W], "travel": {"speed": 1.0, "from": 4.0, **travel}, **contact}
    return {key: value for key, value in force.items() if value is not None}


def scenario(pressed: dict[str, Any], run: dict[str, Any] = SLOWLY, *, calm: bool, **line: Any) -> Scenario:
    own = {**ROPE, **line, **({"wind_drag": 1e-9} if calm else {})}
    air = {"wind": {"direction": [1, 0], "speed": 0.0}} if calm else {}
    return Scenario.model_validate({"lines": {"r": own}, "loads": {"p": load(pressed)}, "run": run, **air})


def hold(result: xr.Dataset) -> np.ndarray:
    return np.asarray(result.hold_force.values[:-1, 0, 0])  # at the end the support holds it


@pytest.mark.parametrize("contact", CONTACTS.values(), ids=CONTACTS)
def test_a_load_is_held_as_on_a_rope_that_is_divided_at_it(contact: dict[str, Any]) -> None:
    """The force turns the rope by up to a right angle; a spline rounds that, to 2 N of 475 whatever the mesh."""
    plain, calm = scenario(contact, calm=False, elements=640), scenario(contact, calm=True, elements=80)
    assert engine_of(plain) is ROPES
    assert engine_of(calm) is SYSTEM
    exact, found = simulate(plain), simulate(calm)
    assert hold(found) == pytest.approx(hold(exact), abs=2.0)
    needed = found.contact_friction.values[:, 0]
    assert needed == pytest.approx(exact.contact_friction.values[:, 0], abs=1e-3)
    assert (
        ("slips" in found.attrs["warnings"])
        == ("slips" in exact.attrs["warnings"])
        == (contact["contact"] == "coulomb")
    )
    assert found.contact_position.values == pytest.approx(exact.contact_position.values, abs=0.02)  # of 3 m


def test_a_mass_without_friction_is_held_as_its_weight_is() -> None:
    mass = {"kind": "mass", "force": None, "mass": W / 9.81, "contact": "frictionless"}
    force, restrained = (
        hold(simulate(scenario(own, calm=True, elements=40))) for own in (CONTACTS["frictionless"], mass)
    )
    assert np.abs(restrained).max() > 100.0
    assert restrained == pytest.approx(force, abs=1e-6 * W)


def test_whether_friction_is_enough_is_asked_at_rest_and_in_motion() -> None:
    found = simulate(scenario({"friction": 0.1}, calm=True, elements=40))
    assert "needs a friction coefficient of 0.26" in found.attrs["warnings"]
    assert "suffice" not in simulate(scenario({"friction": 3.0}, calm=True, elements=40)).attrs["warnings"]
    run = {"kind": "dynamic", "until": 0.1, "every": 0.05}
    moving = simulate(scenario({"friction": 0.1}, run, calm=True, elements=40)).attrs["warnings"]
    assert moving.count("more than the given 0.1") == 1


@pytest.mark.parametrize("stiffness", [1.0, 300.0])
def test_the_hold_force_is_the_slope_of_the_energy(stiffness: float) -> None:
    """Without friction nothing but the hold force moves a load along a stiff line: dE + W dz = H dx."""

    def rest(place: float) -> tuple[float, float, float]:
        own = {**ROPE, "elements": 40, "bending_stiffness": stiffness}
        pressed = {"p": load(CONTACTS["frictionless"], **{"from": place})}
        asked = Scenario.model_validate({"lines": {"r": own}, "loads": pressed, "run": {"kind": "equilibrium"}})
        assert engine_of(asked) is SYSTEM
        found = simulate(asked).isel(load_path=0)
        x, z = found.contact_position.values[0]
        return float(found.energy.sum()) + W * z, x, float(found.hold_force.values[0, 0])

    before, here, behind = (rest(9.0 + d) for d in (-1e-3, 0.0, 1e-3))
    slope = (behind[0] - before[0]) / (behind[1] - before[1])
    assert here[2] == pytest.approx(slope, abs=1e-3 * W)  # differences of energies over 2 mm


def test_two_loads_on_joined_lines_hold_each_other() -> None:
    """One line cut in two where nothing else is: holds and coefficients are those of the whole."""
    own = {**ROPE, "elements": 62, "wind_drag": 1e-9}
    half = {**own, "length": 15.5, "elements": 31}
    cut = {
        "r": {**half, "end": [15, -3]},
        "s": {**half, "start": [15, -3], "start_support": {"kind": "joined", "to": "k"}},
    }
    cut["r"]["end_support"] = {"kind": "joined", "to": "k"}
    air = {"wind": {"direction": [1, 0], "speed": 0.0}, "run": {"kind": "equilibrium"}}
    contact = {"contact": "coulomb", "friction": 0.13}
    pair = {"p": load(contact), "q": load({"contact": "coulomb", "friction": 0.1}, **{"from": 7.0})}
    whole = simulate(Scenario.model_validate({"lines": {"r": own}, "loads": pair, **air}))
    joined = simulate(Scenario.model_validate({"lines": cut, "joints": {"k": {}}, "loads": pair, **air}))
    assert whole.hold_force.values[0, 0, 0] != 0.0
    assert joined.hold_force.values == pytest.approx(whole.hold_force.values, abs=1.0)
    assert joined.contact_friction.values == pytest.approx(whole.contact_friction.values, abs=2e-3)
