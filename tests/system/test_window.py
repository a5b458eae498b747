"""A window on the system, `run.window`: what is far from the loads stands still.

Source: the same motion without a window.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.capabilities import SYSTEM, WIRES, engine_of
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

ROPE = {
    "start": [0, 0],
    "end": [60, 0],
    "length": 60.1,
    "mass": 1.0,
    "axial_stiffness": 1e5,
    "elements": 60,
    "drag": 0.5,
}
HUNG = {
    "rope": ROPE,
    "hanger": {"start": [18, 4], "end": [18, 0], "length": 4.05, "mass": 0.5, "axial_stiffness": 5e4, "elements": 6,
               "end_support": {"kind": "joined", "to": "rope", "at": 18.03}},
}  # fmt: skip
LINES: dict[str, dict[str, Any]] = {
    "slack rope": {"rope": {**ROPE, "axial_damping": 50.0}},
    "hung": HUNG,
    "saddle": {"rope": {**ROPE, "supports": {"saddle": {"at": 20.0, "kind": "fixed", "position": [19.95, 0.1]}}}},
    "sheave": {"rope": {**ROPE, "length": 59.9, "sheaves": {"wheel": {"at": [20.0, 0.3], "friction": 0.0}}}},
    "shoe": {"rope": {**ROPE, "length": 59.9,
                      "saddles": {"shoe": {"at": [20.0, 0.3], "radius": 5.0, "friction": 0.2}}}},
    "beam on a pier": {"rope": {**ROPE, "length": 60.0, "bending_stiffness": 1e6, "axial_stiffness": 1e8,
                                "supports": {"pier": {"at": 20.0, "kind": "fixed"}}}},
}  # fmt: skip


def asked(lines: dict[str, Any], window: float | None, **keys: Any) -> Scenario:
    loads = {"p": {"kind": "mass", "on": "rope", "mass": 10.0, "travel": {"speed": 20.0, "from": 10.0}}}
    run = {"kind": "dynamic", "until": 0.3, "every": 0.05, "geometry": "linearised", **keys.pop("run", {})}
    own = {} if window is None else {"window": window}
    return Scenario.model_validate({"gravity": 9.81, "lines": lines, "loads": loads, "run": {**run, **own}, **keys})


def without_stretch() -> dict[str, Any]:
    return {k: v for k, v in ROPE.items() if k != "axial_stiffness"} | {"law": {"kind": "inextensible"}}


def imbalance(result: xr.Dataset) -> float:
    return float(np.abs(result.energy.sel(form="imbalance")).max())


@pytest.mark.parametrize("lines", LINES.values(), ids=LINES)
def test_what_is_near_a_load_moves_as_without_a_window_and_the_rest_stands_still(lines: dict[str, Any]) -> None:
    """One as long as the line is none; transverse waves run at 50 m/s and less, axial ones at 316 m/s and more."""
    assert engine_of(asked(lines, 8.0)) is SYSTEM
    none = None if engine_of(asked(lines, None)) is SYSTEM else 1e4  # beams are for wires without
    whole, wide, narrow = (simulate(asked(lines, window)) for window in (none, 100.0, 8.0))
    assert wide.position.values.tolist() == whole.position.values.tolist()
    assert wide.reaction.values == pytest.approx(whole.reaction.values, abs=1e-9)
    here, there = narrow.contact_position.values, whole.contact_position.values
    sag = np.abs(there[:, 0, -1] - there[0, 0, -1]).max()
    print(np.abs(here - there).max(), sag, imbalance(narrow), imbalance(whole))
    stiff = bool(lines["rope"].get("bending_stiffness"))  # it bends far beyond 8 m, and is held there
    assert np.abs(here - there).max() < (0.7 if stiff else 0.03) * sag
    moved = np.abs(narrow.position.values - narrow.position.values[0]).max(axis=(0, 2))
    far = narrow.position.values[0, :, 0] > 10.0 + 6.0 + 9.6 + 4.0  # 1.2 windows, four nodes of links of 1 m
    assert far.any()
    assert (moved[far] == 0.0).all()
    assert np.abs(whole.position.values - whole.position.values[0]).max(axis=(0, 2))[far].max() > 0.0
    assert imbalance(narrow) < imbalance(whole) + 1e-5 * 2e3  # of the load's energy


def test_what_moves_far_from_a_load_goes_without_a_window() -> None:
    mode = {"start": {"kind": "mode", "amplitude": 0.01}}
    with pytest.raises(ValueError, match=r"a window with start\.kind: mode is not implemented"):
        asked(LINES["hung"], 8.0, run=mode)
    with pytest.raises(ValueError, match="wind moves the whole line, not only its part near a load"):
        asked({"rope": {**ROPE, "wind_drag": 0.1}}, 8.0, wind={"direction": [0, 1, 0], "speed": 9.0})
    table = {"time": [0, 1], "value": [[0, 0], [0, 1]]}
    with pytest.raises(ValueError, match=r"lines\.rope\.end_support moves its line far from a load, too"):
        asked({"rope": {**ROPE, "end_support": {"kind": "moving", "displacement": table}}}, 8.0)
    with pytest.raises(ValueError, match="a line that does not stretch passes tension on at once"):
        asked({"rope": without_stretch()}, 8.0)
    stiff = {"rope": {**ROPE, "length": 60.0, "bending_stiffness": 1e6, "axial_stiffness": 1e8}}
    assert engine_of(asked(stiff, 8.0)) is WIRES


def test_a_line_that_does_not_stretch_moves_far_from_its_load_at_once() -> None:
    """That is why it has no window: its end feels a load 50 m away after 5 ms, one that stretches after 0.16 s."""
    ends = []
    for rope in (without_stretch(), ROPE):
        short = {"geometry": "nonlinear", "until": 0.005, "every": 0.005}
        found = simulate(asked({"rope": rope}, None, run=short))
        at = found.tension.values[:, -1]
        ends.append(abs(at[-1] / at[0] - 1.0))
    print(ends)
    assert ends[0] > 1e3 * ends[1]
    assert ends[0] > 1e-3
