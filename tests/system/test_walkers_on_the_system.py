"""Walkers on lines in calm air and on joined lines: firm ground, the same on ropes, and the accounts.

Sources: the spring-mass gait on firm ground (`ropewalk.theory.gait`); the engine of ropes, which bears feet otherwise
(`solve/carrier.py`, `mechanics/vehicles.py`); conservation of momentum and energy.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from closed_forms import spring_legs
from gait_cases import GAIT, LEGS
from motion_cases import order
from ropewalk.capabilities import ROPES, SYSTEM, engine_of
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

# Hardly moves: the ground of tests/solve/test_walkers.py.
GROUND = {"start": (0, 0), "end": (10, 0), "tension": 1e9, "mass": 1000.0, "axial_stiffness": 1e12, "elements": 20}
DECK = {
    "start": [0, 0], "end": [20, 0], "tension": 160e3, "mass": 100.0, "axial_stiffness": 1e8, "axial_damping": 1e4,
}  # fmt: skip
WALKER: dict[str, Any] = {"kind": "walker", "speed": GAIT.speed, "from": 5.0}
SPRUNG = {"foot_mass": 1.0, "leg_damping": 100.0}
CALM = {"wind": {"direction": [1, 0], "speed": 0.0}}


def goes(load: dict[str, Any], lines: dict[str, Any], until: float, every: float, **more: Any) -> xr.Dataset:
    run = {"kind": "dynamic", "until": until, "every": every, **more.pop("run", {})}
    scenario = Scenario.model_validate({"lines": lines, "loads": {"her": {"on": "deck", **load}}, "run": run, **more})
    assert engine_of(scenario) is (SYSTEM if more else ROPES)
    return simulate(scenario)


def in_air(load: dict[str, Any], deck: dict[str, Any], until: float, every: float, **run: Any) -> xr.Dataset:
    """On a line that hardly feels the air, which is calm."""
    return goes(load, {"deck": {**deck, "wind_drag": 1e-9}}, until, every, run=run, **CALM)


def form(result: xr.Dataset, name: str) -> np.ndarray:
    return np.asarray(result.energy.sel(form=name).values)


def place(result: xr.Dataset) -> np.ndarray:
    return np.asarray(result.body_position.values[:, 0])


@pytest.fixture(scope="module")
def on_ground() -> xr.Dataset:
    return in_air({**WALKER, "from": 3.0}, GROUND, 1.3, 0.01)


def test_on_firm_ground_the_walker_is_the_spring_mass_gait(on_ground: xr.Dataset) -> None:
    exact = spring_legs.walk(on_ground.time.values, LEGS, height=GAIT.height, speed=GAIT.speed)
    body = place(on_ground) - [place(on_ground)[0, 0], 0.0]
    assert body[:, 0] == pytest.approx(exact.x, abs=5e-5)  # twice what was seen, in two steps
    assert body[:, 1] == pytest.approx(exact.y, abs=3e-4)  # the line gives way by 0.3 mm
    assert np.abs(form(on_ground, "drive_work")).max() < 0.05  # J: nothing to make up for
    rounding = np.finfo(float).eps * np.abs(form(on_ground, "elastic")).max()
    assert np.abs(form(on_ground, "imbalance")).max() < 1e-6 + 64.0 * rounding  # a sum over links, in many steps


def test_when_a_foot_lands_is_found_whatever_the_step(on_ground: xr.Dataset) -> None:
    """Where a foot lands, at 0.2 s, is found to 3e-10 of its leg; nothing else depends on the step on firm ground."""
    step = float(on_ground.attrs["step"])
    walks = [place(in_air({**WALKER, "from": 3.0}, GROUND, 0.3, 0.3, step=part * step)) for part in (1, 0.5, 0.25)]
    moved = [float(np.abs(coarse - walks[-1])[-1].max()) for coarse in walks[:-1]]
    assert max(moved) < 3e-10  # m


@pytest.mark.parametrize("feet", [{}, SPRUNG], ids=["weightless feet", "heavy feet on damped legs"])
def test_a_deck_in_calm_air_bears_her_as_a_rope_does(feet: dict[str, Any]) -> None:
    """Two feet are put down and one is taken up until 0.6 s; what ropes miss goes down with the second order."""
    away, elements = [], [20, 40, 80]
    for n in elements:
        rope = goes({**WALKER, **feet}, {"deck": {**DECK, "elements": n}}, 0.6, 0.02)
        calm = in_air({**WALKER, **feet}, {**DECK, "elements": n}, 0.6, 0.02)
        assert calm.attrs["outcome"] == rope.attrs["outcome"] == "completed"
        assert np.abs(form(calm, "imbalance")).max() < 0.1 * np.abs(form(rope, "imbalance")).max()
        away.append(float(np.abs(place(calm) - place(rope)).max()))
        if n == 80:
            pressed = [np.nansum(run.contact_force.values[:, :, 1], axis=1) for run in (calm, rope)]
            # In most frames; a rope rings where a foot has just landed or taken off.
            assert np.median(np.abs(pressed[0] - pressed[1])) < 3.0  # N
    assert away[-1] < 3e-4  # m, twice what was seen
    assert 2.1 < order([1.0 / n for n in elements], away) < 2.8


def test_joints_that_she_passes_are_felt_no_more_than_what_is_joined_there() -> None:
    """A hanger of next to nothing ends in the middle of the deck, which is two runs of nodes then."""
    hanger = {
        "start": [7, 8], "end": [7, 0], "length": 8.5, "mass": 1e-4, "axial_stiffness": 1.0, "elements": 4,
        "end_support": {"kind": "joined", "to": "deck", "at": 7.0},
    }  # fmt: skip
    deck, walker = {**DECK, "elements": 80}, {**WALKER, **SPRUNG, "from": 6.2}
    bare = in_air(walker, deck, 1.0, 0.05)
    deck = {**deck, "tension": None, "length": float(bare.xi.values.max())}
    hung = goes(walker, {"deck": deck, "hanger": hanger}, 1.0, 0.05, joints={})
    assert hung.attrs["outcome"] == "completed"
    assert place(hung)[-1, 0] > 7.0
    assert place(hung) == pytest.approx(place(bare), abs=1.5e-4)  # what another mesh makes of it


@pytest.fixture(scope="module")
def bridge() -> xr.Dataset:
    """A deck with bending stiffness that hangs from a cable by three hangers, and she on it."""
    cable = {
        "start": [0, 3], "end": [20, 3], "length": 20.3, "mass": 10.0, "axial_stiffness": 1e8, "elements": 40,
        "axial_damping": 2e3,
    }  # fmt: skip
    hangers = {
        f"hanger{i}": {
            "start": [5.0 * i, 1.2], "end": [5.0 * i, 0], "length": 2.0, "mass": 0.5, "axial_stiffness": 1e7,
            "elements": 4, "start_support": {"kind": "joined", "to": "cable", "at": 20.3 * i / 4},
            "end_support": {"kind": "joined", "to": "deck", "at": 5.0 * i},
        }
        for i in (1, 2, 3)
    }  # fmt: skip
    deck = {
        "start": [0, 0], "end": [20, 0], "length": 20.0, "mass": 100.0, "axial_stiffness": 1e8, "elements": 40,
        "bending_stiffness": 1e6, "axial_damping": 1e4,
    }  # fmt: skip
    walker = {**WALKER, **SPRUNG, "from": 4.0}
    return goes(walker, {"deck": deck, "cable": cable, **hangers}, 2.0, 0.005, joints={})


def test_she_walks_over_a_bridge_that_hangs_from_a_cable(bridge: xr.Dataset) -> None:
    assert bridge.attrs["outcome"] == "completed"
    assert place(bridge)[-1, 0] > 5.0  # beyond the first hanger
    landed = np.diff(np.isfinite(bridge.contact_xi.values) * 1, axis=0) == 1
    assert landed.sum() >= 3
    turned = np.abs(form(bridge, "load_kinetic")).max() + np.abs(form(bridge, "drive_work")).max()
    assert np.abs(form(bridge, "imbalance")).max() < 1e-3 * turned


def test_what_presses_on_the_bridge_moves_her(bridge: xr.Dataset) -> None:
    """What presses on the deck less the weight of feet pushes her, but for what moves the feet themselves."""
    t = bridge.time.values
    force = np.nan_to_num(bridge.contact_force.values).sum(axis=1)
    body = 80.0 * (bridge.body_velocity.values[:, 0] - bridge.body_velocity.values[0, 0])
    weight = np.array([0.0, -80.0 * 9.81])
    on = np.isfinite(bridge.contact_xi.values)
    carried = 1.0 * on.sum(axis=1)  # kg of feet that stand
    given = weight - force - np.outer(carried, [0.0, 9.81])
    impulse = np.cumsum(0.5 * (given[1:] + given[:-1]) * np.diff(t)[:, None], axis=0)
    # Trapezoids of 5 ms over forces that begin and end between them: 1 N s of 800 N s a second.
    assert body[1:] == pytest.approx(impulse, abs=12.0)


@pytest.mark.parametrize("at_end", ["leave", "stay", "refuse"])
def test_she_steps_off_stays_or_is_refused(at_end: str) -> None:
    walker = {**WALKER, **SPRUNG, "from": 18.5, "at_end": at_end}
    result = in_air(walker, {**DECK, "elements": 20}, 2.0, 0.1)
    assert result.attrs["outcome"] == ("travel ended" if at_end == "refuse" else "completed")
    if at_end == "refuse":
        assert 0.5 <= result.time.values[-1] < 2.0
        assert "at_end" in result.attrs["advice"]
        return
    assert np.isnan(result.contact_xi.values[-1]).all() == (at_end == "leave")
    velocity = result.body_velocity.values[-1, 0]
    assert velocity[0] == pytest.approx(0.0, abs=1e-12)
    assert (abs(velocity[1]) < 1e-12) == (at_end == "leave")  # who stays goes up and down on her legs
    moved = np.abs(form(result, "load_kinetic")).max()
    assert np.abs(form(result, "imbalance")).max() < 1e-3 * moved


def test_a_walker_that_falls_ends_the_run_with_advice() -> None:
    webbing = {"start": [0, 0], "end": [40, 0], "tension": 1500.0, "mass": 0.07, "axial_stiffness": 55e3, "drag": 20.0}
    load = {**WALKER, "from": 8.0, "angle_of_attack": "85 deg", "leg_stiffness": 3000.0}
    result = in_air(load, {**webbing, "elements": 50}, 5.0, 0.05)
    assert result.attrs["outcome"] == "load failed"
    assert "has fallen" in result.attrs["advice"]
    assert 1 < result.sizes["time"] < 50
    assert np.isfinite(result.position.values).all()


def test_she_balances_to_the_side_as_on_a_rope() -> None:
    balance = {**WALKER, "balance": {"height": 1.17, "width": 0.0157}}
    rope = goes(balance, {"deck": {**DECK, "elements": 40}}, 0.6, 0.02)
    calm = in_air(balance, {**DECK, "elements": 40}, 0.6, 0.02)
    plane = in_air(WALKER, {**DECK, "elements": 40}, 0.6, 0.02)
    side = [run.body_position.sel(axis="y").values for run in (calm, rope)]
    assert np.ptp(side[0]) > 0.015  # m
    assert side[0] == pytest.approx(side[1], abs=1e-4)
    assert place(calm)[:, [0, 2]] == pytest.approx(place(plane), abs=1e-5)  # what is across acts across
    assert np.abs(form(calm, "imbalance")).max() < 0.02  # J of 50 J
