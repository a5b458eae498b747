"""The structure as plain arrays: cable runs of nodes, what holds them, and room for a step.

Nodes are columns of one array, the nodes of a run one after the other; between two runs lies a link that does not
exist. A place where runs meet is a node of each of them, kept together by a holding (`Holdings`). A line is one run, or
several where something is joined to it on its way.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics import law
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import records
from ropewalk.results.frames import summed
from ropewalk.system.elements.elements_about_rest import ElementsAboutRest
from ropewalk.system.elements.profile import Profiles
from ropewalk.system.elements.saddles import Saddles
from ropewalk.system.elements.segments import Segments
from ropewalk.system.elements.surfaces import Surfaces
from ropewalk.system.elements.ties import Ties


class Runs(NamedTuple):
    """Cable runs; one entry for each."""

    first: Integers  # its first node
    links: Integers
    h: Array  # m, unstrained length of a link
    rho: Array  # kg/m
    law: Array  # (run, parameter), see mechanics/law.py
    damping: Array  # N s, Kelvin-Voigt
    bending: Array  # N m^2
    bed: Array  # N/m^2, stiffness of an elastic foundation
    width: Array  # m, drag coefficient times width
    clamped: Integers  # (run, side) 1: it cannot turn there
    turned: Array  # (run, side, axis) m, difference of the first two nodes and of the last two where it is clamped
    shift: Array  # (run, side, 2) parts of the wind on a link that the next two nodes bear for an end
    arcs: Array  # 1: links are arcs; 0: chords, as the edges of the cells beside them
    firm: Array  # N/m, stiffness of contacts on a way on a net; 0: it is a cable
    ahead: Array  # (run, axis) unit vector, level, along which a horizontal force holds contacts
    hysteresis: Array  # (run, parameter) see hysteresis.py; 0 first: none


class Nodes(NamedTuple):
    """What nodes are; (node,) or (axis, node)."""

    mass: Array  # kg
    light: Array  # 1/kg, what a force accelerates; 0 for nodes that a restraint moves
    mobile: Array  # 1/kg, the same, with what restraints let move
    force: Array  # (axis, node) N, weight and constant forces
    drag: Array  # 1/s, force over momentum
    level: Array  # m, height at which the foundation is without force


class Lines(NamedTuple):
    """Lines, each one or more runs one after the other."""

    first: Integers  # its first run
    runs: Integers
    begin: Array  # (run,) m, where each run begins on its line
    length: Array  # (line,) m, unstrained
    profiles: Profiles


class Restraints(NamedTuple):
    """What holds one node, or several together: supports and joints."""

    first: Integers  # (restraint,) where its nodes begin
    nodes: Integers
    node: Integers
    mass: Array  # kg, its own
    force: Array  # (restraint, axis) N, constant, its weight included
    free: Array  # (restraint, axis, axis) projection onto the directions in which it may move
    stiffness: Array  # (restraint, axis, axis) N/m, within the free directions
    damping: Array  # N s/m
    place: Array  # (restraint, axis) m, where it stands, or its springs are without force
    table: Integers  # where the table of its displacement begins
    entries: Integers
    time: Array  # s
    moved: Array  # (axis, entry) m
    winch: Array  # (restraint, 2) m/s and N, fastest speed and dead band of what runs along a rail; zeros: no winch

    def members(self, e: int) -> Integers:
        """Nodes of a holding."""
        return self.node[self.first[e] : self.first[e] + self.nodes[e]]

    def place_at(self, e: int, t: float) -> Array:
        """Where it stands at time t in s, or its springs are without force, m."""
        part = slice(int(self.table[e]), int(self.table[e] + self.entries[e]))
        return np.asarray(self.place[e] + [np.interp(t, self.time[part], row[part]) for row in self.moved])

    def put(self, r: Array, t: float = 0.0) -> Array:
        """Places of nodes (axis, node) in m with those where they are held at time t in s that may not be elsewhere."""
        out = r.copy()
        for e in range(self.mass.size):
            nodes, tied = self.members(e), np.eye(r.shape[0]) - self.free[e]
            out[:, nodes] += tied @ (self.place_at(e, t)[:, None] - out[:, nodes])
        return out


class WindField(NamedTuple):
    """Air that moves."""

    direction: Array  # (axis,) unit vector; zeros: no wind
    time: Array  # s
    speed: Array  # m/s
    density: float  # kg/m^3

    def at(self, t: float) -> Array:
        """Velocity of the air at time t in s, (axis,) m/s."""
        return np.asarray(float(np.interp(t, self.time, self.speed)) * self.direction)


REST = np.dtype(
    [("strain", "f8"), ("tension", "f8"), ("slope", "f8"), ("length", "f8"), ("pull", "f8")], align=True
)  # of a link: also N, what tension changes by with strain, N, m, and tension over length, N/m


class About(NamedTuple):
    """Rest, about which runs are linearised. Few arrays, for to hand them on costs a step as much as nodes do."""

    shape: Array  # (2, axis, node) m, places and second differences; of no nodes: nothing is linearised
    links: Any  # (node,) of REST

    @staticmethod
    def nothing(axes: int) -> About:
        """Of what moves with all geometry."""
        return About(np.zeros((2, axes, 0)), records(0, REST))


class Inertia(NamedTuple):
    """By what nodes are heavier along their lines; no entries: by nothing."""

    factor: float
    along: Array  # (axis, node) unit vectors; zero: it is held, or the same in all directions
    restrained: Array  # (holding, axis, axis) kg, what that adds to what a holding moves, within its free directions

    @staticmethod
    def nothing(axes: int) -> Inertia:
        """Of nodes that are as heavy along their lines as across."""
        return Inertia(1.0, np.zeros((axes, 0)), np.zeros((0, axes, axes)))

    def kinetic(self, mass: Array, v: Array, restrained: Array) -> Array:
        """What it adds to the kinetic energy, (instant,) J.

        Args:
            mass: (node,) kg.
            v: (instant, axis, node) m/s.
            restrained: (instant, axis, restraint) m/s.
        """
        if not self.along.size:
            return np.zeros(len(v))
        along = (self.along * v).sum(axis=1)
        more = summed(restrained[:, :, None] * self.restrained.transpose(1, 2, 0) * restrained[:, None])
        return np.asarray(0.5 * ((self.factor - 1.0) * summed(mass * along**2) + more))


class Sheaves(NamedTuple):
    """Points over which lines run; one entry for each."""

    node: Integers  # its own
    run: Integers  # which ends at it; the next one goes on
    ahead: Array  # m, unstrained length between the last node of that run and the sheave
    friction: Array  # coefficient
    tension: Array  # (sheave, 2) N, behind and ahead, without damping
    drive: Array  # N, by which it was pulled behind more than ahead when it slipped last: energy over slip
    weight: Array  # (sheave, axis) N/m, of the line
    about: ElementsAboutRest = ElementsAboutRest.nothing()
    # (sheave, 5) at rest: both tensions, N, what is behind, m, strain and tension of the link in the mean, N
    rest: Array = np.zeros((0, 5))
    changes: Array = np.zeros((0, 5, 0))  # (sheave, 5, place) of these with places of its element

    @staticmethod
    def nothing(axes: int) -> Sheaves:
        """Of lines that run over none."""
        i, x = np.zeros(0, dtype=np.int64), np.zeros(0)
        return Sheaves(i, i, x, x, np.zeros((0, 2)), x, np.zeros((0, axes)))


class Structure(NamedTuple):
    """All that does not change while it moves."""

    runs: Runs
    nodes: Nodes
    lines: Lines
    restraints: Restraints
    wind: WindField
    about: About
    inertia: Inertia
    surfaces: Surfaces | None
    sheaves: Sheaves | None
    taut: Array | None = None  # (node,) N, tension at rest of inextensible links; None: there are none
    ties: Ties | None = None
    saddles: Saddles | None = None
    segments: Segments | None = None  # None: lines are the same all along

    @property
    def is_plain(self) -> bool:
        """Whether it has nothing of what most structures have not."""
        return all(getattr(self, name) is None for name in _GROUPS)

    @property
    def for_kernels(self) -> Structure:
        """As kernels are handed it: unless it is plain, with empty arrays of what is not there.

        So that they are compiled for two kinds of structures, and not for each set of what is there.
        """
        if self.is_plain:
            return self
        more = {name: empty for name, empty in _nothing(self.nodes.force.shape[0]) if getattr(self, name) is None}
        return self._replace(taut=None, **more)

    @property
    def is_linearised(self) -> bool:
        """Whether its runs are linearised about rest."""
        return bool(self.about.links.size > 0)

    @property
    def on_runs(self) -> NDArray[np.bool_]:
        """Which nodes are those of runs or nets; others are at sheaves, or masses between ties, which act across x."""
        found = np.full(self.nodes.mass.size, self.surfaces is not None)
        for first, links in zip(self.runs.first, self.runs.links, strict=True):
            found[first : first + links + 1] = True
        return found


class Tight(NamedTuple):
    """What keeps inextensible links at their lengths (`constraints.py`); (node,), links by their first node."""

    h: Array  # m, of these links; 0: it is no such link
    fast: Array  # m/kg, square of the largest frequency of waves over the tension
    time: Array  # s for which tensions have kicked; 1: there are two to go on from; 1/s^2 the square of the largest
    # frequency; the most that it may be times the square of the step
    guess: Array  # N, tensions that have kicked
    found: Array  # N, as they should have been
    before: Array  # N, a step before
    miss: Array  # m^2
    x: Array  # N s/m, impulses over lengths
    p: Array  # room of conjugate gradients
    y: Array
    z: Array
    band: Array  # (4, node)
    g: Array  # (axis, 4, node) m, change of the squares of lengths over 2 with nodes
    move: Array  # (axis, node) m/s
    whole: Array  # (restraint, axis) m/s
    mobile: Array  # (restraint, axis, axis) 1/kg, of restraints in a step

    @staticmethod
    def of(structure: Structure, axes: int) -> Tight | None:
        """Of a structure, if it has inextensible links."""
        runs, n, restrained = structure.runs, structure.nodes.mass.size, structure.restraints.mass.size
        if structure.taut is None:
            return None
        h, fast = np.zeros(n), np.zeros(n)
        for s in np.flatnonzero(runs.law[:, 0] == law.RIGID):
            part = slice(runs.first[s], runs.first[s] + runs.links[s])
            h[part] = runs.h[s]
            if not structure.is_linearised:  # whose waves do not know how tensions grow
                fast[part] = 1.0 / (runs.rho[s] * runs.h[s] ** 2)
        buffers = [np.zeros(n) for _ in range(8)]
        buffers[2][:] = structure.taut
        more = [
            np.zeros(size) for size in ((4, n), (axes, 4, n), (axes, n), (restrained, axes), (restrained, axes, axes))
        ]
        return Tight(h, fast, np.zeros(4), *buffers, *more)

    @staticmethod
    def nothing(axes: int) -> Tight:
        """Of lines whose links all stretch."""
        x, sizes = np.zeros(0), ((4, 0), (axes, 4, 0), (axes, 0), (0, axes), (0, axes, axes))
        return Tight(x, x, np.zeros(4), *[x] * 8, *(np.zeros(size) for size in sizes))

    def step_by(self, structure: Structure, dt: float) -> None:
        """Note how restraints yield in a step of the length dt in s, as they are kicked."""
        restrained, axes = structure.restraints, self.move.shape[0]
        for e in range(restrained.mass.size):
            P, mass = restrained.free[e], float(restrained.mass[e] + structure.nodes.mass[restrained.members(e)].sum())
            A = mass * np.eye(axes) + 0.5 * dt * restrained.damping[e] + 0.25 * dt * dt * restrained.stiffness[e]
            self.mobile[e] = P @ np.linalg.inv(P @ A @ P + np.eye(axes) - P) @ P


class Buffers(NamedTuple):
    """Room for a step, so that the loop allocates nothing; (node,) or (axis, node), links by their first node."""

    strain: Array
    before: Array  # strain when it was last looked at
    rate: Array  # 1/s, of the strain then
    tension: Array  # N
    length: Array  # m
    change: Array  # N/m, of what is linearised, change of `pull`
    pull: Array  # N/m, tension over length; of what is linearised, at rest
    moment: Array  # N, of one component
    path: Array  # m, length of a line up to each of its nodes
    lag: Array  # (2, node) N, by which hysteresis has tensions below the curve of loading; strain at the last look
    bent: Array  # (axis, node) m, second difference
    force: Array  # (axis, node) N
    air: Array  # (axis, node) N, of the wind
    guess: Array  # (axis, node) m/s, in the middle of a kick
    reaction: Array  # (restraint, axis) N, of the support on the structure
    tight: Tight | None

    @staticmethod
    def of(structure: Structure, axes: int) -> Buffers:
        """Room of the right size."""
        n, restrained = structure.nodes.mass.size, structure.restraints.mass.size
        sizes = [(n,)] * 9 + [(2, n)] + [(axes, n)] * 4 + [(restrained, axes)]
        parts: list[Any] = [*(np.zeros(size) for size in sizes), Tight.of(structure, axes)]
        buffers = Buffers(*parts)
        if structure.taut is not None:
            buffers.tension[:] = structure.taut
        return buffers

    def for_kernels(self, structure: Structure) -> Buffers:
        """As kernels are handed it beside a structure, see there."""
        if self.tight is not None or structure.is_plain:
            return self
        return self._replace(tight=_loose(structure.nodes.force.shape[0]))

    def react(self, restraints: Restraints) -> None:
        """Note reactions of supports on what stands still, whose forces are known."""
        for e in range(restraints.mass.size):
            self.reaction[e] = -self.force[:, restraints.members(e)].sum(axis=1)


_GROUPS = ("surfaces", "sheaves", "taut", "ties", "saddles", "segments")


@cache
def _nothing(axes: int) -> tuple[tuple[str, Any], ...]:
    """Empty arrays of what a structure may have; nobody writes to them."""
    return (
        ("surfaces", Surfaces.nothing()), ("sheaves", Sheaves.nothing(axes)), ("ties", Ties.nothing(axes)),
        ("saddles", Saddles.nothing(axes)), ("segments", Segments.nothing()),
    )  # fmt: skip


@cache
def _loose(axes: int) -> Tight:
    return Tight.nothing(axes)


class SystemState(NamedTuple):
    """All that changes in motion."""

    t: Array  # (1,) s
    r: Array  # (axis, node) m
    v: Array  # (axis, node) m/s
    u: Array  # (coordinate,) m, places of contacts that have a body, then coordinates of bodies
    w: Array  # (coordinate,) m/s
    s: Array  # (contact,) m, along its line
    work: Array  # (WORKS,) J, done or lost since the start

    def copy(self) -> SystemState:
        """An independent copy."""
        return SystemState(*(array.copy() for array in self))


# Entries of `work`.
DAMPED, LOADED, RESTRAINED, MOVED, IN_BODIES, STRUCK, CARRIED, RUBBED, DRIVEN, LAGGED = range(10)
WORKS = 10
