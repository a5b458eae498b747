"""The structure as plain arrays: cable runs of nodes, what holds them, and room for a step.

Nodes are columns of one array, the nodes of a run one after the other; between two runs lies a link that does not
exist. A place where runs meet is a node of each of them, kept together by a holding (`Holdings`). A line is one run, or
several where something is joined to it on its way.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.chain import Array, Integers


class Runs(NamedTuple):
    """Cable runs; one entry for each."""

    first: Integers  # its first node
    links: Integers  # at least two
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


class Nodes(NamedTuple):
    """What nodes are; (node,) or (axis, node)."""

    mass: Array  # kg
    light: Array  # 1/kg, what a force accelerates; 0 for nodes that a holding moves
    mobile: Array  # 1/kg, the same, with what holdings let move
    force: Array  # (axis, node) N, weight and constant forces
    drag: Array  # 1/s, force over momentum
    level: Array  # m, height at which the foundation is without force


class Lines(NamedTuple):
    """Lines, each one or more runs one after the other."""

    first: Integers  # its first run
    runs: Integers
    begin: Array  # (run,) m, where each run begins on its line
    length: Array  # (line,) m, unstrained


class Holdings(NamedTuple):
    """What holds one node, or several together: supports and joints."""

    first: Integers  # (holding,) where its nodes begin
    nodes: Integers
    node: Integers
    mass: Array  # kg, its own
    force: Array  # (holding, axis) N, constant, its weight included
    free: Array  # (holding, axis, axis) projection onto the directions in which it may move
    stiffness: Array  # (holding, axis, axis) N/m, within the free directions
    damping: Array  # N s/m
    place: Array  # (holding, axis) m, where it stands, or its springs are without force
    table: Integers  # where the table of its displacement begins
    entries: Integers
    time: Array  # s
    moved: Array  # (axis, entry) m


class Wind(NamedTuple):
    """Air that moves."""

    direction: Array  # (axis,) unit vector; zeros: no wind
    time: Array  # s
    speed: Array  # m/s
    density: float  # kg/m^3


class Structure(NamedTuple):
    """All that does not change while it moves."""

    runs: Runs
    nodes: Nodes
    lines: Lines
    holdings: Holdings
    wind: Wind


class Room(NamedTuple):
    """Room for a step, so that the loop allocates nothing; (node,) or (axis, node), links by their first node."""

    strain: Array
    before: Array  # strain when it was last looked at
    rate: Array  # 1/s, of the strain then
    tension: Array  # N
    length: Array  # m
    square: Array  # m^2, half of what arcs add to the squares of lengths
    pull: Array  # N/m, tension over length
    moment: Array  # N, of one component
    bent: Array  # (axis, node) m, second difference
    force: Array  # (axis, node) N
    air: Array  # (axis, node) N, of the wind
    guess: Array  # (axis, node) m/s, in the middle of a kick
    reaction: Array  # (holding, axis) N, of the support on the structure

    @staticmethod
    def of(structure: Structure, axes: int) -> Room:
        """Room of the right size."""
        n, held = structure.nodes.mass.size, structure.holdings.mass.size
        sizes = [(n,)] * 8 + [(axes, n)] * 4 + [(held, axes)]
        return Room(*(np.zeros(size) for size in sizes))


class State(NamedTuple):
    """All that changes in motion."""

    t: Array  # (1,) s
    r: Array  # (axis, node) m
    v: Array  # (axis, node) m/s
    u: Array  # (coordinate,) m, places of contacts that have a body, then coordinates of bodies
    w: Array  # (coordinate,) m/s
    s: Array  # (contact,) m, along its line
    work: Array  # (WORKS,) J, done or lost since the start

    def copy(self) -> State:
        """An independent copy."""
        return State(*(array.copy() for array in self))


# Entries of `work`.
DAMPED, LOADED, HELD, MOVED, IN_BODIES, STRUCK, CARRIED = 0, 1, 2, 3, 4, 5, 6
WORKS = 7
