"""The promise on bits: the same Model and State give the same State everywhere, however a motion is divided."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import numpy as np
import pytest

from core_structures import STRUCTURES, bridge, net, rope, taut_lines
from ropewalk.engine.bound import Bound
from ropewalk.engine.library import variants

STEPS, STEP = 500, 2.0**-13
HASHES = {
    "rope": "16c9158609c39ddc",
    "rope in space": "d18e4976a89c6f33",
    "straight links": "eb4e0b8099feded6",
    "damped": "3fa3ff0b9e41cdbd",
    "tension only": "c7f53be8223f99d1",
    "bridge": "2fdf153c847f97d8",
    "damped bridge in space": "5e565701990542d0",
    "bridge under a force": "dddd6361da141ae0",
    "tripod": "396585500b45e11a",
    "damped tripod": "a29a92daebe03046",
    "plain bending": "6e302f2705083348",
    "damped plain bending": "fc793cc6192a6d6a",
    "taut lines": "9aba4b8b5b199341",
    "damped droppers in space": "6de59e50f2ddb6cd",
    "free play": "2eb582a2753f5d49",
    "damped free play in space": "69e2e80de84ceccd",
    "net under a force": "97e07dddbf323754",
    "damped free net": "79ed57647db0bdb3",
}
"""Of positions and velocities: of every processor, compiler and variant. New structures add a line."""


@pytest.mark.parametrize("kind", STRUCTURES)
def test_states_are_the_same_on_every_platform_and_in_every_variant(kind: str) -> None:
    for variant in variants():
        bound = STRUCTURES[kind]()
        assert bound.advance(STEPS, STEP, variant).outcome == "done"
        found = hashlib.sha256(bound.state.position.tobytes() + bound.state.velocity.tobytes())
        assert found.hexdigest()[:16] == HASHES[kind], variant


@pytest.mark.parametrize("make", [rope, bridge, net, taut_lines])
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
