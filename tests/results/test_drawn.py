"""Lines are drawn through the loads that bend them: on splines, nodes beside a load lie on a curve.

Source: a rope without weight below a force is two straight lines.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import xarray as xr

from ropewalk.mechanics.chain import Array
from ropewalk.model import Scenario
from ropewalk.results.picture import drawn_position
from ropewalk.simulate import simulate

ROPE = {"start": [0, 0], "end": [20, 0], "length": 20.3, "mass": 1e-3, "axial_stiffness": 1e5, "elements": 20}


def result(loads: dict[str, Any], **line: Any) -> xr.Dataset:
    asked = {"kind": "dynamic", "until": 1e-4, "every": 1e-4, "start": {"with_loads": True}}
    lines = {"rope": {**ROPE, "wind_drag": 1e-30, **line}}
    wind = {"direction": [1, 0], "speed": 0.0}
    return simulate(Scenario.model_validate({"lines": lines, "loads": loads, "run": asked, "wind": wind}))


def force(at: float) -> dict[str, Any]:
    return {"kind": "force", "on": "rope", "force": [0.0, -800.0], "travel": {"from": at, "speed": 0.0}}


def away(points: Array, corners: Array) -> float:
    """How far points are from a polyline, m."""
    found = np.full(len(points), np.inf)
    for a, b in pairwise(corners):
        part = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        found = np.minimum(found, np.linalg.norm(points - a - part[:, None] * (b - a), axis=1))
    return float(found.max())


@pytest.mark.parametrize("places", [(3.3,), (3.3, 10.15), (3.3, 4.1, 10.0)])
def test_a_rope_without_weight_is_drawn_straight_from_load_to_load(places: tuple[float, ...]) -> None:
    found = result({f"f{k}": force(at) for k, at in enumerate(places)})
    nodes, drawn = found.position.values[0], drawn_position(found)[0]
    corners = np.concatenate([nodes[:1], found.contact_position.values[0], nodes[-1:]])
    assert away(corners, nodes) > 0.05  # m, of the loads from what was drawn: links are a metre long
    assert away(corners, drawn) < 1e-12
    assert away(drawn, corners) < min(0.02, away(nodes, corners))  # splines round corners off within two links
    assert drawn[[0, -1]] == pytest.approx(nodes[[0, -1]], abs=0.0)


def test_lines_that_are_not_bent_are_drawn_through_their_nodes() -> None:
    for found in (
        result({"f": force(3.3)}, bending_stiffness=1e5, length=20.0, axial_stiffness=1e7),
        result({"f": {**force(3.3), "force": [0.0, -1e-6]}}, length=19.9),
    ):
        assert (drawn_position(found) == found.position.values).all()
