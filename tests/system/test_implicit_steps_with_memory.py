"""Implicit methods where forces depend on what has gone before: hysteresis of links, and lines over sheaves.

Sources: Verlet's method in small steps, which is another one; the area of a loop of strain and tension.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.results.frame import ENERGY_FORMS, Frame, RunInfo
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.system.elements.inertia import tangents
from system_cases import frames_of

UNTIL = 0.5
METHODS = ["implicit", "rkn6"]


def in_steps(steps: int, method: str, **run: Any) -> dict[str, Any]:
    """A run in so many steps, whose errors are not asked for."""
    asked = {"kind": "dynamic", "until": UNTIL, "every": UNTIL, "method": method, "step": UNTIL / steps * (1 + 1e-9)}
    return asked | ({} if method == "verlet" else {"accuracy": 0.9}) | run


WEB: dict[str, Any] = {
    "start": [0, 0], "end": [1, 0], "length": 0.98, "mass": 1.0, "axial_stiffness": 10.0, "elements": 8,
    "law": {"kind": "tension_only"}, "hysteresis": {"ratio": 0.8, "stiffness": 30.0},
}  # fmt: skip
STANDS = {"on": "r", "kind": "mass", "mass": 0.3, "travel": {"speed": 0.0, "from": 0.3}}
GOES = {"on": "r", "kind": "mass", "mass": 0.3, "travel": {"speed": 0.4, "from": 0.3}}


def webbing(steps: int, method: str, load: dict[str, Any] = STANDS) -> Scenario:
    run = in_steps(steps, method)
    return Scenario.model_validate({"gravity": 1.0, "lines": {"r": WEB}, "loads": {"load": load}, "run": run})


def end_of(scenario: Scenario) -> np.ndarray:
    frames = frames_of(scenario, np.array([0.0, UNTIL]))
    return np.concatenate([frames[-1].position.ravel(), frames[-1].body_position.ravel()])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("load", [STANDS, GOES], ids=["stands", "goes"])
def test_links_with_hysteresis_move_as_by_verlets_method(method: str, load: dict[str, Any]) -> None:
    """With a sixteenth of its steps they are as near, and both are of the second order where loading turns."""
    exact = end_of(webbing(8192, "verlet", load))
    second = np.abs(end_of(webbing(512, "verlet", load)) - exact).max()
    errors = [float(np.abs(end_of(webbing(steps, method, load)) - exact).max()) for steps in (8, 32, 128)]
    order = np.log2(errors[0] / errors[2]) / 4.0
    print(f"errors {errors}, Verlet {second:.3g}, order {order:.3f}")
    assert errors[1] < 2.0 * second
    assert 1.2 < order < 4.0


@pytest.mark.parametrize("method", METHODS)
def test_what_a_cycle_loses_is_the_area_of_its_loop(method: str) -> None:
    """A light webbing pulled to and fro between two strains: corners are where q = f and where it has fallen to -f."""
    low, high, EA, k, share = 0.02, 0.06, 1e3, 6e3, 0.1
    t = np.linspace(0.0, 2.0, 101)
    u = 5.0 * (high - low) * (1.0 - np.cos(2.0 * np.pi * t))
    table = {"time": t.tolist(), "value": [[float(d), 0.0] for d in u]}
    line = {
        "start": [0.0, 0.0], "end": [10.0 * (1.0 + low), 0.0], "length": 10.0, "mass": 0.02, "elements": 2, "drag": 5.0,
        "law": {"kind": "tension_only"}, "axial_stiffness": EA, "hysteresis": {"ratio": 0.8, "stiffness": k},
        "end_support": {"kind": "moving", "displacement": table},
    }  # fmt: skip
    run = {"kind": "dynamic", "until": 2.0, "every": 0.02, "method": method, "accuracy": 1e-4}
    frames = frames_of(Scenario.model_validate({"gravity": 0.0, "lines": {"w": line}, "run": run}))
    x = np.array([high, high * (k - share * EA) / (k + share * EA), low, low * (k + share * EA) / (k - share * EA)])
    y = share * EA * x * [1.0, -1.0, -1.0, 1.0]
    area = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    lost = [frame.energy[ENERGY_FORMS.index("hysteresis")] for frame in (frames[50], frames[100])]
    missed = max(abs(frame.energy[ENERGY_FORMS.index("imbalance")]) for frame in frames)
    print((lost[1] - lost[0]) / (10.0 * area), missed / lost[1])
    assert missed < 3e-2 * lost[1]  # of corners that steps go over
    assert lost[1] - lost[0] == pytest.approx(10.0 * area, rel=2e-3)


def over(friction: float, damping: float = 0.0) -> dict[str, Any]:
    return {
        "start": [0, 0], "end": [1.2, 0.1], "length": 1.30, "mass": 1.0, "elements": 9, "axial_stiffness": 20.0,
        "axial_damping": damping, "sheaves": {"wheel": {"at": [0.5, 0.3], "friction": friction}},
        "start_support": {"kind": "guided", "along": [5.0, 3.0], "stiffness": 8.0, "mass": 0.2},
        "end_support": {"kind": "guided", "along": [7.0, -2.0], "stiffness": 8.0, "mass": 0.2},
    }  # fmt: skip


def running(steps: int, method: str, friction: float, loads: dict[str, Any] | None = None) -> tuple[Any, list[Frame]]:
    """A rope that begins to run over its sheave at 0.7 m/s, at the end; and its first and last frame."""
    tree = {"gravity": 1.0, "lines": {"r": over(friction)}, "loads": loads or {}, "run": in_steps(steps, method)}
    motion = SystemMotion(Scenario.model_validate(tree), RunInfo(), np.array([0.0, UNTIL]))
    structure, v = motion.structure, motion.state.v
    on, restrained = structure.on_runs, structure.restraints
    v[:, on] = 0.7 * tangents(structure, motion.rest)[:, on]
    for e in range(restrained.mass.size):
        v[:, restrained.members(e)] = restrained.free[e] @ v[:, restrained.members(e)]
    frames = motion.frames([motion.note_present()])
    assert motion.advance(1) is None
    return motion, [*frames, *motion.frames([motion.note_present()])]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_a_line_runs_over_a_sheave_as_by_verlets_method(method: str, friction: float) -> None:
    """A node passes, at the end of a step; without friction the order is high, with it forces bend as it slips."""
    exact, frames = running(65536, "verlet", friction)
    second = np.abs(running(2048, "verlet", friction)[0].state.r - exact.state.r).max()
    found = [running(steps, method, friction) for steps in (8, 16, 32)]
    errors = [float(np.abs(motion.state.r - exact.state.r).max()) for motion, _ in found]
    print(f"errors {errors}, Verlet {second:.3g}")
    assert exact.structure.runs.links[0] == found[-1][0].structure.runs.links[0] == 2  # of three
    assert errors[2] < (2.0 if friction else 1.0) * second  # which takes 64 times as many steps
    assert friction or np.log2(errors[0] / errors[1]) > 2.5
    lost, paid = (at[1].energy[ENERGY_FORMS.index("friction")] for at in (found[-1][1], frames))
    assert lost == pytest.approx(paid, abs=1e-3)
    assert (paid > 0.03) == (friction > 0.0)


@pytest.mark.parametrize("method", METHODS)
def test_a_load_ends_the_motion_where_it_comes_to_a_sheave(method: str) -> None:
    """The link over the sheave begins at 3 of 9 links: with steps of any length."""
    load = {"on": "r", "kind": "mass", "mass": 0.1, "travel": {"speed": 1.0, "from": 0.1}}
    tree = {"gravity": 1.0, "lines": {"r": over(0.0, 0.1)}, "loads": {"m": load}, "run": in_steps(8, method)}
    run_info = RunInfo()
    motion = SystemMotion(Scenario.model_validate(tree), run_info, np.array([0.0, UNTIL]))
    ending = motion.advance(1)
    assert ending is not None
    assert "reached a sheave" in ending.advice
    links = motion.structure.runs.links[0]
    assert motion.state.s[0] == pytest.approx(links * 1.3 / 9, abs=1e-6)
