"""The command line: thin, with imports where they are needed, so that `--help` answers at once.

Results go to stdout, messages and progress to stderr. Exit codes: 0 fine, 1 a fault of ropewalk itself, 2 bad
input, 3 a run that stopped early, 4 a run that must not be trusted, 130 interrupted.
"""

from __future__ import annotations

from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import ropewalk
from ropewalk.cli import many
from ropewalk.cli.calculating import calc
from ropewalk.cli.console import (
    CHECKED,
    FIGURE_SUFFIXES,
    FILM_SUFFIXES,
    TABLE_SUFFIXES,
    TRACEBACK,
    check_pictures,
    display_units,
    echo,
    fail,
    finish,
    foreseen,
    foretell,
    load_scenario,
    open_unless_interrupted,
    print_columns,
    print_json,
    print_summary,
    progress_bar,
    progress_of_many,
    progress_of_run,
    quantity_of,
    reported,
    save_figure,
    say,
    show_in,
)
from ropewalk.cli.lines import elasticity
from ropewalk.cli.options import Json, NoCode, Picture, Quiet, ScenarioFile, Settings, Units, Workers
from ropewalk.cli.single_output import CommandWithOutput
from ropewalk.cli.studio import studio
from ropewalk.cli.validating import validate
from ropewalk.permission import forbid_code, is_code_forbidden

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.results.display_units import DisplayUnits

app = typer.Typer(
    name="ropewalk",
    help="Simulate loads that travel along ropes, beams, overhead lines and nets.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,  # rich takes longer to import than the rest together
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        echo(f"ropewalk {ropewalk.__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
    traceback: Annotated[bool, typer.Option("--traceback", help="Print the traceback of an error.")] = False,
) -> None:
    TRACEBACK.set(traceback)


@app.command()
def new(
    name: Annotated[
        str | None,
        typer.Argument(metavar="[NAME]", help="Name of the scenario and its file [default: list the templates]."),
    ] = None,
    trade: Annotated[
        str, typer.Option("--template", "-t", metavar="TEMPLATE", help="Template, for example ropeway or highline.")
    ] = "rope",
) -> None:
    """Write a first scenario, or list the templates. NAME.yaml is commented for its application."""
    with reported():
        from ropewalk.scenario.template import template, trades

        if name is None:
            print_columns([(f"ropewalk new NAME --template {key}", about) for key, about in trades().items()])
            return
        file = Path(name if name.endswith((".yaml", ".yml")) else f"{name}.yaml")
        text = template(file.stem, trade)
        try:
            with file.open("x", encoding="utf-8") as stream:
                stream.write(text)
        except FileExistsError:
            fail(f"{file}: exists already; choose another name")
        except OSError as problem:
            fail(f"{file}: cannot be written ({problem.strerror})")
        say(f"{file} written; next:  ropewalk run {file}")


@app.command()
def check(file: ScenarioFile, settings: Settings = None) -> None:
    """List every mistake in a scenario; estimate its run time."""
    with reported():
        scenario = load_scenario(file, settings)
        if scenario.loads:
            import_module("ropewalk.external.models").check_external(scenario.loads)
        if scenario.sweep is not None:
            import_module("ropewalk.sweeps.plan").Plan.of(scenario, scenario.sweep, CHECKED)
        names = ", ".join((*scenario.lines, *scenario.overhead_lines, *scenario.loads))
        work, warnings = foreseen(file, scenario)
        echo(f"{file}: valid ({scenario.title}: {names}; {scenario.run.kind})\n{work}")
        for warning in warnings:
            echo(f"warning: {warning}")


@app.command()
def run(
    file: ScenarioFile,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="OUT.nc", help="Result file [default: FILE.nc here].")
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace OUT.nc even if it holds a result of another scenario.")
    ] = False,
    no_code: NoCode = False,
    settings: Settings = None,
    units: Units = "engineering",
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Compute a scenario; write the result, print a summary."""
    target = output if output is not None else Path(f"{file.stem}.nc")
    with reported(target):
        from ropewalk.results import check_target

        scenario = load_scenario(file, settings, no_code)
        displayed = display_units(units)
        check_target(target)
        replaced = " (replaced)" if target.exists() else ""
        from ropewalk.simulate import simulate

        with progress_of_run(scenario, quiet) as progress:
            begun = None if quiet else foretell(scenario)
            dataset = simulate(
                scenario, file=target, overwrite=overwrite, progress=progress, begun=begun,
                opened=partial(open_unless_interrupted, target),
            )  # fmt: skip
        _close(dataset, target, replaced, displayed, as_json=as_json, quiet=quiet)


def _close(dataset: xr.Dataset, file: Path, remark: str, units: DisplayUnits, *, as_json: bool, quiet: bool) -> None:
    """Print the summary of a result that has just been written, and end as its outcome says."""
    from ropewalk.results import summary

    with dataset:
        found = summary(dataset)
    print_summary({"file": str(file), **found}, as_json, quiet, units)
    if not quiet:
        say(f"result written to {file}{remark}")
    finish(found, file)


@app.command()
def resume(
    result: Annotated[Path, typer.Argument(metavar="OUT.nc", help="Result file of a motion.")],
    until: Annotated[
        str | None, typer.Option("--until", metavar="TIME", help="New end of the run, as 20s [default: as it was].")
    ] = None,
    no_code: NoCode = False,
    units: Units = "engineering",
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Continue a run that was interrupted or is to be longer. The result file is extended."""
    with reported(result):
        end = None if until is None else quantity_of(until, "s")
        displayed = display_units(units)
        if no_code:
            forbid_code()
        with import_module("ropewalk.resuming").taken_up(result, end) as rest:
            if is_code_forbidden():
                import_module("ropewalk.external.models").refuse_code(rest.scenario.loads)
            if not quiet:
                say(f"continuing from t = {rest.begin:.6g} s")
            with progress_of_run(rest.scenario, quiet) as progress:
                dataset = rest.run(progress, partial(open_unless_interrupted, result))
        _close(dataset, result, "", displayed, as_json=as_json, quiet=quiet)


@app.command()
def show(
    result: Annotated[Path, typer.Argument(metavar="OUT.nc", help="Result file.")],
    output: Annotated[
        list[Path] | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FIG|FILM|REPORT|TABLE|PVD",
            help="Write .png, .svg, .pdf, .gif, .mp4, .html, .csv, .xlsx, .parquet, or .pvd for ParaView; repeat it.",
        ),
    ] = None,
    every: Annotated[
        str | None, typer.Option("--every", metavar="TIME", help="Interval between the rows of a table, as 0.1s.")
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option("--at", metavar="TIME", help="Instant of a row of a table; may be repeated."),
    ] = None,
    panels: Annotated[
        str | None,
        typer.Option("--panels", metavar="NAMES", help="Panels of a figure or its table: tension,contact_force,..."),
    ] = None,
    size: Annotated[
        str | None,
        typer.Option("--size", metavar="SIZE", help="Size of a figure (16x9cm, report, journal) or film (1280x720)."),
    ] = None,
    units: Annotated[
        str | None,
        typer.Option("--units", metavar="UNITS", help="Units: engineering, SI, or a list as kN,mm,km/h [tables: SI]."),
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Print the summary of a result, or draw, film or export it. The suffix of OUT selects the format."""
    with reported():
        if (many := import_module("ropewalk.sweeps.writing").read(result)) is not None:
            import_module("ropewalk.sweeps.command").tell(many, output or [], as_json, quiet)
            return
        check_pictures(output)
        _check_choices({file.suffix.lower() for file in output or []}, every or at, panels, size)
        displayed = display_units(units or "engineering")
        from ropewalk.results import open_result, summary

        with open_result(result) as dataset:
            if not output or as_json:
                print_summary({"file": str(result), **summary(dataset)}, as_json, quiet, displayed)
            names = None if panels is None else [name.strip() for name in panels.split(",")]
            for file in output or []:
                own = names if file.suffix.lower() in (*FIGURE_SUFFIXES, *TABLE_SUFFIXES) else None
                written = show_in(dataset, file, quiet, own, size, None if units is None else displayed, every, at)
                if not quiet:
                    say(f"{' and '.join(map(str, written))} written")


def _check_choices(kinds: set[str], rows: str | list[str] | None, panels: str | None, size: str | None) -> None:
    """Refuse options that none of the kinds of files to write has."""
    if rows and (panels or not kinds & {*TABLE_SUFFIXES}):
        fail(f"--every and --at choose the rows of tables; write one with -o OUT{', OUT'.join(TABLE_SUFFIXES)}")
    if panels and not kinds & {*FIGURE_SUFFIXES, *TABLE_SUFFIXES}:
        fail(f"--panels chooses the panels of a figure; write one with -o OUT{', OUT'.join(FIGURE_SUFFIXES)}")
    if size and not kinds & {*FIGURE_SUFFIXES, *FILM_SUFFIXES}:
        fail("--size is that of a figure or a film; write one with -o")


@app.command()
def figures(
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Folder.")] = Path("figures"),
    only: Annotated[
        list[str] | None,
        typer.Option("--only", metavar="N", help="Draw this figure only, by number or name; may be repeated."),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Compute and draw the figures of the paper."""
    with reported():
        paper = import_module("ropewalk.paper")
        known = {str(entry): entry for entry in paper.AVAILABLE}
        for name in only or ():
            if name not in known:
                fail(f"--only {name}: unknown figure; choose from {', '.join(known)}")
        with progress_bar("drawing", quiet) as progress:
            paper.figures(output, only=[known[name] for name in only] if only else None, progress=progress)
        if not quiet:
            say(f"figures written to {output}")


@app.command()
def spectrum(
    file: ScenarioFile,
    at: Annotated[
        float | None, typer.Option("--at", metavar="TIME", help="Instant of the run in s [default: equilibrium].")
    ] = None,
    output: Picture = None,
    no_code: NoCode = False,
    settings: Settings = None,
    as_json: Json = False,
) -> None:
    """Compute natural frequencies and damping; draw the modes."""
    with reported():
        check_pictures(output, FIGURE_SUFFIXES)
        found = import_module("ropewalk.simulate").spectrum_of(load_scenario(file, settings, no_code), at=at)
        if as_json:
            print_json(found.as_dict())
        else:
            print_columns([*found.table()])
        for picture in output or []:
            save_figure(import_module("ropewalk.results.spectrum_figure").mode_figure(found), picture)
            say(f"{picture} written")


@app.command()
def feedback(file: ScenarioFile, no_code: NoCode = False, settings: Settings = None, as_json: Json = False) -> None:
    """Compare a run with its loads on rigid ground. Shows the effect of the coupling."""
    with reported():
        found = import_module("ropewalk.coupling").feedback(load_scenario(file, settings, no_code))
        if as_json:
            print_json(found.as_dict())
        else:
            rows = found.table()
            widths = [max(len(row[k]) for row in rows) for k in range(3)]
            for what, coupled, without, change in rows:
                row = f"{what:{widths[0]}}  {coupled:>{widths[1]}}  {without:>{widths[2]}}  {change}"
                echo(row.rstrip())
            echo(f"\n{found.verdict}")


@app.command()
def compare(
    file: ScenarioFile,
    output: Picture = None,
    tolerance: Annotated[float, typer.Option("--tolerance", metavar="PART", help="Allowed distance, as 0.02.")] = 0.05,
    no_code: NoCode = False,
    settings: Settings = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Compare simpler models with the full one. Names the simplest adequate model."""
    with reported():
        check_pictures(output, FIGURE_SUFFIXES)
        scenario = load_scenario(file, settings, no_code)
        package = import_module("ropewalk.compare")
        with progress_of_many(quiet) as progress:
            found = package.model_hierarchy(scenario, tolerance=tolerance, progress=progress)
        if as_json:
            print_json(found.as_dict())
        elif not quiet:
            print_columns(found.table())
            print_columns([("", ""), *found.assumptions.table(), ("", "")])
            echo(found.verdict)
        for picture in output or []:
            save_figure(found.figure(), picture)
            if not quiet:
                say(f"{picture} written")


for command in many.COMMANDS:
    app.command()(command)


@app.command()
def export(
    file: ScenarioFile,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="OUT.fmu", help="FMU to write.")],
    line: Annotated[str | None, typer.Option("--line", metavar="NAME", help="A line with its supports.")] = None,
    load: Annotated[str | None, typer.Option("--load", metavar="NAME", help="A vehicle without its line.")] = None,
    give: Annotated[
        str | None,
        typer.Option("--give", metavar="force|motion", help="Output [default: motion of a line, force of a load]."),
    ] = None,
    contacts: Annotated[int, typer.Option("--contacts", metavar="N", help="Number of contacts of the line.")] = 1,
    contact_stiffness: Annotated[
        float | None, typer.Option("--contact-stiffness", metavar="N/m", help="Stiffness of its springs at contacts.")
    ] = None,
    contact_damping: Annotated[
        float, typer.Option("--contact-damping", metavar="N*s/m", help="Damping parallel to these springs.")
    ] = 0.0,
    step: Annotated[
        float, typer.Option("--step", metavar="TIME", help="Step in s that a master is expected to take.")
    ] = 1e-3,
    no_code: NoCode = False,
    settings: Settings = None,
    quiet: Quiet = False,
) -> None:
    """Write a line or a vehicle as an FMU for co-simulation. A line includes its supports; FMI 2.0."""
    with reported():
        what = [name for name in (line, load) if name is not None]
        if len(what) != 1:
            fail("nothing to export is named; write --line NAME or --load NAME")
        if give not in (None, "force", "motion"):
            fail(f"--give {give}: write force or motion")
        scenario = load_scenario(file, settings, no_code)
        names = [*scenario.lines, *scenario.overhead_lines] if line is not None else [*scenario.loads]
        if what[0] not in names:
            kind, known = "line" if line is not None else "load", ", ".join(names) or "none"
            fail(f"{file} has no {kind} {what[0]}; choose from: {known}")
        import_module("ropewalk.cosim").export(
            scenario, what[0], output, causality=give, contacts=contacts, contact_stiffness=contact_stiffness,
            contact_damping=contact_damping, every=step,
        )  # fmt: skip
        if not quiet:
            say(f"{output} written")


@app.command("warm-up")
def warm_up(
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE]", help="Scenario file [default: kernels of most runs].")
    ] = None,
    workers: Workers = None,
    no_code: NoCode = False,
    settings: Settings = None,
    quiet: Quiet = False,
) -> None:
    """Compile ahead of the first run, for images and clusters. Kernels of one scenario, or of most runs."""
    with reported():
        warming = import_module("ropewalk.warming")
        groups = warming.COMMON if file is None else warming.alone(str(file), load_scenario(file, settings, no_code))
        with progress_of_many(quiet) as progress:
            found = warming.warm_up(groups, workers, progress)
        if not quiet:
            print_columns([*found.items(), ("kept in", str(warming.folder()))])


app.command()(elasticity)
app.command()(studio)
app.command()(validate)


@app.command()
def schema() -> None:
    """Print the JSON schema of scenario files, for editors."""
    with reported():
        print_json(import_module("ropewalk.scenario").json_schema())


app.command()(calc)

for command_info in app.registered_commands:
    command_info.cls = CommandWithOutput
