"""Small designs with answers in closed form."""

from __future__ import annotations

from math import asin, cos
from typing import Any

from ropewalk import Scenario

AXIAL = 1e5  # N
FORCE = 100.0  # N
TREE: dict[str, Any] = {
    "title": "String",
    "gravity": 0,
    "lines": {
        "string": {
            "start": [0, 0], "end": [10, 0], "tension": 1000, "mass": 1, "axial_stiffness": AXIAL, "elements": 4,
        }
    },
    "loads": {
        "man": {
            "kind": "force", "on": "string", "force": [0, -FORCE],
            "travel": {"speed": 1, "from": 5, "measured": "horizontal"},
        }
    },
    "run": {"kind": "equilibrium"},
}  # fmt: skip
TEXT = """\
title: String
gravity: 0                              # the weight of the string is nothing beside the load
lines:
  string: {start: [0, 0], end: [10, 0], tension: 1 kN, mass: 1, axial_stiffness: 100 kN, elements: 4}   # of steel
loads:
  man: {kind: force, on: string, force: [0, -100], travel: {speed: 1, from: 5 m, measured: horizontal}}
run: {kind: equilibrium}
"""
TENSION = "lines.string.tension"


def scenario(**more: Any) -> Scenario:
    """A force in the middle of a massless string: two straight halves."""
    return Scenario.model_validate(TREE | more)


def tension_before(strain: float) -> float:
    """The tension of the string without its load, where it has this strain with it: each half is straight,

    2 T sin a = F, and (1 + strain) L0 = L / cos a, where L0 = L / (1 + T0 / EA).
    """
    angle = asin(FORCE / (2.0 * AXIAL * strain))
    return AXIAL * ((1.0 + strain) * cos(angle) - 1.0)
