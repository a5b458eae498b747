"""The command `adequacy`: what was written on the command line, as arguments for the map."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from ropewalk.compare.adequacy import AdequacyMap, adequacy
from ropewalk.compare.axes import Axis
from ropewalk.errors import Problem, Refused, ScenarioError
from ropewalk.model import Scenario
from ropewalk.units import to_si


def adequacy_from_text(
    scenario: Scenario,
    axes: tuple[str, str],
    models: Sequence[str],
    quantity: str,
    tolerance: str,
    store: Path,
    workers: int | None,
    retry: bool,
    progress: Callable[[str, float], None] | None,
) -> AdequacyMap:
    """Compute a map from text.

    Args:
        scenario: what the points are changes of.
        axes: as `Axis.parse` reads them.
        models: the simpler models; the first is the one in question.
        quantity: in which they are compared.
        tolerance: a part, "0.05" or "5 %".
        store: file of the finished points.
        workers: processes; None: all cores.
        retry: compute points that have failed once more.
        progress: called with how many points there are and the part of them that is done.

    Raises:
        ScenarioError: an axis, a tolerance or a name is none.
    """
    problems, read = [], []
    for key, text in zip(("--x", "--y"), axes, strict=True):
        try:
            read.append(Axis.parse(text))
        except ScenarioError as error:
            problems += [Problem(p.key, p.wrong, p.given, p.remedy, key) for p in error.problems]
    allowed = 0.0
    try:
        allowed = to_si(tolerance, "dimensionless")
    except Refused as error:
        problems.append(Problem("", error.wrong, repr(tolerance), "write for example 0.05 or 5 %", "--tolerance"))
    if problems:
        raise ScenarioError(problems)

    def report(done: int, total: int) -> None:
        if progress is not None:
            progress(f"{total} points", done / total)

    return adequacy(
        scenario, *read, model=models[0], quantity=quantity, tolerance=allowed, store=store, workers=workers,
        progress=report, retry=retry,
    )  # fmt: skip
