"""Arguments and options that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

ScenarioFile = Annotated[Path, typer.Argument(metavar="FILE", help="Scenario file, YAML or JSON.")]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a value, as run.until=2s; may be repeated."),
]
Picture = Annotated[
    list[Path] | None,
    typer.Option("-o", "--output", metavar="FIG", help="Figure: .png, .svg or .pdf; may be repeated."),
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
NoCode = Annotated[bool, typer.Option("--no-code", help="Refuse files that run external code: steppers and FMUs.")]
Units = Annotated[
    str,
    typer.Option(
        "--units", metavar="UNITS", help="Units of output: engineering, SI, or a list as kN,mm,km/h [JSON is in SI]."
    ),
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print errors only, no progress and no table.")]
Derive = Annotated[
    list[str] | None, typer.Option("--derive", metavar="KEY=EXPR", help="Dependent value: run.until='9 m / speed'.")
]
Store = Annotated[Path | None, typer.Option("--store", help="Finished cases [default: FILE.sweep.jsonl].")]
Workers = Annotated[int | None, typer.Option("--workers", help="Processes [default: one for each core].")]
Cluster = Annotated[str | None, typer.Option("--cluster", metavar="tcp://...", help="A Dask scheduler.")]
