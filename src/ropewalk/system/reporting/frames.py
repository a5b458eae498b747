"""From a state of the system to a frame of the result: tensions, contacts, reactions, energy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.loading import Loading
from ropewalk.mechanics.multibody_system import FIRM
from ropewalk.mechanics.notes import Notes, columns, numbers_of
from ropewalk.mechanics.vehicle_matrices import MIDDLE
from ropewalk.results.audit import Audit, energies
from ropewalk.results.frame import IN_AIR, MOVES, STICKS, Contacts, Layout
from ropewalk.results.frames import Frames, summed
from ropewalk.system.assembling.assembled import Assembled, on_of
from ropewalk.system.contact.beyond_kinks import beyond_kinks
from ropewalk.system.contact.contact_record import FORCE, ON, PRESCRIBED
from ropewalk.system.elements.membrane_elements import tensions_of
from ropewalk.system.elements.sheaves_at_rest import gravitational
from ropewalk.system.elements.structure import (
    CARRIED,
    DAMPED,
    DRIVEN,
    IN_BODIES,
    LAGGED,
    LOADED,
    MOVED,
    RESTRAINED,
    RUBBED,
    STRUCK,
    Buffers,
    SystemState,
)
from ropewalk.system.elements.surfaces import tensions_about_rest
from ropewalk.system.loads.bodies import BodyArrays
from ropewalk.system.reporting.hold_forces import FrictionDemand, beside


class SystemNote(NamedTuple):
    """What a frame is made of, unchanged by what comes; of several instants, with these in front of all."""

    t: Array  # () s
    r: Array  # (axis, node) m
    v: Array  # m/s
    u: Array  # (coordinate,) m
    w: Array  # m/s
    s: Array  # (contact,) m
    work: Array  # (WORKS,) J
    tension: Array  # (node,) N, of links by their first node, as are strains
    strain: Array
    bent: Array  # (axis, node) m, second differences
    reaction: Array  # (restraint, axis) N
    contacts: Any  # (contact,) records
    tethers: Any  # (tether,) records
    hauls: Any  # (haul,) records
    M: Array  # (part, size, size) kg
    K: Array  # N/m
    elastic: Array  # () J, what lines and contacts store

    @staticmethod
    def sources(state: SystemState, buffers: Buffers, contacts: Any, bodies: BodyArrays, elastic: Array) -> list[Any]:
        """The arrays themselves of which this is a copy; `elastic` has one entry."""
        return [
            state.t, state.r, state.v, state.u, state.w, state.s, state.work, buffers.tension, buffers.strain,
            buffers.bent, buffers.reaction, contacts, bodies.tethers, bodies.carriages.hauls, bodies.M, bodies.K,
            elastic,
        ]  # fmt: skip

    @staticmethod
    def together(notes: Sequence[Notes], sources: Sequence[Any]) -> SystemNote:
        """What has been noted of these arrays."""
        t, *others, elastic = columns(notes, sources)
        return SystemNote._make([t[:, 0], *others, elastic[:, 0]])

    @staticmethod
    def of(state: SystemState, buffers: Buffers, contacts: Any, bodies: BodyArrays, elastic: float) -> SystemNote:
        """What is known now, of one instant."""
        there = SystemNote.sources(state, buffers, contacts, bodies, np.array([elastic]))
        sources = [np.ascontiguousarray(array) for array in there]  # what is superposed is no array of its own
        notes = Notes.empty(numbers_of(sources), 1)
        notes.add()
        return SystemNote.together([notes], sources)


class FrameBuilder:
    """What builds frames; the energy at the first one of a motion is the origin of its audit.

    Args:
        assembled: what frames are of.
        loading: its loads.
        bodies: what has a mass of these.
        windy: whether wind bears some of the weight, as foundations do.
        path: leading dimension of the result.
        cut: runs behind whose last node a line is cut on the way: a link of no length lies there before.
    """

    def __init__(
        self, assembled: Assembled, loading: Loading, bodies: BodyArrays, windy: bool, path: str = "time",
        cut: Sequence[int] = (),
    ) -> None:  # fmt: skip
        self.assembled, self.loading, self.bodies = assembled, loading, bodies
        runs, line = assembled.structure.runs, assembled.line
        nodes, links = [], []
        sheaves = assembled.structure.sheaves
        over = [*cut, *([] if sheaves is None else sheaves.run.tolist())]  # the link beyond these lies over a sheave
        for s, (first, n) in enumerate(zip(runs.first[: len(line)], runs.links[: len(line)], strict=True)):
            goes_on = s > 0 and line[s - 1] == line[s] and s - 1 not in over  # its first node is the last one before
            nodes.append(first + np.arange(int(goes_on), n + 1))
            links.append(first + np.arange(n + int(s in over)))
        none, nets = np.zeros(0, dtype=np.int64), assembled.nets
        vertices = () if nets is None else nets.vertex
        membranes = () if nets is None else nets.membranes
        self.node, self.link = np.concatenate([none, *nodes, *vertices]), np.concatenate([none, *links])
        station = np.where(
            np.arange(self.node.size) < sum(own.size for own in nodes), assembled.station[self.node], np.nan
        )
        begin = np.cumsum([sum(own.size for own in nodes), *(own.size for own in vertices)])
        self._edges = [np.unique([self._restraint_of(n) for n in own.tolist()]) for own in vertices]
        restrained, supports = assembled.structure.restraints, [e for _, e in assembled.supports]
        joints = np.setdiff1d(np.arange(restrained.mass.size), supports)
        weight = -float(assembled.structure.nodes.force[-1].sum() + restrained.force[joints, -1].sum())
        displayed = () if loading.multibody_system is None else loading.multibody_system.displayed
        attached = assembled.attached
        more: dict[str, Any] = {}
        if attached is not None and attached.sampled:
            more = {"tie": attached.tie, "tie_station": attached.station, "watched": attached.watched}
            more |= {"watched_station": attached.watched_station, "sample": (0.0,) if path == "time" else ()}
        self.layout = Layout(
            axes=assembled.axes,
            node_line=(
                *(name for name, own in zip(line, nodes, strict=True) for _ in own),
                *(sheet.name for sheet, own in zip(membranes, vertices, strict=True) for _ in own),
            ),
            node_xi=station,
            link_line=tuple(name for name, own in zip(line, links, strict=True) for _ in own),
            link_xi=0.5 * (assembled.station[self.link] + assembled.station[self.link + 1]),
            contact_load=tuple(wheel.name for wheel in loading.wheels),
            support=(
                *(name for name, _ in assembled.supports), *(() if attached is None else attached.support),
                *(f"{sheet.name}.edge" for sheet in membranes),
            ),
            cell=tuple(
                (int(i), int(j), int(k))
                for sheet, at in zip(membranes, begin, strict=False)
                for i, j, k in sheet.surface.triangle + at
            ),
            hauled=self._hauled(),
            sheave=assembled.sheave,
            cell_net=tuple(sheet.name for sheet in membranes for _ in sheet.surface.triangle),
            body=tuple(body.name for body in displayed),
            path=path,
            weight=float("nan") if windy or runs.bed.any() else weight,
            **more,
        )  # fmt: skip
        self._audit = Audit()

    def get_state(self) -> Tree:
        """The origin of the audit."""
        return self._audit.get_state()

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self._audit.set_state(tree)

    def build(self, at: SystemNote, *, still: float | None = None) -> Frames:
        """The frames of what has been noted.

        Args:
            at: of some instants, `Note.together`; their forces are known.
            still: of a rest, its load path in m.
        """
        tension = self._axial_force(at)
        reading = beyond_kinks(at.contacts, tension, self.assembled.structure)
        beyond = reading.of(tension)
        seen = self._contacts(at, tension, beyond)
        places, velocities = self._displayed_bodies(at)
        position = at.r[:, :, self.node].swapaxes(1, 2)
        if (bow := self.assembled.bow) is not None:
            position[..., 1] += bow[self.node]
            seen.position[..., 1] += self._bow_at(seen.position[..., 0], self._contact_lines)
            places[..., 1] += self._bow_at(places[..., 0], self._body_lines)
        of = {
            "position": position, "velocity": at.v[:, :, self.node].swapaxes(1, 2),
            "tension": beyond[:, self.link], "strain": reading.of(self._strains(at))[:, self.link],
            **seen.fields(),
            "body_position": places, "body_velocity": velocities, "reaction": self._reactions(at),
            **self._of_ties(at, seen, still=still is not None), **self._cell_tensions(at),
            **self._of_hauling_ropes(at), **self._at_sheaves(at),
            "energy": self._energy(at, still=still is not None),
        }  # fmt: skip
        return Frames(at.t if still is None else np.full(at.t.shape, still), of)

    def _bow_at(self, x: Array, line: Sequence[int]) -> Array:
        """How far to the left on curves results show what is over places of lines, (instant, what) m."""
        runs, near, bow = self.assembled.structure.runs, self.assembled.near, self.assembled.bow
        assert bow is not None
        out = np.zeros_like(x)
        for k, s in enumerate(line):
            own = slice(runs.first[s], runs.first[s] + runs.links[s] + 1)
            out[:, k] = np.interp(x[:, k], near[0, own], bow[own])
        return out

    @property
    def _contact_lines(self) -> list[int]:
        """Numbers of the lines of all contacts."""
        return [on_of(self.assembled.on, wheel) for wheel in self.loading.wheels]

    @property
    def _body_lines(self) -> list[int]:
        """Numbers of the lines of all bodies."""
        multibody_system = self.loading.multibody_system
        displayed = () if multibody_system is None else multibody_system.displayed
        return [self._contact_lines[body.wheel] for body in displayed]

    def _restraint_of(self, node: int) -> int:
        """The restraint of a node, -1: none."""
        restrained = self.assembled.structure.restraints
        at = np.flatnonzero(restrained.node == node)
        return int(np.searchsorted(restrained.first, at[0], side="right")) - 1 if at.size else -1

    def _strains(self, at: SystemNote) -> Array:
        """Strains of links from where they are without force."""
        runs, strain = self.assembled.structure.runs, at.strain
        if self.assembled.stretch is not None:
            for first, n, e0 in zip(runs.first, runs.links, self.assembled.stretch, strict=True):
                strain[:, first : first + n] = e0 + (1.0 + e0) * strain[:, first : first + n]
        return strain

    def _reactions(self, at: SystemNote) -> Array:
        """Forces of supports on lines, and of edges on nets, (instant, support, axis) N."""
        edges = [at.reaction[:, own[own >= 0]].sum(axis=1) for own in self._edges]
        ends = [at.reaction[:, e] for _, e in self.assembled.supports]
        on_way = list[Array]()
        if (attached := self.assembled.attached) is not None:
            ties = self.assembled.structure.ties
            assert ties is not None
            pull = np.array([
                ties.forces(r, v)[:, None] * ties.look(r)[0] for r, v in zip(at.r, at.v, strict=True)
            ])  # fmt: skip
            on_way = [pull[:, attached.holds == e].sum(axis=1) for e in range(len(attached.support))]
        nothing = np.zeros((0, *at.t.shape, at.reaction.shape[2]))
        return np.concatenate([nothing, *(one[None] for one in (*ends, *on_way, *edges))]).swapaxes(0, 1)

    def _of_ties(self, at: SystemNote, seen: Contacts, *, still: bool) -> dict[str, Array]:
        """Tensions of ties; samples of a motion are those of its frames."""
        attached, ties = self.assembled.attached, self.assembled.structure.ties
        if attached is None or ties is None or not attached.sampled:
            return {}
        force = np.array([ties.forces(r, v)[: len(attached.tie)] for r, v in zip(at.r, at.v, strict=True)])
        if still:
            return {"tie_force": force}
        rise = np.array([np.asarray(attached.watch @ (r[-1] - self.assembled.near[-1])) for r in at.r])
        return {
            "tie_force": force, "sampled_station": seen.xi[:, None], "sampled_force": seen.force[:, None, :, -1],
            "sampled_height": seen.position[:, None, :, -1], "sampled_tie_force": force[:, None],
            "sampled_uplift": rise[:, None],
        }  # fmt: skip

    def _cell_tensions(self, at: SystemNote) -> dict[str, Array]:
        if (surfaces := self.assembled.structure.surfaces) is None:
            return {}
        cells, count = surfaces.cells, surfaces.cells.area.size
        if surfaces.is_linearised:
            return {"cell_tension": tensions_about_rest(cells, count, self.assembled.near, at.r)}
        return {"cell_tension": tensions_of(cells, count, at.r)}

    def _hauled(self) -> tuple[str, ...]:
        """Carriages that ropes haul: each rope's own, and then those at the other ends of ropes over pulleys."""
        hauls, wheels = self.bodies.carriages.hauls, self.loading.wheels
        ends = [*hauls["first"], *(haul["other"] for haul in hauls if not haul["driven"])]
        return tuple(wheels[int(first)].load for first in ends)

    def _of_hauling_ropes(self, at: SystemNote) -> dict[str, Array]:
        hauls = self.bodies.carriages.hauls
        if not hauls.size:
            return {}
        over = np.flatnonzero(hauls["driven"] == 0)
        own, other = np.split(at.hauls["tensions"], 2, axis=2)
        slipped = at.hauls["slipped"]
        return {
            "haul_tension": np.concatenate([own, other[:, over]], axis=1),
            "haul_slip": np.concatenate([slipped, slipped[:, over]], axis=1),
        }

    def _at_sheaves(self, at: SystemNote) -> dict[str, Array]:
        """Where lines are over their sheaves now, m: frames of such lines are made at once."""
        structure = self.assembled.structure
        if (sheaves := structure.sheaves) is None or not self.assembled.sheave:
            return {}
        ends = structure.lines.begin + structure.runs.links * structure.runs.h
        return {"sheave_station": np.tile(ends[sheaves.run] + sheaves.ahead, (at.t.size, 1))}

    def _axial_force(self, at: SystemNote) -> Array:
        """Force along the tangent in links, by their first node, N: what stretches them, and EI kappa^2."""
        structure, out = self.assembled.structure, at.tension.copy()
        runs = structure.runs
        for s in np.flatnonzero(runs.bending > 0.0):
            first, n = int(runs.first[s]), int(runs.links[s])
            bent = at.bent[:, :, first : first + n + 1]
            if structure.is_linearised:
                rest = structure.about.shape[1][:, first : first + n + 1]
                square = (rest * (2.0 * bent - rest)).sum(axis=1) / runs.h[s] ** 4
            else:
                square = (bent**2).sum(axis=1) / runs.h[s] ** 4
            EI = runs.bending[s] if structure.segments is None else structure.segments.bending[first : first + n + 1]
            square = EI * square
            out[:, first : first + n] += 0.5 * (square[:, 1:] + square[:, :-1])
        return out

    def _contacts(self, at: SystemNote, tension: Array, beyond: Array) -> Contacts:
        """What is told of contacts: those on their lines, one after the other, are looked at together.

        Args:
            at: what is noted.
            tension: of links by their first node, (instant, node) N, as friction sees it.
            beyond: as read beyond the kinks.
        """
        runs, dim = self.assembled.structure.runs, at.r.shape[1]
        seen = Contacts(*at.contacts.shape, dim)
        on = at.contacts["state"] == ON
        instant, own = np.nonzero(on)[0], at.contacts[on]
        s, run, ahead = at.s[on], own["run"], runs.ahead[own["run"]]
        force, hold = own["N"][:, :dim].copy(), (own["hold"] + own["evened"])[:, None] * ahead
        lent = own["lent"] > 0.0  # its mass is the line's
        force[lent] = own["given"][lent, :dim] + hold[lent]
        given = (own["kind"] == FORCE) | (own["first"] >= at.u.shape[1]) | lent
        gripped = ~given & (own["frictionless"] == 0) & (own["travel"] == PRESCRIBED)
        way = own["along"][gripped, :dim]
        way = way / np.linalg.norm(way, axis=1)[:, None]
        hold[gripped] = (force[gripped] * way).sum(axis=1)[:, None] * way  # what the line is gripped with
        begin = instant * tension.shape[1]
        both = beside(own, runs, tension.ravel(), begin)
        hold += own["hauled"][:, :dim]
        seen.position[on], seen.force[on], seen.hold[on] = own["place"][:, :dim], force, hold
        seen.friction[on] = FrictionDemand.of(own, self.assembled.structure, s, both, dim).needed(own)
        seen.xi[on], seen.speed[on], seen.in_air[on] = s, own["measured"], own["flown"]
        seen.state[on] = np.where(own["apart"] != 0, IN_AIR, np.where(own["speed"] != 0.0, MOVES, STICKS))
        read = beside(own, runs, beyond.ravel(), begin)
        seen.tension[on] = np.where(runs.firm[run][:, None] > 0.0, np.nan, read)
        return seen

    def _displayed_bodies(self, at: SystemNote) -> tuple[Array, Array]:
        """Places and velocities of bodies (instant, body, axis), m, m/s; along what has no coordinate above wheels."""
        multibody_system, (count, dim, _) = self.loading.multibody_system, at.r.shape
        displayed = () if multibody_system is None else multibody_system.displayed
        out = np.zeros((2, count, len(displayed), dim))
        places = at.u.shape[1] - (0 if multibody_system is None else multibody_system.bodies.coordinates.size)
        first = np.cumsum([0, *(dim for c in self.bodies.contact[:places:dim])])
        own = dict(zip(self.bodies.contact[:places:dim].tolist(), first[:-1].tolist(), strict=True))
        on, every = at.contacts["state"] == ON, np.arange(count)
        first = np.array([own.get(k, 0) for k in range(on.shape[1])])
        for i, body in enumerate(displayed):
            under = np.tile(first, (count, 1))
            for k in body.others:
                under[:, body.wheel] = np.where(on[:, k] & ~on[:, body.wheel], own[k], under[:, body.wheel])
            onward = onward_of(self.assembled, self._contact_lines[body.wheel])
            sides = [body.wheel, *body.others, *(k for k, _, _ in body.between)]
            for a, c in enumerate(body.coordinates):
                if c >= 0:
                    out[:, :, i, a] = at.u[:, places + c], at.w[:, places + c]
                elif c != MIDDLE:
                    for values, found, way in ((at.u, out[0], float(onward[a])), (at.w, out[1], 0.0)):
                        found[:, i, a] = body.locate(values[every[:, None], under + a], on, way)
                        found[~on[:, sides].any(axis=1), i, a] = np.nan  # no wheel is moved on
        return out[0], out[1]

    def _energy(self, at: SystemNote, *, still: bool) -> Array:
        structure, bodies, dim = self.assembled.structure, self.bodies, at.r.shape[1]
        nodes, restrained = structure.nodes, structure.restraints
        first, elastic = restrained.node[restrained.first], at.elastic
        r, v, square = at.r[:, :, first], at.v[:, :, first], (at.v**2).sum(axis=1)
        # What a kink that is carried along has of kinetic energy, which its line does not.
        kinks = np.where(at.contacts["state"] == ON, at.contacts["carried"] * (at.contacts["d"] ** 2).sum(axis=2), 0.0)
        swept = 0.5 * summed(kinks)
        kinetic = 0.5 * (summed(nodes.mass * square) + summed(restrained.mass * square[:, first]))
        kinetic = kinetic + structure.inertia.kinetic(nodes.mass, at.v, v)
        weight = summed(nodes.force * at.r) + summed(restrained.force.T * r)
        if structure.sheaves is not None:
            weight = weight - [gravitational(structure.sheaves, structure.runs, one) for one in at.r]
        for e in np.flatnonzero(restrained.stiffness.any(axis=(1, 2))):
            part = slice(int(restrained.table[e]), int(restrained.table[e] + restrained.entries[e]))
            moved = [np.interp(at.t, restrained.time[part], row[part]) for row in restrained.moved]
            away = r[:, :, e] - restrained.place[e] - np.transpose(moved)
            elastic = elastic + 0.5 * _squares(away, restrained.stiffness[e])
        # What moves as prescribed has its kinetic energy from there.
        driven = np.flatnonzero((restrained.entries > 1) & (np.einsum("eaa->e", restrained.free) == 0.0))
        mass = np.array([restrained.mass[e] + nodes.mass[restrained.members(int(e))].sum() for e in driven])
        moved_by = 0.5 * summed(mass * square[:, first[driven]])
        alone = bodies.alone == 1
        moving = 0.5 * summed((bodies.mass * at.w**2)[:, alone])
        potential = -summed(bodies.force * at.u)
        for p, n in enumerate(bodies.size):
            own, M, K = bodies.at[p, :n], at.M[:, p, :n, :n], at.K[:, p, :n, :n]
            firm = M.diagonal(axis1=1, axis2=2) >= FIRM
            rate, u = np.where(firm, 0.0, at.w[:, own]), at.u[:, own]  # only its owner moves what is firm
            moving, potential = moving + 0.5 * _squares(rate, M), potential + 0.5 * _squares(u, K)
        potential = potential + _of_tethers(at)
        if bodies.carriages.bars.size:
            potential = potential + [bodies.carriages.energy(u, dim) for u in at.u]
        if still:
            return energies(elastic=elastic, gravitational=-weight, load_potential=potential)
        work = at.work.T
        return self._audit.of(
            kinetic=kinetic + swept, elastic=elastic, gravitational=-weight, load_kinetic=moving,
            load_potential=potential, line_damping=work[DAMPED], load_work=work[LOADED],
            hold_work=work[RESTRAINED] + 2.0 * swept, support_work=work[MOVED] + moved_by,
            load_damping=work[IN_BODIES], contact_dissipation=work[STRUCK] - work[CARRIED] + swept,
            friction=work[RUBBED], drive_work=work[DRIVEN], hysteresis=work[LAGGED],
        )  # fmt: skip


def _squares(x: Array, A: Array) -> Array:
    """The quadratic form x A x of each instant."""
    return summed(x[:, :, None] * A * x[:, None])


def _of_tethers(at: SystemNote) -> Array:
    """Energy stored in all tethers, (instant,) J."""
    total, dim, instant = np.zeros(at.t.size), at.r.shape[1], np.arange(at.t.size)
    for tether in at.tethers.T:
        above = at.contacts["first"][instant, tether["contact"]]
        own, above = (first[:, None] + np.arange(dim) for first in (tether["first"], above))
        across, on = tether["across"][:, :dim], tether["on"] == 1
        own, above = np.where(on[:, None], own, 0), np.where(on[:, None], above, 0)
        way = np.take_along_axis(at.u, own, axis=1) - np.take_along_axis(at.u, above, axis=1)
        apart = np.linalg.norm(way - (across * way).sum(axis=1)[:, None] * across, axis=1)
        longer = np.maximum((apart - tether["length"]) * tether["way"], 0.0)
        total += np.where(on, 0.5 * tether["stiffness"] * longer**2, 0.0)
    return total


def onward_of(assembled: Assembled, line: int) -> Array:
    """Return the level direction from the start of a line to its end, a unit vector (axis,), or zero."""
    lines, runs = assembled.structure.lines, assembled.structure.runs
    first, last = int(lines.first[line]), int(lines.first[line] + lines.runs[line] - 1)
    way = assembled.near[:, runs.first[last] + runs.links[last]] - assembled.near[:, runs.first[first]]
    way[-1] = 0.0
    return np.asarray(way / (float(np.linalg.norm(way)) or 1.0))
