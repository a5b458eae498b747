"""Runs of kind linear of what is joined, held on its way, or a surface: superposition of modes about rest.

Sources: the matrix exponential; superposition of the exact modes of a beam over two spans (`continuous_beams.py`); the
sine modes of a net under a moving force (`ropewalk.theory.membrane`); the reciprocal theorem of Maxwell and Betti; the
same small motion step by step (`geometry: linearised`), and with all geometry as the loads go to nothing; a mass that
crosses a beam, in modes (`ropewalk.theory.beam_crossing`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.linalg as linalg
import scipy.sparse as sparse

from closed_forms import membranes
from continuous_beams import EI, MASS, under_a_moving_force
from ropewalk.capabilities import SUPERPOSED, engine_of
from ropewalk.errors import EquilibriumError
from ropewalk.model import Linear, Scenario
from ropewalk.results.frame import Frame, RunInfo
from ropewalk.simulate import output_times, simulate
from ropewalk.solve.modal import ModalBasis, ModalStep
from ropewalk.solve.radau_iia import C as STAGES
from ropewalk.system.assembling.membranes import sheet_of
from ropewalk.system.small_motion.superposed import Superposed
from ropewalk.theory import beam_crossing
from system_cases import ROPE, TRIPOD, frames_of, with_steps_of

PIER = {"kind": "guided", "along": [1, 0]}
SPANS = (8.0, 12.0)
LOADS: dict[str, Any] = {
    "force": {"kind": "force", "force": [12.0, -40.0]},
    "held force": {"kind": "force", "force": [12.0, -40.0], "contact": "frictionless"},
    "mass": {"kind": "mass", "mass": 2.0},
    "oscillator": {"kind": "oscillator", "mass": 2.0, "wheel_mass": 0.3, "stiffness": 800.0, "damping": 5.0},
    "light oscillator": {"kind": "oscillator", "mass": 2.0, "stiffness": 800.0, "damping": 5.0},
}


def given(lines: dict[str, Any], loads: dict[str, Any], until: float, every: float, **keys: Any) -> Scenario:
    run = {"kind": "linear", "until": until, "every": every} | keys.pop("run", {})
    return Scenario.model_validate({"gravity": 9.81, "lines": lines, "loads": loads, "run": run} | keys)


def superposed(scenario: Scenario, **run: Any) -> list[Frame]:
    """All frames by modes, whichever theory would be chosen."""
    asked = scenario.run
    linear = Linear(until=asked.until, every=asked.every, **run)
    run_info = RunInfo()
    found = list(Superposed(scenario, linear, output_times(linear), run_info).frames())
    assert not run_info.doubts, run_info.doubts
    return found


def over_spans(elements: int, **line: Any) -> dict[str, Any]:
    whole = sum(SPANS)
    own = {"start": [0, 0], "end": [whole, 0], "length": whole, "mass": MASS, "axial_stiffness": 1e8}
    own |= {"bending_stiffness": EI, "elements": elements, "supports": {"pier": {"at": SPANS[0], **PIER}}}
    return {"line": own | line}


def crossing(size: float, speed: float = 20.0, **more: Any) -> dict[str, Any]:
    return {"kind": "force", "on": "line", "force": [0, -size], "travel": {"speed": speed, "at_end": "leave"}} | more


@pytest.mark.parametrize("damping", ["none", "drag", "overdamped", "coupled"])
def test_modes_follow_forces_as_the_equations_of_motion_do(damping: str) -> None:
    """Against the exponential of the first-order equations, with forces that are quadratic in time."""
    rng = np.random.default_rng(0)
    n, h = 4, 0.7
    B, D = rng.normal(size=(2, n, n))
    K, M = B @ B.T + 3.0 * np.eye(n), np.diag(rng.uniform(1.0, 2.0, n))
    C = {"none": 0.0 * M, "drag": 0.3 * M, "overdamped": 9.0 * M, "coupled": D @ D.T}[damping]
    modes = ModalBasis.of(*map(sparse.csc_matrix, (K, M, C)), sparse.identity(n, format="csr"))
    parts = rng.normal(size=(3, n))  # of 1, t, t^2
    A = np.zeros((2 * n + 3, 2 * n + 3))
    A[:n, n : 2 * n] = np.eye(n)
    A[n : 2 * n] = np.linalg.inv(M) @ np.hstack([-K, -C, parts.T * [1.0, 1.0, 2.0]])
    A[[-2, -1], [-3, -2]] = 1.0
    exact = linalg.expm(3.0 * h * A)[:, -3]
    step, z = ModalStep(modes.rate, h), np.zeros(modes.rate.size, dtype=complex)
    for i in range(3):
        forces = [np.array([1.0, t, t * t]) @ parts for t in h * (i + STAGES)]
        z = step.decay[2] * z + sum(step.weight[2, k] * (forces[k] @ modes.driven) for k in range(3))
    assert (modes.shape @ z).real == pytest.approx(exact[:n], rel=1e-9, abs=1e-11)  # roundings
    assert (modes.shape @ (modes.rate * z)).real == pytest.approx(exact[n : 2 * n], rel=1e-9, abs=1e-11)


def test_a_force_over_two_spans_is_the_sum_of_their_exact_modes() -> None:
    until, errors = 1.2, []
    for elements in (10, 20, 40):
        scenario = given(over_spans(elements), {"a": crossing(1e3)}, until, 0.1, gravity=0.0)
        assert engine_of(scenario) is SUPERPOSED
        found = superposed(scenario)
        x, times = found[0].position[:, 0], np.array([frame.path for frame in found])
        exact = -1e3 * under_a_moving_force(SPANS, 20.0, x, times)
        moved = np.array([frame.position[:, 1] for frame in found])
        errors.append(float(np.abs(moved - exact).max() / np.abs(exact).max()))
    print("errors", errors, "order", np.log2(errors[1] / errors[2]))
    assert errors[2] < 5e-4  # seen 4.4e-4
    assert np.log2(errors[1] / errors[2]) == pytest.approx(3.2, abs=0.4)  # seen; a force comes over a support


def test_few_modes_and_what_follows_at_once_are_near_all_modes() -> None:
    """And at rest they are the same: under a load that is on its way for ten periods, to what still swings."""
    quick = given(over_spans(20), {"a": crossing(1e3)}, 1.2, 0.1, gravity=0.0)
    slow = given(over_spans(20), {"a": crossing(1e3, speed=0.5, travel={"speed": 0.2})}, 10.0, 2.5, gravity=0.0)
    for scenario, allowed in ((quick, 6e-3), (slow, 2e-4)):
        whole, few = (np.array([f.position for f in superposed(scenario, modes=m)]) for m in (None, 6))
        size = np.abs(whole - whole[:1]).max()
        print("few modes miss", np.abs(few - whole)[1:].max() / size)
        assert np.abs(few - whole)[1:].max() < allowed * size
        assert np.abs(few - whole)[1:].max() > 1e-9 * size


def test_modes_of_a_net_under_a_moving_force_converge_to_the_closed_form() -> None:
    errors = []
    pairs = ((1, 1), (2, 1), (1, 2))
    for n in (6, 12, 24):
        sheet = {"kind": "net", "corner": [0, 0, 0], "sides": [[4, 0, 0], [0, 3, 0]], "cells": [n, n],
                 "mesh": 0.2, "axial_stiffness": 1e4, "mass": 0.05, "tension": 100.0}  # fmt: skip
        load = {"kind": "force", "on": "net", "force": [0, 0, -0.01]}
        travel = {"path": [[0.0, 1.2], [4.0, 1.2]], "speed": 1.0}
        bare = given({}, {"p": {**load, "travel": travel}}, 1.0, 1.0, nets={"net": sheet}, gravity=0.0)
        laid = sheet_of("net", bare.nets["net"])
        weight = laid.weight
        mass, plan = weight.sum() / 12.0, laid.surface.plan
        speed = 0.5 * np.sqrt(500.0 / mass)
        until = 3.2 / speed
        loads = {"p": {**load, "travel": {**travel, "speed": speed}}}
        found = superposed(given({}, loads, until, until / 40.0, nets={"net": sheet}, gravity=0.0))
        times = np.array([frame.path for frame in found])
        known = {"force": -0.01, "speed": speed, "track": 1.2, "sides": (4.0, 3.0), "tension": 500.0, "mass": mass}
        error = []
        for p, q in pairs:
            shape = np.sin(p * np.pi * plan[:, 0] / 4.0) * np.sin(q * np.pi * plan[:, 1] / 3.0)
            z = np.array([frame.position[:, 2] for frame in found])
            amplitude = 4.0 * (z * shape * weight).sum(axis=1) / weight.sum()
            exact = membranes.moving_force_mode(p, q, times, **known)
            error.append(np.abs(amplitude - exact).max() / np.abs(exact).max())
        errors.append(error)
    last = np.log2(np.array(errors[1]) / errors[2])
    print("errors", errors, "orders", last)
    assert np.all((last > 1.8) & (last < 2.1))  # the dispersion of the lattice


@pytest.mark.parametrize("kind", LOADS)
def test_it_is_the_small_motion_that_steps_converge_to(kind: str) -> None:
    """Verlet's error is of the second order in its step; of the first where a damper moves a wheel without mass."""
    load = {**LOADS[kind], "on": "deck", "travel": {"speed": 6.0, "from": 4.0}}
    run = {"kind": "dynamic", "until": 0.6, "every": 0.1, "geometry": "linearised"}
    scenario = given(TRIPOD, {"a": load}, 0.6, 0.1, run=run)
    found = [superposed(scenario), *(frames_of(with_steps_of(scenario, part)) for part in (1.0, 0.5))]
    places = [np.array([np.vstack([frame.position, frame.contact_position]) for frame in frames]) for frames in found]
    if kind == "mass":  # which does not make links ring as a force does that is set down
        for of in ("tension", "reaction", "contact_force"):
            last = [getattr(frames[-1], of) for frames in (found[0], found[2])]
            assert last[0] == pytest.approx(last[1], abs=3e-4 * np.abs(last[1]).max()), of  # of the steps, seen 1e-4
    errors = [float(np.abs(steps - places[0]).max()) for steps in places[1:]]
    print("errors", errors, "order", np.log2(errors[0] / errors[1]))
    assert errors[0] < 1e-4
    assert np.log2(errors[0] / errors[1]) == pytest.approx(1.0 if kind == "light oscillator" else 2.0, abs=0.2)


def test_displacements_are_reciprocal() -> None:
    """Maxwell and Betti, in motion: of two places, what a force set down on one moves the other by."""
    at, moved = (4.1, 13.7), []
    for here, there in (at, at[::-1]):
        loads = {
            "acts": {"kind": "force", "on": "deck", "force": [0, -10.0], "travel": {"speed": 0.0, "from": here}},
            "looks": {"kind": "force", "on": "deck", "force": [0, 0], "travel": {"speed": 0.0, "from": there}},
        }
        found = simulate(given(TRIPOD, loads, 1.0, 0.1)).contact_position.values[:, 1, 1]
        moved.append(found - found[0])
    assert np.abs(moved[0]).max() > 0.05
    assert moved[0] == pytest.approx(moved[1], abs=1e-9 * np.abs(moved[0]).max())  # roundings; kinks are beside them


def test_given_forces_add_up() -> None:
    one = {**LOADS["force"], "on": "deck", "travel": {"speed": 6.0, "from": 4.0}}
    two = {"kind": "force", "on": "deck", "force": [0, 25.0], "travel": {"speed": -3.0, "from": 12.0}}
    bare, first, second, both = (
        superposed(given(TRIPOD, loads, 0.6, 0.1)) for loads in ({}, {"a": one}, {"b": two}, {"a": one, "b": two})
    )
    for of in ("position", "velocity", "tension", "reaction"):
        none, a, b, sums = (np.array([getattr(f, of) for f in frames]) for frames in (bare, first, second, both))
        assert np.abs(sums - none).max() > 0.0
        assert sums - none == pytest.approx(a + b - 2.0 * none, abs=2e-5 * np.abs(sums - none).max())  # of the steps


def test_a_mass_that_crosses_a_beam_is_as_in_its_modes() -> None:
    errors = []
    times = np.linspace(0.0, 0.8, 9)
    known = {"load_mass": 300.0, "speed": 12.0, "length": 10.0, "bending_stiffness": 1e6, "mass": 100.0}
    exact = beam_crossing.moving_mass(times, tension=1.0, **known).deflection.ravel()
    for elements in (10, 20):
        line = {"start": [0, 0], "end": [10, 0], "length": 10.0, "mass": 100.0, "axial_stiffness": 1e8,
                "bending_stiffness": 1e6, "elements": elements}  # fmt: skip
        load = {"kind": "mass", "on": "line", "mass": 300.0, "force": [0, -300.0 * 9.81],
                "travel": {"speed": 12.0, "at_end": "leave"}}  # fmt: skip
        found = superposed(given({"line": line}, {"m": load}, 0.8, 0.1, gravity=0.0))
        under = -np.array([frame.contact_position[0, 1] for frame in found])
        errors.append(float(np.abs(under - exact).max() / np.abs(exact).max()))
    print("errors", errors, "order", np.log2(errors[0] / errors[1]))
    assert errors[1] < 5e-4
    assert np.log2(errors[0] / errors[1]) == pytest.approx(3.2, abs=0.8)  # a load comes over a support


def test_what_it_does_not_know_is_refused() -> None:
    shaken = {"kind": "moving", "displacement": {"time": [0, 1], "value": [[0, 0], [0, 0.1]]}}
    with pytest.raises(ValueError, match="a support that moves is not implemented"):
        given({**TRIPOD, "deck": {**ROPE, "start_support": shaken}}, {}, 1.0, 0.1)
    heavy = {**LOADS["mass"], "on": "deck", "lift_off": True, "travel": {"speed": 6.0, "from": 4.0}}
    with pytest.raises(ValueError, match="is not implemented for kind: linear"):
        given(TRIPOD, {"a": heavy}, 1.0, 0.1)


def test_what_resists_nothing_is_refused() -> None:
    limp = {"start": [0, 0], "end": [20, 0], "length": 20.0, "mass": 1.0, "axial_stiffness": 1e5, "elements": 10}
    limp |= {"supports": {"saddle": {"at": 10.0, "kind": "fixed"}}}
    with pytest.raises(EquilibriumError):
        simulate(given({"deck": limp}, {}, 1.0, 0.1, gravity=0.0))
