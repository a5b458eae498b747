"""Holds of wires in motion: springs and dampers to the ground, and what holds fast or goes as prescribed.

A damper acts in the kick of a step, whose velocity it changes as m v' = F - c (v - u') does, exactly; u' is that of its
far end. So no damper, however strong, shortens the step, as on ropes (docs/notes/supports.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.compiled import inlined
from ropewalk.mechanics.moving_contact import look_up
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.moving_loads import DAMPED, MOVED
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.rest import rows, spring
from ropewalk.wires.spline import WIDTH

_SHARES = tuple(np.uint64(k) for k in range(WIDTH))
_SLIGHT = 1e-4  # exponent of a decay up to which a series is taken
A_STEP_AGO, NOW, AHEAD = 0, 1, 2


class Holders(NamedTuple):
    """Directions in which holds act, each a spring and a damper; first come those in which they hold fast."""

    fast: int  # number of those
    hold: Integers  # (holder,) its number
    base: Integers
    weight: Array  # (holder, WIDTH)
    way: Array  # (holder, axis) unit vector
    stiffness: Array  # N/m
    damping: Array  # N s/m
    place: Array  # m along the way, where it is without force, but for its displacement
    soft: Array  # m/N by which the wire gives way to a force during a step
    local: Array  # m/N beside its spline, of what holds fast
    x: Array  # m, to know whether it lies in a window
    first: Integers  # where the table of its displacement begins
    instants: Integers
    driven: Integers  # holders that are displaced
    time: Array  # s
    value: Array  # m along the way
    moved: Array  # (holder, 3) m, displacement A_STEP_AGO, NOW and AHEAD of a step; after it, AHEAD is the present
    last: Array  # m, place of the point a step ago
    here: Array  # m, now
    force: Array  # N, in the present step


MOVES = ("moved", "last", "here", "force")  # what changes of them in motion


def holders_of(mesh: Mesh, gain: Array, axes: Sequence[int], position: Array, place: Array) -> Holders:
    """All of them, for steps in which forces displace nodes by gains.

    Args:
        gain: (axis, node) m/N.
        axes: in which wires move, as numbers of x, y and z.
        position: (axis, node) m at the beginning.
        place: (hold, 3) m, where holds are without force then.
    """
    holds = mesh.holds
    x = mesh.strands.across[holds.at.wire, 0] + mesh.strands.across[holds.at.wire, 1] * holds.at.station
    begin = np.cumsum(holds.instants) - holds.instants
    found = []
    for i, j in np.ndindex(holds.stiffness.shape):
        way, part = holds.axes[i, j][list(axes)], slice(int(holds.at.base[i]), int(holds.at.base[i]) + WIDTH)
        soft = float(way**2 @ gain[:, part] @ holds.at.weight[i] ** 2)
        fast = bool(np.isinf(holds.stiffness[i, j]) or (holds.fixes[i, j] and holds.instants[i] > 1))
        if soft > 0.0 and (fast or holds.stiffness[i, j] > 0.0 or holds.damping[i, j] > 0.0):
            found.append((not fast, float(x[i]), int(i), int(j), soft))
    found.sort()
    hold, axis = np.array([(i, j) for *_, i, j, _ in found], dtype=np.int64).reshape(-1, 2).T
    elastic = np.array([elastic for elastic, *_ in found], dtype=np.bool_)
    way, weight = holds.axes[hold, axis], holds.at.weight[hold]
    local = np.where(elastic, 0.0, holds.at.local[hold])
    instants, none = holds.instants[hold], np.zeros(0)
    parts = [slice(int(b), int(b + n)) for b, n in zip(begin[hold], instants, strict=True)]
    times = [none, *(holds.time[p] for p in parts)]
    tables = [none, *(w @ holds.moved[:, p] for w, p in zip(way, parts, strict=True))]
    at = holds.at._replace(base=holds.at.base[hold], weight=weight)
    here = (rows(at, mesh.nodes) @ position.T * way[:, list(axes)]).sum(axis=1)
    return Holders(
        int((~elastic).sum()), hold, holds.at.base[hold], np.ascontiguousarray(weight),
        np.ascontiguousarray(way[:, list(axes)]), spring(holds.stiffness[hold, axis], holds.at.local[hold]),
        holds.damping[hold, axis], (way * place[hold]).sum(axis=1), np.array([s for *_, s in found]) + local, local,
        x[hold], np.cumsum(instants) - instants, instants, np.flatnonzero(instants > 1), np.concatenate(times),
        np.concatenate(tables), np.zeros((hold.size, 3)), here, here.copy(), np.zeros(hold.size),
    )  # fmt: skip


@inlined
def move_places(holders, t):
    """Begin a step that ends at time t in s."""
    for e in holders.driven:
        holders.moved[e, A_STEP_AGO], holders.moved[e, NOW] = holders.moved[e, NOW], holders.moved[e, AHEAD]
        holders.moved[e, AHEAD] = look_up(holders.time, holders.value, holders.first[e], holders.instants[e], t)


def coordinates(holders: Holders, r: Array) -> Array:
    """Where the points of all holders are along their ways at positions r (axis, node) in m, (holder,) m."""
    near = r[:, holders.base[:, None] + np.arange(WIDTH)]
    return np.asarray(np.einsum("ea,ek,aek->e", holders.way, holders.weight, near))


@inlined
def coordinate(holders, e, r):
    """Coordinate of the point of holder e along its way."""
    out, i = 0.0, np.uint64(holders.base[e])  # unsigned: no look at what is before an array
    for a in range(r.shape[0]):
        if holders.way[e, a] != 0.0:
            for k in _SHARES:
                out += holders.way[e, a] * holders.weight[e, k] * r[a, i + k]
    return out


@inlined
def give_way(holders, e, r, gain, F):
    """Let the force of holder e move the nodes that share its point."""
    i = np.uint64(holders.base[e])
    for a in range(r.shape[0]):
        if holders.way[e, a] != 0.0:
            for k in _SHARES:
                r[a, i + k] += gain[a, i + k] * holders.weight[e, k] * holders.way[e, a] * F


@inlined
def write_force(holders, e, F, found, row):
    """Add the force of holder e to the record of its hold, (hold, 3, row)."""
    axes = holders.way.shape[1]
    for a in range(axes):
        found[holders.hold[e], 2 if a == axes - 1 else a, row] += holders.way[e, a] * F


@inlined
def restrain(holders, begin, end, now, other, gain, dt, work, found, row, noted):
    """What the elastic holders from `begin` on do during a step, which all else has already brought to `other`."""
    for e in range(begin, end):
        soft, c = holders.soft[e], holders.damping[e]
        here = coordinate(holders, e, now)
        far = (holders.moved[e, AHEAD] - holders.moved[e, A_STEP_AGO]) / (2.0 * dt)
        F = holders.stiffness[e] * (holders.place[e] + holders.moved[e, NOW] - here)
        work[MOVED] += F * far * dt
        if c > 0.0:
            rate = (here - holders.last[e]) / dt
            struck = (coordinate(holders, e, other) + soft * F - here) / dt - rate
            before, y = rate - far, c * soft / dt  # relative to the far end
            if y < _SLIGHT:
                once, twice = 1.0 - 0.5 * y + y * y / 6.0, 0.5 - y / 6.0
            else:
                once = -np.expm1(-y) / y
                twice = (1.0 - once) / y
            after, mean = before + (struck - y * before) * once, before * once + struck * twice
            work[DAMPED] += dt * dt / soft * (struck * mean - 0.5 * (after * after - before * before))
            work[MOVED] -= c * mean * far * dt
            F -= c * mean
        holders.last[e] = here
        if noted:
            write_force(holders, e, F, found, row)
        give_way(holders, e, other, gain, F)


@inlined
def constraint(holders, begin, end, other, gain, work, found, row, noted, begins):
    """What holds fast, or goes as prescribed, at the end of a step; `begins`: in the first sweep over all of them."""
    for e in range(begin, end):
        if begins:
            holders.force[e] = 0.0
        gap = holders.place[e] + holders.moved[e, AHEAD] - coordinate(holders, e, other)
        F = (gap - holders.local[e] * holders.force[e]) / holders.soft[e]
        holders.force[e] += F
        work[MOVED] += 0.5 * F * (holders.moved[e, AHEAD] - holders.moved[e, A_STEP_AGO])
        if noted:
            write_force(holders, e, F, found, row)
        give_way(holders, e, other, gain, F)
