"""The promise on bits: the same Model and State give the same State everywhere, however a motion is divided."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import numpy as np
import pytest

from core_structures import STRUCTURES, bridge, rope
from ropewalk.engine.bound import Bound
from ropewalk.engine.library import variants

STEPS, STEP = 500, 2.0**-13
HASH = "9d92ff9089cb1a7c"
"""Of all States below: of every processor, compiler and variant."""


def test_states_are_the_same_on_every_platform_and_in_every_variant() -> None:
    for variant in variants():
        found = hashlib.sha256()
        for make in STRUCTURES.values():
            bound = make()
            assert bound.advance(STEPS, STEP, variant).outcome == "done"
            found.update(bound.state.memory.tobytes())
        assert found.hexdigest()[:16] == HASH, variant


@pytest.mark.parametrize("make", [rope, bridge])
def test_division_into_calls_changes_no_bit(make: Callable[[], Bound]) -> None:
    whole, parts = make(), make()
    whole.advance(1000, STEP)
    for _ in range(10):
        parts.advance(100, STEP)
        parts.velocities()  # results in between change nothing either
        parts.linearise()
    np.testing.assert_array_equal(whole.state.memory, parts.state.memory)


def test_copy_of_a_state_is_a_checkpoint() -> None:
    whole = bridge(damping=30.0)
    whole.advance(300, STEP)
    resumed = Bound(whole.model, whole.state.copy())
    whole.advance(300, STEP)
    resumed.advance(300, STEP)
    np.testing.assert_array_equal(whole.state.memory, resumed.state.memory)


def test_a_call_notices_the_stop_flag() -> None:
    bound = rope()
    bound.advance(10, STEP)
    bound.stop.value = 1
    assert bound.advance(10, STEP) == (0, "stopped")
    bound.stop.value = 0
    assert bound.advance(10, STEP) == (10, "done")
    assert bound.state.time[0] == 20 * STEP


def test_positions_that_are_no_numbers_end_a_motion() -> None:
    bound = rope()
    taken, outcome = bound.advance(100_000, 0.05)  # the stable step is 5 ms
    assert outcome == "diverged"
    assert taken < 100_000
