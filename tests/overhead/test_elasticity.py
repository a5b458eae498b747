"""Elasticity of the contact wire along a span, in slow motion with all geometry, against another assembly.

That assembly is of cubic Hermite elements for bending and tension together, bars along them, and tight droppers; of the
library it takes no more than the plan: lengths, tensions, masses, and where everything is.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from overhead_assembly import Hermite
from overhead_cases import EN_2002, formed
from ropewalk.model import Scenario
from ropewalk.simulate import simulate

Array = NDArray[np.float64]
STIFF = {
    "contact_wire": {"mass": "1.35 kg/m", "tension": "20 kN", "bending_stiffness": 195},
    "messenger_wire": {"mass": "1.07 kg/m", "tension": "16 kN", "bending_stiffness": 131.7},
}  # fmt: skip
LINE: dict[str, Any] = {
    **EN_2002, **STIFF, "spans": {"count": 3, "length": "60 m"}, "analysed_spans": [2, 2], "ends": "anchored",
}  # fmt: skip
FIRST, END, POSITIONS = 90.0, 180.0, 31  # m, every 3 m from the middle of the section to its end


def heights(line: dict[str, Any], force: float) -> Array:
    """Heights of the contact wire under a force upwards on it, m; of the end, which stands still, nothing."""
    travel = {"speed": 1.0, "from": FIRST, "measured": "horizontal"}
    load = {"kind": "force", "on": "section", "force": [0.0, force], "travel": travel}
    run = {"kind": "quasistatic", "positions": POSITIONS}
    tree = {"overhead_lines": {"section": line}, "loads": {"push": load}, "run": run}
    found = simulate(Scenario.model_validate(tree))
    assert found.attrs["outcome"] == "completed"
    assert FIRST + found.load_path.values == pytest.approx(np.linspace(FIRST, END, POSITIONS))
    return np.asarray(found.contact_position.values[:-1, 0, 1])


def test_the_elasticity_along_spans_is_that_of_hermite_elements() -> None:
    """At supports, at droppers, between and beside them, in an inner span and the last one."""
    exact = Hermite(formed(LINE).plan, 0.05).elasticity(np.linspace(FIRST, END, POSITIONS)[:-1])  # good to 5e-5
    assert exact.max() / exact.min() > 3.0
    errors = []
    for element in (1.0, 0.5, 0.25):
        line = {**LINE, "element": element}
        found = (heights(line, 2.0) - heights(line, -2.0)) / 4.0  # N; of droppers that bear 80 N none slackens
        errors.append(found / exact - 1.0)
    worst = np.abs(errors).max(axis=1)
    orders = np.log2(worst[:-1] / worst[1:])
    print("elasticity", exact, "errors", np.array(errors), worst, "orders", orders)
    assert worst[-1] < 1e-3
    assert orders.min() > 1.8  # of the second order at least, as shares of droppers get local and kinks are resolved
