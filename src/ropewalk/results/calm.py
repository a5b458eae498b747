"""Pantographs that start so close to the analysed spans that their start is still felt in the statistics."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ropewalk.model.history import SpeedTable
from ropewalk.model.overhead import stations_of
from ropewalk.model.pantograph import Pantograph

if TYPE_CHECKING:
    from ropewalk.model import Scenario

# On the EN 50318 reference models a start two spans before the analysed ones changes sigma by 2 N and leaves the
# largest uplift alone; a start one span before raises that by 8 to 16 mm, half a span before the force by 20 to 34 N.
CALM = 2


def started_too_close(scenario: Scenario) -> Iterator[str]:
    """The pantographs of a scenario that start less than two spans before the analysed ones, in words."""
    if scenario.run.kind != "dynamic" or scenario.run.start.kind == "result":
        return
    for name, load in scenario.loads.items():
        if not isinstance(load, Pantograph) or load.on not in scenario.overhead_lines:
            continue
        line = scenario.overhead_lines[load.on]
        stations, (first, last) = stations_of(line), line.analysed
        speed, start = load.travel.speed, load.travel.start
        values = speed.value if isinstance(speed, SpeedTable) else () if callable(speed) else (speed,)
        if values and max(values) <= 0.0:  # everything as seen from the other end
            first, last = len(stations) - last, len(stations) - first
            stations, start = [stations[-1] - x for x in reversed(stations)], stations[-1] - start
        latest = stations[first - 1 - CALM] if first > CALM else -1.0
        if not latest + 1e-9 * stations[-1] < start < stations[last]:
            continue
        before = stations[first - 1] - start
        where = f"{before:.4g} m before" if before > 0.0 else "within"
        remedy = f"overhead_lines.{load.on}.analysed_spans or more spans"
        if latest >= 0.0:
            remedy = f"loads.{name}.travel.from at least {stations[first - 1] - latest:.4g} m before them, or {remedy}"
        yield (
            f"pantograph {name} starts {where} the analysed spans of {load.on}: the statistics contain the vibration "
            f"that its start excites, which decays within {CALM} spans; write {remedy}"
        )
