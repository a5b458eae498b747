"""All chosen rows, computed in processes of their own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from fnmatch import fnmatchcase

from ropewalk.errors import Problem, ScenarioError
from ropewalk.sweeps.pool import DIED, cores, each
from ropewalk.validation.judging import judged
from ropewalk.validation.known_case import KnownCase
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.registry import CASES
from ropewalk.validation.row_result import FAILED, RowResult

Task = tuple[str, tuple[str, ...], bool]
"""A case and its rows, by their names, and whether with their faults."""


def chosen(only: Sequence[str] = (), quick: bool = False) -> list[tuple[KnownCase, KnownNumber]]:
    """Rows whose names, CASE.ROW, one of the patterns fits (* and ? as in names of files), or all.

    Args:
        only: patterns.
        quick: only those of cases that take a second at most.

    Raises:
        ScenarioError: a pattern fits none.
    """
    every = [(case, row) for case in CASES.values() for row in case.rows]
    for pattern in only:
        if not any(fits(pattern, case, row) for case, row in every):
            remedy = "ropewalk validate --list  shows them all"
            raise ScenarioError([Problem(f"--only {pattern}", "no row is called so", remedy=remedy)])
    return [
        (case, row) for case, row in every
        if (not only or any(fits(pattern, case, row) for pattern in only)) and (case.quick or not quick)
    ]  # fmt: skip


def fits(pattern: str, case: KnownCase, row: KnownNumber) -> bool:
    """Whether a pattern means a row, by the name of its case or its own."""
    return fnmatchcase(case.id, pattern) or fnmatchcase(f"{case.id}.{row.name}", pattern)


def validate(
    only: Sequence[str] = (),
    *,
    quick: bool = False,
    faults: bool = False,
    workers: int | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> list[RowResult]:
    """Compute what is known from elsewhere, and compare.

    Args:
        only: patterns of rows, CASE.ROW or CASE; empty: all.
        quick: only those that take a second at most.
        faults: each with the fault that must make it differ.
        workers: processes; None: one for each core; 0: in this one.
        progress: called with a label and the part that is done.

    Returns:
        The verdicts, in the order of the registry.

    Raises:
        ScenarioError: a pattern fits no row.
    """
    wanted = chosen(only, quick)
    names: dict[str, tuple[str, ...]] = {}
    for case, row in wanted:
        names[case.id] = (*names.get(case.id, ()), row.name)
    tasks: list[Task] = [(case, rows, faults) for case, rows in names.items()]
    ahead = sorted(tasks, key=lambda task: CASES[task[0]].quick)  # long ones first: none is left to the end
    processes = cores() if workers is None else workers
    found = dict[str, RowResult]()
    nothing = list[RowResult]()
    with closing(each(ahead, _task, min(processes, len(ahead)), nothing)) as answers:
        for done, (task, findings) in enumerate(answers, start=1):
            lost = [RowResult(f"{task[0]}.{name}", FAILED, reason=DIED) for name in task[1]]
            found |= {finding.id: finding for finding in findings or lost}
            if progress is not None:
                progress("validating", done / len(ahead))
    return [found[f"{case.id}.{row.name}"] for case, row in wanted]


def _task(task: Task) -> list[RowResult]:
    id, names, faults = task
    case = CASES[id]
    if not faults:
        return judged(case, names)
    return [one for fault, rows in case.by_fault(names).items() for one in judged(case, rows, fault)]
