"""The command `validate`, beside the other commands of `cli`."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer

from ropewalk.cli.console import progress_of_many, reported
from ropewalk.cli.options import Quiet, Workers


def validate(
    only: Annotated[
        list[str] | None,
        typer.Option("--only", metavar="PATTERN", help="Rows, as 'bridge*' or string-force.middle; may be repeated."),
    ] = None,
    listed: Annotated[bool, typer.Option("--list", help="List the rows and compute nothing.")] = False,
    quick: Annotated[bool, typer.Option("--quick", help="Only rows that take a second at most.")] = False,
    faults: Annotated[bool, typer.Option("--faults", help="Insert a fault into each row: it must differ.")] = False,
    output: Annotated[
        list[Path] | None,
        typer.Option("-o", "--output", metavar="OUT", help="Page to write: .md, .html or .json; may be repeated."),
    ] = None,
    workers: Workers = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the rows as JSON.")] = False,
    quiet: Quiet = False,
) -> None:
    """Compare with books, standards and other programs. All that is known there is computed, and judged.

    Exit codes: 0 all rows that were computed agree, 3 one could not be computed, 4 one differs (with --faults: agrees).
    """
    with reported():
        command = import_module("ropewalk.validation.command")
        command.check_outputs(output or [], faults)
        if listed:
            command.tell_rows(only or [], quick, as_json)
            return
        with progress_of_many(quiet) as progress:
            found = import_module("ropewalk.validation.validating").validate(
                only or [], quick=quick, faults=faults, workers=workers, progress=progress
            )
        for file in output or []:
            command.write(found, file)
        command.tell(found, as_json, quiet)
        command.finish(found, quiet, faults)
