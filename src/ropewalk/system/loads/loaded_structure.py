"""Loads that stand still on a structure: where they touch, their coordinates, weights and springs.

Each contact has coordinates of its own here, those of given forces, too: without a mass, it makes no difference.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import HORIZONTAL, Array
from ropewalk.mechanics.compiled import lean, records
from ropewalk.system.contact.contact_record import AWAY, BODY, CONTACT, FORCE, ON
from ropewalk.system.contact.tables import Tables
from ropewalk.system.contact.travel import place
from ropewalk.system.elements.cables import stretch_all
from ropewalk.system.elements.structure import WORKS, Buffers, Structure, SystemState
from ropewalk.system.loads.bodies import BodyArrays, ground
from ropewalk.system.loads.carriages import Carriages
from ropewalk.system.loads.pushes import pushes_at


@lean
def _location(structure, buffers, contacts, tables, state):
    """Put all contacts where they stand, those off their lines on level ground beside them."""
    stretch_all(structure, buffers, state.r)
    place(structure, buffers, contacts, tables, state)
    for k in range(contacts.size):
        contacts[k].speed = 0.0
        contacts[k].fade = 0.0
        if contacts[k].state == AWAY:
            contacts[k].kink = 0.0
            ground(structure, contacts, state, k)


class Carried(NamedTuple):
    """Loads as the assembly gives them."""

    contacts: Any
    tables: Tables
    bodies: BodyArrays


class LoadedStructure:
    """What stands on a structure.

    Args:
        structure: what bears it.
        rest: (axis, node) m, at rest without loads: level ground is at the ends of its lines.
        carried: the loads; None: there are none.
        as_moving: whether given forces and contacts without mass meet the line as in motion, where the kink of each is
            found without the tension that others make on the same links.
    """

    def __init__(
        self, structure: Structure, rest: Array, carried: Carried | None = None, *, as_moving: bool = False
    ) -> None:
        dim = rest.shape[0]
        self.structure, self.rest, self._carried, self.as_moving = structure, rest, carried, as_moving
        self.contacts = records(0, CONTACT) if carried is None else carried.contacts.copy()
        self.own = 0 if carried is None else carried.bodies.mass.size  # coordinates but for those of given forces
        given = np.flatnonzero(self.contacts["kind"] == FORCE)
        self.contacts["first"][given] = self.own + dim * np.arange(given.size)
        self.contacts["kind"], self.contacts["step"][given] = BODY, 0.0
        own = structure.lines.first[self.contacts["line"]]
        if not structure.is_linearised:  # at rest those on lines that do not stretch give way in all directions
            self.contacts["step"][structure.runs.law[own, 0] == law.RIGID] = 0.0
        count = self.own + dim * given.size
        self.firm = np.zeros(self.contacts.size)  # N/m, see `statics.py`
        self._light = np.zeros(count, dtype=np.bool_)
        self.weight, self.K = np.zeros(count), sparse.csc_matrix((count, count))
        self.pushed = np.zeros(count)  # N, by the wind
        self._bodies = None if carried is None or not carried.bodies.pushed.size else carried.bodies
        if carried is not None:
            self.weight[: self.own] = carried.bodies.force
            self._light[: self.own] = as_moving & (carried.bodies.per_mass == 0.0)
            self.K = gathered(carried.bodies, carried.bodies.K, count)
        none = np.zeros(0)
        self._tables = (
            Tables(none, none, none, none, np.zeros((dim, 0)), none, none) if carried is None else carried.tables
        )
        self._tethers = [] if carried is None else list(carried.bodies.tethers)
        self._stands = False  # whether anything has stood here
        self._carriages = Carriages.nothing() if carried is None else carried.bodies.carriages
        self.state = SystemState(
            np.zeros(1), rest.copy(), np.zeros_like(rest), np.zeros(count), np.zeros(count),
            np.zeros(self.contacts.size), np.zeros(WORKS),
        )  # fmt: skip

    @property
    def on(self) -> NDArray[np.int64]:
        """Numbers of the contacts that are on their lines."""
        return np.flatnonzero(self.contacts["state"] == ON)

    @property
    def moves(self) -> NDArray[np.bool_]:
        """Which coordinates may move: all but those on level ground."""
        out = np.ones(self.weight.size, dtype=np.bool_)
        for contact in self.contacts[(self.contacts["state"] != ON) & (self.contacts["clear"] == 0)]:
            out[contact["first"] + np.arange(self.rest.shape[0])] = False
        out[self.contacts["first"][self.contacts["moved"] == 1]] = False
        return out

    def stand(self, t: float, r: Array) -> None:
        """Let all contacts stand where they are at time t in s on lines of the shape r (axis, node) in m.

        There are no kinks at first; payloads hang as they did, or straight down.
        """
        dim, contacts, u = self.rest.shape[0], self.contacts, self.state.u
        was_on, before, self._stands = self._stands & (contacts["state"] == ON), u.copy(), True
        self.state.t[0], self.state.r[:] = t, self.rest
        buffers = Buffers.of(self.structure, dim).for_kernels(self.structure)
        _location(self.structure.for_kernels, buffers, contacts, self._tables, self.state)
        self.state.r[:] = r
        E = self.shares(r.shape[1])
        count = np.bincount(contacts["first"][self.on], minlength=u.size)
        for k in self.on:
            u[int(contacts[k]["first"]) + np.arange(dim)] = 0.0
        for k in self.on:  # what several lines carry is put in the middle
            own = int(contacts[k]["first"]) + np.arange(dim)
            part = 1.0 / count[own[0]]
            u[own] += part * (np.ravel(E[k] @ r.T) - contacts[k]["aside"][:dim])
            u[own[-1]] += part * contacts[k]["rough"]
        led = contacts[contacts["moved"] == 1]
        u[led["first"]] = led["origin"]
        for tether in self._tethers:
            above, below = self._ends(tether)
            fall = np.zeros(dim)
            fall[-1] = -tether["length"] + self.weight[below[-1]] / tether["stiffness"]
            u[below] = u[above] + (before[below] - before[above] if was_on[tether["contact"]] else fall)
        for bar in self._carriages.bars:
            if bar["frame"] >= 0:
                wheels, cabin = self._carriages.ends(bar)
                below = int(cabin[0]) + np.arange(dim)
                u[below] = u[wheels[:, None] + np.arange(dim)].mean(axis=0)
                u[below[-1]] -= bar["length"] - self.weight[below[-1]] / bar["stiffness"]

    def stand_as(self, state: SystemState, contacts: Any) -> None:
        """Let everything stand where it is in a state of motion."""
        dim, own = self.rest.shape[0], self.state
        for key in ("state", "line", "run", "near", "x", "weight", "slope", "second", "link", "h", "part", "change",
                    "given", "rough", "steep"):  # fmt: skip
            self.contacts[key] = contacts[key]
        self.contacts["step"] = 0.0  # nothing gives way that only steps ask for
        own.t[:], own.r[:], own.s[:], own.u[: self.own] = state.t, state.r, state.s, state.u
        for k in self.on:
            at = int(self.contacts[k]["first"])
            if at >= self.own:
                own.u[at : at + dim] = contacts[k]["place"][:dim]

    def set_wind(self, t: float) -> None:
        """Let the wind of time t in s push at what the air drags, as it stands still."""
        if self._carried is None:
            return
        air, dim = self.structure.wind.at(t), self.rest.shape[0]
        for blown in self._carried.bodies.blown:
            own = int(blown["first"]) + np.arange(dim)
            self.pushed[own] = blown["drag"] * np.linalg.norm(air) * air

    def shares(self, nodes: int) -> sparse.csr_matrix:
        """Points of the spline at all contacts by places of the nodes, (contact, node)."""
        out = sparse.lil_matrix((self.contacts.size, nodes))
        for k in self.on:
            contact = self.contacts[k]
            used = np.flatnonzero(contact["weight"])
            out[k, contact["near"] + used] = contact["weight"][used]
        return out.tocsr()

    def slopes(self, nodes: int) -> sparse.csr_matrix:
        """The same of the derivatives of the spline by s, 1/m."""
        out, runs = sparse.lil_matrix((self.contacts.size, nodes)), self.structure.runs
        for k in self.on:
            contact = self.contacts[k]
            used = np.flatnonzero(contact["slope"])
            out[k, contact["near"] + used] = contact["slope"][used] / runs.h[contact["run"]]
        return out.tocsr()

    def _ends(self, tether: Any) -> tuple[Any, Any]:
        """Coordinates of the contact from which a tether hangs, and of what hangs there."""
        axes = np.arange(self.rest.shape[0])
        return int(self.contacts[tether["contact"]]["first"]) + axes, int(tether["first"]) + axes

    def neighbours(self) -> sparse.csc_matrix:
        """Which coordinates may feel which by tethers that turn, (coordinate, coordinate)."""
        out = sparse.lil_matrix((self.weight.size, self.weight.size))
        for tether in self._tethers:
            both = np.concatenate(self._ends(tether))
            out[np.ix_(both, both)] = 1.0
        for bar in self._carriages.bars:
            both = (np.concatenate(self._carriages.ends(bar))[:, None] + np.arange(self.rest.shape[0])).ravel()
            out[np.ix_(both, both)] = 1.0
        return out.tocsc()

    def energy(self, u: Array) -> float:
        """Potential energy of weights, given forces and springs, J."""
        total = 0.5 * float(u @ (self.K @ u)) - float((self.weight + self.pushed + self._pushes()) @ u)
        for k in self.on:
            total -= float(self._given(k) @ u[self._at(k)])
        for tether in self._tethers:
            above, below = self._ends(tether)
            longer = max(float(np.linalg.norm(u[below] - u[above])) - tether["length"], 0.0)
            total += 0.5 * float(tether["stiffness"]) * longer**2
        return total + self._carriages.energy(u, self.rest.shape[0])

    def _at(self, k: int) -> Any:
        return int(self.contacts[k]["first"]) + np.arange(self.rest.shape[0])

    def _given(self, k: int) -> Array:
        """Given force of contact k and what holds it, N."""
        contact, runs = self.contacts[k], self.structure.runs
        return np.asarray(contact["given"][: self.rest.shape[0]] + contact["hold"] * runs.ahead[contact["run"]])

    def _pushes(self) -> Array | float:
        """Forces that change in time, as they are then, N."""
        if self._bodies is None:
            return 0.0
        found = pushes_at(self._bodies, float(self.state.t[0]))
        return np.pad(found, (0, self.weight.size - found.size))

    def forces(self, u: Array) -> Array:
        """Forces on all coordinates, N, with those of the lines at their contacts, which are known."""
        out = np.asarray(self.weight + self.pushed + self._pushes() - self.K @ u)
        for k in self.on:
            at, dim = self._at(k), self.rest.shape[0]
            contact = self.contacts[k]
            alone = (self.firm[k] - contact["moving"]) * contact["d"][:dim] + contact["N"][:dim]
            out[at] += self._given(k) - np.where(self._light[at], alone, contact["N"][:dim])
        for tether in self._tethers:
            above, below = self._ends(tether)
            way = u[below] - u[above]
            length = float(np.linalg.norm(way))
            pull = tether["stiffness"] * max(length - tether["length"], 0.0) * way / length
            out[above] += pull
            out[below] -= pull
        return out + self._carriages.forces(u, self.rest.shape[0])

    def stiffness(self, u: Array) -> sparse.csc_matrix:
        """Second derivatives of the energy, (coordinate, coordinate) N/m."""
        K = self.K.tolil()
        for tether in self._tethers:
            above, below = self._ends(tether)
            way = u[below] - u[above]
            length = float(np.linalg.norm(way))
            along = np.outer(way, way) / length**2
            pull = max(1.0 - tether["length"] / length, 0.0)
            if pull > 0.0:
                k = tether["stiffness"] * (along + pull * (np.eye(way.size) - along))
                for one, other, sign in ((above, above, 1.0), (below, below, 1.0), (above, below, -1.0)):
                    K[np.ix_(one, other)] += sign * k
                K[np.ix_(below, above)] -= k
        if self._carriages.bars.size:
            K += sparse.lil_matrix(self._carriages.stiffness(u, self.rest.shape[0]))
        return K.tocsc()

    def masses(self) -> sparse.csc_matrix:
        """Masses of all coordinates, (coordinate, coordinate) kg."""
        if self._carried is None:
            return sparse.csc_matrix(self.K.shape)
        bodies, count = self._carried.bodies, self.weight.size
        alone = np.zeros(count)
        alone[: self.own] = np.where(bodies.alone == 1, bodies.mass, 0.0)
        return (gathered(bodies, bodies.M, count) + sparse.diags(alone)).tocsc()

    def damping(self, u: Array) -> sparse.csc_matrix:
        """Dampers of all coordinates and of taut tethers, (coordinate, coordinate) N s/m."""
        if self._carried is None:
            return sparse.csc_matrix(self.K.shape)
        C = gathered(self._carried.bodies, self._carried.bodies.C, self.weight.size).tolil()
        for tether in self._tethers:
            above, below = self._ends(tether)
            way = u[below] - u[above]
            length = float(np.linalg.norm(way))
            if length > tether["length"]:
                at, gap = np.concatenate([above, below]), np.concatenate([-way, way]) / length
                C[np.ix_(at, at)] += tether["damping"] * np.outer(gap, gap)
        air = self.structure.wind.at(float(self.state.t[0]))
        if (speed := float(np.linalg.norm(air))) > 0.0:  # of drag |u| u, as far as it is linear about what stands still
            for blown in self._carried.bodies.blown:
                at = int(blown["first"]) + np.arange(air.size)
                C[np.ix_(at, at)] += blown["drag"] * (speed * np.eye(air.size) + np.outer(air, air) / speed)
        if self._carriages.bars.size:
            C += sparse.lil_matrix(self._carriages.damping(u, self.rest.shape[0]))
        return C.tocsc()


def softness(contacts: Any, axes: int) -> Array:
    """By how much lines give way beside their nodes under forces at contacts, (contact, axis, axis) m/N."""
    t, S, along = contacts["tangent"][:, :axes], contacts["moving"], contacts["axial_stiffness"]
    less = np.where(along > 0.0, 1.0 / np.where(along > 0.0, along, 1.0) - 1.0 / S, 0.0)
    return np.asarray(np.eye(axes) / S[:, None, None] + less[:, None, None] * t[:, :, None] * t[:, None, :])


def measure_from_ends(contacts: Any, structure: Structure, rest: Array) -> None:
    """Let horizontal places count from x = 0 and not from the ends of lines, which are at rest (axis, node), m."""
    lines, runs = structure.lines, structure.runs
    level = contacts["measure"] == HORIZONTAL
    contacts["begin"][level] += rest[0, runs.first[lines.first[contacts["line"][level]]]]


def load_springs(bodies: BodyArrays, u: Array, w: Array) -> None:
    """Let springs above contacts bear their weights: put coordinates of bodies where they do, as their contacts are."""
    for p, n in enumerate(bodies.size):
        at, K = bodies.at[p, :n], bodies.K[p, :n, :n]
        free, on = bodies.contact[at] < 0, bodies.contact[at] >= 0
        inner, across = K[np.ix_(free, free)], K[np.ix_(free, on)]
        solve = np.linalg.pinv(inner)
        u[at[free]] = solve @ (bodies.force[at[free]] - across @ u[at[on]])
        w[at[free]] = -solve @ across @ w[at[on]]


def gathered(bodies: BodyArrays, parts: Array, count: int) -> sparse.csc_matrix:
    """Matrices of all parts as one, (coordinate, coordinate)."""
    rows, columns, values = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)], [np.zeros(0)]
    for p, n in enumerate(bodies.size):
        at = bodies.at[p, :n]
        rows.append(np.repeat(at, n))
        columns.append(np.tile(at, n))
        values.append(parts[p, :n, :n].ravel())
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return sparse.coo_matrix(entries, shape=(count, count)).tocsc()
