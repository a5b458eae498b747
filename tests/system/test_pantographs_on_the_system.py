"""Pantographs below runs and ties: implicit methods, whirling starts and droppers that tear, superposition of modes.

Sources: the engine of wires, an independent formulation (control points of cubic splines, Störmer's method); explicit
steps; Radau's and Lobatto's methods beside each other; elasticity from form finding; small motion step by step.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pydantic import ValidationError

from overhead_cases import EN_2002
from ropewalk.capabilities import SUPERPOSED, SYSTEM, WIRES, engine_of
from ropewalk.model import Linear, Scenario
from ropewalk.overhead.section import elasticity, section_of
from ropewalk.results.frame import RunInfo
from ropewalk.simulate import output_times, simulate, spectrum_of
from ropewalk.system.small_motion.superposed import Superposed
from system_cases import computed

DROPPERS: dict[str, Any] = {"at": [3, 9, 15, 21, 27], "stiffness": "100 kN/m"}
LINE: dict[str, Any] = {
    **EN_2002, "spans": {"count": 2, "length": "30 m"}, "element": 1.0, "droppers": DROPPERS, "analysed_spans": [1, 2],
}  # fmt: skip
BARS = {**LINE, "droppers": {**DROPPERS, "pushes": "100 kN/m"}}
PANTOGRAPH: dict[str, Any] = {"kind": "pantograph", "model": "en50318-2002"}
MAY_BE = ("completed", "doubtful")


def scenario(line: dict[str, Any] = LINE, load: dict[str, Any] | None = None, **run: Any) -> Scenario:
    load = {"travel": {"speed": 20.0, "from": 18.0}, **PANTOGRAPH, **(load or {})}
    run = {"kind": "dynamic", "until": 0.4, "every": 0.02} | run
    return Scenario.model_validate(
        {"overhead_lines": {"line": line}, "loads": {"head": {**load, "on": "line"}}, "run": run}
    )


def heights(result: xr.Dataset) -> Any:
    return result["body_position"].values[:, :, -1]


def missed(result: xr.Dataset) -> float:
    """What the audit misses at most, over what the pantograph has been given, J/J."""
    work = result["energy"].sel(form="load_work").values
    return float(np.abs(result["energy"].sel(form="imbalance")).max() / np.abs(work).max())


@pytest.mark.parametrize("geometry", ["nonlinear", "linearised"])
def test_implicit_steps_go_where_explicit_ones_and_wires_do(geometry: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Explicit steps have the head at a place of x, implicit ones at a particle, which moves by a millimetre."""
    asked = scenario(method="implicit", geometry=geometry, accuracy=1e-5)
    assert engine_of(asked) is SYSTEM
    assert engine_of(scenario(geometry=geometry)) is WIRES
    found = simulate(asked)
    sixth = simulate(scenario(method="rkn6", geometry=geometry, accuracy=1e-5))
    assert sixth.attrs["method"] == "rkn6"
    explicit = computed(scenario(geometry=geometry), SYSTEM, monkeypatch, MAY_BE)
    wires = simulate(scenario(geometry=geometry))
    rise = float(np.ptp(heights(found)))
    print(
        geometry, "radau-lobatto", np.abs(heights(found) - heights(sixth)).max(),
        "explicit", np.abs(heights(found) - heights(explicit)).max(), "wires",
        np.abs(heights(found) - heights(wires)).max(), "rise", rise, "audit", missed(found), missed(explicit),
    )  # fmt: skip
    np.testing.assert_allclose(heights(found), heights(sixth), rtol=0.0, atol=1e-5)
    np.testing.assert_allclose(heights(found), heights(explicit), rtol=0.0, atol=2e-4)
    np.testing.assert_allclose(heights(found), heights(wires), rtol=0.0, atol=0.05 * rise)
    force, own = (result["contact_force"].values[:, 0, -1] for result in (found, explicit))
    np.testing.assert_allclose(force, own, rtol=0.0, atol=2.0)
    assert max(missed(found), missed(explicit)) < 1e-3
    assert np.abs(found["contact_force"].values[:, 0, 0]).max() < 1e-6  # a head pushes upwards only


def test_orders_are_those_of_the_methods() -> None:
    """A head that stands and is pressed ever harder, below bars: nothing slackens, nothing jumps."""
    found: dict[tuple[str, int], Any] = {}
    load = {"travel": {"speed": 0.0, "from": 20.0}, "ramp": 0.4, "static_force": "60 N"}
    for method in ("implicit", "rkn6"):
        for steps in (8, 32, 64):
            run = {"until": 0.4, "every": 0.4, "step": 0.4 / steps, "accuracy": "1 m", "geometry": "linearised"}
            found[method, steps] = heights(simulate(scenario(BARS, load, method=method, **run)))[-1]
        first, second = (np.abs(found[method, n] - found[method, 64]).max() for n in (8, 32))
        print(method, first, second, 0.5 * np.log2(first / second))
        assert second < 1e-9  # measured 5e-10 and 8e-11, orders 4.5 and 4.3: short waves of the mesh ring on
        assert 0.5 * np.log2(first / second) > 4.0


def test_droppers_tear_where_their_strength_is_reached() -> None:
    """Implicit steps end there: both methods say when to a microsecond, whatever their steps."""
    line = {**LINE, "droppers": {**DROPPERS, "strength": "150 N", "cut": {"droppers": [[1, 2]], "time": 0.05}}}
    load = {"kind": "force", "force": {"time": [0.0, 0.3], "value": [[0.0, 0.0], [0.0, -300.0]]}, "model": None,
            "travel": {"speed": 0.0, "from": 24.0}}  # fmt: skip
    load = {key: value for key, value in load.items() if value is not None}
    runs = [{"method": "implicit"}, {"method": "rkn6"}, {"method": "implicit", "step": "2 ms"}]
    told = []
    for run in runs:
        tree = scenario(line, {"travel": {"speed": 0.0, "from": 24.0}}, until=0.3, every=0.1, **run).model_dump()
        found = simulate(Scenario.model_validate({
            "overhead_lines": {"line": line}, "loads": {"pull": {**load, "on": "line"}}, "run": tree["run"],
        }))  # fmt: skip
        pulls = [float(pull) for pull in re.findall(r"failed under ([\d.]+) N", found.attrs["warnings"])]
        print(run, found.attrs["warnings"])
        assert pulls[1:] == pytest.approx([150.0] * (len(pulls) - 1), abs=0.1)
        assert len(pulls) > 1
        told.append(found["position"].values[-1, :, -1])
    np.testing.assert_allclose(told[1], told[0], rtol=0.0, atol=1e-4)
    np.testing.assert_allclose(told[2], told[0], rtol=0.0, atol=1e-4)


@pytest.mark.parametrize("geometry", ["nonlinear", "linearised"])
def test_a_line_whirls_as_fast_as_its_mode_at_right_angles_swings(geometry: str) -> None:
    start = {"kind": "mode", "amplitude": 1e-3, "whirl": True}
    tree = scenario(until=0.25, every=0.01, geometry=geometry, start=start).model_dump()
    asked = Scenario.model_validate({"overhead_lines": {"line": LINE}, "run": tree["run"]})
    assert engine_of(asked) is SYSTEM
    found = simulate(asked)
    modes = spectrum_of(asked).modes
    assert modes is not None
    aside = next(i for i, shape in enumerate(modes.shape) if (shape[:, 1] ** 2).sum() > (shape[:, ::2] ** 2).sum())
    speed = float(np.abs(found["velocity"].values[0]).max())
    assert speed == pytest.approx(1e-3 * modes.frequency[aside], rel=1e-9)
    away = found["position"].values - modes.position
    assert np.abs(away[0, :, 2]).max() == pytest.approx(1e-3, rel=1e-6)
    quarter = 0.5 * np.pi / modes.frequency[aside]
    y = np.abs(away[:, :, 1]).max(axis=1)
    print("quarter", quarter, "y", y.max(), found["time"].values[y.argmax()])
    assert y.max() == pytest.approx(1e-3, rel=0.01)
    assert found["time"].values[y.argmax()] == pytest.approx(quarter, abs=0.01)
    with_head = simulate(scenario(until=0.1, every=0.02, geometry=geometry, start=start))
    assert missed(with_head) < 1e-2


def superposed(asked: Scenario, **run: Any) -> tuple[list[Any], RunInfo]:
    run_info = RunInfo()
    linear = Linear(until=asked.run.until, every=asked.run.every, **run)
    return list(Superposed(asked, linear, output_times(linear), run_info).frames()), run_info


def test_modes_move_as_small_motion_does_step_by_step() -> None:
    """Below bars, from where the wire comes down so that contact stays; ties turn, which is of the second order.

    Not from a node, 15.5 m: without a force yet, rounding decides there whether implicit steps begin in contact, and
    with some kernels of OpenBLAS they end as diverged.
    """
    load = {"ramp": 0.1, "static_force": "60 N", "travel": {"speed": 20.0, "from": 15.6}}
    asked = scenario(BARS, load, method="implicit", geometry="linearised", accuracy=1e-6, until=0.3)
    steps, (modes, run_info) = simulate(asked), superposed(asked)
    assert not run_info.doubts
    assert "stay taut" in run_info.reason
    assert engine_of(scenario(BARS, load, kind="linear", until=0.3)) is SUPERPOSED
    body = np.array([frame.body_position[:, -1] for frame in modes])
    force = np.array([frame.contact_force[0, -1] for frame in modes])
    own = steps["contact_force"].values[:, 0, -1]
    tie = np.array([frame.tie_force for frame in modes])
    reaction = np.array([frame.reaction for frame in modes])
    print(own[:4], force[:4])
    print(
        np.abs(body - heights(steps)).max(), np.abs(force - own).max(), np.abs(own).max(),
        np.abs(tie - steps["tie_force"].values).max(), np.abs(reaction - steps["reaction"].values).max(),
    )  # fmt: skip
    np.testing.assert_allclose(body, heights(steps), rtol=0.0, atol=1e-5)
    np.testing.assert_allclose(force[1:], own[1:], rtol=0.0, atol=0.02 * np.abs(own).max())
    np.testing.assert_allclose(tie, steps["tie_force"].values, rtol=0.0, atol=0.02 * 86.0)


def test_a_force_that_stands_raises_the_wire_by_its_elasticity() -> None:
    """A newton on a line in a thick fluid, beside what form finding answers for wires of constant tension."""
    wires = {key: {**LINE[key], "drag": 60.0} for key in ("contact_wire", "messenger_wire")}
    line = {**LINE, **wires, "element": 0.5}
    for at in (15.0, 22.0):
        height = []
        for up in (1.0, 2.0):
            force = {"kind": "force", "force": [0.0, up], "travel": {"speed": 0.0, "from": at}}
            tree = {"overhead_lines": {"line": line}, "loads": {"up": {**force, "on": "line"}},
                    "run": {"kind": "linear", "until": 400.0, "every": 200.0, "modes": 40}}  # fmt: skip
            asked = Scenario.model_validate(tree)
            height.append(simulate(asked)["contact_position"].values[:, 0, -1])
            assert height[-1][2] == pytest.approx(height[-1][1], abs=1e-6)  # it stands still by then
        _, rise = elasticity(section_of("line", asked.overhead_lines["line"]), 1.0, stations=np.array([at]))
        print(at, height[1][2] - height[0][2], rise)
        assert height[1][2] - height[0][2] == pytest.approx(float(rise[0]), rel=0.03)  # measured 0.02 and 0.01


def test_what_is_no_superposition_is_refused_in_plain_words() -> None:
    failing = {**LINE, "droppers": {**DROPPERS, "strength": "400 N"}}
    with pytest.raises(ValidationError, match="other modes after a dropper fails"):
        scenario(failing, kind="linear")
    with pytest.raises(ValidationError, match="is not implemented for pantographs of the sixth order"):
        scenario(LINE, {"irregularity": "rough.csv"}, method="implicit")
    found, run_info = superposed(scenario(LINE, {"ramp": 1.0}, until=0.2))
    assert found
    assert "would have lost contact" in str(run_info.doubts)
    found, run_info = superposed(scenario(LINE, {"ramp": 0.0, "static_force": "600 N"}, until=0.3))
    assert "would be slack" in str(run_info.doubts)
