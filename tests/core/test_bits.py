"""The promise on bits: the same Model and State give the same State everywhere, however a motion is divided."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import numpy as np
import pytest

from core_structures import STRUCTURES, bridge, net, rope, taut_lines
from ropewalk.engine.bound import Bound
from ropewalk.engine.library import variants
from ropewalk.engine.model import Block
from ropewalk.errors import RopewalkError

STEPS, STEP = 500, 2.0**-13
HASHES = {
    "rope": "b5887760f4cf9361",
    "rope in space": "119ea6bf110adeb7",
    "straight links": "eb4e0b8099feded6",
    "damped": "b454b3a046de67eb",
    "tension only": "6fca4cc156c6ac6e",
    "bridge": "edc4db2a1a67865f",
    "damped bridge in space": "22011045dd3a18f8",
    "bridge under a force": "9b90b66e2a30ec04",
    "tripod": "396585500b45e11a",
    "damped tripod": "a29a92daebe03046",
    "plain bending": "6e302f2705083348",
    "damped plain bending": "fc793cc6192a6d6a",
    "taut lines": "9aba4b8b5b199341",
    "collector": "b6dda9a2461ec305",
    "collector on plain links": "af80ad9774e2b6af",
    "damped droppers in space": "6de59e50f2ddb6cd",
    "loads": "d787d9a861e86568",
    "loads in space": "cafa16abfa69a291",
    "loads on straight links": "216d424ac3dc2c46",
    "loads that share links": "857b0fa6deb88b9c",
    "free play": "2e1d145fe6973046",
    "damped free play in space": "78146a36f6ff4096",
    "net under a force": "4f367e02f7c96182",
    "damped free net": "79ed57647db0bdb3",
    "over sheaves": "6bc67dd323504526",
    "damped over sheaves in space": "ff69ff12d22fdc1a",
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


def parted(make: Callable[[], Bound]) -> Bound:
    """Return a structure whose runs are shared out to as many parts as it has runs."""
    whole = make()
    runs = whole.model.sizes["RUNS"]
    model, state = (Block(each.part, each.sizes | {"PARTS": runs}) for each in (whole.model, whole.state))
    for one, other in ((model, whole.model), (state, whole.state)):
        one.set(**{name: getattr(other, name) for name in other.names() if name != "part_run"})
    model.part_run[:] = np.arange(runs)
    return Bound(model, state)


@pytest.mark.parametrize("kind", ["bridge under a force", "damped tripod", "damped free net"])
def test_threads_change_no_bit(kind: str) -> None:
    """Each run is a part; bands between them are summed before, joints behind."""
    one, several = (parted(STRUCTURES[kind]) for _ in range(2))
    for steps in (1, 39):
        several.advance(steps, STEP, threads=one.model.sizes["PARTS"])
    one.advance(40, STEP)
    np.testing.assert_array_equal(one.state.memory, several.state.memory)
    whole = STRUCTURES[kind]()
    whole.advance(40, STEP)  # rounding differs where sums do
    np.testing.assert_allclose(one.state.position, whole.state.position, rtol=0, atol=1e-12)


def test_half_of_a_net_is_a_part() -> None:
    one, two = (net((30, 9), parts=2) for _ in range(2))
    assert one.model.part_run.tolist() == [0, 4]
    assert one.work.band_part.tolist() == [0, 0, 0, 2, 1, 1, 1, 1, 1]  # 2: joins both
    one.advance(100, STEP)
    two.advance(100, STEP, threads=2)
    np.testing.assert_array_equal(one.state.memory, two.state.memory)
    two.stop.value = 1
    assert two.advance(10, STEP, threads=2) == (0, "stopped")
    with pytest.raises(RopewalkError, match="threads: 3 for 2 parts; use one, or one for each part"):
        two.advance(1, STEP, threads=3)


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
