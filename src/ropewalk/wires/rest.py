"""Rest of wires in small motion: tensions are given, heights are sought; ties may be slack."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.wires.bending import fourth_order
from ropewalk.wires.mesh import Mesh, Places, WireRuns, per_length
from ropewalk.wires.plan import Array
from ropewalk.wires.spline import WIDTH

AT_ONCE = 120_000
"""Unknowns that are solved for at once: 250 spans with links of 0.25 m."""
_PIECE, _BESIDE = 60_000, 8_000  # nodes in a piece, and on both sides of it: 125 and 17 spans
_ROUNDS = 8
_LEFT = 1e-12  # of what is given: nothing


def solve_by_stretches(
    K: Any, C: Any, local: Array, free: NDArray[np.bool_], load: Array, gap: Array, x: Array, *, roughly: bool = False
) -> tuple[Array, Array] | None:
    """Solve K z = load + C' force, C z + local force = gap for free control points; None: that does not converge.

    Args:
        K, C: (node, node) N/m, and (point, node).
        local: (point,) m/N.
        free: (node,) which move.
        load, gap: (node,) N, and (point,) m.
        x: (node,) m along the line.
        roughly: whether a first guess is enough.
    """
    K, C = sparse.csr_matrix(K), sparse.csr_matrix(C)
    nodes = np.flatnonzero(free)
    nodes = nodes[np.argsort(x[nodes], kind="stable")]
    at = x[C.indices[C.indptr[:-1]]] if C.shape[0] else np.zeros(0)  # m, of each point
    shares = (C != 0.0).astype(np.int64)
    z, force, before = np.zeros(free.size), np.zeros(C.shape[0]), np.inf
    begins = list(range(0, nodes.size, _PIECE))
    for _ in range(_ROUNDS):
        out, off = load + C.T @ force - K @ z, gap - C @ z - local * force
        moved, pulled = np.zeros_like(z), np.zeros_like(force)
        for i in begins:
            j, last = min(i + _PIECE, nodes.size), i == begins[-1]
            own = np.sort(nodes[max(i - _BESIDE, 0) : j + _BESIDE])
            points = np.flatnonzero((at >= x[own].min()) & (at <= x[own].max()))
            outside = free.copy()
            outside[own] = False
            points = points[shares[points] @ outside == 0]  # a point that borders share would be led by nothing
            A, B = K[own][:, own], C[points][:, own]
            system = sparse.bmat([[A, -B.T], [B, sparse.diags(local[points])]]) if points.size else A
            found = scipy.sparse.linalg.spsolve(sparse.csc_matrix(system), np.concatenate([out[own], off[points]]))
            inner = np.isin(own, nodes[i:j], assume_unique=True)
            moved[own[inner]] = found[: own.size][inner]
            begin, end = -np.inf if i == 0 else x[nodes[i]], np.inf if last else x[nodes[j]]
            kept = (at[points] >= begin) & (at[points] < end)
            pulled[points[kept]] = found[own.size :][kept]
        z, force = z + moved, force + pulled
        out, off = (load + C.T @ force - K @ z)[nodes], gap - C @ z - local * force
        left = max(_part(out, load[nodes], K.diagonal().max() * np.abs(z).max()), _part(off, gap, np.abs(z).max()))
        if roughly or left <= _LEFT:
            return z, force
        if not left < before:
            return None
        before = left
    return None


def _part(left: Array, given: Array, other: float) -> float:
    """The largest of what is left, over the largest of what is given, and of something as large that it comes from."""
    size = max(float(np.abs(given).max(initial=0.0)), other)
    return float(np.abs(left).max(initial=0.0)) / size if size > 0.0 else 0.0


_MOST_STEPS = 60
# Heights are found to this part of the longest wire; forces follow from them.
_CLOSE = 1e-13
_SOFT = 1.0  # N/m, with which wires that hang from others are held until it is known how these hold them
_RIGID = 1e-12  # m/N: what yields less is taken to yield by this
ROUNDING = 1e-12  # of an instant


@dataclass(frozen=True)
class WiresAtRest:
    """Wires at rest."""

    position: Array  # (3, node) m
    tie_force: Array  # (tie,) N, positive in tension
    tie_way: Array  # (tie, 3) from one to the other end, unit vector
    tie_distance: Array  # (tie,) m
    hold_force: Array  # (hold,) N upwards on the wire, its constant force included


def vertical_stiffness(mesh: Mesh) -> sparse.csr_matrix:
    """Stiffness of all wires against vertical displacements, (node, node) N/m, without what is attached."""
    s, tension, bent, bed, blocks = mesh.strands, mesh.tension, with_tension(mesh.strands), beds(mesh), []
    for a, h in enumerate(s.h):
        part, pull = mesh.of(a), tension[mesh.of(a)][:-1] / h
        whole = np.append(pull, 0.0) + np.append(0.0, pull)
        taut = sparse.diags([-pull, whole, -pull], [-1, 0, 1], format="csr")
        blocks.append(taut + _bending(s, a, float(bent[a])) + sparse.diags(bed[part], format="csr"))
    return _side_by_side(blocks)


def bending_stiffness(mesh: Mesh) -> sparse.csr_matrix:
    """The part of bending, of any one component, clamped ends included."""
    bent = with_tension(mesh.strands)
    return _side_by_side([_bending(mesh.strands, a, float(EI)) for a, EI in enumerate(bent)])


def _bending(strands: WireRuns, a: int, EI: float) -> sparse.csr_matrix:
    """That of wire a with a bending stiffness in N m^2."""
    n, h, (start, end) = int(strands.links[a]), float(strands.h[a]), strands.clamped[a]
    if strands.fourth[a]:
        return sparse.csr_matrix(EI / h**3 * fourth_order(n, (bool(start), bool(end))))
    one = np.ones(n + 1)
    curved = sparse.diags([one, -2.0 * one, one], [0, 1, 2], shape=(n - 1, n + 1))
    block = EI / h**3 * (curved.T @ curved)
    for clamped, i, j in ((start, 0, 1), (end, n, n - 1)):
        if clamped:
            turn = sparse.csr_matrix(([-1.0, 1.0], ([0, 0], [i, j])), shape=(1, n + 1))
            block = block + 2.0 * EI / h**3 * (turn.T @ turn)
    return sparse.csr_matrix(block)


def _side_by_side(blocks: list[sparse.csr_matrix]) -> sparse.csr_matrix:
    """Blocks along a diagonal; `scipy.sparse.block_diag` takes three times the memory on its way."""
    sizes = np.cumsum([0, *(block.shape[0] for block in blocks)])
    counts = np.cumsum([0, *(block.nnz for block in blocks)])
    indices = np.concatenate([block.indices + i for block, i in zip(blocks, sizes[:-1].astype(np.int32), strict=True)])
    first = [block.indptr[:-1] + i for block, i in zip(blocks, counts[:-1].astype(np.int32), strict=True)]
    data = np.concatenate([block.data for block in blocks])
    nodes = int(sizes[-1])
    return sparse.csr_matrix((data, indices, np.append(np.concatenate(first), counts[-1])), shape=(nodes, nodes))


def with_tension(strands: WireRuns) -> Array:
    """Bending stiffness, on beams of the fourth order with what makes that of their tension so, too, (wire,) N m^2.

    Strings rest with kinks, on which it must not act: there it is put on motion only.
    """
    more = np.where(strands.fourth, strands.tension * strands.h**2 / 12.0, 0.0)
    return np.asarray(strands.stiffness + more)


def beds(mesh: Mesh) -> Array:
    """Stiffness of the beds under all nodes, (node,) N/m."""
    return per_length(mesh.strands, mesh.strands.bed)


def without_supports(mesh: Mesh) -> Array:
    """Masses of all nodes but for those of supports at the ends of wires, (node,) kg."""
    s, mass = mesh.strands, mesh.mass.copy()
    ends = np.concatenate([s.first, s.first + s.links])
    mass[ends] = mesh.own[ends]
    return mass


def slowed_ends(mesh: Mesh, step: float) -> Array:
    """1 + drag dt m / (2 M) at the ends of all wires, for half a link of mass m and a support of mass M - m, (end,)."""
    ends = np.stack([mesh.strands.first, mesh.strands.first + mesh.strands.links], axis=1)
    slow: Array = 1.0 + 0.5 * step * mesh.strands.drag[:, None] * mesh.own[ends] / mesh.mass[ends]
    return slow.ravel()


def rows(places: Places, nodes: int) -> sparse.csr_matrix:
    """Interpolation: (point, node), the height of each point from those of the control points."""
    count = places.base.size
    row, column = np.repeat(np.arange(count), WIDTH), (places.base[:, None] + np.arange(WIDTH)).ravel()
    return sparse.csr_matrix((places.weight.ravel(), (row, column)), shape=(count, nodes))


def moving(mesh: Mesh) -> NDArray[np.bool_]:
    """Which control points may move up and down."""
    free: NDArray[np.bool_] = ~mesh.fixed[2]
    return free


def restrained_shape(
    mesh: Mesh, places: Places, heights: Array, load: Array, wires: slice = slice(None)
) -> tuple[Array, Array]:
    """Heights of all control points of wires that go through given heights, and the forces upwards that it takes.

    Args:
        places: points of the wires.
        heights: (point,) m.
        load: (node,) N upwards on the control points.
        wires: nodes of those that are asked for; others stay straight.
    """
    K, C = vertical_stiffness(mesh), rows(places, mesh.nodes)
    free, chord = np.zeros(mesh.nodes, dtype=np.bool_), mesh.straight()[2]
    free[wires] = moving(mesh)[wires]
    out = load - K @ chord + beds(mesh) * chord
    z, force = _solve(K, C, places.local, free, out, heights - C @ chord, mesh.straight()[0])
    return chord + z, force


def _solve(
    K: Any, C: Any, local: Array, free: NDArray[np.bool_], load: Array, gap: Array, x: Array, *, roughly: bool = False
) -> tuple[Array, Array]:
    """Solve K z = load + C' force, C z + local force = gap for the free control points, x in m along the line.

    Long lines are solved piece by piece, `roughly` if a first guess is enough.
    """
    z, k = np.zeros(free.size), C.shape[0]
    if free.size > AT_ONCE:
        parts = solve_by_stretches(K, C, local, free, load, gap, x, roughly=roughly)
        if parts is not None:
            return parts
    A, B = K[free][:, free], C[:, free]
    system = sparse.bmat([[A, -B.T], [B, sparse.diags(local)]], format="csc") if k else sparse.csc_matrix(A)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", scipy.sparse.linalg.MatrixRankWarning)  # told below
        found = scipy.sparse.linalg.spsolve(system, np.concatenate([load[free], gap]))
    if not np.isfinite(found).all():
        raise EquilibriumError("the wires have no equilibrium: a wire is not supported; check supports and droppers")
    z[free] = found[: found.size - k]
    return z, found[found.size - k :]


def rest_of(mesh: Mesh) -> WiresAtRest:
    """Rest under gravity with the given lengths of the ties; ties that would be pushed are slack.

    Raises:
        EquilibriumError: there is no rest.
    """
    free, K = moving(mesh), vertical_stiffness(mesh)
    chord, position = mesh.straight()[2], mesh.led(mesh.straight())
    z, x = position[2].copy(), position[0]
    ties, holds = mesh.ties, mesh.holds
    A = rows(ties.other, mesh.nodes) - rows(ties.one, mesh.nodes)
    grounded = np.isfinite(ties.ground)
    across = A @ position[:2].T + np.where(grounded[:, :2], ties.ground[:, :2], 0.0)
    ground = np.where(grounded[:, 2], ties.ground[:, 2], 0.0)
    H, fast = rows(holds.at, mesh.nodes), np.isinf(holds.stiffness[:, 2])
    stiff = np.where(fast, 0.0, spring(holds.stiffness[:, 2], holds.at.local))
    load = -mesh.plan.gravity * mesh.mass + beds(mesh) * chord + H.T @ (holds.force[:, 2] + stiff * holds.place[:, 2])
    K = K + H.T @ sparse.diags(stiff) @ H
    size = float(mesh.strands.h @ mesh.strands.links)
    constraint, local, level = H[fast], holds.at.local[fast], holds.place[fast, 2]
    hanging = rows(ties.one, mesh.nodes)[ties.lengthwise]
    softly = _SOFT * (hanging.T @ hanging)
    z += _solve(K + softly, constraint, local, free, load - K @ z, level - constraint @ z, x, roughly=True)[0]
    pull, slack = ties_springs(mesh)
    for _ in range(_MOST_STEPS):
        rise = A @ z + ground
        reach = np.sqrt((across**2).sum(axis=1) + rise**2)
        way = np.column_stack([across, rise]) / reach[:, None]
        longer = reach - ties.length
        k = np.where(longer > 0.0, pull, slack)
        force = k * longer
        tangent = k * way[:, 2] ** 2 + force / reach * (1.0 - way[:, 2] ** 2)
        out = load - K @ z - A.T @ (force * way[:, 2])
        step, restrained = _solve(
            K + A.T @ sparse.diags(tangent) @ A, constraint, local, free, out, level - constraint @ z, x
        )
        z = z + step
        if np.abs(step).max() <= _CLOSE * size or not ties.length.size:  # without ties one step leads there
            break
    else:
        raise EquilibriumError(
            "the states of the droppers (tight or slack) do not converge; check their lengths, or give them a little "
            "`pushes`"
        )
    position[2] = z
    lift = holds.force[:, 2] + stiff * (holds.place[:, 2] - H @ z)
    lift[fast] += restrained
    return WiresAtRest(position, force, way, reach, lift)


def spring(stiffness: Array, local: Array) -> Array:
    """Stiffness between a spline and what stands beyond a spring at the wire, the local compliance in series, N/m."""
    with np.errstate(divide="ignore"):
        soft = 1.0 / stiffness + local
    return np.where(stiffness > 0.0, 1.0 / np.where(np.abs(soft) > _RIGID, soft, _RIGID), 0.0)


def ties_springs(mesh: Mesh) -> tuple[Array, Array]:
    """Stiffness of ties between splines when pulled and when pushed, N/m."""
    ties = mesh.ties
    local = ties.one.local + np.where(np.isfinite(ties.ground[:, 0]), 0.0, ties.other.local)
    local = np.where(ties.lengthwise, 0.0, local)  # across a wire, not along it
    return spring(ties.stiffness, local), spring(ties.pushes, local)


def hung(mesh: Mesh, position: Array) -> Array:
    """Unstrained lengths of links with which wires of constant level tension hang as they do, (node,) m.

    Args:
        position: (3, node) m at rest.
    """
    rest, tension = np.ones(mesh.nodes), mesh.tension
    for a, wire in enumerate(mesh.plan.wires):
        part = mesh.of(a)
        step = np.diff(position[:, part], axis=1)
        length, level = np.sqrt((step**2).sum(axis=0)), np.hypot(step[0], step[1])
        rest[part][:-1] = length / (1.0 + tension[part][:-1] * length / level / wire.axial_stiffness)
    return rest
