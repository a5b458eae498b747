"""Carriages: wheels on rockers, a cabin on its hanger, a hauling rope.

A rocker bears two others, or two wheels, at its ends and turns about its middle. So the middle of every rocker is the
mean of the wheels below it, whatever way it has turned: forces there are shared alike by these wheels, and masses of
rockers are quadratic forms of velocities of wheels. What is left is that rockers and hangers keep their lengths: bars,

    T = k (l - L) + c l',   l: length of the span between the means of two sets of particles.

A damper between a hanger and the main rocker acts with the moment c (w - w'), w: angular velocities of both. A hauling
rope pulls at all wheels alike, along the line: T = EA e + c e', e: strain of what is between carriage and drive. Where
it hangs freely it pulls as an elastic catenary does, with e = T/EA at the carriage. A counter rope, whose tension a
weight keeps at its station, pulls with T + w times the height of the carriage above that.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import inlined, lean, lean_inner, records
from ropewalk.mechanics.hanging_rope import hang, hang_by_tension
from ropewalk.system.contacts import ON, goes_on
from ropewalk.system.travel import travelled

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
HAUL = np.dtype(
    [
        ("first", _CODE),  # first contact of its carriage
        ("wheels", _CODE),
        ("other", _CODE),  # first contact of the carriage at its other end, -1: none
        ("others", _CODE),
        ("to", _CODE),  # 1: the drive is at the end of the line, -1: at its start
        ("stiffness", _REAL),  # N, EA
        ("damping", _REAL),  # N s
        ("beyond", _REAL),  # m, from the end of the line to the drive
        ("length", _REAL),  # m, unstrained, of what is between carriage and drive at time zero, or both carriages
        ("driven", _CODE),  # 1: a drive takes it in
        ("strain", _REAL),  # when it was last looked at
        ("rate", _REAL),  # 1/s, of the strain
        ("pull", _REAL),  # N
        ("hangs", _CODE),  # 1: freely between carriage and station, with its counter rope
        ("weight", _REAL),  # N/m
        ("level", _REAL),  # N, level part of its pull at the carriage; 0: not known
        ("up", _REAL),  # N, upward part
        ("counter", _REAL),  # N, tension of the counter rope at its station; 0: there is none
        ("counter_weight", _REAL),  # N/m
        ("way", *_VECTOR),  # level unit vector from the carriage to a station
        ("free", *_VECTOR),  # N, pull of all that hangs freely
    ],
    align=True,
)


class Carriages(NamedTuple):
    """All bars and hauling ropes."""

    bars: Any  # (bar,) records
    points: Integers  # first coordinates of particles
    hauls: Any  # (haul,) records

    @staticmethod
    def nothing() -> Carriages:
        """There are none."""
        return Carriages(records(0, BAR), np.zeros(0, dtype=np.int64), records(0, HAUL))

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


@lean_inner
def to_drive(lines, runs, length, contacts, first, count, to):
    """Mean length of the line between some contacts and its end (`to` is 1) or its start (-1), m."""
    line, gone, behind = contacts[first].line, 0.0, 0.0
    last = lines.first[line] + lines.runs[line] - 1
    for s in range(lines.first[line], last + 1):
        begin = runs.first[s]
        for k in range(first, first + count):
            if contacts[k].run == s:
                whole = int(contacts[k].x)
                own = gone
                for i in range(begin, begin + whole):
                    own += length[i]
                if whole < runs.links[s]:
                    own += (contacts[k].x - whole) * length[begin + whole]
                behind += own
        for i in range(begin, begin + runs.links[s]):
            gone += length[i]
        if s < last and not goes_on(lines, runs, s):
            gone += length[begin + runs.links[s]]
    behind /= count
    return gone - behind if to > 0 else behind


@lean
def to_drive_entry(lines, runs, length, contacts, first, count, to):
    """`to_drive` as Python calls it."""
    return to_drive(lines, runs, length, contacts, first, count, to)


@lean_inner
def _aim(hauls, e, lines, runs, r, u, contacts, first, count, to):
    """Note the level way from a carriage to an end of its line; returns how far and how much higher that is, m."""
    last, s = r.shape[0] - 1, lines.first[contacts[first].line]
    node = runs.first[s]
    if to > 0:
        s += lines.runs[contacts[first].line] - 1
        node = runs.first[s] + runs.links[s]
    square = 0.0
    for a in range(last):
        hauls[e].way[a] = r[a, node] - _middle(contacts, first, count, u, a)
        square += hauls[e].way[a] ** 2
    level = max(np.sqrt(square), 1e-9)
    for a in range(last):
        hauls[e].way[a] /= level
    return level, r[last, node] - _middle(contacts, first, count, u, last)


@lean_inner
def _middle(contacts, first, count, u, a):
    """Component a of the middle of a carriage, m."""
    total = 0.0
    for k in range(first, first + count):
        total += u[contacts[k].first + a]
    return total / count


@lean_inner
def _hang_freely(hauls, e, level, up, force, axes):
    """Add the pull of a rope that hangs freely, whose parts are given, of which `force` is a part."""
    for a in range(axes - 1):
        hauls[e].free[a] += force * level * hauls[e].way[a]
    hauls[e].free[axes - 1] += force * up


@lean_inner
def _pull(hauls, e, contacts, first, count, pull, axes):
    """Let contacts of a carriage be pulled by a force in N along their line, and what hangs freely, all alike."""
    for k in range(first, first + count):
        square = 0.0
        for a in range(axes):
            square += contacts[k].along[a] ** 2
        on = 1.0 if contacts[k].state == ON else 0.0
        for a in range(axes):
            new = pull * contacts[k].along[a] / np.sqrt(max(square, 1e-300)) + hauls[e].free[a]
            new *= on / count
            contacts[k].given[a] += new - contacts[k].hauled[a]
            contacts[k].hauled[a] = new


@lean_inner
def haul(carriages, structure, buffers, contacts, tables, state, since):
    """Let hauling ropes pull at their carriages.

    Args:
        since: s, since they were looked at before; 0: nothing has moved.
    """
    H = carriages.hauls
    lines, runs = structure.lines, structure.runs
    for e in range(H.size):
        first, count, to = H[e].first, H[e].wheels, H[e].to
        length = H[e].length
        if H[e].driven == 1:
            length -= travelled(tables, contacts, first, state.t[0])
        if H[e].hangs == 1:
            strain = _stretch_freely(H, e, lines, runs, state.r, state.u, contacts, length)
        else:
            far = to_drive(lines, runs, buffers.length, contacts, first, count, to) + H[e].beyond
            if H[e].driven == 0:
                far += to_drive(lines, runs, buffers.length, contacts, H[e].other, H[e].others, to) + H[e].beyond
            strain = far / length - 1.0
        if since > 0.0:
            H[e].rate = (strain - H[e].strain) / since
        H[e].strain = strain
        H[e].pull = 0.0
        if strain > 0.0:
            H[e].pull = max(H[e].stiffness * strain + H[e].damping * H[e].rate, 0.0)
        _pull_back(H, e, lines, runs, state.r, state.u, contacts, first, count)
        if H[e].driven == 0:
            _pull_back(H, e, lines, runs, state.r, state.u, contacts, H[e].other, H[e].others)


@lean_inner
def _stretch_freely(hauls, e, lines, runs, r, u, contacts, length):
    """Find the pull of a rope that hangs freely, `length` in m long; returns its strain at the carriage."""
    far, up = _aim(hauls, e, lines, runs, r, u, contacts, hauls[e].first, hauls[e].wheels, hauls[e].to)
    EA, w = hauls[e].stiffness, hauls[e].weight
    end = np.hypot(hauls[e].level, hauls[e].up + w * np.hypot(far, up))  # about the tension at the drive
    own = max(length - hauls[e].beyond / (1.0 + end / EA), 1e-3 * far)
    hauls[e].level, hauls[e].up = hang(far, up, own, w, EA, hauls[e].level, hauls[e].up)
    return np.hypot(hauls[e].level, hauls[e].up) / EA


@lean_inner
def _pull_back(hauls, e, lines, runs, r, u, contacts, first, count):
    """Let the hauling rope, whose pull is known, and the counter rope pull at one carriage."""
    axes, to, along = r.shape[0], hauls[e].to, 0.0
    for a in range(axes):
        hauls[e].free[a] = 0.0
    if hauls[e].hangs == 1:
        strain = max(hauls[e].strain, 1e-300)
        _hang_freely(hauls, e, hauls[e].level, hauls[e].up, hauls[e].pull / (hauls[e].stiffness * strain), axes)
    else:
        along = to * hauls[e].pull
    if hauls[e].counter > 0.0:
        far, up = _aim(hauls, e, lines, runs, r, u, contacts, first, count, -to)
        if hauls[e].hangs == 1:
            level, up = hang_by_tension(far, up, hauls[e].counter, hauls[e].counter_weight)
            _hang_freely(hauls, e, level, up, 1.0, axes)
        else:
            along -= to * max(hauls[e].counter - hauls[e].counter_weight * up, 0.0)
    _pull(hauls, e, contacts, first, count, along, axes)
