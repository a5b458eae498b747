"""Ties and holds of wires in the plane or in space, as springs between splines and rigid joints."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.compiled import inlined
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.rest import rows, spring, ties_springs
from ropewalk.wires.riders import DAMPED
from ropewalk.wires.spline import WIDTH

_SHARES = tuple(np.uint64(k) for k in range(WIDTH))


class Strings(NamedTuple):
    """Ties and holds in space."""

    ties: int  # number of ties, which come first
    one: Integers  # (spring,) first node of the one end, and of the other
    other: Integers
    weight: Array  # (spring, 2, WIDTH) of both ends
    place: Array  # (spring, 3) m, of the ground; NaN where the other end is on a wire
    aside: Array  # (spring,) m sideways from the one end to the other, in the plane
    length: Array  # m unstrained; NaN for holds
    pull: Array  # N/m
    push: Array  # N/m
    damping: Array  # N s/m of ties
    last: Array  # (spring, 3) m, a step ago: length of a tie, place of what is held
    rate: Array  # (spring, 3) m/s at which that changed, while it damped
    stiff: Array  # (spring, 3) N/m of holds
    loss: Array  # (spring, 3) N s/m of holds
    lift: Array  # (spring,) N upwards, of holds
    steady: Array  # (spring, 2) N on the one end at rest, sideways and upwards: put on all the time, and not as pushes


def strings_of(mesh: Mesh, position: Array) -> Strings:
    """Ties, and then all holds."""
    ties, holds = mesh.ties, mesh.holds
    pull, push = ties_springs(mesh)
    count, nan = holds.force.size, np.full(holds.force.size, np.nan)
    stiff = np.where(np.isinf(holds.stiffness), 0.0, spring(holds.stiffness, holds.at.local[:, None]))
    no_ties = np.zeros((ties.length.size, 3))
    blank, last = np.zeros(count), np.zeros((ties.length.size + count, 3))
    away = (rows(ties.other, mesh.nodes) - rows(ties.one, mesh.nodes)) @ position.T
    away += np.where(np.isfinite(ties.ground), ties.ground, 0.0)
    last[: ties.length.size, 0] = np.sqrt((away**2).sum(axis=1))
    last[ties.length.size :] = rows(holds.at, mesh.nodes) @ position.T
    longer = last[: ties.length.size, 0] - ties.length
    pulls = np.where(longer > 0.0, pull, push) * longer / last[: ties.length.size, 0]
    held = stiff * (holds.place - last[ties.length.size :])
    held[:, 2] += holds.force
    return Strings(
        ties.length.size, np.concatenate([ties.one.base, holds.at.base]),
        np.concatenate([ties.other.base, holds.at.base]),
        np.concatenate([
            np.stack([ties.one.weight, ties.other.weight], axis=1),
            np.stack([holds.at.weight, np.zeros_like(holds.at.weight)], axis=1),
        ]),
        np.concatenate([ties.ground, holds.place]), np.concatenate([away[:, 1], blank]),
        np.concatenate([ties.length, nan]), np.concatenate([pull, blank]),
        np.concatenate([push, blank]), np.concatenate([ties.damping, blank]), last, np.zeros_like(last),
        np.concatenate([no_ties, stiff]), np.concatenate([no_ties, holds.damping]),
        np.concatenate([np.zeros(ties.length.size), holds.force]),
        np.concatenate([pulls[:, None] * away[:, 1:], held[:, 1:]]),
    )  # fmt: skip


def steady_of(strings: Strings, nodes: int) -> Array:
    """What all ties and holds put on nodes at rest, sideways and upwards, (2, node) N."""
    out = np.zeros((2, nodes))
    for e, (i, j) in enumerate(zip(strings.one, strings.other, strict=True)):
        out[:, i : i + WIDTH] += np.outer(strings.steady[e], strings.weight[e, 0])
        out[:, j : j + WIDTH] -= np.outer(strings.steady[e], strings.weight[e, 1])
    return out


class Grips(NamedTuple):
    """Components of holds that stand fast."""

    base: Integers
    weight: Array  # (grip, WIDTH)
    axis: Integers
    place: Array  # m
    soft: Array  # (grip,) m/N, by which the wire gives way to a force during a step
    hold: Integers  # which hold it is


def grips_of(mesh: Mesh, gain: Array, along: Array, axes: list[int]) -> Grips:
    """All of them, for steps in which forces displace nodes by gains in m/N, across and along x."""
    holds = mesh.holds
    pairs = [(hold, axis) for hold, axis in np.argwhere(np.isinf(holds.stiffness)) if axis in axes]
    fast, axis = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    base, weight = holds.at.base[fast], np.ascontiguousarray(holds.at.weight[fast])
    moved = [(along if a == 0 else gain)[b : b + WIDTH] @ w**2 for a, b, w in zip(axis, base, weight, strict=True)]
    soft = np.array(moved).reshape(-1) + holds.at.local[fast]
    component = np.array([axes.index(a) for a in axis], dtype=np.int64)
    return Grips(base, weight, component, holds.place[fast, axis], soft, fast)


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
def pull_ties(strings, now, other, gain, along, pace, found, row, step):
    """What ties do during a step."""
    dt, axes, weight, length, last = pace.step, now.shape[0], strings.weight, strings.length, strings.last
    steady = strings.steady
    x, z, out_x, out_z = now[0], now[axes - 1], other[0], other[axes - 1]
    for e in range(strings.ties):
        i, j = np.uint64(strings.one[e]), np.uint64(strings.other[e])  # unsigned: no look at what is before an array
        dx, dy, dz = strings.place[e, 0], strings.place[e, 1], strings.place[e, 2]
        if np.isnan(dx):
            dx, dz = _height(x, j, weight, e, 1), _height(z, j, weight, e, 1)
            dy = _height(now[1], j, weight, e, 1) if axes == 3 else 0.0
        dx, dz = dx - _height(x, i, weight, e, 0), dz - _height(z, i, weight, e, 0)
        dy = dy - _height(now[1], i, weight, e, 0) if axes == 3 else strings.aside[e]
        size = np.sqrt(dx * dx + dy * dy + dz * dz)
        c, rate, before = strings.damping[e], (size - last[e, 0]) / dt, strings.rate[e, 0]
        pace.work[DAMPED] += 0.5 * c * before * (before + rate) * dt
        if size > length[e]:
            N, strings.rate[e, 0] = strings.pull[e] * (size - length[e]) + c * rate, rate
        else:
            N, strings.rate[e, 0] = strings.push[e] * (size - length[e]), 0.0
        last[e, 0] = size
        if step == 0:
            found[e, row] = N
        N /= size
        _give(out_x, along, i, weight, e, 0, N * dx)
        _give(out_z, gain, i, weight, e, 0, N * dz - steady[e, 1])
        _give(out_x, along, j, weight, e, 1, -N * dx)
        _give(out_z, gain, j, weight, e, 1, steady[e, 1] - N * dz)
        if axes == 3:
            _give(other[1], gain, i, weight, e, 0, N * dy - steady[e, 0])
            _give(other[1], gain, j, weight, e, 1, steady[e, 0] - N * dy)


@inlined
def hold(strings, now, other, gain, along, pace, found, row, step):
    """What elastic holds do during a step."""
    dt, axes, weight, stiff, loss = pace.step, now.shape[0], strings.weight, strings.stiff, strings.loss
    for e in range(strings.ties, strings.one.size):
        i = np.uint64(strings.one[e])
        for c in range(axes):
            at = 2 if c == axes - 1 else c
            F = strings.lift[e] if at == 2 else 0.0
            if stiff[e, at] > 0.0 or loss[e, at] > 0.0:
                here, before = _height(now[c], i, weight, e, 0), strings.rate[e, at]
                rate = (here - strings.last[e, at]) / dt
                F += stiff[e, at] * (strings.place[e, at] - here) - loss[e, at] * rate
                pace.work[DAMPED] += 0.5 * loss[e, at] * before * (before + rate) * dt
                strings.last[e, at], strings.rate[e, at] = here, rate
            if step == 0:
                found[e - strings.ties, at, row] = F
            if c > 0:
                F -= strings.steady[e, at - 1]
            if F != 0.0:
                _give(other[c], along if c == 0 else gain, i, weight, e, 0, F)


@inlined
def grip(grips, axes, other, gain, along, record, row, step):
    """What rigid holds do at the end of a step."""
    for e in range(grips.base.size):
        i, c, here = grips.base[e], grips.axis[e], 0.0
        at, give = 2 if c == axes - 1 else c, along if c == 0 else gain
        for k in range(WIDTH):
            here += grips.weight[e, k] * other[c, i + k]
        F = (grips.place[e] - here) / grips.soft[e]
        if step == 0:
            record.hold[grips.hold[e], at, row] += F
        for k in range(WIDTH):
            other[c, i + k] += give[i + k] * grips.weight[e, k] * F
