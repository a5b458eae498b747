"""`check` estimates steps within a factor of two, and a result has the largest step that was taken."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import ropewalk
from ropewalk.effort import foreseen
from ropewalk.results import summary
from ropewalk.scenario import load
from ropewalk.scenario.examples import examples
from ropewalk.scenario.loading import loads

LONG = Path(__file__).parent / "b-slow-to-compile.yaml"
RUNS = {
    "implicit, a damped rope": lambda: load(LONG, ["run.until=20 s"]),
    "implicit, as requested": lambda: load(LONG, ["run.until=6 s", "run.method=implicit", "lines.rope.elements=40"]),
    "implicit, long intervals": lambda: load(LONG, ["run.until=20 s", "run.every=100 ms"]),
    "explicit": lambda: load(LONG, ["run.until=5 s", "lines.rope.axial_damping=0 N*s"]),
    "overhead line": lambda: loads(examples()["simple-ac-275"], overrides=["run.until=0.5 s", "run.every=50 ms"]),
}


@pytest.mark.parametrize("name", RUNS)
def test_check_estimates_the_steps_within_a_factor_of_two(name):
    scenario = RUNS[name]()
    said, _ = foreseen(scenario)
    estimate = int(re.search(r"about ([\d ]+) steps", said)[1].replace(" ", ""))
    method = summary(ropewalk.simulate(scenario))["method"]
    assert 0.5 < estimate / method["steps"] < 2.0, (said, method["steps"])
    assert re.search(r", (about .* (s|min|h)|about a second|less than a second)$", said)
    assert method["step"]["value"] <= scenario.run.every * (1.0 + 1e-12)
    assert method["steps"] * method["step"]["value"] >= 0.99 * scenario.run.until
