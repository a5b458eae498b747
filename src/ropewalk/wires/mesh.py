"""A plan of wires as plain arrays: control points, and what is attached to them.

The control points of all wires stand in one array, one wire after the other; those of a wire have the same distance
`h` from each other at rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import RopewalkError
from ropewalk.wires.bending import FEWEST, LOCAL, shares
from ropewalk.wires.plan import Array, Hold, Integers, Spot, TravellingLoad, Wire, WirePlan
from ropewalk.wires.spline import WIDTH, points

FEWEST_LINKS = 8
_CELL = 80  # links in which the local compliance is found; it decays within a few
_FRACTIONS = np.linspace(0.0, 0.5, 6)  # of a link, where it is found
_AT_NODE = 1e-6  # links
_NO_PULL = 1e-12  # of what a clamp takes over: nothing
_STIFF = 5.0  # links: where sqrt(EI / T) is longer, a wire is a beam on this mesh


class WireRuns(NamedTuple):
    """One entry for each wire."""

    first: Integers  # index of the first control point
    links: Integers
    h: Array  # distance of control points, m
    tension: Array  # N, at rest
    stiffness: Array  # EI, N m^2
    rho: Array  # kg/m
    drag: Array  # 1/s
    retardation: Array  # s
    bed: Array  # N/m^2
    clamped: NDArray[np.bool_]  # (wire, 2) whether it cannot turn at its start, and at its end
    across: Array  # (wire, 2) x of the start in m, and x per station along the chord
    local: Array  # (wire, 3) m/N, of the compliance that a point has beside the spline's: see `local_compliance`
    fourth: NDArray[
        np.bool_
    ]  # (wire,) whether it is a beam whose bending is of the fourth order in h: see `bending.py`
    level: NDArray[np.bool_]  # (wire, 2) whether it is that and clamped, at its start and at its end


class Places(NamedTuple):
    """Points of wires: the nodes that share each, and their weights."""

    base: Integers  # (point,) index of the first of them
    weight: Array  # (point, WIDTH)
    wire: Integers
    station: Array  # m
    local: Array  # (point,) m/N: the point of the wire stands this much higher than the spline, for each N upwards


class WireTies(NamedTuple):
    """Links between two points, or between a point and the ground."""

    one: Places
    other: Places  # where `grounded`, the weights are zero
    ground: Array  # (tie, 3) m; where not grounded NaN, and how much farther aside the other wire is
    stiffness: Array
    pushes: Array
    damping: Array
    length: Array
    strength: Array  # N; inf: nothing tears it
    fails_at: Array  # s; inf: never
    lengthwise: NDArray[np.bool_]  # (tie,) whether it pulls along the line


class Holds(NamedTuple):
    """Springs to the ground."""

    at: Places
    node: Integers  # (hold,) where it is at the end of a wire, that; else -1
    axes: Array  # (hold, 3, 3) of its springs, unit vectors
    stiffness: Array  # (hold, 3) N/m along its axes; inf: held fast; 0 where the node itself is `fixed`
    fixes: NDArray[np.bool_]  # (hold, 3) whether it does so along that axis, x, y or z
    damping: Array  # (hold, 3) N s/m along its axes
    place: Array  # (hold, 3) m, at time zero
    force: Array  # (hold, 3) N along x, y and z, constant
    instants: Integers  # (hold,) of the table of its displacement, 1: it stays
    time: Array  # (instant,) s, of all tables, one after the other
    moved: Array  # (3, instant) m, displacement from what it is at time zero

    def places(self, t: float) -> Array:
        """Where they are without force at an instant in s, (hold, 3) m."""
        end = np.cumsum(self.instants)
        parts = [slice(int(e - n), int(e)) for e, n in zip(end, self.instants, strict=True)]
        moved = [[np.interp(t, self.time[part], row[part]) for row in self.moved] for part in parts]
        return self.place + np.array(moved, dtype=np.float64).reshape(-1, 3)


class Mesh(NamedTuple):
    """Everything that does not change while the wires move."""

    plan: WirePlan
    strands: WireRuns
    mass: Array  # (node,) kg, with all that is clamped to the wires
    own: Array  # (node,) kg, of the wires alone
    fixed: NDArray[np.bool_]  # (3, node) whether a component stands where it is held, or goes as prescribed
    driven: NDArray[np.bool_]  # (3, node) whether it goes as prescribed
    ties: WireTies
    holds: Holds
    relief: Array  # (node,) N, by which the link behind each node pulls less than its wire
    sideways: Array  # (node,) N, constant forces along y

    @property
    def tension(self) -> Array:
        """Tension along the chord at rest of the link behind each node, (node,) N (of last nodes: without meaning)."""
        tension: Array = np.repeat(self.strands.tension, self.strands.links + 1) - self.relief
        return tension

    @property
    def nodes(self) -> int:
        """Number of control points."""
        return int(self.mass.size)

    def of(self, wire: int) -> slice:
        """The control points of a wire."""
        first = int(self.strands.first[wire])
        return slice(first, first + int(self.strands.links[wire]) + 1)

    def straight(self) -> Array:
        """Positions of all control points on the chords of their wires, (3, node) m."""
        parts = [
            np.linspace(wire.start, wire.end, int(n) + 1).T
            for wire, n in zip(self.plan.wires, self.strands.links, strict=True)
        ]
        return np.ascontiguousarray(np.concatenate(parts, axis=1))

    def led(self, position: Array, t: float = 0.0) -> Array:
        """Positions (3, node) m with what is fixed where it is at an instant in s, and all between led along evenly."""
        wanted, out = position.copy(), position.copy()
        for node, place in zip(self.holds.node, self.holds.places(t), strict=True):
            if node >= 0:
                wanted[:, node] = np.where(self.fixed[:, node], place, position[:, node])
        for a, n in enumerate(self.strands.links):
            part, along = self.of(a), np.linspace(0.0, 1.0, int(n) + 1)
            shift = (wanted - position)[:, part][:, [0, -1]]
            out[:, part] += shift[:, :1] * (1.0 - along) + shift[:, 1:] * along
        return np.where(self.fixed, wanted, out)


def links_of(wire: Wire, element: float) -> int:
    """Number of links about `element` long."""
    return max(FEWEST_LINKS, round(wire.length / element))


def mesh_of(plan: WirePlan, element: float | list[int], *, small: bool = False) -> Mesh:
    """Divide the wires of a plan.

    Args:
        plan: what there is.
        element: wanted length of a link in m, or the number of links of each wire.
        small: whether they move a little about straight lines only; then beams are of the fourth order.

    Raises:
        RopewalkError: something is attached beyond the end of a wire.
    """
    links = [links_of(wire, element) for wire in plan.wires] if isinstance(element, float) else element
    wires, count = plan.wires, np.array(links, dtype=np.int64)
    column = {
        key: np.array([getattr(wire, key) for wire in wires], dtype=np.float64)
        for key in ("tension", "bending_stiffness", "mass", "drag", "retardation", "bed", "length")
    }
    first = np.concatenate([[0], np.cumsum(count + 1)[:-1]]).astype(np.int64)
    fourth = [small and n >= FEWEST and _is_beam(wire, wire.length / n) for wire, n in zip(wires, links, strict=True)]
    clamped = np.array([[end == "clamped" for end in wire.ends] for wire in wires], dtype=np.bool_)
    strands = WireRuns(
        first, count, column["length"] / count, column["tension"], column["bending_stiffness"], column["mass"],
        column["drag"], column["retardation"], column["bed"],
        clamped,
        np.array([(wire.start[0], (wire.end[0] - wire.start[0]) / wire.length) for wire in wires]),
        np.array([
            local_compliance(wire, wire.length / n, fourth=beam)
            for wire, n, beam in zip(wires, links, fourth, strict=True)
        ]),
        np.array(fourth, dtype=np.bool_), clamped & np.array(fourth, dtype=np.bool_)[:, None],
    )  # fmt: skip
    mass = per_length(strands, strands.rho)
    _check(plan)
    own = mass.copy()
    lumps = [(lump.spot, lump.mass) for lump in plan.masses if lump.mass]
    for tie in plan.ties:
        if tie.mass:
            lumps += [(spot, 0.5 * tie.mass) for spot in (tie.spot, tie.other) if isinstance(spot, Spot)]
    at = clamped_at(strands, [spot for spot, _ in lumps])
    for base, weight, (_, lump) in zip(at.base, at.weight, lumps, strict=True):
        mass[base : base + WIDTH] += weight * lump
    holds = _holds(strands, plan)
    fixed, driven = _fixed(strands, plan, holds)
    relief, sideways = _relief(strands, plan), np.zeros_like(mass)
    pulled = clamped_at(strands, [one.spot for one in plan.sideways])
    for base, weight, one in zip(pulled.base, pulled.weight, plan.sideways, strict=True):
        sideways[base : base + WIDTH] += weight * one.force
    return Mesh(plan, strands, mass, own, fixed, driven, _ties(strands, plan), holds, relief, sideways)


def per_length(strands: WireRuns, value: Array) -> Array:
    """What the nodes take of something that wires have (wire,) of in each metre, (node,)."""
    parts = [
        each * h * shares(int(n), fourth=bool(fourth))
        for each, h, n, fourth in zip(value, strands.h, strands.links, strands.fourth, strict=True)
    ]
    return np.concatenate([np.zeros(0), *parts])


def places_of(strands: WireRuns, spots: Sequence[Spot]) -> Places:
    """Where points of wires are on the mesh."""
    wire = np.array([spot.wire for spot in spots], dtype=np.int64)
    station = np.array([spot.station for spot in spots], dtype=np.float64)
    s = station / strands.h[wire]
    base, weight = points(s, strands.links[wire], strands.level[wire])
    return Places(
        base + strands.first[wire], np.ascontiguousarray(weight[:, 0]), wire, station, local_at(strands, wire, s)
    )


def local_at(strands: WireRuns, wire: Integers, s: Array) -> Array:
    """Compliance of wires beside their splines at places in links, (point,) m/N; as kernels have it."""
    part = s - np.floor(s)
    g = part * (1.0 - part)
    c = strands.local[wire]
    inner = np.where(strands.fourth[wire], np.maximum(1.0 - np.minimum(s, strands.links[wire] - s), 0.0), 0.0)
    return np.asarray((c[:, 0] + g * g * (c[:, 1] + g * c[:, 2])) * (1.0 - inner**3))


def clamped_at(strands: WireRuns, spots: Sequence[Spot]) -> Places:
    """The same for what stays where it is: at the ends and the nodes of strings it takes hold of the node itself."""
    places = places_of(strands, spots)
    wire = places.wire
    place = places.station / strands.h[wire] if len(spots) else places.station
    for k, s in enumerate(place):
        at_end = min(abs(s), abs(s - strands.links[wire[k]])) < _AT_NODE
        if at_end or (strands.stiffness[wire[k]] == 0.0 and abs(s - round(s)) < _AT_NODE):
            node = round(s) + int(strands.first[wire[k]]) - int(places.base[k])
            places.weight[k], places.local[k] = np.eye(WIDTH)[node], 0.0
    # On fine meshes a stiff wire yields less than its spline, by 1e-7 m/N; but a spring of negative stiffness there, in
    # series with what is stiff itself, would be unstable.
    np.maximum(places.local, 0.0, out=places.local)
    return places


def _is_beam(wire: Wire, h: float) -> bool:
    return wire.bending_stiffness > 0.0 and (_STIFF * h) ** 2 * wire.tension < wire.bending_stiffness


def local_compliance(wire: Wire, h: float, *, fourth: bool = False) -> tuple[float, float, float]:
    """By how much a wire itself yields more to a force than its spline: c[0] + c[1] g^2 + c[2] g^3, m/N.

    g = f (1 - f) at the part f of a link. A spline rounds the kink of a string under a point force, as it shares the
    force; the difference to the closed form of a stiff string decays within a few links, so it acts as a spring in
    series. It is a polynomial for strings and for beams of the fourth order, and all but one between them. On beams of
    the second order it is of the order of the error of the mesh, and left out.

    Args:
        wire: its tension and bending stiffness.
        h: distance of nodes, m.
        fourth: whether it is a beam of the fourth order.
    """
    T, EI = wire.tension, wire.bending_stiffness
    if fourth:
        c0, c2, c3 = LOCAL
        return c0 * h**3 / EI, c2 * h**3 / EI, c3 * h**3 / EI
    if T <= 0.0 or _is_beam(wire, h):
        return 0.0, 0.0, 0.0
    c0, c2, c3 = _unit_compliance(float(np.sqrt(EI / T) / h))
    return c0 * h / T, c2 * h / T, c3 * h / T


@cache
def _unit_compliance(reach: float) -> tuple[float, float, float]:
    """The same for a unit tension and unit links; reach = sqrt(EI / T) in links."""
    L = float(_CELL)
    K = _lattice(reach)
    more, powers = np.zeros(_FRACTIONS.size), np.zeros((_FRACTIONS.size, 3))
    for i, f in enumerate(_FRACTIONS):
        x, g = 0.5 * L + f, f * (1.0 - f)
        base, weight = points(np.array([x]), np.array([_CELL]))
        w = np.zeros(_CELL - 1)
        w[base[0] - 1 : base[0] - 1 + WIDTH] = weight[0, 0]
        more[i], powers[i] = _exact_compliance(x, reach) - float(w @ np.linalg.solve(K, w)), (1.0, g * g, g**3)
    c0, c2, c3 = np.linalg.lstsq(powers, more, rcond=None)[0]
    return float(c0), float(c2), float(c3)


def _lattice(reach: float) -> Array:
    """Stiffness of a cell of unit links under unit tension with fixed ends, sqrt(EI / T) in links."""
    one, two = np.diff(np.eye(_CELL + 1), axis=0)[:, 1:-1], np.diff(np.eye(_CELL + 1), 2, axis=0)[:, 1:-1]
    stiffness: Array = one.T @ one + reach**2 * (two.T @ two)
    return stiffness


def _exact_compliance(x: float, reach: float) -> float:
    """x (L - x) / L - reach sinh(x / reach) sinh((L - x) / reach) / sinh(L / reach): of a stiff string as long."""
    L = float(_CELL)
    exact = x * (L - x) / L
    if reach > 0.0:
        a, b, c = (1.0 - np.exp(-2.0 * d / reach) for d in (x, L - x, L))
        exact -= 0.5 * reach * a * b / c
    return float(exact)


def _check(plan: WirePlan) -> None:
    spots = [(f"tie {tie.name}", spot) for tie in plan.ties for spot in (tie.spot, tie.other) if isinstance(spot, Spot)]
    spots += [(f"hold {hold.name}", hold.spot) for hold in plan.holds]
    spots += [(f"mass at {lump.spot.station:g} m", lump.spot) for lump in plan.masses]
    for name, spot in spots:
        wire = plan.wires[spot.wire]
        if not -1e-9 * wire.length <= spot.station <= wire.length * (1.0 + 1e-9):
            raise RopewalkError(
                f"{name} stands at {spot.station:g} m of {wire.name}, which is {wire.length:g} m long; "
                "move it onto the wire"
            )


def _column(values: list[float]) -> Array:
    return np.array(values, dtype=np.float64)


def _ties(strands: WireRuns, plan: WirePlan) -> WireTies:
    ties = plan.ties
    apart = [(np.nan, tie.aside, np.nan) if isinstance(tie.other, Spot) else tie.other for tie in ties]
    ground = np.array(apart, dtype=np.float64).reshape(-1, 3)
    one = clamped_at(strands, [tie.spot for tie in ties])
    other = clamped_at(strands, [tie.other if isinstance(tie.other, Spot) else tie.spot for tie in ties])
    other.weight[np.isfinite(ground[:, 0])] = 0.0
    return WireTies(
        one, other, ground, _column([tie.stiffness for tie in ties]), _column([tie.pushes for tie in ties]),
        _column([tie.damping for tie in ties]), _column([tie.length for tie in ties]),
        _column([tie.strength for tie in ties]), _column([tie.fails_at for tie in ties]),
        np.array([tie.lengthwise for tie in ties], dtype=np.bool_),
    )  # fmt: skip


def _relief(strands: WireRuns, plan: WirePlan) -> Array:
    """What links behind nodes pull less: at a clamp each node takes its share of the pull along the line, (node,) N."""
    out = np.zeros(int((strands.links + 1).sum()))
    for relief in plan.reliefs:
        ends, step = clamped_at(strands, (relief.start, relief.end)), np.zeros_like(out)
        for sign, base, weight in zip((1.0, -1.0), ends.base, ends.weight, strict=True):
            step[base : base + WIDTH] += sign * relief.tension * weight
        less = np.cumsum(step)
        out += np.where(np.abs(less) > _NO_PULL * relief.tension, less, 0.0)
    return out


def _holds(strands: WireRuns, plan: WirePlan) -> Holds:
    holds = plan.holds

    def threes(key: str) -> Array:
        return np.array([getattr(hold, key) for hold in holds], dtype=np.float64).reshape(-1, 3)

    tables, at_start = [_table(hold) for hold in holds], np.array([_at_start(hold) for hold in holds]).reshape(-1, 3)
    none = [(np.zeros(0), np.zeros((3, 0)))]
    at = clamped_at(strands, [hold.spot for hold in holds])
    station = at.station / strands.h[at.wire]
    side = np.where(abs(station) < _AT_NODE, 0, np.where(abs(station - strands.links[at.wire]) < _AT_NODE, 1, -1))
    node = np.where(side < 0, -1, strands.first[at.wire] + np.maximum(side, 0) * strands.links[at.wire])
    return Holds(
        at, node,
        np.array([hold.axes for hold in holds], dtype=np.float64).reshape(-1, 3, 3),
        threes("stiffness"), np.zeros((len(holds), 3), dtype=np.bool_), threes("damping"), threes("place") + at_start,
        threes("force"),
        np.array([time.size for time, _ in tables], dtype=np.int64),
        np.concatenate([time for time, _ in none + tables]), np.hstack([value for _, value in none + tables]),
    )  # fmt: skip


def _table(hold: Hold) -> tuple[Array, Array]:
    """Instants and displacements from what they are at time zero."""
    if hold.moved is None:
        return np.zeros(1), np.zeros((3, 1))
    return hold.moved.time, hold.moved.value - _at_start(hold)[:, None]


def _at_start(hold: Hold) -> Array:
    """Displacement at time zero, (3,) m."""
    if hold.moved is None:
        return np.zeros(3)
    return np.array([np.interp(0.0, hold.moved.time, row) for row in hold.moved.value])


def _fixed(strands: WireRuns, plan: WirePlan, holds: Holds) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """What ends and the holds there fix, and what goes as prescribed, (3, node); such springs of holds are put to zero.

    Only what a hold keeps along x, y and z at the node of an end: elsewhere its force keeps it.
    """
    nodes = int((strands.links + 1).sum())
    fixed, driven = np.zeros((3, nodes), dtype=np.bool_), np.zeros((3, nodes), dtype=np.bool_)
    ends = np.stack([strands.first, strands.first + strands.links], axis=1)
    for wire, both in zip(plan.wires, ends, strict=True):
        for kind, node in zip(wire.ends, both, strict=True):
            fixed[:, node] = kind != "free"
    for i, node in enumerate(holds.node):
        for j, way in enumerate(np.abs(holds.axes[i])):
            if node >= 0 and np.isinf(holds.stiffness[i, j]) and way.max() == 1.0:
                axis = int(np.argmax(way))
                fixed[axis, node], driven[axis, node] = True, holds.instants[i] > 1
                holds.stiffness[i, j], holds.fixes[i, j] = 0.0, True
    return fixed, driven


class MovingLoads(NamedTuple):
    """What travels, as arrays padded to the largest moving load."""

    size: Integers  # (moving load,) number of coordinates
    mass: Array  # (moving load, C, C)
    damping: Array
    stiffness: Array
    owner: Integers  # (contact,) its moving load
    row: Array  # (contact, C) its height is row @ q; zeros: a given force
    turn: Array  # (contact, C) what is added to the row for each metre aside
    widest: Array  # (contact,) m, the largest distance aside
    wire: Integers  # (contact,)
    behind: Array  # (contact,) m
    spring: Array  # (contact,) N/m, inf: rigid
    damper: Array  # (contact,) N s/m
    material: NDArray[np.bool_]  # (contact,) whether its station counts along the wire itself, not along x
    base: Array  # (contact,) m
    rest: Array  # (contact,) N
    sign: Array  # (contact,) +1: the moving load is below and pushes the wire up; -1: it stands on the wire
    lifts: NDArray[np.bool_]  # (contact,)

    def rows(self, aside: Array) -> Array:
        """Rows of contacts that are aside of the middle by (contact,) m, (contact, C)."""
        return self.row + aside[:, None] * self.turn


def moving_loads_of(moving_loads: list[TravellingLoad]) -> MovingLoads:
    """The arrays of all moving loads."""
    most = max([moving_load.size for moving_load in moving_loads], default=0)
    stack = np.zeros((3, len(moving_loads), most, most))
    for i, moving_load in enumerate(moving_loads):
        for j, matrix in enumerate((moving_load.mass, moving_load.damping, moving_load.stiffness)):
            stack[j, i, : moving_load.size, : moving_load.size] = matrix
    contacts = [(i, contact) for i, moving_load in enumerate(moving_loads) for contact in moving_load.contacts]
    row, turn = np.zeros((2, len(contacts), most))
    for k, (_, contact) in enumerate(contacts):
        row[k, : len(contact.row)], turn[k, : len(contact.turn)] = contact.row, contact.turn
    return MovingLoads(
        np.array([moving_load.size for moving_load in moving_loads], dtype=np.int64), stack[0], stack[1], stack[2],
        np.array([i for i, _ in contacts], dtype=np.int64),
        row, turn, _column([contact.widest for _, contact in contacts]),
        np.array([contact.wire for _, contact in contacts], dtype=np.int64),
        _column([contact.behind for _, contact in contacts]), _column([contact.stiffness for _, contact in contacts]),
        _column([contact.damping for _, contact in contacts]),
        np.array([contact.material for _, contact in contacts], dtype=np.bool_),
        _column([contact.base for _, contact in contacts]), _column([contact.rest for _, contact in contacts]),
        _column([1.0 if contact.below else -1.0 for _, contact in contacts]),
        np.array([contact.lifts_off for _, contact in contacts], dtype=np.bool_),
    )  # fmt: skip
