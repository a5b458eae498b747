"""The command `calc`, beside the other commands of `cli`."""

from __future__ import annotations

from importlib import import_module
from typing import Annotated

import typer

from ropewalk.cli.console import display_units, echo, print_columns, print_json, reported


def calc(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="[CALCULATOR]", help="span, catenary, highline, zipline, string or beam [default: list]."
        ),
    ] = None,
    given: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[KEY=VALUE]...", help="Given quantities, as span=63m; sag=? prints this one only [default: list]."
        ),
    ] = None,
    units: Annotated[
        str, typer.Option("--units", metavar="UNITS", help="Units of output: engineering, SI, or a list as kN,mm,km/h.")
    ] = "engineering",
    as_json: Annotated[bool, typer.Option("--json", help="Print the answer as JSON, in SI.")] = False,
) -> None:
    """Answer from closed forms, in a second. Given any sufficient set of quantities, the others."""
    with reported():
        displayed, command = display_units(units), import_module("ropewalk.calc.command")
        if name is None:
            print_columns(command.overview())
        elif not given:
            echo(command.quantities_of(name))
        else:
            answer = command.calculated(name, given)
            if as_json:
                print_json(answer.as_dict())
            else:
                echo(command.text(answer, displayed))
