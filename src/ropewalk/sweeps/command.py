"""The command `sweep`: what was written on the command line, as arguments, and the answer as text."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ropewalk.cli.console import DOUBTFUL, STOPPED_EARLY, echo, fail, print_json, say
from ropewalk.errors import Problem, ScenarioError
from ropewalk.interrupts import EXIT_CODE as INTERRUPTED
from ropewalk.model import Scenario
from ropewalk.sweeps.case import FINE
from ropewalk.sweeps.dataset import counted, effects_table, named, sweep_table
from ropewalk.sweeps.quantities import broken_name
from ropewalk.sweeps.sweeping import sweep
from ropewalk.sweeps.writing import check_outputs, write

if TYPE_CHECKING:
    import xarray as xr

LONGEST = 40  # rows of a table on a terminal
WIDEST = 60  # letters of doubts and reasons there


def sweep_from_text(
    scenario: Scenario,
    over: Sequence[str],
    derived: Sequence[str],
    progress: Callable[[str, float], None] | None,
    **more: Any,
) -> xr.Dataset:
    """Compute a sweep from text.

    Args:
        scenario: what the cases are changes of.
        over: KEY=VALUES.
        derived: KEY=EXPRESSION.
        progress: called with how many cases there are and the part of them that is done.
        more: as for `sweep`.

    Raises:
        ScenarioError, ResultError: as `sweep`.
    """
    problems = list[Problem]()
    keys = pairs(over, "--over", problems, remedy="write KEY=100:350:5 km/h")
    expressions = pairs(derived, "--derive", problems, remedy="write KEY=EXPRESSION")
    if problems:
        raise ScenarioError(problems)

    def report(done: int, total: int) -> None:
        if progress is not None:
            progress(f"{total} cases", done / total)

    origins = {"sweep.derived": "--derive"} | dict.fromkeys(keys, "--over") | dict.fromkeys(expressions, "--derive")
    if more.get("record") is not None:
        origins["sweep.record"] = "--record"
    try:
        return sweep(scenario, keys or None, derived=expressions or None, progress=report, **more)
    except ScenarioError as error:
        raise ScenarioError([replace(p, file=p.file or origins.get(p.key, "")) for p in error.problems]) from None


def tell(dataset: xr.Dataset, outputs: list[Path], as_json: bool, quiet: bool) -> None:
    """Write a sweep into all files that are asked for, and print its table.

    Raises:
        ResultError, ScenarioError: as `check_outputs` and `write`.
    """
    check_outputs(outputs)
    for file in outputs:
        write(dataset, file)
        if not quiet:
            say(f"{file} written")
    if as_json:
        print_json(plain(dataset))
    elif not quiet:
        echo(table_text(dataset))
        if (effects := effects_table(dataset)) is not None:
            echo("\n" + effects.to_string(index=False, float_format=lambda value: f"{value:.4g}", na_rep=""))


def finish(dataset: xr.Dataset, store: Path, outputs: list[Path], quiet: bool) -> None:
    """Say how a sweep has ended, and leave with the exit code that a run of this kind has."""
    counts = counted(dataset)
    total, fine = sum(counts.values()), sum(counts.get(name, 0) for name in FINE)
    if dataset.attrs["outcome"] == "interrupted":
        report = f"interrupted; {fine} of {total} cases are finished and kept in {store}: the same command continues it"
        partial = "".join(f"; {file} holds these" for file in outputs)
        fail(report + partial, INTERRUPTED)
    report = f"{total} cases: {', '.join(f'{number} {name}' for name, number in counts.items())}"
    if fine < total:
        fail(report, STOPPED_EARLY)
    if counts.get("doubtful"):
        fail(report, DOUBTFUL)
    if not quiet:
        say(report)


def pairs(
    texts: Sequence[str], origin: str, problems: list[Problem], form: str = "KEY=VALUE", remedy: str = ""
) -> dict[str, str]:
    """What is given for keys, as a block.

    Args:
        texts: KEY=VALUE.
        origin: the option.
        problems: gets what is wrong.
        form: what each is called.
        remedy: what to write instead (default: the form).
    """
    found = dict[str, str]()
    for text in texts:
        key, sign, value = (part.strip() for part in text.partition("="))
        if not (sign and key and value):
            problems.append(Problem("", f"this is not {form}", repr(text), remedy or f"write {form}", origin))
        elif key in found:
            problems.append(Problem(key, "is given twice", remedy="leave one of them out", file=origin))
        else:
            found[key] = value
    return found


def table_text(dataset: xr.Dataset) -> str:
    """The table for a terminal, the middle of a long one left out."""
    import pandas as pd

    frame = sweep_table(dataset).drop(columns=["seconds [s]"])
    frame["doubts"] = frame["doubts"].str.replace("\n", "; ")
    optional = {"doubts", "reason", *filter(None, map(broken_name, named(dataset, "quantities")))}
    frame = frame[[name for name in frame.columns if name not in optional or frame[name].any()]]
    for name in {"doubts", "reason"} & set(frame.columns):  # but all limits that are broken are named
        frame[name] = frame[name].map(lambda text: text if len(text) <= WIDEST else f"{text[: WIDEST - 3]}...")
    with pd.option_context("display.max_colwidth", None):
        displayed = frame.to_string(index=False, max_rows=LONGEST, float_format=lambda value: f"{value:.6g}", na_rep="")
    return str(displayed)


def _records(frame: Any) -> list[dict[str, Any]]:
    """The rows of a table; None for absent parts."""
    return [
        {name: None if isinstance(value, float) and value != value else value for name, value in row.items()}
        for row in frame.to_dict(orient="records")
    ]


def plain(dataset: xr.Dataset) -> dict[str, Any]:
    """The sweep as plain values that fit into JSON."""
    rows, effects = _records(sweep_table(dataset)), effects_table(dataset)
    more = {} if effects is None else {"effects": _records(effects)}
    about = {name: named(dataset, name) for name in ("parameters", "quantities")}
    return {"title": dataset.attrs["title"], "outcome": dataset.attrs["outcome"], **about, "cases": rows, **more}
