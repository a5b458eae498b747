"""`ropewalk validate`: quick rows agree, every one of them can fail, and the page has all rows."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from ropewalk.cli.app import app
from ropewalk.validation.judging import judged
from ropewalk.validation.page import as_dict, html, markdown
from ropewalk.validation.registry import CASES, GROUPS
from ropewalk.validation.row_result import AGREES, DIFFERS, FAILED, MISSING, RowResult
from ropewalk.validation.validating import chosen, validate

PAGE = Path(__file__).parents[2] / "docs" / "validation.md"
QUICK = [case for case in CASES.values() if case.quick]
ROWS = [f"{case.id}.{row.name}" for case, row in chosen()]


def test_there_are_rows_with_names_of_their_own() -> None:
    assert len(ROWS) >= 60
    assert len(set(ROWS)) == len(ROWS)
    assert len(CASES) == sum(len(cases) for cases in GROUPS.values())
    assert all(re.fullmatch(r"[a-z0-9-]+\.[a-z0-9-]+", name) for name in ROWS)
    assert all(case.fault or all(row.fault for row in case.rows) for case in CASES.values())
    assert all(row.relative > 0.0 or (row.absolute >= 0.0 and row.reason) for _, row in chosen())


@pytest.mark.parametrize("case", QUICK, ids=lambda case: case.id)
def test_quick_rows_agree_and_fail_with_a_fault_in_what_they_look_at(case) -> None:
    names = [row.name for row in case.rows]
    for finding in judged(case, names):
        assert finding.verdict in (AGREES, MISSING), finding
    if case.there:
        for fault, some in case.by_fault(names).items():
            for finding in judged(case, some, fault):
                assert finding.verdict == DIFFERS, finding


def test_the_page_has_the_rows_of_the_registry_and_none_of_them_fails() -> None:
    """Written by `ropewalk validate -o docs/validation.md`."""
    text = PAGE.read_text(encoding="utf-8")
    found = re.findall(r"^\| (\S+\.\S+) \|(?:[^|]*\|){4} ([a-z ]+) \|[^|]*\|$", text, re.MULTILINE)
    assert [name for name, _ in found] == ROWS
    assert {verdict for _, verdict in found} == {AGREES}
    counts = [re.search(rf"^\| {group} \| (\d+) \| \1 \|(  \|){{3}}$", text, re.MULTILINE) for group in GROUPS]
    assert sum(int(count[1]) for count in counts if count) == len(ROWS)


def run(*arguments: str):
    return CliRunner().invoke(app, ["validate", *arguments])


def test_rows_are_listed_and_chosen(tmp_path: Path) -> None:
    listed = run("--list")
    assert listed.exit_code == 0
    assert [line.split()[0] for line in listed.stdout.splitlines()] == ROWS
    some = run("--only", "cable-c*", "--workers", "0", "-o", str(tmp_path / "page.html"), "--json")
    assert some.exit_code == 0, some.stderr
    told = json.loads(some.stdout)
    assert {row["id"].split(".")[0] for row in told["rows"]} == {"cable-catenary"}
    assert told["verdicts"][AGREES] == len(told["rows"]) == 2
    assert "cable-catenary.sag" in (tmp_path / "page.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--only", "nothing*"), "no row is called so"),
        (("-o", "page.pdf"), "written as .md, .html, .json"),
        (("--faults", "-o", "page.md"), "wrong on purpose"),
    ],
)
def test_what_is_not_there_is_refused(arguments: tuple[str, ...], said: str) -> None:
    found = run(*arguments)
    assert found.exit_code == 2
    assert said in found.stderr


def test_the_exit_code_tells_what_failed(monkeypatch: pytest.MonkeyPatch) -> None:
    case = CASES["cable-catenary"]
    wrong = replace(case, settings=case.fault)
    broken = replace(case, settings=("lines.rope.length=1 kg",))
    missing = replace(case, needs="no_such_package")
    codes = []
    for other in (wrong, broken, missing):
        monkeypatch.setitem(CASES, case.id, other)
        codes.append(run("--only", case.id, "--workers", "0").exit_code)
    assert codes == [4, 3, 0]


def test_with_faults_it_is_agreement_that_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    case = CASES["cable-catenary"]
    harmless = replace(case, fault=("title=the same",))
    codes = []
    for other in (case, harmless, replace(case, fault=("lines.rope.length=1 kg",))):
        monkeypatch.setitem(CASES, case.id, other)
        codes.append(run("--only", case.id, "--faults", "--workers", "0").exit_code)
    assert codes == [0, 4, 3]


def test_rows_come_out_the_same_in_processes_of_their_own() -> None:
    here, there = (validate(["cable-catenary"], workers=workers) for workers in (0, 1))
    assert [(one.id, one.ours) for one in here] == [(one.id, one.ours) for one in there]


def test_differences_from_ranges_and_what_did_not_come_out() -> None:
    inside, above = (RowResult("case.row", AGREES, 1.0, 2.0, ours, 0.0) for ours in (1.5, 2.25))
    assert (inside.difference, above.difference) == (0.0, 0.25)
    assert inside.as_dict()["reference"] == [1.0, 2.0]
    lost = RowResult("case.row", FAILED, reason="why")
    assert math.isnan(lost.difference)
    assert lost.as_dict()["ours"] is lost.as_dict()["reference"] is None


def test_pages_tell_rows_that_failed() -> None:
    found = [RowResult("cable-catenary.sag", FAILED, reason="why | so")]
    assert "| failed |" in markdown(found)
    assert 'class="failed"' in html(found)
    assert as_dict(found)["verdicts"] == {AGREES: 0, DIFFERS: 0, FAILED: 1, MISSING: 0}
