"""A line that hangs has no sag, although its ends are not exactly above each other."""

from __future__ import annotations

import pytest

from ropewalk.model import Scenario
from ropewalk.results import summary
from ropewalk.simulate import simulate


@pytest.mark.parametrize("aside", [0.0, 1e-6, 0.02, -1.0])
@pytest.mark.parametrize("down", [True, False])
def test_a_line_that_hangs_has_no_sag(aside: float, down: bool) -> None:
    ends = [[0.0, 400.0], [aside, 0.0]][:: 1 if down else -1]
    line = {"start": ends[0], "end": ends[1], "length": 399.9, "mass": 1, "axial_stiffness": 1e7, "elements": 8}
    found = simulate(Scenario.model_validate({"lines": {"s": line}, "run": {"kind": "equilibrium"}}))
    assert summary(found)["largest_sag"] is None


def test_a_steep_line_has_a_sag() -> None:
    line = {"start": [0, 400], "end": [20, 0], "length": 401, "mass": 1, "axial_stiffness": 1e7, "elements": 8}
    found = simulate(Scenario.model_validate({"lines": {"s": line}, "run": {"kind": "equilibrium"}}))
    assert summary(found)["largest_sag"]["value"] > 1.0
