"""Friction and hold forces of prescribed travel in motion, on everything that the system moves.

Sources: a load that has come to its place slowly is held as at rest by `solve/hold_forces.py`; the capstan equation,
T2/T1 = exp(mu angle); a mass without friction on one rope by the engine of ropes; the energy audit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.capabilities import ROPES, SYSTEM, engine_of
from ropewalk.errors import ScenarioError
from ropewalk.model import Scenario
from ropewalk.results.frame import ENERGY_FORMS
from ropewalk.simulate import simulate, spectrum_of
from system_cases import frames_of, imbalance

ROPE = {"start": [0, 0], "end": [30, 2], "length": 31.0, "mass": 0.5, "axial_stiffness": 1e5, "elements": 60}
W, RAMP = 800.0, {"time": [0.0, 1.0], "value": [[0.0, 0.0], [0.0, -800.0]]}
CONTACTS: dict[str, dict[str, Any]] = {
    "coulomb": {"contact": "coulomb", "friction": 0.1},
    "dragged": {"contact": "dragged", "friction": 0.2},
    "dragged back": {"contact": "dragged", "friction": 0.2, "speed": -0.02},
    "dragged block": {"contact": "dragged", "friction": 0.2, "friction_model": "block"},
}


def asked(load: dict[str, Any], run: dict[str, Any], calm: bool = False, **line: Any) -> Scenario:
    speed = load.pop("speed", 0.02)
    own = {"kind": "force", "force": [0, -W], "on": "r", "travel": {"speed": speed, "from": 8.0}} | load
    rope = {**ROPE, **line, **({"wind_drag": 1e-9} if calm else {})}
    air = {"wind": {"direction": [1, 0], "speed": 0.0}} if calm else {}
    return Scenario.model_validate({"gravity": 9.81, "lines": {"r": rope}, "loads": {"p": own}, "run": run, **air})


def moved(until: float, **keys: Any) -> dict[str, Any]:
    return {"kind": "dynamic", "until": until, "every": until / 10.0} | keys


@pytest.mark.parametrize("contact", CONTACTS.values(), ids=CONTACTS)
def test_what_has_come_slowly_is_held_as_at_rest_and_its_tensions_are_a_capstans(contact: dict[str, Any]) -> None:
    """3 s of damping of 8/s leave 1e-3; a spline rounds what the force turns by 70 degrees, to 1 % of the force."""
    slow = asked({**contact, "force": RAMP}, moved(4.0), drag=8.0, axial_damping=300.0)
    assert engine_of(slow) is SYSTEM
    found = simulate(slow).isel(time=-1)
    place = 8.0 + 4.0 * contact.get("speed", 0.02)
    there = asked({**contact, "travel": {"speed": contact.get("speed", 0.02), "from": place}}, {"kind": "equilibrium"})
    there = there.model_copy(update={"lines": {"r": there.lines["r"].model_copy(update={"elements": 480})}})
    assert engine_of(there) is ROPES
    exact = simulate(there).isel(load_path=0)
    print(found.hold_force.values, exact.hold_force.values)
    assert float(found.hold_force[0, 0]) == pytest.approx(float(exact.hold_force[0, 0]), abs=0.01 * W)
    assert float(found.contact_friction[0]) == pytest.approx(contact["friction"], rel=0.02)
    if contact.get("friction_model") == "block":
        return
    r, T, k = found.position.values, found.tension.values, int(place / (31.0 / 60))
    before, after = r[k - 1] - r[k - 3], r[k + 4] - r[k + 2]
    angle = np.arccos(before @ after / np.linalg.norm(before) / np.linalg.norm(after))
    ratio = T[k - 2] / T[k + 2]  # the line is dragged along, and so it would be by what slips back
    print(ratio, np.exp(contact["friction"] * angle))
    assert abs(np.log(ratio)) == pytest.approx(
        contact["friction"] * angle, abs=0.008
    )  # 1 m of line up weighs 0.7 % of T
    assert ratio > 1.0 or contact["speed"] < 0.0


def test_friction_that_suffices_holds_and_what_rubs_closes_its_audit_as_what_does_not() -> None:
    loose, until = {"axial_damping": 50.0, "drag": 0.5}, 0.4
    restrained, still = (
        simulate(asked({**contact, "force": RAMP, "speed": 2.0}, moved(until), calm=True, **loose))
        for contact in ({"contact": "coulomb", "friction": 9.0}, {})
    )
    assert restrained.position.values == pytest.approx(still.position.values, abs=1e-6)  # kinks are found to 1e-9
    assert (restrained.hold_force == 0.0).all()
    runs = [
        frames_of(asked({**contact, "force": RAMP, "speed": 2.0}, moved(until), calm=True, **loose))
        for contact in ({}, CONTACTS["dragged"])
    ]
    assert imbalance(runs[1]) < 1.2 * imbalance(runs[0])  # kinks that begin with nothing miss 4e-5, whatever the step
    assert imbalance(runs[1]) < 1e-4
    rubbed = [frame.energy[ENERGY_FORMS.index("friction")] for frame in runs[-1]]
    assert (np.diff(rubbed) > 0.0).all()


def test_a_mass_without_friction_is_held_as_on_a_rope_that_is_divided_at_it() -> None:
    """Set down suddenly on a damped rope: path to 1 % of a metre, as links of half a metre are."""
    keys = {"kind": "mass", "mass": 80.0, "contact": "frictionless", "speed": 2.0, "force": [0, 0]}
    loose = {"axial_damping": 50.0, "length": 30.4}
    plain, calm = (asked(dict(keys), moved(1.0, every=0.002), calm=calm, **loose) for calm in (False, True))
    assert engine_of(plain) is ROPES
    assert engine_of(calm) is SYSTEM
    exact, found = simulate(plain), simulate(calm)
    print(np.abs(found.contact_position - exact.contact_position).max().item())
    assert found.contact_position.values == pytest.approx(exact.contact_position.values, abs=0.01)
    assert np.ptp(found.contact_position.values[:, 0, 1]) > 1.0
    restrained, right = (one.hold_force.values[5:, 0, 0] for one in (found, exact))
    print(restrained.mean(), right.mean(), restrained.std(), right.std())
    assert restrained.mean() == pytest.approx(right.mean(), rel=0.03)  # measured 1.1 %
    assert restrained.std() == pytest.approx(right.std(), rel=0.15)  # 9 %: at instants they differ as contact forces do
    assert np.abs(found.contact_friction.values[2:]).max() < 1e-3
    steps = [3e-4, 1.5e-4, 7.5e-5]
    runs = [frames_of(asked(dict(keys), moved(0.5, step=step), calm=True, **loose)) for step in steps]
    missed = [imbalance(frames) for frames in runs]
    print(missed)
    assert missed[0] < 5e-6  # kinks are found to 1e-9: orders from 1.3 on
    assert missed[2] < 0.4 * missed[0]


def test_a_motion_does_not_begin_at_rest_with_what_rubs() -> None:
    with pytest.raises(ValueError, match=r"rest with a contact of kind dragged is not implemented"):
        asked({**CONTACTS["dragged"]}, moved(0.1, start={"with_loads": True}))


def test_a_spectrum_at_an_instant_does_not_leave_out_what_moved_otherwise() -> None:
    with pytest.raises(ScenarioError, match="contact: is not implemented for the spectrum at an instant"):
        spectrum_of(asked({**CONTACTS["dragged"]}, moved(0.1)), at=0.05)
    with pytest.raises(ScenarioError, match="axial_inertia: is not implemented for the spectrum at an instant"):
        spectrum_of(asked({}, moved(0.1, axial_inertia=4.0), calm=True), at=0.05)
