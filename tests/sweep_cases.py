"""Small sweeps, in a module of its own: other processes must find what they compute."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any

from ropewalk import Scenario
from ropewalk.sweeps.case import computed

TREE: dict[str, Any] = {
    "title": "Rope",
    "lines": {
        "rope": {
            "start": [0, 0], "end": [10, 0], "length": 10.5, "mass": 1, "axial_stiffness": 1e5, "elements": 10,
        }
    },
    "loads": {"man": {"kind": "force", "on": "rope", "force": [0, -100], "travel": {"speed": 1, "from": 5}}},
    "run": {"kind": "equilibrium"},
}  # fmt: skip
TEXT = """\
title: Rope
lines:
  rope: {start: [0, 0], end: [10, 0], length: 10.5, mass: 1, axial_stiffness: 100 kN, elements: 10}
loads:
  man: {kind: force, on: rope, force: [0, -100], travel: {speed: 1, from: 5 m}}
run: {kind: equilibrium}
"""


def scenario(**more: Any) -> Scenario:
    """A force at rest on a rope of 10 links."""
    return Scenario.model_validate(TREE | more)


def counted(monkeypatch: Any, module: Any) -> list[str]:
    """The keys of the cases that a module computes from now on."""
    keys = list[str]()

    def counting(case: Any) -> Any:
        keys.append(case.key)
        return computed(case)

    monkeypatch.setattr(module, "computed", counting)
    return keys


def squared(number: int) -> int:
    """What is easy to foretell."""
    return number * number


def deadly(number: int) -> int:
    """The same, but 3 kills its process."""
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def once_deadly(task: tuple[int, str]) -> int:
    """The same, but 3 kills its process the first time; the file says whether it has done so."""
    number, file = task
    if number == 3 and not Path(file).exists():
        Path(file).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def slow(number: int) -> int:
    """The same, some time later."""
    time.sleep(30.0)
    return number
