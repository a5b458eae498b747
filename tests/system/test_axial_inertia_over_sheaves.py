"""Nodes that are heavier along their lines where these run over sheaves, and turn there.

Sources: Atwood's machine, whose rope takes part with f times its mass; waves along a rod; the same motion with nothing
added.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.simulate import simulate
from ropewalk.system.dynamics.moving import SystemMotion
from system_cases import frames_of, imbalance

F = 9.0
NOTHING = 1.0 + 1e-14  # of a factor: rounding


def over(friction: float = 0.0, **changes: Any) -> dict[str, Any]:
    """A rope from (0, 0) over a sheave at (5, 3) to (12, 1)."""
    return {
        "start": [0, 0], "end": [12, 1], "length": 13.15, "mass": 1.0, "axial_stiffness": 1e5, "elements": 40,
        "sheaves": {"wheel": {"at": [5, 3], "friction": friction}}, **changes,
    }  # fmt: skip


def asked(rope: dict[str, Any], until: float, factor: float = F, **more: Any) -> Scenario:
    run = {"kind": "dynamic", "until": until, "every": until / 10.0, "axial_inertia": factor} | more.pop("run", {})
    return Scenario.model_validate({"lines": {"rope": rope}, "run": run} | more)


PART = np.linspace(0.0, 1.0, 41)
WAY = PART - np.sin(2.0 * np.pi * PART) / (2.0 * np.pi)


def hauled(way: float, lasts: float) -> dict[str, Any]:
    """Its end is drawn away, and a counterweight gives rope."""
    unit = np.array([7.0, -2.0]) / np.hypot(7.0, 2.0)
    table = {"time": (lasts * PART).tolist(), "value": [(way * float(w) * unit).tolist() for w in WAY]}
    return {
        "end_support": {"kind": "moving", "displacement": table},
        "start_support": {"kind": "guided", "along": [-5.0, -3.0], "force": 300.0, "mass": 1.0, "damping": 200.0},
    }


PUSHED = {"m": {"kind": "mass", "on": "rope", "mass": 5.0, "travel": {"speed": 2.0, "from": 1.0}}}


def test_atwoods_machine_on_springs_moves_a_rope_of_f_times_its_mass() -> None:
    """3 kg and 2 kg on springs, 10 m of 0.05 kg/m that slide over the sheave: (k1 + k2 - 2 rho g) / (m + f rho L)."""
    k, sides = 0.05, {
        f"{end}_support": {"kind": "guided", "along": [0, 1], "stiffness": 40, "mass": mass}
        for end, mass in (("start", 3.0), ("end", 2.0))
    }  # fmt: skip
    rope = {
        "start": [-0.01, -5], "end": [0.01, -5], "length": 10.0, "mass": k, "axial_stiffness": 1e5,
        "axial_damping": 40.0, "elements": 60, "sheaves": {"wheel": {"at": [0, 0]}}, **sides,
    }  # fmt: skip
    until, times = 2.4, np.linspace(0.0, 2.4, 25)
    motion = SystemMotion(asked(rope, until), RunInfo(), times)
    structure, b = motion.structure, int(motion.structure.sheaves.node[0])
    ahead = np.where(motion.rest[0] > 0.0, -1.0, 1.0)  # up, over the sheave, and down
    motion.state.v[1] = np.where(np.arange(ahead.size) == b, 0.0, 1.5 * ahead)
    z, passed = [], []
    for i in range(times.size):
        assert motion.advance(i) is None
        z.append(motion.state.r[1, structure.runs.first[1] + structure.runs.links[1]] - motion.rest[1, 0])
        passed.append(int(structure.runs.links[0]))
    rate = np.sqrt((80.0 - 2.0 * k * 9.81) / (5.0 + F * k * 10.0))
    moved, way = np.array(z) - z[0], -1.5 / rate * np.sin(rate * times)
    print(np.abs(moved - way).max(), np.ptp(moved), np.ptp(passed))
    assert np.ptp(passed) >= 6
    assert moved == pytest.approx(way, abs=2e-3 * np.ptp(way))


def test_waves_run_over_a_sheave_as_along_a_rod() -> None:
    """The first mode of a light rope that is drawn taut over it: half a wave on all of its length."""
    rope = over(length=12.5, mass=0.1, axial_stiffness=1e4, elements=60)
    until, times = 0.2, np.linspace(0.0, 0.2, 401)
    motion = SystemMotion(asked(rope, until, gravity=0.0, run={"every": until}), RunInfo(), times)
    on = motion.structure.on_runs & (np.linalg.norm(motion.structure.inertia.along, axis=0) > 0.0)
    along, rest = motion.structure.inertia.along[:, on], motion.rest[:, on]
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(rest, axis=1), axis=0))])
    arc += np.linalg.norm(rest[:, 0])
    whole = np.hypot(5.0, 3.0) + np.hypot(7.0, 2.0)
    shape = np.sin(np.pi * arc / whole)
    motion.state.r[:, on] += 1e-5 * shape * along
    seen = []
    for i in range(times.size):
        assert motion.advance(i) is None
        seen.append(float((((motion.state.r[:, on] - rest) * along).sum(axis=0) @ shape) / (shape @ shape) / 1e-5))
    omega = np.pi / 12.5 * np.sqrt(1e4 / (0.1 * F))  # per unstrained length
    print(np.abs(np.array(seen) - np.cos(omega * times)).max(), omega * until)
    assert np.array(seen) == pytest.approx(np.cos(omega * times), abs=0.02)


def test_nothing_added_is_nothing() -> None:
    """Nodes pass, a mass goes along: rounding, which passing nodes make more of."""
    a, b = (
        frames_of(asked(over(0.05, **hauled(0.8, 0.4)), 0.4, f, loads=PUSHED, run={"step": 4e-4}))
        for f in (NOTHING, 1.0)
    )
    gone = np.linalg.norm(a[-1].position[-1] - a[0].position[-1])
    assert gone > 0.7  # two nodes
    for one, other in zip(a, b, strict=True):
        assert one.position == pytest.approx(other.position, abs=1e-7)
        assert one.energy == pytest.approx(other.energy, abs=1e-4)


def test_the_audit_closes_as_nodes_pass() -> None:
    """As well as without it: what passing takes is of the mesh, and known to the first order of the step."""
    missed = [
        imbalance(frames_of(asked(over(0.05, **hauled(0.8, 1.5)), 1.5, factor, loads=PUSHED, run={"step": 2e-4})))
        for factor in (1.0, F)
    ]
    print(missed)
    assert missed[1] < 2e-3


def test_slow_hauling_does_not_feel_it() -> None:
    """The same way and tensions whatever the factor, where nothing is accelerated."""
    ends = {**hauled(1.5, 8.0), "axial_damping": 300.0, "drag": 1.0}
    a, b = (frames_of(asked(over(**ends), 8.0, f)) for f in (4.0, 1.0))
    away = np.abs(a[-1].position - b[-1].position).max()
    print(away, np.linalg.norm(b[-1].position[-1] - b[0].position[-1]))
    assert away < 2e-3


def test_steps_are_longer_and_stay_stable() -> None:
    steps = []
    for factor in (NOTHING, F):
        run_info = RunInfo()
        SystemMotion(asked(over(0.05), 1.0, factor), run_info, np.array([0.0, 1.0]))
        steps.append(run_info.step)
    assert steps[1] / steps[0] == pytest.approx((1.0 / F + 0.0225) ** -0.5, rel=0.1)
    found = simulate(asked(over(0.05, **hauled(0.8, 0.5)), 0.5, loads=PUSHED))
    assert found.attrs["outcome"] == "completed", found.attrs["doubts"]
    assert "over sheaves by 9" in str(found.attrs["warnings"])
