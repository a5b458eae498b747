"""Samples of irregularities and profiles: whether they lie on their lines, and whether their heights are likely."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ropewalk.errors import Problem, ScenarioError
from ropewalk.model.pantograph import Pantograph
from ropewalk.overhead.irregularity import Irregularity, read_irregularity

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
