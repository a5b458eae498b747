"""Scenarios of which exact theory says how good the simpler models are."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import pytest

from ropewalk import Scenario, load
from ropewalk.compare import ModelHierarchy, model_hierarchy

EXAMPLES = Path(__file__).parent.parent.parent / "examples"
G = 9.81


def on_string(loads: dict[str, Any], run: dict[str, Any], **line: Any) -> Scenario:
    """Loads on a string of 10 m whose transverse waves run at 100 m/s along the chord."""
    string = {
        "start": [0.0, 0.0], "end": [10.0, 0.0], "tension": 4e3, "mass": 0.4, "axial_stiffness": 2e5, "elements": 100,
        **line,
    }  # fmt: skip
    of = {name: {"on": "string", **entry} for name, entry in loads.items()}
    return Scenario.model_validate({"gravity": 0.0, "lines": {"string": string}, "loads": of, "run": run})


def figure_5() -> Scenario:
    """Theory 1: a force at 0.9999 of the wave speed; it is 2 % of the tension."""
    stretch = 1.0 + 4e3 / 2e5  # a metre of chord weighs less than one of unstrained string
    speed = 0.9999 * (4e3 / (0.4 / stretch)) ** 0.5
    travel = {"speed": speed, "measured": "horizontal", "at_end": "leave"}
    run = {"kind": "dynamic", "until": 9.99 / speed}
    return on_string({"force": {"kind": "force", "force": [0.0, -80.0], "travel": travel}}, run)


def light_and_slow() -> Scenario:
    """A force of a thousandth of the tension that comes at 4 % of the wave speed to the middle of the span and on."""
    travel = {"speed": 4.0}
    return on_string(
        {"force": {"kind": "force", "force": [0.0, -4.0], "travel": travel}}, {"kind": "dynamic", "until": 1.5}
    )


def mass_to_the_end() -> Scenario:
    """Theory 2b with alpha = 1/2 and kappa = 2: 4 kg of string under 4 kg, whose weight is given; nothing sags."""
    travel = {"speed": 50.0, "measured": "horizontal", "at_end": "leave"}
    run = {"kind": "dynamic", "until": 0.192}
    mass = {"kind": "mass", "mass": 4.0, "force": [0.0, -4.0 * G], "travel": travel}
    return on_string({"mass": mass}, run)


def pantograph() -> Scenario:
    """The first four spans of EN 50318:2002 at 250 km/h, the third analysed."""
    found = load(
        EXAMPLES / "en50318-2002-250.yaml",
        ["overhead_lines.line.spans.count=4", "overhead_lines.line.analysed_spans=[3, 3]", "run.until=2.9 s",
         "overhead_lines.line.element=1 m"],
    )  # fmt: skip
    assert isinstance(found, Scenario)
    return found


def slack_rope() -> Scenario:
    """The force on a slack rope of the paper's Figure 6."""
    return load(EXAMPLES / "moving-force.yaml", ["lines.rope.elements=60"])


def bridge() -> Scenario:
    """Theory 3: the sprung mass of Yang and Yau (1997)."""
    return load(EXAMPLES / "bridge-sprung-mass.yaml", ["lines.bridge.elements=32", "run.every=3 ms"])


def slow_trolley() -> Scenario:
    """A trolley of 60 kg on a rope of 20 kg, at 2 % of its wave speed."""
    rope = {
        "start": [0.0, 0.0], "end": [20.0, 0.0], "length": 20.02, "mass": 1.0, "axial_stiffness": 4e5,
        "axial_damping": 2e3, "drag": 3.0, "elements": 40,
    }  # fmt: skip
    payload = {"mass": 55.0, "length": 1.0, "stiffness": 2e5, "damping": 2e3}
    travel = {"speed": 1.2, "from": 3.0}
    trolley = {"kind": "trolley", "on": "rope", "mass": 5.0, "payload": payload, "travel": travel}
    run = {"kind": "dynamic", "until": 11.5, "start": {"with_loads": True}}
    return Scenario.model_validate({"lines": {"rope": rope}, "loads": {"trolley": trolley}, "run": run})


CASES = {case.__name__: case for case in (
    figure_5, light_and_slow, mass_to_the_end, pantograph, slack_rope, bridge, slow_trolley,
)}  # fmt: skip


@cache
def _climbed(name: str, tolerance: float) -> ModelHierarchy:
    return model_hierarchy(CASES[name](), tolerance=tolerance)


@pytest.fixture
def climbed():
    """Gives the ladder of a case by its name, each climbed once."""
    return lambda name, tolerance=0.05: _climbed(name, tolerance)
