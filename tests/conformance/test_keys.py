"""No key is ignored: another value of it changes the result or is refused by name, or there is a reason why neither."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from conformance.bases import BASES
from conformance.keys import (
    FELT,
    REFUSED,
    Change,
    base_scenario,
    changes,
    declarations,
    furnish,
    is_in_the_sample,
    optional,
    outcome,
    places,
)  # fmt: skip
from conformance.unfelt import KNOWN_IGNORED, NEVER, UNFELT
from conformance.working import read_scenario
from ropewalk.errors import RopewalkError

WHOLE = bool(os.environ.get("ROPEWALK_ALL_KEYS"))
"""Whether all is computed, not a sample of it."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files that bases name."""
    found = tmp_path_factory.mktemp("keys")
    furnish(found)
    return found


def excuse(change: Change) -> str:
    """Why a change is not felt, as the lists say; empty if they say nothing."""
    for listed in (UNFELT, KNOWN_IGNORED):
        for name in (change.name, f"{change.name}={change.choice}"):
            for reason, bases in listed.get(name, {}).items():
                if change.base in bases:
                    return reason
    return ""


@pytest.mark.parametrize("base", BASES)
def test_every_key_is_felt_or_refused(base: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    faults, excused, needed = [], set(), set()
    for change in changes(base):
        if not WHOLE and not is_in_the_sample(change):
            continue
        found, reason = outcome(change), excuse(change)
        good = found.verdict in (FELT, REFUSED)
        if not good and not reason:
            faults.append(str(found))
        if reason:
            excused.add(change.name)
            needed |= set() if good else {change.name}
    assert not faults, "\n".join(faults)
    if WHOLE:
        assert excused == needed, f"no excuse is needed any more: {sorted(excused - needed)}"


def test_every_optional_key_is_felt_somewhere() -> None:
    """By the tests above a change that is accepted, and not excused, is felt."""
    missing = {f"{model.__name__}.{key}" for model in declarations() for key in optional(model)}
    for base in BASES:
        for change in changes(base):
            if change.name in missing and not excuse(change):
                try:
                    read_scenario(change.tree())
                except RopewalkError:
                    continue
                missing.discard(change.name)
    assert missing == set(NEVER), sorted(missing ^ set(NEVER))


def test_the_bases_have_every_declaration() -> None:
    found = {type(model) for base in BASES for _, model in places(base_scenario(base))}
    assert found == set(declarations())


def test_the_lists_name_keys_and_bases_that_exist() -> None:
    known = {f"{model.__name__}.{key}" for model in declarations() for key in optional(model)}
    for listed in (UNFELT, KNOWN_IGNORED):
        for name, reasons in listed.items():
            assert name.split("=")[0] in known, name
            assert {base for bases in reasons.values() for base in bases} <= {*BASES}, name
            assert all(reasons), name
