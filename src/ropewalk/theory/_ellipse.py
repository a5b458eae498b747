"""The ellipse on which a bead slides: the supports are its foci, the rope is its thread.

A weightless inextensible rope of length L over supports a distance 2 c apart holds the bead on the ellipse with the
semi-axes ``a = L/2`` and ``b = sqrt(a^2 - c^2)``, inclined by the angle of the line through the supports. With the
eccentric angle phi, counted from the lowest point between level supports towards the end,

    (x, z) = middle + R(incline) (a sin phi, -b cos phi),     h = |d(x, z)/dphi| = sqrt(b^2 + c^2 cos^2 phi),
    distances to the foci a + c sin phi, a - c sin phi,       curvature a b/h^3,

and the rope turns at the bead by theta, ``sin(theta/2) = b/h``, ``cos(theta/2) = c |cos phi|/h``: the normal of the
ellipse halves the angle between the two straight pieces.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ropewalk.theory import _arguments

__all__ = ["Ellipse", "of_rope"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Ellipse:
    """Semi-axes and half the distance of the foci in m, the inclination in rad, the middle (x, z) in m."""

    a: float
    b: float
    c: float
    incline: float
    middle: tuple[float, float]

    def place(self, phi: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return x and z in m."""
        along, across = self.a * np.sin(phi), -self.b * np.cos(phi)
        return self._turned(along, across, *self.middle)

    def slope(self, phi: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return dx/dphi and dz/dphi in m."""
        return self._turned(self.a * np.cos(phi), self.b * np.sin(phi))

    def sliding_speed(self, phi: FloatArray) -> FloatArray:
        """Return h, the arc length per angle, in m."""
        return np.asarray(np.hypot(self.b, self.c * np.cos(phi)))

    def half_turn(self, phi: FloatArray) -> FloatArray:
        """Return half the angle by which the rope turns at the bead, in rad."""
        return np.asarray(np.arctan2(self.b, self.c * np.abs(np.cos(phi))))

    @property
    def lowest(self) -> float:
        """The angle phi of the lowest point; z grows as ``depth (1 - cos(phi - lowest))`` from there."""
        return float(np.arctan2(-self.a * np.sin(self.incline), self.b * np.cos(self.incline)))

    @property
    def depth(self) -> float:
        """How far the lowest point lies below the middle, in m."""
        return float(np.hypot(self.a * np.sin(self.incline), self.b * np.cos(self.incline)))

    def hanging(self, x: float) -> float:
        """Return the angle phi of the place ``x`` on the lower half. `ValueError` outside the ellipse."""
        reach = float(np.hypot(self.a * np.cos(self.incline), self.b * np.sin(self.incline)))
        off = (x - self.middle[0]) / reach
        if not abs(off) < 1.0:
            low, high = self.middle[0] - reach, self.middle[0] + reach
            raise ValueError(f"start must lie inside the ellipse, between {low:g} and {high:g} m, not {x}")
        lag = float(np.arctan2(self.b * np.sin(self.incline), self.a * np.cos(self.incline)))
        return float(np.arcsin(off)) - lag

    def _turned(
        self, along: FloatArray, across: FloatArray, x: float = 0.0, z: float = 0.0
    ) -> tuple[FloatArray, FloatArray]:
        cos, sin = np.cos(self.incline), np.sin(self.incline)
        return np.asarray(x + cos * along - sin * across), np.asarray(z + sin * along + cos * across)


def of_rope(span: float, height: float, length: float) -> Ellipse:
    """Return the ellipse of a rope from (0, 0) to (span, height). `ValueError` unless it is longer than that."""
    _arguments.positive(span=span, length=length)
    _arguments.finite(height=height)
    distance = float(np.hypot(span, height))
    if not length > distance:
        raise ValueError(f"length must exceed the distance {distance:g} m of the supports, not {length}")
    b = 0.5 * float(np.sqrt((length - distance) * (length + distance)))
    return Ellipse(0.5 * length, b, 0.5 * distance, float(np.arctan2(height, span)), (0.5 * span, 0.5 * height))
