"""Prescribed travel of the loads of a quasi-static run on plain ropes."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import REFUSE, STAY, Array
from ropewalk.mechanics.travelled import Travelled
from ropewalk.model.axles import Axles
from ropewalk.model.history import SpeedTable
from ropewalk.model.load import Travelling
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.scenario import Scenario
from ropewalk.model.train import TrainSection
from ropewalk.model.travel import FreeTravel
from ropewalk.solve.following import Mover
from ropewalk.solve.path_measure import Measure, buffers
from ropewalk.solve.start import PreparedRun

_ARRIVED = 1e-12  # part of a line: nearer to its end, a load is located there


def horizon(scenario: Scenario) -> float:
    """For how long callables are needed until all loads have certainly passed their lines, s (0 without callables)."""
    loads = [load for load in scenario.loads.values() if isinstance(load, Travelling | Pantograph)]
    loads = [load for load in loads if not isinstance(load.travel, FreeTravel)]
    if not any(callable(load.travel.speed) or callable(getattr(load, "force", None)) for load in loads):
        return 0.0
    times = []
    for load in loads:
        speed, until, gone = load.travel.speed, 1.0, -1.0
        line, overhead = scenario.lines.get(load.on), scenario.overhead_lines.get(load.on)
        length = max(line.length or 0.0, line.distance) if line is not None else overhead.length if overhead else 0.0
        reach = (
            3.0 * length + (load.length if isinstance(load, Axles | TrainSection) else 0.0) + abs(load.travel.start)
        )  # longer than the stretched line, and there and back
        for _ in range(60):
            grid = np.linspace(0.0, until, 257)
            if callable(speed):
                rates = np.array([float(speed(t)) for t in grid])
            elif isinstance(speed, SpeedTable):
                rates = np.interp(grid, speed.time, speed.value)
            else:
                rates = np.full(grid.size, speed)
            last, gone = gone, float(np.trapezoid(np.abs(rates), grid))
            if not last < gone < reach:  # done, or the load comes to a stop
                break
            until *= 2.0
        times.append(until)
    return max(times)


def movers_of(setting: PreparedRun, measures: list[Measure], begin: Array) -> list[Mover]:
    """Return the prescribed travel of every load, as measured.

    Args:
        setting: the loads.
        measures: of each load.
        begin: (load,) m, the measures at the beginning.
    """
    loads, movers = setting.loads, []
    for k, measure in enumerate(measures):
        table = slice(loads.speed_first[k], loads.speed_first[k] + loads.speed_count[k])
        course = Travelled(loads.speed_time[table], loads.speed_value[table])
        speeds, place = loads.speed_value[table], float(begin[k])
        ahead = buffers(setting, measure, place, forward=True) if (speeds > 0.0).any() else np.inf
        behind = buffers(setting, measure, place, forward=False) if (speeds < 0.0).any() else np.inf
        least = _ARRIVED * float(setting.strands.links[measure.s] * setting.strands.h[measure.s])
        low, high = (way if way > least else 0.0 for way in (behind, ahead))
        movers.append(Mover(course.at, -low, high, course.settled, bool(loads.at_end[k] == REFUSE)))
    names = [wheel.load for wheel in setting.wheels]
    for k in np.flatnonzero(loads.at_end == STAY).tolist():  # it stops as a whole, when its first wheel is at the end
        own = [mover for mover, name in zip(movers, names, strict=True) if name == names[k]]
        movers[k] = movers[k]._replace(low=max(m.low for m in own), high=min(m.high for m in own))
    return movers
