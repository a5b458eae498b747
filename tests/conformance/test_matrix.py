"""The matrix of what works: its verdicts hold for a sample, every refusal is as told, and the page says so."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from conformance import capabilities
from conformance.cases import Case, cases
from conformance.judging import CRASH, DIFFERS, REFUSED, WRONG
from conformance.refusals import REFUSALS
from conformance.sample import chosen
from conformance.verdicts import FILE, UNKNOWN, read, verdict_of
from conformance.working import answer, furnish, read_scenario
from ropewalk.errors import ScenarioError
from ropewalk.model._base import Declaration

if not FILE.exists():
    pytest.skip("what is known has not been computed yet: run `make matrix`", allow_module_level=True)

COMMAND = "run `make matrix`, look at what it prints, and commit what it writes"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files that scenarios name."""
    found = tmp_path_factory.mktemp("matrix")
    furnish(found)
    return found


def answered(case: Case) -> str:
    return verdict_of(answer({"scenario": case.scenario, "tool": case.tool, "options": case.options}))


def test_every_case_has_its_verdict_and_every_verdict_its_case() -> None:
    names = [case.name for case in cases()]
    assert len(set(names)) == len(names)
    assert set(names) == set(read()), COMMAND


def test_nothing_is_wrong_in_silence() -> None:
    faults = [f"{word}: {name}" for name, word in read().items() if word in (WRONG, CRASH) or UNKNOWN in word]
    assert not faults, "\n".join(faults)


def test_the_page_of_capabilities_says_what_the_verdicts_say() -> None:
    assert capabilities.FILE.read_text(encoding="utf-8") == capabilities.page(cases(), read()), COMMAND


def test_what_check_refuses_is_what_the_verdicts_say_is_refused() -> None:
    """The whole matrix, as far as nothing needs to be computed: seconds."""
    verdicts, faults = read(), []
    for case in cases():
        word = verdicts[case.name]
        try:
            read_scenario(case.scenario)
        except ScenarioError:
            found = answered(case)
        else:
            found = word  # what is refused later on is a matter for the sample
        if found != word:
            faults.append(f"{case.name}: {found}, not {word}")
    assert not faults, "\n".join([*faults, COMMAND])


def _by_structure() -> Iterator[Any]:
    grouped = defaultdict(list)
    for case, word in chosen():
        grouped[case.structure].append((case, word))
    for structure, members in grouped.items():
        yield pytest.param(members, id=structure)


@pytest.mark.parametrize("members", list(_by_structure()))
def test_a_sample_of_runs_does_as_the_verdicts_say(
    members: list[tuple[Case, str]], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every load on every structure, every row with every family of structures and with every load."""
    monkeypatch.chdir(folder)
    faults = []
    for case, word in members:
        found = answered(case)
        if found != word and word != DIFFERS:  # who differs is told from two runs: tests of agreement
            faults.append(f"{case.name}: {found}, not {word}")
    assert not faults, "\n".join([*faults, COMMAND])


def kinds_declared(base: type = Declaration) -> Iterator[str]:
    """Every `kind` that a scenario file may have."""
    for model in base.__subclasses__():
        if "kind" in model.model_fields and isinstance(kind := model.model_fields["kind"].default, str):
            yield kind
        yield from kinds_declared(model)


def kinds_in(tree: Any) -> Iterator[str]:
    """Every `kind` that a scenario has."""
    if isinstance(tree, dict):
        if isinstance(tree.get("kind"), str):
            yield tree["kind"]
        for value in tree.values():
            yield from kinds_in(value)
    elif isinstance(tree, list | tuple):
        for value in tree:
            yield from kinds_in(value)


def test_every_kind_of_the_schema_is_in_the_matrix() -> None:
    found = {kind for case in cases() for kind in kinds_in(case.scenario)}
    understood = {"hooke", "prescribed", "rest", "result"}  # defaults, and what the tool "go on" starts from
    assert set(kinds_declared()) - understood <= found


def test_every_reason_to_refuse_is_met_by_a_case() -> None:
    """A reason that nobody meets any more has gone: the list shrinks."""
    met = {word.removeprefix(f"{REFUSED}: ") for word in read().values()}
    assert {refusal.reason for refusal in REFUSALS} <= met, COMMAND
