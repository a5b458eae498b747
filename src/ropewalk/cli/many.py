"""Commands of many runs: maps, sweeps, designs; imports where they are needed, as on all of the command line."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer

from ropewalk.cli.console import (
    FIGURE_SUFFIXES,
    check_pictures,
    echo,
    load_scenario,
    now_called,
    print_json,
    progress_of_many,
    reported,
    save_figure,
    say,
)
from ropewalk.cli.options import Cluster, Derive, Json, NoCode, Picture, Quiet, ScenarioFile, Settings, Store, Workers


def adequacy(
    file: ScenarioFile,
    x: Annotated[str, typer.Option("--x", metavar="KEY=FROM:TO:COUNT[:log]", help="First parameter, key or ratio.")],
    y: Annotated[str, typer.Option("--y", metavar="KEY=FROM:TO:COUNT[:log]", help='Second, as "load ratio=0.01:1:9".')],
    model: Annotated[list[str], typer.Option("--model", help="Simpler model; may be repeated.")] = ["linear"],  # noqa: B006
    rung: Annotated[list[str] | None, typer.Option(hidden=True, callback=now_called("--model"))] = None,
    quantity: Annotated[str, typer.Option("--quantity", help="Quantity that is compared.")] = "deflection",
    tolerance: Annotated[str, typer.Option("--tolerance", help="Allowed relative error, 0.02 or 2 %.")] = "5 %",
    store: Annotated[Path | None, typer.Option("--store", help="Points [default: FILE.adequacy.jsonl].")] = None,
    workers: Workers = None,
    retry: Annotated[bool, typer.Option("--retry", help="Repeat failed points.")] = False,
    output: Picture = None,
    no_code: NoCode = False,
    settings: Settings = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Map the accuracy of simpler models over two parameters. Continues an interrupted map."""
    with reported(), progress_of_many(quiet) as progress:
        check_pictures(output, FIGURE_SUFFIXES)
        model = rung or model
        found = import_module("ropewalk.compare.command").adequacy_from_text(
            load_scenario(file, settings, no_code), (x, y), model, quantity, tolerance,
            store or Path(f"{file.stem}.adequacy.jsonl"), workers, retry, progress,
        )  # fmt: skip
        for picture in output or []:
            save_figure(found.figure(model), picture)
    if as_json:
        print_json(found.as_dict())
    elif not quiet:
        echo("\n".join(str(found.coverage(name)) for name in model))


def sweep(
    file: ScenarioFile,
    over: Annotated[
        list[str] | None, typer.Option("--over", metavar="KEY=VALUES", help="Key, values: 100:350:5km/h, or a,b,c.")
    ] = None,
    derive: Derive = None,
    record: Annotated[
        str | None, typer.Option("--record", metavar="NAMES", help="Recorded quantities: 'max tension, largest_sag'.")
    ] = None,
    output: Annotated[
        list[Path] | None,
        typer.Option(
            "-o", "--output", metavar="OUT", help=".nc, .csv, .xlsx, .parquet, .png, .svg or .pdf; repeat it."
        ),
    ] = None,
    combine: Annotated[
        str | None,
        typer.Option(
            "--combine", help="grid (default), zip, one_at_a_time, latin_hypercube, sobol, random, morris or saltelli."
        ),
    ] = None,
    count: Annotated[int | None, typer.Option("--count", help="Number of sampled cases, or of groups.")] = None,
    seed: Annotated[int | None, typer.Option("--seed", help="Seed of the sampling.")] = None,
    store: Store = None,
    workers: Workers = None,
    cluster: Cluster = None,
    retry: Annotated[bool, typer.Option("--retry", help="Repeat failed cases.")] = False,
    no_code: NoCode = False,
    settings: Settings = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run a scenario many times with other values. Uses all cores; continues an interrupted sweep."""
    with reported():
        package, outputs = import_module("ropewalk.sweeps.command"), output or []
        package.check_outputs(outputs)
        store = store or Path(f"{file.stem}.sweep.jsonl")
        scenario = load_scenario(file, settings, no_code)
        with progress_of_many(quiet) as progress:
            found = package.sweep_from_text(
                scenario, over or [], derive or [], progress, record=record, combine=combine, count=count,
                seed=seed, store=store, workers=workers, cluster=cluster, retry=retry,
            )  # fmt: skip
        package.tell(found, outputs, as_json, quiet)
        package.finish(found, store, outputs, quiet)


def design(
    file: ScenarioFile,
    vary: Annotated[
        list[str] | None,
        typer.Option("--vary", metavar="KEY=LOW:HIGH", help="Design variable, as lines.rope.tension=5:40 kN."),
    ] = None,
    minimise: Annotated[
        str | None, typer.Option("--minimise", "--minimize", metavar="QUANTITY", help="Quantity to minimise.")
    ] = None,
    maximise: Annotated[
        str | None, typer.Option("--maximise", "--maximize", metavar="QUANTITY", help="Quantity to maximise.")
    ] = None,
    subject_to: Annotated[
        list[str] | None, typer.Option("--subject-to", metavar="LIMIT", help='Limit, as "max strain < 2 %"; repeat it.')
    ] = None,
    derive: Derive = None,
    output: Annotated[
        list[Path] | None,
        typer.Option(
            "-o", "--output", metavar="OUT", help="Best scenario: .yaml; history: .nc, .csv, .png; repeat it."
        ),
    ] = None,
    method: Annotated[
        str | None, typer.Option("--method", help="models (few variables) or optuna (many, noisy).")
    ] = None,
    tolerance: Annotated[
        float, typer.Option("--tolerance", metavar="PART", help="Tolerance, as a fraction of each range.")
    ] = 1e-3,
    first: Annotated[
        int | None, typer.Option("--first", metavar="N", help="Number of initial points, spread over all ranges.")
    ] = None,
    most: Annotated[
        int | None, typer.Option("--most", metavar="N", help="Maximum number of runs [default: 50 per variable].")
    ] = None,
    seed: Annotated[int, typer.Option("--seed", help="Seed of the first points.")] = 0,
    store: Store = None,
    workers: Workers = None,
    cluster: Cluster = None,
    no_code: NoCode = False,
    settings: Settings = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Find the best values within limits. Continues an interrupted search."""
    with reported():
        package, outputs = import_module("ropewalk.designs.command"), output or []
        package.check_outputs(outputs, file)
        store = store or Path(f"{file.stem}.sweep.jsonl")
        scenario = load_scenario(file, settings, no_code)
        with progress_of_many(quiet) as progress:
            found = package.design_from_text(
                scenario, vary or [], derive or [], progress, minimise=minimise, maximise=maximise,
                subject_to=subject_to or [], method=method, tolerance=tolerance, first=first, most=most, seed=seed,
                store=store, workers=workers, cluster=cluster,
            )  # fmt: skip
        for written in package.tell_design(found, file, settings or [], outputs):
            if not quiet:
                say(f"{written} written")
        package.print_design(found, as_json, quiet)
        package.finish_design(found, store, quiet)


def fit(
    file: ScenarioFile,
    data: Annotated[Path, typer.Option("--data", metavar="CSV", help="Measured values: quantity, value; or series.")],
    vary: Annotated[
        list[str] | None, typer.Option("--vary", metavar="KEY=LOW:HIGH", help="Unknown value and its bounds.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="OUT.yaml", help="Scenario with the fitted values.")
    ] = None,
    no_code: NoCode = False,
    settings: Settings = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Fit unknown values to measured ones. Prints their confidence intervals."""
    with reported():
        package = import_module("ropewalk.designs.command")
        if output is not None:
            package.check_outputs([output], file, package.SCENARIOS)
        found = package.fit_from_text(load_scenario(file, settings, no_code), vary or [], data)
        if output is not None:
            overrides = [f"{key}={value}" for key, value in found.values.items()]
            package.write_scenario(output, file, [*(settings or []), *overrides])
            if not quiet:
                say(f"{output} written")
        package.print_fit(found, as_json, quiet)


COMMANDS = (adequacy, sweep, design, fit)
