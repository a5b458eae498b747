"""From a scenario to a structure and to what it carries."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ropewalk.mechanics.assembly import axes_of, components, held_by, pack, speed_table, vector_table
from ropewalk.mechanics.bodies import Bodies as FleetBodies
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import records
from ropewalk.mechanics.fleet import MARGIN
from ropewalk.mechanics.loading import Loading
from ropewalk.model.capabilities import refusal
from ropewalk.model.joint import Joined
from ropewalk.model.load import MovingForce
from ropewalk.model.scenario import Scenario
from ropewalk.model.support import Fixed
from ropewalk.system.bodies import BLOWN, TETHER, Bodies
from ropewalk.system.capabilities import between_nodes
from ropewalk.system.contacts import BODY, CONTACT, FORCE
from ropewalk.system.motion import Tables
from ropewalk.system.structure import Holdings, Lines, Nodes, Runs, Structure, Wind
from ropewalk.webs.lengths import laid_at_rest

# Part of the compliance of its springs by which a contact without mass gives way at a support.
FIRM = 1e-12


@dataclass(frozen=True, eq=False)
class Assembled:
    """A structure, and what results name of it."""

    structure: Structure
    axes: tuple[str, ...]
    near: Array  # (axis, node) m, about where its nodes rest
    station: Array  # (node,) m along the line of each
    line: tuple[str, ...]  # (run,)
    supports: tuple[tuple[str, int], ...]  # names of supports, and which holdings they are


def structure_of(scenario: Scenario, until: float) -> Assembled:
    """The structure of a scenario, without its loads.

    Args:
        scenario: what is there.
        until: how long histories are needed, s.

    Raises:
        EquilibriumError: its lines have no rest.
    """
    laid, rest = laid_at_rest(scenario.model_copy(update={"loads": {}}), until)
    axes = axes_of(scenario)
    shown = [0, 2] if len(axes) == 2 else [0, 1, 2]
    uses = np.bincount(np.concatenate([strand.node for strand in laid.strands]), minlength=rest.shape[0])
    sections: list[tuple[str, Integers, Array]] = []
    for strand in laid.strands:
        ends = {0, strand.node.size - 1}
        inner = [i for i in range(1, strand.node.size - 1) if uses[strand.node[i]] > 1]
        if scenario.lines[strand.name].bending_stiffness:  # it does not end where something is joined to it
            if np.ptp(np.diff(strand.station)) > 1e-9 * strand.station[-1]:
                raise refusal(between_nodes(strand.name, scenario.lines[strand.name].elements))
            inner = []
        for i, j in pairwise(sorted(ends | set(inner))):
            sections.append((strand.name, strand.node[i : j + 1], strand.station[i : j + 1]))
    links = np.array([node.size - 1 for _, node, _ in sections])
    first = np.concatenate([[0], np.cumsum(links + 1)[:-1]]).astype(np.int64)
    lines = [scenario.lines[name] for name, _, _ in sections]
    h = np.array([(s[-1] - s[0]) / (s.size - 1) for *_, s in sections])
    laws = [pack(line.law, line.axial_stiffness) for line in lines]
    width = max(p.size for p in laws)
    original = np.concatenate([node for _, node, _ in sections])
    r = rest[original][:, shown].T.copy()
    dim, n = len(axes), original.size
    gravity = np.zeros(dim)
    gravity[-1] = -scenario.gravity
    mass, drag, level = np.zeros(n), np.zeros(n), np.zeros(n)
    clamped, turned = np.zeros((links.size, 2), dtype=np.int64), np.zeros((links.size, 2, dim))
    for s, line in enumerate(lines):
        part = slice(first[s], first[s] + links[s] + 1)
        m = np.full(links[s] + 1, line.mass * h[s])
        m[[0, -1]] *= 0.5
        mass[part], drag[part] = m, line.drag
        begin, end = components(line.start, axes), components(line.end, axes)
        level[part] = np.linspace(begin[-1], end[-1], links[s] + 1)
        way = (end - begin) / np.linalg.norm(end - begin) * h[s]
        before, after = (sections[i][0] if 0 <= i < len(sections) else None for i in (s - 1, s + 1))
        is_end = before != sections[s][0], after != sections[s][0]
        for side, support in enumerate((line.start_support, line.end_support)):
            if is_end[side] and isinstance(support, Fixed) and support.clamped:
                clamped[s, side], turned[s, side] = 1, way if side == 0 else -way
    runs = Runs(
        first, links.astype(np.int64), h, np.array([line.mass for line in lines]),
        np.array([np.pad(p, (0, width - p.size)) for p in laws]), np.array([line.axial_damping for line in lines]),
        np.array([line.bending_stiffness or 0.0 for line in lines]),
        np.array([line.foundation or 0.0 for line in lines]), np.array([line.wind_drag for line in lines]),
        clamped, turned, np.zeros((links.size, 2, 2)),
    )  # fmt: skip
    holdings = _holdings(scenario, sections, first, original, gravity, until, axes)
    light = np.divide(1.0, mass, out=np.zeros(n), where=mass > 0.0)
    light[holdings.node] = 0.0
    names = list(scenario.lines)
    of = np.array([names.index(name) for name, _, _ in sections])
    count = np.bincount(of, minlength=len(names))
    structure = Structure(
        runs, Nodes(mass, light, _mobile(mass, light, holdings), mass * gravity[:, None], drag, level),
        Lines(
            np.concatenate([[0], np.cumsum(count)[:-1]]).astype(np.int64), count.astype(np.int64),
            np.array([s[0] for *_, s in sections]),
            np.array([max(s[-1] for name, _, s in sections if name == own) for own in names]),
        ),
        holdings, _wind(scenario, until, axes),
    )  # fmt: skip
    where = {int(n): e for e in range(holdings.mass.size) for n in _members(holdings, e)}
    at_ends = {end.name: int(np.flatnonzero(original == end.node)[0]) for end in laid.ends}
    supports = tuple((name, where[node]) for name, node in at_ends.items())
    station = np.concatenate([station for *_, station in sections])
    return Assembled(structure, axes, r, station, tuple(name for name, _, _ in sections), supports)


def _members(holdings: Holdings, e: int) -> Integers:
    return holdings.node[holdings.first[e] : holdings.first[e] + holdings.nodes[e]]


def _mobile(mass: Array, light: Array, holdings: Holdings) -> Array:
    found = light.copy()
    for e in range(holdings.mass.size):
        nodes = _members(holdings, e)
        found[nodes] = float(holdings.free[e].any()) / (holdings.mass[e] + mass[nodes].sum())
    return found


def _holdings(
    scenario: Scenario, sections: list[tuple[str, Integers, Array]], first: Integers, original: Integers,
    gravity: Array, until: float, axes: tuple[str, ...],
) -> Holdings:  # fmt: skip
    """Supports at the ends of lines, and what keeps nodes together."""
    dim = gravity.size
    members = {int(i): np.flatnonzero(original == i) for i in np.unique(original)}
    found: dict[int, dict[str, Any]] = {
        i: {"node": nodes, "free": np.eye(dim)} for i, nodes in members.items() if nodes.size > 1
    }
    none: dict[str, Any] = {
        "mass": 0.0, "force": np.zeros(dim), "stiffness": np.zeros((dim, dim)), "damping": np.zeros((dim, dim)),
        "place": np.zeros(dim), "table": (np.zeros(1), np.zeros((dim, 1))),
    }  # fmt: skip
    for name, line in scenario.lines.items():
        mine = [node for own, node, _ in sections if own == name]
        ends = ((mine[0][0], line.start, line.start_support), (mine[-1][-1], line.end, line.end_support))
        for node, place, support in ends:
            entry = found.setdefault(int(node), {"node": members[int(node)], "free": np.eye(dim)})
            if isinstance(support, Joined):
                if support.to in scenario.joints:
                    joint = scenario.joints[support.to]
                    entry |= {"mass": joint.mass, "force": joint.mass * gravity + components(joint.force, axes)}
                continue
            free, stiffness, damping, force = held_by(support, axes)
            mass = getattr(support, "mass", 0.0)
            history = getattr(support, "displacement", (0.0,) * dim)
            entry |= {
                "mass": mass, "force": force + mass * gravity, "free": free, "stiffness": stiffness,
                "damping": damping, "place": components(place, axes), "table": vector_table(history, until, axes),
            }  # fmt: skip
    entries = [none | entry for entry in found.values()]

    def column(key: str) -> Array:
        return np.array([entry[key] for entry in entries], dtype=float)

    counts = np.array([entry["node"].size for entry in entries], dtype=np.int64)
    sizes = np.array([entry["table"][0].size for entry in entries], dtype=np.int64)
    return Holdings(
        np.cumsum(counts) - counts, counts, np.concatenate([e["node"] for e in entries]).astype(np.int64),
        column("mass"), column("force"), column("free"), column("stiffness"), column("damping"), column("place"),
        np.cumsum(sizes) - sizes, sizes, np.concatenate([e["table"][0] for e in entries]),
        np.ascontiguousarray(np.hstack([e["table"][1] for e in entries])),
    )  # fmt: skip


def _wind(scenario: Scenario, until: float, axes: tuple[str, ...]) -> Wind:
    wind = scenario.wind
    if wind is None:
        return Wind(np.zeros(len(axes)), np.zeros(1), np.zeros(1), 1.0)
    direction = components(wind.direction, axes)
    time, speed = speed_table(wind.speed, until)
    return Wind(direction / np.linalg.norm(direction), time, speed, wind.air_density)


def contacts_of(
    scenario: Scenario, loading: Loading, structure: Structure, lines: tuple[str, ...]
) -> tuple[Any, Tables, Bodies]:
    """Contacts of all loads, their histories, and what has a mass above them.

    Args:
        scenario: what is there.
        loading: its loads.
        structure: what they travel on.
        lines: names of its lines, as it numbers them.
    """
    wheels, loads, dim = loading.wheels, loading.loads, len(loading.axes)
    contacts = records(len(wheels), CONTACT)
    names = list(scenario.loads)
    contacts["line"] = [lines.index(wheel.on) for wheel in wheels]
    contacts["load"] = [names.index(wheel.load) for wheel in wheels]
    contacts["begin"] = [wheel.start for wheel in wheels]
    for key in ("speed_first", "speed_count", "force_first", "force_count"):
        contacts[key] = getattr(loads, key)
    contacts["lift"] = [wheel.lift for wheel in wheels]
    contacts["stays"] = [wheel.at_end == "stay" for wheel in wheels]
    contacts["refuses"] = [wheel.at_end == "refuse" for wheel in wheels]
    contacts["before"] = np.nan
    tables = Tables(loads.speed_time, loads.speed_value, loads.speed_path, loads.force_time, loads.force_value)
    heavy = [k for k, wheel in enumerate(wheels) if not isinstance(scenario.loads[wheel.load], MovingForce)]
    contacts["kind"] = FORCE
    contacts["kind"][heavy] = BODY
    contacts["first"][heavy] = dim * np.arange(len(heavy))
    h = structure.runs.h[structure.lines.first[contacts["line"]]]
    contacts["margin"][heavy] = [MARGIN * h[k] if wheels[k].margin is None else wheels[k].margin for k in heavy]
    places = dim * len(heavy)
    if loading.fleet is None:
        none = np.zeros((0, 2), dtype=np.int64)
        return contacts, tables, _bodies([], np.zeros(0), np.zeros(0), none, none[:, 0], len(names))
    fleet = loading.fleet.bodies
    count = places + fleet.coordinates.size
    mass, force, owner = np.zeros(count), np.zeros(count), np.full((count, 2), -1, dtype=np.int64)
    for k in heavy:
        own = contacts[k]["first"] + np.arange(dim)
        mass[own] = fleet.wheels[k]["mass"][:dim]
        force[own[-1]] = -scenario.gravity * mass[own[-1]]
        owner[own, 0], owner[own, 1] = k, np.arange(dim)
    parts = []
    load = np.zeros(count, dtype=np.int64)
    load[:places] = np.repeat(contacts["load"][heavy], dim)
    for v, vehicle in enumerate(fleet.vehicles):
        own, n = int(vehicle["coordinates"]), int(vehicle["coordinates"] + vehicle["wheels"])
        at = [places + int(vehicle["first"]) + i for i in range(own)]
        seats = list(zip(fleet.wheel[v, : n - own], fleet.axis[v, : n - own], strict=True))
        at += [int(contacts[k]["first"] + a) for k, a in seats]
        np.add.at(force, at, fleet.load[v, :n])
        parts.append((np.array(at), fleet.M[v, :n, :n], fleet.C[v, :n, :n], fleet.K[v, :n, :n]))
        hangs = fleet.tethers["wheel"][fleet.tethers["first"] == vehicle["first"]]
        load[at[:own]] = contacts["load"][seats[0][0] if seats else hangs[0]]
    bodies = _bodies(parts, mass, force, owner, load, len(names))
    bodies = bodies._replace(tethers=_tethers(fleet, contacts, places), blown=_blown(fleet, contacts, heavy, places))
    for k in heavy:
        own = contacts[k]["first"] + np.arange(dim)
        contacts[k]["light"] = bodies.per_mass[own].max()
        above = [bodies.K[p, i, i] for p, n in enumerate(bodies.size) for i in range(n) if bodies.at[p, i] in own]
        stiffest = max(above, default=0.0)
        contacts[k]["least"] = FIRM / stiffest if stiffest > 0.0 else 0.0
    return contacts, tables, bodies


def _tethers(fleet: FleetBodies, contacts: Any, places: int) -> Any:
    found = records(len(fleet.tethers), TETHER)
    found["contact"], found["first"] = fleet.tethers["wheel"], places + fleet.tethers["first"]
    for key in ("length", "stiffness", "damping"):
        found[key] = fleet.tethers[key]
    return found


def _blown(fleet: FleetBodies, contacts: Any, heavy: list[int], places: int) -> Any:
    drags = [(int(contacts[k]["first"]), float(fleet.wheels[k]["air_drag"])) for k in heavy]
    drags += [(places + c, float(drag)) for c, drag in enumerate(fleet.coordinates["drag"])]
    found = [pair for pair in drags if pair[1] > 0.0]
    return np.array(found, dtype=BLOWN) if found else records(0, BLOWN)


def _bodies(
    parts: list[tuple[Integers, Array, Array, Array]], mass: Array, force: Array, owner: Integers, load: Integers,
    loads: int,
) -> Bodies:  # fmt: skip
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
    return Bodies(
        mass, per_mass, force, owner[:, 0].copy(), owner[:, 1].copy(), alone, size, at, M, C, K,
        np.zeros((2, len(parts), most, most)), weightless, np.zeros((most, most)), np.zeros(most), np.zeros(mass.size),
        np.zeros(mass.size), load.astype(np.int64), np.zeros(loads, dtype=np.int64), records(0, TETHER),
        records(0, BLOWN),
    )  # fmt: skip
