"""Plain ropes as controllers see them, and what controllers do with loads on them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ropewalk.checkpoint import Arrays, Tree, arrays_of, copied, put
from ropewalk.controllers import carrier
from ropewalk.controllers.carrier import SLIDES
from ropewalk.external.cosimulation_master import ContactPush
from ropewalk.mechanics.bodies import AWAY, MOVING_WITH, Bodies, Records
from ropewalk.mechanics.chain import DRIVE, LOAD_DAMPING, OFF, SHARED, Array, ChainState, Loads
from ropewalk.mechanics.moving_contact import contact_point, location_of, put_back
from ropewalk.mechanics.multibody_system import FIRM
from ropewalk.solve.start import PreparedRun

Look = Callable[[Loads, ChainState, Bodies, float], None]
"""Moves a copy of a state ahead by some seconds, with loads of its own."""


@dataclass
class ChainLine:
    """The line as a load sees it while the motion goes on."""

    setting: PreparedRun
    state: ChainState
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

    @property
    def chord(self) -> Array:
        """From its start to its end, (axis,) m."""
        first, last = self.ends
        return np.asarray(self.state.r[:, last] - self.state.r[:, first])

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
        i = int(location_of(X, xi, self._link, first, last))
        begin = float(X[i])
        return i, (xi - begin) / (float(X[i + 1]) - begin)

    @cached_property
    def _link(self) -> float:
        return float(self.setting.strands.h[self.strand])


@dataclass
class RopeCarrier:
    """Plain ropes in motion with the loads on them; see `Carrier`."""

    setting: PreparedRun
    state: ChainState
    bodies: Bodies
    loads: Loads
    look: Look | None = None  # sends a copy of the state ahead; given when the motion begins

    @property
    def t(self) -> float:
        """Time, s."""
        return float(self.state.t[0])

    @property
    def gravity(self) -> float:
        """Downwards, m/s^2."""
        return -float(self.setting.strands.gravity[-1])

    @property
    def q(self) -> Array:
        """Places of the coordinates of bodies, m."""
        return np.asarray(self.bodies.coordinates["q"])

    @property
    def v(self) -> Array:
        """Their velocities, m/s."""
        return np.asarray(self.bodies.coordinates["v"])

    @property
    def legs(self) -> Records:
        """Tethers."""
        return self.bodies.tethers

    def line(self, k: int) -> ChainLine:
        """The line of contact k as it is now."""
        return ChainLine(self.setting, self.state, int(self.setting.loads.strand[k]))

    def is_on(self, k: int) -> bool:
        """Whether contact k is on its line."""
        return bool(self.state.moving_load[k] != OFF)

    def motion(self, k: int) -> tuple[Array, Array]:
        """Place in m of contact k, and velocity in m/s of the line there, (axis,)."""
        place = np.zeros(self.state.r.shape[0])
        contact_point(self.setting.strands, self.setting.loads, self.state, k, place)
        return place, self.line(k).at(float(self.state.xi[k]))[1]

    def height(self, k: int) -> float:
        """Height of contact k, or where it was last, m."""
        if self.state.moving_load[k] == OFF:
            return float(self.bodies.wheels[k]["r"][len(self.setting.axes) - 1])
        return float(self.line(k).at(float(self.state.xi[k]))[0][-1])

    def set_down(self, k: int, xi: float) -> None:
        """Let contact k stand on its line at xi in m."""
        self.take_up(k)
        state, record = self.state, self.bodies.wheels[k]
        state.xi[k], state.moving_load[k], state.speed[k] = xi, SHARED, 0.0
        dim, before = state.r.shape[0], self._foot_energy(k)
        record["phase"] = MOVING_WITH
        record["r"][:dim], record["v"][:dim] = self.motion(k)  # a foot is set down as fast as the line moves
        self.give(self._foot_energy(k) - before)

    def _foot_energy(self, k: int) -> float:
        """Energy of the mass of a foot, which its owner lifts, lowers and moves, J."""
        z, record = len(self.setting.axes) - 1, self.bodies.wheels[k]
        height = -float(record["mass"][z] * self.setting.strands.gravity[z] * record["r"][z])
        return height + 0.5 * float((record["mass"] * record["v"] ** 2).sum())

    def take_up(self, k: int) -> None:
        """Take contact k off its line."""
        state, record, b = self.state, self.bodies.wheels[k], int(self.state.moving_load[k])
        if b >= 0:
            put_back(self.setting.strands, state, int(self.setting.loads.strand[k]), b, float(state.speed[k]))
        if state.moving_load[k] != OFF:  # the foot stops, and is held where it is
            self.lose(0.5 * float((record["mass"] * record["v"] ** 2).sum()))
        state.moving_load[k], state.speed[k] = OFF, 0.0
        record["phase"], record["v"] = AWAY, 0.0

    def launch(self, own: slice, v: Array) -> None:
        """Let some coordinates of bodies move at velocities in m/s from now on."""
        self.bodies.coordinates["v"][own] = self.bodies.coordinates["ahead"][own] = v

    def hold(self, own: slice) -> None:
        """Let some coordinates of one body stand as on firm ground: nothing moves what has no end of mass."""
        vehicle = int(np.flatnonzero(self.bodies.vehicles["first"] == own.start)[0])
        M, count = self.bodies.M[vehicle], own.stop - own.start
        self.lose(0.5 * float(M[0, 0]) * float((self.bodies.coordinates["v"][own] ** 2).sum()))
        self.launch(own, np.zeros(count))
        np.fill_diagonal(M[:count], FIRM)

    def couple(self, vehicle: int, own: Array, k: int | None, across: Array, stiffness: float) -> None:
        """Let one spring act on a vehicle whose elongation is `own` @ q less that of contact k along `across`."""
        K, bodies = self.bodies.K[vehicle], self.bodies
        K[:] = 0.0
        if k is None:
            return
        row = np.zeros(K.shape[0])
        row[: own.size] = own
        locations = zip(bodies.wheel[vehicle], bodies.axis[vehicle], strict=True)
        for j, (wheel, a) in enumerate(locations):
            if wheel == k and j < int(bodies.vehicles[vehicle]["wheels"]):
                row[own.size + j] = -across[a]
        K += stiffness * np.outer(row, row)

    def give(self, work: float) -> None:
        """Book work of muscles or drives, J."""
        self.state.work[DRIVE] += work

    def lose(self, energy: float) -> None:
        """Book what loads lose, J."""
        self.state.work[LOAD_DAMPING] += energy

    def apply_push(self, k: int, push: ContactPush, every: float) -> None:
        """Let contact k do what a push says for some seconds: it slides on to there, or is put down anew."""
        loads, away = self.loads, push.xi - float(self.state.xi[k])
        if self.state.moving_load[k] == OFF or abs(away) > self.reach(k):
            self.set_down(k, push.xi)
            away = 0.0
        first = int(loads.force_first[k])
        loads.force_time[first], loads.force_time[first + 1] = self.t, self.t + every
        loads.force_value[:, first], loads.force_value[:, first + 1] = push.first, push.last
        loads.speed_value[loads.speed_first[k]] = push.speed + away / every  # catches up until then

    def set_interface(self, interface_coordinate: int, height: float, rise: float) -> None:
        """Put the far end of an interface's spring somewhere, and let it go on from there."""
        record = self.bodies.coordinates[interface_coordinate]
        record["q"], record["v"], record["ahead"] = height, rise, rise

    def reach(self, k: int) -> float:
        """How far from where it has slid to contact k may be said to be without being put down anew, m."""
        return SLIDES * float(self.setting.strands.h[self.setting.loads.strand[k]])

    def given(self, contacts: Iterable[int]) -> Arrays:
        """What `apply_push` writes for some contacts."""
        found: Arrays = {}
        for k in contacts:
            first, at = int(self.loads.force_first[k]), int(self.loads.speed_first[k])
            found[f"{k}.time"] = self.loads.force_time[first : first + 2]
            found[f"{k}.force"] = self.loads.force_value[:, first : first + 2]
            found[f"{k}.speed"] = self.loads.speed_value[at : at + 1]
        return found

    def stored(self, line: carrier.CarrierLine) -> Tree:
        """A line of `frozen` as data."""
        assert isinstance(line, ChainLine)
        return copied(arrays_of(line.state))

    def frozen(self, k: int, tree: Tree | None = None) -> ChainLine:
        """The line of contact k as it is now, or as it was when `stored` gave a tree, to be looked at later."""
        then = self.state.copy()
        if tree is not None:
            put(arrays_of(then), tree)
        return ChainLine(self.setting, then, int(self.setting.loads.strand[k]))

    @property
    def looks_ahead(self) -> bool:
        """Whether twins can go on."""
        return self.look is not None

    def copy(self) -> RopeCarrier:
        """A twin that may go its own way: forces and speeds of its loads may be changed as well."""
        tables = ("speed_value", "force_time", "force_value")
        loads = self.loads._replace(**{name: getattr(self.loads, name).copy() for name in tables})
        return replace(self, state=self.state.copy(), bodies=self.bodies.copy(), loads=loads)

    def go_on(self, h: float) -> None:
        """Move a twin on by h seconds, or up to where somebody is to be asked."""
        assert self.look is not None
        self.look(self.loads, self.state, self.bodies, h)
