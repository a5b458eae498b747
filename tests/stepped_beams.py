"""Independent routes to beams with steps: transfer matrices, moments by hand, and Hermite elements with their modes.

Sources: W. C. Hurty and M. F. Rubinstein, Dynamics of Structures (1964), for transfer matrices of beams; the theorem of
Mohr for deflections; M. Hetenyi, Beams on Elastic Foundation (1946), for infinitely long beams on a bed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad, solve_ivp
from scipy.linalg import eigh
from scipy.optimize import brentq

Array = NDArray[np.float64]
Piece = tuple[float, float, float]
"""Length in m, bending stiffness in N m^2, mass per length in kg/m."""


def _field(piece: Piece, w: Array) -> Array:
    """Deflection, slope, moment, shear at the end of a piece by those at its start, (..., 4, 4), at w in rad/s."""
    length, EI, mass = piece
    k = (mass * w * w / EI) ** 0.25

    def all_at(x: float) -> Array:
        c, s, C, S = np.cos(k * x), np.sin(k * x), np.cosh(k * x), np.sinh(k * x)
        rows = np.array([[c, s, C, S], [-s, c, S, C], [-c, -s, C, S], [s, -c, S, C]])
        units = np.array([np.ones_like(k), k, EI * k**2, EI * k**3])
        return np.moveaxis(rows * units[:, None], (0, 1), (-2, -1))

    return np.asarray(all_at(length) @ np.linalg.inv(all_at(0.0)))


def frequencies(pieces: Sequence[Piece], count: int, clamped: tuple[bool, bool] = (False, False)) -> Array:
    """The lowest frequencies of a beam of uniform pieces on hinges, or clamped, Hz."""
    first, last = ([2, 3] if clamped[0] else [1, 3]), ([0, 1] if clamped[1] else [0, 2])

    def determinant(f: Array) -> Array:
        T = np.eye(4)
        for piece in pieces:
            T = _field(piece, 2.0 * np.pi * np.asarray(f)) @ T
        return np.asarray(np.linalg.det(T[..., last, :][..., first]))

    length, EI, mass = sum(p[0] for p in pieces), max(p[1] for p in pieces), min(p[2] for p in pieces)
    highest = (count + 0.6) ** 2 * np.pi / (2.0 * length**2) * np.sqrt(EI / mass)
    f = np.linspace(1e-3 * highest, highest, 4000)
    d = determinant(f)
    at = np.flatnonzero(d[:-1] * d[1:] < 0.0)
    return np.array([brentq(determinant, f[i], f[i + 1]) for i in at])[:count]


def sag(pieces: Sequence[Piece], x: float, gravity: float) -> float:
    """Deflection at x of a beam on hinges under the weight of its pieces, m: int M m / EI by Mohr's theorem."""
    ends = np.cumsum([0.0, *(p[0] for p in pieces)])
    whole = ends[-1]

    def moment(s: float) -> float:
        total = 0.0
        for (length, _, mass), begin in zip(pieces, ends, strict=False):
            middle, weight = begin + 0.5 * length, mass * gravity * length
            left = weight * (whole - middle) / whole
            over = np.clip(s - begin, 0.0, length)
            total += left * s - mass * gravity * over * (s - begin - 0.5 * over)
        return total

    def unit(s: float) -> float:
        return min(s, x) * (whole - max(s, x)) / whole

    parts = zip(pieces, ends, ends[1:], strict=False)
    return sum(quad(lambda s: moment(s) * unit(s), a, b, points=[x])[0] / p[1] for p, a, b in parts)


@dataclass(frozen=True)
class HermiteBeam:
    """A beam on hinges of cubic elements with consistent mass, on a bed or not; uniform within each element."""

    h: float  # m
    EI: Array  # (element,) N m^2
    mass: Array  # (element,) kg/m
    bed: Array  # (element,) N/m^2

    @staticmethod
    def of(length: float, elements: int, *, along: Callable[[Array], tuple[Array, Array, Array]]) -> HermiteBeam:
        """By bending stiffness, mass and bed at the middles of its elements."""
        h = length / elements
        return HermiteBeam(h, *along((np.arange(elements) + 0.5) * h))

    def matrices(self) -> tuple[Array, Array]:
        """Stiffness and mass of free coordinates: slope and deflection at nodes, but for those of hinges."""
        h, n = self.h, self.EI.size
        bent = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h],
                         [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h]]) / h**3  # fmt: skip
        heavy = np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h * h, 13 * h, -3 * h * h],
                          [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h * h, -22 * h, 4 * h * h]]) * h / 420  # fmt: skip
        K, M = np.zeros((2, 2 * n + 2, 2 * n + 2))
        for e in range(n):
            own = np.ix_(range(2 * e, 2 * e + 4), range(2 * e, 2 * e + 4))
            K[own] += self.EI[e] * bent + self.bed[e] * heavy
            M[own] += self.mass[e] * heavy
        free = np.delete(np.arange(2 * n + 2), [0, 2 * n])
        return K[np.ix_(free, free)], M[np.ix_(free, free)]

    def shape(self, x: float) -> Array:
        """What a unit force at x does on free coordinates."""
        h, n = self.h, self.EI.size
        e = min(int(x / h), n - 1)
        q = x / h - e
        out = np.zeros(2 * n + 2)
        out[2 * e : 2 * e + 4] = [
            (1 - q) ** 2 * (1 + 2 * q), h * q * (1 - q) ** 2, q * q * (3 - 2 * q), h * q * q * (q - 1),
        ]  # fmt: skip
        return np.delete(out, [0, 2 * n])

    def deflection(self, x: float, force: float, at: float) -> float:
        """At x in m under a force in N that stands, m."""
        return float(self.shape(x) @ np.linalg.solve(self.matrices()[0], force * self.shape(at)))

    def passage(self, times: Array, speed: float, force: float, x: float, mass: float = 0.0, modes: int = 12) -> Array:
        """Deflection at x in m under a force with a mass that moves, by modes; the last time lies on the beam."""
        square, shapes = eigh(*self.matrices(), subset_by_index=[0, modes - 1])
        h, n = self.h, self.EI.size
        # Cubics of q, the place within an element: rows 1, q, q^2, q^3; columns deflection and slope at both nodes.
        cubics = np.array([[1, 0, 0, 0], [0, h, 0, 0], [-3, -2 * h, 3, -h], [2, h, -2, h]])
        whole = np.insert(shapes, [0, 2 * n - 1], 0.0, axis=0)

        def rates(t: float, y: Array, e: int) -> Array:
            q, at = speed * t / h - e, cubics @ whole[2 * e : 2 * e + 4]
            here, slope, curve = np.array([[1, q, q**2, q**3], [0, 1, 2 * q, 3 * q**2], [0, 0, 2, 6 * q]]) @ at
            convected = 2.0 * speed / h * slope @ y[modes:] + (speed / h) ** 2 * curve @ y[:modes]
            free = here * (force - mass * convected) - square * y[:modes]
            # The inverse of I + m here here^T by Sherman and Morrison.
            return np.concatenate([y[modes:], free - here * (mass * here @ free / (1.0 + mass * here @ here))])

        # From node to node: curvatures jump there.
        y, motion = np.zeros(2 * modes), []
        for e in range(int(times[-1] * speed / h) + 1):
            begin, end = e * h / speed, (e + 1) * h / speed
            asked = times[(times >= begin) & (times < end)]
            part = solve_ivp(rates, (begin, end), y, "DOP853", [*asked, end], args=(e,), rtol=1e-8, atol=1e-10).y
            motion.append(part[:modes, :-1])
            y = part[:, -1]
        return np.asarray(shapes.T @ self.shape(x) @ np.hstack(motion))
