"""Ties of wires in the plane or in space, as springs between splines, and between splines and the ground."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.compiled import inlined
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.moving_loads import DAMPED
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.rest import ROUNDING, rows, ties_springs
from ropewalk.wires.spline import WIDTH

_SHARES = tuple(np.uint64(k) for k in range(WIDTH))


class LinkSprings(NamedTuple):
    """Ties in space."""

    one: Integers  # (spring,) first node of the one end, and of the other
    other: Integers
    weight: Array  # (spring, 2, WIDTH) of both ends
    place: Array  # (spring, 3) m, of the ground; where the other end is on a wire NaN, and how much farther aside
    aside: Array  # (spring,) m sideways from the one end to the other, in the plane
    length: Array  # m unstrained
    pull: Array  # N/m
    push: Array  # N/m
    damping: Array  # N s/m
    last: Array  # (spring,) m, length a step ago
    rate: Array  # (spring,) m/s at which that changed, while it damped
    strength: Array  # N, that tears it
    fails_at: Array  # s
    failed: Array  # (spring, 2) when it did, s, and under which force, N; infinite: it has not
    rest: Array  # N at rest, which what is recorded is counted from
    steady: Array  # (spring, 2) N on the one end at rest, sideways and upwards: put on all the time, and not as pushes
    slow: Integers  # springs that push once a step; they stand across the wires
    fast: Integers  # springs along the wires, which go with the wires' own steps; nothing of theirs is steady


def link_springs_of(mesh: Mesh, position: Array) -> LinkSprings:
    """All ties, at rest at positions (3, node) m."""
    ties = mesh.ties
    pull, push = ties_springs(mesh)
    away = (rows(ties.other, mesh.nodes) - rows(ties.one, mesh.nodes)) @ position.T
    away += np.where(np.isfinite(ties.ground), ties.ground, 0.0)
    last = np.sqrt((away**2).sum(axis=1))
    longer = last - ties.length
    rest = np.where(longer > 0.0, pull, push) * longer
    pulls = np.where(ties.lengthwise, 0.0, rest / last)
    return LinkSprings(
        ties.one.base, ties.other.base, np.stack([ties.one.weight, ties.other.weight], axis=1), ties.ground,
        away[:, 1].copy(), ties.length, pull, push, ties.damping, last, np.zeros_like(last),
        ties.strength, ties.fails_at * (1.0 - ROUNDING), np.full((last.size, 2), np.inf), rest,
        pulls[:, None] * away[:, 1:], np.flatnonzero(~ties.lengthwise), np.flatnonzero(ties.lengthwise),
    )  # fmt: skip


def steady_of(link_springs: LinkSprings, nodes: int) -> Array:
    """What all ties put on nodes at rest, sideways and upwards, (2, node) N."""
    out = np.zeros((2, nodes))
    for e, (i, j) in enumerate(zip(link_springs.one, link_springs.other, strict=True)):
        out[:, i : i + WIDTH] += np.outer(link_springs.steady[e], link_springs.weight[e, 0])
        out[:, j : j + WIDTH] -= np.outer(link_springs.steady[e], link_springs.weight[e, 1])
    return out


@inlined
def _height(x, i, weight, e, side):
    """Coordinate of one end of spring e on a wire."""
    out = 0.0
    for k in _SHARES:
        out += weight[e, side, k] * x[i + k]
    return out


@inlined
def _give(x, gain, i, weight, e, side, F):
    """Let a force move the nodes that share one end of spring e."""
    for k in _SHARES:
        x[i + k] += gain[i + k] * weight[e, side, k] * F


@inlined
def _stored(link_springs, e, size):
    """Energy of spring e where it is of a size in m, J."""
    longer = size - link_springs.length[e]
    return 0.5 * (link_springs.pull[e] if longer > 0.0 else link_springs.push[e]) * longer * longer


@inlined
def add_tie_forces(link_springs, which, now, other, gain, dt, work, found, row, noted, t):
    """What some of the ties do during a step of dt in s, which begins at t in s."""
    axes, weight, length, last = now.shape[0], link_springs.weight, link_springs.length, link_springs.last
    steady, failed = link_springs.steady, link_springs.failed
    x, z, out_x, out_z = now[0], now[axes - 1], other[0], other[axes - 1]
    for e in which:
        i, j = (
            np.uint64(link_springs.one[e]),
            np.uint64(link_springs.other[e]),
        )  # unsigned: no look at what is before an array
        dx, dy, dz = link_springs.place[e, 0], link_springs.place[e, 1], link_springs.place[e, 2]
        if np.isnan(dx):
            dx, dz = _height(x, j, weight, e, 1), _height(z, j, weight, e, 1)
            dy = _height(now[1], j, weight, e, 1) + dy if axes == 3 else 0.0
        dx, dz = dx - _height(x, i, weight, e, 0), dz - _height(z, i, weight, e, 0)
        dy = dy - _height(now[1], i, weight, e, 0) if axes == 3 else link_springs.aside[e]
        size = np.sqrt(dx * dx + dy * dy + dz * dz)
        whole = failed[e, 0] == np.inf
        c = link_springs.damping[e] if whole else 0.0
        rate, before = (size - last[e]) / dt, link_springs.rate[e]
        work[DAMPED] += 0.5 * c * before * (before + rate) * dt
        if size > length[e]:
            N, link_springs.rate[e] = link_springs.pull[e] * (size - length[e]) + c * rate, rate
        else:
            N, link_springs.rate[e] = link_springs.push[e] * (size - length[e]), 0.0
        if whole and (link_springs.strength[e] < N or t >= link_springs.fails_at[e]):
            failed[e, 0], failed[e, 1], whole = t, N, False
            work[DAMPED] += 0.5 * (_stored(link_springs, e, size) + _stored(link_springs, e, last[e]))
        if not whole:
            N = 0.0
        last[e] = size
        if noted:
            found[e, row] = N - link_springs.rest[e]
        N /= size
        _give(out_x, gain[0], i, weight, e, 0, N * dx)
        _give(out_z, gain[axes - 1], i, weight, e, 0, N * dz - steady[e, 1])
        _give(out_x, gain[0], j, weight, e, 1, -N * dx)
        _give(out_z, gain[axes - 1], j, weight, e, 1, steady[e, 1] - N * dz)
        if axes == 3:
            _give(other[1], gain[1], i, weight, e, 0, N * dy - steady[e, 0])
            _give(other[1], gain[1], j, weight, e, 1, steady[e, 0] - N * dy)
