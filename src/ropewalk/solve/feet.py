"""Feet: contacts that are put down on a line and taken up again, and the line as who decides about them sees it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ropewalk.mechanics.bodies import AWAY, RIDING, Bodies
from ropewalk.mechanics.chain import DRIVE, LOAD_DAMPING, OFF, SHARED, Array, State
from ropewalk.mechanics.rider import contact_point, put_back, seat_of
from ropewalk.solve.start import Setting


@dataclass
class Line:
    """The line as a load sees it while the motion goes on."""

    setting: Setting
    state: State
    strand: int

    @cached_property
    def length(self) -> float:
        """Unstrained length, m."""
        return float(self.setting.strands.links[self.strand] * self.setting.strands.h[self.strand])

    def at(self, xi: float) -> tuple[Array, Array]:
        """Position in m and velocity in m/s of the line at the unstrained length xi in m from its start, (axis,)."""
        i, part = self._place(xi)
        shares = np.array([1.0 - part, part])
        return self.state.r[:, i : i + 2] @ shares, self.state.w[:, i : i + 2] @ shares

    def below(self, x: float, way: Array | None = None) -> float:
        """The xi in m of the line above or below a horizontal place x in m, along x or a level unit vector (x, y)."""
        first, last = self.ends
        row, X = self._row(way), self.state.X[first : last + 1]
        return float(np.interp(x, row, X) if row[-1] > row[0] else np.interp(-x, -row, X))

    def height(self, x: float, way: Array | None = None) -> float:
        """Height of the line in m at a horizontal place in m; beyond its ends it goes on straight, as in the kernel."""
        first, last = self.ends
        row, z = self._row(way), self.state.r[-1, first : last + 1]
        onward = 1.0 if row[-1] > row[0] else -1.0
        i = min(max(int(np.searchsorted(onward * row, onward * x)) - 1, 0), row.size - 2)
        return float(z[i] + (x - row[i]) / (row[i + 1] - row[i]) * (z[i + 1] - z[i]))

    @cached_property
    def ends(self) -> tuple[int, int]:
        """Numbers of its first and last node."""
        first = int(self.setting.strands.first[self.strand])
        return first, first + int(self.setting.strands.links[self.strand])

    def _row(self, way: Array | None) -> Array:
        first, last = self.ends
        level = self.state.r[:-1, first : last + 1]
        return np.asarray(level[0] if way is None else way @ level)

    def _place(self, xi: float) -> tuple[int, float]:
        first, last = self.ends
        X = self.state.X
        i = int(seat_of(X, xi, self._link, first, last))
        begin = float(X[i])
        return i, (xi - begin) / (float(X[i + 1]) - begin)

    @cached_property
    def _link(self) -> float:
        return float(self.setting.strands.h[self.strand])


def set_down(setting: Setting, state: State, bodies: Bodies, k: int, xi: float) -> None:
    """Let contact k stand on its line at xi."""
    take_up(setting, state, bodies, k)
    s = int(setting.loads.strand[k])
    state.xi[k], state.rider[k], state.speed[k] = xi, SHARED, 0.0
    record, dim = bodies.wheels[k], state.r.shape[0]
    before = _foot_energy(setting, bodies, k)
    record["phase"] = RIDING
    place = np.zeros(dim)
    contact_point(setting.strands, setting.loads, state, k, place)
    _, speed = Line(setting, state, s).at(xi)
    record["r"][:dim], record["v"][:dim] = place, speed  # a foot is set down as fast as the line moves
    state.work[DRIVE] += _foot_energy(setting, bodies, k) - before


def _foot_energy(setting: Setting, bodies: Bodies, k: int) -> float:
    """Energy of the mass of a foot, which its owner lifts, lowers and moves, J."""
    z, record = len(setting.axes) - 1, bodies.wheels[k]
    height = -float(record["mass"][z] * setting.strands.gravity[z] * record["r"][z])
    return height + 0.5 * float((record["mass"] * record["v"] ** 2).sum())


def take_up(setting: Setting, state: State, bodies: Bodies, k: int) -> None:
    """Take contact k off its line."""
    b = int(state.rider[k])
    if b >= 0:
        put_back(setting.strands, state, int(setting.loads.strand[k]), b, float(state.speed[k]))
    record = bodies.wheels[k]
    if state.rider[k] != OFF:  # the foot stops, and is held where it is
        state.work[LOAD_DAMPING] += 0.5 * float((record["mass"] * record["v"] ** 2).sum())
    state.rider[k], state.speed[k] = OFF, 0.0
    record["phase"], record["v"] = AWAY, 0.0
