"""Magnitudes: finite numbers with which no motion can be computed, because time steps would be countless or vanish.

The bounds lie orders of magnitude beyond any structure: what they meet is a wrong unit or exponent.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from ropewalk.errors import Problem, ScenarioError
from ropewalk.model._base import Finding
from ropewalk.model.line import Line
from ropewalk.model.overhead_wire import OverheadWire
from ropewalk.model.parts import Parts
from ropewalk.model.run import Dynamic, Linear

LONGEST = 1e9  # m, beyond the moon
LEAST_MASS = 1e-9  # kg/m, a thousandth of a spider's thread
_LIGHT = 1e-3  # kg/m, below which a mass is the more likely mistake
FASTEST_WAVE = 1e8  # m/s, a third of the speed of light; in diamond it is 18 km/s
MOST_CRITICAL, LONGEST_RELAXATION = 1e3, 100.0  # times critical damping, and s: both, of Kelvin-Voigt damping
FASTEST_DECAY, LONGEST_RETARDATION = 1e9, 1e6  # 1/s and s
MOST_STRAIN = 1e3  # of a tension that is given; rubber bears 10
MOST_STEPS = 1e13  # a year of computing
EXTREME, MINUTE = 1e15, 1e-8  # magnitudes in SI of numbers that are suspect where something cannot be computed


def check_magnitudes(parts: Parts) -> Iterator[Finding]:
    """Find masses, stiffnesses, damping and times that no motion can be computed with."""
    fastest = 0.0
    for name, line in parts.lines.items():
        if line is not None:
            found = [Finding(("lines", name, key), *problem) for key, *problem in _of_line(line, parts)]
            fastest = max(fastest, 0.0 if found else _steps_per_second(line))
            yield from found
    for name, overhead in parts.overhead.items():
        for wire in ("contact_wire", "messenger_wire") if overhead is not None else ():
            if (declared := getattr(overhead, wire, None)) is not None:
                for key, *problem in (*_of_damping(declared), *_of_tension(declared)):
                    yield Finding(("overhead_lines", name, wire, key), *problem)
    if isinstance(parts.run, Dynamic) and (steps := parts.run.until * fastest) > MOST_STEPS:
        wrong = f"the motion would take about {steps:.1e} steps, of the time that a wave takes through a link"
        remedy = f"write at most {MOST_STEPS / fastest:.1e} s, or check the units of mass, axial_stiffness and length"
        yield Finding(("run", "until"), wrong, f"{parts.run.until:g} s", remedy)


def _of_line(line: Line, parts: Parts) -> Iterator[tuple[str, str, str, str]]:
    """Problems of a line: key, problem, value, remedy."""
    yield from _of_tension(line)
    if line.length is not None and line.length > LONGEST:
        yield "length", "is longer than any line", f"{line.length:g} m", f"check its unit; write at most {LONGEST:g} m"
        return
    if not isinstance(parts.run, Dynamic | Linear):
        return
    if line.mass < LEAST_MASS and not line.axial_stiffness:
        wrong, remedy = "is lighter than any line", f"check its unit; write at least {LEAST_MASS:g} kg/m"
        yield "mass", wrong, f"{line.mass:g} kg/m", remedy
        return
    yield from _of_damping(line)
    if not line.axial_stiffness:
        return
    if (speed := _wave_speed(line)) > FASTEST_WAVE:
        wrong = f"waves would travel along the line at {speed:.1e} m/s, faster than in any material (20 km/s)"
        mass, stiffness = f"{line.mass:g} kg/m", f"{line.axial_stiffness:g} N"
        if line.mass < _LIGHT:
            yield "mass", wrong, mass, f"check its unit and that of axial_stiffness ({stiffness})"
        else:
            yield "axial_stiffness", wrong, stiffness, f"check its unit and that of mass ({mass})"
        return
    critical = 2.0 * (line.length or line.distance) * math.sqrt(line.axial_stiffness * line.mass) / math.pi
    relaxation = line.axial_damping / line.axial_stiffness
    if line.axial_damping > MOST_CRITICAL * critical and relaxation > LONGEST_RELAXATION:
        wrong = f"is {line.axial_damping / critical:.1e} times the critical damping of its slowest axial vibration"
        most = max(MOST_CRITICAL * critical, LONGEST_RELAXATION * line.axial_stiffness)
        remedy = f"check its unit; critical are {critical:.3g} N*s, write at most {most:.3g} N*s"
        yield "axial_damping", wrong, f"{line.axial_damping:g} N*s", remedy


def _of_damping(line: Line | OverheadWire) -> Iterator[tuple[str, str, str, str]]:
    if line.drag > FASTEST_DECAY:
        remedy = f"write at most {FASTEST_DECAY:g} 1/s: beyond, nothing moves"
        yield "drag", "stops every motion at once", f"{line.drag:g} 1/s", remedy
    if line.retardation > LONGEST_RETARDATION:
        remedy = f"write at most {LONGEST_RETARDATION:g} s: beyond, nothing moves"
        yield "retardation", "stops every motion at once", f"{line.retardation:g} s", remedy


def _of_tension(line: Line | OverheadWire) -> Iterator[tuple[str, str, str, str]]:
    if line.tension and line.axial_stiffness and line.tension > MOST_STRAIN * line.axial_stiffness:
        wrong = f"is so low that the tension of {line.tension:g} N makes it {MOST_STRAIN:g} times as long or more"
        yield "axial_stiffness", wrong, f"{line.axial_stiffness:g} N", "check its unit and that of tension"


def _wave_speed(line: Line) -> float:
    return math.sqrt((line.axial_stiffness or 0.0) / line.mass)


def _steps_per_second(line: Line) -> float:
    length = line.length or line.distance
    return _wave_speed(line) * line.elements / length if length else 0.0


def check_steps(until: float, step: float | None) -> None:
    """Refuse a motion whose step is so short that it would never end.

    Args:
        until: its end, s.
        step: that its engine has chosen, s; None where the method finds its length on the way.

    Raises:
        ScenarioError: it would take more than 1e13 steps.
    """
    if step is None or step * MOST_STEPS > until:
        return
    count = f"{until / step:.1e}" if step > 0.0 else "countless"
    wrong = f"the motion would take {count} steps of {step:.1e} s"
    remedy = "check the units of masses, stiffnesses and damping, or lower run.until"
    raise ScenarioError([Problem("run.until", wrong, f"{until:g} s", remedy)])


def extremes(tree: Any, key: str = "") -> Iterator[tuple[str, float]]:
    """Yield the keys and values of numbers of a scenario (as plain values) that are extreme in SI units."""
    if isinstance(tree, dict):
        for name, part in tree.items():
            yield from extremes(part, f"{key}.{name}" if key else str(name))
    elif isinstance(tree, list | tuple):
        for number, part in enumerate(tree):
            yield from extremes(part, f"{key}[{number}]")
    elif isinstance(tree, float) and tree and not MINUTE < abs(tree) < EXTREME:
        yield key, tree


def not_computable(tree: Any, error: Exception) -> ScenarioError | None:
    """Return the refusal of a scenario (as plain values) whose extreme numbers have made its set-up fail, if any are.

    Args:
        tree: the scenario.
        error: of arithmetic.
    """
    remedy = "check its unit and exponent"
    wrong = f"makes numbers too large or too small to compute with ({error})"
    found = [Problem(key, wrong, f"{value:g} in SI units", remedy) for key, value in extremes(tree)]
    return ScenarioError(found) if found else None
