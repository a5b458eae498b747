"""Small vertical motion of wires in cubic Hermite elements: the reference that the splines are measured against.

Unknowns are the rise and the slope of every node, and a node stands wherever something is attached. Time goes in steps
of Newmark's rule with constant average acceleration. The step matrix of the wires alone is factorised once; ties,
elastic holds and contacts are scalar problems, each with its own law and the compliance that the wires have within a
step, and all of them are solved together in every step (see kernel.py).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.errors import RopewalkError
from ropewalk.wires.plan import Array, Spot, TravellingLoad

from . import kernel as compiled
from . import sweeps
from .rest import HermiteModel, assembled, height, lumps

_ROUND_OFF = 1e-14  # a repeated node feels this part of what stands `reach` nodes away


@dataclass
class StepInputs:
    """What the riders do at every step, beginning with the start; contacts are counted over all riders."""

    station: Array  # (step, contact) m from the start of its wire; nothing is touched beyond its ends
    rough: Array  # (step, contact) m, what the contact feels above the wire
    given: Array  # (step, contact) N upwards, of contacts without coordinates
    push: Array  # (step, rider, coordinate) N upwards on the coordinates, their weight included


@dataclass(frozen=True)
class State:
    """A state of motion."""

    wires: Array  # (3, node, 2) displacement from rest, velocity, and force of inertia (mass times acceleration)
    moving_loads: Array  # (3, rider, coordinate) height, velocity, acceleration


@dataclass(frozen=True)
class Record:
    """What happened; the first row is the start, where no force of a contact is known."""

    contact_force: Array  # (step, contact) N, pressing together; given forces: upwards
    contact_height: Array  # (step, contact) m of the wire, without roughness; NaN beside it
    q: Array  # (step, rider, coordinate) m above the wire at rest where the first contact of the rider starts
    tie_force: Array  # (step, tie) N
    watched: Array  # (step, watched) m from rest, in the order of the plan
    end: State


def run(
    model: HermiteModel, moving_loads: Sequence[TravellingLoad], drive: StepInputs, dt: float,
    start: State | None = None
) -> Record:  # fmt: skip
    """Move riders along wires, from rest with unstrained riders unless a state is given.

    Contacts of infinite stiffness yield by what the wire yields to their force within a step: of the order dt^2.

    Args:
        model: wires at rest.
        riders: what travels; heights count from that of the wire at rest where the first contact of a rider starts.
        drive: what they do.
        dt: step, s.
        start: state at the first row of the drive.

    Raises:
        RopewalkError: the motion does not stay finite, or its forces cannot be found.
    """
    steps, size = drive.station.shape[0], max((moving_load.size for moving_load in moving_loads), default=0)
    if start is None:
        start = State(np.zeros((3, model.station.size, 2)), np.zeros((3, len(moving_loads), size)))
    table, reach, part, nodes = _table(model, dt, start)
    carried = start.wires[2] + _carry(model, dt, start.wires[:2])
    touch = _touch(model, moving_loads, drive, size)
    bodies = _bodies(moving_loads, size, dt, start)
    result = compiled.Result(
        np.zeros_like(drive.station), np.zeros_like(drive.station), np.zeros((steps, len(moving_loads), size)),
        np.zeros((steps, len(model.plan.ties))), np.zeros((steps, len(model.plan.watched))),
    )  # fmt: skip
    result.contact_force[0] = np.where(touch.given, drive.given[0], 0.0)
    result.q[0], result.tie_force[0] = start.moving_loads[0], model.rest.tie_force
    spots = np.array([model.node(spot) for spot in model.plan.watched.values()], dtype=np.int64)
    push = drive.push.reshape(steps, len(moving_loads), size)
    course = compiled.Course(
        *(np.ascontiguousarray(x, dtype=np.float64) for x in (drive.station, drive.rough, drive.given, push))
    )
    links = _links(model, nodes, reach)
    taken = compiled.march(
        table, reach, part, nodes, carried, links, touch, bodies, course, _strain(links, dt),
        _location(touch.moving_load.size, links.yields.size, reach), nodes.at[spots, 0], dt, result,
    )  # fmt: skip
    moved = np.stack([table[nodes.at + field * sweeps.LANES] for field in (sweeps.U, sweeps.V)])
    if taken < steps or not (np.isfinite(moved).all() and np.isfinite(bodies.q).all()):
        raise RopewalkError(
            f"the forces of ties and contacts were not found at or before {taken * dt:g} s; take a smaller step than "
            f"{dt:g} s, or look for rigid contacts on something immovable"
        )
    end = State(
        np.concatenate([moved, [carried - _carry(model, dt, moved)]]),
        np.stack([bodies.q, bodies.speed, bodies.acceleration]),
    )
    return Record(*result, end)


def _of_nodes(model: HermiteModel, key: str) -> Array:
    return np.array([getattr(wire, key) for wire in model.plan.wires])[model.wire]


def _factors(model: HermiteModel, dt: float) -> tuple[Array, Array, Array]:
    """Of mass and stiffness in the step matrix, and of a right side in the next one, (node,)."""
    late = 2.0 / dt * _of_nodes(model, "retardation")
    return 4.0 / dt**2 + 2.0 / dt * _of_nodes(model, "drag"), 1.0 + late, (late - 1.0) / (1.0 + late)


def _carry(model: HermiteModel, dt: float, moved: Array) -> Array:
    """What a state adds to the right side of the next step beyond M H and the forces of inertia, (node, 2) N.

    The right side is M (4 u / dt^2 + 4 v / dt + a) + C (2 u / dt + v) with C = drag M + retardation K. The steps use
    that K u is known from the right side before: then it is M H, H = (1 - CR) once u + 4 v / dt, and CR times that one.
    """
    once, _, again = (x[:, None] for x in _factors(model, dt))
    drag, late = (_of_nodes(model, key)[:, None] for key in ("drag", "retardation"))
    u, v = moved
    M, K = (_times(model.diagonal[kind], model.coupling[kind], model.free) for kind in (1, 0))
    return M(again * once * u + drag * v) + K(late * (2.0 / dt * u + v))


def _times(diagonal: Array, coupling: Array, free: NDArray[np.bool_]) -> Callable[[Array], Array]:
    matrix = assembled(diagonal, coupling)
    return lambda x: free * (matrix @ x.ravel()).reshape(x.shape)


def _table(model: HermiteModel, dt: float, start: State) -> tuple[Array, int, int, compiled.Nodes]:
    """Rows of fields for the compiled steps, the reach of a force, the nodes of a lane, and the factors by node."""
    n, restrained = model.station.size, ~model.free
    once, kept, again = _factors(model, dt)
    diagonal = once[:, None, None] * model.diagonal[1] + kept[:, None, None] * model.diagonal[0]
    coupling = once[:, None, None] * model.coupling[1] + kept[:, None, None] * model.coupling[0]
    for c in range(2):
        diagonal[restrained[:, c], c, :] = diagonal[restrained[:, c], :, c] = 0.0
        diagonal[restrained[:, c], c, c] = 1.0
        coupling[restrained[:, c], c, :] = 0.0
        coupling[1:][restrained[:-1, c], :, c] = 0.0
    W, D = np.zeros((2, n, 2, 2))
    sweeps.factorise(diagonal, coupling, W, D)
    h = np.append(np.diff(model.station), 0.0)
    h[model.first[1:] - 1] = 0.0
    reach = _reach(W, float(h.sum()) / n)
    part = max(-(-n // sweeps.LANES), reach)
    rows = part + 2 * reach + 2
    node = (np.arange(rows) - reach - 1)[:, None] + part * np.arange(sweeps.LANES)
    table, size = _aligned(rows * sweeps.FIELDS * sweeps.LANES), (rows, sweeps.FIELDS, sweeps.LANES)
    fields, inside = table.reshape(size), (node >= 0) & (node < n)

    def write(field: int, *values: Array) -> None:
        for k, value in enumerate(values):
            fields[:, field + k][inside] = value[node[inside]]

    write(sweeps.W, W[:, 0, 0], W[:, 0, 1], W[:, 1, 0], W[:, 1, 1])
    write(sweeps.D, D[:, 0, 0], D[:, 0, 1], D[:, 1, 1])
    write(sweeps.U, *start.wires[0].T)
    write(sweeps.V, *start.wires[1].T)
    write(sweeps.E, _of_nodes(model, "mass") * h / 420.0, h)
    write(sweeps.CU, (1.0 - again) * once)
    write(sweeps.CR, again)
    row, lane = reach + 1 + np.arange(n) % part, np.arange(n) // part
    at = (row * sweeps.FIELDS * sweeps.LANES + lane)[:, None] + np.array([0, sweeps.LANES])
    lumped = np.zeros(n)
    for spot, mass in lumps(model.plan):
        lumped[model.node(spot)] += mass
    rest = np.column_stack([model.rest.height, model.rest.slope])
    nodes = compiled.Nodes(
        model.first, model.station, model.free.astype(np.float64), rest, W, D, at, lumped, np.flatnonzero(lumped),
        at[restrained],
    )  # fmt: skip
    return table, reach, part, nodes


def _reach(W: Array, h: float) -> int:
    """Number of nodes after which the recurrences have forgotten their start."""
    W = W * np.array([[1.0, h], [1.0 / h, 1.0]])  # forces, and moments as forces at the end of an element
    product, reach = W, 1
    while np.abs(product).max(initial=0.0) > _ROUND_OFF:
        product = W[reach:] @ product[:-1]
        reach += 1
    return reach


def _aligned(size: int) -> Array:
    """Zeros that begin with a line of the cache: rows that straddle two of them take half as long again."""
    room = np.zeros(size + 8)
    begin = -(room.ctypes.data // 8) % 8
    return room[begin : begin + size]


def _links(model: HermiteModel, nodes: compiled.Nodes, reach: int) -> compiled.Links:
    """Ties, the change of direction of ties that are not upright, and elastic holds."""
    rows: list[tuple[int, int, float, float, float, float, float, float, float, bool]] = []
    slanted = []
    for tie, force, far, rise in zip(
        model.plan.ties, model.rest.tie_force, model.rest.tie_distance, model.rest.tie_rise, strict=True
    ):
        one = model.node(tie.spot)
        other, far_way = (model.node(tie.other), 1.0) if isinstance(tie.other, Spot) else (one, 0.0)
        rows.append(
            (one, other, -rise, far_way * rise, far - tie.length, force, tie.stiffness, tie.pushes, tie.damping, False)
        )
        turning = force / far * (1.0 - rise**2)
        if abs(turning) > 1e-9 * tie.stiffness:
            slanted.append((one, other, -1.0, far_way, 0.0, 0.0, turning, 0.0, 0.0, True))
    rows += slanted
    for hold in model.plan.holds:
        k, c = hold.stiffness[2], hold.damping[2]
        if (k or c) and np.isfinite(k):
            i = model.node(hold.spot)
            rows.append((i, i, 1.0, 0.0, 0.0, 0.0, k, 0.0, c, True))
    count, columns = len(rows), list(zip(*rows, strict=True)) or [()] * 10
    node = np.ascontiguousarray(np.array(columns[:2], dtype=np.int64).T.reshape(count, 2))
    way = np.ascontiguousarray(np.array(columns[2:4], dtype=np.float64).T.reshape(count, 2) * nodes.free[node, 0])
    stretched, force, stiffness, pushes, damping = np.array(columns[4:9], dtype=np.float64).reshape(5, count)
    wide = 2 * reach + 2
    parts, unit = [], np.array([1.0, 0.0, 0.0, 0.0])
    for i in np.unique(node[way != 0.0]):
        w, found = model.wire[i], np.zeros((wide, 2))
        lo, hi = max(model.first[w], i - reach), min(model.first[w + 1] - 1, i + reach)
        sweeps.column(nodes.W, nodes.D, i, unit, lo, hi, found)
        parts.append((found[: hi + 1 - lo, 0], np.arange(lo, hi + 1), np.full(hi + 1 - lo, i)))
    value, row, col = (np.concatenate(x) for x in zip(*parts, strict=True)) if parts else (np.zeros(0),) * 3
    compliance = sparse.csc_matrix((value, (row, col)), shape=(model.station.size,) * 2)
    spread = sparse.csr_matrix((way.ravel(), (np.repeat(np.arange(count), 2), node.ravel())), (count, len(nodes.free)))
    felt = sparse.csr_matrix(spread @ compliance @ spread.T)
    yields = felt.diagonal()
    felt.data[np.abs(felt.data) < _ROUND_OFF * yields.max(initial=0.0)] = 0.0
    felt.eliminate_zeros()
    return compiled.Links(
        node, nodes.at[node, 0], way, stretched, force, stiffness, pushes, damping,
        np.array(columns[9], dtype=np.bool_), yields,
        felt.indptr.astype(np.int64), felt.indices.astype(np.int64), felt.data,
    )  # fmt: skip


def _touch(model: HermiteModel, moving_loads: Sequence[TravellingLoad], drive: StepInputs, size: int) -> compiled.Touch:
    pairs = [(r, contact) for r, moving_load in enumerate(moving_loads) for contact in moving_load.contacts]
    rows, zero = np.zeros((len(pairs), size)), np.zeros(len(pairs))
    leading: dict[int, float] = {}
    for k, (r, contact) in enumerate(pairs):
        rows[k, : len(contact.row)] = contact.row
        end = model.plan.wires[contact.wire].length
        if r not in leading:
            leading[r] = float(height(model, contact.wire, [float(np.clip(drive.station[0, k], 0.0, end))])[0])
        zero[k] = leading[r]
    contacts = [contact for _, contact in pairs]
    return compiled.Touch(
        np.array([r for r, _ in pairs], dtype=np.int64), np.array([c.wire for c in contacts], dtype=np.int64), rows,
        np.array([1.0 if c.below or not c.row else -1.0 for c in contacts]),  # forces that are given act upwards
        np.array([c.stiffness for c in contacts], dtype=float),
        np.array([c.damping for c in contacts], dtype=float), np.array([c.lifts_off for c in contacts], dtype=np.bool_),
        np.array([not c.row for c in contacts], dtype=np.bool_), zero,
    )  # fmt: skip


def _bodies(moving_loads: Sequence[TravellingLoad], size: int, dt: float, start: State) -> compiled.Bodies:
    mass, damping, yields = np.zeros((3, len(moving_loads), size, size))
    for r, moving_load in enumerate(moving_loads):
        own = slice(moving_load.size)
        mass[r, own, own], damping[r, own, own] = moving_load.mass, moving_load.damping
        yields[r, own, own] = np.linalg.inv(
            4.0 / dt**2 * moving_load.mass + 2.0 / dt * moving_load.damping + moving_load.stiffness
        )
    q, speed, acceleration = (np.ascontiguousarray(x).copy() for x in start.moving_loads)
    return compiled.Bodies(mass, damping, yields, q, speed, acceleration, np.zeros_like(q), np.zeros_like(q))


def _strain(links: compiled.Links, dt: float) -> compiled.Strain:
    stiff = links.stiffness + 2.0 / dt * links.damping
    zero = np.zeros((7, stiff.size))
    return compiled.Strain(
        zero[0], zero[1], zero[2], zero[3], zero[4], zero[5], zero[6], stiff, 1.0 / (1.0 + stiff * links.yields)
    )  # fmt: skip


def _location(contacts: int, links: int, reach: int) -> compiled.Location:
    none, zero, place = np.full((2, contacts), np.nan), np.zeros((4, contacts)), np.zeros((3, contacts), dtype=np.int64)
    return compiled.Location(
        np.zeros(contacts, dtype=np.bool_), place[0], place[1], place[2],
        np.zeros((contacts, 4)), np.zeros((contacts, 2 * reach + 4, 2)),
        zero[0], zero[1], none[0], none[1], zero[2], zero[3], np.full(contacts, -1), np.zeros((contacts, 4)),
        np.zeros((contacts, contacts)), np.zeros((contacts, links)), np.zeros((contacts, links), dtype=np.int64),
        np.zeros(contacts, dtype=np.int64),
    )  # fmt: skip
