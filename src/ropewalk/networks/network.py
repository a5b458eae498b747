"""A network as plain arrays: nodes in space, links and triangles between them, supports, and loads.

Nodes come first, one node for each contact after them. Links come first, too, followed by slots: a link on which a
contact stands is switched off, and slots take its place, which meet at the contact (`contact_location.py`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

THREADS, SHEET = 0, 1  # kinds of fabric
OFF, FORCE, MASS = 0, 1, 2  # what a contact is at present
LEAVES, STAYS, REFUSED, GONE = 0, 1, 2, 3  # what happens at an end of the way; the last one: has happened
LINK_SLOTS = 2  # for each contact


class Links(NamedTuple):
    """Straight pieces of lines, slots at the end."""

    one: Integers  # (link,) nodes
    other: Integers
    rest: Array  # (link,) m, unstrained length
    law: Integers  # (link,) row of `laws`
    width: Array  # (link,) m, drag coefficient times width
    on: Integers  # (link,) 1: it pulls; 0: slots or a sheave stand for it
    laws: Array  # (law, parameter), see mechanics/law.py


class Cells(NamedTuple):
    """Triangles of nets and membranes."""

    node: Integers  # (cell, 3)
    inverse: Array  # (cell, 4) 1/m, of [X2 - X1, X3 - X1] in material coordinates: a b / c d row by row
    area: Array  # (cell,) m^2, unstrained
    membrane_elements: Integers  # (cell,) row of `fabrics`
    fabrics: Array  # (fabric, 7): kind, four constants, and unstrained over laid-out length along u, v


class NetworkSupports(NamedTuple):
    """What holds nodes beside links and cells."""

    fixed: Integers  # nodes that do not move
    rail: Integers  # nodes that move along a straight line only
    along: Array  # (rail, 3) its direction, a unit vector
    spring: Integers  # nodes on springs and dampers
    place: Array  # (spring, 3) m, without force there
    stiffness: Array  # (spring, 3, 3) N/m
    moves: Moves


class Moves(NamedTuple):
    """Fixed nodes and places of springs that move as prescribed; tables one after the other."""

    node: Integers  # (move,) the node, -1: a spring
    spring: Integers  # (move,) the spring, -1: a node
    place: Array  # (move, 3) m, without displacement
    first: Integers
    entries: Integers
    time: Array  # s
    value: Array  # (3, entry) m, displacement


class NetworkSheaves(NamedTuple):
    """Points over which lines run: each stands over one link of its line, which it divides."""

    node: Integers  # of the sheave itself, fixed or a joint
    link: Integers  # over which it stands
    first: Integers  # first and last link of its line
    last: Integers
    ahead: Array  # (sheave,) m, unstrained length between the start of its link and the sheave
    friction: Array  # (sheave,) coefficient
    tension: Array  # (sheave, 2) N, behind and ahead


class Locations(NamedTuple):
    """Where contacts stand and what they are; one entry for each contact."""

    kind: Integers  # OFF, FORCE, MASS
    wanted: Integers  # what it is while it is on its line
    first: Integers  # of its line: first link, first entry of `station`
    segments: Integers  # links
    xi: Array  # (contact,) m along its line
    load: Array  # (contact, 3) N, the given force
    speed: Array  # (contact,) m/s
    cell: Integers  # (contact,) link on which it stands
    split_link: Integers  # (contact,) link that is switched off for it, -1: none
    last: Integers  # (contact,) link on which it stood when the slots were made, -1: none
    weight: Array  # (contact, 2) of the start and the end of its link
    station: Array  # m along each line, of its nodes, one line after the other
    first_station: Integers  # (contact,) where those of its line begin
    mass: Array  # (contact,) kg


class ContactSchedule(NamedTuple):
    """When contacts are where, and the forces on them: tables of all contacts, one after the other."""

    first: Integers  # (contact,) of knots
    knots: Integers
    time: Array  # (knot,) s; two equal ones make a jump
    place: Array  # (knot,) m
    speed: Array  # (knot,) m/s, after the knot
    slope: Array  # (knot,) m/s^2, after the knot
    length: Array  # (contact,) m, of the line
    low: Array  # (contact,) m, where the line ends for it, towards the start and
    high: Array  # towards the end
    at_end: Integers  # (contact,) LEAVES, STAYS or REFUSED; GONE or STOPPED once it has come there
    force_first: Integers
    force_count: Integers
    force_time: Array
    force_value: Array  # (3, entry) N


class NetworkWind(NamedTuple):
    """Air that moves."""

    direction: Array  # (3,) unit vector, zeros: no wind
    time: Array  # s
    speed: Array  # m/s
    density: float  # kg/m^3


class NodeWeights(NamedTuple):
    """What nodes weigh."""

    mass: Array  # (node,) kg, contacts at the end
    force: Array  # (node, 3) N, weight and constant forces


class Network(NamedTuple):
    """Everything that stays the same, with the arrays in which slots change."""

    links: Links
    cells: Cells
    restrained: NetworkSupports
    sheaves: NetworkSheaves
    locations: Locations
    course: ContactSchedule
    wind: NetworkWind
    body: NodeWeights
    gravity: Array  # (3,) m/s^2
    own_links: int  # without slots
    nodes: int  # without contacts


def whole(values: Array) -> Integers:
    """Numbers of nodes and the like, as integers."""
    return np.ascontiguousarray(values, dtype=np.int64)
