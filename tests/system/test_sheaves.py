"""Lines over sheaves at rest: tensions on both sides, capstans, blocks, and ropes that run out.

In motion: tests/system/test_lines_over_sheaves.py.

Friction: Euler and Eytelwein, T2/T1 = exp(mu theta).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.errors import EquilibriumError
from ropewalk.model import Scenario
from ropewalk.simulate import simulate


def run_of(lines: dict[str, Any], run: dict[str, Any] | None = None, **more: Any) -> xr.Dataset:
    return simulate(Scenario.model_validate({"lines": lines, "run": run or {"kind": "equilibrium"}, **more}))


def over(friction: float = 0.0, **changes: Any) -> dict[str, Any]:
    """A rope from (0, 0) over a sheave at (5, 3) to (12, 1)."""
    return {
        "start": [0, 0], "end": [12, 1], "length": 14.0, "mass": 1.0, "axial_stiffness": 1e5, "elements": 100,
        "sheaves": {"wheel": {"at": [5, 3], "friction": friction}}, **changes,
    }  # fmt: skip


def test_without_friction_a_heavy_rope_has_one_tension_at_its_sheave() -> None:
    """Along an elastic catenary T + T^2 / (2 EA) - w z is the same: from both ends up to the sheave at z = 3."""
    missed = []
    for n in (50, 100, 200):
        result = run_of({"rope": over(elements=n)})
        one, two = (
            _top(float(np.linalg.norm(result.reaction.sel(support=f"rope.{end}").values[0])), 3.0 - z)
            for end, z in (("start", 0.0), ("end", 1.0))
        )
        missed.append(abs(one - two))
    print(missed)
    # Wherever the sheave stands on its link, half of the link's weight is on either side: off by up to that half.
    assert np.all(np.array(missed) < 0.5 * 9.81 * 14.0 / np.array([50, 100, 200]))


def _top(end: float, rise: float) -> float:
    """Tension `rise` above an end with a given one."""
    stored = end + end**2 / 2e5 + 9.81 * rise
    return 1e5 * (np.sqrt(1.0 + 2.0 * stored / 1e5) - 1.0)


def test_the_support_of_a_sheave_bears_both_tensions() -> None:
    result = run_of({"rope": over(mass=1e-6, length=13.0, elements=20)})
    T, r = result.tension.values[0], result.position.values[0]
    assert np.ptp(T) < 1e-6 * T[0]  # of one tension all along, but for a weight of 1e-4 N
    ways = np.array([[-5.0, -3.0], [7.0, -2.0]])
    units = ways / np.linalg.norm(ways, axis=1)[:, None]
    assert result.reaction.sel(support="rope.wheel").values[0] == pytest.approx(-T[0] * units.sum(axis=0), rel=1e-5)
    assert np.linalg.norm(ways, axis=1).sum() == pytest.approx(13.0 * (1.0 + T[0] / 1e5), rel=1e-9)
    assert r[0] == pytest.approx([0.0, 0.0])


def test_a_rope_slips_at_the_ratio_of_the_capstan_and_sticks_below_it() -> None:
    friction = 0.2
    load = {"kind": "force", "on": "rope", "force": [0, -500.0], "travel": {"speed": 1, "from": 0.3}}
    rope = over(friction, mass=1e-6, length=13.05, elements=60)
    result = run_of({"rope": rope}, {"kind": "quasistatic", "positions": 60}, loads={"p": load}, gravity=0.0)
    # The load walks over the first span only, up to the sheave.
    ratios, states = [], []
    for i in range(result.sizes["load_path"]):
        xi = float(result.contact_xi.values[i, 0])
        if xi > 5.3:
            break
        behind, ahead = result.contact_tension.values[i, 0]
        far = result.tension.values[i, -2]
        place, wheel = result.contact_position.values[i, 0], np.array([5.0, 3.0])
        one, two = wheel - place, np.array([12.0, 1.0]) - wheel
        angle = np.arccos(one @ two / np.linalg.norm(one) / np.linalg.norm(two))
        assert behind > 0.0
        ratios.append(np.log(ahead / far) / (friction * angle))
    states = np.array(ratios)
    print(states)
    assert np.abs(states).max() <= 1.0 + 1e-6
    assert states.max() == pytest.approx(1.0, abs=1e-6)  # it slips towards the load as that gets heavier for it
    assert states.min() < 0.9  # and sticks on the way back


@pytest.mark.parametrize(("length", "stiffness", "mass", "push", "xi"), [
    (14.518437672172116, 36622.92361190748, 0.4245031473212446, 686.7, 6.0),
    (14.387722179937077, 184312.6094654312, 0.6380714980029832, 354.4932364521143, 7.718963687822072),
])  # fmt: skip
def test_a_rope_that_rubs_does_not_rest_folded(
    length: float, stiffness: float, mass: float, push: float, xi: float
) -> None:
    """Newton's method found it folded, with -1974 and -10704 N, and friction kept the energy from being looked at."""
    rope = {
        "start": [0, 0], "end": [14, 1], "length": length, "mass": mass, "axial_stiffness": stiffness, "elements": 60,
        "sheaves": {"wheel": {"at": [4, 1.5], "friction": 0.2}},
    }  # fmt: skip
    load = {"kind": "force", "on": "rope", "force": [0, -push], "travel": {"speed": 1, "from": xi}}
    result = run_of({"rope": rope}, loads={"p": load})
    assert result.tension.values.min() > 0.0
    assert result.reaction.values[0].sum(axis=0) == pytest.approx([0.0, push + 9.81 * mass * length], abs=1e-6)


def test_a_rope_that_cannot_rest_before_it_runs_out_says_so() -> None:
    joined = {"kind": "joined", "to": "bob"}
    rope = {**over(), "start": [0.0, -1.0], "end": [1e-3, -9.0], "length": 10.0, "end_support": joined,
            "start_support": {"kind": "guided", "along": [0, 1]}, "sheaves": {"wheel": {"at": [0, 0]}}}  # fmt: skip
    with pytest.raises(EquilibriumError, match="runs over a sheave up to its end"):
        run_of({"rope": rope}, joints={"bob": {"mass": 5.0}})


def test_a_block_in_a_loop_hangs_on_twice_the_tension() -> None:
    rope = {
        "start": [0, 0], "end": [1, 0.3], "length": 4.5, "mass": 1e-6, "axial_stiffness": 1e5, "elements": 30,
        "sheaves": {"block": {"at": [0.5, -2.0], "to": "hook"}},
    }  # fmt: skip
    result = run_of({"rope": rope}, joints={"hook": {"mass": 10.0}})
    tension = result.tension.values[0]
    assert tension == pytest.approx(tension[0], rel=1e-5)
    # An ellipse with the supports as foci: both parts have the same slope, cos = d / length across.
    across = 1.0 / (4.5 * (1.0 + tension[0] / 1e5))
    assert 2.0 * tension[0] * np.sqrt(1.0 - across**2) == pytest.approx(98.1, rel=1e-6)
    assert result.reaction.values[0].sum(axis=0) == pytest.approx([0.0, 98.1], abs=1e-3)


def test_slow_motion_ends_where_a_load_comes_to_a_sheave() -> None:
    """On the link over a sheave a load stood for a link more, with 1097 N beside it instead of 480."""
    load = {"kind": "force", "on": "rope", "force": [0, -500.0], "travel": {"speed": 1, "from": 4.5}}
    rope = over(length=13.0, mass=1e-6, elements=20)
    result = run_of({"rope": rope}, {"kind": "quasistatic", "positions": 30}, loads={"p": load}, gravity=0.0)
    assert "sheave" in result.attrs["advice"]
    assert 5.0 < float(result.contact_xi.values[-1, 0]) < 6.0
