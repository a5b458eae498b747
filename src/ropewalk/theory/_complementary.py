"""Complementary energy of a rope at rest: its minimum is the equilibrium, and where the search for it begins.

It is a convex function of one force, that at the beginning of one piece of the rope; the other pieces begin with
this force plus an ``offset``. Its gradient is the gap, by which the rope under this force misses its end.
"""

from dataclasses import dataclass

import numpy as np

from ropewalk.theory import _segments
from ropewalk.theory._segments import AxialLaw, FloatArray

__all__ = ["ComplementaryEnergy", "of_rope"]


@dataclass(frozen=True)
class ComplementaryEnergy:
    """Complementary energy of a rope in J; forces are those at the beginning of its piece without offset, in N."""

    offset: FloatArray  # by which the force at the beginning of every piece differs from that, shape (pieces, 2), N
    segments: FloatArray  # their lengths, m; zero between loads at one place
    weight: float  # N per unstrained metre
    compliance: float  # 1/EA, 1/N
    law: AxialLaw
    ends: FloatArray  # the end's position from the start's, (2,), m

    def gradient(self, force: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the gap (2,) in m, and its derivative (2, 2) in m/N."""
        of_segments = force + self.offset, self.segments, self.weight, self.compliance, self.law
        return _segments.reach(*of_segments).sum(axis=0) - self.ends, _segments.reach_derivative(*of_segments).sum(
            axis=0
        )

    def start(self) -> FloatArray:
        """Return where the search begins: lower than any kink.

        Where a piece without weight becomes slack the energy has a kink, like the tip of a cone, near which Newton's
        method is lost: for inextensible pieces this is Fermat's problem of the least sum of distances. A search that
        begins lower than every kink and descends never meets one: from the lowest kink, that of the piece without
        offset, down the steepest slope (Kuhn, A note on Fermat's problem, 1973), as far as that falls. Far from
        slackness the force of a taut rope is lower, and next to the minimum.
        """
        taut = self._taut()
        others = np.any(self.offset, axis=1)
        kink = -self.middle[~others][np.argmax(self.segments[~others])]
        stretched = kink + self.middle[others], self.segments[others], 0.0, self.compliance, self.law
        fall = self.ends - _segments.reach(*stretched).sum(axis=0)
        if not np.any(fall):
            return taut
        fall /= np.hypot(*fall)
        far, near = float(np.max(np.abs(taut))), self.weight * float(self.segments[~others].sum())
        while far > max(near, 1e-300) and float(self.gradient(kink + far * fall)[0] @ fall) > 0.0:
            far *= 0.5
        return min(taut, kink + far * fall, key=self.rough)

    def rough(self, force: FloatArray) -> float:
        """Return the energy, with the tension in the middle of every piece for that of all of it: J."""
        stretched = np.hypot(*(force + self.middle).T), self.compliance, self.law
        return float(self.segments @ _segments.complementary(*stretched) - force @ self.ends)

    @property
    def middle(self) -> FloatArray:
        """Offset of the force in the middle of every piece, shape (pieces, 2), N."""
        return np.asarray(self.offset + np.outer(0.5 * self.weight * self.segments, [0.0, 1.0]))

    def _taut(self) -> FloatArray:
        """Force of a taut rope: chord plus elongation is length plus the transverse load's slack."""
        from scipy.optimize import brentq

        total, distance = self.segments.sum(), float(np.hypot(*self.ends))
        chord = self.ends / distance
        first = self.offset
        last = 2.0 * self.middle - first
        mean = (self.segments @ (first + last)) / (2.0 * total)
        p, q = ((side - mean) @ np.array([-chord[1], chord[0]]) for side in (first, last))
        slack = 0.5 * float((self.segments * (p * p + p * q + q * q)).sum()) / (3.0 * total)
        excess = 1.0 - distance / total
        if self.compliance == 0.0:
            tension = float(np.sqrt(slack / max(excess, 1e-300)))
            return np.asarray(max(tension, 1e-9 * float(np.max(np.abs(first - mean)))) * chord - mean)
        bound = float(np.cbrt(slack / self.compliance)) + max(-excess, 0.0) / self.compliance

        def balance(tension: float) -> float:
            return float((self.compliance * tension + excess) * tension**2 - slack)

        tension = brentq(balance, 0.0, 1.001 * bound, xtol=1e-6 * bound, rtol=1e-6) if bound > 0.0 else 0.0
        return np.asarray(max(float(tension), 1e-9 * bound) * chord - mean)


def of_rope(
    offset: FloatArray, segments: FloatArray, weight: float, compliance: float, law: AxialLaw, ends: FloatArray
) -> ComplementaryEnergy:
    """Return the energy with the force of the piece that is nearest to slack as its unknown.

    ``offset`` is measured from any force. If the unknown were the force of another piece, its roundings could be more
    than all that the piece near slackness carries, which would point anywhere.
    """
    from_any = ComplementaryEnergy(offset, segments, weight, compliance, law, ends)
    origin = min(np.flatnonzero(segments > 0.0), key=lambda i: from_any.rough(-from_any.middle[i]))
    return ComplementaryEnergy(offset - offset[origin], segments, weight, compliance, law, ends)
