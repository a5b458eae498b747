"""From a scenario to a structure and to what it carries."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics import law
from ropewalk.mechanics.assembly import components, pack, speed_table
from ropewalk.mechanics.bodies import Bodies as AssembledBodies
from ropewalk.mechanics.chain import BLOCK, COULOMB, DRAGGED, FRICTIONLESS, Array, Integers
from ropewalk.mechanics.compiled import records
from ropewalk.mechanics.loading import Loading
from ropewalk.mechanics.multibody_system import MARGIN
from ropewalk.model.axles import Axles
from ropewalk.model.law import Hooke
from ropewalk.model.line import Line, spatial
from ropewalk.model.load import AnyLoad, ExternalModel, GivenForces, Rolling
from ropewalk.model.net import CableEdge
from ropewalk.model.scenario import Scenario
from ropewalk.model.support import Fixed
from ropewalk.model.train import TrainSection
from ropewalk.model.travel import FreeTravel
from ropewalk.model.walker import Walker
from ropewalk.system.assembling.assembled import Assembled, on_of
from ropewalk.system.assembling.carriage_assembly import with_carriages
from ropewalk.system.assembling.laid import Laid
from ropewalk.system.assembling.restraints import restraints_of
from ropewalk.system.assembling.sections import sections_of, sheaves_of
from ropewalk.system.assembling.surface_paths import Nets
from ropewalk.system.contact import contact_record
from ropewalk.system.contact.contact_record import BODY, CONTACT, FORCE, FREE, NOT, STANDS
from ropewalk.system.contact.feet import is_led, steps_by_table, with_steps
from ropewalk.system.contact.tables import Tables
from ropewalk.system.elements.hysteresis import packed_of
from ropewalk.system.elements.profile import Profiles
from ropewalk.system.elements.saddles import saddles_of
from ropewalk.system.elements.segments import Segments
from ropewalk.system.elements.structure import About, Inertia, Lines, Nodes, Restraints, Runs, Structure, WindField
from ropewalk.system.loads.bodies import BLOWN, PUSHED, BodyArrays
from ropewalk.system.loads.carriages import Carriages
from ropewalk.system.loads.tethers import TETHER

# Sine of the angle to the vertical below which a way on a net goes straight up.
_UPRIGHT = 1e-9
# Part of the compliance of its springs by which a contact without mass gives way at a support.
FIRM = 1e-12
# Mass that a line lends to what touches it without one, over that of a link.
_LENT = 0.5


class _Cable(NamedTuple):
    """What the runs of a line have in common."""

    law: Array
    mass: float  # kg/m
    drag: float  # 1/s
    damping: float = 0.0  # N s
    bending: float = 0.0  # N m^2
    bed: float = 0.0  # N/m^2
    width: float = 0.0  # m
    ends: tuple[Array, Array] | None = None  # (axis,) m
    clamped: tuple[bool, bool] = (False, False)
    hysteresis: Array = np.zeros(1)

    @staticmethod
    def of(line: Line, axes: tuple[str, ...]) -> _Cable:
        """Those of a line."""
        one, other = (
            isinstance(support, Fixed) and support.clamped for support in (line.start_support, line.end_support)
        )
        return _Cable(
            pack(line.law, line.axial_stiffness), line.mass, line.alpha, line.axial_damping,
            line.bending_stiffness or 0.0, line.foundation or 0.0, line.wind_drag,
            (components(line.start, axes), components(line.end, axes)), (one, other), packed_of(line),
        )  # fmt: skip


def _cables(scenario: Scenario, axes: tuple[str, ...]) -> dict[str, _Cable]:
    """All lines, and the edge cables of nets."""
    cables = {name: _Cable.of(line, axes) for name, line in scenario.lines.items()}
    for name, net in scenario.nets.items():
        if isinstance(net.edge, CableEdge):
            cables[f"{name}.edge"] = _Cable(pack(Hooke(), net.edge.axial_stiffness), net.edge.mass, net.drag)
    return cables


def assembled_of(scenario: Scenario, laid: Laid, rest: Array, until: float, axes: tuple[str, ...]) -> Assembled:
    """The structure of a scenario laid out, whose nodes rest about at places (node, 3) in m."""
    displayed, dim = [0, 2] if len(axes) == 2 else [0, 1, 2], len(axes)
    nets = Nets(scenario, laid) if scenario.nets else None
    sections = list(sections_of(scenario, laid, set(nets.corners()) if nets is not None else set()))
    original = np.concatenate(
        [
            np.zeros(0, dtype=np.int64),
            *(node for _, node, _ in sections),
            np.array([s.node for s in laid.sheaves], dtype=np.int64),
        ]
    )
    if nets is not None:
        original = nets.number(original)
    lines = scenario.lines.items()
    crowns = [(f"{name}.{own}", saddle) for name, line in lines for own, saddle in line.saddles.items()]
    if crowns:
        original = np.concatenate([original, rest.shape[0] + np.arange(len(crowns))])
        rest = np.concatenate([rest, [spatial(saddle.at) for _, saddle in crowns]])
    cables = _cables(scenario, axes)
    links = [node.size - 1 for _, node, _ in sections]
    h = [(s[-1] - s[0]) / (s.size - 1) for *_, s in sections]
    begin = [s[0] for *_, s in sections]
    own, names = [cables[name] for name, *_ in sections], list(cables)
    of = [names.index(name) for name, *_ in sections]
    ways, first = nets.ways if nets is not None else (), np.cumsum([0, *(n + 1 for n in links)])[:-1].tolist()
    lengths = [max(s[-1] for name, _, s in sections if name == mine) for mine in names]
    on = {name: names.index(load.on) for name, load in scenario.loads.items() if load.on in names}
    n, n_lines = original.size, original.size - len(crowns)
    for way in ways:
        if way.load not in on:
            on[way.load] = len(lengths)
            lengths.append(0.0)
        of.append(on[way.load])
        first.append(n)
        n += way.places.shape[0]
        links.append(way.places.shape[0] - 1)
        h.append(way.h)
        begin.append(way.begin)
        own.append(_Cable(np.array([law.CUBIC, law.NO_FLOOR, 0.0, 0.0, 0.0]), 0.0, 0.0))
        lengths[on[way.load]] += 0.0 if way.stands else way.h * links[-1]
    r = np.zeros((dim, n))
    r[:, : original.size] = rest[original][:, displayed].T
    gravity = np.zeros(dim)
    gravity[-1] = -scenario.gravity
    mass, lag, level = np.zeros(n), np.zeros(n), np.zeros(n)
    segments = Segments.of(scenario.lines, sections, n)
    weights = np.array([cable.mass for cable in own[: len(sections)]])[:, None] * gravity
    sheaves = sheaves_of(laid, sections, weights, sum(n + 1 for n in links[: len(sections)]))
    over = set() if sheaves is None else set(sheaves.run.tolist())
    clamped, turned = np.zeros((len(links), 2), dtype=np.int64), np.zeros((len(links), 2, dim))
    for s, (name, *_) in enumerate(sections):
        cable, part = own[s], slice(first[s], first[s] + links[s] + 1)
        m = np.full(links[s] + 1, cable.mass * h[s])
        if segments is not None and name in scenario.lines:
            m = segments.rho[part] * h[s]
        m[0] *= 1.0 if s - 1 in over else 0.5  # nodes that pass keep their mass
        m[-1] *= 1.0 if s in over else 0.5
        mass[part], lag[part] = m, cable.drag * m
        if cable.ends is None:
            continue
        one, other = cable.ends
        level[part] = np.linspace(one[-1], other[-1], links[s] + 1)
        way = (other - one) / np.linalg.norm(other - one) * h[s]
        before, after = (sections[i][0] if 0 <= i < len(sections) else None for i in (s - 1, s + 1))
        for side, is_end in enumerate((before != name, after != name)):
            if is_end and cable.clamped[side]:
                clamped[s, side], turned[s, side] = 1, way if side == 0 else -way
    if nets is not None:
        nets.lump(mass, lag)
    width = max((cable.law.size for cable in own), default=1)
    lags = max((cable.hysteresis.size for cable in own), default=1)
    runs = Runs(
        np.array(first, dtype=np.int64), np.array(links, dtype=np.int64), np.array(h),
        np.array([cable.mass for cable in own]),
        np.array([np.pad(cable.law, (0, width - cable.law.size)) for cable in own]).reshape(len(own), width),
        np.array([cable.damping for cable in own]), np.array([cable.bending for cable in own]),
        np.array([cable.bed for cable in own]), np.array([cable.width for cable in own]), clamped, turned,
        np.zeros((len(links), 2, 2)),
        np.array([float(name in scenario.lines) for name, *_ in sections] + [0.0] * len(ways)),
        np.array([0.0] * len(sections) + [way.firm for way in ways]), np.tile(np.eye(dim)[0], (len(links), 1)),
        np.array([np.pad(one.hysteresis, (0, lags - one.hysteresis.size)) for one in own]).reshape(len(own), lags),
    )  # fmt: skip
    restraints = restraints_of(scenario, laid, sections, original, gravity, until, axes, nets)
    light = np.divide(1.0, mass, out=np.zeros(n), where=mass > 0.0)
    light[restraints.node] = 0.0
    surfaces = nets.surfaces(dict(enumerate(first[len(sections) :]))) if nets is not None else None
    mobile = _mobile(mass, light, restraints)
    if surfaces is not None:
        A = surfaces.shares(n)
        r += np.asarray((A @ r.T).T)
        for s in range(len(sections), len(links)):
            runs.ahead[s] = _level(r[:, first[s] + links[s]] - r[:, first[s]])
        mobile[surfaces.node] = np.asarray(abs(A) @ (mobile * np.asarray(abs(A).sum(axis=0)).ravel()))[surfaces.node]
    count = np.bincount(of, minlength=len(lengths))
    structure = Structure(
        runs,
        Nodes(
            mass, light, mobile, mass * gravity[:, None],
            np.divide(lag, mass, out=np.zeros(n), where=mass > 0.0), level,
        ),
        Lines(
            np.concatenate([[0], np.cumsum(count)[:-1]]).astype(np.int64), count.astype(np.int64), np.array(begin),
            np.array(lengths), Profiles.of(scenario, names, lengths, until),
        ),
        restraints, _wind(scenario, until, axes), About.nothing(dim), Inertia.nothing(dim), surfaces, sheaves,
        np.zeros(n) if (runs.law[:, 0] == law.RIGID).any() else None,
        saddles=saddles_of(scenario, sections, first, h, n_lines, axes), segments=segments,
    )  # fmt: skip
    where = {int(n): e for e in range(restraints.mass.size) for n in restraints.members(e)}
    at_ends = {end.name: int(np.flatnonzero(original == end.node)[0]) for end in laid.ends}
    supports = tuple((name, where[node]) for name, node in at_ends.items())
    supports += tuple((name, where[node]) for node, (name, _) in enumerate(crowns, n_lines))
    station = np.concatenate([*(station for *_, station in sections), np.full(n, np.nan)])[:n]
    wheels = tuple(f"{wheel.line}.{wheel.name}" for wheel in laid.sheaves if wheel.link >= 0)
    mine = tuple(name for name, *_ in sections)
    return Assembled(structure, axes, r, station, mine, on, supports, nets, sheave=wheels)


def _level(way: Array) -> Array:
    """Unit vector (axis,) above which a way goes; along x if it goes straight up."""
    level = np.concatenate([way[:-1], [0.0]])
    size = float(np.linalg.norm(level))
    return level / size if size > _UPRIGHT * float(np.linalg.norm(way)) else np.eye(way.size)[0]


def _mobile(mass: Array, light: Array, restraints: Restraints) -> Array:
    found = light.copy()
    for e in range(restraints.mass.size):
        nodes = restraints.members(e)
        weight = restraints.mass[e] + mass[nodes].sum()
        found[nodes] = float(restraints.free[e].any()) / weight if weight > 0.0 else 0.0
    return found


def _wind(scenario: Scenario, until: float, axes: tuple[str, ...]) -> WindField:
    wind = scenario.wind
    if wind is None:
        return WindField(np.zeros(len(axes)), np.zeros(1), np.zeros(1), 1.0)
    direction = components(wind.direction, axes)
    time, speed = speed_table(wind.speed, until)
    return WindField(direction / np.linalg.norm(direction), time, speed, wind.air_density)


def contacts_of(
    scenario: Scenario, loading: Loading, structure: Structure, on: Mapping[str, int]
) -> tuple[Any, Tables, BodyArrays]:
    """Contacts of all loads, their histories, and what has a mass above them.

    Args:
        scenario: what is there.
        loading: its loads.
        structure: what they travel on.
        on: numbers of the lines of loads, by their names.
    """
    wheels, loads, dim = loading.wheels, loading.loads, len(loading.axes)
    contacts = records(len(wheels), CONTACT)
    names = list(scenario.loads)
    lines = list(scenario.lines)
    contacts["line"] = [lines.index(wheel.on) if wheel.with_last else on_of(on, wheel) for wheel in wheels]
    contacts["load"] = [names.index(wheel.load) for wheel in wheels]
    contacts["begin"] = [wheel.start for wheel in wheels]
    for key in ("speed_first", "speed_count", "force_first", "force_count"):
        contacts[key] = getattr(loads, key)
    contacts["lift"], contacts["clear"] = [wheel.lift for wheel in wheels], [not wheel.ground for wheel in wheels]
    contacts["measure"], contacts["frictionless"] = loads.measure, loads.contact == FRICTIONLESS
    contacts["rubs"] = np.where(
        loads.contact == COULOMB, STANDS, np.where(loads.contact == DRAGGED, contact_record.DRAGGED, NOT)
    )
    contacts["friction"] = np.nan_to_num(loads.friction)  # of prescribed travel it is asked whether it is enough
    contacts["block"] = loads.friction_model == BLOCK
    contacts["stays"] = [wheel.at_end == "stay" for wheel in wheels]
    contacts["refuses"] = [wheel.at_end == "refuse" for wheel in wheels]
    contacts["before"] = np.nan
    tables = Tables(
        loads.speed_time, loads.speed_value, loads.speed_path, loads.force_time, loads.force_value, np.zeros(1),
        np.zeros(1),
    )  # fmt: skip
    lends = _lent(structure, contacts)
    given = np.array([_only_presses(scenario.loads[wheel.load]) for wheel in wheels], dtype=np.bool_)
    heavy = np.flatnonzero(~given | (lends > 0.0)).tolist()
    contacts["lent"] = np.where(given, lends, 0.0)
    tables = with_steps(scenario, loading, structure, contacts, tables)
    contacts["led"] = led = [is_led(scenario.loads[wheel.load]) for wheel in wheels]
    contacts["kind"] = FORCE
    contacts["kind"][heavy] = BODY
    contacts["rolls"] = [isinstance(scenario.loads[wheel.load], Rolling | Walker | ExternalModel) for wheel in wheels]
    bearing = np.cumsum([not wheels[k].with_last for k in heavy]) - 1  # of some contacts one body, of others theirs
    contacts["first"][heavy] = dim * bearing
    runs, first = structure.runs, structure.lines.first[contacts["line"]]
    h = np.where(runs.firm[first] > 0.0, 0.0, runs.h[first])  # no support is at the ends of a way on a net
    contacts["margin"][heavy] = MARGIN * h[heavy]
    text = [k for k, wheel in enumerate(wheels) if wheel.margin is not None]
    contacts["margin"][text] = [wheels[k].margin for k in text]
    lengths = structure.lines.length[contacts["line"]]
    for contact, wheel, length in zip(contacts, wheels, lengths, strict=True):
        contact["brake_low"], contact["brake_high"] = -np.inf, np.inf
        if wheel.free is not None:
            _travel_freely(contact, wheel.free, float(length))
    contacts["margin"][led] = 0.0
    shared, heavy = heavy, [k for k in heavy if not wheels[k].with_last]
    places = dim * len(heavy)
    load = np.repeat(contacts["load"][heavy], dim).astype(np.int64)
    if loading.multibody_system is None:
        owner = np.stack([np.repeat(heavy, dim), np.tile(np.arange(dim), len(heavy))], axis=1).astype(np.int64)
        mass = np.repeat(lends[heavy], dim)
        contacts["light"][heavy] = np.divide(1.0, lends[heavy])
        return contacts, tables, _bodies([], mass, np.zeros(places), owner, load, len(names))
    multibody_system = loading.multibody_system.bodies
    tables = tables._replace(drive_time=multibody_system.drive_time, drive_value=multibody_system.drive_value)
    for key in ("drive_first", "drive_count"):
        contacts[key] = multibody_system.wheels[key]
    count = places + multibody_system.coordinates.size
    mass, force, owner = np.zeros(count), np.zeros(count), np.full((count, 2), -1, dtype=np.int64)
    for k in heavy:
        own = contacts[k]["first"] + np.arange(dim)
        mass[own] = multibody_system.wheels[k]["mass"][:dim]
        force[own[-1]] = -scenario.gravity * mass[own[-1]]
        mass[own] = np.where(mass[own] > 0.0, mass[own], lends[k])
        owner[own, 0], owner[own, 1] = k, np.arange(dim)
    parts = []
    load = np.pad(load, (0, count - places))
    for v, vehicle in enumerate(multibody_system.vehicles):
        own, n = int(vehicle["coordinates"]), int(vehicle["coordinates"] + vehicle["wheels"])
        at = [places + int(vehicle["first"]) + i for i in range(own)]
        locations = list(zip(multibody_system.wheel[v, : n - own], multibody_system.axis[v, : n - own], strict=True))
        at += [int(contacts[k]["first"] + a) for k, a in locations]
        np.add.at(force, at, multibody_system.load[v, :n])
        begin = int(vehicle["first"])
        below = [b for b in multibody_system.buffers if begin <= b["coordinate"] < begin + own]
        at += [int(contacts[b["wheel"]]["first"] + dim - 1) for b in below]
        hangs = multibody_system.tethers["wheel"][multibody_system.tethers["first"] == begin].tolist()
        more = [
            int(contacts[k]["first"] + a) for k in (*hangs, *(k for k, _ in locations)) if led[k] for a in range(dim)
        ]
        at += [c for c in dict.fromkeys(more) if c not in at]  # a foot is where its leg and the line are in balance
        M, C, K = (
            np.pad(m[v, :n, :n], (0, len(at) - n)) for m in (multibody_system.M, multibody_system.C, multibody_system.K)
        )
        for j, buffer in enumerate(below, start=n):  # a contact without mass below the wheel
            both = np.ix_([int(buffer["coordinate"]) - begin, j], [int(buffer["coordinate"]) - begin, j])
            K[both] += float(buffer["stiffness"]) * np.array([[1.0, -1.0], [-1.0, 1.0]])
            contacts[buffer["wheel"]]["lift"] = buffer["side"]
        parts.append((np.array(at), M, C, K))
        hangs += [int(buffer["wheel"]) for buffer in below]
        load[at[:own]] = contacts["load"][locations[0][0] if locations else hangs[0]]
    bodies = _bodies(parts, mass, force, owner, load, len(names))
    bodies = bodies._replace(
        tethers=_tethers(multibody_system, contacts, places),
        blown=_blown(multibody_system, contacts, heavy, places),
    )
    for k in heavy:
        own = contacts[k]["first"] + np.arange(dim)
        mine = [other for other in shared if contacts[other]["first"] == own[0]]
        contacts["light"][mine] = len(mine) * bodies.per_mass[own].max()
        above = [bodies.K[p, i, i] for p, n in enumerate(bodies.size) for i in range(n) if bodies.at[p, i] in own]
        stiffest = max([*above, *bodies.tethers["stiffness"][bodies.tethers["contact"] == k]], default=0.0)
        contacts[k]["least"] = FIRM / stiffest if stiffest > 0.0 else 0.0
    return contacts, tables, with_carriages(scenario, loading, contacts, bodies, places)


def _only_presses(load: AnyLoad) -> bool:
    """Whether nothing stands on the contacts of a load."""
    return (
        isinstance(load, GivenForces)
        or steps_by_table(load)
        or (isinstance(load, ExternalModel) and not (load.exchange.stiffness or load.exchange.damping))
    )


def _travel_freely(contact: Any, free: FreeTravel, length: float) -> None:
    """Note how a contact travels freely along a line of a length in m."""
    contact["travel"], contact["friction"], contact["block"] = FREE, free.friction, free.friction_model == "block"
    contact["rolling"], contact["viscous"] = free.rolling, free.viscous
    contact["driver"] = 0.0 if free.driver is None else free.driver.force
    if free.brake is not None:
        endless = np.inf if free.brake.rate is not None else 0.0
        contact["brake"] = endless if free.brake.force is None else free.brake.force
        contact["braking"], contact["spring"] = free.brake.rate or 0.0, free.brake.stiffness or 0.0
        if free.brake.at in ("start", "both"):
            contact["brake_low"] = free.brake.within
        if free.brake.at in ("end", "both"):
            contact["brake_high"] = length - free.brake.within


def refuse_beyond(scenario: Scenario, loading: Loading, contacts: Any, structure: Structure) -> None:
    """Refuse loads that would begin beyond the end of their line, but for trains, whose axles come to it later.

    The distance of the ends of a line stands for its far one, also for axles that begin behind that.

    Raises:
        EquilibriumError: there is such a load.
    """
    shifts = dict[int, float]()
    for wheel, contact in zip(loading.wheels, contacts, strict=True):
        length, line = float(structure.lines.length[contact["line"]]), scenario.lines.get(wheel.on)
        far = length if line is None else line.distance
        beyond = wheel.start > length * (1.0 + 1e-9)
        trains = isinstance(scenario.loads[wheel.load], Axles | TrainSection)
        if beyond and not trains and not np.isclose(wheel.start, far, 1e-9):
            raise EquilibriumError(
                f"load {wheel.name} would begin {wheel.start:g} m along {wheel.on}, which ends at {length:g} m; "
                "change its from"
            )
        if beyond and line is not None and line.length is None and wheel.measured == "material":
            shifts[int(contact["load"])] = far - length
    for load, shift in shifts.items():  # with all of its wheels
        contacts["begin"][contacts["load"] == load] -= shift


def _tethers(multibody_system: AssembledBodies, contacts: Any, places: int) -> Any:
    found = records(len(multibody_system.tethers), TETHER)
    found["contact"], found["first"] = multibody_system.tethers["wheel"], places + multibody_system.tethers["first"]
    for key in ("length", "full", "stiffness", "damping", "way", "on", "across"):
        found[key] = multibody_system.tethers[key]
    return found


def _blown(multibody_system: AssembledBodies, contacts: Any, heavy: list[int], places: int) -> Any:
    drags = [(int(contacts[k]["first"]), float(multibody_system.wheels[k]["air_drag"])) for k in heavy]
    drags += [(places + c, float(drag)) for c, drag in enumerate(multibody_system.coordinates["drag"])]
    found = [pair for pair in drags if pair[1] > 0.0]
    return np.array(found, dtype=BLOWN) if found else records(0, BLOWN)


def _in_all_directions(
    part: tuple[Integers, Array, Array, Array], mass: Array, owner: Integers
) -> tuple[Integers, Array, Array, Array]:
    """A part with the other coordinates of its contacts without mass: where one has given way, lines lean."""
    own, *matrices = part
    here = np.isin(owner[:, 0], owner[own, 0][owner[own, 0] >= 0]) & (mass == 0.0)
    more = np.setdiff1d(np.flatnonzero(here), own)
    wider = [np.pad(matrix, (0, more.size)) for matrix in matrices]
    return np.concatenate([own, more]), wider[0], wider[1], wider[2]


def _bodies(
    parts: list[tuple[Integers, Array, Array, Array]], mass: Array, force: Array, owner: Integers, load: Integers,
    loads: int,
) -> BodyArrays:  # fmt: skip
    parts = [_in_all_directions(part, mass, owner) for part in parts]
    size = np.array([at.size for at, *_ in parts], dtype=np.int64)
    most = int(size.max(initial=1))
    at = np.zeros((len(parts), most), dtype=np.int64)
    M, C, K = (np.zeros((len(parts), most, most)) for _ in range(3))
    alone = np.ones(mass.size, dtype=np.int64)
    per_mass = np.divide(1.0, mass, out=np.zeros_like(mass), where=mass > 0.0)
    weightless = np.zeros(len(parts), dtype=np.int64)
    for p, (own, m, c, k) in enumerate(parts):
        n = own.size
        at[p, :n], C[p, :n, :n], K[p, :n, :n] = own, c, k
        M[p, :n, :n] = m + np.diag(mass[own])
        alone[own] = 0
        heavy = np.diag(M[p])[:n] > 0.0
        weightless[p] = int((~heavy).sum())
        per_mass[own] = np.divide(1.0, np.diag(M[p])[:n], out=np.zeros(n), where=heavy)
    return BodyArrays(
        mass, per_mass, force, owner[:, 0].copy(), owner[:, 1].copy(), alone, size, at, M, C, K,
        np.zeros((2, len(parts), most, most)), weightless, np.zeros((most, most)), np.zeros(most), np.zeros(mass.size),
        np.zeros(mass.size), load.astype(np.int64), np.zeros(loads, dtype=np.int64), records(0, TETHER),
        records(0, BLOWN), records(0, PUSHED), np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(0),
        Carriages.nothing(),
    )  # fmt: skip


def _lent(structure: Structure, contacts: Any) -> Array:
    """Mass (contact,) in kg that inextensible lines lend to what touches them without one."""
    runs, first = structure.runs, structure.lines.first[contacts["line"]]
    if structure.is_linearised:  # there their kinks lengthen no links
        return np.zeros(contacts.size)
    return np.where(runs.law[first, 0] == law.RIGID, _LENT * runs.rho[first] * runs.h[first], 0.0)
