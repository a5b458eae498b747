"""Irregularities of a contact wire, from a file: how much higher or lower a pantograph feels it to be."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from ropewalk.errors import Problem, ScenarioError
from ropewalk.wires.plan import Array

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
