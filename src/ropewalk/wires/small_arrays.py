"""What small motion of wires is computed with, as arrays: springs, grips, stencil, what moves and is watched."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.wires.mesh import FREE, Mesh
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.rest import Rest, spring, ties_springs
from ropewalk.wires.spline import WIDTH

_FEW = 0.1  # part of the nodes of a wire that may carry more than it and be seen to afterwards


class Springs(NamedTuple):
    """Ties and holds as vertical springs between splines, about rest; ties first."""

    one: Integers  # (spring,) first control point of one end
    other: Integers  # the same of the other end
    weight: Array  # (spring, 2 WIDTH) that gives how far they move apart; zeros for the ground
    nodes: Integers  # (spring, 2) where both ends are nodes, these, or the node twice for the ground; else -1
    rest: Array  # N along the tie at rest; of a slack one the negative of what pulls it straight
    pull: Array  # N/m along the tie, while tight
    push: Array  # N/m along the tie, while slack
    across: Array  # N/m vertically, of its tension at rest; all the stiffness of a hold
    damping: Array  # N s/m, while tight
    way: Array  # (spring,) vertical part of its direction
    last: Array  # m by which its ends had moved apart a step ago
    rate: Array  # m/s at which they did so then, while it damped
    x: Array  # m, to know whether it lies in the window
    number: Integers  # of the tie, or of the hold


class Grips(NamedTuple):
    """Holds that stand fast."""

    base: Integers
    weight: Array  # (grip, WIDTH)
    soft: Array  # (grip,) m/N, by which the wire gives way to a force during a step
    local: Array  # (grip,) m/N, beside its spline
    hold: Integers  # which hold it is
    x: Array  # m, to know whether it lies in the window
    force: Array  # (grip,) N in the present step
    now: Array  # (grip,) m, height of the spline over rest now, and
    last: Array  # (grip,) m, a step ago


class Window(NamedTuple):
    """What of the wires moves: the rest stands still. Each as the first of them and one beyond the last."""

    low: Integers  # (wire,) control points, counted in the wire
    high: Integers  # (wire,)
    laden: Integers  # (wire, 2)
    springs: tuple[int, int]
    grips: tuple[int, int]
    watched: tuple[int, int]


class Watched(NamedTuple):
    """Points whose height is recorded."""

    base: Integers
    weight: Array  # (point, WIDTH)
    x: Array  # m
    number: Integers  # in the record


class Stencil(NamedTuple):
    """What a step of a given length needs of the wires."""

    bending: Array  # (wire,) N m^2, corrected
    gain: Array  # (node,) m/N, displacement by a force during a step
    keep: Array  # (wire,) part of the last displacement that is kept, 1 without drag
    bare: Array  # (wire,) m/N, gain of a node that carries its wire alone; 0 where many carry more
    laden: Integers  # the other nodes, of all wires with a bare gain
    first: Integers  # (wire + 1,) where those of each wire begin
    saved: Array  # (laden,) room
    mass: Array  # (node,) kg
    damped: bool  # whether any wire is


def _nodes(base: Integers, weight: Array) -> Integers:
    """The node of each place that is one, else -1."""
    return np.where((weight == 1.0).any(axis=1), base + np.argmax(weight, axis=1), -1)


def x_of(mesh: Mesh, wire: Integers, station: Array) -> Array:
    """Where stations of wires are along x, m."""
    across = mesh.strands.across[wire]
    x: Array = across[:, 0] + across[:, 1] * station
    return x


def springs_of(mesh: Mesh, rest: Rest) -> Springs:
    """Ties and elastic holds, as springs about rest."""
    ties, holds = mesh.ties, mesh.holds
    pull, slack = ties_springs(mesh)
    held = spring(holds.stiffness[:, 2], holds.at.local)
    keep = (holds.stiffness[:, 2] > 0.0) & ~np.isinf(holds.stiffness[:, 2])
    none, way = np.zeros(int(keep.sum())), rest.tie_way[:, 2]
    apart = np.hstack([-ties.one.weight, ties.other.weight])
    to_ground = np.hstack([-holds.at.weight[keep], np.zeros_like(holds.at.weight[keep])])
    across = np.maximum(rest.tie_force, 0.0) / rest.tie_distance * (1.0 - way**2)
    one = _nodes(np.concatenate([ties.one.base, holds.at.base[keep]]), -np.vstack([apart, to_ground])[:, :WIDTH])
    other = _nodes(np.concatenate([ties.other.base, holds.at.base[keep]]), np.vstack([apart, to_ground])[:, WIDTH:])
    grounded = ~np.vstack([apart, to_ground])[:, WIDTH:].any(axis=1)
    nodes = np.column_stack([one, np.where(grounded, one, other)])
    nodes[(nodes < 0).any(axis=1)] = -1
    wire = np.concatenate([ties.one.wire, holds.at.wire[keep]])
    station = np.concatenate([ties.one.station, holds.at.station[keep]])
    return Springs(
        np.concatenate([ties.one.base, holds.at.base[keep]]), np.concatenate([ties.other.base, holds.at.base[keep]]),
        np.concatenate([apart, to_ground]), nodes, np.concatenate([pull * (rest.tie_distance - ties.length), none]),
        np.concatenate([pull, none]), np.concatenate([slack, none]), np.concatenate([across, held[keep]]),
        np.concatenate([ties.damping, holds.damping[keep, 2]]), np.concatenate([way, none + 1.0]),
        np.zeros(way.size + none.size), np.zeros(way.size + none.size), x_of(mesh, wire, station),
        np.concatenate([np.arange(way.size), np.flatnonzero(keep)]),
    )  # fmt: skip


def stencil_of(mesh: Mesh, step: float) -> Stencil:
    """Prepare steps of a length in s."""
    s = mesh.strands
    T = np.maximum(s.tension, 0.0)
    bending = s.stiffness + T * (s.h**2 - T / s.rho * step**2) / 12.0
    gain = step**2 / mesh.mass / (1.0 + 0.5 * step * np.repeat(s.drag, s.links + 1))
    gain[s.first[s.end[:, 0] != FREE]] = 0.0
    gain[(s.first + s.links)[s.end[:, 1] != FREE]] = 0.0
    slow = 1.0 + 0.5 * step * s.drag
    bare, laden, first = step**2 / (s.rho * s.h) / slow, [], [0]
    for a, n in enumerate(s.links):
        part = slice(int(s.first[a]) + 2, int(s.first[a] + n) - 1)
        own = part.start + np.flatnonzero(np.abs(gain[part] / bare[a] - 1.0) > 1e-12)
        if own.size > _FEW * n:
            bare[a], own = 0.0, own[:0]
        laden += own.tolist()
        first.append(len(laden))
    return Stencil(
        bending, gain, (2.0 - slow) / slow, bare, np.array(laden, dtype=np.int64), np.array(first, dtype=np.int64),
        np.zeros(len(laden)), mesh.mass, bool(s.drag.any() or s.retardation.any()),
    )  # fmt: skip


def grips_of(mesh: Mesh, gain: Array) -> Grips:
    """Rigid holds, for steps in which forces displace nodes by a gain in m/N."""
    at, fast = mesh.holds.at, np.flatnonzero(np.isinf(mesh.holds.stiffness[:, 2]))
    fast = fast[np.argsort(x_of(mesh, at.wire[fast], at.station[fast]), kind="stable")]
    base, weight = at.base[fast], at.weight[fast]
    moved = np.array([gain[b : b + WIDTH] @ w**2 for b, w in zip(base, weight, strict=True)])
    none = np.zeros(fast.size)
    x = x_of(mesh, at.wire[fast], at.station[fast])
    return Grips(
        base, np.ascontiguousarray(weight), moved.reshape(-1), at.local[fast], fast, x, none, none.copy(), none.copy()
    )  # fmt: skip
