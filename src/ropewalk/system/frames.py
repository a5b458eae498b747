"""From a state of the system to a frame of the result: tensions, contacts, reactions, energy."""

from __future__ import annotations

from typing import Any

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.loading import Loading
from ropewalk.results.audit import Audit
from ropewalk.results.frame import MOVES, STICKS, Contacts, Frame, Layout
from ropewalk.system.assembly import Assembled
from ropewalk.system.bodies import Bodies
from ropewalk.system.contacts import ON
from ropewalk.system.structure import CARRIED, DAMPED, HELD, IN_BODIES, LOADED, MOVED, STRUCK, Room, State

_BESIDE = 1.5  # links from a contact, where a line is as beyond its kink


class FrameBuilder:
    """What builds the frames of a motion; the energy at the first one is the origin of its audit."""

    def __init__(self, assembled: Assembled, loading: Loading, bodies: Bodies, windy: bool) -> None:
        self.assembled, self.loading, self.bodies = assembled, loading, bodies
        runs, line = assembled.structure.runs, assembled.line
        nodes, links = [], []
        for s, (first, n) in enumerate(zip(runs.first, runs.links, strict=True)):
            goes_on = s > 0 and line[s - 1] == line[s]  # its first node is the last one before
            nodes.append(first + np.arange(int(goes_on), n + 1))
            links.append(first + np.arange(n))
        self._node, self.link = np.concatenate(nodes), np.concatenate(links)
        station = assembled.station
        held, supports = assembled.structure.holdings, [e for _, e in assembled.supports]
        joints = np.setdiff1d(np.arange(held.mass.size), supports)
        weight = -float(assembled.structure.nodes.force[-1].sum() + held.force[joints, -1].sum())
        shown = () if loading.fleet is None else loading.fleet.shown
        self.layout = Layout(
            axes=assembled.axes,
            node_line=tuple(name for name, own in zip(line, nodes, strict=True) for _ in own),
            node_xi=station[self._node],
            link_line=tuple(name for name, own in zip(line, links, strict=True) for _ in own),
            link_xi=0.5 * (station[self.link] + station[self.link + 1]),
            contact_load=tuple(wheel.name for wheel in loading.wheels),
            support=tuple(name for name, _ in assembled.supports),
            body=tuple(body.name for body in shown),
            weight=float("nan") if windy else weight,
        )
        self._audit = Audit()

    def get_state(self) -> Tree:
        """The origin of the audit."""
        return self._audit.get_state()

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self._audit.set_state(tree)

    def build(self, state: State, room: Room, contacts: Any, elastic: float) -> Frame:
        """The frame of a state whose forces are known; `elastic` is what its lines and contacts store, J."""
        seen, tension = Contacts(contacts.size, len(self.assembled.axes)), self._axial_force(room)
        for k in np.flatnonzero(contacts["state"] == ON):
            self._look_at(seen, int(k), contacts[k], state, tension)
        places, velocities = self._shown_bodies(state)
        return Frame(
            path=float(state.t[0]), position=state.r[:, self._node].T.copy(), velocity=state.v[:, self._node].T.copy(),
            tension=tension[self.link], strain=room.strain[self.link], **seen.told(),
            body_position=places, body_velocity=velocities,
            reaction=np.array([room.reaction[e] for _, e in self.assembled.supports]).reshape(-1, state.r.shape[0]),
            energy=self._energy(state, contacts, elastic),
        )  # fmt: skip

    def _axial_force(self, room: Room) -> Array:
        """Force along the tangent in links, by their first node, N: what stretches them, and EI kappa^2."""
        runs, out = self.assembled.structure.runs, room.tension.copy()
        for s in np.flatnonzero(runs.bending > 0.0):
            first, n = int(runs.first[s]), int(runs.links[s])
            square = (room.bent[:, first : first + n + 1] ** 2).sum(axis=0) / runs.h[s] ** 4
            out[first : first + n] += 0.5 * runs.bending[s] * (square[1:] + square[:-1])
        return out

    def _look_at(self, seen: Contacts, k: int, contact: Any, state: State, tension: Array) -> None:
        runs, dim, run = self.assembled.structure.runs, state.r.shape[0], int(contact["run"])
        seen.position[k], seen.force[k], seen.hold[k] = contact["place"][:dim], contact["N"][:dim], 0.0
        seen.xi[k], seen.speed[k] = state.s[k], contact["speed"]
        seen.state[k] = MOVES if contact["speed"] != 0.0 else STICKS
        for side, way in enumerate((-_BESIDE, _BESIDE)):
            link = min(max(int(np.floor(contact["x"] + way)), 0), int(runs.links[run]) - 1)
            seen.tension[k, side] = tension[runs.first[run] + link]

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

    def _held(self, e: int) -> Integers:
        """Nodes of a holding."""
        held = self.assembled.structure.holdings
        return held.node[held.first[e] : held.first[e] + held.nodes[e]]

    def _energy(self, state: State, contacts: Any, elastic: float) -> Array:
        nodes, held, bodies = self.assembled.structure.nodes, self.assembled.structure.holdings, self.bodies
        first = held.node[held.first]
        # What a kink that is carried along has of kinetic energy, which its line does not.
        on = contacts[contacts["state"] == ON]
        swept = 0.5 * float((on["carried"][:, None] * on["d"] ** 2).sum())
        kinetic = 0.5 * float((nodes.mass * state.v**2).sum() + (held.mass * state.v[:, first] ** 2).sum())
        weight = float((nodes.force * state.r).sum() + (held.force.T * state.r[:, first]).sum())
        for e in range(held.mass.size):
            part = slice(int(held.table[e]), int(held.table[e] + held.entries[e]))
            moved = [np.interp(state.t[0], held.time[part], row[part]) for row in held.moved]
            away = state.r[:, first[e]] - held.place[e] - moved
            elastic += 0.5 * float(away @ held.stiffness[e] @ away)
        # What moves as prescribed has its kinetic energy from there.
        driven = (held.entries > 1) & (np.einsum("eaa->e", held.free) == 0.0)
        mass = held.mass + np.array([nodes.mass[self._held(e)].sum() for e in range(held.mass.size)])
        moved_by = 0.5 * float((mass * (state.v[:, first] ** 2).sum(axis=0))[driven].sum())
        alone = bodies.alone == 1
        moving = 0.5 * float((bodies.mass * state.w**2)[alone].sum())
        potential = -float(bodies.force @ state.u)
        for p, n in enumerate(bodies.size):
            at = bodies.at[p, :n]
            moving += 0.5 * float(state.w[at] @ bodies.M[p, :n, :n] @ state.w[at])
            potential += 0.5 * float(state.u[at] @ bodies.K[p, :n, :n] @ state.u[at])
        for tether in bodies.tethers:
            dim, above = state.r.shape[0], int(contacts[tether["contact"]]["first"])
            way = state.u[int(tether["first"]) :][:dim] - state.u[above : above + dim]
            potential += 0.5 * float(tether["stiffness"] * max(np.linalg.norm(way) - tether["length"], 0.0) ** 2)
        work = state.work
        return self._audit.of(
            kinetic=kinetic + swept, elastic=elastic, gravitational=-weight, load_kinetic=moving,
            load_potential=potential, line_damping=float(work[DAMPED]), load_work=float(work[LOADED]),
            hold_work=float(work[HELD]) + 2.0 * swept, support_work=float(work[MOVED]) + moved_by,
            load_damping=float(work[IN_BODIES]),
            contact_dissipation=float(work[STRUCK] - work[CARRIED]) + swept,
        )  # fmt: skip
