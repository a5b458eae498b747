"""From declarations to plain arrays: strands from lines, loads from loads, tables from histories."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.chain import (
    ARC,
    BLOCK,
    CAPSTAN,
    CLAMPED,
    COULOMB,
    DRAGGED,
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
    Supports,
)
from ropewalk.mechanics.contact_points import ContactPoint
from ropewalk.mechanics.footfall import Footfall
from ropewalk.mechanics.law import CUBIC, NO_FLOOR, RIGID, SERIES, TABLE
from ropewalk.mechanics.travelled import Travelled
from ropewalk.model.history import DisplacementTable, DriveTable, ForceTable, SpeedTable
from ropewalk.model.law import (
    Hooke,
    Inextensible,
    Law,
    Polynomial,
    SecondPiolaKirchhoff,
    Tabulated,
    TensionOnly,
    Webbing,
)
from ropewalk.model.line import spatial
from ropewalk.model.scenario import Scenario
from ropewalk.model.support import Elastic, Guided, Support

_MEASURES = {"material": MATERIAL, "slip": SLIP, "arc": ARC, "horizontal": HORIZONTAL}
_CONTACTS = {"clamped": CLAMPED, "frictionless": FRICTIONLESS, "coulomb": COULOMB, "dragged": DRAGGED}
_FRICTION_MODELS = {"capstan": CAPSTAN, "block": BLOCK}
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
    if isinstance(law, Webbing):
        return np.array([CUBIC, 0.0, law.axial_stiffness, 0.0, 0.0])
    if isinstance(law, Inextensible):
        return np.array([RIGID, 0.0, 0.0, 0.0, 0.0])
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
        drag=np.array([line.alpha for line in lines.values()]),
        gravity=gravity,
    )


def tabulate(function: Callable[[float], Any], end: float) -> tuple[Array, NDArray[np.float64]]:
    """Sample a callable of time so that linear interpolation is good to 1e-6 of its largest value.

    Args:
        function: f(t) -> float or sequence of floats, t in s.
        end: of the interval from 0, s.

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

    grid = np.linspace(0.0, end, 257)
    samples = {float(t): value(float(t)) for t in grid}
    scale = max(float(np.abs(v).max()) for v in samples.values())
    stack = [(float(a), float(b), 0) for a, b in pairwise(grid)]
    while stack:
        a, b, depth = stack.pop()
        middle = 0.5 * (a + b)
        samples[middle] = value(middle)
        miss = float(np.abs(samples[middle] - 0.5 * (samples[a] + samples[b])).max())
        if miss > 1e-6 * scale and depth < 14:
            stack += [(a, middle, depth + 1), (middle, b, depth + 1)]
    times = np.array(sorted(samples))
    return times, np.array([samples[t] for t in times])


def speed_table(speed: Any, until: float) -> tuple[Array, Array]:
    """Times (n,) and values (n,) of a speed in m/s, up to the time `until`."""
    if isinstance(speed, SpeedTable):
        return np.array(speed.time), np.array(speed.value)
    if callable(speed):
        return tabulate(speed, until)
    return np.zeros(1), np.array([float(speed)])


def vector_table(history: Any, until: float, axes: tuple[str, ...]) -> tuple[Array, NDArray[np.float64]]:
    """Times (n,) and values (axis, n) of forces or displacements."""
    if isinstance(history, ForceTable | DisplacementTable):
        times, rows = np.array(history.time), history.value
    elif isinstance(history, Footfall):
        times = history.instants(until)
        force = history(times)
        parts = {"x": force[:, 0], "y": force[:, 1] if force.shape[1] == 3 else np.zeros(times.size), "z": force[:, -1]}
        return times, np.array([parts[axis] for axis in axes])
    elif callable(history):
        times, samples = tabulate(history, until)
        rows = tuple(tuple(row) for row in samples)
    else:
        times, rows = np.zeros(1), (history,)
    return times, np.array([components(row, axes) for row in rows]).T


def drive_table(drive: Any, until: float) -> tuple[Array, Array]:
    """Times (n,) and values (n,) of a drive in N, up to the time `until`."""
    if isinstance(drive, DriveTable):
        return np.array(drive.time), np.array(drive.value)
    if callable(drive):
        return tabulate(drive, until)
    return np.zeros(1), np.array([float(drive)])


def loads_of(
    scenario: Scenario, wheels: Sequence[ContactPoint], until: float, axes: tuple[str, ...] | None = None
) -> Loads:
    """All wheels of a scenario, with their histories tabulated up to the time `until`.

    Args:
        axes: names of the axes, if not those that the scenario needs.
    """
    names, axes = list(scenario.lines), axes or axes_of(scenario)
    speeds = [speed_table(wheel.speed, until) for wheel in wheels]
    forces = [vector_table(wheel.force, until, axes) for wheel in wheels]

    def codes(values: list[int]) -> NDArray[np.int64]:
        return np.array(values, dtype=np.int64)

    none = np.zeros(0)
    return Loads(
        strand=codes([names.index(wheel.on) if wheel.on in names else -1 for wheel in wheels]),
        measure=codes([_MEASURES[wheel.measured] for wheel in wheels]),
        contact=codes([_CONTACTS[wheel.contact] for wheel in wheels]),
        at_end=codes([_ENDS[wheel.at_end] for wheel in wheels]),
        margin=np.array([wheel.margin or 0.0 for wheel in wheels]),
        speed_first=_first(speeds),
        speed_count=_count(speeds),
        speed_time=np.concatenate([none, *(t for t, _ in speeds)]),
        speed_value=np.concatenate([none, *(v for _, v in speeds)]),
        speed_path=np.concatenate([none, *(Travelled(t, v).path for t, v in speeds)]),
        force_first=_first(forces),
        force_count=_count(forces),
        force_time=np.concatenate([none, *(t for t, _ in forces)]),
        force_value=np.concatenate([np.zeros((len(axes), 0)), *(v for _, v in forces)], axis=1),
        friction=np.array([np.nan if wheel.friction is None else wheel.friction for wheel in wheels], dtype=float),
        friction_model=codes([_FRICTION_MODELS[wheel.friction_model] for wheel in wheels]),
    )


def supports_of(scenario: Scenario, until: float) -> Supports:
    """What holds the ends of all lines, with histories tabulated up to the time `until`."""
    axes = axes_of(scenario)
    dim = len(axes)
    ends = [
        (point, support)
        for line in scenario.lines.values()
        for point, support in ((line.start, line.start_support), (line.end, line.end_support))
    ]
    restrained = [restrained_by(support, axes) for _, support in ends]
    motions = [vector_table(getattr(support, "displacement", (0.0, 0.0)), until, axes) for _, support in ends]
    return Supports(
        place=np.array([components(point, axes) for point, _ in ends]),
        free=np.array([free for free, *_ in restrained]).reshape(-1, dim, dim),
        stiffness=np.array([stiffness for _, stiffness, *_ in restrained]).reshape(-1, dim, dim),
        damping=np.array([damping for *_, damping, _ in restrained]).reshape(-1, dim, dim),
        mass=np.array([getattr(support, "mass", 0.0) for _, support in ends]),
        force=np.array([force for *_, force in restrained]).reshape(-1, dim),
        motion_first=_first(motions),
        motion_count=_count(motions),
        motion_time=np.concatenate([t for t, _ in motions]),
        motion_value=np.concatenate([v for _, v in motions], axis=1),
    )


def restrained_by(support: Support, axes: tuple[str, ...]) -> tuple[Array, Array, Array, Array]:
    """Free directions, stiffness and damping (axis, axis) and constant force (axis,) of a support."""
    dim = len(axes)
    if isinstance(support, Elastic):
        stiffness, damping = (
            np.diag(components(value, axes)) if isinstance(value, tuple) else value * np.eye(dim)
            for value in (support.stiffness, support.damping)
        )
        return np.eye(dim), stiffness, damping, np.zeros(dim)
    if isinstance(support, Guided):
        along = components(support.along, axes)
        along = along / np.linalg.norm(along)
        rail = np.outer(along, along)
        return rail, support.stiffness * rail, support.damping * rail, support.force * along
    return np.zeros((dim, dim)), np.zeros((dim, dim)), np.zeros((dim, dim)), np.zeros(dim)


def _first(tables: list[tuple[Array, Array]]) -> NDArray[np.int64]:
    """Where each of several tables begins when they are put one after the other."""
    return np.cumsum([0, *(t.size for t, _ in tables)])[:-1].astype(np.int64)


def _count(tables: list[tuple[Array, Array]]) -> NDArray[np.int64]:
    return np.array([t.size for t, _ in tables], dtype=np.int64)
