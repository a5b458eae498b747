"""The step of explicit motion is bound by the largest frequency, 2/omega, whatever the structure.

Source: the largest generalised eigenvalue of stiffness and mass at rest.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse.linalg as sla

from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.system.dynamics.stability import WITHOUT_LOADS
from ropewalk.system.equilibrium.still import SystemStatics
from ropewalk.system.small_motion.spectrum import equations_of
from system_cases import HELD_TAUT, deck_on_a_hanger

CALM = {"wind": {"direction": [1, 0], "speed": 0.0}}
LINES: dict[str, dict[str, Any]] = {
    "taut rope": {"r": {**HELD_TAUT, "axial_stiffness": 1e6, "wind_drag": 1e-9}},
    "slack rope": {"r": {**HELD_TAUT, "tension": None, "length": 21.0, "axial_stiffness": 1e5, "wind_drag": 1e-9}},
    "beam": {"r": {**HELD_TAUT, "axial_stiffness": 1e8, "bending_stiffness": 1e6, "elements": 100}},
    "on a bed": {"r": {**HELD_TAUT, "axial_stiffness": 1e6, "foundation": 1e6, "wind_drag": 1e-9}},
    "network": deck_on_a_hanger(32),
}


@pytest.mark.parametrize("lines", LINES.values(), ids=LINES)
def test_the_step_is_bound_by_the_largest_frequency(lines: dict[str, Any]) -> None:
    """Bounds of single lines are those of endless ones: right to 0.2 %; joints and beds cost up to an eighth."""
    tree = {"lines": lines, **CALM, "gravity": 9.81, **({"joints": {}} if len(lines) > 1 else {})}
    still = SystemStatics(Scenario.model_validate({**tree, "run": {"kind": "equilibrium"}}), RunInfo(), 0.0, space=True)
    found = equations_of(still)
    square = float(sla.eigsh(found.stiffness, 1, found.mass, which="LM", return_eigenvectors=False)[0])
    moves, run_info = {"kind": "dynamic", "until": 1.0}, RunInfo()
    SystemMotion(Scenario.model_validate({**tree, "run": moves}), run_info, np.array([0.0, 1.0]))
    bound = 2.0 / np.sqrt(square) / (run_info.step / WITHOUT_LOADS)
    assert 0.998 < bound < (1.002 if len(lines) == 1 and "foundation" not in lines["r"] else 1.12)
