"""The depth under a load on a net or membrane is that of its place, wherever its path begins and leads to."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

FILE = Path(__file__).parent / "depth-on-a-membrane.yaml"
RECTANGLE: dict[str, Any] = {"corner": [0, 0, 0], "sides": [[7.519, 0, 0], [0, 3.243, 0]], "cells": [6, 4]}
OUTLINE: dict[str, Any] = {"boundary": [[0, 0, 0], [7.5, 0, 0], [6, 4, 0], [1, 3.5, 0]], "spacing": 0.8}
MEMBRANE = {"kind": "membrane", "stiffness": 287e3, "tension": 780, "mass": 1}
NET = {"kind": "net", "axial_stiffness": 287e3, "tension": 780, "mass": 1, "mesh": 0.5}
# Paths through [2.466, 1.495], and how far that is from where they begin, m.
PATHS = [
    ([[2.466, 1.495], [4, 1.495]], 0.0),
    ([[2.166, 1.495], [4, 1.495]], 0.3),
    ([[1.766, 1.495], [6, 1.495]], 0.7),
    ([[4.066, 1.495], [1, 1.495]], 1.6),
    ([[2.466, 1.0], [2.466, 2.5]], 0.495),
    ([[2.166, 1.095], [3.366, 2.695]], 0.5),
    ([[1, 1], [2.466, 1], [2.466, 2]], 1.466 + 0.495),
]


def depth(sheet: dict[str, Any], path: Any, start: float, **more: Any) -> float:
    travel = {"speed": 1.0, "path": path, "from": start}
    push = {"kind": "force", "on": "net", "force": [0, 0, -96.6], "travel": travel}
    ask = {"gravity": 0.0, "nets": {"net": sheet}, "loads": {"f": push}, "run": {"kind": "equilibrium"}, **more}
    return -float(simulate(Scenario.model_validate(ask)).contact_position.values[-1, 0, 2])


def test_a_path_that_begins_at_the_load_gives_the_depth_of_one_that_begins_before() -> None:
    before = simulate(load(FILE))
    here = ["loads.f.travel.path=[[2.466 m, 1.495 m], [4 m, 1.495 m]]", "loads.f.travel.from=0 m"]
    depths = [-float(each.contact_position.values[0, 0, 2]) for each in (before, simulate(load(FILE, here)))]
    assert depths == pytest.approx([0.0284, 0.0284], rel=0.003)  # an eighth of a cell of interpolation is left


@pytest.mark.parametrize("laid", [RECTANGLE, OUTLINE], ids=["rectangle", "outline"])
@pytest.mark.parametrize("fabric", [MEMBRANE, NET], ids=["membrane", "net"])
def test_it_does_not_depend_on_the_path(fabric: dict[str, Any], laid: dict[str, Any]) -> None:
    depths = [depth({**fabric, **laid}, path, start) for path, start in PATHS]
    # What is left of the path is the interpolation over an eighth of a cell.
    assert np.ptp(depths) < 0.005 * np.mean(depths)


def test_nor_does_it_in_motion() -> None:
    run = {"kind": "dynamic", "until": 0.02, "every": 0.02, "start": {"with_loads": True}}
    depths = [depth({**MEMBRANE, **RECTANGLE}, path, start, run=run) for path, start in PATHS[:4]]
    assert np.ptp(depths) < 0.02 * np.mean(depths)  # the third and fourth move 20 mm apart meanwhile
