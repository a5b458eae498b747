"""From the declared supports of a line to what holds its wire, at its ends and between them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.mechanics.assembly import restrained_by, vector_table
from ropewalk.mechanics.restrained_points import supports_of
from ropewalk.model.inner_support import InnerSupport
from ropewalk.model.line import Line, spatial
from ropewalk.model.support import Elastic, Fixed, Guided, Moving, Support
from ropewalk.wires.plan import Array, EndKind, Hold, PointMass, Spot, Three, Wire, WireDisplacement

_AXES = ("x", "y", "z")
_ALONG = 1e-12  # of an axis: a rail that is less off it goes along it


def kinds_of(line: Line) -> tuple[EndKind, EndKind]:
    """How the two ends of a line are held."""
    return _kind(line.start_support), _kind(line.end_support)


def _kind(support: Support) -> EndKind:
    if isinstance(support, Fixed):
        return "clamped" if support.clamped else "pinned"
    return "free"


def holds_of(line: Line, wire: Wire, number: int, until: float) -> Iterator[Hold]:
    """What holds a line between its ends, and its ends where they are not fixed.

    Args:
        line: as it is declared.
        wire: that it has become, and its number.
        until: how long displacements are needed, s.
    """
    for side, point, support, station in supports_of(line, wire.length):
        if isinstance(support, Fixed) and side in ("start", "end"):
            continue
        axes, stiffness, damping, force = _springs(support)
        time, moved = vector_table(getattr(support, "displacement", (0.0, 0.0)), until, _AXES)
        yield Hold(
            f"{wire.name}.{side}", Spot(number, station), _three(stiffness), _three(damping), point,
            _three(force), (_three(axes[0]), _three(axes[1]), _three(axes[2])), WireDisplacement(time, moved),
        )  # fmt: skip


def masses_of(line: Line, wire: Wire, number: int) -> Iterator[PointMass]:
    """What moves with a line at its supports."""
    for _, _, support, station in supports_of(line, wire.length):
        mass = getattr(support, "mass", 0.0)
        if mass:
            yield PointMass(Spot(number, station), mass)


def compliance(line: Line) -> float:
    """By how much the supports of a straight line give way along it, m/N."""
    way, found = np.subtract(spatial(line.end), spatial(line.start)) / line.distance, 0.0
    for support in (line.start_support, line.end_support):
        if not isinstance(support, Fixed | Moving):
            axes, stiffness, _, _ = _springs(support)
            free = np.isfinite(stiffness) & (stiffness > 0.0)
            found += float(((axes[free] @ way) ** 2 / stiffness[free]).sum())
    return found


def lengthened(line: Line) -> float:
    """By how much farther the supports of a line are from each other at time zero than it is declared, m."""
    way, found = np.subtract(spatial(line.end), spatial(line.start)) / line.distance, 0.0
    for sign, support in ((-1.0, line.start_support), (1.0, line.end_support)):
        time, moved = vector_table(getattr(support, "displacement", (0.0, 0.0)), 0.0, _AXES)
        found += sign * float(way @ [np.interp(0.0, time, row) for row in moved])
    return found


def _springs(support: Support | InnerSupport) -> tuple[Array, Array, Array, Array]:
    """Axes (3, 3) of its springs, their stiffnesses and dampings, and a constant force; wires stay in the x-z plane."""
    free, _, _, force = restrained_by(support, _AXES)
    axes, stiffness, damping = np.eye(3), np.full(3, np.inf), np.zeros(3)
    if isinstance(support, Guided):
        along = np.linalg.eigh(free)[1][:, -1]
        if np.abs(along).max() < 1.0 - _ALONG:
            axes = np.array([along, [0.0, 1.0, 0.0], [-along[2], 0.0, along[0]]])
        slides = int(np.argmax(np.abs(axes @ along)))
        stiffness[slides], damping[slides] = support.stiffness, support.damping
    if isinstance(support, Elastic):
        for values, given in ((stiffness, support.stiffness), (damping, support.damping)):
            aside = np.inf if values is stiffness else 0.0
            values[:] = (given[0], aside, given[-1]) if isinstance(given, tuple) else given
    return axes, stiffness, damping, force


def _three(values: Array) -> Three:
    x, y, z = (float(value) for value in values)
    return x, y, z
