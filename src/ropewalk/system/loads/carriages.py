"""Carriages: wheels on rockers, a cabin on its hanger, and what hauls them.

A rocker bears two others, or two wheels, at its ends and turns about its middle. So the middle of every rocker is the
mean of the wheels below it, whatever way it has turned: forces there are shared alike by these wheels, and masses of
rockers are quadratic forms of velocities of wheels. What is left is that rockers and hangers keep their lengths: bars,

    T = k (l - L) + c l',   l: length of the span between the means of two sets of particles.

A damper between a hanger and the main rocker acts with the moment c (w - w'), w: angular velocities of both. Hauling
ropes are in `hauling_ropes.py`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import inlined, lean_inner, records
from ropewalk.system.loads.hauling_ropes import HAUL, PART

_REAL, _CODE, _VECTOR = "f8", "i8", ("f8", (3,))
BAR = np.dtype(
    [
        ("upper", _CODE),  # where in `points` the particles at its upper, or rear, end begin
        ("uppers", _CODE),  # how many they are
        ("lower", _CODE),
        ("lowers", _CODE),
        ("length", _REAL),  # m
        ("stiffness", _REAL),  # N/m
        ("damping", _REAL),  # N s/m
        ("frame", _CODE),  # bar that a damper of its rotation acts against, -1: none
        ("turning", _REAL),  # N m s
        ("span", *_VECTOR),  # unit vector from the upper to the lower end
        ("long", _REAL),  # m, how long it is now
        ("force", _REAL),  # N, positive if it pulls
        ("damper", _REAL),  # N, of the damper along it alone
        ("across", *_VECTOR),  # m/s, velocity of the lower end as seen from the upper one, across the span
        ("bend", *_VECTOR),  # N, of the damper of its rotation on its lower end
        ("back", *_VECTOR),  # N, of the same on the lower end of the frame
    ],
    align=True,
)


class Carriages(NamedTuple):
    """All bars and hauling ropes."""

    bars: Any  # (bar,) records
    points: Integers  # first coordinates of particles
    hauls: Any  # (haul,) records
    ropes: Any  # (part,) records of their masses and springs
    towers: Array  # (tower, 2) m, on the ways of hauling ropes: along the rope to the drive, and level

    @staticmethod
    def nothing() -> Carriages:
        """There are none."""
        none = np.zeros(0, dtype=np.int64)
        return Carriages(records(0, BAR), none, records(0, HAUL), records(0, PART), np.zeros((0, 2)))

    def ends(self, bar: Any) -> tuple[Integers, Integers]:
        """First coordinates of the particles at the upper and at the lower end of a bar."""
        upper, lower = int(bar["upper"]), int(bar["lower"])
        return self.points[upper : upper + int(bar["uppers"])], self.points[lower : lower + int(bar["lowers"])]

    def row(self, bar: Any, count: int, dim: int) -> Array:
        """Matrix (axis, coordinate) from coordinates to the span of a bar."""
        out = np.zeros((dim, count))
        for points, sign in zip(self.ends(bar), (-1.0, 1.0), strict=True):
            for first in points.tolist():
                out[np.arange(dim), first + np.arange(dim)] += sign / points.size
        return out

    def spans(self, u: Array, dim: int) -> Iterator[tuple[Any, Array, Array]]:
        """Bars, their matrices and their spans at coordinates (coordinate,) in m."""
        for bar in self.bars:
            row = self.row(bar, u.size, dim)
            yield bar, row, row @ u

    def energy(self, u: Array, dim: int) -> float:
        """Energy stored in all bars, J."""
        stored = (bar["stiffness"] * (np.linalg.norm(way) - bar["length"]) ** 2 for bar, _, way in self.spans(u, dim))
        return 0.5 * float(sum(stored))

    def forces(self, u: Array, dim: int) -> Array:
        """Forces of bars without dampers, (coordinate,) N."""
        out = np.zeros(u.size)
        for bar, row, way in self.spans(u, dim):
            long = float(np.linalg.norm(way))
            out -= bar["stiffness"] * (long - bar["length"]) / long * (row.T @ way)
        return out

    def stiffness(self, u: Array, dim: int) -> Array:
        """Second derivatives of the energy, (coordinate, coordinate) N/m."""
        out = np.zeros((u.size, u.size))
        for bar, row, way in self.spans(u, dim):
            long = float(np.linalg.norm(way))
            along, turn = np.outer(way, way) / long**2, bar["stiffness"] * (1.0 - bar["length"] / long)
            out += row.T @ (bar["stiffness"] * along + turn * (np.eye(dim) - along)) @ row
        return out

    def damping(self, u: Array, dim: int) -> Array:
        """Forces of dampers over velocities, (coordinate, coordinate) N s/m."""
        out, spans = np.zeros((u.size, u.size)), list(self.spans(u, dim))
        for bar, row, way in spans:
            n = way / np.linalg.norm(way)
            out += bar["damping"] * np.outer(row.T @ n, row.T @ n)
            if bar["frame"] >= 0:
                frame, other = spans[int(bar["frame"])][1:]
                turns = _turning(way) @ row - _turning(other) @ frame
                out += bar["turning"] * turns.T @ turns
        return out

    def bounds(self, inverse: Array, dim: int) -> tuple[float, float]:
        """Bounds of the square of a frequency, 1/s^2, and of a rate, 1/s, by the inverse of the mass matrix."""
        square = rate = 0.0
        for bar in self.bars:
            row = self.row(bar, inverse.shape[0], dim)[0]
            light = float(row @ inverse @ row)
            square += float(bar["stiffness"]) * light
            rate += float(bar["damping"]) * light
            if bar["frame"] >= 0:
                frame = self.bars[int(bar["frame"])]
                other = self.row(frame, inverse.shape[0], dim)[0]
                square_of = light / float(bar["length"]) ** 2 + float(other @ inverse @ other) / frame["length"] ** 2
                rate += 2.0 * float(bar["turning"]) * float(square_of)
        return square, rate


def _turning(way: Array) -> Array:
    """Matrix from the rate of a span to its angular velocity."""
    square = float(way @ way)
    if way.size == 2:
        return np.array([[way[1], -way[0]]]) / square
    x, y, z = way
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]) / square


@inlined
def roll(carriages):
    """Whether there are any: asked where a call would hand all arrays on."""
    return carriages.bars.size > 0


@lean_inner
def mean(carriages, first, count, u, a):
    """Component a of the mean of some particles."""
    total = 0.0
    for i in range(first, first + count):
        total += u[carriages.points[i] + a]
    return total / count


@lean_inner
def add_bar_forces(carriages, u, w, f, axes):
    """Add the forces of all bars to those on coordinates."""
    B = carriages.bars
    for e in range(B.size):
        square, along = 0.0, 0.0
        for a in range(axes):
            upper = mean(carriages, B[e].upper, B[e].uppers, u, a)
            B[e].span[a] = mean(carriages, B[e].lower, B[e].lowers, u, a) - upper
            square += B[e].span[a] ** 2
        B[e].long = np.sqrt(square)
        for a in range(axes):
            upper = mean(carriages, B[e].upper, B[e].uppers, w, a)
            B[e].span[a] /= B[e].long
            B[e].across[a] = mean(carriages, B[e].lower, B[e].lowers, w, a) - upper
            along += B[e].span[a] * B[e].across[a]
        for a in range(axes):
            B[e].across[a] -= along * B[e].span[a]
            B[e].bend[a] = B[e].back[a] = 0.0
        B[e].damper = B[e].damping * along
        B[e].force = B[e].stiffness * (B[e].long - B[e].length) + B[e].damper
    for e in range(B.size):
        g = B[e].frame
        if g >= 0:
            alike, own, other = 0.0, 0.0, 0.0
            for a in range(axes):
                alike += B[e].span[a] * B[g].span[a]
                own += B[e].across[a] * B[g].span[a]
                other += B[g].across[a] * B[e].span[a]
            for a in range(axes):
                turned = (B[g].across[a] * alike - B[g].span[a] * other) / B[g].long
                B[e].bend[a] = -B[e].turning / B[e].long * (B[e].across[a] / B[e].long - turned)
                turned = (B[e].across[a] * alike - B[e].span[a] * own) / B[e].long
                B[e].back[a] = B[e].turning / B[g].long * (turned - B[g].across[a] / B[g].long)
    for e in range(B.size):
        for a in range(axes):
            _share(carriages, e, a, B[e].bend[a] - B[e].force * B[e].span[a], f)
            if B[e].frame >= 0:
                _share(carriages, B[e].frame, a, B[e].back[a], f)


@lean_inner
def _share(carriages, e, a, force, f):
    """Let a force act on the lower end of bar e, and its opposite on the upper one."""
    B = carriages.bars
    for i in range(B[e].lowers):
        f[carriages.points[B[e].lower + i] + a] += force / B[e].lowers
    for i in range(B[e].uppers):
        f[carriages.points[B[e].upper + i] + a] -= force / B[e].uppers


@lean_inner
def taken_by_bars(carriages, w, old, axes):
    """Power that dampers of bars take at the mean of the velocities before and behind a kick, W."""
    B, power = carriages.bars, 0.0
    for e in range(B.size):
        for a in range(axes):
            rate = 0.5 * (_apart(carriages, e, w, a) + _apart(carriages, e, old, a))
            power += (B[e].damper * B[e].span[a] - B[e].bend[a]) * rate
            if B[e].frame >= 0:
                g = B[e].frame
                rate = 0.5 * (_apart(carriages, g, w, a) + _apart(carriages, g, old, a))
                power -= B[e].back[a] * rate
    return power


@lean_inner
def _apart(carriages, e, w, a):
    B = carriages.bars
    upper = mean(carriages, B[e].upper, B[e].uppers, w, a)
    return mean(carriages, B[e].lower, B[e].lowers, w, a) - upper
