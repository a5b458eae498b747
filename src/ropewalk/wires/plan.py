"""A plan of wires: what there is, before any mesh. Both formulations (splines, Hermite elements) start from it.

A wire is a line with bending stiffness under tension, as in an overhead line. It lies along x between its ends; a
**station** is the distance from its start along the chord at rest. Heights are positive upwards.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Three = tuple[float, float, float]
EndKind = Literal["pinned", "clamped", "free"]


@dataclass(frozen=True)
class Wire:
    """A wire at rest.

    `held`: the end stands still and may turn; `clamped`: it cannot turn either; `free`: nothing but holds holds it.
    """

    name: str
    start: tuple[float, float, float]  # m
    end: tuple[float, float, float]  # m
    tension: float  # N, along the chord at rest, but for what reliefs take over
    mass: float  # kg/m
    bending_stiffness: float = 0.0  # EI, N m^2
    axial_stiffness: float = 1e9  # EA, N; unknown to small motion
    drag: float = 0.0  # 1/s, alpha of Rayleigh damping
    retardation: float = 0.0  # s, beta of Rayleigh damping
    bed: float = 0.0  # N/m^2, of an elastic bed below
    ends: tuple[EndKind, EndKind] = ("pinned", "pinned")
    unstrained: float | None = None  # m; None: what follows from the tension
    stretched: bool = True  # whether stations count metres of the stretched wire where only its tension is given

    @property
    def chord(self) -> float:
        """Distance of the ends, m."""
        return float(np.linalg.norm(np.subtract(self.end, self.start)))

    @property
    def length(self) -> float:
        """What stations count up to: the unstrained length if that is given, or else the chord, m."""
        return self.chord if self.unstrained is None else self.unstrained


@dataclass(frozen=True)
class Spot:
    """A point of a wire."""

    wire: int
    station: float  # m


@dataclass(frozen=True)
class PointMass:
    """What is clamped to a wire and moves with it."""

    spot: Spot
    mass: float  # kg


@dataclass(frozen=True)
class WireDisplacement:
    """A displacement over time: linear between its instants, constant outside."""

    time: Array  # (instant,) s
    value: Array  # (3, instant) m


@dataclass(frozen=True)
class Hold:
    """Springs and dampers between a point of a wire and the ground, along three axes; infinitely stiff ones hold fast.

    One at the end of a wire that is `free` is the support there; if it has the name `WIRE.start` or `WIRE.end`, results
    show it as that.
    """

    name: str
    spot: Spot
    stiffness: Three  # N/m
    damping: Three = (0.0, 0.0, 0.0)  # N s/m
    place: Three = (0.0, 0.0, 0.0)  # m, where the springs are without force
    force: Three = (0.0, 0.0, 0.0)  # N on the wire along x, y and z, constant
    axes: tuple[Three, Three, Three] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))  # orthogonal unit vectors
    moved: WireDisplacement | None = None  # of its place


@dataclass(frozen=True)
class WireTie:
    """A straight link between two wires (a dropper), or between a wire and a place on the ground (a steady arm)."""

    name: str
    spot: Spot
    other: Spot | tuple[float, float, float]
    stiffness: float  # N/m, when longer than `length`
    length: float  # m, unstrained
    pushes: float = 0.0  # N/m, stiffness when shorter
    damping: float = 0.0  # N s/m, while it pulls
    mass: float = 0.0  # kg, half of which goes to each end
    strength: float = np.inf  # N, pull that tears it
    fails_at: float = np.inf  # s
    aside: float = 0.0  # m, how much farther to the left the other wire is than its coordinates say
    lengthwise: bool = False  # whether it is the last piece of a wire, which pulls another one along the line


@dataclass(frozen=True)
class SideForce:
    """A constant force sideways."""

    spot: Spot
    force: float  # N, along y


@dataclass(frozen=True)
class Relief:
    """A piece of a wire beside which another one, clamped to it at both ends, takes over a part of its tension."""

    start: Spot
    end: Spot
    tension: float  # N, by which that of the wire is less there at rest


def nothing(stations: Array) -> Array:
    """Zero at all stations."""
    return np.zeros_like(stations)


@dataclass(frozen=True)
class Contact:
    """Where a moving load touches a wire. Infinite stiffness keeps them together, or apart, rigidly.

    A wire that runs aside of the middle of the moving load has another lever there: the row is `row + aside turn`.
    """

    wire: int
    row: tuple[float, ...] = ()  # its height is row @ q; nothing: a force that is given
    behind: float = 0.0  # m, behind the place of the moving load
    material: bool = False  # whether its station counts along the wire itself, and not along x
    stiffness: float = np.inf  # N/m; 0: nothing but what is given
    damping: float = 0.0  # N s/m
    base: float = 0.0  # m, height of the contact where row @ q is zero
    rest: float = 0.0  # N upwards on the wire where nothing is moved: coordinates may count from an equilibrium
    below: bool = False  # whether the moving load touches the wire from below
    lifts_off: bool = False
    rough: Callable[[Array], Array] = nothing  # stations to heights that are added to the wire, m
    turn: tuple[float, ...] = ()  # what is added to the row for each metre aside; of soft contacts
    aside: Callable[[Array], Array] = nothing  # stations to how far the wire is to the left of the middle, m
    widest: float = 0.0  # m, the largest distance aside, on either side


@dataclass(frozen=True)
class TravellingLoad:
    """What travels: M q'' + C q' + K q = forces, with heights q, and its contacts; without coordinates, a force."""

    name: str
    mass: Array  # (coordinate, coordinate) kg
    damping: Array  # N s/m
    stiffness: Array  # N/m
    contacts: tuple[Contact, ...]

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.mass.shape[0])


@dataclass(frozen=True)
class WirePlan:
    """All wires and what is attached to them."""

    wires: tuple[Wire, ...]
    ties: tuple[WireTie, ...] = ()
    holds: tuple[Hold, ...] = ()
    masses: tuple[PointMass, ...] = ()
    reliefs: tuple[Relief, ...] = ()
    sideways: tuple[SideForce, ...] = ()
    gravity: float = 9.81  # m/s^2, downwards
    watched: dict[str, Spot] = field(default_factory=dict)  # points whose height is recorded closely, by name
