"""Forces of everything at given velocities, and the powers of what is audited.

The kernels of explicit motion know strain rates as differences in time and kick restraints and bodies by their dampers;
here all of that is a function of places and velocities.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ropewalk.mechanics.bodies import PULLS
from ropewalk.mechanics.chain import Array
from ropewalk.mechanics.compiled import lean
from ropewalk.system.contact.arrivals import travelled
from ropewalk.system.contact.contact_record import AWAY, BODY, FORCE, ON, PRESCRIBED
from ropewalk.system.dynamics import motion
from ropewalk.system.dynamics.carrier import System
from ropewalk.system.dynamics.memory import Memory
from ropewalk.system.elements.structure import CARRIED, DAMPED, IN_BODIES, LOADED, MOVED, RESTRAINED, STRUCK, WORKS
from ropewalk.system.elements.surfaces import damp_surfaces
from ropewalk.system.elements.ties import damp_ties
from ropewalk.system.loads.bodies import STAYS
from ropewalk.system.loads.loaded_structure import LoadedStructure, gathered
from ropewalk.system.loads.pushes import pushes_at


class RoughGround:
    """The coordinates of a system that rough ground moves up and down, until a contact comes or leaves."""

    def __init__(self, system: System) -> None:
        self._system, contacts = system, system.contacts
        knots = system.structure.lines.profiles.knots[contacts["line"]]
        rolls = (contacts["rolls"] == 1) & (knots > 0) & (contacts["led"] == 0) & (contacts["clear"] == 0)
        away = (contacts["state"] == AWAY) & (contacts["kind"] == BODY) & (contacts["travel"] == PRESCRIBED)
        self._on = np.flatnonzero(rolls & away)
        self.coordinates = contacts["first"][self._on] + system.state.r.shape[0] - 1

    def moved(self, t: float) -> Array:
        """Height, speed and acceleration of each at time t in s, (3, coordinate) m, m/s, m/s^2."""
        system, out = self._system, np.zeros((3, self._on.size))
        profiles, dt = system.structure.lines.profiles, 1e-6
        for i, contact in enumerate(system.contacts[self._on]):
            (way, U), line = travelled(system.tables, contact, t), contact["line"]
            s, faster = float(contact["begin"]) + way, (travelled(system.tables, contact, t + dt)[1] - U) / dt
            part = slice(int(profiles.first[line]), int(profiles.first[line] + profiles.knots[line]))
            begin, c = profiles.s[part], profiles.c[:, part]
            k = int(np.clip(np.searchsorted(begin, s, side="right") - 1, 0, begin.size - 1))
            x, cubic = s - begin[k], np.polynomial.Polynomial(c[:, k])
            if not begin[0] < s < begin[-1]:  # level beyond
                x, cubic = 0.0, np.polynomial.Polynomial(c[:1, k])
            slope, bend = cubic.deriv()(x), cubic.deriv(2)(x)
            out[:, i] = cubic(x), slope * U, bend * U * U + slope * faster
        return out


# Parts of a step over which strains are differenced along their velocities, once and twice: rounding is as small as
# what it cuts off.
_LITTLE, _WIDE = 1e-3, 0.1


@lean
def _damp(surfaces, ties, r, v, force):
    """Add the forces of the dampers of cells and of ties, which have been looked at; returns the power they take, W."""
    return damp_surfaces(surfaces, r, v, force) + damp_ties(ties, v, force)


class Forces:
    """Forces on places of nodes (axis, node), then on coordinates of loads, then on places of given forces.

    Args:
        system: what moves.
        loaded: its loads, with coordinates of given forces.
    """

    def __init__(self, system: System, loaded: LoadedStructure) -> None:
        self.system, self._loaded = system, loaded
        structure, bodies, own = system.structure, system.bodies, system.bodies.mass.size
        restrained = structure.restraints
        self.K, self.C = (gathered(bodies, matrix, own).tocsr() for matrix in (bodies.K, bodies.C))
        self._stiff = self.K.diagonal()
        rank = np.einsum("eaa->e", restrained.free)
        self._driven = np.flatnonzero((restrained.entries > 1) & (rank < 0.5))
        self._sprung = np.flatnonzero(restrained.stiffness.any(axis=(1, 2)) | restrained.damping.any(axis=(1, 2)))
        self._arrange()
        self.memory, self.ground = Memory(system), RoughGround(system)
        self._dragged = structure.nodes.mass * structure.nodes.drag  # kg/s, of all but what moves as prescribed
        for e in self._driven.tolist():
            self._dragged[restrained.members(e)] = 0.0
        groups = (structure.surfaces, structure.ties)
        self._has_dampers = any(group is not None and group.damped for group in groups)
        self._little, self._span = 0.0, (0.0, 0.0)

    def _arrange(self) -> None:
        """Take note of dampers of links, N s, and of their lengths, m; what sheaves divide is a link, too."""
        structure = self.system.structure
        runs, n = structure.runs, structure.nodes.mass.size
        self._damped_links, self._h = np.zeros(n), np.ones(n)
        over = set() if structure.sheaves is None else set(structure.sheaves.run.tolist())
        for s, (first, links) in enumerate(zip(runs.first, runs.links, strict=True)):
            part = slice(first, first + links + (s in over))
            self._damped_links[part], self._h[part] = runs.damping[s], runs.h[s]

    def begin(self, dt: float, until: float) -> None:
        """Let strains be differenced as suits steps of about dt in s, from now until contacts change."""
        self._arrange()
        self.memory.begin()
        self.ground = RoughGround(self.system)
        self._little, self._span = _LITTLE * dt, (float(self.system.state.t[0]), until)

    def _sides(self, t: float) -> tuple[tuple[float, float], ...]:
        """Instants about t at which strains are looked at for their rates, and weights of the second order of these."""
        if t - self._little < self._span[0]:
            return (0.0, -3.0), (1.0, 4.0), (2.0, -1.0)
        if t + self._little > self._span[1]:
            return (0.0, 3.0), (-1.0, -4.0), (-2.0, 1.0)
        return (1.0, 1.0), (-1.0, -1.0)

    def taken(self) -> tuple[Array, Array]:
        """Places and velocities of everything as it is."""
        state, given = self.system.state, self._loaded.weight.size - self.system.bodies.mass.size
        none = np.zeros(given)
        return np.concatenate([state.r.ravel(), state.u, none]), np.concatenate([state.v.ravel(), state.w, none])

    def _place(self, e: int, t: float) -> Array:
        restrained = self.system.structure.restraints
        part = slice(int(restrained.table[e]), int(restrained.table[e] + restrained.entries[e]))
        return np.asarray(
            restrained.place[e] + [np.interp(t, restrained.time[part], row[part]) for row in restrained.moved]
        )

    def _rate(self, e: int, t: float) -> Array:
        if self.system.structure.restraints.entries[e] < 2:
            return np.zeros(self.system.state.r.shape[0])
        return (self._place(e, t) - self._place(e, t - self._little)) / self._little

    def _all_driven(self, found: Array, values: list[Array]) -> Array:
        axes, n = self.system.state.r.shape
        for e, value in zip(self._driven, values, strict=True):
            for a in range(axes):
                found[a * n + self.system.structure.restraints.members(int(e))] = value[a]
        return found

    def driven(self, t: float) -> Array:
        """Places of what moves as prescribed at time t in s, zero elsewhere."""
        none = np.zeros(self.system.state.r.size + self._loaded.weight.size)
        none[self.system.state.r.size + self.ground.coordinates] = self.ground.moved(t)[0]
        return self._all_driven(none, [self._place(int(e), t) for e in self._driven])

    def driven_rates(self, t: float) -> Array:
        """The same of velocities."""
        none = np.zeros(self.system.state.r.size + self._loaded.weight.size)
        none[self.system.state.r.size + self.ground.coordinates] = self.ground.moved(t)[1]
        return self._all_driven(none, [self._rate(int(e), t) for e in self._driven])

    def _look(self, t: float, shape: Array, rates: Array) -> None:
        state = self.system.state
        nodes, own = state.r.size, state.u.size
        state.t[0] = t
        state.r[:], state.v[:] = shape[:nodes].reshape(state.r.shape), rates[:nodes].reshape(state.r.shape)
        state.u[:], state.w[:] = shape[nodes : nodes + own], rates[nodes : nodes + own]
        if self.memory.any:
            self.memory.look()
        else:
            self.system.advance(0.0, motion.GIVEN)

    def differenced(self, t: float, shape: Array, rates: Array, seen: Callable[[], Array]) -> Array:
        """Rate at time t in s of what is seen as everything goes on at these rates, per second."""
        total = np.zeros_like(seen())
        for side, part in self._sides(t):
            self._look(t + side * self._little, shape + side * self._little * rates, rates)
            total += part * seen()
        return total / (2.0 * self._little)

    def bent(self, t: float, shape: Array, rates: Array, seen: Callable[[], Array]) -> Array:
        """The same of the rate, at constant rates of everything, per second squared."""
        wide = self._little * _WIDE / _LITTLE
        sides: tuple[tuple[float, float], ...] = ((1.0, 1.0), (0.0, -2.0), (-1.0, 1.0))
        if t - wide < self._span[0] or t + wide > self._span[1]:
            way = 1.0 if t - wide < self._span[0] else -1.0
            sides = (0.0, 2.0), (way, -5.0), (2.0 * way, 4.0), (3.0 * way, -1.0)
        total = np.zeros_like(seen())
        for side, part in sides:
            self._look(t + side * wide, shape + side * wide * rates, rates)
            total += part * seen()
        return total / wide**2

    def at(self, t: float, shape: Array, rates: Array) -> Array:
        """Forces at time t in s, N; the state is left there."""
        buffers, state, structure = self.system.buffers, self.system.state, self.system.structure
        if self._damped_links.any():
            buffers.rate[:] = 0.0
            buffers.rate[:] = self.differenced(t, shape, rates, lambda: buffers.strain)
        self._look(t, shape, rates)
        force = buffers.force - structure.nodes.mass * structure.nodes.drag * state.v
        if self._has_dampers:
            self._damp(force)
        restrained = structure.restraints
        first = restrained.node[restrained.first]
        for e, n in enumerate(first):
            force[:, n] += restrained.force[e]
        for e in self._sprung.tolist():
            away, rate = self._place(e, t) - state.r[:, first[e]], state.v[:, first[e]] - self._rate(e, t)
            force[:, first[e]] += restrained.stiffness[e] @ away - restrained.damping[e] @ rate
        out = np.zeros(shape.size)
        out[: force.size], out[force.size : force.size + state.u.size] = force.ravel(), self._on_bodies()
        return out

    def _damp(self, force: Array) -> float:
        """Add what cells and ties damp to forces (axis, node); returns the power it takes, W."""
        structure, state = self.system.structure.for_kernels, self.system.state
        return float(_damp(structure.surfaces, structure.ties, state.r, state.v, force))

    def _on_bodies(self) -> Array:
        """Forces on coordinates of loads, N."""
        state, contacts, bodies = self.system.state, self.system.contacts, self.system.bodies
        axes = state.r.shape[0]
        out = np.asarray(bodies.force + pushes_at(bodies, float(state.t[0])) - self.K @ state.u - self.C @ state.w)
        for contact in contacts[(contacts["apart"] == 1) | ((contacts["clear"] == 1) & (contacts["state"] != ON))]:
            self._follow(contact, out)
        for contact in contacts[(contacts["kind"] == BODY) & (contacts["state"] == ON)]:
            first = int(contact["first"])
            out[first : first + axes] += contact["given"][:axes] - contact["N"][:axes]
        for tether, way, T, _ in self.tethers():
            below, above = int(tether["first"]), int(contacts[tether["contact"]]["first"])
            out[below : below + axes] -= T * way
            out[above : above + axes] += T * way
        for blown in bodies.blown:
            own = slice(int(blown["first"]), int(blown["first"]) + axes)
            meets = state.w[own] - self.system.structure.wind.at(float(state.t[0]))
            out[own] -= blown["drag"] * np.linalg.norm(meets) * meets
        return out

    def _follow(self, contact: Any, out: Array) -> None:
        """Let what is in the air, and has neither mass nor spring, follow the line, as if it were on it."""
        axes, bodies = self.system.state.r.shape[0], self.system.bodies
        own = int(contact["first"]) + np.arange(axes)
        free = (bodies.per_mass[own] == 0.0) & (self._stiff[own] == 0.0)
        away = contact["p"][:axes] - self.system.state.u[own]
        out[own[free]] = away[free] * float(contact["moving"] * (contact["state"] == ON))

    def tethers(self) -> Iterator[tuple[Any, Array, float, float]]:
        """All tethers that hold: records, unit vectors, tensions and those of their dampers alone, N."""
        state, contacts, axes = self.system.state, self.system.contacts, self.system.state.r.shape[0]
        for tether in self.system.bodies.tethers:
            below, above = int(tether["first"]), int(contacts[tether["contact"]]["first"])
            across = tether["across"][:axes]
            span = state.u[below : below + axes] - state.u[above : above + axes]
            span = span - (across @ span) * across
            long = float(np.linalg.norm(span))
            spring = float(tether["stiffness"]) * (long - float(tether["length"]))
            if not tether["on"] or (tether["way"] == PULLS and spring <= 0.0):
                continue
            way = span / max(long, 1e-300)
            damper = float(tether["damping"] * (way @ (state.w[below : below + axes] - state.w[above : above + axes])))
            if (spring + damper) * tether["way"] > 0.0:
                yield tether, way, spring + damper, damper

    def react(self, acceleration: Array) -> None:
        """Note reactions of supports, whose nodes are accelerated as given, m/s^2."""
        buffers, state, restrained = self.system.buffers, self.system.state, self.system.structure.restraints
        nodes, a = self.system.structure.nodes, acceleration[: state.r.size].reshape(state.r.shape)
        for e in range(restrained.mass.size):
            own = restrained.members(e)
            drag = nodes.mass[own] * nodes.drag[own] * state.v[:, own] * float(restrained.free[e].any())
            buffers.reaction[e] = (nodes.mass[own] * a[:, own] + drag - buffers.force[:, own]).sum(axis=1)

    def losses(self, t: float) -> Array:
        """Powers (work,) of what is audited, W, but for those of contacts, which depend on how they move."""
        structure, state, buffers = self.system.structure, self.system.state, self.system.buffers
        restrained, power = structure.restraints, np.zeros(WORKS)
        power[DAMPED] = float((self._damped_links * self._h * buffers.rate**2).sum())
        power[DAMPED] += float((self._dragged * state.v**2).sum())
        if self._has_dampers:
            power[DAMPED] += self._damp(np.zeros_like(state.v))
        if structure.wind.direction.any():
            power[LOADED] = float((buffers.air * state.v).sum())
        for e in np.union1d(self._sprung, self._driven):
            n = int(restrained.node[restrained.first[e]])
            moves, rate = self._rate(e, t), state.v[:, n] - self._rate(e, t)
            power[DAMPED] += float(rate @ restrained.damping[e] @ rate)
            bears = restrained.stiffness[e] @ (self._place(e, t) - state.r[:, n]) - restrained.damping[e] @ rate
            if e in self._driven:
                bears = -(restrained.force[e] + buffers.force[:, restrained.members(e)].sum(axis=1))
            power[MOVED] += float(moves @ bears)
        bodies = self.system.bodies
        w = np.where(bodies.gone[bodies.load] == STAYS, state.w, 0.0) if bodies.load.size else state.w
        power[IN_BODIES] = float(w @ (self.C @ w))
        power[LOADED] += float(w @ pushes_at(bodies, t))
        if (on := self.ground.coordinates).size:
            bears = bodies.mass[on] * self.ground.moved(t)[2] - self._on_bodies()[on]
            power[RESTRAINED] += float(bears @ state.w[on])
        for tether, way, _, damper in self.tethers():
            below, above = int(tether["first"]), int(self.system.contacts[tether["contact"]]["first"])
            axes = state.r.shape[0]
            power[IN_BODIES] += damper * float(way @ (state.w[below : below + axes] - state.w[above : above + axes]))
        for blown in self.system.bodies.blown:
            own = slice(int(blown["first"]), int(blown["first"]) + state.r.shape[0])
            air = structure.wind.at(t)
            meets = state.w[own] - air
            square = float(blown["drag"]) * float(np.linalg.norm(meets))
            power[IN_BODIES] += square * float(meets @ meets)
            power[LOADED] -= square * float(meets @ air)
        return power


class Powers:
    """Powers at the stages of a step: of contacts, by how their places and kinks change along its polynomial.

    Args:
        forces: of everything.
        contacts: as they were at the start of the step.
    """

    def __init__(self, forces: Forces, contacts: Any) -> None:
        self._forces, self.force = forces, np.zeros(0)
        self._seen, self._power = [contacts], list[Array]()

    def see(self, t: float, shape: Array, rates: Array) -> None:
        """Look at the next stage."""
        self.force = self._forces.at(t, shape, rates)
        self._seen.append(self._forces.system.contacts.copy())
        self._power.append(self._forces.losses(t))

    def at_stages(self, dt: float, D: Array) -> Iterator[Array]:
        """Powers (work,) of all stages, W; dt in s, D: (stage, stage), rates of stages over dt."""
        begin, *stages = self._seen
        axes = self._forces.system.state.r.shape[0]
        for j, (stage, power) in enumerate(zip(stages, self._power, strict=True)):
            place, d = (
                sum(D[j, m] * (other[key] - begin[key])[:, :axes] for m, other in enumerate(stages)) / dt
                for key in ("place", "d")
            )
            on = stage["state"] == ON
            work = (stage["given"][:, :axes] * place).sum(axis=1)
            power[LOADED] += float(work[on].sum())
            level = self._forces.system.structure.runs.ahead[stage["run"]]
            restrained = stage["hold"] * (level * place).sum(axis=1)
            power[RESTRAINED] += float(restrained[on & (stage["kind"] == FORCE)].sum())
            power[CARRIED] += float((stage["carried"] * (stage["d"][:, :axes] * d).sum(axis=1))[on].sum())
            push = stage["push"] * stage["speed"]
            power[STRUCK] -= float(push[on & (stage["kind"] == FORCE)].sum())
            power[RESTRAINED] += float(push[on & (stage["kind"] == BODY)].sum())
            yield power
