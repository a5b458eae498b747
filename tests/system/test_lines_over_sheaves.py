"""Lines over sheaves in motion: Atwood's machine, a hoist, friction by Euler and Eytelwein, blocks, and what travels.

References: closed forms in each test. Friction: T2/T1 = exp(mu theta).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.linalg import eigh

from ropewalk.model import Scenario
from ropewalk.results.frame import Frame, RunInfo
from ropewalk.simulate import simulate
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.system.elements.sheaves_at_rest import damping_of
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.loads.loaded_structure import LoadedStructure

G = 9.81


def over(friction: float = 0.0, **changes: Any) -> dict[str, Any]:
    """A rope from (0, 0) over a sheave at (5, 3) to (12, 1)."""
    return {
        "start": [0, 0], "end": [12, 1], "length": 13.3, "mass": 1.0, "axial_stiffness": 1e5, "elements": 40,
        "sheaves": {"wheel": {"at": [5, 3], "friction": friction}}, **changes,
    }  # fmt: skip


def scenario(rope: dict[str, Any], run: dict[str, Any], **more: Any) -> Scenario:
    return Scenario.model_validate({"lines": {"rope": rope}, "run": {"kind": "dynamic", "every": 0.01, **run}, **more})


def at_first(rope: dict[str, Any], **more: Any) -> SystemMotion:
    """A motion in its first state."""
    return SystemMotion(scenario(rope, {"until": 0.01}, **more), RunInfo(), np.array([0.0]))


def frame_of(motion: SystemMotion) -> Frame:
    """Its present frame."""
    return motion.frames([motion.note_present()])[0]


def form(result: xr.Dataset, name: str) -> np.ndarray:
    return np.asarray(result.energy.sel(form=name).values)


def upright(n: int, **changes: Any) -> dict[str, Any]:
    """10 m of rope, straight up to a sheave and down again."""
    return {
        "start": [-0.05, -5], "end": [0.05, -5], "length": 10.0, "mass": 0.05, "axial_stiffness": 1e5,
        "axial_damping": 20.0, "elements": n, "sheaves": {"wheel": {"at": [0, 0]}}, **changes,
    }  # fmt: skip


def test_the_tension_of_a_heavy_rope_at_a_sheave_converges_with_the_second_order() -> None:
    """Along an elastic catenary T + T^2 / (2 EA) - w z is the same: from both ends up to the sheave at z = 3.

    Pieces weigh what they are: with the weight of a link at its nodes alone it would be the first order.
    """
    missed = []
    for n in (20, 40, 80):
        largest = 0.0  # where the sheave stands on its link is by chance
        for more in (0, 1, 2, 3, 4, 5):
            frame = frame_of(at_first(over(length=14.0, elements=n + more * n // 20)))
            assert frame is not None
            ends = (float(np.linalg.norm(force)) for force in frame.reaction[:2])
            one, two = (T + T**2 / 2e5 + G * rise for T, rise in zip(ends, (3.0, 2.0), strict=True))
            largest = max(largest, abs(one - two))
        missed.append(largest)
    orders = np.log2(np.array(missed[:-1]) / missed[1:])
    print(missed, orders)
    assert orders == pytest.approx(2.0, abs=0.3)


def test_without_friction_and_weight_both_tensions_are_the_same() -> None:
    motion = at_first(over(length=13.0, elements=20), gravity=0.0)
    sheaves = motion.structure.sheaves
    assert sheaves is not None
    one, two = sheaves.tension[0]
    assert two / one - 1.0 == pytest.approx(0.0, abs=1e-11)  # to rounding of lengths, over the strain
    frame = frame_of(motion)
    assert frame is not None
    ways = np.array([[-5.0, -3.0], [7.0, -2.0]])
    units = ways / np.linalg.norm(ways, axis=1)[:, None]
    assert frame.reaction[2] == pytest.approx(-one * units.sum(axis=0), rel=1e-6)


def test_a_block_in_a_loop_hangs_on_twice_the_tension() -> None:
    rope = {
        "start": [0, 0], "end": [1, 0.3], "length": 4.5, "mass": 1e-6, "axial_stiffness": 1e5, "elements": 30,
        "sheaves": {"block": {"at": [0.5, -2.0], "to": "hook"}},
    }  # fmt: skip
    motion = at_first(rope, joints={"hook": {"mass": 10.0}})
    assert motion.structure.sheaves is not None
    one, two = motion.structure.sheaves.tension[0]
    assert two / one - 1.0 == pytest.approx(0.0, abs=1e-7)  # the rope weighs 5e-5 N of 50 N
    # An ellipse with the supports as foci: both parts have the same slope, cos = d / length across.
    across = 1.0 / (4.5 * (1.0 + one / 1e5))
    assert 2.0 * one * np.sqrt(1.0 - across**2) == pytest.approx(98.1, rel=1e-6)


def test_weights_on_a_rope_swing_as_atwoods_machine_on_springs() -> None:
    """3 kg and 2 kg, each on a spring of 400 N/m, tied by a rope of 1e6 N / 10 m: the slow one of two modes."""
    sides = {
        f"{end}_support": {"kind": "guided", "along": [0, 1], "stiffness": 400, "mass": mass}
        for end, mass in (("start", 3.0), ("end", 2.0))
    }
    result = simulate(scenario(
        upright(20, axial_stiffness=1e6, axial_damping=0.0, **sides),
        {"until": 0.5, "start": {"kind": "mode", "number": 1, "amplitude": 0.005}},
    ))  # fmt: skip
    K = np.array([[400.0 + 1e5, 1e5], [1e5, 400.0 + 1e5]])
    omega = np.sqrt(eigh(K, np.diag([3.0 + 0.25, 2.0 + 0.25]), eigvals_only=True)[0])
    z, t = result.position.values[:, [0, -1], 1], result.time.values
    for side in (0, 1):
        moved = z[:, side] - z[0, side]
        assert moved == pytest.approx(moved.min() + np.ptp(moved) * (0.5 + 0.5 * np.cos(omega * t)), abs=5e-5) or (
            moved == pytest.approx(moved.max() - np.ptp(moved) * (0.5 + 0.5 * np.cos(omega * t)), abs=5e-5)
        )
    assert np.abs(form(result, "imbalance")).max() < 1e-6 * form(result, "kinetic").max()
    assert form(result, "friction")[-1] == 0.0


def hoist(n: int, friction: float, way: float = 2.0, lasts: float = 2.0) -> xr.Dataset:
    """A winch pulls a rope down over a sheave, smoothly, and lifts 3 kg."""
    part = np.linspace(0.0, 1.0, 81)
    down = way * (part - np.sin(2.0 * np.pi * part) / (2.0 * np.pi))
    rope = upright(
        n, sheaves={"wheel": {"at": [0, 0], "friction": friction}},
        end_support={"kind": "guided", "along": [0, 1], "mass": 3.0},
        start_support={
            "kind": "moving",
            "displacement": {"time": (lasts * part).tolist(), "value": [[0.0, -float(d)] for d in down]},
        },
    )  # fmt: skip
    return simulate(scenario(rope, {"until": lasts, "every": 0.02}))


def test_a_hoist_lifts_what_its_winch_winds() -> None:
    """Nodes pass from side to side; works close, and a sheave without friction takes nothing."""
    audit = []
    for n in (20, 40):
        result = hoist(n, 0.0)
        assert result.attrs["outcome"] == "completed", result.attrs["advice"]
        r = result.position.values
        lifted, wound = r[:, -1, 1] - r[0, -1, 1], r[0, 0, 1] - r[:, 0, 1]
        # The rope stretches by (m + 3/2 of what it weighs) times pi m/s^2 over EA/L: 1.2e-3 m.
        assert lifted == pytest.approx(wound, abs=1.5e-3)
        assert lifted[-1] == pytest.approx(2.0, abs=3e-4)
        raised = G * (3.0 * 2.0 + 0.05 * (5.0**2 - 3.0**2) / 2.0 - 0.05 * (7.0**2 - 5.0**2) / 2.0)
        assert form(result, "support_work")[-1] == pytest.approx(raised, rel=2e-3)
        audit.append(float(np.abs(form(result, "imbalance")).max() / raised))
        assert np.abs(form(result, "friction")).max() < 1e-6 * raised
    print(audit)
    assert max(audit) < 5e-5


def test_a_hoist_pays_friction_by_euler_and_eytelwein() -> None:
    mu, n = 0.1, 40
    result = hoist(n, mu)
    angle = np.pi - np.arctan(0.05 / np.linspace(5.0, 3.0, 101)) - np.arctan(0.05 / np.linspace(5.0, 7.0, 101))
    tension = G * (3.0 + 0.05 * np.linspace(5.0, 3.0, 101))
    expected = 2.0 * float(((np.exp(mu * angle) - 1.0) * tension).mean())
    lost = form(result, "friction")
    print(lost[-1] / expected - 1.0, np.abs(form(result, "imbalance")).max() / expected)
    assert lost[-1] == pytest.approx(expected, rel=5e-3)  # it accelerates and slows down by 3 m/s^2
    assert np.abs(form(result, "imbalance")).max() < 5e-3 * expected  # 0.009 J


@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_a_motion_over_a_sheave_goes_on_from_a_stored_instant_as_if_nothing_had_been(
    friction: float, tmp_path: Path
) -> None:  # fmt: skip
    """Nodes pass before and after it, and friction slips: results hold where lines are over their sheaves."""
    time = np.linspace(0.0, 0.6, 61)
    down = -1.5 * (time / 0.6 - np.sin(2.0 * np.pi * time / 0.6) / (2.0 * np.pi))

    def rope(first: int) -> dict[str, Any]:
        table = {"time": (time[first:] - time[first]).tolist(), "value": [[0.0, float(z)] for z in down[first:]]}
        return upright(
            20, axial_damping=0.0, sheaves={"wheel": {"at": [0, 0], "friction": friction}},
            end_support={"kind": "guided", "along": [0, 1], "mass": 3.0},
            start_support={"kind": "moving", "displacement": table},
        )  # fmt: skip

    file = tmp_path / "whole.nc"
    whole = simulate(scenario(rope(0), {"until": 0.3, "every": 0.02}), file=file)
    station = whole.sheave_station.values[:, 0]
    assert np.floor(2.0 * station[[0, 8, 15]]).tolist() == [9.0, 10.0, 11.0]  # links of 0.5 m
    start = {"kind": "result", "file": str(file), "time": 0.16}
    later = simulate(scenario(rope(16), {"until": 0.14, "every": 0.02, "start": start}))
    for key in ("position", "sheave_station"):
        miss = float(np.abs(later[key].values - whole[key].values[8:]).max())
        print(key, miss)
        assert miss < 1e-11


@pytest.mark.parametrize("kind", ["force", "mass", "oscillator", "trolley"])
def test_loads_travel_on_a_line_over_a_sheave(kind: str) -> None:
    own: dict[str, Any] = {
        "force": {"force": [0, -100.0]}, "mass": {"mass": 10.0},
        "oscillator": {"mass": 10.0, "stiffness": 2e3, "wheel_mass": 1.0},
        "trolley": {"mass": 2.0, "payload": {"mass": 8.0, "length": 0.5}},
    }[kind]  # fmt: skip
    load = {"kind": kind, "on": "rope", **own, "travel": {"speed": 3.0, "from": 7.5}}
    result = simulate(scenario(over(0.05), {"until": 1.0, "start": {"with_loads": True}}, loads={"load": load}))
    assert result.attrs["outcome"] == "completed", result.attrs["advice"]
    moved = form(result, "kinetic").max() + np.ptp(form(result, "elastic"))
    print(kind, np.abs(form(result, "imbalance")).max() / moved, form(result, "friction")[-1])
    assert np.abs(form(result, "imbalance")).max() < 2e-3 * moved
    assert np.diff(form(result, "friction")).min() > -1e-9 * moved


def test_what_rests_with_its_load_stays_there() -> None:
    load = {"kind": "mass", "on": "rope", "mass": 10.0, "travel": {"speed": 0.0, "from": 9.0}}
    result = simulate(scenario(over(), {"until": 0.05, "start": {"with_loads": True}}, loads={"load": load}))
    assert np.abs(result.velocity.values).max() < 1e-9


def test_a_load_that_comes_to_a_sheave_stops_the_run() -> None:
    load = {"kind": "force", "on": "rope", "force": [0, -50.0], "travel": {"speed": 10, "from": 4.5}}
    result = simulate(scenario(over(), {"until": 0.6}, loads={"load": load}))
    assert result.attrs["outcome"] == "travel ended"
    assert "a load has reached a sheave" in result.attrs["advice"]
    # The sheave is 5.83 m from the start, over one link of 0.33 m.
    assert result.contact_xi.values[-1, 0] == pytest.approx(5.8, abs=0.5)


def test_a_rope_that_runs_out_says_so() -> None:
    result = hoist(20, 0.0, 6.0)
    assert result.attrs["outcome"] == "line ran out"
    assert "a line has moved over a sheave up to its end" in result.attrs["advice"]
    assert 1.0 < result.time.values[-1] < 2.0
    assert np.abs(form(result, "imbalance")).max() < 1e-2 * form(result, "support_work")[-1]


def test_stiffness_and_dampers_of_pieces_are_derivatives_of_their_forces() -> None:
    motion, rng = at_first(over(axial_damping=50.0)), np.random.default_rng(7)
    structure, r = motion.structure, motion.rest + 1e-3 * rng.standard_normal(motion.rest.shape)
    potential = SystemPotential(structure, LoadedStructure(structure, r), 1.0)
    way = rng.standard_normal(potential.free.shape[1])
    ahead, behind = (potential.out_of_balance(r.ravel() + potential.free @ (far * way)) for far in (1e-6, -1e-6))
    change, K = (behind - ahead) / 2e-6, potential.stiffness(r.ravel())
    assert change == pytest.approx(K @ way, abs=1e-6 * float(np.abs(change).max()))  # central differences
    # What dampers take over the link that the sheave divides: c h (rate of its strain)^2.
    sheaves, runs, v = structure.sheaves, structure.runs, rng.standard_normal(r.shape)
    assert sheaves is not None
    taken = float(v.ravel() @ damping_of(sheaves, runs, r) @ v.ravel())
    e, b, h = int(runs.first[0] + runs.links[0]), int(sheaves.node[0]), float(runs.h[0])

    def length(t: float) -> float:
        here = r + t * v
        return float(np.linalg.norm(here[:, b] - here[:, e]) + np.linalg.norm(here[:, e + 1] - here[:, b]))

    assert taken == pytest.approx(50.0 * h * ((length(1e-6) - length(-1e-6)) / 2e-6 / h) ** 2, rel=1e-6)
