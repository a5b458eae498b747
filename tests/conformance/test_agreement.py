"""The same thing said in other words is computed by another engine: both must agree, or differ as is known."""

from __future__ import annotations

from functools import cache

import pytest

from conformance.agreement import ALLOWED, KNOWN, LOADS, REASONS, apart
from conformance.cases import scenario
from conformance.loads import load
from conformance.structures import BY_NAME, STRUCTURES, Tree
from conformance.working import answer

TWINS = [structure.name for structure in STRUCTURES if structure.twin]
GROWN = 3.0
"""By so much a known difference may grow: those of runs that go wrong hang on rounding errors."""


@cache
def answered(name: str, kind: str) -> Tree:
    structure = BY_NAME[name]
    loads = {"load": load(structure, kind)} if kind != "none" else {}
    return answer({"scenario": scenario(structure, loads), "tool": "run", "options": {}})


@pytest.mark.parametrize("kind", LOADS)
@pytest.mark.parametrize("name", TWINS)
def test_another_engine_says_the_same_or_differs_as_is_known(name: str, kind: str) -> None:
    """A known difference that has gone must be struck from the list, and none may grow."""
    one, other = answered(BY_NAME[name].twin, kind), answered(name, kind)
    known = KNOWN.get(name, {}).get(kind, {})
    if not other["trace"]:
        assert known == {"refused": 1.0} if other["verdict"] == "refused" else known == {"stopped": 1.0}, other["note"]
        return
    found = apart(one, other)
    print({aspect: f"{size:.3g}" for aspect, size in found.items()})
    beyond = {aspect for aspect, size in found.items() if size > ALLOWED[aspect]}
    new, gone = beyond - set(known), set(known) - beyond
    assert not new, f"differs in {', '.join(f'{aspect} by {found[aspect]:.3g}' for aspect in sorted(new))}"
    assert not gone, f"the known difference in {', '.join(sorted(gone))} is no more: strike it from KNOWN"
    grown = [aspect for aspect in beyond if found[aspect] > GROWN * known[aspect]]
    assert not grown, f"the known difference in {', '.join(grown)} has grown: {found}"


def test_every_known_difference_has_its_reason() -> None:
    named = {(name.split("+")[1], aspect) for name in KNOWN for kind in KNOWN[name].values() for aspect in kind}
    assert named == set(REASONS)
