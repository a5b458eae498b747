"""A window on large motion of wires: what is far from the contacts stands still, but for waves along the wires.

Waves across the wires are taken up next to the borders (`absorbing_layer.py`). Those along them are thirty times as
fast, and a wire that could not give way along it at a border would be stretched: beyond the border it carries them on.
There its displacement u along itself is that of a wave that goes away, c u' + u. + c u / L = 0, with L up to where it
is held along x. A few nodes beyond a border follow that (the absorbing condition of first order, as a box scheme): each
is where its link has the tension of the wave, whatever shape it was left in. All others are led along with them, and
with them wires that are clamped to theirs lengthwise, as stitch wires are: they move as a whole, or not by themselves.
What goes away with waves, and the kinetic energy of what the window leaves, is lost and counted so.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.compiled import inlined
from ropewalk.wires.absorbing_layer import layers
from ropewalk.wires.mesh import Mesh, Places
from ropewalk.wires.moving_loads import DAMPED
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.restraints import Holders
from ropewalk.wires.small_arrays import x_of
from ropewalk.wires.spline import WIDTH
from ropewalk.wires.springs import LinkSprings

_CLEAR = 2.0  # widths of a spline that borders stay away from holds and ends of wires, at least
BEYOND = WIDTH + 2  # nodes beyond a border that follow waves along the wire: those that ties share with nodes within


class LargeWindow(NamedTuple):
    """What of the wires moves."""

    low: Integers  # (wire,) first node that does, counted in the wire
    high: Integers  # (wire,) one beyond the last
    layer: Integers  # (wire,) nodes of each of the layers that take up waves across, and
    rate: Array  # (wire, side, node) 1/s, at which they do so
    slow: Integers  # ties that push once in a step
    fast: Integers  # ties along the wires
    rigid: tuple[int, int]  # holders that hold fast: the first, and one beyond the last
    elastic: tuple[int, int]  # the others
    watched: Integers  # points whose height is recorded
    border: Integers  # (border, 2) last node that moves, and the direction in which its wire goes on beyond it
    follow: Array  # (border, 3) how the next node follows: its own displacement, the last one's after and before
    impedance: Array  # (border,) N s/m, along the wire
    wave: Array  # (border, BEYOND) m, displacement along the wire of nodes beyond
    length: Array  # (node,) m, at rest, of the link behind


@inlined
def follow_waves(window, still, now, other, dt, work):
    """Let nodes beyond the borders follow, along x, in a step of dt in s that all within has done already."""
    for k in range(window.border.shape[0]):
        e, d = window.border[k, 0], window.border[k, 1]
        before, after = now[0, e] - still[0, e], other[0, e] - still[0, e]
        work[DAMPED] += window.impedance[k] * (after - before) * (after - before) / dt
        for j in range(BEYOND):
            i, own = e + d, window.wave[k, j]
            new = window.follow[k, 0] * own + window.follow[k, 1] * after + window.follow[k, 2] * before
            square = (window.length[min(e, i)] + d * (new - after)) ** 2
            for c in range(1, other.shape[0]):
                square -= (now[c, i] - other[c, e]) ** 2
                other[c, i] = now[c, i]
            other[0, i] = other[0, e] + d * np.sqrt(square)
            window.wave[k, j], before, after, e = new, own, new, i


class Following:
    """A window that follows the contacts, and what it leaves behind.

    Args:
        mesh: the wires.
        still: (axis, node) m, at rest.
        width: m, on both sides of the contacts; infinite: all moves.
        step: s, of an inner step.
        inertia: factor on the mass for motion along x.
        link_springs: ties.
        holders: what holds.
        watched: points whose height is recorded.
    """

    def __init__(
        self, mesh: Mesh, still: Array, width: float, step: float, inertia: float, link_springs: LinkSprings,
        holders: Holders, watched: Places,
    ) -> None:  # fmt: skip
        s, self._mesh, self.still, self.width, self._step = mesh.strands, mesh, still, width, step
        self._fast, self._holder_x = holders.fast, holders.x
        x = x_of(mesh, mesh.ties.one.wire, mesh.ties.one.station)
        self._ties = [which[np.argsort(x[which], kind="stable")] for which in (link_springs.slow, link_springs.fast)]
        self._tie_x = [x[which] for which in self._ties]
        self._hold_x = x_of(mesh, mesh.holds.at.wire, mesh.holds.at.station)
        ends = s.across[:, 0], s.across[:, 0] + s.across[:, 1] * s.h * s.links
        self._watched_x = x_of(mesh, watched.wire, watched.station)
        clamped = mesh.ties.lengthwise
        pairs = zip(mesh.ties.one.wire[clamped], mesh.ties.other.wire[clamped], strict=True)
        self._carried = sorted({(int(a), int(carrier)) for a, carrier in pairs})
        carried = [a for a, _ in self._carried]
        lengths = np.stack([own[carried] for own in ends])
        points = np.concatenate([*ends, self._hold_x])
        self._marks = np.concatenate([np.stack([points, points]), lengths], axis=1)  # (2, mark) m, from x to x
        axial = np.array([wire.axial_stiffness for wire in mesh.plan.wires])
        self._speed, self._impedance = np.sqrt(axial / (s.rho * inertia)), np.sqrt(axial * s.rho * inertia)
        self._anchors = [self._anchors_of(a) for a in range(s.first.size)] if np.isfinite(width) else []
        self.is_whole = bool(np.isinf(width))
        self.low, self.high = np.zeros_like(s.links), np.zeros_like(s.links)  # nothing moves before the first step
        self.reach = np.array([np.inf, -np.inf])  # m, along x
        self._length = np.sqrt((np.diff(still, append=still[:, -1:]) ** 2).sum(axis=0))
        self._layer = layers(mesh, width)
        self._mark = np.zeros((s.first.size, 2))  # m, x of the last node that follows, as all beyond was led along last
        if self.is_whole:
            self.high[:], self.reach[:] = s.links + 1, (-np.inf, np.inf)

    def _anchors_of(self, a: int) -> Array:
        """Where a wire is held along x, in links, in order."""
        holds, s = self._mesh.holds, self._mesh.strands
        along = (holds.stiffness > 0.0) & (np.abs(holds.axes[:, :, 0]) > 0.0)
        at = holds.at.station[along.any(axis=1) & (holds.at.wire == a)] / s.h[a]
        ends = [place for place in (0.0, float(s.links[a])) if self._mesh.fixed[0, int(s.first[a] + place)]]
        return np.sort(np.concatenate([at, ends]))

    def changing(self) -> dict[str, Array]:
        """What changes."""
        return {"low": self.low, "high": self.high, "reach": self.reach, "mark": self._mark}

    def around(self, x: Array, r: Sequence[Array], mass: Array, work: Array) -> LargeWindow:
        """The window for a stretch of the motion.

        Args:
            x: (place,) m, of what is to be in it.
            r: now and a step before, (axis, node) m: what comes in is led along, what is left stands still.
            mass: (axis, node) kg.
            work: the account.
        """
        s = self._mesh.strands
        if not self.is_whole and x.size:
            each = s.across[:, 1] * s.h
            begin, end = self._clear(float(x.min()) - self.width, float(x.max()) + self.width)
            low = np.clip(np.floor((begin - s.across[:, 0]) / each), 0, s.links + 1).astype(np.int64)
            high = np.clip(np.ceil((end - s.across[:, 0]) / each), 0, s.links + 1).astype(np.int64)
            none = low >= high
            low[none] = high[none] = 0
            self._move_to(low, high, r, mass, work)
            self.reach[:] = begin, end
        begin, end = self._within()
        rigid, elastic = (
            (first + int(np.searchsorted(x, begin)), first + int(np.searchsorted(x, end)))
            for x, first in ((self._holder_x[: self._fast], 0), (self._holder_x[self._fast :], self._fast))
        )
        watched = np.flatnonzero((self._watched_x >= begin) & (self._watched_x < end))
        slow, fast = (self._near(which, x) for which, x in zip(self._ties, self._tie_x, strict=True))
        border, follow, impedance, wave = self._borders(r[0])
        return LargeWindow(
            self.low, self.high, *self._layer, slow, fast, rigid, elastic, watched, border, follow, impedance, wave,
            self._length,
        )  # fmt: skip

    def _near(self, ties: Integers, x: Array) -> Integers:
        """Those of some ties, in the order of their x in m, that share a node which moves."""
        margin = 2.0 * WIDTH * float(self._mesh.strands.h.max())
        found = ties[slice(*np.searchsorted(x, self.reach + np.array([-margin, margin])))]
        moves = np.zeros(found.size, dtype=np.bool_)
        for end in (self._mesh.ties.one, self._mesh.ties.other):
            wire, base = end.wire[found], end.base[found]
            first = base - self._mesh.strands.first[wire]
            moves |= (first < self.high[wire]) & (first + WIDTH > self.low[wire])
        return found[moves]

    def _within(self) -> Array:
        """Between which x a point is shared by nodes that move alone, m."""
        edge = WIDTH * float(self._mesh.strands.h.max())
        return np.asarray(self.reach + np.array([edge, -edge]))

    def holds_within(self) -> Integers:
        """Numbers of all holds that hold something which moves."""
        begin, end = self._within()
        return np.flatnonzero((self._hold_x >= begin) & (self._hold_x < end))

    def _clear(self, begin: float, end: float) -> tuple[float, float]:
        """A window whose borders are clear of holds and ends of wires: what moves must feel all that holds it."""
        near = _CLEAR * WIDTH * float(self._mesh.strands.h.max())
        before, after = self._marks[0] - near, self._marks[1] + near
        while (close := (before < begin) & (begin < after)).any():
            begin = float(before[close].min())
        while (close := (before < end) & (end < after)).any():
            end = float(after[close].max())
        return begin, end

    def _hold_beyond(self, a: int, i: int, d: int) -> float:
        """How far it is from node i of a wire in the direction d to where that is held along x, m."""
        away = d * (self._anchors[a] - i)
        return float(away[away > 0.0].min(initial=np.inf) * self._mesh.strands.h[a])

    def _borders(self, r: Array) -> tuple[Integers, Array, Array, Array]:
        """Borders of all wires at positions r (axis, node) in m, as `LargeWindow` has them."""
        s = self._mesh.strands
        border, follow, impedance = list[tuple[int, int]](), list[Array](), list[float]()
        for a in np.flatnonzero(self.high > self.low):
            for i, d in ((int(self.low[a]), -1), (int(self.high[a]) - 1, 1)):
                if not 0 < i < s.links[a]:
                    continue
                A, B = 0.5 / self._step, 0.5 * self._speed[a] / s.h[a]
                S = 0.25 * self._speed[a] / max(self._hold_beyond(int(a), i, d), s.h[a])
                border.append((int(s.first[a]) + i, d))
                follow.append(np.array([A - B - S, B - A - S, A + B - S]) / (A + B + S))
                impedance.append(self._impedance[a])
        wave = np.zeros((len(border), BEYOND))
        for k, (e, d) in enumerate(border):
            nodes = e + d * np.arange(BEYOND + 1)
            longer = np.sqrt((np.diff(r[:, nodes]) ** 2).sum(axis=0)) - self._length[np.minimum(nodes[1:], nodes[:-1])]
            wave[k] = r[0, e] - self.still[0, e] + d * np.cumsum(longer)
        return (
            np.array(border, dtype=np.int64).reshape(-1, 2), np.array(follow, dtype=np.float64).reshape(-1, 3),
            np.array(impedance, dtype=np.float64), wave,
        )  # fmt: skip

    def _live(self, a: int, low: int, high: int) -> tuple[int, int]:
        """Of a wire whose nodes from low to high move: the first that moves or follows, and one beyond the last."""
        if low >= high:
            return 0, 0
        return max(low - BEYOND, 0), min(high + BEYOND, int(self._mesh.strands.links[a]) + 1)

    def _beyond(self) -> Iterator[tuple[int, int, slice, int]]:
        """Stretches beyond the nodes that follow: wire, side, nodes, and the last that follows."""
        for a in np.flatnonzero(self.high > self.low):
            first, n = int(self._mesh.strands.first[a]), int(self._mesh.strands.links[a]) + 1
            i, j = self._live(int(a), int(self.low[a]), int(self.high[a]))
            if i > 0:
                yield int(a), 0, slice(first, first + i), first + i
            if j < n:
                yield int(a), 1, slice(first + j, first + n), first + j - 1

    def settle(self, r: Sequence[Array]) -> None:
        """Lead along all that is beyond the window, positions (axis, node) in m now and a step before: it stands."""
        for a, side, part, end in () if self.is_whole else self._beyond():
            first, h = int(self._mesh.strands.first[a]), float(self._mesh.strands.h[a])
            led, reach = r[0][0, end] - self._mark[a, side], self._hold_beyond(a, end - first, 2 * side - 1)
            ways = [(part, np.arange(part.start, part.stop) - float(end))]  # links beyond the end
            for carried in (b for b, carrier in self._carried if carrier == a and self.low[b] >= self.high[b]):
                away = self._places_on(a, carried) - (end - first)
                if (away[0] > 0.0) == (side == 1):
                    ways.append((self._mesh.of(carried), away))
            for nodes, away in ways:  # as much as a wire that is stretched evenly up to where it is held
                for at in r:
                    at[0, nodes] += led * np.maximum(1.0 - np.abs(away) * h / reach, 0.0)
            self._mark[a, side] = r[0][0, end]

    def _places_on(self, carrier: int, carried: int) -> Array:
        """Beside which places of the wire that carries another one the nodes of that are, in links."""
        s = self._mesh.strands
        x = s.across[carried, 0] + s.across[carried, 1] * s.h[carried] * np.arange(s.links[carried] + 1.0)
        return np.asarray((x - s.across[carrier, 0]) / (s.across[carrier, 1] * s.h[carrier]))

    def _move_to(self, low: Integers, high: Integers, r: Sequence[Array], mass: Array, work: Array) -> None:
        """Let what comes in move, as its neighbour does, and what is left stand still where it is."""
        self.settle(r)
        now, last = r
        for a in np.flatnonzero((self.high > self.low) | (high > low)):
            first = int(self._mesh.strands.first[a])
            i, j = (first + e for e in self._live(int(a), int(self.low[a]), int(self.high[a])))
            m, n = (first + e for e in self._live(int(a), int(low[a]), int(high[a])))
            for part, end in (slice(m, min(n, i)), i), (slice(max(m, j), n), j - 1):  # comes in
                if part.stop > part.start and j > i:
                    last[0, part] = now[0, part] - (now[0, end] - last[0, end])
            stops = [(slice(i, min(j, m)), slice(None)), (slice(max(i, n), j), slice(None))]
            if n > m:
                stops += [
                    (slice(m, first + int(low[a])), slice(1, None)),
                    (slice(first + int(high[a]), n), slice(1, None)),
                ]
            for part, axes in stops:
                if part.stop > part.start:
                    rate = (now[axes, part] - last[axes, part]) / self._step
                    work[DAMPED] += 0.5 * float((mass[axes, part] * rate**2).sum())  # lost
                    last[axes, part] = now[axes, part]
        for carried, carrier in self._carried:  # comes in as what carries it moves
            if low[carried] < high[carried] and self.low[carried] >= self.high[carried]:
                moved = (now[0] - last[0])[self._mesh.of(carrier)]
                place, nodes = self._places_on(carrier, carried), self._mesh.of(carried)
                last[0, nodes] = now[0, nodes] - np.interp(place, np.arange(moved.size), moved)
        self.low[:], self.high[:] = low, high
        for wire, side, _, end in self._beyond():
            self._mark[wire, side] = now[0, end]
