"""Forces and stiffness of cable runs are derivatives of their energy; rest against closed forms.

Sources: central differences; the hinged and the clamped beam under its weight.
"""

from __future__ import annotations

import numpy as np
import pytest

from motion_cases import order
from ropewalk.model import Scenario
from ropewalk.system.equilibrium.rest import settle
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.equilibrium.structures import structure_of
from ropewalk.system.loads.loaded_structure import LoadedStructure

CLAMPED = {"kind": "fixed", "clamped": True}


def beam(elements: int, support: dict[str, object] | None = None, **keys: object) -> Scenario:
    ends = {} if support is None else {"start_support": support, "end_support": support}
    line = {"start": [0, 0], "end": [4, 1], "tension": 50.0, "mass": 2.0, "axial_stiffness": 1e4, "elements": elements}
    return Scenario.model_validate({"lines": {"beam": line | ends | keys}})


def joined_beams(bending_stiffness: float) -> Scenario:
    """Two beams that are alike but for their bending stiffness; if they are so in this as well, they share loops."""
    line, joined = {"mass": 2.0, "axial_stiffness": 1e4, "elements": 4}, {"kind": "joined", "to": "knot"}
    one = line | {"start": [0, 0], "end": [2, 1], "length": 2.2, "bending_stiffness": 30.0, "start_support": CLAMPED}
    two = line | {"start": [2, 1], "end": [4, 0], "length": 2.2, "bending_stiffness": bending_stiffness}
    lines = {"one": one | {"end_support": joined}, "two": two | {"start_support": joined, "end_support": CLAMPED}}
    return Scenario.model_validate({"lines": lines, "joints": {"knot": {}}})


@pytest.mark.parametrize(
    "scenario",
    [
        beam(6), beam(6, bending_stiffness=30.0), beam(7, CLAMPED, bending_stiffness=30.0),
        beam(6, {"kind": "elastic", "stiffness": 2e3}, foundation=70.0), joined_beams(30.0), joined_beams(20.0),
    ],
    ids=["rope", "hinged beam", "clamped beam", "on springs", "alike beams", "unlike beams"],
)  # fmt: skip
def test_forces_and_stiffness_are_derivatives_of_the_energy(scenario: Scenario) -> None:
    found = structure_of(scenario, 0.0)
    r = (found.near + 0.05 * np.random.default_rng(1).standard_normal(found.near.shape)).ravel()
    potential, step = SystemPotential(found.structure, LoadedStructure(found.structure, found.near), 4.0), 1e-5
    unknowns = potential.free.shape[1]
    for i in range(unknowns):
        way = np.zeros(unknowns)
        way[i] = step
        ahead, behind = potential.moved(r, way), potential.moved(r, -way)
        slope = (potential.energy(ahead) - potential.energy(behind)) / (2.0 * step)
        # differences of 1e-5 m are good to 1e-6 of forces of some kN
        assert potential.out_of_balance(r)[i] == pytest.approx(-slope, rel=1e-6, abs=2e-3)
        row = (potential.out_of_balance(behind) - potential.out_of_balance(ahead)) / (2.0 * step)
        assert np.abs(potential.stiffness(r).toarray()[i] - row).max() < 1e-5 * np.abs(row).max()


@pytest.mark.parametrize(("support", "share"), [(None, 5.0 / 384.0), (CLAMPED, 1.0 / 384.0)], ids=["hinged", "clamped"])
def test_a_beam_bends_under_its_weight_to_the_fourth_order_of_the_mesh(
    support: dict[str, object] | None, share: float
) -> None:
    """w L^4 / EI times 5/384 hinged and 1/384 clamped; it hardly stretches, as it weighs hardly anything."""
    keys = {"end": [1, 0], "tension": None, "length": 1.0, "mass": 1e-4, "axial_stiffness": 1e3}
    exact = share * 1e-4 * 9.81 / 10.0

    def error(elements: int) -> float:
        found = structure_of(beam(elements, support, bending_stiffness=10.0, **keys), 0.0)
        return abs(-settle(found.structure, found.near)[1, elements // 2] / exact - 1.0)

    sizes = [8, 16, 32]
    errors = [error(n) for n in sizes]
    assert errors[-1] < 2e-3
    # The load beside supports is lumped at nodes, which leaves the second order in part.
    assert order([1.0 / n for n in sizes], errors) > 1.9
