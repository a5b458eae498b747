"""What can go wrong, as values that say where, what was given and what to do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


class RopewalkError(Exception):
    """Base of every error that ropewalk raises on purpose."""


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
        where = ":".join(str(part) for part in (self.file, self.line, self.key) if part not in ("", None))
        text = f"{where}: {self.wrong}" if where else self.wrong
        if self.given:
            text += f", given {self.given}"
        if self.remedy:
            text += f"; {self.remedy}"
        return text


class ScenarioError(RopewalkError):
    """A scenario that cannot be run, with every problem found in it."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))


class EquilibriumError(RopewalkError):
    """No rest shape exists, or it is not unique; the message says why and what to change."""
