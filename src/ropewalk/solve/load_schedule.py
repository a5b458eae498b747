"""When the loads of a slow motion are where: their paths over time, until the first of them comes to its end."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.moving_contact import look_up_integral
from ropewalk.model.axles import Axles
from ropewalk.model.history import SpeedTable
from ropewalk.model.load import Travelling
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.scenario import Scenario
from ropewalk.model.train import TrainSection
from ropewalk.model.travel import FreeTravel
from ropewalk.solve.path_measure import Measure, buffers
from ropewalk.solve.start import PreparedRun


def horizon(scenario: Scenario) -> float:
    """For how long callables are needed until a load has certainly passed its line, s (0 without callables)."""
    loads = [load for load in scenario.loads.values() if isinstance(load, Travelling | Pantograph)]
    loads = [load for load in loads if not isinstance(load.travel, FreeTravel)]
    if not any(callable(load.travel.speed) or callable(getattr(load, "force", None)) for load in loads):
        return 0.0
    times = []
    for load in loads:
        speed, until, gone = load.travel.speed, 1.0, -1.0
        line, overhead = scenario.lines.get(load.on), scenario.overhead_lines.get(load.on)
        length = max(line.length or 0.0, line.distance) if line is not None else overhead.length if overhead else 0.0
        reach = 3.0 * length + (
            load.length if isinstance(load, Axles | TrainSection) else 0.0
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
    return min(times)


def load_schedule(setting: PreparedRun, measures: list[Measure], begin: Array) -> tuple[Array, list[Array]]:
    """Times and paths of all loads until the first of them comes to the end of its line."""
    loads, count = setting.loads, setting.xi.size

    def path(k: int, times: Array) -> Array:
        first, n = loads.speed_first[k], loads.speed_count[k]
        tables = loads.speed_time, loads.speed_value, loads.speed_path
        return np.array([look_up_integral(*tables, first, n, t) for t in times])

    arrivals, changing = [], bool((loads.speed_count > 1).any())
    for k in range(count):
        table = slice(loads.speed_first[k], loads.speed_first[k] + loads.speed_count[k])
        speeds, last = loads.speed_value[table], float(loads.speed_value[table][-1])
        ahead = buffers(setting, measures[k], float(begin[k]), forward=True) if (speeds > 0.0).any() else np.inf
        behind = buffers(setting, measures[k], float(begin[k]), forward=False) if (speeds < 0.0).any() else np.inf
        if last == 0.0 and speeds.size == 1:
            continue
        horizon = max(float(loads.speed_time[table][-1]), 0.0)
        if last != 0.0:
            then = float(path(k, np.array([horizon]))[0])
            horizon += max((ahead - then) / last if last > 0.0 else (behind + then) / -last, 0.0)
        times = np.linspace(0.0, horizon, 20001 if speeds.size > 1 else 2)
        gone = path(k, times)
        off = np.maximum(gone / ahead, -gone / behind)
        i = int(np.argmax(off >= 1.0 - 1e-12)) if off.max() >= 1.0 - 1e-12 else times.size - 1
        arrivals.append(float(np.interp(1.0, off[i - 1 : i + 1], times[i - 1 : i + 1])))
    times = np.linspace(0.0, min(arrivals, default=0.0), 20001 if changing else 2)
    return times, [path(k, times) for k in range(count)]
