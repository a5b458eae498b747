"""What can go wrong, as values that say where, what was given and what to do."""

from __future__ import annotations

import difflib
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

SEVERAL = 3
"""So many problems of one cause are told as one."""
_NAMED = 10  # names that a problem of many lists
_NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")


class RopewalkError(Exception):
    """Base of every error that ropewalk raises on purpose."""


class Refused(ValueError):
    """A value not accepted: what is wrong, what to do, what was given (None: show the value itself)."""

    def __init__(self, wrong: str, remedy: str = "", given: str | None = None) -> None:
        self.wrong = wrong
        self.remedy = remedy
        self.given = given
        super().__init__(f"{wrong}; {remedy}" if remedy else wrong)

    def __reduce__(self) -> tuple[type[Refused], tuple[str, str, str | None]]:
        return Refused, (self.wrong, self.remedy, self.given)


@dataclass(frozen=True)
class Problem:
    """One thing wrong with an input: where it stands, what is wrong, what was given, what to do."""

    key: str
    wrong: str
    given: str = ""
    remedy: str = ""
    file: str = ""
    line: int | None = None

    def __str__(self) -> str:
        place = self.file if self.line is None else f"{self.file}:{self.line}"
        key = "" if place.endswith(f" {self.key}") else self.key  # "--set a.b" has named the key already
        text = ": ".join(part for part in (place, key, self.wrong) if part)
        if self.given:
            text += f", given {self.given}"
        if self.remedy:
            text += f"; {self.remedy}"
        return printable(text)


class ScenarioError(RopewalkError, ValueError):
    """A scenario, or a part of one, that cannot be: with every problem found in it."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(_once_each(condensed(self.problems))))

    def __reduce__(self) -> tuple[type[ScenarioError], tuple[tuple[Problem, ...]]]:
        return ScenarioError, (self.problems,)


def condensed(problems: Sequence[Problem]) -> list[Problem]:
    """Return problems with those of one cause in many rows of a file, or entries of a list, as one.

    The first of them stays, and its remedy gets the number of rows and the last one. Rows have one cause where they
    differ in their values, in numbers within the text, and in the indices of their keys only.

    Args:
        problems: in the order of the file.
    """

    def cause(problem: Problem) -> tuple[str, ...]:
        parts = problem.key.split(".")  # of which the second is a name, even if it is a number
        key = ".".join("#" if part.isdigit() and k > 1 else part for k, part in enumerate(parts))
        return problem.file, key, *(_NUMBER.sub("#", text) for text in (problem.wrong, problem.remedy))

    groups: dict[tuple[str, ...], list[Problem]] = {}
    for problem in problems:
        groups.setdefault(cause(problem), []).append(problem)
    found: list[Problem] = []
    for group in groups.values():
        first, last = group[0], group[-1]
        if len(group) < SEVERAL:
            found += group
            continue
        place = last.key if last.line in (None, first.line) else f"line {last.line}"
        count = f"{len(group)} entries have this problem, the last is {place}"
        found.append(replace(first, remedy="; ".join(filter(None, (first.remedy, count)))))
    return found if len(found) < len(problems) else list(problems)


def _once_each(problems: Sequence[Problem]) -> Iterator[str]:
    """Problems as lines; several that differ by one name in their keys only, as of the wheels of a train, are one."""

    def shapes(problem: Problem) -> list[tuple[object, ...]]:
        parts = problem.key.split(".")
        said = problem.file, problem.wrong, problem.given, problem.remedy
        return [(k, *said, *parts[:k], "", *parts[k + 1 :]) for k in range(1, len(parts) - 1)]

    count = Counter(shape for problem in problems for shape in shapes(problem))
    groups: dict[object, list[Problem]] = {}
    for problem in problems:
        most = max(shapes(problem), key=count.__getitem__, default=None)
        groups.setdefault(problem if most is None or count[most] < SEVERAL else most, []).append(problem)
    for shape, (first, *others) in groups.items():
        text = str(first)
        if others and isinstance(shape, tuple):
            names = [problem.key.split(".")[shape[0]] for problem in others]
            lines = [str(problem.line) for problem in others if problem.line is not None]
            names = [*names[:_NAMED], f"{len(names) - _NAMED} more"] if len(names) > _NAMED + 1 else names
            text += f" (also {', '.join(names)}{f': lines {lines[0]} to {lines[-1]}' if lines else ''})"
        yield text


class EquilibriumError(RopewalkError):
    """No rest shape exists, or it is not unique; the message says why and what to change."""


def printable(text: str) -> str:
    """Write control characters and lone surrogates as escapes, so that any terminal can show the text."""
    return "".join(sign if sign.isprintable() else repr(sign)[1:-1] for sign in text)


def printable_lines(text: str) -> str:
    """Do the same with all but ends of lines and tabs, in a text of several lines."""
    return "".join(sign if sign.isprintable() or sign in "\n\t" else repr(sign)[1:-1] for sign in text)


def nearest(word: str, options: Iterable[str]) -> str | None:
    """Find the option that `word` most likely meant, or None."""
    choices = list(options)
    for choice in choices:
        if choice.lower() == word.lower():
            return choice
    lowered = {choice.lower(): choice for choice in choices}
    close = difflib.get_close_matches(word.lower()[:80], lowered, n=1, cutoff=0.6)
    return lowered[close[0]] if close else None


def did_you_mean(word: str, options: Iterable[str], otherwise: str = "") -> str:
    """Write the remedy for an unknown word: the nearest option, else `otherwise`, else all options."""
    choices = list(options)
    found = nearest(word, choices)
    if found is not None:
        return f"did you mean {found}?"
    return otherwise or (f"choose from: {', '.join(choices)}" if choices else "")
