"""Trolleys: pendulums below a firm line, held or free, tethers that go slack, and the audit on a rope."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.special import ellipk

from ropewalk.model import Dynamic, Line, Scenario, Trolley
from ropewalk.scenario import loads
from ropewalk.simulate import simulate

GRAVITY, LENGTH, PAYLOAD = 9.81, 2.0, 100.0
FIRM = {"start": (0, 0), "end": (10, 0), "tension": 1e8, "mass": 1e3, "axial_stiffness": 1e10, "elements": 11}
ROPE = {"start": (0, 0), "end": (40, -2), "length": 40.1, "mass": 1.0, "axial_stiffness": 1e6}
MIDDLE = 5.0 / 1.01  # m, unstrained; in the middle of a link, and where the line is level
RESTRAINED = {"speed": 0.0, "from": MIDDLE}


def hangs(line: dict[str, Any], travel: dict[str, Any], until: float, mass: float = 2e3, **payload: Any) -> xr.Dataset:
    """A payload of 100 kg on a rope of 2 m below a trolley."""
    load = {"on": "rope", "mass": mass, "payload": {"mass": PAYLOAD, "length": LENGTH, **payload}, "travel": travel}
    run = Dynamic(until=until, every=0.01, start={"with_loads": True})
    lines = {"rope": Line.model_validate(line)}
    return simulate(Scenario(lines=lines, loads={"crab": Trolley.model_validate(load)}, run=run))


def period(result: xr.Dataset) -> float:
    """Of the payload relative to the trolley, between passages from right to left, linear between outputs."""
    x = (result.body_position.sel(axis="x").isel(body=0) - result.contact_position.sel(axis="x").isel(contact=0)).values
    t, i = result.time.values, np.flatnonzero((x[:-1] > 0.0) & (x[1:] <= 0.0))
    return float(np.diff(t[i] + (t[i + 1] - t[i]) * x[i] / (x[i] - x[i + 1])).mean())


def form(result: xr.Dataset, name: str) -> np.ndarray:
    return np.asarray(result.energy.sel(form=name).values)


@pytest.mark.parametrize("swing", [0.02, 1.2])
def test_a_payload_below_a_held_trolley_swings_as_a_pendulum(swing: float) -> None:
    result = hangs(FIRM, RESTRAINED, 6.0, stiffness=1e7, swing=swing)
    exact = 4.0 * np.sqrt(LENGTH / GRAVITY) * ellipk(np.sin(0.5 * swing) ** 2)
    assert period(result) == pytest.approx(exact, rel=2e-4)  # the rope gives by 0.1 mm, wide swings pull it thrice
    if swing < 0.1:
        assert period(result) == pytest.approx(2.0 * np.pi * np.sqrt(LENGTH / GRAVITY), rel=2e-4)
    assert np.abs(form(result, "imbalance")).max() < 1e-3  # J of 1250 J
    assert np.abs(result.contact_position.sel(axis="z").values).max() < 5e-3


def test_a_free_trolley_and_its_payload_swing_about_their_centre_of_mass() -> None:
    mass, swing = 300.0, 0.05
    result = hangs(FIRM, {"kind": "free", "from": MIDDLE}, 6.0, mass, stiffness=1e7, swing=swing)
    exact = 2.0 * np.pi * np.sqrt(LENGTH * mass / (GRAVITY * (mass + PAYLOAD)))
    assert period(result) == pytest.approx(exact, rel=1e-3)  # the swing of 0.05 rad lengthens it by 2e-4, the sag more
    crab, payload = result.contact_position.values[:, 0, 0], result.body_position.values[:, 0, 0]
    centre = (mass * crab + PAYLOAD * payload) / (mass + PAYLOAD)
    assert np.ptp(crab) > 0.04  # m
    assert np.ptp(centre) < 0.02 * np.ptp(crab)  # momentum along x is kept
    assert np.abs(form(result, "imbalance")).max() < 1e-3


def test_a_slack_tether_lets_its_payload_fall_and_catches_it() -> None:
    stiffness, drop = 2e4, 1.5
    result = hangs(FIRM, RESTRAINED, 1.0, stiffness=stiffness, at=(0.0, drop - LENGTH))
    t, z = result.time.values, (result.body_position.values - result.contact_position.values)[:, 0, 1]
    falls = np.sqrt(2.0 * drop / GRAVITY)
    free = t < falls
    assert z[free] == pytest.approx(drop - LENGTH - 0.5 * GRAVITY * t[free] ** 2, abs=5e-3)  # the trolley sags by 3 mm
    rest = PAYLOAD * GRAVITY / stiffness
    deepest = rest + np.sqrt(rest**2 + 2.0 * rest * drop)
    assert -z.min() - LENGTH == pytest.approx(deepest, rel=5e-3)  # seen every 10 ms
    # Momentum: what the tether takes from the payload, the line has to bear, beside the trolley.
    speed = result.body_velocity.values[:, 0, 1]
    borne = -np.trapezoid(result.contact_force.values[:, 0, 1], t) - 2e3 * GRAVITY * t[-1]
    assert borne == pytest.approx(PAYLOAD * (GRAVITY * t[-1] + speed[-1]), rel=0.04)  # 10 ms between outputs
    assert np.abs(form(result, "imbalance")).max() < 0.01  # J of 1500 J


def test_a_damped_tether_accounts_for_all_that_it_takes() -> None:
    """Also where the damper is stronger than the spring, and the tether is slack before the spring is."""
    result = hangs(FIRM, RESTRAINED, 3.0, stiffness=2e4, damping=600.0, at=(0.0, -0.5))
    assert form(result, "load_damping")[-1] > 1000.0  # J
    # A catch begins with a blow, at a time that is known to a step: 1 in 1000.
    assert np.abs(form(result, "imbalance")).max() < 2.0


def test_the_audit_of_a_free_trolley_on_a_rope_closes_with_the_mesh() -> None:
    missed = []
    for n in (40, 80, 160):
        more = {"stiffness": 2e4, "damping": 300.0, "swing": 0.5, "air_drag": 0.5}
        result = hangs({**ROPE, "elements": n}, {"kind": "free", "from": 5.0, "speed": 3.0}, 4.0, 30.0, **more)
        missed.append(float(np.abs(form(result, "imbalance")).max()))
    print(missed)
    assert missed[2] < 0.5 * missed[0]
    assert missed[2] < 2e-3 * np.ptp(form(result, "load_potential"))


def test_a_damped_tether_on_an_undamped_line_does_not_care_how_often_one_looks() -> None:
    # The damper once saw velocities of the last output: forces were ten times too large, the more the rarer it was.
    def largest_force(every: float) -> float:
        result = simulate(
            loads(
                f"""
lines:
  rope: {{start: [0, 0], end: [20, 0], tension: 2 kN, mass: 0.1, axial_stiffness: 100 kN, elements: 40}}
loads:
  cart:
    kind: trolley
    on: rope
    mass: 0.05 kg
    payload: {{mass: 50, length: 1, stiffness: 20 kN/m, damping: 300, swing: 20 deg}}
    travel: {{speed: 0, from: 7}}
run: {{kind: dynamic, until: 1 s, every: {every}}}
"""
            )
        )
        return float(np.abs(result.contact_force.sel(time=slice(0.1, 1.0), axis="z")[:: round(0.1 / every)]).max())

    assert largest_force(0.1) == pytest.approx(largest_force(0.002), rel=0.02)


def test_a_damped_tether_knows_how_fast_its_trolley_is_on_a_line_without_damping_too() -> None:
    # Its damper once saw that line half a step ago: with a light trolley the payload came 1.4 mm beside its place.
    def payload(damping: float) -> np.ndarray:
        line = {**ROPE, "elements": 40, "axial_damping": damping}
        result = hangs(line, {"speed": 5.0, "from": 10.0}, 2.0, 0.05, stiffness=2e4, damping=600.0, swing=0.3)
        return np.asarray(result.body_position.values[:, 0])

    assert np.abs(payload(0.0) - payload(1e-6)).max() < 1e-6  # m; what so little damping does is far below
