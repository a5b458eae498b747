"""Lines on saddles: tension by height, Euler and Eytelwein's friction, and a bead that goes over one by its energy."""

from __future__ import annotations

import json
import re
from typing import Any

import numpy as np
import pytest

from ropewalk.errors import ScenarioError
from ropewalk.model.scenario import Scenario
from ropewalk.results.statistics import summary
from ropewalk.scenario import loads
from ropewalk.simulate import simulate, spectrum_of

LENGTH, EA, MASS, RADIUS = 20.0, 1e6, 2.0, 2.0
TOWER: dict[str, Any] = {"at": [10.0, 3.0], "radius": RADIUS}
AT_REST = {"kind": "equilibrium"}


def tramway(run: dict[str, Any], load: dict[str, Any] | None = None, tower: dict[str, Any] = TOWER, **keys: Any) -> Scenario:
    """A rope from an anchor over a saddle to a slider that a constant force pulls."""
    rope = {
        "start": [0.0, 0.0], "end": [20.0, 1.0], "length": 20.72, "mass": MASS, "axial_stiffness": EA,
        "end_support": {"kind": "guided", "along": [1.0, 0.0], "force": 1e4}, "saddles": {"tower": tower},
        "elements": 100, **keys,
    }  # fmt: skip
    found = {"load": {"on": "rope", **load}} if load is not None else {}
    return loads(json.dumps({"gravity": 9.81, "lines": {"rope": rope}, "loads": found, "run": run}))
