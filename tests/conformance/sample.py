"""A sample of the matrix for every day: each load, row, structure and tool, and a part of their pairs."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from zlib import crc32

from .cases import Case, cases
from .judging import REFUSED
from .structures import BY_NAME
from .verdicts import Verdicts, read

SLOW = ("adequacy", "compare", "show")
"""Tools that take seconds: once each."""
HEAVY = ("loads / one / inextensible / train",)
"""Cases that take half a minute."""
PART = 16
"""One in so many pairs is in the sample; `make matrix` computes all."""


def pairs(case: Case) -> set[tuple[str, ...]]:
    """What a case is a sample of."""
    row, family = f"{case.table} / {case.row}", BY_NAME[case.structure].family
    if case.tool in SLOW:
        return {("tool", case.tool)}
    each = {("load", case.load), ("structure", case.structure), ("row", row), ("tool", case.tool)}
    both = {
        ("load", case.load, "family", family), ("row", row, "family", family), ("row", row, "load", case.load),
        ("load", case.load, "structure", case.structure),
    }  # fmt: skip
    return each | {pair for pair in both if crc32(" / ".join(pair).encode()) % PART == 0}


def sample(every: Iterable[Case], verdicts: Verdicts) -> list[Case]:
    """Cases that run and between them show all pairs: greedily, those first that show most."""
    running = [case for case in every if case.name not in HEAVY and not verdicts[case.name].startswith(REFUSED)]
    displayed = [(case, pairs(case)) for case in running]
    missing = set[tuple[str, ...]]().union(*(found for _, found in displayed))
    chosen = []
    while missing:
        best, found = max(displayed, key=lambda each: len(each[1] & missing))
        chosen.append(best)
        missing -= found
        displayed = [each for each in displayed if not missing.isdisjoint(each[1])]
    return chosen


@cache
def chosen() -> tuple[tuple[Case, str], ...]:
    """The sample with its verdicts."""
    verdicts = read()
    return tuple((case, verdicts[case.name]) for case in sample(cases(), verdicts))
