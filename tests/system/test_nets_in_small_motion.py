"""Nets and membranes linearised about rest.

Sources: the same motion with all geometry as the load goes to nothing; the same small motion by superposition of modes
(`kind: linear`), which a closed form of the net stands behind (`test_superposition_of_modes.py`); the sine modes of a
net under a moving force (Fryba, Vibration of Solids and Structures under Moving Loads; `ropewalk.theory.membrane`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from closed_forms import membranes
from motion_cases import order
from ropewalk.errors import ScenarioError
from ropewalk.model import Linear, Scenario
from ropewalk.results.frame import Frame, RunInfo
from ropewalk.scenario import loads
from ropewalk.simulate import output_times
from ropewalk.system.assembling.membranes import sheet_of
from ropewalk.system.small_motion.superposed import Superposed
from system_cases import frames_of, imbalance, with_steps_of

FLAT: dict[str, Any] = {"corner": [0, 0, 0], "sides": [[4, 0, 0], [0, 3, 0]], "cells": [8, 6]}
SHEETS: dict[str, dict[str, Any]] = {
    "net": {"kind": "net", **FLAT, "axial_stiffness": 1e4, "mass": 0.05, "tension": 100.0, "axial_damping": 5.0},
    "membrane": {"kind": "membrane", **FLAT, "stiffness": 1e5, "poisson": 0.3, "mass": 0.3, "tension": 500.0,
                 "damping": 20.0},
    "awning": {"kind": "membrane", "boundary": [[0, 0, 0], [4, 0, 0], [4, 3, 0], [0, 3, 0]], "spacing": 0.6,
               "stiffness": 1e5, "mass": 0.3, "tension": 500.0,
               "edge": {"kind": "cable", "axial_stiffness": 2e6, "mass": 0.5, "tension": 3e3}},
}  # fmt: skip
PATH = [[0.6, 1.3], [3.4, 1.7]]


def motion(sheet: str, load: dict[str, Any], *, geometry: str = "linearised", until: float = 0.12, **run: Any):
    """A load on a sheet under its weight."""
    load = {"on": "net", "travel": {"speed": 6.0, "from": 0.5, "path": PATH}} | load
    run = {"kind": "dynamic", "until": until, "every": until / 6.0, "geometry": geometry} | run
    return Scenario.model_validate({"gravity": 9.81, "nets": {"net": SHEETS[sheet]}, "loads": {"a": load}, "run": run})


def superposed(scenario: Scenario) -> list[Frame]:
    run = Linear(until=scenario.run.until, every=scenario.run.every)
    return list(Superposed(scenario, run, output_times(run), RunInfo()).frames())


@pytest.mark.parametrize("sheet", SHEETS)
def test_it_is_what_all_geometry_tends_to_as_the_load_vanishes(sheet: str) -> None:
    """What differs of places and of tensions goes with the square of the load."""

    def differs(size: float) -> tuple[float, float]:
        load = {"kind": "force", "force": [0.3 * size, 0.2 * size, -size]}
        small, full = (
            frames_of(motion(sheet, load, geometry=geometry, step=1e-4))[-1] for geometry in ("linearised", "nonlinear")
        )
        assert small.cell_tension is not None
        apart = np.abs(small.cell_tension - full.cell_tension).max()
        return float(np.abs(small.position - full.position).max()), float(apart)

    sizes = [4.0, 2.0, 1.0]
    places, tensions = zip(*map(differs, sizes), strict=True)
    print(places, tensions)
    assert 1.8 < order(sizes, list(places)) < 2.2
    assert 1.3 < order(sizes, list(tensions)) < 2.4  # of the cell with most, which is another one for each load


@pytest.mark.parametrize("kind", ["force", "mass"])
@pytest.mark.parametrize("sheet", SHEETS)
def test_steps_converge_to_the_superposition_of_modes(sheet: str, kind: str) -> None:
    """Up to how a stiff contact on a net gives way within a step: bounds are twice what was seen."""
    load = {"kind": "mass", "mass": 2.0} if kind == "mass" else {"kind": "force", "force": [0.0, 0.0, -20.0]}
    scenario = motion(sheet, load)
    exact = superposed(scenario)
    steps = [frames_of(with_steps_of(scenario, part)) for part in (1.0, 0.5)]

    def away(frames: list[Frame], of: str) -> float:
        return max(float(np.abs(getattr(a, of) - getattr(b, of)).max()) for a, b in zip(frames, exact, strict=True))

    moved = max(float(np.abs(frame.position - exact[0].position).max()) for frame in exact)
    errors = [away(frames, "position") / moved for frames in steps]
    pulls = [away(frames, "cell_tension") / np.abs(exact[-1].cell_tension).max() for frames in steps]
    print(errors, pulls)
    assert errors[1] < 7e-4
    assert pulls[1] < 1.4e-4
    if kind == "force" and sheet != "awning":
        assert errors[1] < 0.6 * errors[0]


@pytest.mark.parametrize("sheet", SHEETS)
def test_its_energy_audit_closes(sheet: str) -> None:
    scenario = motion(sheet, {"kind": "oscillator", "mass": 2.0, "wheel_mass": 0.3, "stiffness": 800.0, "damping": 5.0})
    missed = [imbalance(frames_of(with_steps_of(scenario, part))) for part in (1.0, 0.5)]
    print(missed)
    assert missed[1] < 2e-4
    assert missed[1] < 0.6 * missed[0]


def test_a_moving_force_drives_the_sine_modes_of_a_net() -> None:
    """Errors of the lattice are of the second order in its cells: twice what was seen."""
    errors = []
    for n in (6, 12):
        sheet = {"kind": "net", **FLAT, "cells": [n, n], "mesh": 0.2, "axial_stiffness": 1e4, "mass": 0.05,
                 "tension": 100.0}  # fmt: skip
        travel = {"path": [[0.0, 1.2], [4.0, 1.2]], "speed": 1.0}
        tree: dict[str, Any] = {"gravity": 0.0, "nets": {"net": sheet}}
        load = {"kind": "force", "on": "net", "force": [0, 0, -10.0], "travel": travel}
        run = {"kind": "dynamic", "until": 1.0, "geometry": "linearised"}
        laid = sheet_of("net", Scenario.model_validate({**tree, "loads": {"p": load}, "run": run}).nets["net"])
        weight, plan = laid.weight, laid.surface.plan
        mass = weight.sum() / 12.0
        travel["speed"] = speed = float(0.5 * np.sqrt(500.0 / mass))
        run |= {"until": 3.2 / speed, "every": 0.16 / speed}
        found = frames_of(Scenario.model_validate({**tree, "loads": {"p": load}, "run": run}))
        times, z = np.array([f.path for f in found]), np.array([f.position[:, 2] for f in found])
        shape = np.sin(np.pi * plan[:, 0] / 4.0) * np.sin(np.pi * plan[:, 1] / 3.0)
        amplitude = 4.0 * (z * shape * weight).sum(axis=1) / weight.sum()
        exact = membranes.moving_force_mode(
            1, 1, times, force=-10.0, speed=speed, track=1.2, sides=(4.0, 3.0), tension=500.0, mass=mass
        )
        errors.append(float(np.abs(amplitude - exact).max() / np.abs(exact).max()))
    print(errors)  # a force of 10 N, in all geometry 3 % stiffer
    assert errors[1] < 1e-2
    assert errors[1] < 0.4 * errors[0]


def test_a_window_is_measured_along_lines() -> None:
    text = motion("net", {"kind": "force", "force": [0, 0, -1]}).model_dump_json()
    with pytest.raises(ScenarioError, match=r"a window is measured along lines, and a net has none"):
        loads(text, "case.json", ["run.window=1 m"])
