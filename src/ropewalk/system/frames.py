"""From a state of the system to a frame of the result: tensions, contacts, reactions, energy."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.fleet import FIRM
from ropewalk.mechanics.loading import Loading
from ropewalk.results.audit import Audit, energies
from ropewalk.results.frame import IN_AIR, MOVES, STICKS, Contacts, Frame, Layout
from ropewalk.system.assembled import Assembled
from ropewalk.system.bodies import Bodies
from ropewalk.system.contacts import FORCE, ON, PRESCRIBED
from ropewalk.system.holding import Grip, beside
from ropewalk.system.sheaves_at_rest import gravitational
from ropewalk.system.structure import (
    CARRIED,
    DAMPED,
    DRIVEN,
    HELD,
    IN_BODIES,
    LOADED,
    MOVED,
    RUBBED,
    STRUCK,
    Room,
    State,
)
from ropewalk.webs.fabric import tensions_of


class FrameBuilder:
    """What builds frames; the energy at the first one of a motion is the origin of its audit.

    Args:
        assembled: what frames are of.
        loading: its loads.
        bodies: what has a mass of these.
        windy: whether wind bears some of the weight, as foundations do.
        path: leading dimension of the result.
    """

    def __init__(self, assembled: Assembled, loading: Loading, bodies: Bodies, windy: bool, path: str = "time") -> None:
        self.assembled, self.loading, self.bodies = assembled, loading, bodies
        runs, line = assembled.structure.runs, assembled.line
        nodes, links = [], []
        sheaves = assembled.structure.sheaves
        over = [] if sheaves is None else sheaves.run.tolist()  # the link beyond these lies over a sheave
        for s, (first, n) in enumerate(zip(runs.first[: len(line)], runs.links[: len(line)], strict=True)):
            goes_on = s > 0 and line[s - 1] == line[s] and s - 1 not in over  # its first node is the last one before
            nodes.append(first + np.arange(int(goes_on), n + 1))
            links.append(first + np.arange(n + int(s in over)))
        none, nets = np.zeros(0, dtype=np.int64), assembled.nets
        vertices = () if nets is None else nets.vertex
        sheets = () if nets is None else nets.sheets
        self.node, self.link = np.concatenate([none, *nodes, *vertices]), np.concatenate([none, *links])
        station = np.where(
            np.arange(self.node.size) < sum(own.size for own in nodes), assembled.station[self.node], np.nan
        )
        begin = np.cumsum([sum(own.size for own in nodes), *(own.size for own in vertices)])
        self._edges = [np.unique([self._holding_of(n) for n in own.tolist()]) for own in vertices]
        held, supports = assembled.structure.holdings, [e for _, e in assembled.supports]
        joints = np.setdiff1d(np.arange(held.mass.size), supports)
        weight = -float(assembled.structure.nodes.force[-1].sum() + held.force[joints, -1].sum())
        shown = () if loading.fleet is None else loading.fleet.shown
        attached = assembled.attached
        more: dict[str, Any] = {}
        if attached is not None:
            more = {"tie": attached.tie, "tie_station": attached.station, "watched": attached.watched}
            more |= {"watched_station": attached.watched_station, "sample": (0.0,) if path == "time" else ()}
        self.layout = Layout(
            axes=assembled.axes,
            node_line=(
                *(name for name, own in zip(line, nodes, strict=True) for _ in own),
                *(sheet.name for sheet, own in zip(sheets, vertices, strict=True) for _ in own),
            ),
            node_xi=station,
            link_line=tuple(name for name, own in zip(line, links, strict=True) for _ in own),
            link_xi=0.5 * (assembled.station[self.link] + assembled.station[self.link + 1]),
            contact_load=tuple(wheel.name for wheel in loading.wheels),
            support=(
                *(name for name, _ in assembled.supports), *(() if attached is None else attached.support),
                *(f"{sheet.name}.edge" for sheet in sheets),
            ),
            cell=tuple(
                (int(i), int(j), int(k))
                for sheet, at in zip(sheets, begin, strict=False)
                for i, j, k in sheet.surface.triangle + at
            ),
            cell_net=tuple(sheet.name for sheet in sheets for _ in sheet.surface.triangle),
            body=tuple(body.name for body in shown),
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

    def build(self, state: State, room: Room, contacts: Any, elastic: float, *, still: float | None = None) -> Frame:
        """The frame of a state whose forces are known.

        Args:
            state, room, contacts: as they are.
            elastic: what lines and contacts store, J.
            still: of a rest, its load path in m.
        """
        seen, tension = Contacts(contacts.size, len(self.assembled.axes)), self._axial_force(room)
        for k in np.flatnonzero(contacts["state"] == ON):
            self._look_at(seen, int(k), contacts[k], state, tension)
        places, velocities = self._shown_bodies(state)
        return Frame(
            path=float(state.t[0]) if still is None else still,
            position=state.r[:, self.node].T.copy(), velocity=state.v[:, self.node].T.copy(),
            tension=tension[self.link], strain=self._strains(room), **seen.told(),
            body_position=places, body_velocity=velocities,
            reaction=self._reactions(room, state), **self._of_ties(state, seen, still=still is not None),
            cell_tension=self._cell_tensions(state),
            energy=self._energy(state, contacts, elastic, still=still is not None),
        )  # fmt: skip

    def _holding_of(self, node: int) -> int:
        """The holding of a node, -1: none."""
        held = self.assembled.structure.holdings
        at = np.flatnonzero(held.node == node)
        return int(np.searchsorted(held.first, at[0], side="right")) - 1 if at.size else -1

    def _strains(self, room: Room) -> Array:
        """Strains of links from where they are without force."""
        runs, strain = self.assembled.structure.runs, room.strain.copy()
        if self.assembled.stretch is not None:
            for first, n, e0 in zip(runs.first, runs.links, self.assembled.stretch, strict=True):
                strain[first : first + n] = e0 + (1.0 + e0) * strain[first : first + n]
        return np.asarray(strain[self.link])

    def _reactions(self, room: Room, state: State) -> Array:
        """Forces of supports on lines, and of edges on nets, (support, axis) N."""
        edges = [room.reaction[own[own >= 0]].sum(axis=0) for own in self._edges]
        ends = [room.reaction[e] for _, e in self.assembled.supports]
        on_way = list[Array]()
        if (attached := self.assembled.attached) is not None:
            ties = self.assembled.structure.ties
            assert ties is not None
            pull = ties.forces(state.r, state.v)[:, None] * ties.look(state.r)[0]
            on_way = [pull[attached.holds == e].sum(axis=0) for e in range(len(attached.support))]
        return np.array([*ends, *on_way, *edges]).reshape(-1, room.reaction.shape[1])

    def _of_ties(self, state: State, seen: Contacts, *, still: bool) -> dict[str, Array]:
        """Tensions of ties; samples of a motion are those of its frames."""
        attached, ties = self.assembled.attached, self.assembled.structure.ties
        if attached is None or ties is None:
            return {}
        force = ties.forces(state.r, state.v)[: len(attached.tie)]
        if still:
            return {"tie_force": force}
        rise = attached.watch @ (state.r[-1] - self.assembled.near[-1])
        return {
            "tie_force": force, "sampled_station": seen.xi[None], "sampled_force": seen.force[None, :, -1],
            "sampled_height": seen.position[None, :, -1], "sampled_tie_force": force[None],
            "sampled_uplift": np.asarray(rise)[None],
        }  # fmt: skip

    def _cell_tensions(self, state: State) -> Array | None:
        surfaces = self.assembled.structure.surfaces
        return None if surfaces is None else tensions_of(surfaces.cells, surfaces.cells.area.size, state.r.T)

    def _axial_force(self, room: Room) -> Array:
        """Force along the tangent in links, by their first node, N: what stretches them, and EI kappa^2."""
        structure, out = self.assembled.structure, room.tension.copy()
        runs, squares = structure.runs, room.bent**2
        if structure.is_linearised:
            squares = structure.about.shape[1] * (2.0 * room.bent - structure.about.shape[1])
        for s in np.flatnonzero(runs.bending > 0.0):
            first, n = int(runs.first[s]), int(runs.links[s])
            square = squares[:, first : first + n + 1].sum(axis=0) / runs.h[s] ** 4
            out[first : first + n] += 0.5 * runs.bending[s] * (square[1:] + square[:-1])
        return out

    def _look_at(self, seen: Contacts, k: int, contact: Any, state: State, tension: Array) -> None:
        runs, dim = self.assembled.structure.runs, state.r.shape[0]
        on_net = runs.firm[contact["run"]] > 0.0
        seen.position[k], seen.force[k], seen.hold[k] = contact["place"][:dim], contact["N"][:dim], 0.0
        seen.hold[k] = (contact["hold"] + contact["evened"]) * runs.ahead[contact["run"]]
        if contact["lent"] > 0.0:  # its mass is the line's
            seen.force[k] = contact["given"][:dim] + seen.hold[k]
        given = contact["kind"] == FORCE or contact["first"] >= state.u.size or contact["lent"] > 0.0
        if (
            not given and not contact["frictionless"] and contact["travel"] == PRESCRIBED
        ):  # what the line is gripped with
            way = contact["along"][:dim] / np.linalg.norm(contact["along"])
            seen.hold[k] = (seen.force[k] @ way) * way
        grip = Grip.of(contact, self.assembled.structure, float(state.s[k]), tension, dim)
        seen.friction[k] = grip.needed(contact)
        seen.xi[k], seen.speed[k], seen.in_air[k] = state.s[k], contact["measured"], contact["flown"]
        seen.state[k] = IN_AIR if contact["apart"] else MOVES if contact["speed"] != 0.0 else STICKS
        if not on_net:
            seen.tension[k] = beside(contact, runs, tension)

    def _shown_bodies(self, state: State) -> tuple[Array, Array]:
        """Places and velocities of bodies (body, axis), m and m/s; along what has no coordinate above their wheels."""
        fleet, dim = self.loading.fleet, state.r.shape[0]
        shown = () if fleet is None else fleet.shown
        out = np.zeros((2, len(shown), dim))
        places = state.u.size - (0 if fleet is None else fleet.bodies.coordinates.size)
        first = np.cumsum([0, *(dim for c in self.bodies.contact[:places:dim])])
        own = dict(zip(self.bodies.contact[:places:dim].tolist(), first[:-1].tolist(), strict=True))
        for i, body in enumerate(shown):
            for a, coordinate in enumerate(body.coordinates):
                at = places + coordinate if coordinate >= 0 else own[body.wheel] + a
                out[:, i, a] = state.u[at], state.w[at]
            if body.coordinates[0] < 0:
                out[0, i, 0] += body.ahead
        return out[0], out[1]

    def _energy(self, state: State, contacts: Any, elastic: float, *, still: bool) -> Array:
        nodes, held, bodies = self.assembled.structure.nodes, self.assembled.structure.holdings, self.bodies
        first = held.node[held.first]
        # What a kink that is carried along has of kinetic energy, which its line does not.
        on = contacts[contacts["state"] == ON]
        swept = 0.5 * float((on["carried"][:, None] * on["d"] ** 2).sum())
        kinetic = 0.5 * float((nodes.mass * state.v**2).sum() + (held.mass * state.v[:, first] ** 2).sum())
        kinetic += self.assembled.structure.inertia.kinetic(nodes.mass, state.v, state.v[:, first])
        weight = float((nodes.force * state.r).sum() + (held.force.T * state.r[:, first]).sum())
        if self.assembled.structure.sheaves is not None:
            weight -= gravitational(self.assembled.structure.sheaves, self.assembled.structure.runs, state.r)
        for e in range(held.mass.size):
            part = slice(int(held.table[e]), int(held.table[e] + held.entries[e]))
            moved = [np.interp(state.t[0], held.time[part], row[part]) for row in held.moved]
            away = state.r[:, first[e]] - held.place[e] - moved
            elastic += 0.5 * float(away @ held.stiffness[e] @ away)
        # What moves as prescribed has its kinetic energy from there.
        driven = (held.entries > 1) & (np.einsum("eaa->e", held.free) == 0.0)
        mass = held.mass + np.array([nodes.mass[held.members(e)].sum() for e in range(held.mass.size)])
        moved_by = 0.5 * float((mass * (state.v[:, first] ** 2).sum(axis=0))[driven].sum())
        alone = bodies.alone == 1
        moving = 0.5 * float((bodies.mass * state.w**2)[alone].sum())
        potential = -float(bodies.force @ state.u)
        for p, n in enumerate(bodies.size):
            at = bodies.at[p, :n]
            rate = np.where(np.diag(bodies.M[p])[:n] < FIRM, state.w[at], 0.0)  # only its owner moves what is firm
            moving += 0.5 * float(rate @ bodies.M[p, :n, :n] @ rate)
            potential += 0.5 * float(state.u[at] @ bodies.K[p, :n, :n] @ state.u[at])
        potential += _of_tethers(state, contacts, bodies.tethers)
        if still:
            return energies(elastic=elastic, gravitational=-weight, load_potential=potential)
        work = state.work
        return self._audit.of(
            kinetic=kinetic + swept, elastic=elastic, gravitational=-weight, load_kinetic=moving,
            load_potential=potential, line_damping=float(work[DAMPED]), load_work=float(work[LOADED]),
            hold_work=float(work[HELD]) + 2.0 * swept, support_work=float(work[MOVED]) + moved_by,
            load_damping=float(work[IN_BODIES]),
            contact_dissipation=float(work[STRUCK] - work[CARRIED]) + swept, friction=float(work[RUBBED]),
            drive_work=float(work[DRIVEN]),
        )  # fmt: skip


def _of_tethers(state: State, contacts: Any, tethers: Any) -> float:
    """Energy stored in all tethers, J."""
    total, dim = 0.0, state.r.shape[0]
    for tether in tethers[tethers["on"] == 1]:
        first, own = int(tether["first"]), int(contacts[tether["contact"]]["first"])
        way, across = state.u[first : first + dim] - state.u[own : own + dim], tether["across"][:dim]
        longer = float(np.linalg.norm(way - (across @ way) * across) - tether["length"])
        total += 0.5 * float(tether["stiffness"] * max(longer * tether["way"], 0.0) ** 2)
    return total
