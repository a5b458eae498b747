"""A sample of the matrix for every day: each load and each row with each family once, and some of the structures."""

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
PART = 12
"""One in so many pairs of a load and a structure is in the sample; `make matrix` computes all."""


def pairs(case: Case) -> set[tuple[str, ...]]:
    """What a case is a sample of."""
    row, family = f"{case.table} / {case.row}", BY_NAME[case.structure].family
    if case.tool in SLOW:
        return {("tool", case.tool)}
    found = {
        ("load", case.load, "family", family), ("structure", case.structure), ("row", row, "family", family),
        ("row", row, "load", case.load),
    }  # fmt: skip
    pair = ("load", case.load, "structure", case.structure)
    return found | ({pair} if crc32(" on ".join((case.load, case.structure)).encode()) % PART == 0 else set())


def sample(every: Iterable[Case], verdicts: Verdicts) -> list[Case]:
    """Cases that run and between them show all pairs: greedily, those first that show most."""
    displayed = [(case, pairs(case)) for case in every if not verdicts[case.name].startswith(REFUSED)]
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
