"""Results do not depend on where a scenario is located."""

from __future__ import annotations

import numpy as np

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
