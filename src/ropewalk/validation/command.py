"""The command `validate`: rows and verdicts as text and files, and the exit code."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from ropewalk.cli.console import DOUBTFUL, STOPPED_EARLY, fail, print_columns, print_json, say, write_text
from ropewalk.results import ResultError
from ropewalk.validation.page import as_dict, html, markdown, number, reference_of, said_of
from ropewalk.validation.row_result import AGREES, DIFFERS, FAILED, MISSING, RowResult
from ropewalk.validation.validating import chosen

SUFFIXES = (".md", ".html", ".json")


def check_outputs(outputs: Sequence[Path], faults: bool = False) -> None:
    """Refuse files that cannot be written, before anything is computed.

    Raises:
        ResultError: another suffix, no such folder, or a page of rows with faults.
    """
    if outputs and faults:
        raise ResultError("--faults: no page is written of rows that are wrong on purpose; leave out -o, or use --json")
    for file in outputs:
        if file.suffix.lower() not in SUFFIXES:
            raise ResultError(f"{file}: the page is written as {', '.join(SUFFIXES)}")
        if not file.parent.is_dir():
            raise ResultError(f"{file}: the folder {file.parent} does not exist; create it or choose another place")


def tell_rows(only: Sequence[str], quick: bool, as_json: bool) -> None:
    """Print the rows that are chosen.

    Raises:
        ScenarioError: a pattern fits none.
    """
    rows = [
        (f"{case.id}.{row.name}", f"{case.what}: {row.what}", str(case.source)) for case, row in chosen(only, quick)
    ]
    if as_json:
        print_json([dict(zip(("id", "what", "source"), row, strict=True)) for row in rows])
    else:
        print_columns([row[:2] for row in rows])


def tell(found: Sequence[RowResult], as_json: bool, quiet: bool) -> None:
    """Print what came out."""
    if as_json:
        print_json(as_dict(found))
    elif not quiet:
        units = {f"{case.id}.{row.name}": row.unit for case, row in chosen()}
        head = ("row", "reference", "ours", "", "verdict")
        print_columns(
            [head, *((one.id, reference_of(one), number(one.ours), units[one.id], one.verdict) for one in found)]
        )


def finish(found: Sequence[RowResult], quiet: bool, faults: bool = False) -> None:
    """Say what does not agree (with faults: differ), and leave with the exit code of the worst."""
    wanted = DIFFERS if faults else AGREES
    if not quiet:
        for finding in found:
            if finding.verdict != wanted:
                say(f"{finding.id}: {finding.verdict}{': ' if finding.reason else ''}{finding.reason}")
    bad = {finding.verdict for finding in found} - {wanted, MISSING}
    if bad:
        fail(said_of(found), STOPPED_EARLY if bad == {FAILED} else DOUBTFUL)
    if not quiet:
        say(said_of(found))


def write(found: Sequence[RowResult], file: Path) -> None:
    """Write the page."""
    kind = file.suffix.lower()
    if kind == ".json":
        write_text(json.dumps(as_dict(found), indent=2, ensure_ascii=False) + "\n", file)
    else:
        write_text(markdown(found) if kind == ".md" else html(found), file)
