"""The command `calc`: quantities as they are written on the command line, and the answer as text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ropewalk.calc import CALCULATORS, Answer
from ropewalk.calc.calculator import Calculator, listed
from ropewalk.errors import Problem, ScenarioError, did_you_mean
from ropewalk.results.display_units import DisplayUnits

Rows = list[tuple[str, ...]]


def overview() -> Rows:
    """Rows of all calculators."""
    return [(f"ropewalk calc {name}", calculator.about) for name, calculator in CALCULATORS.items()]


def quantities_of(name: str) -> str:
    """The quantities of a calculator, free ones first, as text."""
    rows = list(listed(_calculator(name)))
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    lines = ["  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    return "\n".join([_calculator(name).about, "", *lines])


def calculated(name: str, given: Sequence[str]) -> Answer:
    """Calculate from texts such as `span=63m`.

    Raises:
        ScenarioError: a text is no quantity with its value, or as of `Calculator`.
    """
    calculator = _calculator(name)
    values: dict[str, Any] = {}
    problems = []
    for text in given:
        key, sign, value = (part.strip() for part in text.partition("="))
        if not sign or not key or not value:
            problems.append(
                Problem(text, "no quantity with its value", remedy="write for example span=63m, or sag=? to ask")
            )
        elif key in values:
            problems.append(Problem(key, "given twice", remedy="leave one out"))
        values[key] = None if value == "?" else value
    if problems:
        raise ScenarioError(problems)
    return calculator(**values)


def _calculator(name: str) -> Calculator:
    if name in CALCULATORS:
        return CALCULATORS[name]
    advice = did_you_mean(name, CALCULATORS, otherwise=f"there are {', '.join(CALCULATORS)}")
    raise ScenarioError([Problem("calc", f"there is no calculator {name}", remedy=advice)])


def text(answer: Answer, units: DisplayUnits) -> str:
    """The table of an answer with its messages, as text."""
    cells = answer.table(units)
    widths = [max(len(row[k]) for row in cells) for k in range(2)]
    lines = [f"{what:{widths[0]}}  {value:>{widths[1]}}  {about}".rstrip() for what, value, about in cells]
    return "\n".join([*lines, "", "* given", *answer.messages])
