"""Wind that acts suddenly at t = 0 on lines in equilibrium in calm air."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.model.history import SpeedTable

if TYPE_CHECKING:
    from ropewalk.model import Scenario

_BREEZE = 1e-3  # of the weight per length: a smaller force of wind per length hardly moves a line


def blows_at_once(scenario: Scenario) -> Iterator[str]:
    """Yield a warning where wind acts at t = 0 on what begins in equilibrium in calm air."""
    run, wind = scenario.run, scenario.wind
    if wind is None or run.kind not in ("dynamic", "linear"):
        return
    remedy = "write kind: dynamic with start: {in_wind: true}, or let "
    if run.kind == "dynamic":
        if run.start.in_wind or run.start.kind == "result":
            return
        remedy = "let " if run.start.kind == "mode" else "write run.start: {in_wind: true}, or let "
    speed = wind.speed(0.0) if callable(wind.speed) else wind.speed
    first = float(np.interp(0.0, speed.time, speed.value)) if isinstance(speed, SpeedTable) else speed
    if first != 0.0 and _felt(scenario, 0.5 * wind.air_density * first**2):
        yield (
            f"the wind of {first:.4g} m/s acts suddenly at t = 0 on lines that begin in equilibrium in calm air: the "
            f"transient that follows is part of the result; {remedy}wind.speed grow from 0 in a table {{time, value}}"
        )


def _felt(scenario: Scenario, pressure: float) -> bool:
    """Return whether wind of a pressure in N/m^2 acts on a line, or on a load in equilibrium with its line."""
    run = scenario.run
    with_loads = run.kind == "dynamic" and run.start.with_loads
    return (with_loads and scenario.parts.is_airy) or any(
        line.wind_drag * pressure > _BREEZE * line.mass * scenario.gravity for line in scenario.lines.values()
    )
