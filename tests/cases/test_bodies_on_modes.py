"""Bodies on modes: contact forces do not depend on output instants, and long computations are foreseen."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from ropewalk.effort import foreseen
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

NET = {"kind": "net", "corner": [0, 0, 0], "sides": [[4, 0, 0], [0, 3, 0]], "cells": [4, 3], "axial_stiffness": 1e3,
       "mass": 0.5, "tension": 100.0}  # fmt: skip
ROPE = {"start": [0, 0], "end": [20, 0], "length": 20.3, "mass": 1.0, "axial_stiffness": 1e5, "elements": 10}
OSCILLATOR: dict[str, Any] = {"kind": "oscillator", "on": "a", "mass": 5.0, "wheel_mass": 1.0, "stiffness": 2e3,
                              "damping": 5.0}  # fmt: skip


def scenario(name: str, every: float, **run: Any) -> Scenario:
    travel = {"speed": 0.01, "from": 1.2, "at_end": "leave"}
    structure: dict[str, Any] = {"lines": {"a": ROPE}}
    if name == "net":
        structure, travel = {"nets": {"a": NET}}, {**travel, "path": [[0.5, 1.5], [3.5, 1.5]]}
    how = {"kind": "linear", "until": 1.0, "every": every, **run}
    return Scenario.model_validate({**structure, "loads": {"w": {**OSCILLATOR, "travel": travel}}, "run": how})


@pytest.mark.parametrize("name", ["net", "rope"])
def test_contact_forces_do_not_depend_on_the_interval_of_output(name: str) -> None:
    few, many = (simulate(scenario(name, every)) for every in (1.0, 0.05))
    assert few.outcome == many.outcome == "completed"
    size = float(np.nanmax(np.abs(many.contact_force.values)))
    # 1 %: half the steps may change forces by 0.1 % of the largest one.
    assert few.contact_force.values[-1] == pytest.approx(many.contact_force.values[-1], abs=1e-2 * size)
    assert few.reaction.values[-1] == pytest.approx(many.reaction.values[-1], abs=1e-2 * size)


def test_a_check_foresees_that_bodies_on_modes_take_long() -> None:
    assert any("geometry: linearised" in one for one in foreseen(scenario("rope", 0.1))[1])
    other = scenario("rope", 0.1, kind="dynamic", geometry="linearised")
    assert not any("geometry: linearised" in one for one in foreseen(other)[1])


BED: dict[str, Any] = {
    "start": [0, 0], "end": [20, 0], "length": 20, "mass": 100.0, "bending_stiffness": 2e5, "axial_stiffness": 1e8,
    "foundation": 3e7, "elements": 16,
}  # fmt: skip
HEAVY = {"kind": "vehicle", "bodies": {"box": {"mass": 3000.0}}, "wheels": {"w": {"mass": 600.0}},
         "springs": {"s": {"between": ["box", "w"], "stiffness": 1e6, "damping": 1e4}}}  # fmt: skip


def on_bed(step: float | None, **changed: Any) -> Any:
    run = {"kind": "dynamic", "geometry": "linearised", "until": 0.2, "every": 0.02} | ({"step": step} if step else {})
    load = {**HEAVY, "on": "a", "travel": {"speed": 3.0, "from": 8.0, "at_end": "leave"}}
    return simulate(Scenario.model_validate({"lines": {"a": {**BED, **changed}}, "loads": {"w": load}, "run": run}))


def test_a_heavy_wheel_begins_with_its_static_contact_force() -> None:
    soft = {"bending_stiffness": 2e6, "foundation": 1e6, "mass": 1000.0}
    long, short = (on_bed(step, **soft).contact_force.values[:, 0, -1] for step in (1e-3, 1.25e-4))
    assert short[0] == pytest.approx(-3600.0 * 9.80665, rel=1e-2)  # what the kink moves in the first step
    size = np.abs(short).max()
    assert long == pytest.approx(short, abs=0.1 * size)  # the coarse mesh rings by some percent; 35 % before


def test_steps_too_long_for_a_foundation_are_reported_and_the_remedy_helps() -> None:
    found = on_bed(None)
    warned = re.search(r"phase error of .* write run.step: (\S+) s", found.warnings)
    assert warned is not None
    better = on_bed(float(warned[1]))
    assert "phase error" not in better.warnings
    exact = on_bed(0.25 * float(warned[1]))
    missed = [
        float(np.abs(one.position.values[..., 1] - exact.position.values[..., 1]).max()) for one in (found, better)
    ]
    assert missed[1] < 0.35 * missed[0]  # of the lowest frequency; higher ones add to it
    assert "phase error" not in on_bed(None, foundation=0.0).warnings


def test_bodies_without_weight_leave_the_line_still_in_few_steps() -> None:
    """Displacements of rounding size do not converge: half the steps change them by their own size."""
    bearings = {"pier": {"at": 11.78431011498552, "kind": "guided", "along": [1, 0, 0]},
                "bearing": {"at": 17.67646517247828, "kind": "elastic", "stiffness": [0, 1e8]}}  # fmt: skip
    beam = {"start": [0, 0, 0], "end": [23.56862022997104, 0, 0], "length": 23.56862022997104, "mass": 2633.69,
            "bending_stiffness": 7.2e9, "axial_stiffness": 1e10, "elements": 10, "supports": bearings}  # fmt: skip
    springs = {name: {"between": ["box", name], "stiffness": 2e5, "damping": 1.5e3} for name in ("front", "rear")}
    wheels = {"front": {"at": 0.8, "mass": 167.0}, "rear": {"at": -0.6, "mass": 167.0}}
    car = {"kind": "vehicle", "on": "beam", "bodies": {"box": {"mass": 778.0, "inertia": 389.0}}, "wheels": wheels,
           "springs": springs, "travel": {"speed": 20.0, "from": 10.98}}  # fmt: skip
    run = {"kind": "linear", "until": 0.014, "every": 0.0017}
    found = simulate(Scenario(gravity=0, lines={"beam": beam}, loads={"car": car}, run=run))
    assert "half the steps" not in found.attrs["doubts"]
    assert np.abs(found.position.values - found.position.values[0]).max() < 1e-11  # m; of coordinates, 5e-13
    assert found.attrs["cpu_seconds"] < 2.0  # 9 halvings take twice as long each
