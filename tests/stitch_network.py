"""Another assembly of overhead lines with stitch wires, for tests: networks of strings, and of bars with lumped masses.

Numbers only, nothing of the package. At rest strings between points are parabolas, so heights are exact. About that
rest bars move along the line as well as up and down: what links the tensions of messenger and stitch wire is in there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

Array = NDArray[np.float64]
G = 9.81
CONTACT, MESSENGER, STITCH = 0, 1, 2


@dataclass(frozen=True)
class String:
    """A string from x to x under a tension along x, which less takes from between two places."""

    start: float  # m
    end: float  # m
    tension: float  # N
    mass: float  # kg/m
    EA: float  # N
    less: tuple[tuple[float, float, float], ...] = ()  # m, m, N

    def pull(self, x: float) -> float:
        """Tension along x there, N."""
        return self.tension - sum(T for a, b, T in self.less if a < x < b)


@dataclass(frozen=True)
class StitchedLine:
    """Level spans of equal length, contact wire level at droppers and supports, a stitch wire at each support."""

    spans: int = 3
    length: float = 60.0  # m
    droppers: tuple[float, ...] = (5.0, 10.5, 17.0, 23.5, 30.0, 36.5, 43.0, 49.5, 55.0)
    contact: tuple[float, float, float] = (20e3, 1.35, 17e6)  # N, kg/m, N
    messenger: tuple[float, float, float] = (16e3, 1.07, 14e6)
    stitch: tuple[float, float, float] = (2.8e3, 0.31, 4e6)
    reach: float = 9.0  # m, from a support to a clamp; 0: no stitch wires
    height: float = 1.8  # m
    stiffness: float = 100e3  # N/m, of droppers

    @property
    def supports(self) -> Array:
        """Places of those between spans, m."""
        return self.length * np.arange(1, self.spans)

    @property
    def hung(self) -> Array:
        """Places of all droppers, m."""
        return (self.length * np.arange(self.spans)[:, None] + np.array(self.droppers)).ravel()

    @property
    def strings(self) -> list[String]:
        """Contact wire, messenger, stitch wires."""
        end, at = self.spans * self.length, self.supports if self.reach else ()
        less = tuple((float(s) - self.reach, float(s) + self.reach, self.stitch[0]) for s in at)
        found = [String(0.0, end, *self.contact), String(0.0, end, *self.messenger, less)]
        return found + [String(a, b, *self.stitch) for a, b, _ in less]

    def above(self, x: float) -> int:
        """The string that a dropper hangs from."""
        near = [i for i, s in enumerate(self.strings[STITCH:]) if s.start < x < s.end]
        return STITCH + near[0] if near else MESSENGER

    @property
    def pulls(self) -> Array:
        """What droppers bear, N: the contact wire between them and the supports; arms bear the rest."""
        points = np.sort(np.concatenate([[0.0], self.hung, self.supports, [self.spans * self.length]]))
        half = 0.5 * self.contact[1] * G * (points[2:] - points[:-2])
        return half[np.searchsorted(points, self.hung) - 1]

    def rest(self, h: float) -> tuple[list[Array], list[Array], Array]:
        """Places and heights of all strings at points every h metres, and unstrained lengths of the droppers, m.

        Heights follow from the balance of each point of strings of piecewise constant tension: exact at the points.
        """
        strings, hung = self.strings, self.hung
        x = [np.linspace(s.start, s.end, round((s.end - s.start) / h) + 1) for s in strings]
        first = np.concatenate([[0], np.cumsum([points.size for points in x])])
        K, f = np.zeros((first[-1], first[-1])), np.zeros(first[-1])
        fixed: dict[int, float] = {}
        same: list[tuple[int, int]] = []  # ends of stitch wires, and where they are clamped

        def at(string: int, place: float) -> int:
            return int(first[string]) + round((place - strings[string].start) / h)

        for i, s in enumerate(strings):
            for k in range(x[i].size - 1):
                own, T = first[i] + np.array([k, k + 1]), s.pull(0.5 * (x[i][k] + x[i][k + 1]))
                K[np.ix_(own, own)] += T / h * np.array([[1.0, -1.0], [-1.0, 1.0]])
                f[own] -= 0.5 * s.mass * G * h
            if i >= STITCH:
                same += [(at(i, s.start), at(MESSENGER, s.start)), (at(i, s.end), at(MESSENGER, s.end))]
        end = self.spans * self.length
        fixed |= {at(MESSENGER, place): self.height for place in (0.0, end, *self.supports)}
        fixed |= {at(CONTACT, place): 0.0 for place in (0.0, end, *hung, *self.supports)}
        for place, pull in zip(hung, self.pulls, strict=True):
            f[at(self.above(place), place)] -= pull
        join = np.eye(first[-1])
        for low, high in same:
            join[low] = join[high]
        K, f = join.T @ K @ join, join.T @ f
        z = np.zeros(first[-1])
        z[list(fixed)] = list(fixed.values())
        free = np.setdiff1d(np.arange(first[-1]), [*fixed, *(low for low, _ in same)])
        z[free] = np.linalg.solve(K[np.ix_(free, free)], (f - K @ z)[free])
        z = join @ z
        reach = np.array([z[at(self.above(p), p)] - z[at(CONTACT, p)] for p in hung])
        return x, np.split(z, first[1:-1]), reach - self.pulls / self.stiffness

    def matrices(self, h: float, *, along: bool = True) -> tuple[Array, Array, NDArray[np.int64], NDArray[np.int64]]:
        """Stiffness and mass about rest of what is free, numbers of these, and of the points of the contact wire.

        Args:
            h: distance of points, m.
            along: whether points move along x, too.
        """
        strings = self.strings
        x, z, lengths = self.rest(h)
        first = np.concatenate([[0], np.cumsum([points.size for points in x])])
        count = int(first[-1])
        K, m = np.zeros((2 * count, 2 * count)), np.zeros(count)

        def bar(i: int, j: int, d: Array, k: float, pull: float) -> None:
            L = np.hypot(*d)
            e = d / L
            block = (k - pull / L) * np.outer(e, e) + pull / L * np.eye(2)
            own, other = np.array([i, i + count]), np.array([j, j + count])
            for a, b, sign in ((own, own, 1), (other, other, 1), (own, other, -1), (other, own, -1)):
                K[np.ix_(a, b)] += sign * block

        def at(string: int, place: float) -> int:
            return int(first[string]) + round((place - strings[string].start) / h)

        for i, s in enumerate(strings):
            for k in range(x[i].size - 1):
                d = np.array([h, z[i][k + 1] - z[i][k]])
                L = float(np.hypot(*d))
                T = s.pull(0.5 * (x[i][k] + x[i][k + 1])) * L / h
                # Without motion along x no stretch follows from the slope: T / h is all that a link answers with.
                stiff = s.EA / (L / (1.0 + T / s.EA)) if along else T / L
                bar(first[i] + k, first[i] + k + 1, d, stiff, T)
                m[first[i] + np.array([k, k + 1])] += 0.5 * s.mass * h
        for place, pull, length in zip(self.hung, self.pulls, lengths, strict=True):
            bar(at(CONTACT, place), at(self.above(place), place), np.array([0.0, length + pull / self.stiffness]),
                self.stiffness, pull)  # fmt: skip
        join = np.eye(2 * count)
        gone = []
        for i, s in enumerate(strings[STITCH:], start=STITCH):
            for place in (s.start, s.end):
                for axis in (0, count):
                    join[axis + at(i, place)] = join[axis + at(MESSENGER, place)]
                    gone.append(axis + at(i, place))
        K, M = join.T @ K @ join, join.T @ np.diag(np.concatenate([m, m])) @ join
        ends = [count + at(w, place) for w in (CONTACT, MESSENGER) for place in (0.0, self.spans * self.length)]
        held = [count + at(MESSENGER, place) for place in self.supports]
        free = np.setdiff1d(np.arange(0 if along else count, 2 * count), [*gone, *ends, *held])
        return K[np.ix_(free, free)], M[np.ix_(free, free)], free, count + np.arange(x[CONTACT].size)

    def elasticity(self, places: Array, h: float, *, along: bool = True) -> Array:
        """Rise of the contact wire under a small force there, over the force, m/N."""
        K, _, free, contact = self.matrices(h, along=along)
        if along:  # both wires may slide along the line together, which costs nothing
            K = K + 1e-6 * np.eye(len(K))
        own = np.searchsorted(free, contact[np.round(np.asarray(places) / h).astype(np.int64)])
        push = np.zeros((len(K), own.size))
        push[own, np.arange(own.size)] = 1.0
        return np.asarray(np.linalg.solve(K, push)[own, np.arange(own.size)])

    def frequencies(self, count: int, h: float) -> Array:
        """The lowest natural frequencies, Hz."""
        K, M, _, _ = self.matrices(h)
        square = eigh(K, M, eigvals_only=True, subset_by_index=(0, count + 3))
        return np.asarray(np.sqrt(square[square > 1e-3])[:count] / (2.0 * np.pi))
