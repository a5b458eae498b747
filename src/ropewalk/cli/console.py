"""What commands share: reading, printing, pictures, progress, and errors as messages and exit codes.

Results go to stdout, messages and progress to stderr. Exit codes: 0 fine, 1 a fault of ropewalk itself, 2 bad
input, 3 a run that stopped early, 4 a run that must not be trusted, 130 interrupted.
"""

from __future__ import annotations

import json
import os
import re
import sys
import time as clock
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from typer import CallbackParam

from ropewalk.errors import printable_lines
from ropewalk.interrupts import EXIT_CODE as INTERRUPTED
from ropewalk.interrupts import is_interrupted, note_kept
from ropewalk.permission import code_restored, forbid_code, is_code_forbidden

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario
    from ropewalk.results.display_units import DisplayUnits
    from ropewalk.results.frame import RunInfo
    from ropewalk.results.running import Run

FAULT, BAD_INPUT, STOPPED_EARLY, DOUBTFUL = 1, 2, 3, 4
FIGURE_SUFFIXES = (".png", ".svg", ".pdf")
FILM_SUFFIXES = (".gif", ".mp4")
REPORT_SUFFIX = ".html"
EXPORT_SUFFIX = ".pvd"
TABLE_SUFFIXES = (".csv", ".xlsx", ".parquet")
_CONTROL = re.compile("[\x7f-\x9f]")  # signs that control a terminal and stand in JSON as they are
Progress = Callable[[float], None]
Report = Callable[..., None]  # a task, the part that is done, and maybe what it is at
_READ: ContextVar[tuple[Path, tuple[str, ...]] | None] = ContextVar("read", default=None)  # file and settings
# Part of the whole from which on what is done tells what is left: before, kernels are still loaded.
_KNOWN = 0.02
CHECKED = 512  # cases of a sweep that `check` makes: each takes a millisecond or more
PATIENCE = 6.0  # s of computing, after which `check` gives up to find how a run begins
_BETWEEN_LINES = 30.0  # s between lines that tell how far what takes long has come
TRACEBACK: ContextVar[bool] = ContextVar("traceback", default=False)


def load_scenario(file: Path, settings: list[str] | None, no_code: bool = False) -> Scenario:
    from ropewalk.scenario import load

    if no_code:
        forbid_code()
    scenario = load(file, settings or ())
    _READ.set((file, tuple(settings or ())))  # read well: what is found later can be shown its place
    if is_code_forbidden():
        from ropewalk.external.models import refuse_code

        refuse_code(scenario.loads)
    return scenario


def open_unless_interrupted(target: Path, path: Path) -> xr.Dataset:
    """Open a result that has just been written; after an interrupt it is not read back, and the command ends.

    A summary may import xarray, which takes a second, or read a file of gigabytes.

    Args:
        target: result file as the user names it.
        path: the same, complete.
    """
    from ropewalk.results.arrays import open_arrays

    if is_interrupted():
        fail(
            f"interrupted; the computed part is kept in {target}. `ropewalk show {target}` prints its summary.",
            INTERRUPTED,
        )
    return open_arrays(path)


def finish(found: dict[str, Any], target: Path) -> None:
    """Leave with the exit code of the outcome, and say what there is and what can be done."""
    outcome = found["outcome"]
    if outcome == "completed":
        return
    advice = f"\n{found['advice']}" if found["advice"] else ""
    if outcome == "interrupted":
        fail(f"interrupted; the computed part is kept in {target}{advice}", INTERRUPTED)
    if outcome == "doubtful":
        report = "\n".join(found["doubts"])
        fail(f"the run finished, but its results are unreliable; they are kept in {target}\n{report}", DOUBTFUL)
    fail(f"the run stopped early: {outcome}; the computed part is kept in {target}{advice}", STOPPED_EARLY)


def display_units(text: str) -> DisplayUnits:
    """Read a choice of units in which results are shown."""
    from ropewalk.errors import Refused
    from ropewalk.results.display_units import DisplayUnits

    try:
        return DisplayUnits.read(text)
    except Refused as problem:
        fail(f"--units {text}: {problem}")
        raise


def print_summary(found: dict[str, Any], as_json: bool, quiet: bool, units: DisplayUnits) -> None:
    if as_json:
        print_json(found)
    elif not quiet:
        from ropewalk.results import text

        echo(text(found, units))


def print_json(value: Any) -> None:
    typer.echo(_CONTROL.sub(_escaped, json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False)))


def print_columns(rows: list[tuple[str, ...]]) -> None:
    """A table: what on the left, and columns of values, which stand to the right where there are several."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    for what, *values in rows:
        cells = [f"{value:>{width}}" for value, width in zip(values, widths[1:], strict=True)]
        echo("  ".join([f"{what:{widths[0]}}", *(cells if len(cells) > 1 else values)]).rstrip())


def check_pictures(
    outputs: Sequence[Path] | None,
    known: tuple[str, ...] = (*FIGURE_SUFFIXES, *FILM_SUFFIXES, REPORT_SUFFIX, EXPORT_SUFFIX, *TABLE_SUFFIXES),
) -> None:
    for output in outputs or ():
        if output.suffix.lower() not in known:
            fail(f"{output}: unknown kind of picture, report or table; the name must end in {', '.join(known)}")
        if not output.parent.is_dir():
            fail(f"{output}: the folder {output.parent} does not exist; create it or choose another place")


def write_text(text: str, output: Path) -> None:
    try:
        output.write_text(text, encoding="utf-8")
    except OSError as problem:
        fail(f"{output}: cannot be written ({problem.strerror or problem})")


def save_figure(drawn: Any, output: Path) -> None:
    try:
        drawn.savefig(output)
    except OSError as problem:
        fail(f"{output}: cannot be written ({problem.strerror or problem})")


def show_in(
    dataset: xr.Dataset,
    output: Path,
    quiet: bool,
    panels: Sequence[str] | None = None,
    size: str | None = None,
    units: DisplayUnits | None = None,
    every: str | None = None,
    at: Sequence[str] | None = None,
) -> list[Path]:
    """Write a result as what the name of the file asks for; gives the files written."""
    from ropewalk import results
    from ropewalk.errors import Refused

    kind = output.suffix.lower()
    try:
        if kind in FILM_SUFFIXES:
            with progress_bar("filming", quiet) as progress:
                results.film(dataset, output, size=size, units=units, progress=progress)
        elif kind == EXPORT_SUFFIX:
            with progress_bar("exporting", quiet) as progress:
                results.export(dataset, output, progress=progress)
        elif kind in TABLE_SUFFIXES and panels is not None:
            from ropewalk.results.table_export import save_tables

            return save_tables(results.figure_data(dataset, panels=panels, units=units), output)
        elif kind in TABLE_SUFFIXES:
            unit = "s" if "time" in dataset.dims else "m"
            thinned = None if every is None else quantity_of(every, unit)
            chosen = None if at is None else [quantity_of(text, unit) for text in at]
            return results.write_tables(dataset, output, every=thinned, at=chosen, units=units)
        elif kind == REPORT_SUFFIX:
            write_text(results.html_report(dataset, units=units), output)
        else:
            save_figure(results.figure(dataset, panels=panels, size=size, units=units), output)
    except Refused as problem:  # of the size, which is all that is still to be read
        fail(f"--size {size}: {problem}")
    return [output]


def quantity_of(text: str, unit: str) -> float:
    """A quantity in SI units, from a number or a text with a unit."""
    from ropewalk.errors import Refused
    from ropewalk.units import to_si

    try:
        return to_si(text, unit)
    except Refused as problem:
        fail(f"{text}: {problem}")
        raise


def say(message: str) -> None:
    echo(message, err=True)


def echo(text: str, *, err: bool = False) -> None:
    """Print text, in which signs that control a terminal are escapes: titles and messages of files may hold any."""
    typer.echo(printable_lines(text), err=err)


def _escaped(sign: re.Match[str]) -> str:
    return f"\\u{ord(sign[0]):04x}"


def fail(message: str, code: int = BAD_INPUT) -> None:
    say(message)
    raise typer.Exit(code)


@contextmanager
def progress_bar(label: str, quiet: bool) -> Iterator[Progress | None]:
    """A bar on stderr if that is a terminal; gives the function that moves it."""
    with progress_of_many(quiet) as report:
        yield report and partial(report, label)


@contextmanager
def progress_of_run(scenario: Scenario, quiet: bool) -> Iterator[Progress | None]:
    """A bar for a run, and before it what the compiler is at, if it is at something."""
    from ropewalk.simulate import must_compile

    if not quiet and (how_long := must_compile(scenario)):
        say(f"compiling the kernels for this type of structure, once ({how_long} on a quiet machine)")
    with progress_of_many(quiet) as report:
        if report is None:
            yield None
            return
        with _compiling(report):
            yield partial(report, "running")


@contextmanager
def _compiling(report: Report | None) -> Iterator[None]:
    """Let the compiler tell how far it is, where anybody is told anything."""
    from ropewalk.mechanics.compiled import compiling

    compiling.progress = None if report is None else partial(report, "compiling")
    try:
        yield
    finally:
        compiling.progress = None


@contextmanager
def progress_of_many(quiet: bool) -> Iterator[Report | None]:
    """A bar for each of several tasks, as they come, on stderr if that is a terminal, and lines if not."""
    if quiet:
        yield None
        return
    if not sys.stderr.isatty():
        yield _in_lines()
        return
    from rich.console import Console
    from rich.progress import Progress as Bar

    with Bar(console=Console(stderr=True), transient=True) as bar:
        tasks: dict[str, Any] = {}

        def report(label: str, done: float, what: str = "") -> None:
            if label not in tasks:
                tasks[label] = bar.add_task(label, total=1.0)
            bar.update(tasks[label], completed=done, description=f"{label} {what}".rstrip())

        yield report


def _in_lines() -> Report:
    """Progress of what takes long as lines: the first after half a minute, then one for each tenth, and none sooner.

    What is near its end for minutes says so once more.
    """
    lines: dict[str, tuple[float, float]] = {}
    begun: dict[str, tuple[float, float]] = {}

    def report(label: str, done: float, what: str = "") -> None:
        now = clock.monotonic()
        last, least = lines.setdefault(label, (now, 0.0))
        first, before = begun.setdefault(label, (now, done))
        if now - last >= (_BETWEEN_LINES if done >= least else 4.0 * _BETWEEN_LINES):
            from ropewalk.effort import about  # what runs half a minute has read it

            left = (now - first) * (1.0 - done) / max(done - before, 1e-9)
            known = before + _KNOWN <= done < 1.0
            say(f"{label} {what}".rstrip() + f": {done:.0%}" + (f", {about(left)} left" if known else ""))
            lines[label] = now, done + 0.1

    return report


def foreseen(file: Path, scenario: Scenario) -> tuple[str, list[str]]:
    """What a run will be, in words, and warnings of its start; fails if it would not start."""
    from ropewalk.cli.deadline import Overdue, deadline
    from ropewalk.effort import foreseen as words
    from ropewalk.errors import RopewalkError

    try:
        with progress_of_many(quiet=False) as report, _compiling(report), deadline(PATIENCE):
            return words(scenario)
    except Overdue:
        return f"the start of the run was not evaluated within {PATIENCE:g} s of computing time; no estimate", []
    except RopewalkError as problem:
        fail(f"{file}: the file has no mistake, but its run would not start: {problem}", STOPPED_EARLY)
        raise


def foretell(scenario: Scenario) -> Callable[[Run, RunInfo], None]:
    """Print the warnings of a run that begins, and its estimated time if that is long."""

    def begun(run: Run, run_info: RunInfo) -> None:
        from ropewalk.effort import effort_of

        for remark in run_info.warnings:
            say(f"warning: {remark}")
        effort = effort_of(scenario, run, run_info)
        if effort is not None and (effort.seconds or 0.0) >= _BETWEEN_LINES:
            say(str(effort))

    return begun


def now_called(new: str) -> Callable[[CallbackParam, Any], Any]:
    """A callback of an option that has another name now: it still works for one release, and says so."""

    def used(option: CallbackParam, value: Any) -> Any:
        if value:
            say(f"{option.opts[0]} was renamed to {new}; the old name will be removed in the next release")
        return value

    return used


@contextmanager
def reported(target: Path | None = None) -> Iterator[None]:
    """Turn exceptions into messages and exit codes; `target` is the file that a run may have begun."""
    before = _stamp(target)
    _READ.set(None)  # of a command before, in the same process

    def kept() -> str:
        return f"; the computed part is kept in {target}" if _stamp(target) != before else ""

    note_kept(kept)
    try:
        with code_restored():
            yield
    except typer.Exit:
        raise
    except KeyboardInterrupt as stop:
        fail(str(stop) or f"interrupted{kept()}", INTERRUPTED)
    except BrokenPipeError:  # the reader of stdout has gone, as in `ropewalk schema | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise typer.Exit(FAULT) from None
    except Exception as problem:
        if TRACEBACK.get():
            raise
        _explain(problem, target if _stamp(target) != before else None)


def _stamp(target: Path | None) -> tuple[int, int] | None:
    """What changes when a file is written."""
    if target is None:
        return None
    try:
        status = target.stat()
    except OSError:
        return None
    return status.st_ino, status.st_mtime_ns


def _explain(problem: Exception, partial: Path | None) -> None:
    from ropewalk.errors import RopewalkError, ScenarioError
    from ropewalk.results import ResultError, WriteError

    if isinstance(problem, ScenarioError) and (read := _READ.get()) is not None:
        from ropewalk.scenario.loading import placed

        problem = placed(problem, *read)
    if not isinstance(problem, RopewalkError):
        if is_interrupted():  # what libraries make of it
            fail("interrupted" + (f"; the computed part is kept in {partial}" if partial else ""), INTERRUPTED)
        kind = type(problem).__name__
        say(f"ropewalk failed ({kind}: {problem}); this is a fault of ropewalk, not of your input")
        fail("please report it with the output of `ropewalk --traceback ...` for the same command", FAULT)
    say(str(problem))
    if isinstance(problem, ScenarioError) or (isinstance(problem, ResultError) and not isinstance(problem, WriteError)):
        raise typer.Exit(BAD_INPUT)
    if partial is not None:
        say(f"the computed part is kept in {partial}")
    raise typer.Exit(STOPPED_EARLY)
