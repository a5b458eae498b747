"""An overhead line and its pantograph on the core: ranges of EN 50318:2002, rest, order in the step, bits.

`python tests/core_overhead.py` prints both speeds, both meshes and both kinds of motion.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from core_overhead import Reference
from core_structures import collected
from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, RunProperties
from ropewalk.engine.library import variants
from ropewalk.errors import RopewalkError

Array = NDArray[np.float64]


@pytest.mark.parametrize(("linearised", "inner"), [(True, 1), (False, 7)])
def test_all_quantities_are_inside_the_ranges_of_the_standard(linearised: bool, inner: int) -> None:
    found = Reference(0.5, linearised, 300, inner=inner).passage()
    print(found)
    assert found.outside(300) == []
    # unfiltered, as of today's engine: 41.6 N converged; a contact that blows up passes the filtered ranges
    assert found.raw == pytest.approx(41.6, abs=1.5)


def test_line_at_rest_stays_there_with_inner_steps() -> None:
    bound = Reference(0.5, False, 300, inner=7).build()
    bound.state.velocity[:] = bound.state.predicted[:] = 0.0
    begin = bound.state.position.copy()
    bound.advance(300, 9e-4)
    # the pantograph presses on the wire once in each step; what droppers bear is in the weights
    assert np.abs(bound.state.position - begin)[1].max() < 2e-5


@pytest.mark.parametrize(("kind", "inner"), [("taut", 1), ("plain", 1), ("taut", 3), ("plain", 4)])
def test_motion_under_a_collector_is_of_the_second_order_in_the_step(kind: str, inner: int) -> None:
    found, time = [], 0.1 if kind == "taut" else 0.04  # s; axial waves are fast
    for factor in (1, 2, 4):
        bound = collected(kind, inner)
        bound.advance(96 * factor, time / (96 * factor))
        found.append(bound.state.position.copy())
    order = np.log2(np.linalg.norm(found[0] - found[1]) / np.linalg.norm(found[1] - found[2]))
    print("order", order)
    assert abs(order - 2.0) < 0.15


@pytest.mark.parametrize("inner", [1, 4])
@pytest.mark.parametrize("kind", ["taut", "plain"])
def test_bits_are_the_same_in_all_variants_and_divisions(kind: str, inner: int) -> None:
    whole = collected(kind, inner)
    whole.advance(300, 2.0**-11)
    for variant in variants():
        parts = collected(kind, inner)
        for _ in range(10):
            parts.advance(30, 2.0**-11, variant)
        np.testing.assert_array_equal(parts.state.memory, whole.state.memory)


def test_records_are_what_was_before_each_step() -> None:
    recorded, followed = collected("plain"), collected("plain")
    force, _ = recorded.record(150, 4e-4)  # more than a call records
    np.testing.assert_array_equal(recorded.state.memory, followed_by(followed, 150).state.memory)
    assert force.shape == (1, 150)
    assert force.max() > 1.0


def followed_by(bound: Bound, steps: int) -> Bound:
    bound.advance(steps, 4e-4)
    return bound


def test_structures_that_record_nothing_say_so() -> None:
    builder = Builder()
    builder.add_node([0.0, 0.0], 1.0)
    with pytest.raises(RopewalkError, match="records nothing"):
        Bound(*builder.build()).record(3, 1e-3)


def test_a_string_gives_way_under_a_collector_as_its_closed_form() -> None:
    """Anywhere in a link: x (L - x)/(L T), and the contact."""
    T, L = 1000.0, 10.0
    for place in (3.0, 3.07, 3.125, 3.2, 0.1, 9.9):
        builder = Builder(gravity=0.0)
        points = np.array([np.linspace(0.0, L, 41), np.zeros(41)])
        run = RunProperties(0.25, 0.5, 0.0, curved=False, tension=T, taut=True)
        first, last = builder.add_run(points, run)
        builder.fix(first, last)
        builder.fix(*range(41), axes=[0])
        body = builder.add_node([place, 0.01], 0.0)
        builder.fix(body)
        builder.add_collector(0, body, 5e3)
        bound = Bound(*builder.build())
        at = bound.linearise()
        free = bound.unknowns()
        move = np.linalg.solve((free.T @ at.stiffness @ free).toarray(), free.T @ at.forces.ravel())
        bound.state.position[:] += (free @ move).reshape(bound.state.position.shape)
        force = -bound.forces()[1, body]
        give = place * (L - place) / (L * T) + 1.0 / 5e3
        assert force == pytest.approx(0.01 / give, rel=1e-9)
