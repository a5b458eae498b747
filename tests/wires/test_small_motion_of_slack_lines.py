"""Vertical small motion is about a nearly straight line: what is slack, buckles or sags deeply is refused, or doubted.

Without a window, which asks for it, what is slack moves about its rest on the engine of the system.
"""

from __future__ import annotations

import pytest

from ropewalk.errors import EquilibriumError, ScenarioError
from ropewalk.scenario.loading import loads
from ropewalk.simulate import simulate

LINE = """lines:
  cable: {{start: [0, 0], end: [20, 0], {length}, mass: 1, axial_stiffness: 100 kN, elements: 40{more}}}
run: {{kind: dynamic, until: 0.1 s, every: 50 ms, geometry: {geometry}}}
"""
STIFF = ", bending_stiffness: 100"


WINDOW = "linearised, window: 5 m"


def outcome(length: str, more: str = STIFF, geometry: str = "linearised"):
    return simulate(loads(LINE.format(length=length, more=more, geometry=geometry), "cable.yaml")).attrs


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (STIFF, "this one buckles at 2.467 N; it bears 2439 N"),  # pi^2 EI / L^2
        (f"{STIFF}, start_support: {{kind: fixed, clamped: true}}", "buckles at 5.048 N"),
        (", foundation: 10", "a line without bending_stiffness needs a tension"),
    ],
)
def test_a_cable_longer_than_its_chord_is_no_strut(more: str, message: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        outcome("length: 20.5 m", more, WINDOW)
    (problem,) = caught.value.problems
    text = str(caught.value)
    assert (problem.line, problem.key) == (2, "lines.cable.length")
    assert message in text
    assert "given 20.5 m over 20 m; write run.geometry: nonlinear, or give tension" in text


def test_a_strut_that_buckles_on_its_bed_is_refused_as_it_is_laid_out() -> None:
    with pytest.raises(EquilibriumError, match="cable buckles under its compression of 2439 N"):
        outcome("length: 20.5 m", f"{STIFF}, foundation: 10", WINDOW)


def test_struts_that_bear_their_compression_move() -> None:
    """Below Euler's load, or with enough of a bed: 2 sqrt(k EI)."""
    assert outcome("length: 20.0003 m", ", bending_stiffness: 1e5", WINDOW)["outcome"] == "completed"
    assert outcome("length: 20.01 m", f"{STIFF}, foundation: 1e4", WINDOW)["outcome"] == "completed"


@pytest.mark.parametrize("more", [STIFF, ", foundation: 10", f"{STIFF}, foundation: 10"])
def test_all_of_that_may_move_about_its_rest_or_with_all_geometry(more: str) -> None:
    for geometry in ("linearised", "nonlinear"):
        assert outcome("length: 20.5 m", more, geometry)["outcome"] == "completed"


def test_a_line_that_sags_deeply_in_small_motion_is_doubted() -> None:
    """A cable as long as its chord, as limp as a rope, would hang 200 m through if it did not stretch."""
    attributes = outcome("length: 20 m")
    assert attributes["outcome"] == "doubtful"
    assert "cable sags 204 m over a span of 20 m" in attributes["doubts"]
    assert "(run.geometry); write geometry: nonlinear, or give tension" in attributes["doubts"]
    assert outcome("length: 20 m", ", bending_stiffness: 1e5")["outcome"] == "completed"
    assert outcome("tension: 1 kN")["outcome"] == "completed"
