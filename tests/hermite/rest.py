"""Wires in cubic Hermite elements at rest: nodes where something is attached, heights, slopes and slow lifting."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError, RopewalkError
from ropewalk.wires.plan import Array, Spot, Wire, WirePlan

_MOST_ITERATIONS = 100


@dataclass(frozen=True)
class Rest:
    """Wires at rest under gravity, held by their ties."""

    height: Array  # (node,) m
    slope: Array  # (node,)
    tie_force: Array  # (tie,) N
    tie_distance: Array  # (tie,) m
    tie_rise: Array  # (tie,) cosine between the tie and the vertical


@dataclass(frozen=True)
class HermiteModel:
    """A plan divided into elements; the nodes of all wires stand one after the other."""

    plan: WirePlan
    first: NDArray[np.int64]  # (wire + 1,) first node of each wire, and the number of nodes
    station: Array  # (node,) m
    diagonal: Array  # (stiffness or mass, node, 2, 2)
    coupling: Array  # (stiffness or mass, node, 2, 2) with the node before
    free: NDArray[np.bool_]  # (node, 2)
    rest: Rest

    @cached_property
    def wire(self) -> NDArray[np.int64]:
        """Wire of each node."""
        return np.repeat(np.arange(len(self.plan.wires)), np.diff(self.first))

    @property
    def stiffness(self) -> Any:
        """Stiffness of the wires without ties and holds, sparse; rise and slope of each node in turn."""
        return assembled(self.diagonal[0], self.coupling[0])

    @property
    def mass(self) -> Any:
        """Consistent mass of the wires and what is clamped to them, sparse."""
        return assembled(self.diagonal[1], self.coupling[1])

    def node(self, spot: Spot) -> int:
        """Node that stands at a spot."""
        first, end = self.first[spot.wire : spot.wire + 2]
        return int(first + np.argmin(np.abs(self.station[first:end] - spot.station)))


def rest_of(plan: WirePlan, element: float) -> HermiteModel:
    """Divide wires into elements of about a given length and let them rest.

    Args:
        plan: what there is.
        element: wanted length of an element, m.

    Raises:
        RopewalkError: something is attached beside its wire.
        EquilibriumError: there is no rest.
    """
    spots = [spot for spot, _ in lumps(plan)] + [hold.spot for hold in plan.holds] + list(plan.watched.values())
    spots += [spot for tie in plan.ties for spot in (tie.spot, tie.other) if isinstance(spot, Spot)]
    for spot in spots:
        if not 0.0 <= spot.station <= plan.wires[spot.wire].length * (1.0 + 1e-12):
            raise RopewalkError(
                f"nothing can be attached at {spot.station:g} m of wire {plan.wires[spot.wire].name}, which is "
                f"{plan.wires[spot.wire].length:g} m long; move it onto the wire"
            )
    stations = [
        _nodes(wire, [spot.station for spot in spots if spot.wire == w], element) for w, wire in enumerate(plan.wires)
    ]
    first = np.concatenate([[0], np.cumsum([s.size for s in stations])]).astype(np.int64)
    blocks = np.zeros((2, 2, first[-1], 2, 2))
    free = np.ones((first[-1], 2), dtype=np.bool_)
    for w, (wire, s) in enumerate(zip(plan.wires, stations, strict=True)):
        own = slice(first[w], first[w + 1])
        for kind, elements in enumerate((stiffnesses(wire, np.diff(s)), masses(wire, np.diff(s)))):
            blocks[0, kind, own][:-1] += elements[:, :2, :2]
            blocks[0, kind, own][1:] += elements[:, 2:, 2:]
            blocks[1, kind, own][1:] += elements[:, 2:, :2]
        for node, end in zip((first[w], first[w + 1] - 1), wire.ends, strict=True):
            free[node] = end == "free", end != "clamped"
    nothing = np.zeros(0)
    model = HermiteModel(
        plan, first, np.concatenate(stations), blocks[0], blocks[1], free, Rest(*(nothing,) * 5)
    )  # fmt: skip
    for spot, mass in lumps(plan):
        model.diagonal[1, model.node(spot), 0, 0] += mass
    for hold in plan.holds:
        if np.isinf(hold.stiffness[2]):
            free[model.node(hold.spot), 0] = False
    return HermiteModel(plan, first, model.station, blocks[0], blocks[1], free, _rest(model, np.zeros(2 * first[-1])))


def tie_forces(model: HermiteModel) -> Array:
    """Forces of the ties at rest, (tie,) N."""
    return model.rest.tie_force


def height(model: HermiteModel, wire: int, stations: Sequence[float]) -> Array:
    """Height of a wire at rest, m, at stations along it."""
    return np.array([_row(model, Spot(wire, s)) @ _unknowns(model.rest) for s in stations])


def elasticity(model: HermiteModel, wire: int, stations: Sequence[float], force: float = 100.0) -> Array:
    """Rise of a wire per force that lifts it slowly, (station,) m/N; ties slacken.

    Args:
        model: wires at rest.
        wire: which one is lifted.
        stations: where, m.
        force: N.
    """
    rows = [_row(model, Spot(wire, s)) for s in stations]
    now = _unknowns(model.rest)
    return np.array([row @ (_unknowns(_rest(model, row * force)) - now) / force for row in rows])


def stiffnesses(wire: Wire, h: Array) -> Array:
    """Stiffness of elements of lengths h under tension, with bending and bed, (element, 4, 4)."""
    one = np.ones_like(h)
    tension = wire.tension / (30.0 * h) * _symmetric(36 * one, 3 * h, -36 * one, 3 * h, 4 * h**2, -3 * h, -(h**2))
    bending = wire.bending_stiffness / h**3 * _symmetric(12 * one, 6 * h, -12 * one, 6 * h, 4 * h**2, -6 * h, 2 * h**2)
    return np.moveaxis(tension + bending + wire.bed * _overlaps(h), -1, 0)


def masses(wire: Wire, h: Array) -> Array:
    """Consistent mass of elements of lengths h, (element, 4, 4)."""
    return np.moveaxis(wire.mass * _overlaps(h), -1, 0)


def _overlaps(h: Array) -> Array:
    one = np.ones_like(h)
    return h / 420.0 * _symmetric(156 * one, 22 * h, 54 * one, -13 * h, 4 * h**2, 13 * h, -3 * h**2)


def _symmetric(a: Array, b: Array, c: Array, d: Array, e: Array, f: Array, g: Array) -> Array:
    """4 x 4 matrices that stay the same when the element is turned round."""
    return np.array([[a, b, c, d], [b, e, f, g], [c, f, a, -b], [d, g, -b, e]])


def _nodes(wire: Wire, wanted: list[float], element: float) -> Array:
    marks = np.unique(np.clip([0.0, wire.length, *wanted], 0.0, wire.length))
    marks = marks[np.concatenate([[True], np.diff(marks) > 1e-9 * wire.length])]
    marks[-1] = wire.length
    segments = [
        np.linspace(a, b, max(1, int(np.ceil((b - a) / element - 1e-9))), endpoint=False) for a, b in pairwise(marks)
    ]
    return np.concatenate([*segments, [wire.length]])


def lumps(plan: WirePlan) -> list[tuple[Spot, float]]:
    ends = [(spot, 0.5 * tie.mass) for tie in plan.ties if tie.mass for spot in (tie.spot, tie.other)]
    return [(lump.spot, lump.mass) for lump in plan.masses] + [(s, m) for s, m in ends if isinstance(s, Spot)]


def assembled(diagonal: Array, coupling: Array) -> Any:
    n = diagonal.shape[0]
    size, each = (2 * n, 2 * n), np.arange(n)
    beside = sparse.bsr_matrix((coupling[1:], each[:-1], np.r_[0, each]), shape=size)
    return sparse.csc_matrix(sparse.bsr_matrix((diagonal, each, np.r_[each, n]), shape=size) + beside + beside.T)


def _unknowns(rest: Rest) -> Array:
    return np.column_stack([rest.height, rest.slope]).ravel()


def _row(model: HermiteModel, spot: Spot) -> Array:
    """Height of a spot from all unknowns."""
    first, end = model.first[spot.wire : spot.wire + 2]
    i = int(np.clip(np.searchsorted(model.station[first:end], spot.station) - 1, 0, end - first - 2) + first)
    h = model.station[i + 1] - model.station[i]
    q = (spot.station - model.station[i]) / h
    row = np.zeros(2 * model.station.size)
    row[2 * i : 2 * i + 2] = (1.0 - q) ** 2 * (1.0 + 2.0 * q), h * q * (1.0 - q) ** 2
    row[2 * i + 2 : 2 * i + 4] = q * q * (3.0 - 2.0 * q), h * q * q * (q - 1.0)
    return row


def _rest(model: HermiteModel, lift: Array) -> Rest:
    """Rest under gravity and further forces upwards on the unknowns, by Newton's method on which ties are slack."""
    plan, nodes = model.plan, model.station.size
    part = model.station / np.array([wire.length for wire in plan.wires])[model.wire]
    ends = np.array([(wire.start, wire.end) for wire in plan.wires])[model.wire]
    chord = ends[:, 0] + part[:, None] * (ends[:, 1] - ends[:, 0])
    level = np.zeros((nodes, 2))
    level[:, 0] = 1.0
    K = model.stiffness
    load = lift - plan.gravity * (model.mass @ level.ravel())  # consistent with the shape functions
    z = np.zeros((nodes, 2))  # above the chord
    for hold in plan.holds:
        i, k = model.node(hold.spot), hold.stiffness[2]
        gap = hold.place[2] - chord[i, 2]
        load[2 * i] += hold.force[2]
        if np.isinf(k):
            z[i, 0] = gap
        elif k:
            load[2 * i] += k * gap
            K = K + sparse.csc_matrix(([k], ([2 * i], [2 * i])), shape=K.shape)
    ties, count = plan.ties, len(plan.ties)
    one = np.array([model.node(tie.spot) for tie in ties], dtype=np.int64)
    pairs = [(t, model.node(tie.other)) for t, tie in enumerate(ties) if isinstance(tie.other, Spot)]
    B = sparse.csc_matrix((-np.ones(count), (np.arange(count), 2 * one)), shape=(count, 2 * nodes))
    far = np.zeros((count, 3))
    for t, tie in enumerate(ties):
        if not isinstance(tie.other, Spot):
            far[t] = tie.other
    if pairs:
        t, j = np.array(pairs).T
        far[t] = chord[j]
        B = B + sparse.csc_matrix((np.ones(t.size), (t, 2 * j)), shape=B.shape)
    pull, push, length = (np.array([getattr(tie, key) for tie in ties]) for key in ("stiffness", "pushes", "length"))
    free, x, apart = model.free.ravel(), z.ravel(), far - chord[one]
    close, change = 1e-12 * max(wire.length for wire in plan.wires), np.inf
    for iteration in range(_MOST_ITERATIONS):
        span = apart.copy()
        span[:, 2] += B @ x
        distance = np.maximum(np.linalg.norm(span, axis=1), 1e-12)
        rise, stretch = span[:, 2] / distance, distance - length
        stiff = np.where((stretch > 0.0) | (iteration == 0), pull, push)  # all are taut to begin with
        force = stiff * stretch
        if change < close:
            break
        out = load - K @ x - B.T @ (force * rise)
        tangent = K + B.T @ sparse.diags(stiff * rise**2 + force / distance * (1.0 - rise**2)) @ B
        try:
            x[free] += (step := scipy.sparse.linalg.splu(sparse.csc_matrix(tangent)[free][:, free]).solve(out[free]))
        except RuntimeError:  # singular
            step = np.full(1, np.inf)
        change = float(np.abs(step).max(initial=0.0))
        if not change < 1e9:
            wrong = "the wires have no equilibrium: a wire is not supported; check supports and droppers"
            raise EquilibriumError(wrong)
    else:
        raise EquilibriumError("which ties are slack at rest cannot be decided; change the length of one a little")
    slope = (ends[:, 1, 2] - ends[:, 0, 2]) / np.array([wire.length for wire in plan.wires])[model.wire]
    return Rest(chord[:, 2] + x[::2], slope + x[1::2], force, distance, rise)
