"""The same thing said in other words is computed by another engine: both must agree, or differ as is known."""

from __future__ import annotations

import pytest

from conformance.differences import FILE, LOADS, REASONS, TWINS, differences, known, pair

if not FILE.exists():
    pytest.skip("what is known has not been computed yet: run `make matrix`", allow_module_level=True)

COMMAND = "run `make matrix` and commit what it writes"
GROWN = 3.0
"""By so much a known difference may grow: those of runs that go wrong hang on rounding errors."""


@pytest.mark.parametrize("kind", LOADS)
@pytest.mark.parametrize("name", TWINS)
def test_another_engine_says_the_same_or_differs_as_is_known(name: str, kind: str) -> None:
    """A known difference that has gone must be struck from the list, and none may grow."""
    expected, found = known()[name].get(kind, {}), differences(name, kind)
    message = f"{found}, known {expected}: {pair(name, kind)[1]['note']}"
    assert set(found) <= set(expected), f"a new difference: {message}"
    assert set(expected) <= set(found), f"a known difference is no more; {COMMAND}: {message}"
    assert all(found[aspect] <= GROWN * expected[aspect] for aspect in found), f"a difference has grown: {message}"


def test_every_known_difference_has_a_reason() -> None:
    """Its engine and aspect stand among the reasons; a new kind of difference needs one."""
    named = {
        (name.split("+")[1], aspect) for name, kinds in known().items() for sizes in kinds.values() for aspect in sizes
    }
    assert named <= set(REASONS)
