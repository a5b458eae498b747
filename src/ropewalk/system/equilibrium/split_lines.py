"""Lines at rest that are divided into runs where forces act on them, and where they lie over sheaves.

A force at rest is one on a node: nothing bends within a link, and nothing is shared among nodes. At a sheave a line has
an end on either side, both at the sheave; how much of it is on which side, x, is as long unknown as it may slip. It is
divided evenly on both sides whatever x is, so that no node ever passes. Tensions T beside a sheave follow from those
of the links there and from what the line weighs in between, dT/dx = -rho g . t along any line. It slips as soon as

    T2 > exp(mu theta) T1   or   T1 > exp(mu theta) T2

(Euler and Eytelwein), and until it no longer does: Newton's method on x, for each of which nodes find their own rest.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from copy import copy
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ropewalk.errors import EquilibriumError
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.model.scenario import Scenario
from ropewalk.solve.minimum import cause
from ropewalk.solve.search_budget import SearchBudgetError, search
from ropewalk.solve.sensitivity import not_noted
from ropewalk.system.assembling.assembled import Assembled
from ropewalk.system.assembling.assembly import assembled_of
from ropewalk.system.assembling.laid import Laid, Over, lay
from ropewalk.system.assembling.line_shapes import attached, curves
from ropewalk.system.assembling.membranes import sheet_of
from ropewalk.system.elements.structure import Structure
from ropewalk.system.equilibrium.rest import ends_of, settled_in_wind, tensions, with_ends
from ropewalk.system.equilibrium.slipping import missed, slip
from ropewalk.system.equilibrium.softening import softened
from ropewalk.system.equilibrium.statics import SystemPotential
from ropewalk.system.equilibrium.tracks import with_tracks
from ropewalk.system.loads.loaded_structure import LoadedStructure

# Part of a link to which a place with a node stands for another one.
TOGETHER = 1e-4
# The same at a sheave, to which no load may come.
_BESIDE = 0.05
# Links may be this much longer or shorter than without marks, before lines are divided anew.
_UNEVEN = 2.0
# Part of the load on a link that an end bears for which the next two nodes bear some, see `rest.py`.
_SHARED = 0.375
# Rounds in which lines come to rest over sheaves, and before softer ones are tried; what is left of a tension then,
# and of a length.
_ROUNDS, _FEW, _EVEN, _CLOSE = 100, 12, 1e-9, 1e-10
# The most of the way to the next end by which lines slip in a round.
_FAR = 0.4
# The most that a shape goes on as it went before, over how far it went then.
_ON = 2.0
AT_SHEAVE = "a load has reached a sheave, which it cannot pass; let it stop before it"
RUN_OUT = "a line runs over a sheave up to its end, or to the next sheave; make it longer, or hold that end"


class LineForce(NamedTuple):
    """A force on a line."""

    line: str
    at: float  # m along it
    force: Array  # (axis,) N


class LineShape(NamedTuple):
    """Where lines and nets are, whatever their nodes."""

    lines: dict[str, tuple[Array, Array]]  # places along each, m, and in space, (place, 3) m
    vertex: tuple[Array, ...]  # (vertex, 3) m
    over: Over

    @staticmethod
    def of(rest: SplitRest) -> LineShape:
        """That of lines at rest."""
        return _shape(rest.assembled, rest.r, rest.over)

    def on(self, laid: Laid) -> Array:
        """About where all nodes of other ones are, (node, 3) m."""
        out = laid.place.copy()
        for own in laid.strands:
            if own.name in self.lines:
                at, places = self.lines[own.name]
                part = own.station * (at[-1] / own.station[-1])
                out[own.node] = np.stack([np.interp(part, at, column) for column in places.T], axis=1)
        for nodes, places in zip(laid.vertex, self.vertex, strict=True):
            out[nodes] = places
        return out


class SplitRest(NamedTuple):
    """Lines at rest, with marks: the places of their sheaves, and those of forces at which there is no other node."""

    assembled: Assembled  # without the forces on its lines
    potential: SystemPotential
    shape: Array  # as of the potential
    gravity: Array  # (axis,) m/s^2
    t: float  # s
    x: Array  # (mark,) m along their lines
    run: Integers  # (mark,) the run that ends there
    sheaves: tuple[tuple[str, str], ...]  # lines and names of those, which are the first marks
    forces: tuple[LineForce, ...]
    mark: tuple[int, ...]  # (force,) its mark, -1: it is at another node
    weight: dict[int, Array]  # (axis, node) N/m, of runs beside marks, over the length of their links
    before: tuple[float, Array] | None = None  # another time, and the shape then

    @property
    def r(self) -> Array:
        """Places of all nodes (axis, node), m."""
        nodes = self.assembled.structure.nodes.mass.size
        return self.shape[: self.potential.axes * nodes].reshape(self.potential.axes, nodes)

    @property
    def over(self) -> Over:
        """Where lines are over their sheaves."""
        return dict(zip(self.sheaves, self.x.tolist(), strict=False))

    @property
    def structure(self) -> Structure:
        """With the forces."""
        return self.potential.structure

    @property
    def is_loaded(self) -> bool:
        """Whether there are weights or forces."""
        return bool(self.structure.nodes.force.any() or self.structure.restraints.force.any())

    def runs_of(self, name: str) -> list[int]:
        """The runs of a line, in order."""
        return [s for s, own in enumerate(self.assembled.line) if own == name]

    def nodes_of(self, run: int) -> Integers:
        """The nodes of a run, in order."""
        first, links = (int(own[run]) for own in (self.structure.runs.first, self.structure.runs.links))
        return first + np.arange(links + 1)

    def stations(self, run: int) -> Array:
        """Where the nodes of a run are along its line, m."""
        return self.assembled.station[self.nodes_of(run)]

    def node_at(self, name: str, at: float) -> int:
        """The node closest to a place along a line in m."""
        nodes = np.concatenate([self.nodes_of(s) for s in self.runs_of(name)])
        return int(nodes[np.abs(self.assembled.station[nodes] - at).argmin()])

    def at_end(self, run: int, side: int) -> tuple[float, Array]:
        """Tension in N, and direction (axis,) of a line at the start (0) or the end (1) of a run.

        Forces are those that were found last.
        """
        nodes, runs = self.nodes_of(run), self.structure.runs
        links = np.diff(self.r[:, nodes], axis=1).T
        last, one = (0, 1) if side == 0 else (links.shape[0] - 1, links.shape[0] - 2)
        way = links[last] + (0.5 * (links[last] - links[one]) if links.shape[0] > 1 else 0.0)
        way = way / np.linalg.norm(way)
        shared = links.shape[0] > 1 and runs.arcs[run] and not runs.clamped[run, side]
        weight = (_SHARED if shared else 0.5) * runs.rho[run] * runs.h[run] * float(self.gravity @ way)
        return float(self.potential.buffers.tension[nodes[last]] + (weight if side == 0 else -weight)), way

    def beside(self, name: str, at: float) -> tuple[tuple[float, Array], tuple[float, Array]]:
        """The same behind and ahead of a node of a line at a place along it in m; at its end both of the only side."""
        station = self.assembled.station[self.node_at(name, at)]
        ends = [(s, side) for s in self.runs_of(name) for side in (1, 0) if self.stations(s)[-side] == station]
        found = [self.at_end(s, side) for s, side in ends]
        return found[0], found[-1]

    def put(self, x: Array) -> SplitRest:
        """The same with marks at other places, x (mark,) in m, which is not at rest: nodes go with the lines."""
        runs = self.assembled.structure.runs
        limits = {s: self.stations(s)[[0, -1]] for s in self.weight}
        for s, own in zip(self.run.tolist(), x.tolist(), strict=True):
            limits[s][1] = limits[s + 1][0] = own
        h, force, station = runs.h.copy(), self.assembled.structure.nodes.force.copy(), self.assembled.station.copy()
        for s, (begin, end) in limits.items():
            nodes = self.nodes_of(s)
            h[s] = (end - begin) / (nodes.size - 1)
            force[:, nodes] += (h[s] - runs.h[s]) * self.weight[s]
            station[nodes] = np.linspace(begin, end, nodes.size)
        structure = self.assembled.structure
        structure = structure._replace(runs=runs._replace(h=h), nodes=structure.nodes._replace(force=force))
        assembled = replace(self.assembled, structure=structure, station=station)
        return self._replace(assembled=assembled, x=x).under(self.forces)

    def under(self, forces: Sequence[LineForce]) -> SplitRest:
        """The same under other forces at the same marks or nodes."""
        structure, potential = self.assembled.structure, copy(self.potential)
        force = structure.nodes.force.copy()
        for own, mark in zip(forces, self.mark, strict=True):
            at = self.node_at(own.line, own.at) if mark < 0 else self.nodes_of(int(self.run[mark]))[-1]
            force[:, at] += own.force
        potential.structure = structure._replace(nodes=structure.nodes._replace(force=force))
        potential.blown = self.potential.blown.copy()
        return self._replace(potential=potential, forces=tuple(forces))

    def with_laws(self, law: Array) -> SplitRest:
        """The same with other axial laws, (run, parameter)."""
        structure = self.assembled.structure
        structure = structure._replace(runs=structure.runs._replace(law=law))
        return self._replace(assembled=replace(self.assembled, structure=structure)).under(self.forces)

    def ends(self, mark: int) -> tuple[float, float]:
        """Places on the line of a mark at which the runs beside it end, m."""
        s = int(self.run[mark])
        return float(self.stations(s)[0]), float(self.stations(s + 1)[-1])


class SplitLines:
    """Lines without stiffness against bending that come to rest under forces and over sheaves.

    Args:
        scenario: what is there; its loads do not count.
        lengths: of all lines without strain, m.
        until: how long histories are needed, s.
        axes: names of the axes.
    """

    def __init__(self, scenario: Scenario, lengths: Mapping[str, float], until: float, axes: tuple[str, ...]) -> None:
        self._scenario, self._lengths, self._until, self._axes = scenario, dict(lengths), until, axes
        self.gravity = np.zeros(len(axes))
        self.gravity[-1] = -scenario.gravity
        self._sheaves = tuple((name, own) for name, line in scenario.lines.items() for own in line.sheaves)
        self._friction = np.array([scenario.lines[name].sheaves[own].friction for name, own in self._sheaves])
        self._ends = {
            name: [0.0, *attached(scenario, name), *(s.at for s in line.supports.values()), lengths[name]]
            for name, line in scenario.lines.items()
        }

    def link_of(self, name: str) -> float:
        """About the length of a link of a line, m."""
        return self._lengths[name] / self._scenario.lines[name].elements

    def settle(
        self, forces: Sequence[LineForce] = (), *, near: LineShape | SplitRest | None = None, t: float = 0.0,
        rubs: bool = False,
    ) -> SplitRest:  # fmt: skip
        """Rest next to a shape, or to another rest.

        Args:
            forces: on lines.
            near: None: as lines are drawn.
            t: s, in histories.
            rubs: whether lines rub at sheaves, from where they are; else they slip freely.

        Raises:
            EquilibriumError: there is no rest, or not before a line has run out over a sheave.
        """
        friction = self._friction if rubs else np.zeros(len(self._sheaves))
        if isinstance(near, SplitRest):
            for start in self._gone_on(near, forces, t):
                even = self._is_even(start)
                try:
                    if not even:
                        start = self._split(forces, start.over, LineShape.of(start), t)
                    found = self._slipped(start, friction, close=True)
                except EquilibriumError:
                    continue
                return found._replace(before=(near.t, near.shape)) if even else found
            near = LineShape.of(near)
        start = self._split(forces, self._drawn() if near is None else near.over, near, t)
        with search(start.assembled.line):
            if not self._sheaves or friction.any():
                return self._slipped(start, friction)
            with suppress(EquilibriumError):
                return self._slipped(start, friction, close=True, rounds=_FEW)
            soft = self._stiffened(start, friction)
            if not self._is_even(soft):
                soft = self._split(forces, soft.over, LineShape.of(soft), t)
            return self._slipped(soft, friction)

    def _stiffened(self, start: SplitRest, friction: Array) -> SplitRest:
        """Equilibrium of lines that are much softer, then ever stiffer; the start where none is softer."""
        law, found = start.structure.runs.law, start
        for soft in softened(start.structure):
            try:
                with not_noted():
                    found = self._slipped(found.with_laws(soft.runs.law), friction)
            except SearchBudgetError:
                raise
            except EquilibriumError:  # what has been found is closer all the same
                break
        return found.with_laws(law)

    def _gone_on(self, near: SplitRest, forces: Sequence[LineForce], t: float) -> Iterator[SplitRest]:
        """Where lines may be about at rest, without dividing them anew: as they went on before, and as they are."""
        if [own.line for own in forces] != [own.line for own in near.forces]:
            return
        x, close = near.x.copy(), [TOGETHER * self.link_of(own.line) for own in forces]
        for own, was, mark in zip(forces, near.forces, near.mark, strict=True):
            if mark < 0 and own.at != was.at:
                return
            if mark >= 0:
                x[mark] = own.at
        for i, own in enumerate(forces):  # no two marks in one place, and all in the same order
            others = [near.x[j] for j in range(x.size) if j != near.mark[i] and self._line_of(near, j) == own.line]
            if any(abs(own.at - at) <= close[i] for at in (*others, *self._ends[own.line]) if near.mark[i] >= 0):
                return
        self._marks(forces, near.over)
        here = near.put(x).under(forces)._replace(t=t)
        if (here.structure.runs.h <= 0.0).any():
            return
        if near.before is not None and near.before[1].size == near.shape.size and near.t != near.before[0]:
            part = float(np.clip((t - near.t) / (near.t - near.before[0]), -_ON, _ON))
            yield self._restrained(here._replace(shape=near.shape + part * (near.shape - near.before[1])))
        yield self._restrained(here)

    def _is_even(self, rest: SplitRest) -> bool:
        """Whether links beside marks are about as long as others, or single ones that are shorter."""
        runs, even = rest.structure.runs, True
        for s in rest.weight:
            h = self.link_of(rest.assembled.line[s])
            even &= runs.h[s] <= _UNEVEN * h and (runs.links[s] == 1 or runs.h[s] >= h / _UNEVEN)
        return bool(even)

    @staticmethod
    def _line_of(rest: SplitRest, mark: int) -> str:
        return rest.assembled.line[int(rest.run[mark])]

    @staticmethod
    def _restrained(rest: SplitRest) -> SplitRest:
        """The same with what moves as prescribed where it is."""
        r = rest.structure.restraints.put(rest.r, rest.t)
        return rest._replace(shape=np.concatenate([r.ravel(), rest.shape[r.size :]]))

    def _drawn(self) -> Over:
        """About where lines are over their sheaves."""
        if not self._sheaves:
            return {}
        membranes = tuple(sheet_of(name, net) for name, net in self._scenario.nets.items())
        found = curves(self._scenario, self._lengths, membranes, {})
        corners = {name: list(line.sheaves) for name, line in self._scenario.lines.items()}
        return {
            (name, own): float(found[name][2][1 + corners[name].index(own)]) * self._lengths[name]
            for name, own in self._sheaves
        }

    def _split(self, forces: Sequence[LineForce], over: Over, near: LineShape | None, t: float) -> SplitRest:
        """Lines divided for forces and at sheaves, which are not at rest yet.

        Raises:
            EquilibriumError: a force is at a sheave, or there is no rest with lines as stiff as they are.
        """
        marks, at, mark = self._marks(forces, over)
        laid = lay(self._scenario, self._lengths, marks=marks, over=over, split=True)
        places = laid.place if near is None else near.on(laid)
        assembled = with_tracks(self._scenario, assembled_of(self._scenario, laid, places, self._until, self._axes))
        start = assembled.structure.restraints.put(assembled.near, t)
        tension = np.ones(start.shape[1])
        for bends in (assembled.structure.runs.bending.any(), False):
            found = self._of(assembled, start, tension, [*over.values(), *(place for _, place in at)],
                             [*(name for name, _ in over), *(name for name, _ in at)], t)  # fmt: skip
            found = found._replace(mark=tuple(mark)).under(forces)
            if not bends:
                break
            start = found._replace(shape=settled_in_wind(found.potential, found.shape, t)).r
            tension = tensions(assembled.structure, start)
        return found

    def _of(
        self, assembled: Assembled, start: Array, tension: Array, x: Sequence[float], lines: Sequence[str], t: float
    ) -> SplitRest:  # fmt: skip
        """Lines with marks at x in m on lines, their nodes at places (axis, node) in m."""
        structure = with_ends(assembled.structure, self.gravity, tension)
        assembled = replace(assembled, structure=structure)
        size = float(np.ptp(start, axis=1).max())
        potential = SystemPotential(structure, LoadedStructure(structure, start), size, within=self._scenario.is_plane)
        found = SplitRest(
            assembled, potential, start.ravel(), self.gravity, t, np.array(x, dtype=np.float64),
            np.zeros(0, dtype=np.int64), self._sheaves, (), (), {},
        )  # fmt: skip
        run = [
            min(found.runs_of(name), key=lambda s, at=at: abs(float(found.stations(s)[-1]) - at))  # type: ignore[misc]
            for name, at in zip(lines, x, strict=True)
        ]
        weight, parts = {}, {(s, side): own for s, side, own in ends_of(structure, tension)}
        for s in sorted({*run, *(s + 1 for s in run)}):
            unit = np.ones(int(structure.runs.links[s]) + 1)
            unit[[0, -1]] = 0.5
            for side, nodes in ((0, [0, 1, 2]), (1, [-1, -2, -3])):
                if (s, side) in parts:
                    one, two = parts[s, side]
                    unit[nodes] += np.array([-one - two, one, two])
            weight[s] = structure.runs.rho[s] * np.outer(self.gravity, unit)
        return found._replace(run=np.array(run, dtype=np.int64), weight=weight)

    def _marks(
        self, forces: Sequence[LineForce], over: Over
    ) -> tuple[dict[str, list[float]], list[tuple[str, float]], list[int]]:
        """Where lines are divided for forces: where there is no node yet; lines, marks, and marks of forces.

        Raises:
            EquilibriumError: a force is at a sheave.
        """
        marks: dict[str, list[float]] = {}
        at, found = list[tuple[str, float]](), list[int]()
        for force in forces:
            close = TOGETHER * self.link_of(force.line)
            beside = _BESIDE * self.link_of(force.line)
            if any(name == force.line and abs(place - force.at) <= beside for (name, _), place in over.items()):
                raise EquilibriumError(AT_SHEAVE)
            same = [i for i, (name, place) in enumerate(at) if name == force.line and abs(place - force.at) <= close]
            if any(abs(place - force.at) <= close for place in self._ends[force.line]):
                found.append(-1)
            elif same:
                found.append(len(over) + same[0])
            else:
                found.append(len(over) + len(at))
                at.append((force.line, force.at))
                marks.setdefault(force.line, []).append(force.at)
        return marks, at, found

    def _slipped(self, found: SplitRest, friction: Array, *, close: bool = False, rounds: int = _ROUNDS) -> SplitRest:
        """At rest, with lines slipped over their sheaves."""
        found.potential.loaded.state.t[0] = found.t
        few = rounds < _ROUNDS
        found = found._replace(shape=settled_in_wind(found.potential, found.shape, found.t, close=close))
        sheaves = len(found.sheaves)
        begin, goes, last = found.x.copy(), np.zeros(sheaves), np.zeros(sheaves)
        for _ in range(rounds if sheaves else 0):
            miss, largest = missed(found, friction, goes)
            goes = np.where(goes == 0.0, np.sign(miss), goes)
            is_even = np.abs(miss).max() <= _EVEN * largest
            step, way = (0.0 * miss, 0.0) if is_even else slip(found, miss, friction, goes)
            if np.abs(step).max() <= _CLOSE * found.potential.size:
                back = (friction > 0.0) & ((found.x - begin)[:sheaves] * goes > _CLOSE * found.potential.size)
                if not (back.any() or found.is_loaded or largest > 0.0):
                    raise EquilibriumError(f"no equilibrium was found: {cause(found.potential, found.shape)}")
                if not back.any():
                    return found
                goes[back], found.x[:sheaves][back] = 0.0, begin[:sheaves][back]  # it does not slip there at all
                found = found.put(found.x)
                found = found._replace(shape=settled_in_wind(found.potential, found.shape, found.t, close=few))
                continue
            back = (step * last < 0.0) & (np.abs(step) > 0.5 * np.abs(last))  # to and fro, as over folds
            x, most = found.x.copy(), float((0.5 * np.abs(last[back] / step[back])).min(initial=1.0))
            for j, far in enumerate(step.tolist()):
                name, _ = found.sheaves[j]
                end = found.ends(j)[int(far > 0.0)]
                if abs(end - x[j]) <= TOGETHER * self.link_of(name) < abs(far):
                    loads = [at for k, at in enumerate(found.x[sheaves:], sheaves) if self._line_of(found, k) == name]
                    raise EquilibriumError(AT_SHEAVE if end in loads else RUN_OUT)
                most = min(most, _FAR * abs(end - x[j]) / max(abs(far), 1e-300))
            x[:sheaves] += most * step
            last = most * step
            found = found.put(x)._replace(shape=found.shape + most * way)
            found = found._replace(shape=settled_in_wind(found.potential, found.shape, found.t, close=few))
        if sheaves:
            j = int(np.abs(miss).argmax())
            name, own = found.sheaves[j]
            raise EquilibriumError(
                f"no equilibrium was found: line {name} does not stop slipping over sheave {own}, where its tensions "
                f"differ by {abs(miss[j]):.3g} N; check its length and its supports"
            )
        return found

    def shape_of(self, assembled: Assembled) -> LineShape:
        """Where lines and nets are about to rest in a structure that is not divided."""
        structure, over = assembled.structure, dict[tuple[str, str], float]()
        if (sheaves := structure.sheaves) is not None:
            ends = structure.runs.first[sheaves.run] + structure.runs.links[sheaves.run]
            over = dict(zip(self._sheaves, (assembled.station[ends] + sheaves.ahead).tolist(), strict=True))
        return _shape(assembled, assembled.near, over)


def _shape(assembled: Assembled, r: Array, over: Over) -> LineShape:
    """Where lines and nets are with their nodes at places (axis, node) in m."""
    places, lines, runs = np.zeros((r.shape[1], 3)), {}, assembled.structure.runs
    places[:, [0, 2] if r.shape[0] == 2 else [0, 1, 2]] = r.T
    for name in dict.fromkeys(assembled.line):
        own = [s for s, line in enumerate(assembled.line) if line == name]
        nodes = np.concatenate([runs.first[s] + np.arange(runs.links[s] + 1) for s in own])
        lines[name] = assembled.station[nodes].copy(), places[nodes]
    vertex = () if assembled.nets is None else tuple(places[own] for own in assembled.nets.vertex)
    return LineShape(lines, vertex, over)
