"""An undamped chain in compression amplifies errors: from then on the sixth-order method takes shorter steps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from motion_cases import slack_rope
from ropewalk.solve.choice import COMPRESSED, choose, is_compressed
from ropewalk.solve.motion import Progress, move
from ropewalk.solve.start import setting_of, start_state


def steps(elements: int = 20, damping: float = 0.0, pushed: float = 1.0, **run: Any) -> list[int]:
    """Steps taken in each of four equal intervals by a rope whose rest shape was shrunk to `pushed` of its size."""
    scenario = slack_rope(elements, damping, run={"until": 0.04, "every": 0.01, "accuracy": 1e-3, **run})
    setting = setting_of(scenario, 0.04)
    state = start_state(setting, with_loads=False)
    state.r[:] *= pushed
    choice = choose(
        setting.strands, setting.loads, state,
        method=run.get("method", "auto"), step=run.get("step"), accuracy=1e-3, duration=0.04,
    )  # fmt: skip
    progress, seen = Progress(), [0]
    for _ in move(setting.strands, setting.loads, state, choice, 1e-3, np.linspace(0.01, 0.04, 4), progress):
        seen.append(progress.steps)
    return list(np.diff(seen))


def test_a_link_that_pushes_is_seen_and_one_that_is_slack_is_not() -> None:
    for law, expected in (("hooke", True), ("tension_only", False)):
        setting = setting_of(slack_rope(20, line={"law": {"kind": law}}), 1.0)
        state = start_state(setting, with_loads=False)
        assert not is_compressed(setting.strands, state.r, state.X)
        state.r[:] *= 0.99
        assert is_compressed(setting.strands, state.r, state.X) is expected
        state.r[0], state.r[1] = state.X, 0.0  # neither: only roundings are left
        assert not is_compressed(setting.strands, state.r, state.X)


def test_steps_are_as_much_shorter_as_a_twentieth_of_the_error_asks_for() -> None:
    assert abs(20.0 * COMPRESSED**6 - 1.0) < 0.1  # sixth order
    calm, pushed = steps(elements=200), steps(elements=200, pushed=0.995)
    assert calm[0] == pushed[0]  # seen at the first output only
    for a, b in zip(calm[1:], pushed[1:], strict=True):
        assert b / a == pytest.approx(1.0 / COMPRESSED, rel=0.1)  # whole steps between changes of seat


@pytest.mark.parametrize("run", [{"step": 2e-4, "method": "rkn6"}, {"method": "verlet"}], ids=["step given", "verlet"])
def test_a_step_that_was_asked_for_is_kept(run: dict[str, Any]) -> None:
    taken = steps(elements=40, pushed=0.995, **run)
    assert max(taken) - min(taken) <= 0.05 * max(taken) + 2
