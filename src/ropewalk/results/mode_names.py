"""Modes of a structure, and names of their shapes: direction, half-waves, and the line that moves most."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ropewalk.results.frame import Array

_SMALL = 0.05  # of the largest displacement: smaller ones count for no half-wave
_CLEAR = 2.0 / 3.0  # share of the squared displacement from which on one direction names a mode
_APART = 5.0  # times the usual distance of nodes that follow one another: beyond, they are the rows of a net
_SAME = 1e-3  # of the length of the structure: nodes at one place along x


@dataclass(frozen=True, eq=False)
class Modes:
    """The lowest modes of a structure."""

    frequency: Array
    """(mode,) natural angular frequencies, rad/s, ascending."""
    ratio: Array
    """(mode,) damping ratios."""
    shape: Array = field(default_factory=lambda: np.zeros((0, 0, 3)))
    """(mode, node, 3) displacements in x, y, z; the largest is 1."""
    position: Array = field(default_factory=lambda: np.zeros((0, 3)))
    """(node, 3) m, at rest."""
    line: tuple[str, ...] = ()
    """Line or net of each node."""


def mode_names(modes: Modes) -> list[str]:
    """Name every mode by its shape, such as "vertical, 2 half-waves of deck".

    The direction holds at least two thirds of the squared displacement of all nodes: `axial` is along the lines,
    `lateral` level across them, `vertical` the remaining one; `torsional` is vertical in opposite directions at nodes
    next to each other. A half-wave lies between two changes of sign along the line that moves most. Shapes of nets are
    named by their direction only: `vertical`, or `level`.

    Args:
        modes: with shapes (mode, node, 3) and positions (node, 3) in m.
    """
    if not modes.shape.size:
        return [""] * len(modes.frequency)
    lines = np.array(modes.line)
    names = list(dict.fromkeys(modes.line))
    along, across, up = _directions(modes.position, lines, names)
    return [_name(shape, (along, across, up), lines, names, modes.position) for shape in modes.shape]


def _name(shape: Array, axes: tuple[Array, Array, Array], lines: Array, names: list[str], place: Array) -> str:
    parts = [(shape * axis).sum(axis=1) for axis in axes]
    share = np.array([(part**2).sum() for part in parts]) / max(float((shape**2).sum()), 1e-300)
    k = int(share.argmax())
    direction = ("axial", "lateral", "vertical")[k] if share[k] >= _CLEAR else "mixed directions"
    moving = max(names, key=lambda name: float((parts[k][lines == name] ** 2).sum()))
    if not _is_line(place[lines == moving]):
        return ("vertical" if direction == "vertical" else "level") + (f", {moving}" if len(names) > 1 else "")
    if direction == "vertical" and _is_torsional(parts[k], place, place[lines == moving]):
        direction = "torsional"
    count = _half_waves(parts[k][lines == moving])
    waves = f"{count} half-wave{'s' if count > 1 else ''}"
    return f"{direction}, {waves}" + (f" of {moving}" if len(names) > 1 else "")


def _directions(place: Array, lines: Array, names: list[str]) -> tuple[Array, Array, Array]:
    """Unit vectors (node, 3) along the lines, level across them, and across both; of a vertical line y is across."""
    along = np.zeros_like(place)
    for name in names:
        own = np.flatnonzero(lines == name)
        along[own] = np.gradient(place[own], axis=0) if _is_line(place[own]) else (1.0, 0.0, 0.0)
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.where(length > 0.0, along / np.where(length > 0.0, length, 1.0), (1.0, 0.0, 0.0))
    across = np.stack([-along[:, 1], along[:, 0], np.zeros(len(along))], axis=1)
    level = np.linalg.norm(across, axis=1, keepdims=True)
    across = np.where(level > 1e-9, across / np.where(level > 0.0, level, 1.0), (0.0, 1.0, 0.0))
    return along, across, np.cross(along, across)


def _is_line(place: Array) -> bool:
    """Whether nodes follow one another, as on a line; on a net the first node of a row is far from the one before."""
    steps = np.linalg.norm(np.diff(place, axis=0), axis=1)
    return steps.size > 0 and bool(steps.max() <= _APART * np.median(steps))


def _is_torsional(vertical: Array, place: Array, line: Array) -> bool:
    """Whether nodes at one place along a line move in opposite directions on both sides, more than together."""
    extent = float(np.ptp(place, axis=0).max())
    together, apart = 0.0, 0.0
    way = (line[-1] - line[0])[:2]
    level = float(np.hypot(*way))
    c, s = way / level if level > _SAME * extent else (1.0, 0.0)
    station, aside = np.round((c * place[:, 0] + s * place[:, 1]) / (_SAME * extent)), c * place[:, 1] - s * place[:, 0]
    for x in np.unique(station):
        own = np.flatnonzero(station == x)
        if np.ptp(aside[own]) > _SAME * extent:
            mean = vertical[own].mean()
            together += own.size * mean**2
            apart += float(((vertical[own] - mean) ** 2).sum())
    return apart > together


def _half_waves(values: Array) -> int:
    """Number of stretches of one sign, without those of hardly any displacement."""
    signs = np.sign(values[np.abs(values) > _SMALL * np.abs(values).max(initial=0.0)])
    return 1 + int(np.count_nonzero(np.diff(signs)))
