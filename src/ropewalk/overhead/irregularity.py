"""Irregularities of a contact wire, from a file: how much higher or lower a pantograph feels it to be."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ropewalk.errors import Problem, ScenarioError
from ropewalk.model.pantograph import Pantograph
from ropewalk.wires.plan import Array

if TYPE_CHECKING:
    from ropewalk.model.scenario import Scenario

_COARSE = 10.0  # lengths of the line between two samples: with at most one of them on it, x has another unit
_HIGH = 0.05  # m; contact wires are level within some mm
_STEEP = 0.06  # roads and tracks stay below; roughness of some mm that is read as m is steeper


class _Samples(NamedTuple):
    """A file of samples, and between which positions in m along which line they have an effect."""

    key: str
    file: Path
    line: str
    low: float
    high: float
    is_wire: bool


def check_samples(scenario: Scenario) -> list[str]:
    """Read all irregularities and profiles of a scenario; return warnings about unlikely heights.

    Raises:
        ScenarioError: a file cannot be read, or none of its samples lies on its line.
    """
    warnings = list[str]()
    for given in _files(scenario):
        rows = read_irregularity(given.file, given.key)
        _refuse_elsewhere(given, rows)
        warnings += _questioned(given, rows)
    return warnings


def _files(scenario: Scenario) -> Iterator[_Samples]:
    for name, load in scenario.loads.items():
        if not isinstance(load, Pantograph):
            continue
        for line, file in load.irregularities.items():
            if line in scenario.overhead_lines:
                key = f"loads.{name}.irregularity" + ("" if isinstance(load.irregularity, str) else f".{line}")
                yield _Samples(key, Path(file), line, 0.0, scenario.overhead_lines[line].length, True)
    for name, road in scenario.lines.items():
        if road.profile is not None and road.profile.file is not None:
            starts = [place.start for load in scenario.loads.values() if load.on == name for place in load.starts()]
            low, high = min([0.0, *starts]), max([road.length or road.distance, *starts])
            yield _Samples(f"lines.{name}.profile.file", Path(road.profile.file), name, low, high, False)


def _refuse_elsewhere(given: _Samples, rows: Irregularity) -> None:
    """Refuse samples that lie off their line, or so far apart that at most one of them lies on it."""
    low, high, x = given.low, given.high, rows.x
    inside = int(((x >= low) & (x <= high)).sum())
    after = int(np.clip(np.searchsorted(x, high, side="right"), 1, x.size - 1))
    gap = float(x[after] - x[after - 1])
    if x[0] <= high and x[-1] >= low and (inside > 1 or gap <= _COARSE * (high - low)):
        return
    count = "only one sample lies" if inside else "no sample lies"
    wrong = f"{count} on {given.line}, from {low:g} m to {high:g} m: samples reach from {x[0]:g} m to {x[-1]:g} m"
    remedy = "write x in m from the start of the line (divide values in mm by 1000)"
    raise ScenarioError([Problem(given.key, wrong, str(given.file), remedy)])


def _questioned(given: _Samples, rows: Irregularity) -> Iterator[str]:
    """Yield a warning where heights are far beyond those of wires, roads and tracks."""
    on = (rows.x >= given.low) & (rows.x <= given.high)
    z = rows.z[on] if on.any() else rows.z
    steep = float(np.abs(np.diff(rows.z) / np.diff(rows.x)).max())
    highest = float(np.abs(z).max() if given.is_wire else np.ptp(z))
    if highest <= _HIGH or not (given.is_wire or steep > _STEEP):
        return
    usual = "contact wires deviate by some mm"
    if not given.is_wire:
        usual = f"with slopes of up to {100.0 * steep:.3g} %, where roads and tracks stay below {100.0 * _STEEP:g} %"
    yield (
        f"{given.key}: heights of {given.file.name} reach {100.0 * highest:.3g} cm on {given.line}, {usual}; "
        "check the unit: z is in m (divide values in mm by 1000)"
    )


_LARGEST = 1.0  # m; more is taken for a slip of the unit
_REMEDY = "write rows of two numbers, x and z in m, such as 12.5, -0.002"


class Irregularity(NamedTuple):
    """Heights along the wire, linear in between and 0 outside."""

    x: Array  # m from the start of the line, rising
    z: Array  # m, added to the height of the wire

    def at(self, station: Array) -> Array:
        """Heights at stations, m."""
        return np.interp(station, self.x, self.z, left=0.0, right=0.0)


def read_irregularity(file: Path, key: str = "irregularity") -> Irregularity:
    """Read a file of rows `x, z` in m.

    Commas, semicolons or blanks divide them; a first row of words is skipped, and so is what follows a #.

    Args:
        file: its name.
        key: where it is named, for errors.

    Raises:
        ScenarioError: it cannot be read, or rows are not as they should be; every problem with its line.
    """
    try:
        text = file.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) and error.strerror else "it is not text in UTF-8"
        problem = Problem(key, "the file cannot be read", f"{file} ({why})", "name a text file next to the scenario")
        raise ScenarioError([problem]) from None
    rows: list[tuple[float, float]] = []
    problems: list[Problem] = []
    seen = False
    for number, line in enumerate(text.splitlines(), start=1):
        cells = line.partition("#")[0].replace(";", " ").replace(",", " ").split()
        if not cells:
            continue
        numbers = [_number(cell) for cell in cells]
        if not seen and all(value is None for value in numbers):
            seen = True  # a header
            continue
        seen = True
        found = _wrong(numbers, rows)
        if found:
            problems.append(Problem(key, found[0], line.strip()[:60], found[1], str(file), number))
        else:
            rows.append((numbers[0] or 0.0, numbers[1] or 0.0))
    if not problems and len(rows) < 2:
        count = f"{len(rows)} row{'' if len(rows) == 1 else 's'}"
        problems.append(Problem(key, "at least two rows are needed", count, _REMEDY, str(file)))
    if problems:
        raise ScenarioError(problems)
    x, z = np.array(rows).T
    return Irregularity(np.ascontiguousarray(x), np.ascontiguousarray(z))


def _wrong(numbers: list[float | None], rows: list[tuple[float, float]]) -> tuple[str, str] | None:
    """What is wrong with a row after those before it, and what to do."""
    if len(numbers) != 2:
        return f"has {len(numbers)} values instead of 2", _REMEDY
    x, z = numbers
    if x is None or z is None or not (np.isfinite(x) and np.isfinite(z)):
        return "is not two numbers", _REMEDY
    if rows and x <= rows[-1][0]:
        return f"x must rise, the row before has {rows[-1][0]:g}", "sort the rows by x, and give each x once"
    if abs(z) > _LARGEST:
        return "an irregularity of more than 1 m", "write z in m"
    return None


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None
