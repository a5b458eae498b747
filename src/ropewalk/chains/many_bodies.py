"""Bodies at many instants at once: their contacts, places and energies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.mechanics.bodies import AWAY, FLYING, LOCATED, MOVING_WITH, PULLS, PUSHES, WAITING, Bodies, noted_of
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.multibody_system import FIRM
from ropewalk.results.frame import IN_AIR, MOVES, OFF_LINE, STICKS
from ropewalk.results.frames import summed
from ropewalk.solve.start import PreparedRun


@dataclass(frozen=True)
class ManyBodies:
    """What bodies were at some instants, which come first; matrices and buffers stay as they are."""

    phase: Integers  # (instant, wheel)
    at: Integers  # (instant, wheel)
    r: Array  # (instant, wheel, axis) m
    v: Array  # (instant, wheel, axis) m/s
    wheels: Any  # (instant, wheel) records
    q: Array  # (instant, coordinate) m
    rate: Array  # (instant, coordinate) m/s
    tethers: Any  # (instant, tether) records
    fixed: Bodies

    @staticmethod
    def of(bodies: Bodies, dim: int, wheels: Any, coordinates: Any, tethers: Any) -> ManyBodies:
        """What has been noted of bodies that move in some dimensions."""
        r, v = (np.ascontiguousarray(wheels[name][..., :dim]) for name in "rv")
        return ManyBodies(
            np.ascontiguousarray(wheels["phase"]), np.ascontiguousarray(wheels["at"]), r, v, wheels,
            np.ascontiguousarray(coordinates["q"]), np.ascontiguousarray(coordinates["v"]), tethers, bodies,
        )  # fmt: skip

    @staticmethod
    def now(bodies: Bodies, dim: int) -> ManyBodies:
        """What they are at present."""
        return ManyBodies.of(bodies, dim, *(records.copy()[None] for records in noted_of(bodies)))

    def are(self, phase: int, k: int) -> tuple[Integers, Integers]:
        """Instants at which wheel k is in a phase, and the link or node that it is at."""
        rows = np.flatnonzero(self.phase[:, k] == phase)
        return rows, self.at[rows, k]

    def on_line(self, rows: Integers, k: int) -> Array:
        """Forces of wheel k on the line in the last kick, (row, axis) N."""
        return np.asarray(self.wheels["on_line"][rows, k, : self.r.shape[2]])

    def states(self, moving_load: Integers, speed: Array) -> Array:
        """In which states the contacts are, (instant, wheel); `moving_load` and `speed` are those of the chain."""
        phase, buffered = self.phase, np.isin(np.arange(self.phase.shape[1]), self.fixed.buffers["wheel"])
        off = (phase == AWAY) | (phase == WAITING) | ((phase == MOVING_WITH) & (moving_load <= -2))
        flies = (phase == FLYING) | ((phase == MOVING_WITH) & ~self.wheels["on_line"].any(axis=2) & buffered)
        return np.where(off, OFF_LINE, np.where(flies, IN_AIR, np.where(speed != 0.0, MOVES, STICKS)))


def put_located(setting: PreparedRun, X: Array, bodies: ManyBodies, r: Array, w: Array) -> None:
    """Put particles that wheels carry to their own places, in r and w (instant, axis, node); X is (instant, node)."""
    for k in range(bodies.phase.shape[1]):
        rows, b = bodies.are(LOCATED, k)
        s = int(setting.loads.strand[k])
        h = float(setting.strands.h[s])
        home = (b - setting.strands.first[s]) * h
        a = np.where(home < X[rows, b], b - 1, b)  # of the link that it is on
        part = ((home - X[rows, a]) / (X[rows, a + 1] - X[rows, a]))[:, None]
        here = r[rows, :, a] + part * (r[rows, :, a + 1] - r[rows, :, a])
        r[rows, :, b] = here
        w[rows, :, b] = bodies.wheels["store"][rows, k, : r.shape[1]] / (setting.strands.rho[s] * h)


def displayed(setting: PreparedRun, r: Array, bodies: ManyBodies, on: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Positions and velocities of all bodies beside the contacts, (instant, body, axis); nodes are at (instant, axis,
    node), and `on` is (instant, wheel) whether wheels are on their lines."""
    assert setting.multibody_system is not None
    others, dim = setting.multibody_system.displayed, r.shape[1]
    place, speed = np.empty((len(r), len(others), dim)), np.empty((len(r), len(others), dim))
    for i, body in enumerate(others):
        ahead = onwards(setting, r, int(setting.loads.strand[body.wheel]))
        for a, d in enumerate(body.coordinates):
            place[:, i, a] = bodies.q[:, d] if d >= 0 else body.locate(bodies.r[:, :, a], on, ahead[:, a])
            speed[:, i, a] = bodies.rate[:, d] if d >= 0 else body.locate(bodies.v[:, :, a], on, 0.0)
    return place, speed


def onwards(setting: PreparedRun, r: Array, s: int) -> Array:
    """Level directions from the start of strand s to its end, (instant, axis), see `onward`."""
    first = int(setting.strands.first[s])
    way = r[:, :, first + int(setting.strands.links[s])] - r[:, :, first]
    way[:, -1] = 0.0
    size = lengths(way)
    return np.asarray(way / np.where(size > 0.0, size, 1.0)[:, None])


def lengths(vectors: Array) -> Array:
    """Lengths of vectors (row, axis)."""
    total = np.zeros(len(vectors))
    for a in range(vectors.shape[1]):
        total += vectors[:, a] ** 2
    return np.sqrt(total)


def energies_of_loads(setting: PreparedRun, bodies: ManyBodies) -> dict[str, Array]:
    """Kinetic and potential energies of all loads, (instant,) J."""
    dim, fixed, (count, _) = bodies.r.shape[2], bodies.fixed, bodies.phase.shape
    z, mass = dim - 1, fixed.wheels["mass"][:, :dim]
    kinetic = 0.5 * summed(mass * bodies.v * bodies.v)
    potential = -summed(mass[:, z] * setting.strands.gravity[z] * bodies.r[:, :, z])
    for i, vehicle in enumerate(fixed.vehicles):
        n, wheels, first = int(vehicle["coordinates"]), int(vehicle["wheels"]), int(vehicle["first"])
        size, own = n + wheels, slice(first, first + n)
        k, a = fixed.wheel[i, :wheels], fixed.axis[i, :wheels]
        u = np.concatenate((bodies.q[:, own], bodies.r[:, k, a]), axis=1)
        rate = np.concatenate((bodies.rate[:, own], bodies.v[:, k, a]), axis=1)
        rate[:, np.diag(fixed.M[i])[:size] == FIRM] = 0.0  # what only its owner moves
        kinetic += 0.5 * _squares(rate, fixed.M[i, :size, :size])
        potential += 0.5 * _squares(u, fixed.K[i, :size, :size]) - summed(fixed.load[i, :size] * u)
    instant = np.arange(count)
    for tether in bodies.tethers.T:
        own = tether["first"][:, None] + np.arange(dim)
        way = bodies.q[instant[:, None], own] - bodies.r[instant, tether["wheel"]]
        across = np.ascontiguousarray(tether["across"][:, :dim])
        longer = lengths(way - summed(across * way)[:, None] * across) - tether["length"]
        slack = ((tether["way"] == PULLS) & (longer < 0.0)) | ((tether["way"] == PUSHES) & (longer > 0.0))
        acts = (tether["on"] != 0) & ~slack
        potential += np.where(acts, 0.5 * tether["stiffness"] * longer * longer, 0.0)
    for buffer in fixed.buffers:
        deep = buffer["side"] * (bodies.r[:, buffer["wheel"], z] - bodies.q[:, buffer["coordinate"]])
        potential += 0.5 * float(buffer["stiffness"]) * np.maximum(deep, 0.0) ** 2
    return {"load_kinetic": kinetic, "load_potential": potential}


def _squares(x: Array, A: Array) -> Array:
    """The quadratic form x A x of each row."""
    return summed(x[:, :, None] * A * x[:, None])
