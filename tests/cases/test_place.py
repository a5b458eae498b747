"""Results do not depend on where a scenario is located."""

from __future__ import annotations

import numpy as np
import pytest

import ropewalk

BEAM = {
    "lines": {"beam": {"start": [0.0, 0.0], "end": [20.003114581296977, 0.0], "length": 20.003114581296977,
                       "mass": 1740.0, "bending_stiffness": 2.4e9, "axial_stiffness": 1e10, "elements": 16}},
    "loads": {"car": {"kind": "vehicle", "on": "beam", "wheels": {"wheel": {"mass": 300.0}},
                      "travel": {"speed": 20.0, "from": 8.0}}},
    "run": {"kind": "dynamic", "until": 0.1, "every": 0.02},
}  # fmt: skip


def test_contact_forces_on_a_beam_do_not_depend_on_its_place() -> None:
    """The distance of the moved ends is less than the length by 4e-15 m, which does not make the beam slack."""
    line, away = BEAM["lines"]["beam"], -87.05792013610214
    moved = {**BEAM, "lines": {"beam": {**line, "start": [away, 0.0], "end": [line["end"][0] + away, 0.0]}}}
    assert moved["lines"]["beam"]["end"][0] - away < line["length"]
    here, there = (ropewalk.simulate(ropewalk.Scenario(**tree)) for tree in (BEAM, moved))
    forces = here["contact_force"].values, there["contact_force"].values
    np.testing.assert_allclose(*forces, atol=1e-6 * np.abs(forces[0]).max())  # rounding of places 90 m away


@pytest.mark.parametrize("away", [0.0, 3.3, 41.7])
def test_a_frictionless_force_on_a_stiff_beam_is_held_wherever_the_beam_is(away: float) -> None:
    """Rounding of 10 GN leaves a residual of 1e-8 of the force, which is no force beyond all bounds."""
    length = 26.764797198036277
    line = {"start": [away, 0.0, 0.0], "end": [away + length, 0.0, 0.0], "length": length, "mass": 2304.5012861913538,
            "bending_stiffness": 6618496785.6320305, "axial_stiffness": 1e10, "elements": 20,
            "end_support": {"kind": "guided", "along": [1.0, 0.0, 0.0]}}  # fmt: skip
    load = {"kind": "force", "on": "beam", "force": [0.0, 0.0, -5089.615819388085], "contact": "frictionless",
            "travel": {"speed": 20.0, "from": 7.752053111499672}}  # fmt: skip
    tree = {"lines": {"beam": line}, "loads": {"force": load}, "run": {"kind": "equilibrium"}}
    result = ropewalk.simulate(ropewalk.Scenario(**tree))
    assert result.attrs["outcome"] == "completed"
    assert float(result["contact_force"].values[0, 0, 0]) == pytest.approx(-8.3286, rel=1e-4)  # as at x = 0, rounding
