"""Wheels that pull their lines up, as they may not leave them, are remarked with when they begin to, and how much."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.results import summary
from ropewalk.results.frame import RunInfo
from ropewalk.results.lost_contact import LostContactWatch
from ropewalk.results.table import rows
from ropewalk.simulate import simulate

ROPE = {"start": [0, 0], "end": [10, 0], "tension": 1e4, "mass": 1.0, "axial_stiffness": 1e6, "elements": 20}
MASS: dict[str, Any] = {"kind": "mass", "on": "rope", "mass": 30.0, "travel": {"speed": 5.0, "from": 3.0}}


def remarked(force: list[float], hold: float = 0.0, gravity: float = 9.81, **load: Any) -> list[str]:
    """What is said of vertical forces on a rope, 10 ms apart."""
    run = {"kind": "dynamic", "until": 0.2}
    tree = {"gravity": gravity, "lines": {"rope": ROPE}, "loads": {"ball": {**MASS, **load}}, "run": run}
    layout = SimpleNamespace(contact_load=("ball",), path="time")
    watch = LostContactWatch(cast(Any, layout), Scenario.model_validate(tree))
    vectors = np.stack([np.zeros(len(force)), force], axis=1)[:, None]
    path = 0.01 * np.arange(len(force))
    for part in (slice(0, 2), slice(2, None)):  # in two blocks
        of = {"contact_force": vectors[part], "hold_force": np.full_like(vectors[part], hold)}
        watch.see(cast(Any, SimpleNamespace(of=of, path=path[part])))
    return list(watch.messages(RunInfo()))


def test_who_pulls_is_named_with_when_and_how_much() -> None:
    (said,) = remarked([-300.0, -400.0, np.nan, 20.0, 90.0, -100.0])
    assert said.startswith("load ball: contact is lost from t = 0.03 s on: it pulls rope up with up to 90 N")
    assert said.endswith("write lift_off: true to let it leave the line")


@pytest.mark.parametrize(
    ("force", "more"),
    [
        ([-300.0, -400.0, 3.0], {}),  # less than a hundredth
        ([-300.0, -400.0, 90.0], {"lift_off": True}),
        ([-300.0, -400.0, 90.0], {"gravity": 0.0}),  # nothing presses it down: it is fixed to the rope
        ([-300.0, -400.0, 90.0], {"hold": 90.0}),  # what holds it along a steep line
        ([-300.0, -400.0, 90.0], {"kind": "trolley", "payload": {"mass": 5.0, "length": 1.0}}),  # runs on its rope
    ],
    ids=["little", "lift-off", "no weight", "hold force", "trolley"],
)
def test_who_may_or_does_not_is_not(force: list[float], more: dict[str, Any]) -> None:
    assert remarked(force, **more) == []


def test_a_wheel_on_humps_says_so_and_its_summary_tells_the_vertical_part(tmp_path: Path) -> None:
    """Over z = a (1 - cos k x) a mass of its own would fly where v^2 k^2 a > g."""
    x = np.linspace(-2.0, 12.0, 2801)
    np.savetxt(tmp_path / "humps.csv", np.stack([x, 0.01 * (1.0 - np.cos(np.pi * x))], axis=1), delimiter=",")
    beam = {
        "start": [0.0, 0.0], "end": [10.0, 0.0], "length": 10.0, "mass": 1000.0, "axial_stiffness": 1e9,
        "bending_stiffness": 1e11, "elements": 8, "profile": {"file": str(tmp_path / "humps.csv")},
    }  # fmt: skip
    load = {"kind": "mass", "on": "beam", "mass": 100.0, "travel": {"speed": 12.0, "from": 2.0}}
    run = {"kind": "dynamic", "geometry": "linearised", "until": 0.5, "every": 1e-3}
    found = simulate(Scenario.model_validate({"lines": {"beam": beam}, "loads": {"mass": load}, "run": run}))
    up = (found["contact_force"] - found["hold_force"]).values[:, 0, 1]
    assert np.nanmax(up) > 0.4 * 100.0 * 9.81  # 12^2 pi^2 0.01 - 9.81 of 9.81, and what swings
    (said,) = [line for line in str(found.attrs["warnings"]).splitlines() if "lift_off" in line]
    assert f"with up to {np.nanmax(up):.4g} N" in said
    (row,) = [row for row in rows(summary(found)) if row[0] == "of it downwards, mean"]
    assert row[2].startswith("-")
