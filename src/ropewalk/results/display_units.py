"""Units in which results are shown: of engineering, by the size of the numbers, or those that the reader names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ropewalk.errors import Refused, did_you_mean
from ropewalk.units import measure


class DisplayUnit(NamedTuple):
    """A unit by its symbol, its size in SI units, and the least size (in SI) of what it is taken for."""

    symbol: str
    size: float
    since: float = 0.0


_UnitSteps = tuple[DisplayUnit, ...]
Row = tuple[str, str, str]
"""Of a table: what, how much, where and when."""


def _decimal(si: str, prefixes: str = " kM") -> _UnitSteps:
    """An SI unit and its multiples by 1000."""
    steps = (1000.0**k for k in range(len(prefixes)))
    return tuple(
        DisplayUnit(f"{p.strip()}{si}", s, s if s > 1.0 else 0.0) for p, s in zip(prefixes, steps, strict=True)
    )


ENGINEERING: Mapping[str, _UnitSteps] = {
    "N": _decimal("N"),
    "N/m": _decimal("N/m"),
    "N*m": _decimal("N*m"),
    "J": (DisplayUnit("J", 1.0), DisplayUnit("kJ", 1e3, 1e4), DisplayUnit("MJ", 1e6, 1e7)),  # forms differ in size
    "W": _decimal("W"),
    "m": (DisplayUnit("mm", 1e-3), DisplayUnit("m", 1.0, 1.0)),
    "s": (DisplayUnit("µs", 1e-6), DisplayUnit("ms", 1e-3, 1e-3), DisplayUnit("s", 1.0, 1.0)),
    "m/s": (DisplayUnit("m/s", 1.0), DisplayUnit("km/h", 1.0 / 3.6, 10.0)),
    "rad": (DisplayUnit("°", np.pi / 180.0),),
    "strain": (DisplayUnit("%", 0.01),),
}
"""Per SI unit those that are shown, small ones first; of several the last one that the largest value reaches."""

_WITHOUT_DIMENSION = {"%": "strain", "deg": "rad", "rad": "rad", "mrad": "rad"}
PLACES = ("line", "xi", "x", "y", "z", "time", "load_path", "station")
"""Where and when something was found: in m and s, lengths in a named unit that is not a part of the metre."""
NOTHING = 1e-5  # of the largest of its kind: what is no larger gets no row
PLACE = "place"  # stands for the SI unit of coordinates


@dataclass(frozen=True)
class DisplayUnits:
    """What numbers are shown in, per SI unit; what is not listed is shown in SI."""

    steps: Mapping[str, _UnitSteps]

    @classmethod
    def read(cls, text: str | None) -> DisplayUnits:
        """Read a choice of units.

        Args:
            text: `engineering` (also None), `SI`, or a list such as "kN,mm,km/h" of units which replace those of
                engineering (after `SI,` those of the SI) for all that is measured in them.

        Raises:
            Refused: (a ValueError) no unit, or one of nothing that is shown.
        """
        steps: dict[str, _UnitSteps] = dict(ENGINEERING)
        for part in (part.strip() for part in (text or "").split(",")):
            if part.lower() in ("", "engineering", "si"):
                steps = {} if part.lower() == "si" else steps
                continue
            size = measure(part)[0]
            steps[_quantity_of(part)] = (DisplayUnit("°" if part == "deg" else part, size),)
            if _quantity_of(part) == "m" and (size >= 1.0 or not part.endswith("m")):  # places in mm help nobody
                steps[PLACE] = (DisplayUnit(part, size),)
        return cls(steps)

    @property
    def place(self) -> DisplayUnit:
        """The unit of coordinates."""
        return self.steps.get(PLACE, (DisplayUnit("m", 1.0),))[0]

    def of(self, unit: str, values: Iterable[Any]) -> DisplayUnit:
        """The unit for numbers that stand next to each other, of which the largest one decides.

        Args:
            unit: SI unit of the numbers; `strain` for strains.
            values: numbers or arrays; values that are not finite do not count.
        """
        if unit not in self.steps:
            return DisplayUnit("" if unit in ("1", "strain") else unit, 1.0)
        unit_steps = self.steps[unit]
        largest = max((_largest(value) for value in values), default=0.0)
        if largest == 0.0 and len(unit_steps) > 1:
            return next(step for step in unit_steps if step.symbol == unit)
        return [step for step in unit_steps if largest >= step.since * (1.0 - 1e-12)][-1]


class Column:
    """Writes the numbers of one part of a summary: like things in one unit.

    Args:
        units: that are shown.
        found: parts of a summary, whose numbers decide on the units.
        floor: per SI unit, what is no larger is written as zero.
    """

    def __init__(self, units: DisplayUnits, *found: Any, floor: Mapping[str, float] | None = None) -> None:
        self._units, self._floor = units, floor or {}
        sizes: dict[str, list[float]] = {}
        for unit, value in (pair for part in found for pair in quantities(part)):
            sizes.setdefault(unit, []).append(value)
        self._chosen = {unit: units.of(unit, values) for unit, values in sizes.items()}

    def unit(self, unit: str, *values: float | None) -> DisplayUnit:
        """What numbers in an SI unit are written in; numbers of quite another size than theirs get their own."""
        own = self._units.of(unit, [value for value in values if value is not None])
        displayed = self._chosen.get(unit, own)
        largest = max((abs(value) for value in values if value is not None), default=0.0) / displayed.size
        return displayed if largest == 0.0 or 0.1 <= largest < 1e5 else own

    def __call__(self, value: float | None, unit: str, digits: int = 4) -> str:
        """A number with its unit, or a dash for none."""
        if value is None:
            return "–"
        value = self._round(value, unit)
        displayed = self.unit(unit, value)
        return f"{number(value / displayed.size, digits)} {displayed.symbol}".rstrip().replace(" °", "°")

    def span(self, low: float | None, high: float | None, unit: str, digits: int = 4) -> str:
        """A range of numbers with as many decimals at both ends; one number if it has no width."""
        if low is None or high is None:
            return "–"
        low, high = self._round(low, unit), self._round(high, unit)
        displayed = self.unit(unit, low, high)
        ends = low / displayed.size, high / displayed.size
        if high - low <= 1e-6 * max(abs(low), abs(high)):
            return self(high, unit, digits)
        largest = max(map(abs, ends))
        if not 1e-4 <= largest < 1e6:
            label = [number(end, digits) for end in ends]
        else:
            label = [f"{end:.{decimals(largest, digits)}f}" for end in ends]
            label = ["0" if float(text) == 0.0 else text for text in label]
        return f"{label[0]} to {label[1]} {displayed.symbol}".rstrip()

    @property
    def length(self) -> DisplayUnit:
        """The unit of lengths about a metre."""
        return self._units.of("m", [1.0])

    def place(self, value: float | None, *, with_unit: bool = True) -> str:
        """A coordinate to four digits, but no finer than a thousandth of its unit."""
        unit = self._units.place
        if value is None:
            return "–"
        here = value / unit.size
        return (number(here) if abs(here) >= 1.0 else f"{here:.3f}") + (f" {unit.symbol}" if with_unit else "")

    def when(self, found: Mapping[str, Any]) -> Iterator[str]:
        """The instant, or the place of the load, at which something was found."""
        if found.get("time") is not None:
            yield f"t = {number(found['time'])} s"
        if found.get("load_path") is not None:
            unit = self._units.place
            yield f"load path = {number(found['load_path'] / unit.size)} {unit.symbol}"

    def instant_and_components(self, force: Mapping[str, Any]) -> str:
        """The instant of a force, and the ranges of its components that are anything compared with the whole."""
        parts = force["components"].items() if force["value"] is not None else ()
        known = [(axis, part["min"], part["max"]) for axis, part in parts if part["min"] is not None]
        spans = (f"{axis}: {self.span(low, high, 'N')}" for axis, low, high in known
                 if max(abs(low), abs(high)) > NOTHING * force["value"])  # fmt: skip
        return "  ".join((*self.when(force), *spans))

    def _round(self, value: float, unit: str) -> float:
        return 0.0 if abs(value) <= self._floor.get(unit, 0.0) else value


def quantities(found: Any, unit: str = "1") -> Iterator[tuple[str, float]]:
    """The numbers of a part of a summary with their SI units, without places and instants."""
    if isinstance(found, dict):
        unit = found.get("unit", unit)
        for key, value in found.items():
            if key not in ("unit", "relative", *PLACES):
                yield from quantities(value, unit)
    elif isinstance(found, int | float) and not isinstance(found, bool) and isinstance(unit, str):
        yield unit, float(found)


def number(value: float | None, digits: int = 4) -> str:
    """A number with so many significant digits, or a dash for none."""
    if value is None:
        return "–"
    if value == 0.0:
        return "0"
    if not 1e-4 <= abs(value) < 1e6:
        return f"{value:.{digits - 1}e}"
    return f"{value:.{decimals(value, digits)}f}"


def decimals(value: float, digits: int) -> int:
    """Decimals that give a number so many significant digits."""
    return max(digits - 1 - int(np.floor(np.log10(abs(value)))), 0)


def _quantity_of(text: str) -> str:
    """The SI unit of what is measured in a unit."""
    dimension = measure(text)[1]
    if text in _WITHOUT_DIMENSION:
        return _WITHOUT_DIMENSION[text]
    alike = [si for si in ENGINEERING if si not in _WITHOUT_DIMENSION.values() and measure(si)[1] == dimension]
    if alike:  # a moment and an energy have one dimension, and are distinguished by how they are written
        return next((si for si in alike if ("*" in si) == ("*" in text)), alike[0])
    known = sorted({step.symbol for unit_steps in ENGINEERING.values() for step in unit_steps})
    raise Refused(
        f"no quantity is shown in {text}", did_you_mean(text, known, otherwise=f"write {', '.join(known)} or SI")
    )


def _largest(value: Any) -> float:
    kept = np.abs(np.asarray(value, dtype=np.float64))
    kept = kept[np.isfinite(kept)]
    return float(kept.max(initial=0.0))
