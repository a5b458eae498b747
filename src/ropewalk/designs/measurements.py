"""Measured values, and what a scenario makes of them: frequencies, quantities of a run, series over time."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ropewalk.errors import Refused, RopewalkError, did_you_mean
from ropewalk.mechanics.chain import Array
from ropewalk.model import Scenario
from ropewalk.results import ResultError, series_table
from ropewalk.simulate import simulate, spectrum_of
from ropewalk.sweeps.case import FINE
from ropewalk.sweeps.keys import ends_with
from ropewalk.sweeps.parameters import quantity, refuse
from ropewalk.sweeps.quantities import measured
from ropewalk.units import measure, to_si

_FREQUENCY = re.compile(r"frequency (\d+)")
SAME = 1e-3
"""Of a frequency, by which another one counts as the same."""
_COLUMN = re.compile(r"\s*(.+?)\s*(?:\[(.+)\])?\s*")


@dataclass(frozen=True)
class Measurements:
    """Values that were measured, as one vector.

    Args:
        names: of quantities, or of columns of the table of series.
        times: s, of series; empty: these are single values.
        values: (datum,) in SI units; of series column by column.
        deviations: (datum,) standard deviations in SI units, 1 where none are given.
        is_weighted: whether they are given.
    """

    names: tuple[str, ...]
    times: Array
    values: Array
    deviations: Array
    is_weighted: bool

    @classmethod
    def read(cls, data: Any) -> Measurements:
        """Read a CSV file, or a mapping of values by name.

        Raises:
            ResultError: the file cannot be read.
            ScenarioError: a value is no quantity.
        """
        if isinstance(data, Mapping):
            values = np.array([_number(name, value) for name, value in data.items()])
            return cls(tuple(data), np.zeros(0), values, np.ones(values.size), False)
        import pandas as pd

        file = Path(os.fspath(data))
        try:
            table = pd.read_csv(file, comment="#", skipinitialspace=True, dtype=str)
        except (OSError, ValueError) as error:
            raise ResultError(f"{file}: cannot be read ({error})") from None
        table.columns = table.columns.str.strip()
        if {"quantity", "value"} <= set(table.columns):
            names = tuple(table["quantity"].str.strip())
            values, spread = (
                np.array([_number(name, text) for name, text in zip(names, table[column], strict=True)])
                if column in table
                else np.ones(len(names))
                for column in ("value", "deviation")
            )
            return cls(names, np.zeros(0), values, spread, "deviation" in table)
        first = _COLUMN.fullmatch(str(table.columns[0])) if len(table.columns) > 1 else None
        if first is None or first[1] != "time":
            what = (
                "is no table of measured values; write the columns quantity and value, or time [s] and names of series"
            )
            raise ResultError(f"{file}: {what}")
        columns = []
        for name in table.columns:
            found = _COLUMN.fullmatch(str(name))
            assert found is not None
            try:
                size = to_si(f"1 {found[2]}", _si(found[2])) if found[2] else 1.0
            except (Refused, ValueError) as error:
                raise ResultError(f"{file}: column {name}: {error}") from None
            columns.append((found[1], _numbers(file, name, table[name]) * size))
        series = np.concatenate([values for _, values in columns[1:]])
        return cls(tuple(name for name, _ in columns[1:]), columns[0][1], series, np.ones(series.size), False)

    def of(self, scenario: Scenario) -> Array:
        """What a scenario has in place of the data (datum,), SI units.

        Raises:
            RopewalkError: its run fails; it says why.
            ScenarioError: a quantity is unknown.
        """
        found: dict[str, float] = {}
        modes = {name: int(match[1]) for name in self.names if (match := _FREQUENCY.fullmatch(name))}
        if modes:
            frequencies = _frequencies(scenario, max(modes.values()))
            for name, number in modes.items():
                if not 1 <= number <= frequencies.size:
                    refuse("data", "there is no such frequency", name, f"there are {frequencies.size}")
                found[name] = float(frequencies[number - 1])
        others = [name for name in self.names if name not in modes]
        if others:
            with simulate(scenario) as result:
                outcome = str(result.attrs["outcome"])
                if outcome not in FINE:
                    raise RopewalkError(f"{outcome}; {result.attrs['advice']}".rstrip("; "))
                if self.times.size:
                    return np.concatenate([self._series(result, name) for name in others])
                for name, (value, _) in measured(result, others).items():
                    if value is None:
                        raise RopewalkError(f"the run has no {name}")
                    found[name] = value
        return np.array([found[name] for name in self.names])

    def _series(self, result: Any, name: str) -> Array:
        table = series_table(result)
        columns = {str(column).rpartition(" [")[0] or str(column): column for column in table.columns}
        keys = [key for key in columns if ends_with(key, name)]
        if len(keys) != 1:
            refuse("data", "the run has no such series", repr(name), did_you_mean(name, list(columns)))
        times, values = result["time"].values, table[columns[keys[0]]].to_numpy(dtype=np.float64)
        if self.times.min() < times[0] - 1e-9 or self.times.max() > times[-1] + 1e-9:
            span = f"{self.times.min():g} to {self.times.max():g} s"
            refuse("data", "the series is longer than the run", span, "lengthen run.until, or cut the data")
        return np.asarray(np.interp(self.times, times, values))


def _numbers(file: Path, name: str, cells: Any) -> Array:
    """Numbers of a column of text.

    Raises:
        ResultError: with the first cell that is no finite number, and how many there are.
    """
    import pandas as pd

    numbers: Array = pd.to_numeric(cells, errors="coerce").to_numpy(dtype=np.float64)
    wrong = np.flatnonzero(~np.isfinite(numbers))
    if wrong.size:
        given = "an empty cell" if pd.isna(cells.iloc[wrong[0]]) else repr(cells.iloc[wrong[0]])
        count = f"{wrong.size} cells have this problem" if wrong.size > 1 else "it is the only one"
        where = f"row {wrong[0] + 1} below the head"
        raise ResultError(f"{file}: column {name}: {where} is no number, given {given}; write a number; {count}")
    return numbers


def _frequencies(scenario: Scenario, count: int) -> Array:
    """The lowest different natural frequencies in Hz; both planes of a string have the same."""
    modes = spectrum_of(scenario, how_many=max(3 * count, 1)).modes
    assert modes is not None
    found = np.sort(modes.frequency) / (2.0 * np.pi)
    return np.asarray(found[np.append(True, np.diff(found) > SAME * found[:-1])])


def _number(name: str, value: Any) -> float:
    """A measured value in SI units."""
    number, unit = quantity(name, str(value))
    if not unit:
        return float(number)
    try:
        return to_si(f"{number} {unit}", _si(unit))
    except Refused as error:
        refuse(name, error.wrong, str(value), error.remedy)
        raise


def _si(unit: str) -> str:
    """The SI unit of the same kind."""
    exponents = zip(("m", "kg", "s"), measure(unit)[1], strict=False)
    return "*".join(f"{name}^{power}" for name, power in exponents if power) or "dimensionless"
