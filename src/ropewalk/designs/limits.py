"""What a design is to be: a quantity that is as small or as large as may be, and limits of others."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from ropewalk.errors import Problem, Refused, ScenarioError
from ropewalk.sweeps.parameters import quantity
from ropewalk.units import to_si

_LIMIT = re.compile(r"\s*(.+?)\s*(<=|>=|<|>)\s*(.+?)\s*")
_FORM = 'write QUANTITY < VALUE or QUANTITY > VALUE, for example "max strain < 2 %"'


@dataclass(frozen=True)
class Limit:
    """A quantity that must not be above or below a value.

    Args:
        text: as it was written.
        name: of the quantity, as `record` has it.
        sign: 1 if the value is the most, -1 if it is the least.
        given: the value, with its unit.
    """

    text: str
    name: str
    sign: float
    given: str

    @classmethod
    def read(cls, text: str) -> Limit:
        """Read a limit as the command line has it.

        Raises:
            ScenarioError: it is none.
        """
        found = _LIMIT.fullmatch(text)
        if found is None:
            raise ScenarioError([Problem("subject_to", "this is no limit", repr(text), _FORM)])
        number, unit = quantity("subject_to", found[3])
        return cls(text, found[1], 1.0 if found[2].startswith("<") else -1.0, f"{number} {unit}".strip())

    def value(self, unit: str) -> float:
        """The value in the SI unit of the quantity.

        Raises:
            ScenarioError: it has another unit.
        """
        try:
            return to_si(self.given, "dimensionless" if unit in ("", "1") else unit)
        except Refused as error:
            raise ScenarioError([Problem("subject_to", error.wrong, repr(self.text), error.remedy)]) from None

    def excess(self, value: float, unit: str) -> float:
        """By how much a value of the quantity is beyond the limit, as a part of it; negative: it keeps it."""
        limit = self.value(unit)
        return self.sign * (value - limit) / (abs(limit) or 1.0)


def limits_of(texts: Iterable[str]) -> tuple[Limit, ...]:
    """Read all limits, or tell all their mistakes.

    Raises:
        ScenarioError: with every mistake found.
    """
    problems, found = list[Problem](), []
    for text in texts:
        try:
            found.append(Limit.read(text))
        except ScenarioError as error:
            problems += error.problems
    if problems:
        raise ScenarioError(problems)
    return tuple(found)
