"""What motion of stiff lines leaves out is told where it counts, and only there."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from ropewalk.capabilities import WIRES
from ropewalk.model import Scenario
from ropewalk.scenario import load
from ropewalk.simulate import simulate

SLACK = {
    "start": [0, 0], "end": [19, 0], "length": 20, "mass": 1.0, "axial_stiffness": 1e6, "elements": 40,
    "bending_stiffness": 10.0, "drag": 0.5,
}  # fmt: skip
TAUT = {k: v for k, v in SLACK.items() if k != "length"} | {"tension": 1e4}
MASS = {"kind": "mass", "mass": 5.0}
FORCE = {"kind": "force", "force": [0.0, -49.05]}


def doubts(line: dict[str, Any], load: dict[str, Any], start: float, until: float = 0.05) -> str:
    own = {**load, "on": "line", "travel": {"speed": 3.0, "from": start}}
    run = {"kind": "dynamic", "until": until, "every": 0.01, "sample": 0.005}  # samples are of the engine of beams
    found = simulate(Scenario.model_validate({"lines": {"line": line}, "loads": {"load": own}, "run": run}))
    return str(found.attrs["doubts"])


@pytest.mark.parametrize(("line", "load", "start", "message"), [
    (SLACK, MASS, 2.0, True), (SLACK, FORCE, 2.0, False), (SLACK, MASS, 9.5, False), (TAUT, MASS, 2.0, False),
], ids=["a mass on a slope", "a force", "a mass in the middle", "a taut line"])  # fmt: skip
def test_a_mass_on_a_steep_stiff_line_is_doubtful(
    line: dict[str, Any], load: dict[str, Any], start: float, message: bool
) -> None:
    """It moves up and down only: its inertia along the line is left out; a force has none."""
    found = doubts(line, load, start)
    assert ("load moves where line has a slope of" in found) == message
    assert ("lines.line.bending_stiffness" in found) == message


def test_compression_that_buckles_between_nodes_is_doubtful() -> None:
    """The wave that a sudden force sends along an undamped rope pushes it together; a taut one is only slackened."""
    limp = {k: v for k, v in SLACK.items() if k != "drag"} | {"bending_stiffness": 1e-9}
    assert "line is compressed by" in doubts({**limp, "elements": 200}, FORCE, 5.0, 0.15)
    assert "pushed together" not in doubts({**TAUT, "elements": 200}, FORCE, 5.0, 0.15)


def test_outputs_so_far_apart_that_the_samples_between_fill_the_memory_are_refused():
    """By the engine that keeps samples: that of joined lines, which keeps none, takes them."""
    every = ["loads.pantograph.travel.at_end=leave", "run.until=2e6 s", "run.every=2e6 s"]
    asked = load(Path(__file__).parents[2] / "examples" / "en50318-2002-250.yaml", every)
    (found,) = WIRES.motion.unsupported(asked.parts)
    assert found.path == ("run", "every")
    assert "is too long: contact forces of every millisecond in between are kept" in found.wrong
