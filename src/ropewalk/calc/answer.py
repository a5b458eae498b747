"""What a calculator knows of a quantity, and what it answers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from math import inf, isinf
from typing import Any

from ropewalk.errors import Refused
from ropewalk.results.display_units import DisplayUnits, number


@dataclass(frozen=True)
class CalcValue:
    """A quantity of a calculator.

    Args:
        name: as it is given.
        unit: SI unit.
        about: what it is.
        low, high: range of values.
        default: taken if it is not given; None: there is none.
        optional: results that depend on it are left out if it is not given.
        typical: where a search of several begins.
        share: displayed in per cent.
        search: sizes among which it is sought.
        zero: whether it may be zero.
    """

    name: str
    unit: str
    about: str
    low: float = 0.0
    high: float = inf
    default: float | None = None
    optional: bool = False
    typical: float = 1.0
    share: bool = False
    search: tuple[float, float] = (1e-6, 1e12)
    zero: bool = False

    def check(self, value: float) -> None:
        """Refuse a value out of range.

        Raises:
            Refused: (a ValueError) it is.
        """
        positive = self.low == 0.0 and not self.zero
        if not self.low <= value <= self.high or (positive and value == 0.0):
            least = "positive" if positive else f"at least {self.low:g}"
            bounds = least if isinf(self.high) else f"between {self.low:g} and {self.high:g}"
            raise Refused(f"{self.name} must be {bounds}")

    @property
    def displayed_default(self) -> str:
        """The default as the table of quantities has it."""
        if self.default is None:
            return "(left out)" if self.optional else ""
        return "inextensible" if isinf(self.default) else f"{self.default:g}"


@dataclass(frozen=True)
class Answer(Mapping[str, float]):
    """Quantities in SI units by name, those that were given among them; also as attributes.

    `given` names what was given, `messages` says what else would fit; `asked` what was asked for.
    """

    calculator: str
    quantities: Mapping[str, CalcValue]
    values_in_si: Mapping[str, float]
    given: frozenset[str]
    chosen: Mapping[str, str]
    messages: tuple[str, ...] = ()
    asked: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> float:
        return self.values_in_si[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.values_in_si)

    def __len__(self) -> int:
        return len(self.values_in_si)

    def __getattr__(self, name: str) -> float:
        if name.startswith("_") or name not in self.values_in_si:
            raise AttributeError(f"the answer of {self.__dict__.get('calculator', '')} has no {name}")
        return self.values_in_si[name]

    def table(self, units: DisplayUnits | None = None) -> list[tuple[str, str, str]]:
        """Rows of name, value with unit and meaning; what was given is marked by a star."""
        units = units or DisplayUnits.read(None)
        rows = [(f"{name} *" if name in self.given else name, value, "") for name, value in self.chosen.items()]
        for name, value in self.values_in_si.items():
            if self.asked and name not in self.asked and name not in self.given:
                continue
            mark = f"{name} *" if name in self.given else name
            rows.append((mark, displayed(self.quantities[name], value, units), self.quantities[name].about))
        return rows

    def as_dict(self) -> dict[str, Any]:
        """Everything with its unit, for JSON; None for a value that is not finite."""
        found: dict[str, Any] = {"calculator": self.calculator, **self.chosen, "quantities": {}}
        for name, value in self.values_in_si.items():
            unit, kept = self.quantities[name].unit, None if isinf(value) else value
            found["quantities"][name] = {"value": kept, "unit": unit, "given": name in self.given}
        return {**found, "messages": list(self.messages)}


def displayed(quantity: CalcValue, value: float, units: DisplayUnits) -> str:
    """A value with its unit."""
    if isinf(value):
        return "inextensible" if quantity.name == "axial_stiffness" else "infinite"
    if quantity.unit == "dimensionless" and not quantity.share:
        return number(value)
    unit = "strain" if quantity.share else quantity.unit
    chosen = units.of(unit, [value])
    return f"{number(value / chosen.size)} {chosen.symbol}".replace(" °", "°")


def in_words(quantities: Mapping[str, CalcValue], names: Iterable[str], values: Mapping[str, float]) -> str:
    """Quantities with values, as `span = 63.00 m, sag = 3.000 m`."""
    units = DisplayUnits.read(None)
    return ", ".join(f"{name} = {displayed(quantities[name], values[name], units)}" for name in names)
