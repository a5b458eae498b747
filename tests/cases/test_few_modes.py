"""A number of modes that leaves a part of a result out is reported, with the part and a number that is enough."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from ropewalk import load
from ropewalk.model import Scenario
from ropewalk.results.line_response import responses
from ropewalk.simulate import simulate

FILE = Path(__file__).parent / "five-modes.yaml"
BEAM = {"start": [0, 0], "end": [20, 0], "length": 20, "mass": 1e3, "bending_stiffness": 1e8, "axial_stiffness": 1e9,
        "elements": 10}  # fmt: skip
STRING = {"start": [0, 0], "end": [20, 0], "tension": 1e5, "mass": 2.0, "axial_stiffness": 1e7, "elements": 10}
PIER = {"pier": {"at": 10, "kind": "guided", "along": [1, 0]}}
FORCE: dict[str, Any] = {"kind": "force", "force": [0, -1e3]}
MASS = {"kind": "mass", "mass": 100.0}
NET = {"kind": "net", "corner": [0, 0, 0], "sides": [[4, 0, 0], [0, 3, 0]], "cells": [8, 6], "axial_stiffness": 1e4,
       "mass": 0.05, "tension": 100.0}  # fmt: skip


def run(structure: dict[str, Any], load: dict[str, Any], modes: int | None) -> xr.Dataset:
    line = {"lines": {"a": structure}} if "corner" not in structure else {"nets": {"a": structure}}
    travel = {"speed": 5.0, "from": 0.0, "at_end": "leave"}
    if "nets" in line:
        load, travel = {**load, "force": [0, 0, -1.0]}, {**travel, "path": [[0.5, 1.5], [3.5, 1.5]]}
    own = {**load, "on": "a", "travel": travel}
    how = {"kind": "linear", "until": 0.4, "every": 0.1} | ({} if modes is None else {"modes": modes})
    return simulate(Scenario.model_validate({**line, "loads": {"w": own}, "run": how}))


def warned(result: xr.Dataset) -> str:
    return "\n".join(one for one in str(result.warnings).splitlines() if "modes" in one and "string a sum" not in one)


def test_five_modes_of_a_bridge_are_reported_with_the_shear_that_they_miss() -> None:
    five = simulate(load(FILE))
    found = re.search(r"5 modes miss up to .*?([\d.]+) % of the shear .* write run.modes: (\d+)", warned(five))
    assert found is not None
    all_modes = simulate(load(FILE, ["run.modes=null"]))
    shear = [abs(responses(one)[0]["deck"].at(10.0)["shear"]).max() for one in (five, all_modes)]
    assert shear == pytest.approx([245.8e3, 295.6e3], rel=1e-3)  # as in the case
    assert float(found[1]) == pytest.approx(100.0 * (1.0 - shear[0] / shear[1]), abs=5.0)  # % of shear, static instead
    assert not warned(simulate(load(FILE, [f"run.modes={found[2]}"])))


@pytest.mark.parametrize(
    ("structure", "load", "few"),
    [(BEAM, FORCE, 2), (BEAM, MASS, 2), (STRING, FORCE, 9), ({**BEAM, "supports": PIER}, FORCE, 2),
     ({**BEAM, "supports": PIER}, MASS, 2), (NET, FORCE, 4)],
    ids=["beam, force", "beam, mass", "string", "pier, force", "pier, mass", "net"],
)  # fmt: skip
def test_few_modes_are_reported_and_all_are_not(structure: dict[str, Any], load: dict[str, Any], few: int) -> None:
    assert re.search(rf"{few} modes", warned(run(structure, load, few)))
    assert not warned(run(structure, load, None))
