"""The lowest frequencies of overhead lines against another assembly: cubic Hermite elements, written for tests."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from overhead_assembly import Hermite, MovingWith
from overhead_cases import EN_2002, formed
from ropewalk.model import Scenario
from ropewalk.simulate import spectrum_of
from ropewalk.wires.plan import Spot, WirePlan

Array = NDArray[np.float64]
LINE: dict[str, Any] = {
    **EN_2002,
    "spans": {"count": 3, "length": "60 m"},
    "contact_wire": {"mass": "1.35 kg/m", "tension": "20 kN", "bending_stiffness": 195},
    "messenger_wire": {"mass": "1.07 kg/m", "tension": "16 kN", "bending_stiffness": 131.7},
    "analysed_spans": [2, 2],
}


def known(plan: WirePlan, moving_with: MovingWith | None = None) -> Array:
    """Ten frequencies of Hermite elements of 0.5 and 0.25 m, extrapolated: chords of the sag converge with h^2."""
    coarse, fine = (Hermite(plan, h).frequencies(moving_with)[:10] for h in (0.5, 0.25))
    assert np.abs(fine / coarse - 1.0).max() < 1e-3
    return fine + (fine - coarse) / 3.0


def test_the_first_ten_frequencies_of_an_overhead_line_are_those_of_hermite_elements() -> None:
    exact, errors = known(formed(LINE).plan), []
    for element in (2.0, 1.0, 0.5):
        scenario = {"overhead_lines": {"section": {**LINE, "element": element}}, "run": {"kind": "equilibrium"}}
        found = spectrum_of(Scenario.model_validate(scenario), how_many=12)
        assert found.modes is not None
        errors.append(np.abs(found.modes.frequency[:10] / exact - 1.0))
    worst = np.array(errors).max(axis=1)
    order = np.log2(worst[:-1] / worst[1:])
    print("exact", exact, "errors", np.array(errors), "orders", order)
    assert worst[-1] < 1.5e-4
    assert np.abs(order[-1] - 2.0) < 0.2  # on the coarsest mesh errors of several kinds meet


def test_a_pantograph_under_the_contact_wire_changes_them_as_it_does_those_of_hermite_elements() -> None:
    own = MovingWith(Spot(0, 80.0), (20.0, 10.0), (1.0, 7000.0), 5e4)  # held by next to nothing: it does not lift
    line = {**LINE, "ends": "anchored"}  # between weights it may slide, and rounding moves it by centimetres
    exact, bare = known(formed(line).plan, own), known(formed(line).plan)
    pantograph = {
        "kind": "pantograph", "on": "section", "travel": {"speed": 0.0, "from": 80.0}, "masses": own.masses,
        "stiffness": own.stiffness, "damping": [0.0, 0.0], "contact_stiffness": own.contact, "static_force": 1e-6,
    }  # fmt: skip
    scenario = {"overhead_lines": {"section": line}, "loads": {"head": pantograph}, "run": {"kind": "equilibrium"}}
    modes = spectrum_of(Scenario.model_validate(scenario), how_many=12).modes
    assert modes is not None
    print(exact / bare - 1.0, modes.frequency[:10] / exact - 1.0)
    assert modes.frequency[:10] == pytest.approx(exact, rel=1.5e-4)  # as without it
    assert np.abs(exact / bare - 1.0).max() > 0.02
