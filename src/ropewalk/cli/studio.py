"""The command `studio`, beside the other commands of `cli`."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer

from ropewalk.cli.console import fail, reported


def studio(
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE]", help="Scenario or result; its folder is opened [default: here].")
    ] = None,
    port: Annotated[int, typer.Option("--port", metavar="N", help="Port on 127.0.0.1; 0: any that is free.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")] = True,
    allow_code: Annotated[
        bool, typer.Option("--allow-code", help="Run scenarios with external code: steppers and FMUs.")
    ] = False,
    memory: Annotated[
        float, typer.Option("--memory", metavar="GB", help="Memory limit of each process; 0: no limit.")
    ] = 4.0,
    pages: Annotated[int, typer.Option("--pages", metavar="N", help="Limit of pages that compute at once.")] = 4,
    seconds: Annotated[float, typer.Option("--seconds", metavar="S", help="Time limit of a run.")] = 3600.0,
    workers: Annotated[
        int | None,
        typer.Option("--workers", metavar="N", min=0, help="Processes of a sweep [default: one for each core]."),
    ] = None,
    disk: Annotated[
        float, typer.Option("--disk", metavar="GB", help="Disk limit of the files in the folder; 0: no limit.")
    ] = 20.0,
) -> None:
    """See, drag, run and share structures in the browser. Served to this machine only."""
    with reported():
        folder, name = Path.cwd() if file is None else file.absolute().parent, "" if file is None else file.name
        if not folder.is_dir():
            fail(f"{folder}: there is no such folder")
        if file is not None and not file.is_file():
            fail(f"{file}: there is no such file; write one with  ropewalk new {file.stem}")
        if file is not None and file.suffix.lower() not in (".yaml", ".yml", ".json", ".nc"):
            fail(f"{file}: give a scenario (.yaml, .json) or a result (.nc)")
        try:
            serving = import_module("ropewalk.studio.serving")
        except ImportError as problem:
            fail(f'{problem}; the studio needs more packages: pip install "ropewalk[studio]"')
            raise
        memory, disk = 1e9 * memory, 1e9 * disk
        settings = serving.Settings(folder, name, allow_code, int(memory), max(pages, 1), seconds, workers, int(disk))
        serving.serve(settings, port, browser)
