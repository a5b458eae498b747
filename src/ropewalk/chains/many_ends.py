"""Ends that yield or move, at many instants at once: their energies, and what supports bear."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.results.frames import summed
from ropewalk.solve.ends import Ends
from ropewalk.solve.start import PreparedRun


def energies_of_ends(ends: Ends, t: Array, r: Array, w: Array) -> tuple[Array, Array, Array]:
    """Kinetic, elastic and gravitational energies of what yields or moves with ends, (instant,) J.

    Args:
        ends: they.
        t: (instant,) s.
        r, w: (instant, axis, node) m, m/s.
    """
    at, v = r[:, :, ends.node].swapaxes(1, 2), w[:, :, ends.node].swapaxes(1, 2)
    moved = at - places_of(ends, t)
    elastic = 0.5 * summed(moved[..., None] * ends.stiffness * moved[:, :, None])
    return 0.5 * summed(ends.mass[:, None] * v * v), elastic, -summed(ends.force * at)


def places_of(ends: Ends, t: Array) -> Array:
    """Where supports stand, (instant, end, axis) m."""
    out = np.empty((t.size, *ends.place.shape))
    for e, place in enumerate(ends.place):
        table = slice(ends.motion_first[e], ends.motion_first[e] + ends.motion_count[e])
        for a, row in enumerate(ends.motion_value):
            out[:, e, a] = place[a] + np.interp(t, ends.motion_time[table], row[table])
    return out


def _rates(ends: Ends, e: int, t: Array) -> Array:
    """Velocities of the table of an end just after times in s, (instant, axis) m/s."""
    table = slice(ends.motion_first[e], ends.motion_first[e] + ends.motion_count[e])
    times, values = ends.motion_time[table], ends.motion_value[:, table]
    slopes = np.zeros((times.size + 1, len(values)))  # before, between and after the entries
    slopes[1:-1] = (np.diff(values, axis=1) / np.diff(times)).T
    return np.asarray(slopes[np.searchsorted(times, t, side="right")])


def let_yield(setting: PreparedRun, ends: Ends, t: Array, X: Array, r: Array, w: Array, reaction: Array) -> None:
    """Make reactions (instant, support, axis) of points that do not move those of supports that yield or move.

    On half a link at the end act the line, the loads there, and the reaction; the latter is all that the line knows of
    spring, damper, rail and mass.

    Args:
        setting, ends: the lines.
        t, X, r, w: (instant, ...) as of the chain.
        reaction: changed in place, N.
    """
    strands, supports, places = setting.strands, setting.supports, places_of(ends, t)
    for e, number in enumerate(ends.number.tolist()):
        i, s, link = int(ends.node[e]), number // 2, int(ends.link[e])
        v = w[:, :, i]
        drag = strands.drag[s] * ends.half[e] * v
        # Beside a load, the link that the end carries half of is not uniform.
        uneven = 0.5 * strands.rho[s] * (X[:, link + 1] - X[:, link]) - ends.half[e]
        reaction[:, number] += drag - uneven[:, None] * strands.gravity
        if ends.free[e]:
            given = ends.force[e] + _turned(ends.stiffness[e], places[:, e] - r[:, :, i])
            given += _turned(supports.damping[number], _rates(ends, e, t) - v)
            push = _turned(supports.free[number], given - reaction[:, number])
            reaction[:, number] += ends.half[e] / ends.mass[e] * push


def _turned(matrix: Array, vectors: Array) -> Array:
    """A matrix times vectors (instant, axis)."""
    out = np.zeros_like(vectors)
    for a in range(vectors.shape[1]):
        out += matrix[:, a] * vectors[:, a, None]
    return out
