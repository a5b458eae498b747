"""Where the wires of an overhead line run in plan view: strings between supports and clamps, aside of the track.

Stations follow the track. On a curve the chords between its supports are laid out straight: at each support they turn
by an angle, and a wire that goes straight on under a tension T is pulled to the inside by T times that angle there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ropewalk.model.overhead import OverheadLine, stations_of
from ropewalk.wires.plan import Array

CONTACT, MESSENGER, STITCH = 0, 1, 2
"""Numbers of the wires of a line; stitch wires follow from support to support."""
_Polygon = tuple[Array, Array]


@dataclass(frozen=True)
class PlanView:
    """Contact wire, messenger and stitch wires in plan view, y in m to the left of the middle of the track."""

    supports: Array  # (span + 1,) m, stations with both ends
    stagger: Array  # (span + 1,) m, how far aside the contact wire is there
    turns: Array  # (span - 1,) rad, by which chords turn to the left at the supports between spans
    tension: float = 1.0  # N, of the messenger
    stitch_tension: float = 0.0  # N
    reach: float = 0.0  # m, of a stitch wire to each side of its support; 0: there is none
    last_piece: float = 0.0  # m, of a stitch wire that is a link at each clamp
    straight: bool = False  # whether the messenger runs straight
    side: float = 0.0  # m, y of the line

    @property
    def is_straight(self) -> bool:
        """Whether nothing goes aside."""
        return not (self.stagger.any() or self.turns.any())

    def station(self, wire: int, own: Array) -> Array:
        """Stations of the line where a wire is at stations of its own, m."""
        if wire < STITCH:
            return own
        return np.asarray(self.supports[1 + wire - STITCH] - self.reach + self.last_piece + own)

    def aside(self, wire: int, station: Array) -> Array:
        """Where a wire runs at stations of the line, y in m; a stitch wire as if the chords did not turn between."""
        if wire == CONTACT:
            points: _Polygon = self.supports, self.stagger
        elif wire == MESSENGER:
            points = self._messenger
        else:
            clamps = self.supports[1 + wire - STITCH] + self.reach * np.array([-1.0, 1.0])
            points = clamps, np.interp(clamps, *self._messenger)
        return np.asarray(self.side + np.interp(station, *points))

    def inside(self, wire: int, station: Array) -> Array:
        """How far a stitch wire is to the left of that, m: it goes straight from clamp to clamp where chords turn."""
        if wire < STITCH:
            return np.zeros_like(station)
        i = wire - STITCH
        return np.asarray(0.5 * self.turns[i] * (self.reach - np.abs(station - self.supports[1 + i])))

    @cached_property
    def _messenger(self) -> _Polygon:
        """Supports and clamps of the messenger, and how far aside it is there: strings, which stitch wires pull at."""
        stagger = np.zeros_like(self.stagger) if self.straight else self.stagger
        if not self.reach:
            return self.supports, stagger
        inner = self.supports[1:-1]
        points = np.sort(np.concatenate([self.supports, inner - self.reach, inner + self.reach]))
        links, pull = [(i, i + 1, self.tension) for i in range(points.size - 1)], np.zeros(points.size)
        for middle, turn in zip(inner, self.turns, strict=True):
            i, j = np.searchsorted(points, [middle - self.reach, middle + self.reach])
            links += [(i, j, self.stitch_tension), *((k, k + 1, -self.stitch_tension) for k in range(i, j))]
            pull[[i, j]] += 0.5 * self.stitch_tension * turn
        K = np.zeros((points.size, points.size))
        for i, j, T in links:
            K[np.ix_([i, j], [i, j])] += T / (points[j] - points[i]) * np.array([[1.0, -1.0], [-1.0, 1.0]])
        y, fixed = np.zeros(points.size), np.searchsorted(points, self.supports)
        y[fixed] = stagger
        free = np.setdiff1d(np.arange(points.size), fixed)
        y[free] = np.linalg.solve(K[np.ix_(free, free)], pull[free] - K[free] @ y)
        return points, y


def plan_view_of(line: OverheadLine) -> PlanView:
    """Where the wires of a line run, as it was fitted."""
    supports, stitch = np.array(stations_of(line)), line.stitch_wire
    half = 0.5 * np.array(line.curvatures) * np.array(line.span_lengths)
    return PlanView(
        supports,
        np.zeros(supports.size) if line.staggers is None else np.array(line.staggers),
        half[:-1] + half[1:],
        line.messenger_wire.tension,
        0.0 if stitch is None else stitch.tension,
        0.0 if stitch is None else 0.5 * stitch.length,
        line.element,
        line.messenger_supports.stagger == "straight",
        line.start[1] if len(line.start) == 3 else 0.0,
    )
