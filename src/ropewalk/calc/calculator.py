"""A calculator: quantities, and rules by which some follow from others; any sufficient set of them gives the rest.

Rules are functions whose arguments are names of quantities or of other rules. What no rule gives is free. Free
quantities that are not given follow from given results by a search for roots, one at a time where that is possible.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from inspect import signature
from itertools import combinations
from math import isclose, isfinite
from typing import Any

from ropewalk.calc.answer import Answer, CalcValue, in_words
from ropewalk.calc.roots import several, single
from ropewalk.errors import Problem, ScenarioError, did_you_mean
from ropewalk.units import to_si

Rule = Callable[..., Any]
SAME = 2e-3
"""Part by which a given result may differ from what follows from the rest: that of rounded numbers."""


@dataclass(frozen=True)
class Calculator:
    """Quantities of one trade and what they follow from.

    Args:
        name: as on the command line.
        about: one sentence.
        free: quantities that follow from no other, in the order of the table.
        results: quantities that rules of the same names give.
        rules: functions of quantities and of each other.
        points: of a search, per quantity; fewer where rules take long.
    """

    name: str
    about: str
    free: tuple[CalcValue, ...]
    results: tuple[CalcValue, ...]
    rules: Mapping[str, Rule]
    points: int = 240
    choices: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @cached_property
    def quantities(self) -> dict[str, CalcValue]:
        """All of them by name."""
        return {quantity.name: quantity for quantity in (*self.free, *self.results)}

    @cached_property
    def arguments(self) -> dict[str, tuple[str, ...]]:
        """What each rule asks for."""
        return {name: tuple(signature(rule).parameters) for name, rule in self.rules.items()}

    @cached_property
    def depends(self) -> dict[str, frozenset[str]]:
        """Free quantities that each rule depends on."""
        found: dict[str, frozenset[str]] = {}

        def of(name: str) -> frozenset[str]:
            if name not in self.rules:
                return frozenset({name})
            if name not in found:
                found[name] = frozenset().union(*(of(argument) for argument in self.arguments[name]))
            return found[name]

        return {name: of(name) for name in self.rules}

    def __call__(self, **given: Any) -> Answer:
        """Compute what follows from what is given: numbers in SI or texts with units; None asks for a quantity.

        Raises:
            ScenarioError: a name or a value is none, too little is given, or what is given contradicts itself.
        """
        return _Search(self, self._read(given)).answer()

    def compute(self, name: str, known: Mapping[str, Any], memory: dict[str, Any]) -> Any:
        """A quantity or rule from known free quantities; `memory` keeps what was computed.

        Raises:
            ValueError: out of the range of a formula.
        """
        if name in known:
            return known[name]
        if name not in memory:
            memory[name] = self.rules[name](
                **{argument: self.compute(argument, known, memory) for argument in self.arguments[name]}
            )
        return memory[name]

    def _read(self, given: Mapping[str, Any]) -> dict[str, Any]:
        read, problems = dict[str, Any](), []
        for name, value in given.items():
            if name not in self.quantities and name not in self.choices:
                names = [*self.quantities, *self.choices]
                advice = did_you_mean(name, names, otherwise=f"there are {', '.join(names)}")
                problems.append(Problem(name, f"{self.name} has no such quantity", remedy=advice))
            elif name in self.choices:
                read[name] = value
                if value not in self.choices[name]:
                    known = ", ".join(self.choices[name])
                    problems.append(Problem(name, "no such choice", str(value), f"write one of {known}"))
            elif value is None or value == "?":
                read[name] = None
            else:
                quantity = self.quantities[name]
                try:
                    read[name] = to_si(value, quantity.unit)
                    quantity.check(read[name])
                except ValueError as error:
                    problems.append(Problem(name, str(error), str(value)))
        if problems:
            raise ScenarioError(problems)
        return read


class _Search:
    """What is known in the course of one calculation."""

    def __init__(self, calculator: Calculator, given: dict[str, Any]) -> None:
        self.calculator, self.given = calculator, given
        self.known: dict[str, Any] = {name: given.get(name, known[0]) for name, known in calculator.choices.items()}
        for quantity in calculator.free:
            value = given.get(quantity.name, quantity.default)
            if value is not None:
                self.known[quantity.name] = value
        self.targets = {
            quantity.name: given[quantity.name]
            for quantity in calculator.results
            if given.get(quantity.name) is not None
        }
        self.messages: list[str] = []
        self.used = set[str]()

    def open(self, name: str) -> frozenset[str]:
        """Free quantities that a result waits for."""
        return frozenset(self.calculator.depends[name] - self.known.keys())

    def answer(self) -> Answer:
        """All that follows.

        Raises:
            ScenarioError: too little or contradicting.
        """
        while self._solve_some():
            pass
        self._refuse_missing()
        memory: dict[str, Any] = {}
        values = dict[str, float]()
        for name in self.calculator.quantities:
            if name in self.known:
                values[name] = self.known[name]
            elif name in self.calculator.rules and not self.open(name):
                try:
                    value = float(self.calculator.compute(name, self.known, memory))
                except ValueError as error:
                    raise ScenarioError([Problem(name, str(error), self._givens(name))]) from None
                if isfinite(value):
                    values[name] = value
        self._refuse_contradictions(values)
        asked = tuple(name for name, value in self.given.items() if value is None)
        chosen = {name: str(self.known[name]) for name in self.calculator.choices}
        given = frozenset(name for name, value in self.given.items() if value is not None)
        return Answer(
            self.calculator.name, self.calculator.quantities, values, given, chosen, tuple(self.messages), asked
        )

    def _solve_some(self) -> bool:
        """Find one free quantity, or several together, from given results; whether there were any."""
        waiting = [name for name in self.targets if self.open(name) and name not in self.used]
        for size in range(1, len(waiting) + 1):
            for names in combinations(waiting, size):
                unknown = frozenset().union(*(self.open(name) for name in names))
                if len(unknown) == size:
                    self._solve(names, tuple(q.name for q in self.calculator.free if q.name in unknown))
                    return True
        return False

    def _solve(self, results: Sequence[str], unknown: Sequence[str]) -> None:
        quantities = [self.calculator.quantities[name] for name in unknown]

        def values(trial: Sequence[float]) -> list[float]:
            known, memory = {**self.known, **dict(zip(unknown, trial, strict=True))}, dict[str, Any]()
            return [float(self.calculator.compute(name, known, memory)) for name in results]

        wanted = [self.targets[name] for name in results]
        alike = [v for n, v in self.known.items() if n in self.calculator.quantities and isinstance(v, float)]
        found: Sequence[tuple[float, ...]]
        if len(unknown) == 1:
            found = single(lambda x: values([x])[0], wanted[0], quantities[0], alike, self.calculator.points)
        else:
            found = several(values, wanted, quantities, alike)
        if not found:
            what = in_words(self.calculator.quantities, results, self.targets)
            raise ScenarioError(
                [
                    Problem(
                        ", ".join(results), f"no {' and '.join(unknown)} gives {what}", self._givens(*results),
                        f"change a given quantity, or leave {results[0]} out and give {unknown[0]}",
                    )
                ]
            )  # fmt: skip
        self.known.update(zip(unknown, found[0], strict=True))
        self.used.update(results)
        for other in found[1:]:
            what = in_words(self.calculator.quantities, unknown, dict(zip(unknown, other, strict=True)))
            self.messages.append(f"{what} gives the same {' and '.join(results)}; give {unknown[0]} to choose it")

    def _givens(self, *results: str) -> str:
        """What was given of that on which results depend."""
        on = frozenset().union(*(self.calculator.depends.get(name, frozenset({name})) for name in results))
        names = [name for name in self.calculator.quantities if name in on and self.given.get(name) is not None]
        return in_words(self.calculator.quantities, names, self.given)

    def _refuse_missing(self) -> None:
        needed = [q.name for q in self.calculator.free if q.name not in self.known and not q.optional]
        if not needed:
            return
        instead = [
            q.name for q in self.calculator.results if q.name not in self.targets and self.open(q.name) & set(needed)
        ]
        count = len(needed) - sum(bool(self.open(name)) for name in self.targets)
        more = "one more quantity is" if count <= 1 else f"{count} more quantities are"
        unknown = f"{', '.join(needed)} {'is' if len(needed) == 1 else 'are'} to be given"
        raise ScenarioError(
            [
                Problem(
                    self.calculator.name, f"{more} needed: {unknown}",
                    remedy=f"give {' or '.join(needed)}, or instead {', '.join(instead)}",
                )
            ]
        )  # fmt: skip

    def _refuse_contradictions(self, values: Mapping[str, float]) -> None:
        problems = []
        for name, given in self.targets.items():
            if name not in values or not isclose(values[name], given, rel_tol=SAME, abs_tol=1e-9):
                rest = sorted({*self.given} - {name, *(n for n, v in self.given.items() if v is None)})
                first = in_words(self.calculator.quantities, [name], values) if name in values else "nothing"
                problems.append(
                    Problem(
                        name, f"contradicts the other given quantities, from which {first} follows",
                        in_words(self.calculator.quantities, [name], self.targets),
                        f"leave out one of {', '.join([name, *rest])}{self._defaults(name)}",
                    )
                )  # fmt: skip
        if problems:
            raise ScenarioError(problems)

    def _defaults(self, name: str) -> str:
        """What of a result's causes was nobody's but a default, and could be asked for."""
        free = [q.name for q in self.calculator.free if q.name in self.calculator.depends[name]]
        silent = [
            n
            for n in free
            if n not in self.given and n in self.known and self.calculator.quantities[n].default is not None
        ]
        silent = [n for n in silent if n not in self.used and n != "gravity"]
        return f", or ask for one that has a default: {', '.join(f'{n}=?' for n in silent)}" if silent else ""


def listed(calculator: Calculator) -> Iterator[tuple[str, str, str, str]]:
    """Rows of the table of quantities: name, unit, default, meaning."""
    yield "quantity", "unit", "default", ""
    for name, known in calculator.choices.items():
        yield name, "", known[0], f"one of {', '.join(known)}"
    for quantity in calculator.quantities.values():
        free = quantity.name not in calculator.rules
        default = quantity.displayed_default if free else ""
        yield quantity.name, "" if quantity.unit == "dimensionless" else quantity.unit, default, quantity.about
