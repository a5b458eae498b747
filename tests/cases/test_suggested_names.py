"""A suggested name of a quantity has the words of the unknown one, and exists in the run."""

from __future__ import annotations

import re

import pytest

import ropewalk
from ropewalk.errors import ScenarioError
from ropewalk.scenario import loads
from ropewalk.sweeps.quantities import measured

ROPE = """
lines: {rope: {start: [0, 0], end: [20, 0], length: 20.1, mass: 1, axial_stiffness: 1 MN, elements: 6}}
loads: {w: {kind: force, on: rope, force: [0, -100], travel: {speed: 1, from: 5}}}
run: {kind: quasistatic, positions: 3}
"""


@pytest.fixture(scope="module")
def results():
    loaded = ropewalk.simulate(loads(ROPE))
    bare = ropewalk.simulate(loads(re.sub("loads:.*\n", "", ROPE).replace("quasistatic, positions: 3", "equilibrium")))
    return {"loaded": loaded, "bare": bare}


def refused(result, name: str) -> str:
    with pytest.raises(ScenarioError) as caught:
        measured(result, [name])
    return str(caught.value)


@pytest.mark.parametrize(
    ("name", "suggested"),
    [
        ("max contact force", "max contact_force"),
        ("largest_tensions", "largest_tension"),
        ("max tensoin", "max tension"),
        ("tension", "largest_tension"),
        ("lowest place", "contacts.w.lowest_place"),
        ("max reaction", "max rope.start.reaction.x"),
        ("contacts.w.force.max", "contacts.w.force.magnitude.max"),
        ("max dissipation", "max energy.contact_dissipation"),
    ],
)
def test_a_suggestion_has_all_words_and_works(results, name, suggested):
    assert f"did you mean {suggested}?" in refused(results["loaded"], name)
    assert suggested in measured(results["loaded"], [suggested])


@pytest.mark.parametrize(
    "name", ["max acceleration", "min clearance", "max bending moment", "max contact force", "max speed"]
)
def test_a_quantity_that_the_run_does_not_have_gets_no_suggestion_of_another_one(results, name):
    said = refused(results["bare"], name)
    assert "did you mean" not in said
    assert "; known: " in said
    for known in re.search(r"; known: (.*?), \.\.\.;", said)[1].split(", "):
        assert known in measured(results["bare"], [known])
