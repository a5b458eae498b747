"""From declarations to plain arrays: strands from lines, loads from loads, tables from histories."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.chain import (
    ARC,
    CLAMPED,
    FRICTIONLESS,
    HORIZONTAL,
    LEAVE,
    MATERIAL,
    REFUSE,
    SLIP,
    STAY,
    Array,
    Loads,
    Strands,
)
from ropewalk.mechanics.law import CUBIC, NO_FLOOR, SERIES, TABLE
from ropewalk.model.history import ForceTable, SpeedTable
from ropewalk.model.law import Hooke, Law, Polynomial, SecondPiolaKirchhoff, Tabulated, TensionOnly
from ropewalk.model.line import spatial
from ropewalk.model.scenario import Scenario

_MEASURES = {"material": MATERIAL, "slip": SLIP, "arc": ARC, "horizontal": HORIZONTAL}
_CONTACTS = {"clamped": CLAMPED, "frictionless": FRICTIONLESS}
_ENDS = {"refuse": REFUSE, "leave": LEAVE, "stay": STAY}


def pack(law: Law, axial_stiffness: float | None) -> Array:
    """Write a declared law as the array that the kernels read, see law.py."""
    if isinstance(law, Tabulated):
        return np.array([TABLE, len(law.strain), *law.strain, *law.tension], dtype=float)
    if isinstance(law, Polynomial):
        c = law.coefficients
        if len(c) <= 3:
            return np.array([CUBIC, NO_FLOOR, *c, *(0.0,) * (3 - len(c))])
        return np.array([SERIES, len(c), *c], dtype=float)
    if axial_stiffness is None:
        raise ValueError(f"law {law.kind} needs an axial stiffness")
    if isinstance(law, Hooke):
        return np.array([CUBIC, NO_FLOOR, axial_stiffness, 0.0, 0.0])
    if isinstance(law, TensionOnly):
        return np.array([CUBIC, 0.0, axial_stiffness, 0.0, 0.0])
    if isinstance(law, SecondPiolaKirchhoff):
        return np.array([CUBIC, NO_FLOOR, axial_stiffness, axial_stiffness, 0.0])
    raise TypeError(f"unknown law {law!r}")


def axes_of(scenario: Scenario) -> tuple[str, ...]:
    """Names of the axes that the scenario needs: x and z in the plane, else x, y and z."""
    return ("x", "z") if scenario.is_plane else ("x", "y", "z")


def components(vector: tuple[float, ...], axes: tuple[str, ...]) -> Array:
    """The components of a declared point or vector along the axes."""
    x, y, z = spatial(vector)
    return np.array([x, z] if len(axes) == 2 else [x, y, z])


def strands_of(scenario: Scenario, lengths: Mapping[str, float]) -> Strands:
    """All lines of a scenario as strands, with their unstrained lengths in m by name."""
    lines, axes = scenario.lines, axes_of(scenario)
    links = np.array([line.elements for line in lines.values()])
    laws = [pack(line.law, line.axial_stiffness) for line in lines.values()]
    width = max(p.size for p in laws)
    gravity = np.zeros(len(axes))
    gravity[-1] = -scenario.gravity
    return Strands(
        first=np.concatenate(([0], np.cumsum(links + 1)[:-1])),
        links=links,
        h=np.array([lengths[name] / line.elements for name, line in lines.items()]),
        rho=np.array([line.mass for line in lines.values()]),
        law=np.array([np.pad(p, (0, width - p.size)) for p in laws]),
        damping=np.array([line.axial_damping for line in lines.values()]),
        drag=np.array([line.drag for line in lines.values()]),
        gravity=gravity,
    )


def tabulate(
    function: Callable[[float], Any], begin: float, end: float, tolerance: float = 1e-6
) -> tuple[Array, NDArray[np.float64]]:
    """Sample a callable of time so that linear interpolation is good to `tolerance` of its largest value.

    Args:
        function: f(t) -> float or sequence of floats, t in s.
        begin, end: interval, s.

    Returns:
        Times (n,) and values (n,) or (n, component).

    Raises:
        ValueError: the callable gives something that is not finite.
    """

    def value(t: float) -> NDArray[np.float64]:
        out = np.asarray(function(t), dtype=float)
        if not np.all(np.isfinite(out)):
            raise ValueError(f"the callable gives {out} at t = {t:g} s: it must give finite numbers")
        return out

    grid = np.linspace(begin, end, 257)
    samples = {float(t): value(float(t)) for t in grid}
    scale = max(float(np.abs(v).max()) for v in samples.values())
    stack = [(float(a), float(b), 0) for a, b in pairwise(grid)]
    while stack:
        a, b, depth = stack.pop()
        middle = 0.5 * (a + b)
        samples[middle] = value(middle)
        miss = float(np.abs(samples[middle] - 0.5 * (samples[a] + samples[b])).max())
        if miss > tolerance * scale and depth < 14:
            stack += [(a, middle, depth + 1), (middle, b, depth + 1)]
    times = np.array(sorted(samples))
    return times, np.array([samples[t] for t in times])


def _speed_table(speed: Any, until: float) -> tuple[Array, Array]:
    if isinstance(speed, SpeedTable):
        return np.array(speed.time), np.array(speed.value)
    if callable(speed):
        return tabulate(speed, 0.0, until)
    return np.zeros(1), np.array([float(speed)])


def _force_table(force: Any, until: float, axes: tuple[str, ...]) -> tuple[Array, NDArray[np.float64]]:
    """Times (n,) and values (axis, n)."""
    if isinstance(force, ForceTable):
        times, rows = np.array(force.time), force.value
    elif callable(force):
        times, samples = tabulate(force, 0.0, until)
        rows = tuple(tuple(row) for row in samples)
    else:
        times, rows = np.zeros(1), (force,)
    return times, np.array([components(row, axes) for row in rows]).T


def _integral_from_zero(times: Array, values: Array) -> Array:
    """The integral of a table (linear between, constant outside its entries) from time 0 to each entry."""
    path: Array = np.concatenate(([0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(times))))
    if times[0] >= 0.0:
        return np.asarray(path + values[0] * times[0])
    if times[-1] <= 0.0:
        return np.asarray(path - path[-1] + values[-1] * times[-1])
    i = int(np.searchsorted(times, 0.0, side="right")) - 1
    at_zero = np.interp(0.0, times, values)
    return np.asarray(path - (path[i] + 0.5 * (values[i] + at_zero) * -times[i]))


def loads_of(scenario: Scenario, until: float) -> Loads:
    """All loads of a scenario, with their histories tabulated up to the time `until`."""
    names, axes = list(scenario.lines), axes_of(scenario)
    loads = list(scenario.loads.values())
    speeds = [_speed_table(load.travel.speed, until) for load in loads]
    forces = [_force_table(load.force, until, axes) for load in loads]

    def first(tables: list[Any]) -> NDArray[np.int64]:
        return np.cumsum([0, *(t.size for t, _ in tables)])[:-1].astype(np.int64)

    def count(tables: list[Any]) -> NDArray[np.int64]:
        return np.array([t.size for t, _ in tables], dtype=np.int64)

    def codes(values: list[int]) -> NDArray[np.int64]:
        return np.array(values, dtype=np.int64)

    none = np.zeros(0)
    return Loads(
        strand=codes([names.index(load.on) for load in loads]),
        measure=codes([_MEASURES[load.travel.measured] for load in loads]),
        contact=codes([_CONTACTS[load.contact] for load in loads]),
        at_end=codes([_ENDS[load.travel.at_end] for load in loads]),
        speed_first=first(speeds),
        speed_count=count(speeds),
        speed_time=np.concatenate([none, *(t for t, _ in speeds)]),
        speed_value=np.concatenate([none, *(v for _, v in speeds)]),
        speed_path=np.concatenate([none, *(_integral_from_zero(t, v) for t, v in speeds)]),
        force_first=first(forces),
        force_count=count(forces),
        force_time=np.concatenate([none, *(t for t, _ in forces)]),
        force_value=np.concatenate([np.zeros((len(axes), 0)), *(v for _, v in forces)], axis=1),
    )
