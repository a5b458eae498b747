"""A task: wires, what travels on them, and how closely it is to be computed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import scipy.sparse as sparse

from ropewalk.errors import EquilibriumError
from ropewalk.solve.minimum import is_definite
from ropewalk.wires.contact_location import location_at, location_below
from ropewalk.wires.equilibrium import WirePotential, settle_on_rails
from ropewalk.wires.mesh import Mesh, mesh_of
from ropewalk.wires.partners import WireExternalModel
from ropewalk.wires.plan import Array, Contact, Spot, TravellingLoad, Wire, WirePlan
from ropewalk.wires.prescribed_motion import PrescribedMotion
from ropewalk.wires.rest import WiresAtRest, hung, moving, rest_of, rows, spring, vertical_stiffness

Geometry = Literal["nonlinear", "linearised"]
_MOST_ROUNDS, _CLOSE = 20, 1e-6  # in which unstrained lengths are found, and how closely they give the tension
_INSTANT = 1e-6  # s, in which a first speed is found
_SLIGHT = 1e-6  # strain to guess with where there is no weight
# Of the length of a hanging wire: its ends are as far from each other at least; and its steepest chord.
_NARROW, _STEEP = 1e-3, 1.0 - 1e-9


@dataclass(frozen=True)
class Displayed:
    """A coordinate of a moving load that results show as a body: how high it is, and where."""

    name: str
    prescribed_motion: int
    row: Array  # (coordinate,) height over `base`
    base: float  # m
    ahead: float = 0.0  # m ahead of the contact
    wheel: int = 0  # which of the moving load's contacts that is
    between: tuple[tuple[int, float], ...] = ()  # contacts and their parts in its place, if that is not at one of them

    @property
    def shares(self) -> tuple[tuple[int, float], ...]:
        """Contacts and their parts in its place."""
        return self.between or ((self.wheel, 1.0),)


@dataclass(frozen=True)
class WireTask:
    """What is computed."""

    plan: WirePlan
    prescribed_motions: tuple[PrescribedMotion, ...]
    contacts: tuple[str, ...]  # name of each contact in results
    displayed: tuple[Displayed, ...] = ()
    element: float | list[int] = 0.25  # m, or the number of links of each wire
    geometry: Geometry = "nonlinear"
    window: float = np.inf  # m on both sides of the contacts, beyond which nothing moves
    accuracy: float | None = None  # m, of the height under contacts: the window becomes as wide as that takes
    inertia: float = 1.0  # factor on the mass along x; nonlinear only
    space: bool = False  # whether anything moves sideways
    external_models: tuple[WireExternalModel, ...] = ()  # who of the prescribed motions are external models
    near: tuple[Array, ...] | None = None  # near rest, of each wire: (3, node) m; needed where wires run aside
    bow: Array | None = None  # (node,) m sideways, from where wires are computed to where results show them, on curves
    diagnostics: tuple[str, ...] = ()  # what one should know of it
    with_loads: bool = False  # whether the wires begin at rest with what travels on them
    # From wires at rest without loads to positions and velocities (3, node) in m and m/s that they begin with.
    beginning: Callable[[WireStart], tuple[Array, Array]] | None = None


@dataclass(frozen=True)
class WireStart:
    """Wires divided and at rest."""

    mesh: Mesh
    position: Array  # (3, node) m
    unstrained: Array  # (node,) m, of the link behind each node
    rest: WiresAtRest | None  # small motion: about this


def unstretched(plan: WirePlan, element: float | list[int]) -> WirePlan:
    """The plan with wires whose stations count unstrained metres as long as their tensions ask for.

    Raises:
        RopewalkError: something is attached off its wire, or there is no rest.
    """
    if all(wire.stretched or wire.unstrained is not None for wire in plan.wires):
        return plan
    mesh = mesh_of(plan, element)
    wanted = [i for i, wire in enumerate(plan.wires) if not wire.stretched and wire.unstrained is None]
    lengths = _guess(mesh)[1]
    found = _with_lengths(plan, {i: float(lengths[mesh.of(i)][:-1].sum()) for i in wanted})
    yields = {int(mesh.holds.at.wire[i]) for i, node in enumerate(mesh.holds.node) if not mesh.fixed[::2, node].all()}
    yields |= {i for i, wire in enumerate(plan.wires) if wire.start[2] != wire.end[2]}
    for _ in range(_MOST_ROUNDS):  # where supports yield, or on slopes, the guess is none of the tension at rest
        mesh = mesh_of(found, element)
        position, unstrained = _guess(mesh)
        rest = settle_on_rails(WirePotential(mesh, unstrained), position) if yields.intersection(wanted) else None
        if rest is None:
            break
        last, soft, more = np.cumsum(mesh.strands.links), _softness(mesh), dict[int, float]()
        for i in yields.intersection(wanted):
            wire = found.wires[i]
            missing = plan.wires[i].tension - float(rest.tension[last[i] - mesh.strands.links[i] : last[i]].mean())
            if abs(missing) > _CLOSE * plan.wires[i].tension:
                more[i] = wire.length - missing * (wire.length / wire.axial_stiffness + float(soft[i]))
        if not more:
            break
        found = _with_lengths(found, more)
    return found


def _with_lengths(plan: WirePlan, lengths: dict[int, float]) -> WirePlan:
    """The plan with other unstrained lengths of some wires, in m; what is attached to them goes along."""
    wires = tuple(
        replace(wire, unstrained=lengths[i]) if i in lengths else wire for i, wire in enumerate(plan.wires)
    )  # fmt: skip

    def there(spot: Spot) -> Spot:
        return replace(spot, station=spot.station * wires[spot.wire].length / plan.wires[spot.wire].length)

    return replace(
        plan, wires=wires, holds=tuple(replace(hold, spot=there(hold.spot)) for hold in plan.holds),
        masses=tuple(replace(mass, spot=there(mass.spot)) for mass in plan.masses),
    )  # fmt: skip


def _softness(mesh: Mesh) -> Array:
    """By how much the holds at the ends of straight wires give way along them, (wire,) m/N."""
    out, holds = np.zeros(len(mesh.plan.wires)), mesh.holds
    for i in np.flatnonzero(holds.node >= 0):
        a = int(holds.at.wire[i])
        way = np.subtract(mesh.plan.wires[a].end, mesh.plan.wires[a].start) / mesh.plan.wires[a].chord
        free = np.isfinite(holds.stiffness[i]) & (holds.stiffness[i] > 0.0)
        out[a] += float(((holds.axes[i, free] @ way) ** 2 / holds.stiffness[i, free]).sum())
    return out


def ready(task: WireTask) -> tuple[WireTask, WireStart]:
    """Divide the wires and find their rest; moving loads that are to stand on the wires take their first places there.

    Raises:
        RopewalkError: something is attached off its wire, or there is no rest.
    """
    start = _linearised(task) if task.geometry == "linearised" else _nonlinear(task)
    prescribed_motions = tuple(
        loaded(start, prescribed_motion) if prescribed_motion.stands else prescribed_motion
        for prescribed_motion in task.prescribed_motions
    )
    return replace(task, prescribed_motions=prescribed_motions), start


def _linearised(task: WireTask) -> WireStart:
    for wire in task.plan.wires:
        if wire.tension <= 0.0 and not wire.bending_stiffness:
            raise EquilibriumError(
                f"{wire.name} is slack, and linearised motion requires a tension: write geometry: nonlinear, or give "
                "tension"
            )
    for hold in task.plan.holds:
        if hold.moved is not None and np.ptp(hold.moved.value[0]) > 0.0:
            raise EquilibriumError(
                f"{hold.name} moves along x, and linearised motion has constant tensions: write geometry: nonlinear"
            )
    mesh = mesh_of(task.plan, task.element, small=True)
    for i, wire in enumerate(task.plan.wires):
        if wire.tension < 0.0 and not _bears(mesh, i):
            raise EquilibriumError(
                f"{wire.name} buckles under its compression of {-wire.tension:.4g} N, and linearised motion is about "
                "a straight line: write geometry: nonlinear, or give tension"
            )
    rest = rest_of(mesh)
    return WireStart(mesh, rest.position, hung(mesh, rest.position), rest)


def _bears(mesh: Mesh, wire: int) -> bool:
    """Whether a wire bears its compression without buckling."""
    holds = mesh.holds
    at, stiff = rows(holds.at, mesh.nodes), spring(holds.stiffness[:, 2], holds.at.local)
    K = vertical_stiffness(mesh) + at.T @ sparse.diags(stiff) @ at
    own = np.arange(mesh.nodes)[mesh.of(wire)][moving(mesh)[mesh.of(wire)]]
    return bool(is_definite(K[own][:, own].tocsc()))


def _nonlinear(task: WireTask) -> WireStart:
    plan = task.plan
    mesh = mesh_of(plan, task.element)
    if task.near is not None:
        position = np.concatenate(task.near, axis=1)
        unstrained = hung(mesh, position)
    else:
        position, unstrained = _guess(mesh)
    for _ in range(2):
        found = settle_on_rails(WirePotential(mesh, unstrained), position, space=task.space)
        position = found.position
        if all(wire.unstrained is None for wire in plan.wires):
            break
        # The tension of rest, which the stencil and the local compliance go by, is known now.
        last = np.cumsum(mesh.strands.links)
        parts = [found.tension[i - n : i] for i, n in zip(last, mesh.strands.links, strict=True)]
        wires = [
            wire if wire.unstrained is None else replace(wire, tension=float(part.mean()))
            for wire, part in zip(plan.wires, parts, strict=True)
        ]
        plan = replace(plan, wires=tuple(wires))
        mesh = mesh_of(plan, task.element)
    return WireStart(mesh, position, unstrained, None)


def _guess(mesh: Mesh) -> tuple[Array, Array]:
    """Positions near rest, and unstrained lengths: of wires of given length, that; of others, what tension asks for."""
    wires = mesh.plan.wires
    tension = np.array([_stretched(wire, mesh.plan.gravity) for wire in wires])
    position = yielded(mesh, rest_of(mesh._replace(strands=mesh.strands._replace(tension=tension))).position, tension)
    unstrained = hung(mesh, position)
    for i, wire in enumerate(wires):
        if wire.unstrained is None:
            continue
        part, links = mesh.of(i), int(mesh.strands.links[i])
        unstrained[part] = wire.unstrained / links
        if wire.unstrained > (1.0 + 1e-9) * wire.chord:
            start, end = position[:, part][:, 0], position[:, part][:, -1]
            position[:, part] = hanging(start, end, wire.unstrained, links)
    return position, unstrained


def yielded(mesh: Mesh, position: Array, tension: Array) -> Array:
    """Positions near rest (3, node) m whose ends have given way along x to tensions of straight wires, (wire,) N."""
    out, s = position.copy(), mesh.strands
    for i, node in enumerate(mesh.holds.node):
        if node < 0 or mesh.fixed[0, node]:
            continue
        a, axes, stiff = int(mesh.holds.at.wire[i]), mesh.holds.axes[i], mesh.holds.stiffness[i]
        way = np.subtract(mesh.plan.wires[a].end, mesh.plan.wires[a].start) / mesh.plan.wires[a].chord
        pull = way * tension[a] * (1.0 if node == s.first[a] else -1.0) + mesh.holds.force[i]
        restrained = np.isfinite(stiff) & (stiff > 0.0)
        moved = float(axes[restrained, 0] @ (axes[restrained] @ pull / stiff[restrained]))
        part, along = mesh.of(a), np.linspace(0.0, 1.0, int(s.links[a]) + 1)
        out[0, part] += moved * (along if node != s.first[a] else 1.0 - along)
    return out


def _stretched(wire: Wire, gravity: float) -> float:
    """The tension of a wire, or one to guess with for a slack one, N."""
    if wire.unstrained is None or wire.tension > 0.0:
        return wire.tension
    return wire.mass * gravity * wire.length or _SLIGHT * wire.axial_stiffness


def hanging(start: Array, end: Array, length: float, links: int) -> Array:
    """Points of the catenary of a length in m between two points, (3, point) m, at equal distances along it.

    With the distance l along the ground and the height h between them: sinh(a) / a = sqrt(length^2 - h^2) / l, and
    the arc from the lowest point is l / (2 a) sinh of what grows by 2 a from one end to the other.
    """
    flat = np.array([end[0] - start[0], end[1] - start[1]])
    rise, way = float(end[2] - start[2]), max(float(np.hypot(*flat)), _NARROW * length)
    ratio = np.sqrt(max(length**2 - rise**2, way**2)) / way
    from scipy.optimize import brentq  # lazy: it takes long to import

    a = float(brentq(lambda a: np.sinh(a) / a - ratio, 1e-9, 1.0 + 2.0 * np.log(2.0 * ratio) + 2.0, xtol=1e-15))
    middle = np.arctanh(np.clip(rise / length, -_STEEP, _STEEP))  # half the sum of what sinh is taken of
    arc = np.linspace(np.sinh(middle - a), np.sinh(middle + a), links + 1)
    part = (np.arcsinh(arc) - (middle - a)) / (2.0 * a)
    z = start[2] + 0.5 * way / a * (np.sqrt(1.0 + arc**2) - np.cosh(middle - a))
    return np.stack([start[0] + flat[0] * part, start[1] + flat[1] * part, z])


def place_at(start: WireStart, wire: int, station: float, *, material: bool) -> tuple[float, float]:
    """Height of a wire at rest in m, and its slope in m per m of station; beyond its ends it is level.

    Args:
        station: m along the chord, or along the wire itself if `material`.
    """
    mesh, z = start.mesh, start.position[2]
    h, own = float(mesh.strands.h[wire]), z[mesh.of(wire)]
    if not 0.0 <= station <= mesh.plan.wires[wire].length:
        return float(own[0 if station < 0.0 else -1]), 0.0
    if material or start.rest is not None:
        location = location_at(mesh, wire, station / h)
        return float(location.value(z)), float(location.slope(z)) / h
    begin, along = mesh.strands.across[wire]
    location = location_below(mesh, wire, start.position[0], float(begin + along * station))
    return float(location.value(z)), float(along * location.slope(z) / location.slope(start.position[0]))


def loaded(start: WireStart, prescribed_motion: PrescribedMotion) -> PrescribedMotion:
    """A prescribed motion whose load begins at rest within itself, on contacts that go along the wires as they rest."""
    moving_load = prescribed_motion.moving_load
    stations = [float(prescribed_motion.place(np.zeros(1))[0]) - c.behind for c in moving_load.contacts]
    found = [
        place_at(start, c.wire, s, material=c.material)[0] for c, s in zip(moving_load.contacts, stations, strict=True)
    ]
    found = [z + _kink(start, c, s) for z, c, s in zip(found, moving_load.contacts, stations, strict=True)]
    height = np.array(found) - [c.base for c in moving_load.contacts]
    first = resting(moving_load, height, rows_at(moving_load, stations))
    return along(start, replace(prescribed_motion, first=first))


def _kink(start: WireStart, contact: Contact, station: float) -> float:
    """Displacement of a wire next to its spline under the static load of a contact, m: else the contact would ring."""
    mesh, a = start.mesh, contact.wire
    if not 0.0 < station < mesh.plan.wires[a].length:
        return 0.0
    least = 0.0 if np.isinf(contact.stiffness) else -0.5 / contact.stiffness
    return contact.rest * max(location_at(mesh, a, station / float(mesh.strands.h[a])).local, least)


def along(start: WireStart, prescribed_motion: PrescribedMotion) -> PrescribedMotion:
    """The same with rates as of one that goes along the wires as they rest.

    Who begins at the very end of a wire comes from level ground: only what is rigidly on the wire rises with it.
    """
    moving_load = prescribed_motion.moving_load
    if not prescribed_motion.stands:
        return prescribed_motion
    place = prescribed_motion.place(np.array([0.0, _INSTANT]))
    speed = (place[1] - place[0]) / _INSTANT
    stations = [float(place[0]) - c.behind for c in moving_load.contacts]
    slopes = [
        place_at(start, c.wire, s, material=c.material)[1] for c, s in zip(moving_load.contacts, stations, strict=True)
    ]
    rise = speed * np.array(slopes)
    lengths = [start.mesh.plan.wires[c.wire].length for c in moving_load.contacts]
    within = np.array([0.0 < s < length for s, length in zip(stations, lengths, strict=True)], dtype=np.bool_)
    row = rows_at(moving_load, stations)
    return replace(
        prescribed_motion,
        rate=_struck(moving_load, resting(moving_load, np.where(within, rise, 0.0), row), rise, row),
    )


def rows_at(moving_load: TravellingLoad, stations: Sequence[float]) -> Array:
    """Rows of all contacts at stations in m, (contact, coordinate)."""
    found = np.zeros((len(stations), moving_load.size))
    for k, (contact, station) in enumerate(zip(moving_load.contacts, stations, strict=True)):
        found[k] = contact.row
        if contact.turn:
            found[k] += float(contact.aside(np.array([station]))[0]) * np.array(contact.turn)
    return found


def _struck(moving_load: TravellingLoad, rate: Array, rise: Array, row: Array) -> Array:
    """Rates of the coordinates after a blow that gives rigid contacts the rates of the wires under them."""
    rigid = np.array([np.isinf(contact.stiffness) for contact in moving_load.contacts], dtype=np.bool_)
    if not rigid.any():
        return rate
    fast = row[rigid]
    yielding = np.linalg.solve(moving_load.mass, fast.T)
    struck: Array = rate + yielding @ np.linalg.lstsq(fast @ yielding, rise[rigid] - fast @ rate, rcond=None)[0]
    return struck


def resting(moving_load: TravellingLoad, height: Array, row: Array) -> Array:
    """Coordinates of a moving load at rest on contacts that are moved up by heights in m; or their rates, by rates.

    Args:
        moving_load: it.
        height: (contact,) m or m/s.
        row: (contact, coordinate) by which its contacts follow its coordinates.
    """
    size = moving_load.size
    rigid = np.array([np.isinf(contact.stiffness) for contact in moving_load.contacts], dtype=np.bool_)
    soft = np.where(rigid, 0.0, [contact.stiffness for contact in moving_load.contacts])
    stiffness = moving_load.stiffness + row.T @ (soft[:, None] * row)
    fast, none = row[rigid], np.zeros((int(rigid.sum()),) * 2)
    K = np.block([[stiffness, fast.T], [fast, none]])
    given = np.concatenate([row.T @ (np.where(rigid, 0.0, soft) * height), height[rigid]])
    found: Array = np.linalg.lstsq(K, given, rcond=None)[0][:size]
    return found
