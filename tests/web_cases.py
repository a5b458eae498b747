"""Small networks for tests: four taut lines that meet in a joint, and a line that hangs on another one."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.model import Scenario
from ropewalk.simulate import spectrum_of

EA, N = 1e6, 8
TENSION = {"west": 1000.0, "east": 1000.0, "south": 600.0, "north": 600.0}
SPAN = {"west": [-10, 0, 0], "east": [10, 0, 0], "south": [0, -6, 0], "north": [0, 6, 0]}
RHO = {"west": 0.5, "east": 0.5, "south": 0.3, "north": 0.3}


def cross(load: dict[str, Any] | None = None, **more: Any) -> Scenario:
    return Scenario.model_validate(cross_tree(load, **more))


def cross_tree(load: dict[str, Any] | None = None, **more: Any) -> dict[str, Any]:
    """Four taut lines that meet in a joint, in a horizontal plane."""
    own = {"axial_stiffness": EA, "elements": N, "end": [0, 0, 0], "end_support": {"kind": "joined", "to": "knot"}}
    damped = more.pop("damped", {})
    lines = {name: {**own, **damped, "start": SPAN[name], "tension": TENSION[name], "mass": RHO[name]} for name in SPAN}
    loads = {"loads": {"load": load}} if load is not None else {}
    return {"gravity": 0.0, "joints": {"knot": {}}, "lines": lines, **loads, "run": {"kind": "equilibrium"}, **more}


HUNG = {
    "lines": {
        "rope": {"start": [0, 0], "end": [20, 0], "length": 20.3, "mass": 1.0, "axial_stiffness": 1e4, "elements": 24},
        "hanger": {"start": [9, 6], "end": [9, 0], "length": 6.0, "mass": 0.2, "axial_stiffness": 1e4, "elements": 8,
                   "end_support": {"kind": "joined", "to": "rope", "at": 8.5}},
    }
}  # fmt: skip


def frequencies(scenario: Scenario, how_many: int) -> NDArray[np.float64]:
    """Lowest natural angular frequencies at rest, rad/s."""
    modes = spectrum_of(scenario, how_many=how_many).modes
    assert modes is not None
    return modes.frequency
