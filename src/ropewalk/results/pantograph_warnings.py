"""Pantographs as declared: those that start close to the analysed spans, and those on stiff springs."""

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
# Frames have 0 to some 200 N/m there, heads 2 to 20 kN/m. With 1 kN/m a wire 10 cm higher is pressed by 100 N less.
_STIFF = 1e3  # N/m


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


def stiff_below(scenario: Scenario) -> Iterator[str]:
    """The pantographs of a scenario that stand on such a spring, in words."""
    for name, load in scenario.loads.items():
        if isinstance(load, Pantograph) and load.stiffness and load.stiffness[0] >= _STIFF:
            yield (
                f"pantograph {name} stands on a spring of {load.stiffness[0]:.4g} N/m on the roof, the first of its "
                "stiffness: its contact force decreases with the height of the wire, and its mean force is not the "
                "static one; write 0 to some 200 N/m there, as frames have, and the spring of the head last"
            )
