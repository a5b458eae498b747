"""Lines whose law only pulls and that push by their dampers are remarked, where that is much."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.results.pushing import PushWatch

ROPE = {"start": [0, 0], "end": [10, 0], "length": 10.5, "mass": 0.1, "axial_stiffness": 5e4, "axial_damping": 50.0}


def remarked(tension: list[list[float]], **keys: Any) -> list[str]:
    """What is said of frames with the tensions of two links each of the lines `main` and `loop`, 10 ms apart."""
    main = {**ROPE, "end": [10, 0], "law": {"kind": "tension_only"}}
    lines = {"main": main, "loop": {**main, "start": [0, 1], "end": [10, 1], **keys}}
    scenario = Scenario.model_validate({"lines": lines, "run": {"kind": "dynamic", "until": 1.0}})
    layout = SimpleNamespace(link_line=("main", "main", "loop", "loop"), path="time")
    watch = PushWatch(cast(Any, layout), scenario)
    for i, row in enumerate(tension):
        watch.see(cast(Any, SimpleNamespace(of={"tension": np.array([row])}, path=np.array([0.01 * i]))))
    return list(watch.messages(RunInfo()))


def test_the_line_that_pushes_most_is_named_with_its_force_and_when() -> None:
    (said,) = remarked([[900.0, 1000.0, 2.0, 3.0], [900.0, -60.0, -200.0, 1.0], [0.0, 0.0, -150.0, np.nan]])
    assert said.startswith("tension-only line loop has a compressive force of 200 N at t = 0.01 s: its axial_damping")


@pytest.mark.parametrize(
    ("push", "keys"),
    [
        (40.0, {}),  # a twenty-fifth of what is pulled
        (400.0, {"axial_damping": 0.0}),  # rounding of something else: it has no damper
        (400.0, {"law": {"kind": "hooke"}}),  # it may push
    ],
)
def test_what_is_little_or_may_push_is_not(push: float, keys: dict[str, Any]) -> None:
    assert remarked([[900.0, 1000.0, -push, 3.0]], **keys) == []
