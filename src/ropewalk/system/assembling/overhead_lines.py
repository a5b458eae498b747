"""Overhead lines as structures: their wires are runs, droppers and arms and what holds wires on their way are ties.

Form finding (`overhead/`) gives the tension of each wire and about where it rests. Links are equally long there, and
strains count from that state, so that stations along a wire are those of its plan; its law is then

    T = EA (e0 + (1 + e0) e),   e0: strain of the wire at rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sparse

from ropewalk.mechanics import law
from ropewalk.mechanics.assembly import axes_of
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.contact_points import wheels_of
from ropewalk.model.scenario import Scenario
from ropewalk.overhead.in_space import at_full_stiffness, bow_of, in_space, near_rest
from ropewalk.overhead.plan_view import CONTACT
from ropewalk.overhead.section import Section, section_of
from ropewalk.system.assembling.assembled import Assembled, Attached
from ropewalk.system.elements.profile import Profiles
from ropewalk.system.elements.structure import About, Inertia, Lines, Nodes, Restraints, Runs, Structure, WindField
from ropewalk.system.elements.ties import Point, Tie, ties_of
from ropewalk.wires.plan import Hold, Spot, Wire
from ropewalk.wires.plan import WireTie as Planned
from ropewalk.wires.rest import hung

_SURE = 1e-9  # of a line: what is no further from its end is there


@dataclass(frozen=True)
class _WireRun:
    """A wire as a run."""

    wire: Wire
    first: int
    links: int
    rest: Array  # (axis, node) m, about where it rests
    strain: float  # e0
    place: Array  # (mesh node,) m, stations of the plan
    along: Array  # (mesh node,) m, the same points along the run

    @property
    def h(self) -> float:
        return self.wire.length / self.links

    def point(self, station: float) -> Point:
        at = float(np.interp(station, self.place, self.along)) / self.h
        return Point(self.first, self.links, self.h, at, self.wire.tension, self.wire.bending_stiffness,
                     self.wire.axial_stiffness)  # fmt: skip


def overhead_lines_of(scenario: Scenario, axes: tuple[str, ...] | None) -> Assembled:
    """The structure of all overhead lines of a scenario, without its loads.

    Args:
        scenario: what is there.
        axes: names of the axes, if not those that the scenario needs; wires that run aside need three.

    Raises:
        EquilibriumError: a line cannot rest as wanted.
    """
    sections = {name: section_of(name, line, scenario.gravity) for name, line in scenario.overhead_lines.items()}
    aside = not all(section.view.is_straight for section in sections.values())
    axes = axes or (("x", "y", "z") if aside else axes_of(scenario))
    displayed = [0, 1, 2] if len(axes) == 3 else [0, 2]
    parts, runs, on, bows = list[_Part](), list[_WireRun](), dict[str, int](), list[Array]()
    for name, section in sections.items():
        line = scenario.overhead_lines[name]
        laid = at_full_stiffness(section, line)
        laid = in_space(laid, line) if len(axes) == 3 else laid
        on |= {load: len(runs) + CONTACT for load, it in scenario.loads.items() if it.on == name}
        on |= {wheel.name: len(runs) + CONTACT for wheel in wheels_of(scenario) if wheel.on == name}
        near = near_rest(section) if len(axes) == 3 else section.rest.position
        own = list(_runs(laid, near, displayed, sum(run.links + 1 for run in runs)))
        parts.append(_Part(laid, own, displayed))
        runs += own
        bows.append(bow_of(section, line))
    gravity = np.zeros(len(axes))
    gravity[-1] = -scenario.gravity
    nodes = _nodes(parts, runs, gravity)
    restraints, names = _restraints(parts, len(axes))
    nodes.light[restraints.node] = 0.0
    nodes.mobile[restraints.node] *= restraints.free.any(axis=(1, 2))
    ties, attached = _ties(parts, nodes.mass.size)
    count = len(runs)
    structure = Structure(
        _as_runs(runs, len(axes)), nodes,
        Lines(np.arange(count), np.ones(count, dtype=np.int64), np.zeros(count),
              np.array([run.wire.length for run in runs]), Profiles.none(count)),
        restraints, WindField(np.zeros(len(axes)), np.zeros(1), np.zeros(1), 1.0), About.nothing(len(axes)),
        Inertia.nothing(len(axes)), None, None, ties=ties_of(ties, len(axes)),
    )  # fmt: skip
    station = np.concatenate([np.linspace(0.0, run.wire.length, run.links + 1) for run in runs])
    return Assembled(
        structure, axes, np.concatenate([run.rest for run in runs], axis=1), station,
        tuple(run.wire.name for run in runs), on, tuple((name, e) for e, name in enumerate(names)),
        attached=attached, stretch=np.array([run.strain for run in runs]),
        bow=np.concatenate(bows) if any(section.view.turns.any() for section in sections.values()) else None,
        sections=sections,
    )  # fmt: skip


def _runs(section: Section, near: Array, displayed: list[int], first: int) -> Iterator[_WireRun]:
    """The wires of a line that rests about at (3, node) m."""
    mesh = section.mesh()
    unstrained = hung(mesh, near)
    for i, wire in enumerate(section.plan.wires):
        part, links = mesh.of(i), int(mesh.strands.links[i])
        length = np.concatenate([[0.0], np.cumsum(unstrained[part][:-1])])
        along = length * (wire.length / length[-1])
        even = np.linspace(0.0, wire.length, links + 1)
        rest = np.array([np.interp(even, along, row) for row in near[displayed, part]])
        place = mesh.strands.h[i] * np.arange(links + 1.0)
        yield _WireRun(wire, first, links, rest, wire.length / float(length[-1]) - 1.0, place, along)
        first += links + 1


def _as_runs(runs: Sequence[_WireRun], axes: int) -> Runs:
    def column(key: str) -> Array:
        return np.array([getattr(run.wire, key) for run in runs], dtype=np.float64)

    n, strains = len(runs), np.array([-1.0, 1.0])
    laws = [
        np.array([law.TABLE, 2.0, *strains, *(run.wire.axial_stiffness * (run.strain + (1.0 + run.strain) * strains))])
        for run in runs
    ]
    return Runs(
        np.array([run.first for run in runs], dtype=np.int64), np.array([run.links for run in runs], dtype=np.int64),
        np.array([run.h for run in runs]), column("mass"), np.array(laws), np.zeros(n), column("bending_stiffness"),
        np.zeros(n), np.zeros(n), np.zeros((n, 2), dtype=np.int64), np.zeros((n, 2, axes)), np.zeros((n, 2, 2)),
        np.ones(n), np.zeros(n), np.eye(axes)[:1].repeat(n, axis=0), np.zeros((n, 1)),
    )  # fmt: skip


@dataclass(frozen=True)
class _Part:
    """One overhead line."""

    section: Section
    runs: list[_WireRun]
    displayed: list[int]  # axes, as numbers of x, y and z

    def point(self, spot: Spot) -> Point:
        return self.runs[spot.wire].point(spot.station)

    def place(self, spot: Spot) -> Array:
        """About where a point of a wire rests, (axis,) m."""
        run, (own, weight) = self.runs[spot.wire], self.point(spot).parts
        return np.asarray(run.rest[:, own - run.first] @ weight)

    def end_of(self, hold: Hold) -> tuple[int, int] | None:
        """Wire and side of a hold at an end; None: it is on the way."""
        last = float(self.section.supports[-1])  # wires that end aside are a little longer
        for side, station in enumerate((0.0, last)):
            if abs(hold.spot.station - station) <= _SURE * last:
                return hold.spot.wire, side
        return None


def _nodes(parts: Sequence[_Part], runs: Sequence[_WireRun], gravity: Array) -> Nodes:
    """Masses are shared by the nodes beside them as by levers."""
    mass = np.concatenate([np.full(run.links + 1, run.wire.mass * run.h) for run in runs])
    for run in runs:
        mass[[run.first, run.first + run.links]] *= 0.5
    drag = np.concatenate([np.full(run.links + 1, run.wire.drag) for run in runs]) * mass
    for part in parts:
        for lump in part.section.plan.masses:
            point = part.point(lump.spot)
            i = min(int(point.at), point.links - 1)
            f = point.at - i
            mass[point.first + i] += (1.0 - f) * lump.mass
            mass[point.first + i + 1] += f * lump.mass
    light, force = 1.0 / mass, mass * gravity[:, None]
    for part in parts:
        for pull in part.section.plan.sideways:  # in space
            own, weight = part.point(pull.spot).parts
            force[1, own] += weight * pull.force
    return Nodes(mass, light, light.copy(), force, drag / mass, np.zeros(mass.size))


def _restraints(parts: Sequence[_Part], axes: int) -> tuple[Restraints, list[str]]:
    """What holds the ends of wires: fast, or on rails along which weights pull. Links hold those of stitch wires."""
    node, place, free, force, names = [], [], [], [], []
    for part in parts:
        guided = {part.end_of(hold): hold for hold in part.section.plan.holds}
        for i, run in enumerate(part.runs):
            for side, (end, column) in enumerate((("start", 0), ("end", -1))):
                hold = guided.get((i, side))
                if hold is None and run.wire.ends[side] == "free":
                    continue
                names.append(f"{run.wire.name}.{end}")
                node.append(run.first + side * run.links)
                place.append(run.rest[:, column])
                stiffness = np.full(3, np.inf) if hold is None else np.array(hold.stiffness)
                free.append(np.diag((~np.isinf(stiffness[part.displayed])).astype(np.float64)))
                force.append(np.zeros(axes) if hold is None else np.array(hold.force)[part.displayed])
    count, none = len(node), np.zeros((len(node), axes, axes))
    return Restraints(
        np.arange(count), np.ones(count, dtype=np.int64), np.array(node, dtype=np.int64), np.zeros(count),
        np.array(force), np.array(free), none, none.copy(), np.array(place), np.arange(count),
        np.ones(count, dtype=np.int64), np.zeros(count), np.zeros((axes, count)), np.zeros((count, 2)),
    ), names  # fmt: skip


def _ties(parts: Sequence[_Part], nodes: int) -> tuple[list[Tie], Attached]:
    """Droppers and arms, and then what holds wires on their way, axis by axis."""
    displayed: list[tuple[Tie, Planned]] = []
    restrained: list[tuple[Tie, str]] = []
    watched: dict[str, tuple[float, Point]] = {}
    for part in parts:
        plan = part.section.plan
        for tie in plan.ties:
            other = part.point(tie.other) if isinstance(tie.other, Spot) else np.array(tie.other)[part.displayed]
            apart = np.array([0.0, tie.aside, 0.0])[part.displayed]
            more: dict[str, Any] = {"apart": apart} if isinstance(tie.other, Spot) else {}
            if tie.lengthwise and isinstance(tie.other, Spot):
                way = part.place(tie.other) + apart - part.place(tie.spot)
                more["along"] = float(way[0] ** 2 / (way**2).sum())
            tied = Tie(part.point(tie.spot), other, tie.length, (tie.stiffness, tie.pushes), (tie.damping, 0.0), **more)
            displayed.append((tied, tie))
        for hold in plan.holds:
            if part.end_of(hold) is None:
                restrained += [(tie, hold.name) for tie in _axes_of(part, hold)]
        watched |= {name: (spot.station, part.point(spot)) for name, spot in plan.watched.items()}
    arms = [tie.name for _, tie in displayed if not isinstance(tie.other, Spot)]
    supports = tuple(dict.fromkeys([*(name for _, name in restrained), *arms]))
    names = [tie.name for _, tie in displayed] + [name for _, name in restrained]
    watch = sparse.lil_matrix((len(watched), nodes))
    for row, (_, point) in enumerate(watched.values()):
        own, weight = point.parts
        watch[row, own] = weight
    attached = Attached(
        tuple(tie.name for _, tie in displayed), tuple(tie.spot.station for _, tie in displayed), supports,
        np.array([supports.index(name) if name in supports else -1 for name in names], dtype=np.int64),
        tuple(watched), tuple(station for station, _ in watched.values()), watch.tocsr(),
        {e: (tie.fails_at, tie.strength) for e, (_, tie) in enumerate(displayed)
         if np.isfinite(min(tie.fails_at, tie.strength))},
    )  # fmt: skip
    return [tie for tie, _ in displayed] + [tie for tie, _ in restrained], attached


def _axes_of(part: _Part, hold: Hold) -> Iterator[Tie]:
    """Springs, dampers and constant forces of a hold along x, y and z."""
    point, place = part.point(hold.spot), np.array(hold.place)[part.displayed]
    for a, axis in enumerate(part.displayed):
        k, c, F = (float(values[axis]) for values in (hold.stiffness, hold.damping, hold.force))
        if not (k or c or F):
            continue
        way = np.eye(len(part.displayed))[a]
        yield Tie(point, place, 0.0, (k, k), (c, c), F, way, along=float(axis == 0))
