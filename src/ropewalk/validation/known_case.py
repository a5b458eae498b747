"""A scenario whose answer is known, with the numbers that are known of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

from ropewalk.model import Scenario
from ropewalk.scenario import loads
from ropewalk.simulate import simulate, spectrum_of
from ropewalk.validation.known_number import KnownNumber
from ropewalk.validation.publication import Publication


def answered(scenario: Scenario) -> Any:
    """The result of a run that went to its end; `doubtful` ones count, as their numbers are what is looked at.

    Raises:
        RuntimeError: it stopped early.
        RopewalkError: as `simulate`.
    """
    result = simulate(scenario)
    outcome = str(result.attrs["outcome"])
    if outcome not in ("completed", "doubtful"):
        raise RuntimeError(f"the run ended: {outcome}; {result.attrs['advice']}")
    return result


def frequencies(scenario: Scenario) -> Any:
    """The spectrum at rest."""
    return spectrum_of(scenario)


@dataclass(frozen=True)
class KnownCase:
    """What is computed once for all of its rows.

    Args:
        id: by which its rows are chosen, ID.NAME.
        what: the scenario.
        source: where its numbers are from.
        scenario: text of the scenario, or the function that gives it.
        rows: its numbers.
        fault: settings of the scenario that must make every row fail: what the rows look at is looked at.
        settings: of the scenario, before anything else.
        answer: computes the scenario.
        coarser: settings of a coarser run, for observed orders.
        ratio: by which it is coarser.
        needs: the package that it cannot do without.
        quick: whether it takes a second at most.
    """

    id: str
    what: str
    source: Publication
    scenario: str | Callable[[], str]
    rows: tuple[KnownNumber, ...]
    fault: tuple[str, ...]
    settings: tuple[str, ...] = ()
    answer: Callable[[Scenario], Any] = answered
    coarser: tuple[str, ...] = ()
    ratio: float = 2.0
    needs: str = ""
    quick: bool = False

    def by_fault(self, names: Iterable[str]) -> dict[tuple[str, ...], list[str]]:
        """Names of rows by the fault that must make them fail."""
        found: dict[tuple[str, ...], list[str]] = {}
        for row in self.rows:
            if row.name in set(names):
                found.setdefault(row.fault or self.fault, []).append(row.name)
        return found

    @property
    def there(self) -> bool:
        """Whether what it needs is installed."""
        return not self.needs or find_spec(self.needs) is not None

    def solved(self, more: Iterable[str] = ()) -> Any:
        """The answer, with more settings.

        Raises:
            ScenarioError: the scenario cannot be run.
            RuntimeError, RopewalkError: as `answer`.
        """
        text = self.scenario if isinstance(self.scenario, str) else self.scenario()
        return self.answer(loads(text, f"{self.id}.yaml", (*self.settings, *more)))
