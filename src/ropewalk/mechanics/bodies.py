"""Bodies as plain arrays: what has a mass of its own, stands on the line at one or more wheels, and moves with it.

Every place where a load touches its line is a wheel, and every wheel an entry of `Loads`, whether or not it has a mass.
A heavy wheel has its own place on the chain, see moving_mass.py; a light one rides with a node as a force does, and its
mass is added to that of the node. Above the wheels stand the coordinates of the vehicles, see vehicles.py.

Records instead of one array for each quantity: a kernel is handed ten numbers for every array.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import records

CARRIED = -3  # value of `State.moving_load` for a wheel that bodies look after: a heavy one, or one that waits

# `travel`: the place xi is given; it is given and the hold force keeps the tensions equal; x is given and the line
# slides without friction; the load travels freely.
GIVEN, EVEN, ALONG_X, FREE = 0, 1, 2, 3

# `phase`: off the line for good; not yet on it, on firm ground before its start; on it close to a support, which bears
# it; in a link, which it divides in two; in the place of a node, whose particle it carries along; in the air; riding as
# a force does.
AWAY, WAITING, PARKED, INSIDE, LOCATED, FLYING, MOVING_WITH = 0, 1, 2, 3, 4, 5, 6

PULLS, PUSHES, BOTH = 1, -1, 0  # `way` of a tether
SWINGS, STANDS = 1, 2  # `watch` of a leg: until its foot comes down to the line, until it no longer pushes

_REAL, _CODE, _VECTOR = "f8", "i8", ("f8", (3,))

WHEEL = np.dtype(
    [
        # what it is
        ("mass", *_VECTOR),  # kg, inertia at the contact; the last component is what has weight
        ("heavy", _CODE),  # 1: has its own place on the chain
        ("travel", _CODE),
        ("lift", _CODE),  # 0: cannot leave the line; 1, -1: runs above, below it, and can
        ("clearance", _REAL),  # m, distance from a support below which the support bears it
        ("margin", _REAL),  # m, distance from a support at which the line ends for it
        ("air_drag", _REAL),  # kg/m, force over speed squared
        ("rolling", _REAL),  # coefficient of rolling resistance
        ("viscous", _REAL),  # N s/m, friction over speed
        ("drive_first", _CODE),  # where the table of its drive begins
        ("drive_count", _CODE),
        ("driver", _REAL),  # N, the most that holds the speed of `Loads`; 0: no driver
        ("brake", _REAL),  # N
        ("brake_start", _REAL),  # m, xi below which it brakes
        ("brake_end", _REAL),  # m, xi above which it brakes
        # how it moves
        ("phase", _CODE),
        ("at", _CODE),  # the link it is inside of, parked on or above, or the node whose place it has
        ("passed", _CODE),  # located: 1 if the node's particle is behind it by now
        ("r", *_VECTOR),  # m
        ("v", *_VECTOR),  # m/s
        ("ahead", *_VECTOR),  # m/s, extrapolated to the instant of the positions
        ("store", *_VECTOR),  # kg m/s, momentum of the particle it carries
        ("behind", *_VECTOR),  # N, force vector of the piece of line behind
        ("forth", *_VECTOR),  # N, of the piece ahead
        ("place", *_VECTOR),  # m, before a kick, of any wheel
        ("before", *_VECTOR),  # m/s, before a kick
        ("leading", *_VECTOR),  # m/s, extrapolated to the instant of the positions
        ("own", *_VECTOR),  # m/s, what a kick adds without the vehicle
        ("per_impulse", *_VECTOR),  # 1/kg, what an impulse adds; 0 on firm ground
        ("push", *_VECTOR),  # N s, impulse that a kick gets from the vehicle
        ("on_line", *_VECTOR),  # N, force on the line in the last kick, of wheels that are light or parked
        ("hold", _REAL),  # N, see divided.hold
        ("gone", _REAL),  # m, change of xi in the last drift, of a given travel
        ("drift_speed", _REAL),  # m/s, along x in the last drift, of wheels that are pushed along x
        ("driving", _REAL),  # N, of drive and driver in the last step
        ("in_air", _REAL),  # s, time off the line so far
        ("power", _REAL),  # W, of friction, in the last step
        ("parting", _REAL),  # J, lost by the line when the wheel left it
    ],
    align=True,
)
VEHICLE = np.dtype(
    [
        ("first", _CODE),  # its first coordinate
        ("coordinates", _CODE),  # how many
        ("wheels", _CODE),  # how many places of wheels
        ("damped", _CODE),  # 1: C is not zero
        ("lumped", _CODE),  # 1: M is diagonal
    ],
    align=True,
)
COORDINATE = np.dtype(
    [
        ("q", _REAL),  # m
        ("v", _REAL),  # m/s
        ("ahead", _REAL),  # m/s, extrapolated to the instant of the positions
        ("pushed", _REAL),  # N, forces of tethers and buffers
        ("drag", _REAL),  # kg/m, air drag of the particle that begins with this coordinate
    ],
    align=True,
)
TETHER = np.dtype(
    [
        ("wheel", _CODE),
        ("first", _CODE),  # first of the coordinates of the particle
        ("length", _REAL),  # m
        ("full", _REAL),  # m, length that it grows to
        ("growth", _REAL),  # m/s, while it does
        ("stiffness", _REAL),  # N/m
        ("damping", _REAL),  # N s/m
        ("way", _CODE),
        ("on", _CODE),  # 1: it holds
        ("watch", _CODE),  # of a leg: what is waited for
        ("across", *_VECTOR),  # unit vector in whose direction it does not act; zero: it acts in all
        ("reach", *_VECTOR),  # m, of a leg that swings: its foot, seen from the particle
        ("near", _CODE),  # link of the line below that foot
    ],
    align=True,
)
BUFFER = np.dtype(
    [
        ("wheel", _CODE),
        ("coordinate", _CODE),
        ("stiffness", _REAL),  # N/m
        ("side", _CODE),  # 1: the load is above
    ],
    align=True,
)
Records = NDArray[Any]


class Bodies(NamedTuple):
    """All that bodies are and do."""

    wheels: Records  # (wheel,) one for each load of `Loads`
    order: Integers  # (wheel,) heavy wheels on the lines, sorted along them
    ordered: Integers  # (1,) how many of these
    drive_time: Array  # s, tables of drives
    drive_value: Array  # N, forward
    vehicles: Records  # (vehicle,) coordinates and then places of wheels: u = (q, places)
    wheel: Integers  # (vehicle, place)
    axis: Integers  # (vehicle, place)
    M: Array  # (vehicle, size, size)
    C: Array
    K: Array
    load: Array  # (vehicle, size) N, weights
    coordinates: Records  # (coordinate,)
    tethers: Records  # between a wheel and a particle, straight and of any direction
    buffers: Records  # between a wheel and a coordinate: vertical, they only push
    A: Array  # (size, size + 2) room for a solution
    b: Array  # (size,)

    def copy(self) -> Bodies:
        """An independent copy."""
        return Bodies(*(array.copy() for array in self))  # type: ignore[arg-type]


def noted_of(bodies: Bodies) -> list[Records]:
    """What of bodies changes while nobody leads them, and frames are made of."""
    return [bodies.wheels, bodies.coordinates, bodies.tethers]


def are_weightless(bodies: Bodies) -> bool:
    """Whether there is nothing but contacts that press with given forces: then lines move as with forces alone."""
    return not (bodies.wheels["mass"].any() or bodies.coordinates.size)


def without_vehicles(wheels: int) -> Bodies:
    """Wheels that ride as forces do, to be filled in; nothing stands above them."""
    empty = records(wheels, WHEEL)
    empty["phase"], empty["brake_start"], empty["brake_end"] = MOVING_WITH, -np.inf, np.inf
    empty["drive_first"], empty["drive_count"] = np.arange(wheels), 1
    places, block = np.zeros((0, 1), dtype=np.int64), np.zeros((0, 1, 1))
    return Bodies(
        wheels=empty, order=np.zeros(wheels, dtype=np.int64), ordered=np.zeros(1, dtype=np.int64),
        drive_time=np.zeros(wheels), drive_value=np.zeros(wheels),
        vehicles=records(0, VEHICLE), wheel=places, axis=places.copy(), M=block, C=block.copy(), K=block.copy(),
        load=np.zeros((0, 1)), coordinates=records(0, COORDINATE), tethers=records(0, TETHER),
        buffers=records(0, BUFFER), A=np.zeros((1, 3)), b=np.zeros(1),
    )  # fmt: skip
