"""Motions by the compiled core, whose structure, weights and start are those of today's system at rest."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import eigsh

from ropewalk.engine.bound import Bound
from ropewalk.engine.builder import Builder, RunProperties, SpringProperties
from ropewalk.engine.model import Block
from ropewalk.model import Scenario
from ropewalk.results.frame import RunInfo
from ropewalk.system.dynamics.moving import SystemMotion
from ropewalk.system.equilibrium.form_finding import formed

Array = np.ndarray
VARIANT = "avx2"
SAFETY_OF_ROPES, SAFETY = 0.9, 0.7
"""Step over the longest stable one: as today's engine of ropes has it with forces, and today's system with loads."""


class CoreFrame(NamedTuple):
    """What problems need of a frame: today's names and shapes."""

    position: Array
    path: float
    contact_position: Array
    contact_force: Array


class CoreMotion:
    """Lines, hangers of one link each, and loads with a prescribed speed."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = formed(scenario)
        self.today = SystemMotion(self.scenario, RunInfo(), np.array([0.0, self.scenario.run.until]))
        self.steps = 0
        self.long = list[int]()  # runs of the system that are runs of the core
        self.node = np.full(self.today.rest.shape[1], -1)  # of the core, by that of the system
        self.bodies = dict[int, Array]()  # velocities at the start by nodes
        builder = self._builder()
        model, state = builder.build()
        self._set_weights(model)
        bare = Bound(model, state)
        self.step = (SAFETY_OF_ROPES if len(self.long) == 1 else SAFETY) * 2.0 / largest_frequency(bare)
        self._add_loads(builder)
        model, state = builder.build(step=self.step)
        self._set_weights(model)
        for body, velocity in self.bodies.items():
            state.velocity[:, body] = velocity
        self.bound = Bound(model, state)
        self.begin = state.copy()

    def _builder(self) -> Builder:
        """Return the structure without loads."""
        runs = self.today.structure.runs
        builder = Builder(self.today.rest.shape[0], self.scenario.gravity)
        ties = np.flatnonzero((runs.links == 1) & (runs.links.size > 1)).tolist()
        self.long = [s for s in range(runs.links.size) if s not in ties]
        for s in self.long:
            self._add_run(builder, s)
        self._join(builder)
        for s in ties:
            self._add_tie(builder, s)
        return builder

    def _add_run(self, builder: Builder, s: int) -> None:
        runs, law = self.today.structure.runs, self.today.structure.runs.law[s]
        nodes = runs.first[s] + np.arange(runs.links[s] + 1)
        own = RunProperties(
            float(runs.h[s]), float(runs.rho[s]), float(law[2]), float(runs.damping[s]), float(runs.bending[s]),
            law[1] == 0.0, bool(runs.arcs[s]),
        )  # fmt: skip
        begin, _ = builder.add_run(self.today.rest[:, nodes], own)
        self.node[nodes] = begin + np.arange(nodes.size)

    def _join(self, builder: Builder) -> None:
        """Hold nodes, and join those that are one point; ties end there, too."""
        restraints = self.today.structure.restraints
        for e in range(restraints.mass.size):
            members = restraints.members(e)
            known = self.node[members[self.node[members] >= 0]].tolist()
            self.node[members[self.node[members] < 0]] = known[0]
            if not restraints.free[e].any():
                builder.fix(*known)
                continue
            for copy in known[1:]:
                builder.join(copy, known[0])
            builder.add_mass(known[0], float(restraints.mass[e]))

    def _add_tie(self, builder: Builder, s: int) -> None:
        runs = self.today.structure.runs
        begin, end = self.node[runs.first[s] : runs.first[s] + 2].tolist()
        h, EA = float(runs.h[s]), float(runs.law[s, 2])
        builder.add_spring(begin, end, SpringProperties(EA / h, h, tension_only=runs.law[s, 1] == 0.0))
        for node in (begin, end):
            builder.add_mass(node, 0.5 * float(runs.rho[s]) * h)

    def _add_loads(self, builder: Builder) -> None:
        """Add forces and masses, which move along the runs on which they begin."""
        lines, names = self.today.structure.lines, list(self.today.assembled.line)
        for load, s in zip(self.scenario.loads.values(), self.today.state.s.tolist(), strict=True):
            first = names.index(load.on)
            run = first + int(np.searchsorted(lines.begin[first : first + names.count(load.on)], s, "right")) - 1
            self._add_load(builder, load, self.long.index(run), s - float(lines.begin[run]))

    def _add_load(self, builder: Builder, load: object, run: int, place: float) -> None:
        speed = float(load.travel.speed)
        if load.kind == "force":
            builder.add_force(run, load.force, place, speed)
            return
        line = self.scenario.lines[load.on]
        along = (np.asarray(line.end) - np.asarray(line.start)) / line.length
        body = builder.add_node(np.asarray(line.start) + place * along, load.mass)
        if load.force is not None:
            builder.push(body, load.force)
        builder.add_contact(run, body, place, speed)
        self.bodies[body] = speed * along

    def _set_weights(self, model: Block) -> None:
        """Set weights as today's system has them near ends of runs, so that its rest is one of the core."""
        joined = dict(zip(model.joint_copy.tolist(), model.joint_original.tolist(), strict=True))
        points = [joined.get(node, node) for node in self.node.tolist()]
        model.weight[:, : self.node.max() + 1] = 0.0
        for row, forces in zip(model.weight, self.today.structure.nodes.force, strict=True):
            np.add.at(row, points, forces)

    def restart(self) -> None:
        """Go back to the first state."""
        self.bound.state.memory[:], self.steps = self.begin.memory, 0

    def advance(self, time: float, variant: str = VARIANT) -> None:
        """Go on to an instant, s."""
        left = time - float(self.bound.state.time[0])
        if (steps := int(np.ceil(left / self.step - 1e-9))) > 0:
            self.bound.advance(steps, left / steps, variant)
            self.steps += steps

    def frames(self, times: Array, variant: str = VARIANT) -> list[CoreFrame]:
        """Return frames at some instants, s."""
        found = list[CoreFrame]()
        self.restart()
        for time in times.tolist():
            self.advance(time, variant)
            position = self.bound.state.position
            shown = position[:, self.node[self.today.displayed]].T.copy()
            found.append(CoreFrame(shown, time, position[:, list(self.bodies)].T.copy(), np.full((1, 2), np.nan)))
        return found


class CoreNet(CoreMotion):
    """A rectangular net whose threads are runs, with bands of springs across, under a force along a thread."""

    def _builder(self) -> Builder:
        """Return the structure without loads."""
        net = next(iter(self.scenario.nets.values()))
        rest, mesh = self.today.rest, net.mesh
        sides, cells = np.linalg.norm(net.sides, axis=1), np.asarray(net.cells)
        h, stretch = sides / cells, 1.0 + net.tension / net.axial_stiffness
        columns, rows = (np.rint(rest[k] / h[k]).astype(int) for k in (0, 1))
        owned = self.today.structure.nodes.mass > 0.0  # not the nodes of paths
        self.at = np.full((cells[1] + 1, cells[0] + 1), -1)
        self.at[rows[owned], columns[owned]] = np.flatnonzero(owned)
        builder, width = Builder(3, self.scenario.gravity), cells[0] + 1
        stiffness = net.axial_stiffness * h[::-1] / mesh  # of the computed threads along u and along v
        along = RunProperties(h[0] / stretch, 0.0, stiffness[0], curved=False, tension_only=True)
        across = SpringProperties(stiffness[1] / h[1] * stretch, h[1] / stretch, tension_only=True)
        for row, nodes in enumerate(self.at):
            first, last = builder.add_run(rest[:, nodes], along)
            self.node[nodes] = np.arange(first, last + 1)
            builder.fix(*(range(first, last + 1) if row in (0, cells[1]) else (first, last)))
            for node, of in zip(range(first, last + 1), nodes.tolist(), strict=True):
                builder.add_mass(node, float(self.today.structure.nodes.mass[of]))
            if row:
                builder.add_band(first - width + 1, first + 1, int(cells[0]) - 1, across)
        self.node[self.node < 0] = 0
        self.laid, self.link = h, h[0] / stretch
        return builder

    def _add_loads(self, builder: Builder) -> None:
        """Add forces; their paths begin on threads along u and follow them."""
        for load in self.scenario.loads.values():
            (x, y), scale = load.travel.path[0], self.link / self.laid[0]
            builder.add_force(round(y / self.laid[1]), load.force, x * scale, float(load.travel.speed) * scale)


def largest_frequency(bound: Bound) -> float:
    """Return the largest frequency of small motion about the positions of the State, rad/s."""
    free, mobility = bound.unknowns(), bound.model.mobility.ravel()
    root = sparse.diags(np.sqrt(mobility[mobility > 0.0]))
    matrix = (root @ free.T @ bound.linearise().stiffness @ free @ root).tocsc()
    start = np.sin(np.arange(matrix.shape[0]))
    values = eigsh(0.5 * (matrix + matrix.T), k=1, return_eigenvectors=False, tol=1e-4, v0=start)
    return float(np.sqrt(values[0]))
