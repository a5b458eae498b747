"""Nodes that are heavier along their lines: `run.axial_inertia` on ropes and networks.

Sources: modes of M = m (1 + (f - 1) t t^T) and the stiffness of a network at rest, with Verlet's frequency,
2/dt asin(w dt/2); axial and transverse modes of a taut string of links; the same motion with nothing added.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg as linalg
from pydantic import ValidationError

from motion_cases import order
from ropewalk.capabilities import SYSTEM, engine_of
from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.simulate import simulate
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.system.dynamics.stability import WITHOUT_LOADS
from ropewalk.system.elements.inertia import tangents
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.loads.loaded_structure import LoadedStructure
from system_cases import frames_of, imbalance

F = 9.0
NOTHING = 1.0 + 1e-14  # of a factor: rounding
TAUT = {"start": [0, 0], "end": [1, 0], "tension": 1.0, "mass": 1.0, "axial_stiffness": 1e4, "elements": 20}
ROPE = {"start": [0, 0], "end": [20, 3], "length": 20.3, "mass": 1.0, "axial_stiffness": 1e5, "elements": 24}
SOFT = {"kind": "elastic", "stiffness": 4e3, "mass": 0.3}
TRIPOD = {
    "deck": {**ROPE, "end_support": SOFT},
    "stay": {"start": [9, 6], "end": [10, 1.0], "end_support": {"kind": "joined", "to": "deck", "at": 10.15},
             "length": 5.3, "mass": 0.4, "axial_stiffness": 4e4, "elements": 6},
}  # fmt: skip


def asked(lines: dict[str, Any], until: float, gravity: float = 9.81, loads: Any = (), **run: Any) -> Scenario:
    wind = {"wind": run.pop("wind")} if "wind" in run else {}
    run = {"kind": "dynamic", "until": until, "every": until / 5.0, "axial_inertia": F} | run
    return Scenario.model_validate({"gravity": gravity, "lines": lines, "loads": dict(loads), "run": run} | wind)


def equations(motion: SystemMotion) -> tuple[np.ndarray, np.ndarray, Any]:
    """K and M of free unknowns about rest, and how nodes move with these; M said anew."""
    potential, n = (
        SystemPotential(motion.structure, LoadedStructure(motion.structure, motion.rest), 20.0),
        motion.rest.shape[1],
    )
    along, m, restrained = (
        tangents(motion.structure, motion.rest),
        motion.structure.nodes.mass,
        motion.structure.restraints,
    )
    full = np.zeros((2, n, 2, n))
    for i in range(n):
        full[:, i, :, i] = m[i] * (np.eye(2) + (F - 1.0) * np.outer(along[:, i], along[:, i]))
    for e in range(restrained.mass.size):
        first = restrained.node[restrained.first[e]]
        full[:, first, :, first] += restrained.mass[e] * np.eye(2)
    M = potential.free.T @ (full.reshape(2 * n, 2 * n) @ potential.free.toarray())
    return potential.stiffness(motion.rest.ravel()).toarray(), M, potential.free


def test_a_network_swings_in_its_modes() -> None:
    """Joint, springs and masses at supports: it stays in one to 1e-6, rounding, and its frequency is of order two."""

    def missed(step: float) -> float:
        motion = SystemMotion(asked(TRIPOD, 0.1, step=step), RunInfo(), np.linspace(0.0, 0.1, 26))
        K, M, free = equations(motion)
        squares, modes = linalg.eigh(K, M)
        number = int(np.searchsorted(np.sqrt(squares), 80.0))
        w, mode = float(np.sqrt(squares[number])), modes[:, number]
        shape = (free @ mode).reshape(motion.rest.shape)
        size = 1e-6 / np.abs(shape).max()
        motion.state.r[:] += size * shape
        seen = []
        for i in range(26):
            assert motion.advance(i) is None
            away = np.linalg.lstsq(free.toarray(), (motion.state.r - motion.rest).ravel(), rcond=None)[0]
            q = modes.T @ M @ away / size
            seen.append(q[number])
            assert np.abs(np.delete(q, number)).max() < 1e-5 + 1e3 * step**2
        swung = np.array(seen) - np.cos(w * motion.times)
        return float(np.abs(swung).max())

    steps = [2e-3, 1e-3, 5e-4]
    assert order(steps, [missed(step) for step in steps]) == pytest.approx(2.0, abs=0.05)


def test_waves_along_a_string_are_slower_by_the_root_of_the_factor_and_those_across_are_as_they_are() -> None:
    """Of links and steps: w = 2/dt asin(dt/h sqrt(EA/(f rho)) sin(k h/2)); in 1e-7 m 1e-16 m are rounded away."""
    times, x, step, k = np.linspace(0.0, 0.1, 6), np.linspace(0.0, 1.0, 21), 5e-4, np.pi
    h, seen = (1.0 / 1.0001) / 20, []  # stretched by 1 N of 10 kN
    for axis, factor in ((0, F), (1, F), (1, NOTHING)):
        scene = asked({"r": TAUT}, 0.1, 0.0, step=step, axial_inertia=factor)
        motion = SystemMotion(scene, RunInfo(), times)
        motion.state.r[axis] += 1e-7 * np.sin(k * x)
        away = []
        for i in range(times.size):
            assert motion.advance(i) is None
            away.append((motion.state.r - motion.rest)[axis] / 1e-7)
        seen.append(np.array(away))
    w = 2.0 / step * np.arcsin(step / h * np.sqrt(1e4 / F) * np.sin(0.5 * k / 20))
    assert seen[0] == pytest.approx(np.outer(np.cos(w * times), np.sin(k * x)), abs=1e-5)
    assert seen[1] == pytest.approx(seen[2], abs=1e-8)
    assert np.abs(seen[1][-1]).max() < 0.97


def test_nothing_added_is_nothing() -> None:
    """Beside a wind of nothing, with which the same engine knows of no axes: rounding."""
    loads = {"m": {"kind": "mass", "on": "deck", "mass": 5.0, "travel": {"speed": 5.0, "from": 6.0}}}
    one = asked(TRIPOD, 0.1, loads=loads, axial_inertia=NOTHING, step=2e-3)
    other = asked(TRIPOD, 0.1, loads=loads, axial_inertia=1.0, step=2e-3)
    assert engine_of(one) is engine_of(other) is SYSTEM
    for a, b in zip(frames_of(one), frames_of(other), strict=True):
        assert a.position == pytest.approx(b.position, abs=1e-9)
        assert a.reaction == pytest.approx(b.reaction, abs=1e-4)
        assert a.energy == pytest.approx(b.energy, abs=1e-5)


def test_the_audit_closes_to_the_second_order() -> None:
    """A mass on a damped rope whose end stands on springs; in wind, whose work is booked to the first order."""
    rope = {**ROPE, "end_support": SOFT, "drag": 1.0, "axial_damping": 20.0}
    loads = {"m": {"kind": "mass", "on": "deck", "mass": 5.0, "travel": {"speed": 5.0, "from": 6.0}}}
    steps = [2e-3, 1e-3, 5e-4]
    missed = [imbalance(frames_of(asked({"deck": rope}, 0.5, loads=loads, step=step))) for step in steps]
    assert order(steps, missed) == pytest.approx(2.0, abs=0.2)
    blown, wind = {"deck": {**rope, "wind_drag": 0.05}}, {"direction": [1, 0.2], "speed": 25.0}
    assert imbalance(frames_of(asked(blown, 0.5, loads=loads, wind=wind, step=1e-3))) < 1e-5  # 6e-6 without the factor


def test_the_step_grows_by_the_root_of_the_factor() -> None:
    """On a straight string by that, but for what it may turn (0.15 rad); everywhere it is stable."""
    steps = []
    for factor in (NOTHING, F):
        run_info = RunInfo()
        SystemMotion(asked({"r": TAUT}, 1.0, 0.0, axial_inertia=factor), run_info, np.array([0.0, 1.0]))
        steps.append(run_info.step)
    assert steps[1] / steps[0] == pytest.approx((1.0 / F + 0.0225) ** -0.5, rel=2e-3)  # T is 1e-4 of EA
    run_info = RunInfo()
    K, M, _ = equations(SystemMotion(asked(TRIPOD, 1.0), run_info, np.array([0.0, 1.0])))
    bound = 2.0 / np.sqrt(linalg.eigh(K, M, eigvals_only=True)[-1]) / (run_info.step / WITHOUT_LOADS)
    assert 1.0 < bound < 1.2


def test_what_sags_is_doubted_and_what_has_no_axis_is_refused() -> None:
    found = simulate(asked({"r": {**ROPE, "length": 21.5}}, 0.02))
    assert found.attrs["outcome"] == "doubtful"
    assert "run.axial_inertia" in str(found.attrs["doubts"])
    assert "by a factor of 3" in str(simulate(asked({"r": TAUT}, 0.02, 0.0)).attrs["warnings"])
    net = {"corner": [0, 0, 0], "sides": [[3, 0, 0], [0, 2, 0]], "cells": [3, 2], "kind": "membrane",
           "stiffness": 1e4, "mass": 0.1, "tension": 100.0}  # fmt: skip
    with pytest.raises(ValidationError, match="a net has no axis along which"):
        simulate(Scenario.model_validate({"nets": {"n": net}, "run": {"kind": "dynamic", "until": 0.1,
                                                                      "axial_inertia": 4}}))  # fmt: skip
