"""A motion under way."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array
from ropewalk.model.scenario import Scenario
from ropewalk.system.assembly import loads_on, structure_of
from ropewalk.system.bodies import with_step
from ropewalk.system.compliance import CORRECTION, compliances
from ropewalk.system.contacts import BODY
from ropewalk.system.motion import advance, stored
from ropewalk.system.statics import settle
from ropewalk.system.structure import WORKS, Room, State, Structure

# Part of the stable step that is used.
SAFETY = 0.5


def largest_step(structure: Structure, r: Array) -> float:
    """A stable step, s: from bounds of the largest frequency and damping rate of the runs."""
    runs, found = structure.runs, np.inf
    for s in range(runs.first.size):
        part = slice(runs.first[s], runs.first[s] + runs.links[s] + 1)
        length = np.sqrt((np.diff(r[:, part], axis=1) ** 2).sum(axis=0))
        strain = np.concatenate([length / runs.h[s] - 1.0, [0.0]])
        stiff = max(float(law.tangents(runs.law[s], strain).max()), float(law.tensions(runs.law[s], strain).max()) * (1.0 + CORRECTION / 3.0))
        h, rho = runs.h[s], runs.rho[s]
        square = 4.0 * stiff / (rho * h * h) + 80.0 / 3.0 * runs.bending[s] / (rho * h**4) + runs.bed[s] / rho
        rate = 4.0 * runs.damping[s] / (rho * h * h)
        omega = np.sqrt(square)
        zeta = rate / omega
        found = min(found, 2.0 / omega * (np.sqrt(1.0 + zeta**2) - zeta))
    return SAFETY * found


class Motion:
    """A structure that moves, with what it carries."""

    def __init__(self, scenario: Scenario, until: float, step: float | None = None) -> None:
        self.structure, near = structure_of(scenario, until)
        self.rest = settle(self.structure, near)
        self.contacts, self.tables, self.bodies = loads_on(scenario, self.structure, until)
        axes, n = self.rest.shape
        self.state = State(
            np.zeros(1), self.rest.copy(), np.zeros((axes, n)), np.zeros(self.bodies.mass.size),
            np.zeros(self.bodies.mass.size), np.zeros(self.contacts.size), np.zeros(WORKS),
        )  # fmt: skip
        self.room = Room.of(self.structure, axes)
        self.step = step or largest_step(self.structure, self.rest)
        self._table, self._out = compliances(), np.zeros(3)
        self._A, self._b = np.zeros((3, 4)), np.zeros(3)
        self._begin(scenario)
        self.stored()
        self.room.before[:] = self.room.strain

    def _begin(self, scenario: Scenario) -> None:
        """Put bodies on the line at rest, moving with it, springs without force but for weights."""
        self.stored()  # places contacts
        axes = self.rest.shape[0]
        for c in self.contacts:
            if c["kind"] == BODY:
                own = c["first"] + np.arange(axes)
                self.state.u[own] = c["p"][:axes]
                self.state.w[own] = c["speed"] * c["along"][:axes]
        bodies = self.bodies
        for p, n in enumerate(bodies.size):
            at = bodies.at[p, :n]
            free = np.flatnonzero(bodies.contact[at] < 0)
            stand = np.flatnonzero(bodies.contact[at] >= 0)
            K = bodies.K[p, :n, :n]
            force = bodies.force[at][free] - K[np.ix_(free, stand)] @ self.state.u[at[stand]]
            self.state.u[at[free]] = np.linalg.lstsq(K[np.ix_(free, free)], force, rcond=None)[0]
            follow = np.linalg.lstsq(K[np.ix_(free, free)], -K[np.ix_(free, stand)] @ self.state.w[at[stand]], rcond=None)[0]
            self.state.w[at[free]] = follow

    def stored(self) -> float:
        """Elastic energy of all lines, J."""
        return float(stored(self.structure, self.room, self.contacts, self.tables, self.bodies, self.state, self._table, self._out, self.step))

    def energies(self) -> dict[str, float]:
        """All energies and works, J."""
        s, nodes, held, bodies = self.state, self.structure.nodes, self.structure.holdings, self.bodies
        out = {"elastic": self.stored(), "kinetic": 0.5 * float((nodes.mass * s.v**2).sum())}
        out["gravitational"] = -float((nodes.force * s.r).sum())
        for e in range(held.mass.size):
            node = held.node[held.first[e]]
            out["kinetic"] += 0.5 * held.mass[e] * float((s.v[:, node] ** 2).sum())
            out["gravitational"] -= float(held.force[e] @ s.r[:, node])
            part = slice(int(held.table[e]), int(held.table[e] + held.entries[e]))
            moved = [np.interp(s.t[0], held.time[part], row[part]) for row in held.moved]
            away = s.r[:, node] - held.place[e] - moved
            out["elastic"] += 0.5 * float(away @ held.stiffness[e] @ away)
        alone = bodies.alone == 1
        out["load_kinetic"] = 0.5 * float((bodies.mass * s.w**2)[alone].sum())
        out["load_potential"] = -float(bodies.force @ s.u)
        for p, n in enumerate(bodies.size):
            at = bodies.at[p, :n]
            out["load_kinetic"] += 0.5 * float(s.w[at] @ bodies.M[p, :n, :n] @ s.w[at])
            out["load_potential"] += 0.5 * float(s.u[at] @ bodies.K[p, :n, :n] @ s.u[at])
        out["damped"], out["loaded"], out["held"], out["moved"], out["in_bodies"], out["struck"], out["carried"] = s.work
        total = sum(out[k] for k in ("elastic", "kinetic", "gravitational", "load_kinetic", "load_potential", "damped", "in_bodies", "struck"))
        out["total"] = total - out["loaded"] - out["held"] - out["moved"] - out["carried"]
        return out

    def to(self, t: float) -> int:
        """Go on to the time t in s."""
        rest = t - float(self.state.t[0])
        steps = max(1, int(np.ceil(rest / self.step - 1e-9)))
        dt = rest / steps
        bodies = with_step(self.bodies, dt)
        return int(advance(
            self.structure, self.room, self.contacts, self.tables, bodies, self.state, self._table, self._out,
            self._A, self._b, dt, steps,
        ))  # fmt: skip
