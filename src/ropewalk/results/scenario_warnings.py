"""Warnings that follow from a scenario and its steps, without frames: pantographs, sudden wind, explicit steps."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.model.history import SpeedTable
from ropewalk.model.overhead import stations_of
from ropewalk.model.pantograph import Pantograph
from ropewalk.results.frame import RunInfo

if TYPE_CHECKING:
    from ropewalk.model import Scenario

_BREEZE = 1e-3  # of the weight per length: a smaller force of wind per length hardly moves a line
_LEAD = 0.1  # rad, by which the computed vibration may lead the exact one
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


def phase_warnings(scenario: Scenario, run_info: RunInfo) -> Iterator[str]:
    """Warn of lines whose vibration on the foundation an explicit method computes with a phase error.

    Stoermer's method has the frequency w (1 + (w h)^2/24) for w, which is at least that of a rigid line on its
    foundation, sqrt(k/m). Damping ends the vibration, and with it the growth of the error.

    Args:
        scenario: of the run.
        run_info: with its method and step.
    """
    run, h = scenario.run, run_info.step
    if run.kind != "dynamic" or run_info.method != "explicit" or not h:
        return
    for name, line in scenario.lines.items():
        if not line.foundation:
            continue
        w = math.sqrt(line.foundation / line.mass)
        lasts, rate = run.until, 0.5 * (line.alpha + line.beta * w**2)
        if rate > 0.0:
            lasts = min(lasts, 1.0 / rate)
        lead = w * lasts * (w * h) ** 2 / 24.0
        if lead > _LEAD:
            enough = 0.9 * h * math.sqrt(_LEAD / lead)
            yield (
                f"line {name}: vibration on its foundation at {w / (2.0 * math.pi):.3g} Hz and more is computed with a "
                f"phase error of {lead:.2g} rad in steps of {h:.3g} s, and contact and support forces with it; "
                f"write run.step: {enough:.2g} s or less"
            )
