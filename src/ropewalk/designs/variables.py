"""Variables: keys of a scenario that may take any value between two bounds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ropewalk.errors import Refused
from ropewalk.mechanics.chain import Array
from ropewalk.model import Scenario
from ropewalk.scenario import tree_of
from ropewalk.sweeps.case import Outcome
from ropewalk.sweeps.keys import leaves, short_names, unit_at
from ropewalk.sweeps.parameters import quantity, read_all, refuse, written
from ropewalk.units import to_si

FORM = "write LOW:HIGH with a unit, for example 500 kN:600 kN or 0.9:1.1 m"


@dataclass(frozen=True)
class Variable:
    """A key and its bounds, in a unit.

    Args:
        key: as `--set` has it.
        low: lower bound.
        high: upper bound.
        unit: of both, and of every value; empty: SI.
    """

    key: str
    low: float
    high: float
    unit: str = ""

    @classmethod
    def read(cls, key: str, bounds: Any) -> Variable:
        """Read bounds: text, or two numbers or texts.

        Raises:
            ScenarioError: these are no bounds.
        """
        parts = bounds.split(":") if isinstance(bounds, str) else list(bounds)
        if len(parts) != 2:
            refuse(key, "these are no two bounds", str(bounds)[:60], FORM)
        read = [quantity(key, str(part)) for part in parts]
        units = {unit for _, unit in read if unit}
        if len(units) > 1:
            refuse(key, "both bounds need the same unit", " and ".join(sorted(units)), FORM)
        low, high = (float(number) for number, _ in read)
        if not low < high:
            refuse(key, "the upper bound is not above the lower one", str(bounds)[:60], FORM)
        return cls(key, low, high, units.pop() if units else "")

    def at(self, part: float) -> str:
        """The value at a part of the way from the lower bound to the upper one, as a file has it."""
        return written(float(self.value(part)), self.unit)

    def value(self, part: float) -> float:
        """The same as a number in the unit."""
        if part <= 0.0:
            return self.low
        return self.high if part >= 1.0 else self.low + part * (self.high - self.low)

    def si(self, value: float, unit: str) -> float:
        """A value of this variable in SI units, `unit` being the one of its key."""
        return to_si(written(value, self.unit) if self.unit else value, unit or "dimensionless")


def variables_of(vary: Mapping[str, Any]) -> tuple[Variable, ...]:
    """Read all variables, or tell all their mistakes.

    Raises:
        ScenarioError: with every mistake found, or nothing varies.
    """
    if not vary:
        refuse("vary", "nothing varies", "", "name a key and its bounds, KEY=LOW:HIGH")
    return read_all(Variable.read, vary)


@dataclass(frozen=True)
class Space:
    """All variables together: points are parts (variable,) of the ways between their bounds.

    Args:
        variables: what varies.
        names: their short names.
        units: SI units of their keys.
        own: (variable,) the point of the scenario as it is; the middle where it has no value or one outside.
    """

    variables: tuple[Variable, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]
    own: Array

    @classmethod
    def of(cls, scenario: Scenario, vary: Mapping[str, Any], taken: Sequence[str] = ()) -> Space:
        """The variables of a scenario; short names differ from those that are taken.

        Raises:
            ScenarioError: as `variables_of`.
        """
        variables = variables_of(vary)
        tree = tree_of(scenario)
        units = tuple(unit_at(tree, variable.key) for variable in variables)
        stands = dict(leaves(tree))
        own = np.full(len(variables), 0.5)
        for k, (one, unit) in enumerate(zip(variables, units, strict=True)):
            try:
                low, high = (one.si(bound, unit) for bound in (one.low, one.high))
                part = (to_si(stands[one.key], unit or "dimensionless") - low) / (high - low)
            except (KeyError, Refused):
                continue
            own[k] = part if 0.0 <= part <= 1.0 else own[k]
        return cls(variables, tuple(short_names([v.key for v in variables], taken)), units, own)

    def settings(self, point: Array) -> dict[str, str]:
        """The values at a point, by key, as a file has them."""
        return {one.key: one.at(float(part)) for one, part in zip(self.variables, point, strict=True)}

    def values(self, point: Array) -> Array:
        """(variable,) the values at a point, each in the unit of its bounds."""
        return np.array([one.value(float(part)) for one, part in zip(self.variables, point, strict=True)])

    def amount(self, k: int, point: Array) -> tuple[float, str]:
        """The value of one variable in SI units, and that unit."""
        one = self.variables[k]
        return one.si(one.value(float(point[k])), self.units[k]), self.units[k]


def number_of(outcome: Outcome, name: str) -> float:
    """A quantity of a case in SI units, NaN if it has none."""
    value = outcome.values.get(name, (None, ""))[0]
    return np.nan if value is None else float(value)
