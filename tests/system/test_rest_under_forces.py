"""Lines at rest under forces at which they are divided, and over sheaves at which they end.

Sources of the exact values: the elastic catenary, `ropewalk.theory.rope`; Euler and Eytelwein, T2/T1 = exp(mu theta).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from motion_cases import order
from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.simulate import simulate
from ropewalk.system.equilibrium.rest_under_forces import RestUnderForces
from ropewalk.theory import rope


def line(elements: int, **more: Any) -> dict[str, Any]:
    """A rope of 20.3 m over 20 m."""
    own = {"start": [0, 0], "end": [20, 0], "length": 20.3, "mass": 1.0, "axial_stiffness": 1e4}
    return {**own, "elements": elements, **more}


def force(at: float, size: float = 800.0, **travel: Any) -> dict[str, Any]:
    return {"kind": "force", "on": "line", "force": [0, -size], "travel": {"speed": 1.0, "from": at, **travel}}


@pytest.mark.parametrize("at", [3.03, 10.15])
def test_a_rope_bends_under_a_force_as_the_elastic_catenary(at: float) -> None:
    """It turns by up to 0.8 rad there; with kinks on splines the force was 6.8 mm away with 20 links."""
    exact = rope.resting(span=20.0, length=20.3, weight=9.81, axial_stiffness=1e4, loads=[(at, (0.0, -800.0))])
    errors, places = [], []
    for n in (20, 40, 80):
        asked = {"lines": {"line": line(n)}, "loads": {"p": force(at)}, "run": {"kind": "equilibrium"}}
        still = RestUnderForces(Scenario.model_validate(asked), RunInfo(), 0.0)
        frame, xi = still.loaded(), still.layout.node_xi
        places.append(np.abs(frame.position - exact.position(xi)).max())
        away = frame.contact_position[0] - exact.load_positions[0]
        errors.append(float(np.linalg.norm(away)))
        # What the line weighs on an eighth of a link is how far links beside an end are read from their middles.
        assert frame.contact_tension[0] == pytest.approx(exact.load_tensions[0], abs=2e-2 * 9.81 * 20.3 / n)
        assert frame.tension == pytest.approx(exact.tension(still.layout.link_xi), abs=0.125 * 9.81 * 20.3 / n)
        assert frame.reaction[0] == pytest.approx(exact.start_reaction, abs=0.25 / n**2)
    print(errors, places)
    assert errors[0] < 1e-6  # m
    assert places[0] < 1e-4
    assert order([4.0, 2.0, 1.0], errors) == pytest.approx(2.0, abs=0.3)
    assert order([4.0, 2.0, 1.0], places) == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("positions", [12, 89])
def test_a_force_that_goes_slowly_rests_everywhere_as_by_itself(positions: int) -> None:
    """In short steps lines are divided anew only now and then; what hangs on them is passed."""
    hanger = {"start": [9, 6], "end": [9, 0], "length": 6.0, "mass": 0.2, "axial_stiffness": 1e4, "elements": 8,
              "end_support": {"kind": "joined", "to": "line", "at": 8.5}}  # fmt: skip
    lines = {"line": line(24), "hanger": hanger}
    asked = {"lines": lines, "loads": {"p": force(0.4)}, "run": {"kind": "quasistatic", "positions": positions}}
    result = simulate(Scenario.model_validate(asked))
    assert result.attrs["outcome"] == "completed"
    for i in (positions // 4, positions // 2, 2 * positions // 3):
        at = float(result.contact_xi.values[i, 0])
        alone = simulate(
            Scenario.model_validate({"lines": lines, "loads": {"p": force(at)}, "run": {"kind": "equilibrium"}})
        )
        # Links are up to twice as long: errors of the second order of some hundredths of a millimetre.
        for name, near in (("contact_position", 2e-6), ("position", 5e-4), ("reaction", 2e-2)):
            assert result[name].values[i] == pytest.approx(alone[name].values[0], abs=near), name


def test_a_rope_slips_over_a_sheave_no_further_than_friction_lets_it() -> None:
    """The tension beyond it rises while the force goes to the middle, at the ratio of the capstan, and stays then.

    Polygons that had to relax on the way had slipped on: 1442 N where 1098 N are right.
    """
    own = {"start": [0, 0], "end": [12, 1], "length": 13.05, "mass": 1e-6, "axial_stiffness": 1e5, "elements": 60}
    asked = {
        "lines": {"line": {**own, "sheaves": {"wheel": {"at": [5, 3], "friction": 0.2}}}}, "gravity": 0.0,
        "loads": {"p": force(0.3, 500.0)}, "run": {"kind": "quasistatic", "positions": 60},
    }  # fmt: skip
    result = simulate(Scenario.model_validate(asked))
    on = result.contact_xi.values[:, 0] < 5.3
    ahead, far = result.contact_tension.values[on, 0, 1], result.tension.values[on, -2]
    one = np.array([5.0, 3.0]) - result.contact_position.values[on, 0]
    two = np.array([7.0, -2.0])
    angle = np.arccos((one @ two) / np.linalg.norm(one, axis=1) / np.linalg.norm(two))
    ratio = np.log(ahead / far) / (0.2 * angle)
    assert np.abs(ratio).max() <= 1.0 + 1e-6
    rises = np.diff(far)
    assert rises.min() > -1e-6  # sticks, or slips towards the force
    assert ratio[:-1][rises > 1e-3] == pytest.approx(1.0, abs=1e-6)
    assert far.max() == pytest.approx(1115.0, abs=1.0)
