"""A mass that hangs on a joint is in the summary with its place and the force of the lines on it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import ropewalk
from ropewalk.results import summary, tables, text
from ropewalk.scenario import load, loads

HOOK = Path(__file__).parent / "a-08-hook-untold.yaml"
V = """
joints: {bob: {mass: 100, force: [FORCE, 0]}}
lines:
  left: {start: [0, 0], end: [5, -3], end_support: {kind: joined, to: bob}, length: 6, mass: 1e-3,
    axial_stiffness: 1 MN, elements: 4EI}
  right: {start: [5, -3], end: [10, 0], start_support: {kind: joined, to: bob}, length: 6, mass: 1e-3,
    axial_stiffness: 1 MN, elements: 4}
run: {kind: equilibrium}
"""


def test_a_hoisted_mass_has_its_place_and_its_force():
    found = summary(ropewalk.simulate(load(HOOK, ["run.until=1 s"])))
    hook = found["joints"]["hook"]
    assert hook["mass"]["value"] == 2000.0
    moved = 0.125  # m, of the start of the rope within 1 s; the rope stretches by 0.05 m
    assert hook["place"]["z"]["max"] - hook["place"]["z"]["min"] == pytest.approx(moved, abs=0.15)
    assert hook["place"]["z"]["min"] <= hook["place"]["z"]["last"] <= hook["place"]["z"]["max"]
    force = hook["force"]["components"]["z"]
    assert force["min"] < 2000.0 * 9.81 < force["max"]  # it swings about its weight
    said = text(found)
    assert "Joint hook" in said
    assert "largest force of the lines on it" in said


@pytest.mark.parametrize("bending", ["", ", bending_stiffness: 1e-3"])
@pytest.mark.parametrize("sideways", [0.0, 300.0])
def test_at_rest_the_lines_carry_weight_and_force(bending, sideways):
    result = ropewalk.simulate(loads(V.replace("EI", bending).replace("FORCE", str(sideways))))
    bob = summary(result)["joints"]["bob"]
    components = bob["force"]["components"]
    assert components["z"]["max"] == pytest.approx(981.0, rel=1e-4)  # lines of 12 g in all
    assert components["x"]["max"] == pytest.approx(-sideways, abs=0.2)
    names = tables(result)["summary"]["quantity"].tolist()
    assert "joints.bob.place.z.last" in names
    assert "joints.bob.force" in names
    assert np.isfinite(bob["place"]["z"]["last"])
