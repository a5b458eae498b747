"""A load led slowly along a rope, clamped or frictionless: computed on the chain, from the middle to where it ends."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import takewhile
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import EquilibriumError
from ropewalk.model import Hooke, Inextensible, Line, MovingForce, Quasistatic, Scenario, Travel
from ropewalk.model.load import Contact
from ropewalk.model.support import Fixed, Support
from ropewalk.solve.quasistatic import LoadPosition, walk
from ropewalk.solve.start import setting_of

FloatArray = NDArray[np.float64]
FIXED = Fixed()

GRAVITY = 9.81
POSITIONS = 121  # of each half
TURN = 0.03  # rad, largest turn of a path between two places
MOST = 20.0  # hold force over load: the way ends where it grows beyond all bounds
LINKS, HEAVY_LINKS = 10, 160  # a chain without weight is exact, whatever its links


@dataclass(frozen=True)
class Rope:
    """A rope between two level supports and the load W that walks on it; N and m."""

    span: float = 20.0
    length: float = 20.0
    weight: float = 0.0  # N per unstrained metre
    axial_stiffness: float = inf
    load: float = 700.0
    support: Support = FIXED

    def line(self) -> Line:
        """The rope as a line of links, of which those without weight need a mass all the same."""
        stiff = isfinite(self.axial_stiffness)
        return Line(
            start=(0.0, 0.0), end=(self.span, 0.0), length=self.length,
            mass=self.weight / GRAVITY if self.weight else 1.0,
            law=Hooke() if stiff else Inextensible(), axial_stiffness=self.axial_stiffness if stiff else None,
            start_support=self.support, end_support=self.support, elements=HEAVY_LINKS if self.weight else LINKS,
        )  # fmt: skip

    def scenario(self, contact: Contact, speed: float) -> Scenario:
        """The load that sets out from the middle."""
        travel = Travel.model_validate({"speed": speed, "from": 0.5 * self.length})
        return Scenario(
            gravity=GRAVITY if self.weight else 0.0,
            lines={"rope": self.line()},
            loads={"load": MovingForce(on="rope", force=(0.0, -self.load), contact=contact, travel=travel)},
            run=Quasistatic(positions=POSITIONS, turn=TURN),
        )

    def label(self) -> str:
        """All parameters, for the figure."""
        stretch = f"EA = {self.axial_stiffness / 1e3:g} kN" if isfinite(self.axial_stiffness) else "inextensible"
        weight = f"weight {self.weight:g} N/m" if self.weight else "no weight"
        return f"X = {self.span:g} m, L = {self.length:g} m, {weight}, {stretch}, W = {self.load:g} N"


@dataclass(frozen=True)
class LoadPath:
    """The places of a load from left to right and what is found there, arrays (place,); no forces on a support."""

    xi: FloatArray  # m
    x: FloatArray  # m
    z: FloatArray
    behind: FloatArray  # N, tension
    ahead: FloatArray
    hold: FloatArray  # N, along x
    friction: FloatArray  # coefficient of a capstan that the tensions need
    middle_pull: float  # N, horizontal tension with the load in the middle
    shapes: list[FloatArray]  # (2, point) m, of the rope at each place

    def path_slope(self) -> tuple[FloatArray, FloatArray]:
        """Places x in m between two neighbours, and the slope dz/dx from one to the other, infinite if upright."""
        dx, dz = np.diff(self.x), np.diff(self.z)
        upright = np.abs(dx) < 1e-9 * np.abs(self.x).max()
        slope = np.where(upright, np.copysign(inf, dz), dz / np.where(upright, 1.0, dx))
        return 0.5 * (self.x[1:] + self.x[:-1]), slope

    def nearest(self, count: int) -> list[int]:
        """Places about equally spaced along the rope."""
        wanted = np.linspace(self.xi[0], self.xi[-1], count)
        return sorted({int(np.abs(self.xi - xi).argmin()) for xi in wanted})


def way(rope: Rope, contact: Contact, half: bool = False) -> LoadPath:
    """Lead the load from the middle to both sides, until it reaches the support or nothing can hold it any more.

    With `half`, to the right alone.
    A rope without weight that is longer than its span is slack once the load stands on a support: there the way ends a
    thousandth of the length before.
    """
    left, right = [] if half else _half(rope, contact, -1.0), _half(rope, contact, 1.0)
    places = [*reversed(left[1:]), *right]
    stands = [place.stands[0] for place in places]
    xi = np.array([place.xi[0] for place in places])
    x, z = np.array([s.r[:, s.contact[0]] for s in stands]).T
    forces = np.array([[*s.beside[0], s.hold[0], s.friction[0]] for s in stands])
    forces[(xi <= 1e-9 * rope.length) | (xi >= (1.0 - 1e-9) * rope.length)] = np.nan
    behind, ahead, hold, friction = forces.T
    middle_pull = float(right[0].stands[0].pull[0, 0])
    return LoadPath(xi, x, z, behind, ahead, hold, friction, middle_pull, shapes=[s.r for s in stands])


def linear_string(rope: Rope, pull: float, x: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Height of the load in m and slope of its path by the linear theory of a string under the constant ``pull`` in N.

    ``z = -x (X - x)/(P X) (W + q X/2)``, the load on the sag of the string's own weight q = weight L/X.
    """
    steepness = (rope.load + 0.5 * rope.weight * rope.length) / (pull * rope.span)
    return -steepness * x * (rope.span - x), steepness * (2.0 * x - rope.span)


def _half(rope: Rope, contact: Contact, speed: float) -> list[LoadPosition]:
    setting = setting_of(rope.scenario(contact, speed), rope.length)
    end = (1.0 if rope.weight or rope.length <= rope.span else 0.999) * rope.length
    places: list[LoadPosition] = []

    def goes_on(place: LoadPosition) -> bool:
        restrained = abs(place.stands[0].hold[0]) <= MOST * rope.load
        return bool(restrained and rope.length - end <= place.xi[0] <= end)

    try:
        places.extend(takewhile(goes_on, walk(setting, POSITIONS, TURN)))
    except EquilibriumError:
        if not places:
            raise
    return places
