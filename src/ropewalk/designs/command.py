"""The commands `design` and `fit`: what was written, as arguments, and the answers as text and files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ropewalk.cli.console import DOUBTFUL, STOPPED_EARLY, fail, print_columns, print_json, say
from ropewalk.designs.designing import design
from ropewalk.designs.fitting import Fit, fit
from ropewalk.designs.result import Design
from ropewalk.errors import Problem, ScenarioError
from ropewalk.interrupts import EXIT_CODE as INTERRUPTED
from ropewalk.model import Scenario
from ropewalk.results import ResultError
from ropewalk.results.table_export import SUFFIXES as TABLES
from ropewalk.results.table_export import check_tables
from ropewalk.scenario.editing import edited
from ropewalk.scenario.source import read_text
from ropewalk.sweeps.command import pairs
from ropewalk.sweeps.writing import FIGURES, write

SCENARIOS = (".yaml", ".yml")
SUFFIXES = (*SCENARIOS, ".nc", *TABLES, *FIGURES)


def check_outputs(outputs: Sequence[Path], source: Path, kinds: Sequence[str] = SUFFIXES) -> None:
    """Refuse files that cannot be written, before anything is computed.

    Raises:
        ResultError: another suffix, no such folder, the scenario itself, or a package that is missing.
    """
    for file in outputs:
        kind = file.suffix.lower()
        if kind not in kinds:
            raise ResultError(f"{file}: this is written as {', '.join(kinds)}")
        if not file.parent.is_dir():
            raise ResultError(f"{file}: the folder {file.parent} does not exist; create it or choose another place")
        if kind in SCENARIOS and file.exists() and file.samefile(source):
            raise ResultError(f"{file}: is the scenario that is varied; choose another name for the best one")
        if kind in TABLES:
            check_tables(file)


def reporting(progress: Callable[[str, float], None] | None) -> Callable[[int], None] | None:
    """A bar of runs whose number nobody knows: it comes ever closer to its end."""
    return None if progress is None else lambda count: progress(f"run {count}", 1.0 - 1.0 / (1.0 + 0.05 * count))


def design_from_text(
    scenario: Scenario,
    vary: Sequence[str],
    derived: Sequence[str],
    progress: Callable[[str, float], None] | None,
    **more: Any,
) -> Design:
    """Find a design from text.

    Args:
        scenario: what the designs are changes of.
        vary: KEY=LOW:HIGH.
        derived: KEY=EXPRESSION.
        progress: called with a label and the part that is done.
        more: as for `design`.

    Raises:
        ScenarioError, ResultError: as `design`.
    """
    problems = list[Problem]()
    bounds = pairs(vary, "--vary", problems, "KEY=LOW:HIGH")
    expressions = pairs(derived, "--derive", problems, "KEY=EXPRESSION")
    if problems:
        raise ScenarioError(problems)
    origins = {"vary": "--vary", "subject_to": "--subject-to"} | dict.fromkeys(bounds, "--vary")
    origins |= dict.fromkeys(expressions, "--derive")
    try:
        return design(scenario, bounds, derived=expressions, progress=reporting(progress), **more)
    except ScenarioError as error:
        raise ScenarioError([replace(p, file=p.file or origins.get(p.key, "")) for p in error.problems]) from None


def tell_design(found: Design, file: Path, settings: Sequence[str], outputs: Sequence[Path]) -> list[Path]:
    """Write a design into the files that are asked for: the best scenario, the course, the figure.

    Args:
        found: the design.
        file: of the scenario.
        settings: that changed it before.
        outputs: files.

    Returns:
        The files that were written: without a design there is no best scenario.

    Raises:
        ResultError: one cannot be written.
    """
    done = []
    for output in outputs:
        kind = output.suffix.lower()
        if kind in SCENARIOS:
            if found.best is None:
                continue
            write_scenario(output, file, [*settings, *found.best.settings])
        elif kind in FIGURES:
            found.figure().savefig(output)
        else:
            write(found.course, output)
        done.append(output)
    return done


def write_scenario(output: Path, file: Path, settings: Sequence[str]) -> None:
    """Write a scenario file with other values, its comments kept.

    Raises:
        ResultError: it cannot be written.
    """
    try:
        output.write_text(edited(read_text(file), str(file), settings), encoding="utf-8", newline="\n")
    except OSError as problem:
        raise ResultError(f"{output}: cannot be written ({problem.strerror or problem})") from None


def print_design(found: Design, as_json: bool, quiet: bool) -> None:
    """What an engineer asks first."""
    if as_json:
        print_json(found.as_dict())
        return
    if quiet:
        return
    rows: list[tuple[str, ...]] = [(key, value) for key, value in found.values.items()]
    if found.best is not None:
        goal = "smallest" if found.task.sign > 0.0 else "largest"
        rows.append((f"{goal} {found.task.objective}", f"{found.value:.6g} {found.unit}".rstrip()))
        for name in found.task.runs.record:
            if name != found.task.objective:
                value, unit = found.best.outcome.values[name]
                rows.append((name, f"{value:.6g} {unit}".rstrip() if value is not None else "none"))
    rows += [("reached", text) for text in found.limits_reached]
    if found.neighbours:
        count = {verdict: sum(n.verdict == verdict for n in found.neighbours) for verdict in
                 dict.fromkeys(n.verdict for n in found.neighbours)}  # fmt: skip
        rows.append(("around it", ", ".join(f"{number} {verdict}" for verdict, number in count.items())))
    rows.append(("runs", str(len(found.task.runs.course))))
    print_columns(rows)


def finish_design(found: Design, store: Path, quiet: bool) -> None:
    """Say how a search has ended, and leave with the exit code that a run of this kind has."""
    if found.outcome == "interrupted":
        fail(f"interrupted; all runs are kept in {store}: the same command continues it", INTERRUPTED)
    if found.best is None:
        near = found.task.nearest()
        reason = "" if near is not None else next((e.outcome.reason for e in found.task.runs.course), "")
        if near is not None:
            _, excess = found.task.of(near)
            worst = found.task.limits[int(excess.argmax())]
            reason = f"closest to them is {', '.join(near.settings)}, beyond {worst.text} by {excess.max():.3g} of it"
        fail(f"{found.outcome}: {reason}", STOPPED_EARLY)
    if found.doubts or found.outcome != "completed":
        fail(f"{found.outcome}: {'; '.join(found.doubts)}", DOUBTFUL)
    if not quiet:
        say(f"the best of {len(found.task.runs.course)} runs")


def fit_from_text(scenario: Scenario, vary: Sequence[str], data: Path) -> Fit:
    """Fit from text.

    Args:
        scenario: the model.
        vary: KEY=LOW:HIGH.
        data: CSV file.

    Raises:
        ScenarioError, ResultError, RopewalkError: as `fit`.
    """
    problems = list[Problem]()
    bounds = pairs(vary, "--vary", problems, "KEY=LOW:HIGH")
    if problems:
        raise ScenarioError(problems)
    origins = {"vary": "--vary", "data": "--data"} | dict.fromkeys(bounds, "--vary")
    try:
        return fit(scenario, bounds, data)
    except ScenarioError as error:
        raise ScenarioError([replace(p, file=p.file or origins.get(p.key, "")) for p in error.problems]) from None


def print_fit(found: Fit, as_json: bool, quiet: bool) -> None:
    """The values with their intervals; at a bound it ends as a doubtful run does."""
    if as_json:
        print_json(found.as_dict())
    elif not quiet:
        rows: list[tuple[str, ...]] = []
        for key, (value, unit) in found.numbers.items():
            low, high = found.intervals[key]
            between = f"95 %: {low:.6g} to {high:.6g} {unit}" if low == low else "the data do not determine an interval"
            rows.append((key, f"{value:.6g} {unit}".rstrip(), between.rstrip()))
        rows.append(("left", f"{found.residual:.4g}", "root of the mean square"))
        print_columns(rows)
    if found.at_bounds:
        fail(f"{', '.join(found.at_bounds)}: at a bound; the best value may lie beyond it", DOUBTFUL)
