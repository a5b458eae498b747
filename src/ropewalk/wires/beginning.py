"""Beginnings of motion other than rest: a mode, a stored instant, and small motion at rest with its loads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sparse

from ropewalk.errors import EquilibriumError
from ropewalk.solve.mode_of_structure import mode_of
from ropewalk.wires.bearing import Bearing
from ropewalk.wires.contact_location import location_at
from ropewalk.wires.equilibrium import WirePotential, movable
from ropewalk.wires.mesh import Mesh
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.prescribed_motion import PrescribedMotion
from ropewalk.wires.pressing import Pressing, pressing
from ropewalk.wires.rest import moving, rows, spring, ties_springs, vertical_stiffness
from ropewalk.wires.small import SmallMotion
from ropewalk.wires.task import WireStart, along, loaded, place_at, resting, rows_at

_MOST_ROUNDS, _CLOSE = 100, 1e-13  # rounds between tight and slack, and the end of them, of the longest wire


def in_mode(start: WireStart, wires: Sequence[int], number: int, amplitude: float, direction: Array) -> Array:
    """Positions (3, node) in m of wires at rest, some of which are deflected in a mode of theirs.

    Args:
        start: all wires at rest.
        wires: numbers of those that vibrate together.
        number: of the mode, from 1, among those in the direction.
        amplitude: m, largest displacement.
        direction: (3,).

    Raises:
        EquilibriumError: there are not so many modes.
    """
    mesh, n = start.mesh, start.mesh.nodes
    mine = np.zeros(n, dtype=np.bool_)
    for i in wires:
        mine[mesh.of(i)] = True
    if start.rest is not None:
        free = np.zeros((3, n), dtype=np.bool_)
        free[2] = moving(mesh)
        K = sparse.block_diag([sparse.csc_matrix((2 * n, 2 * n)), _about_rest(start)], format="csc")
    else:
        free = movable(mesh, space=bool(direction[1]))
        K = WirePotential(mesh, start.unstrained).stiffness(start.position)
    free &= mine
    whole = np.flatnonzero(free.ravel())
    row = 3 * (whole % n) + whole // n
    moves = sparse.csr_matrix((np.ones(whole.size), (row, np.arange(whole.size))), shape=(3 * n, whole.size))
    M = sparse.diags(np.tile(mesh.mass, 3)[whole]).tocsc()
    return start.position + amplitude * mode_of(K[whole][:, whole], M, moves, number, direction).T


def _about_rest(start: WireStart) -> sparse.csc_matrix:
    """Stiffness of small motion against vertical displacements, ties as they are at rest, (node, node) N/m."""
    mesh, rest = start.mesh, start.rest
    assert rest is not None
    ties, holds = mesh.ties, mesh.holds
    k = np.where(rest.tie_force > 0.0, *ties_springs(mesh))
    way, pull = rest.tie_way[:, 2], np.maximum(rest.tie_force, 0.0)
    tie, hold = rows(ties.other, mesh.nodes) - rows(ties.one, mesh.nodes), rows(holds.at, mesh.nodes)
    across = k * way**2 + pull / rest.tie_distance * (1.0 - way**2)
    stiff = spring(holds.stiffness[:, 2], holds.at.local)
    K = vertical_stiffness(mesh) + tie.T @ sparse.diags(across) @ tie + hold.T @ sparse.diags(stiff) @ hold
    return sparse.csc_matrix(K)


def on_moved(
    start: WireStart, prescribed_motions: Sequence[PrescribedMotion], position: Array, velocity: Array
) -> tuple[PrescribedMotion, ...]:
    """Prescribed motions whose moving loads begin on wires that are elsewhere than at rest, and move.

    Args:
        start: of the wires.
        prescribed_motions: of the moving loads; those that stand follow the wires.
        position, velocity: (3, node) m and m/s, of the wires at the beginning.
    """
    moved, out = replace(start, position=position), []
    for prescribed_motion in prescribed_motions:
        if not prescribed_motion.stands:
            out.append(prescribed_motion)
            continue
        there = loaded(moved, prescribed_motion)
        rates = replace(moved, position=np.stack([position[0], velocity[1], velocity[2]]))
        stations = [
            float(prescribed_motion.place(np.zeros(1))[0]) - c.behind for c in prescribed_motion.moving_load.contacts
        ]
        own = [
            place_at(rates, c.wire, s, material=c.material)[0]
            if 0.0 < s < start.mesh.plan.wires[c.wire].length
            else 0.0
            for c, s in zip(prescribed_motion.moving_load.contacts, stations, strict=True)
        ]
        row = rows_at(prescribed_motion.moving_load, stations)
        out.append(replace(there, rate=there.rate + resting(prescribed_motion.moving_load, np.array(own), row)))
    return tuple(out)


def small_under_loads(
    motion: SmallMotion, prescribed_motions: Sequence[PrescribedMotion]
) -> tuple[Array, tuple[PrescribedMotion, ...]]:
    """Small motion at rest with its loads: displacements (node,) in m from rest without them, and the motions there.

    Droppers slacken as they do in motion, and what can lift off does; then nothing moves unless a load does.

    Raises:
        EquilibriumError: there is no such rest.
    """
    mesh, moving_loads, springs, holders = motion.mesh, motion.moving_loads, motion.springs, motion.holders
    corrected: Mesh = mesh._replace(strands=mesh.strands._replace(stiffness=motion.stencil.bending))
    K, free, n = vertical_stiffness(corrected), moving(mesh), mesh.nodes
    bearing = Bearing(mesh, prescribed_motions, np.ones(n), space=False)
    station = bearing.stations(0.0)
    wire = moving_loads.wire
    inside = np.array([0.0 <= s <= bearing.length(k) for k, s in enumerate(station)], dtype=np.bool_)
    ground = np.where(inside, np.nan, bearing.ground(station))
    locations = [
        location_at(mesh, int(wire[k]), min(s, mesh.plan.wires[wire[k]].length) / float(mesh.strands.h[wire[k]]))
        if inside[k]
        else None
        for k, s in enumerate(station)
    ]
    local = np.array([location.local if location is not None else 0.0 for location in locations])
    with np.errstate(divide="ignore"):
        local = np.where(moving_loads.spring > 0.0, np.maximum(local, -0.5 / moving_loads.spring), local)
    at = bearing.rows(locations)
    half = springs.weight.shape[1] // 2
    apart = _spread(springs.one, springs.weight[:, :half], n) + _spread(springs.other, springs.weight[:, half:], n)
    hold, fast = _spread(holders.base, holders.way * holders.weight, n), holders.fast
    K = K + hold[fast:].T @ sparse.diags(holders.stiffness[fast:]) @ hold[fast:]
    tie, touches = springs.pull > 0.0, inside | np.isfinite(ground)
    u, tight, size = np.zeros(n), springs.rest > 0.0, max(w.length for w in mesh.plan.wires)
    ratio = np.divide(springs.push, springs.pull, out=np.zeros_like(springs.pull), where=tie)
    before = np.where(springs.rest > 0.0, springs.rest, springs.rest * ratio)  # what is put on at rest already
    for _ in range(_MOST_ROUNDS):
        found: Pressing = pressing(
            prescribed_motions, moving_loads, 0.0, local, bearing.rough(station), bearing.aside(station), touches,
            ground,
        )  # fmt: skip
        # N = k (rest / pull + way apart) of each tie; what it changes by acts along its way
        k = np.where(tie, np.where(tight, springs.pull, springs.push), 0.0)
        N = k * np.divide(springs.rest, springs.pull, out=np.zeros_like(k), where=tie)
        stiff = springs.across + k * springs.way**2
        given = at.T @ (found.given - found.stiffness @ (at @ motion.level))
        given -= apart.T @ np.where(tie, springs.way * (N - before), 0.0)
        A = K + apart.T @ sparse.diags(stiff) @ apart + at.T @ sparse.csr_matrix(found.stiffness) @ at
        last, u = u, np.zeros(n)
        u[free] = _restrained(
            sparse.csc_matrix(A)[free][:, free], hold[:fast][:, free], holders.local[:fast], given[free]
        )
        was, tight = tight, springs.rest + springs.pull * springs.way * (apart @ u) > 0.0
        force = found.given - found.stiffness @ (at @ (motion.level + u))
        lifted = touches & inside & moving_loads.lifts & (moving_loads.sign * force < 0.0)
        touches &= ~lifted
        if not lifted.any() and np.array_equal(was, tight) and np.abs(u - last).max(initial=0.0) <= _CLOSE * size:
            q, begin = found.coordinates(at @ (motion.level + u)), np.concatenate([[0], np.cumsum(moving_loads.size)])
            return u, tuple(replace(j, first=q[begin[i] : begin[i + 1]]) for i, j in enumerate(prescribed_motions))
    raise EquilibriumError("the droppers find no rest with the loads between tight and slack; check their lengths")


def _spread(base: Integers, weight: Array, nodes: int) -> sparse.csr_matrix:
    """Interpolation (point, node) from the first node that shares each point, and the shares."""
    count, width = weight.shape
    row, column = np.repeat(np.arange(count), width), (base[:, None] + np.arange(width)).ravel()
    return sparse.csr_matrix((weight.ravel(), (row, column)), shape=(count, nodes))


def _restrained(A: sparse.csc_matrix, hold: sparse.csr_matrix, local: Array, given: Array) -> Array:
    """Solve A u = given + hold' force, hold u + local force = 0."""
    count = hold.shape[0]
    system = sparse.bmat([[A, -hold.T], [hold, sparse.diags(local)]], format="csc") if count else A
    found: Array = sparse.linalg.splu(system).solve(np.concatenate([given, np.zeros(count)]))
    return found[: given.size]


def along_moved(
    start: WireStart, prescribed_motions: Sequence[PrescribedMotion], u: Array
) -> tuple[PrescribedMotion, ...]:
    """Prescribed motions with rates as of moving loads that go along wires displaced upwards by u (node,) m."""
    moved = replace(start, position=start.position + np.outer([0.0, 0.0, 1.0], u))
    return tuple(along(moved, prescribed_motion) for prescribed_motion in prescribed_motions)
