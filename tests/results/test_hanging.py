"""The largest pull of a leash that falls between output instants is remarked, and the one that is seen is not."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.results.hanging import HangingWatch
from ropewalk.simulate import simulate

FALL, LEASH, PERSON = 1.0, 1.5, 80.0  # m, m, kg


def fall(every: float) -> Scenario:
    """A person falls from a metre above a rope into a leash that is stiff beside it."""
    rope = {"start": [0, 0], "end": [20, 0], "tension": 3e3, "mass": 0.1, "axial_stiffness": 1e5, "axial_damping": 20.0,
            "elements": 20}  # fmt: skip
    payload = {"mass": PERSON, "length": LEASH, "stiffness": 5e4, "at": [0.0, FALL]}
    ring = {"kind": "trolley", "on": "rope", "mass": 2.0, "payload": payload, "travel": {"speed": 0.0, "from": 10.0}}
    run = {"kind": "dynamic", "until": 1.6, "every": every}
    return Scenario.model_validate({"lines": {"rope": rope}, "loads": {"ring": ring}, "run": run})


def said(found: Any) -> list[str]:
    return [line for line in str(found.attrs["warnings"]).splitlines() if "pull of payload" in line]


def test_a_snap_between_instants_is_remarked_and_one_that_is_seen_is_not() -> None:
    (line,) = said(simulate(fall(0.05)))
    assert line.startswith("the largest pull of payload ring, ")
    assert line.endswith("write a smaller run.every")
    assert not said(simulate(fall(1e-3)))


@pytest.mark.parametrize(("stretch", "count"), [([0.0, 0.0, 0.2, 0.0, 0.0], 1), ([0.18, 0.19, 0.2, 0.19, 0.18], 0)])
def test_it_is_told_of_what_stands_out(stretch: list[float], count: int) -> None:
    """k (l - L) of the rope, in the order of instants."""
    scenario = fall(0.4)

    layout = SimpleNamespace(body=("ring.payload",), contact_load=("ring",), axes=("x", "z"), path="time")
    place = np.stack([np.zeros(5), -LEASH - np.array(stretch)], axis=1)[:, None]
    frames = SimpleNamespace(
        path=0.1 * np.arange(5.0), of={"body_position": place, "contact_position": np.zeros((5, 1, 2))}
    )
    watch = HangingWatch(cast(Any, layout), scenario)
    watch.see(cast(Any, frames))
    assert len(list(watch.messages(RunInfo()))) == count
