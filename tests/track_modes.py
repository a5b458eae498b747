"""A track in textbook words: sine modes of rail and bridge, sleepers and ballast as point masses, a moving force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Beam(NamedTuple):
    """A beam on hinges."""

    start: float  # m, along x
    length: float
    mass: float  # kg/m
    stiffness: float  # N m^2
    modes: int
    drag: float = 0.0  # 1/s

    def shapes(self, x: float) -> Array:
        """Sine modes at a place."""
        return np.asarray(np.sin(np.arange(1, self.modes + 1) * np.pi * (x - self.start) / self.length))

    def is_over(self, x: float) -> bool:
        return bool(-1e-9 <= x - self.start <= self.length + 1e-9)


class Layer(NamedTuple):
    """Springs and dampers of one layer, and the mass below or above them."""

    stiffness: float  # N/m
    damping: float  # N s/m
    mass: float = 0.0  # kg


@dataclass(frozen=True)
class ModalTrack:
    """Rail, bridge, and what is below sleepers at places x."""

    rail: Beam
    bridge: Beam | None
    sleepers: Array  # m
    pads: Layer
    sleeper: float  # kg
    ballast: Layer
    subgrade: Layer

    def matrices(self) -> tuple[Array, Array, Array]:
        """M, C and K, of modes of the rail, of the bridge, and of masses."""
        rail, bridge = self.rail, self.bridge
        beams = [rail] if bridge is None else [rail, bridge]
        own, on = sum(beam.modes for beam in beams), [bridge is not None and bridge.is_over(x) for x in self.sleepers]
        size = own + self.sleepers.size + on.count(False)
        M, C, K = (np.zeros((size, size)) for _ in range(3))
        first = 0
        for beam in beams:
            n = np.arange(1, beam.modes + 1)
            at = first + n - 1
            M[at, at] = 0.5 * beam.mass * beam.length
            C[at, at] = beam.drag * M[at, at]
            K[at, at] = 0.5 * beam.length * beam.stiffness * (n * np.pi / beam.length) ** 4
            first += beam.modes
        base = own + self.sleepers.size

        def couple(row: Array, layer: Layer) -> None:
            K[:] += layer.stiffness * np.outer(row, row)
            C[:] += layer.damping * np.outer(row, row)

        for i, x in enumerate(self.sleepers):
            above, sleeper = np.zeros(size), np.zeros(size)
            above[: rail.modes], sleeper[own + i] = rail.shapes(x), 1.0
            M[own + i, own + i] = self.sleeper
            couple(above - sleeper, self.pads)
            below = np.zeros(size)
            if on[i] and bridge is not None:
                below[rail.modes : own] = bridge.shapes(x)
                M += self.ballast.mass * np.outer(below, below)
            else:
                below[base] = 1.0
                M[base, base] = self.ballast.mass
                couple(below, self.subgrade)
                base += 1
            couple(sleeper - below, self.ballast)
        return M, C, K

    def under_a_force(self, force: float, start: float, speed: float, times: Array, *, parts: int) -> Array:
        """Coordinates (instant, coordinate) under a downward force from x = start on, which appears at time 0.

        Newmark's average acceleration, `parts` steps between two instants.
        """
        M, C, K = self.matrices()
        dt = float(times[1] - times[0]) / parts
        solve = scipy.linalg.lu_factor(M + 0.5 * dt * C + 0.25 * dt * dt * K)
        q, v = np.zeros(M.shape[0]), np.zeros(M.shape[0])
        found: Array = np.zeros((times.size, q.size))

        def load(t: float) -> Array:
            f, x = np.zeros(q.size), start + speed * t
            if self.rail.is_over(x):
                f[: self.rail.modes] = -force * self.rail.shapes(x)
            return f

        a: Array = np.linalg.solve(M, load(0.0) - K @ q)
        for i in range(1, times.size):
            for j in range(parts):
                t = float(times[i - 1]) + (j + 1) * dt
                ahead, rate = q + dt * v + 0.25 * dt * dt * a, v + 0.5 * dt * a
                a = scipy.linalg.lu_solve(solve, load(t) - C @ rate - K @ ahead)
                q, v = ahead + 0.25 * dt * dt * a, rate + 0.5 * dt * a
            found[i] = q
        return found
