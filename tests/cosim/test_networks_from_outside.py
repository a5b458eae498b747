"""Joined lines, lines over sheaves and saddles, inextensible lines and nets, moved step by step from outside.

Sources: the same force as a load of the scenario; a mass on a spring as one of its bodies; going back.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ropewalk
from ropewalk.cosim import Outside, stepwise
from ropewalk.errors import ScenarioError

ROPE = {"start": [0, 0], "end": [20, 0], "mass": 1.0, "axial_stiffness": 1e5, "elements": 40}
TAUT, LOOSE = {**ROPE, "tension": 2e3}, {**ROPE, "length": 19.95}
SLACK = {"start": [0, 0], "end": [20, 1], "length": 20.4, "mass": 1.0, "law": {"kind": "inextensible"}, "elements": 24}
HANGER = {"start": [10, 4], "end": [10, 0], "length": 4.05, "mass": 0.5, "axial_stiffness": 5e5, "elements": 8,
          "end_support": {"kind": "joined", "to": "rope", "at": 9.95}}  # fmt: skip
PLACES: dict[str, dict[str, Any]] = {
    "joined": {"lines": {"rope": TAUT, "hanger": HANGER}},
    "sheave": {"lines": {"rope": {**LOOSE, "sheaves": {"tower": {"at": [12, 1], "friction": 0.05}}}}},
    "saddle": {"lines": {"rope": {**LOOSE, "saddles": {"tower": {"at": [12, 0.5], "radius": 2.0, "friction": 0.1}}}}},
    "inextensible": {"lines": {"rope": SLACK}},
    "net": {"nets": {"rope": {"kind": "net", "corner": [0, 0, 0], "sides": [[12, 0, 0], [0, 9, 0]], "cells": [12, 9],
                              "axial_stiffness": 1e4, "mass": 0.05, "tension": 100.0}}},
}  # fmt: skip
PATH, FROM, SPEED, H, STEPS = [[1.0, 4.0], [11.0, 5.0]], 3.0, 6.0, 2e-3, 60


def scenario(place: str, loads: dict[str, Any] | None = None) -> ropewalk.Scenario:
    run = {"kind": "dynamic", "until": H * STEPS, "every": H * STEPS}
    return ropewalk.Scenario.model_validate({**PLACES[place], "loads": loads or {}, "run": run})


def outside(place: str, **keys: Any) -> Outside:
    return Outside("rope", path=tuple(map(tuple, PATH)) if place == "net" else None, **keys)


def travel(place: str, speed: float = SPEED) -> dict[str, Any]:
    return {"speed": speed, "from": FROM} | ({"path": PATH} if place == "net" else {})


@pytest.mark.parametrize("place", PLACES)
def test_a_force_pressed_from_outside_does_what_a_travelling_force_does(place: str) -> None:
    down = [0.0, 0.0, -50.0] if place == "net" else [0.0, -50.0]
    motion = stepwise(scenario(place), {"c": outside(place)})
    for n in range(STEPS):
        motion.set_force("c", FROM + SPEED * n * H, tuple(down), SPEED)
        motion.step(H)
    load = {"kind": "force", "on": "rope", "force": down, "travel": travel(place)}
    result = ropewalk.simulate(scenario(place, {"c": load}))
    expected = result.contact_position.isel(time=-1, contact=0).values
    moved = np.abs(result.position.values[-1] - result.position.values[0]).max()
    # Whose steps are cut at other instants, and give way within these by as much.
    assert motion.output("c").place == pytest.approx(expected, abs=3e-3 * moved)
    forces = motion.support_forces()
    assert set(forces) == set(result.support.values.tolist())
    for k, name in enumerate(result.support.values.tolist()):
        reaction = result.reaction.values[-1, k]
        assert forces[name] == pytest.approx(reaction, abs=0.02 * np.abs(result.reaction.values[-1]).max())


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("stiffness", [0.0, 1e4])
def test_going_back_repeats_what_was(place: str, stiffness: float) -> None:
    motion = stepwise(scenario(place), {"c": outside(place, stiffness=stiffness)})
    level = motion.at("rope", FROM)[0][-1]

    def go(steps: int) -> np.ndarray:
        for n in range(steps):
            if stiffness:
                motion.set_motion("c", FROM + SPEED * n * H, level - 0.01, 0.0, SPEED)
            else:
                motion.set_force("c", FROM + SPEED * n * H, -50.0, SPEED)
            motion.step(H)
        return np.concatenate([*motion.at("rope", FROM + 1.0), motion.output("c").force])

    go(5)
    state = motion.get_state()
    once = go(10)
    motion.set_state(state)
    assert go(10) == pytest.approx(once, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("place", ["joined", "net"])
def test_a_body_on_the_spring_of_a_contact_is_one_of_the_scenario(place: str) -> None:
    """A mass on a spring whose motion somebody else finds, a step behind: the error is of the first order in these."""
    m, k = 5.0, 2e4
    body = {"kind": "oscillator", "mass": m, "stiffness": k, "on": "rope", "travel": travel(place, 0.0)}
    result = ropewalk.simulate(scenario(place, {"c": body}))
    expected = float(result.body_position.values[-1, 0, -1] - result.body_position.values[0, 0, -1])
    apart = []
    for h in (H, 0.5 * H):
        motion = stepwise(scenario(place), {"c": outside(place, stiffness=k)})
        z = begin = motion.at("rope", FROM)[0][-1] - m * 9.81 / k  # with its spring as at rest
        v, force = 0.0, -m * 9.81
        for _ in range(round(H * STEPS / h)):
            v += h * (-9.81 - force / m)
            motion.set_motion("c", FROM, z, v)
            motion.step(h)
            z += h * v
            force = float(motion.output("c").force[-1])
        apart.append(abs((z - begin) - expected) / abs(expected))
    print(apart)
    assert apart[1] < 0.01
    assert apart[1] < 0.65 * apart[0]  # 0.5, and what the net answers besides


def test_what_is_not_known_is_refused() -> None:
    with pytest.raises(ScenarioError, match="on a net it needs a path"):
        stepwise(scenario("net"), {"c": Outside("rope")})
    with pytest.raises(ScenarioError, match=r"side.*is not implemented"):
        stepwise(scenario("joined"), {"c": Outside("rope", stiffness=1e4, side="above")})
    with pytest.raises(ScenarioError, match="there is no such line"):
        stepwise(scenario("joined"), {"c": Outside("rop")})
