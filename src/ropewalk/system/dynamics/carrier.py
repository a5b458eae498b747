"""The system as controllers see it, and what controllers do with loads on it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ropewalk.checkpoint import Arrays, Tree, arrays_of, copied, put
from ropewalk.controllers import carrier
from ropewalk.controllers import carrier as seen
from ropewalk.external.cosimulation_master import ContactPush
from ropewalk.mechanics.bodies import Records
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import entry_of
from ropewalk.mechanics.multibody_system import FIRM
from ropewalk.mechanics.portions import portions
from ropewalk.system.contact.arrivals import next_change
from ropewalk.system.contact.contact_record import AWAY, BODY, ON
from ropewalk.system.contact.tables import Tables
from ropewalk.system.dynamics import motion
from ropewalk.system.dynamics.intervals import Intervals, advance
from ropewalk.system.elements.profile import profile_entry
from ropewalk.system.elements.spline import WIDTH, share
from ropewalk.system.elements.structure import DRIVEN, IN_BODIES, STRUCK, Buffers, Structure, SystemState
from ropewalk.system.loads.bodies import BodyArrays, with_step
from ropewalk.system.loads.tethers import gap_entry, height_entry, seek_entry

# Part of a leg to which it is found when it lands or takes off, and tries of finding it.
CLOSE, TRIES = 3e-10, 40
# By which steps get shorter as tensions of inextensible lines grow: for twice as much of these.
SHORTER = 0.7
NEAR, WILD = 1e-9, 1e-3  # parts of a step that are none any more, and that no tension asks for


Advance = Callable[[float, int], tuple[int, float]]


class System(NamedTuple):
    """All that the kernel of a motion is handed."""

    structure: Structure
    buffers: Buffers
    contacts: Any
    tables: Tables
    bodies: BodyArrays
    state: SystemState
    table: Array
    out: Array
    A: Array
    b: Array
    method: tuple[Array, Array]  # kicks and drifts of a step

    @property
    def arguments(self) -> tuple[Any, ...]:
        """What the kernel of a motion is handed, but for steps."""
        return self.structure.for_kernels, self.buffers.for_kernels(self.structure), *self[2:]

    def advance(self, dt: float, steps: int) -> tuple[int, float]:
        """The kernel of a motion, see there."""
        return advance(*self.arguments, dt, steps, Intervals.nowhere(self.bodies))  # type: ignore[no-any-return]

    def go(
        self, end: float, longest: float, alone: bool = False, advance: Advance | None = None
    ) -> tuple[int, int]:  # fmt: skip
        """Go on to a time in s by equal steps.

        Args:
            end: s.
            longest: s, the most that a step may be.
            alone: contacts give way within such a step; where intervals are cut short, they do as in the longest.
            advance: as `advance`, if there is a shorter way to that.

        Returns:
            What has come of it, and the number of steps.
        """
        begin = float(self.state.t[0])
        steps = max(1, int(np.ceil((end - begin) / longest - 1e-9)))
        dt = (end - begin) / steps
        if alone and self.is_verlet:
            self.contacts["step"] = dt
        self.bodies.inverse[:] = with_step(self.bodies, dt).inverse
        if self.buffers.tight is not None:
            self.buffers.tight.step_by(self.structure, dt)
        advance = advance or self.advance
        for part in portions(steps, self.state.r.shape[1], self.method[1].size):
            status = int(advance(dt, part)[0])
            if status != motion.RUNNING:
                break
        if status in (motion.RUNNING, motion.NOT_FINITE):
            self.state.t[0] = end
        return status, steps if status == motion.RUNNING else round((float(self.state.t[0]) - begin) / dt)

    @property
    def is_verlet(self) -> bool:
        """Whether the method is Verlet's, in whose steps stiff contacts and supports give way."""
        return bool(self.method[1].size == 1)

    def segments(self, end: float) -> Iterator[float]:
        """Instants up to a time in s to which steps of higher order go: contacts come, leave and stop between two."""
        while not self.is_verlet and (found := next_change(self, end)) is not None:
            before, after = found
            if before > self.state.t[0]:
                yield before
            self.state.t[0] = after
            self.advance(0.0, motion.LOOK)
        yield end

    def settle(self) -> None:
        """Find all forces anew after contacts have changed; what jumps with them has no rate that damps."""
        self.advance(0.0, motion.SETTLE)
        self.buffers.before[:] = self.buffers.strain

    def gap(self) -> float:
        """How far the next leg is from landing or taking off, m."""
        return float(gap_entry(self.structure.lines, self.structure.runs, self.contacts, self.bodies, self.state))

    def changing(self) -> dict[str, Arrays]:
        """All that changes in motion."""
        own = arrays_of(self.bodies, "gone", "tethers", "M", "K")
        own |= arrays_of(self.bodies.carriages, "hauls", "ropes")
        found = {
            "state": arrays_of(self.state), "room": arrays_of(self.buffers), "contacts": {"records": self.contacts},
            "bodies": own,
        }  # fmt: skip
        if self.structure.sheaves is not None:
            passed = arrays_of(self.structure.runs, "first", "links") | arrays_of(self.structure.lines, "begin")
            own = arrays_of(self.structure.sheaves, "ahead", "tension", "drive")
            found["sheaves"] = own | passed | arrays_of(self.structure.inertia, "along")
        return found

    def put(self, tree: Tree) -> None:
        """Go back to a copy of what changes."""
        for name, arrays in self.changing().items():
            put(arrays, tree[name])

    def copy(self) -> System:
        """A twin that shares nothing that changes; its forces and speeds may be changed as well."""
        structure = self.structure if self.structure.sheaves is None else copied(self.structure)
        return System(structure, *(copied(part) for part in self[1:]))


@dataclass
class SystemLine:
    """A line as a load sees it while the motion goes on."""

    structure: Structure
    number: int
    r: Array  # (axis, node) m
    v: Array  # m/s
    kinks: list[tuple[float, Array]]  # of contacts: where they are, m, and how far from the spline, (axis,) m
    _weight: Array = field(default_factory=lambda: np.zeros((2, WIDTH)))

    @cached_property
    def length(self) -> float:
        """Unstrained length, m."""
        return float(self.structure.lines.length[self.number])

    @cached_property
    def _runs(self) -> Integers:
        first = int(self.structure.lines.first[self.number])
        return np.arange(first, first + int(self.structure.lines.runs[self.number]))

    @property
    def chord(self) -> Array:
        """From its start to its end, (axis,) m."""
        runs = self.structure.runs
        first, last = runs.first[self._runs[0]], runs.first[self._runs[-1]] + runs.links[self._runs[-1]]
        return np.asarray(self.r[:, last] - self.r[:, first])

    def way(self, xi: float) -> tuple[Array, Array]:
        """Position in m and velocity in m/s of the spline at xi, with the profile above it, (axis,)."""
        runs, begin = self.structure.runs, self.structure.lines.begin[self._runs]
        run = int(self._runs[max(int(np.searchsorted(begin, xi, side="right")) - 1, 0)])
        n = int(runs.links[run])
        x = min(max((xi - float(self.structure.lines.begin[run])) / float(runs.h[run]), 0.0), float(n))
        base = int(runs.first[run]) + int(share(x, n, self._weight[0], self._weight[1]))
        near, weight = slice(base, base + min(WIDTH, n + 1)), self._weight[0, : min(WIDTH, n + 1)]
        place = self.r[:, near] @ weight
        if (profiles := self.structure.lines.profiles).knots[self.number]:
            place[-1] += profile_entry(profiles, self.number, xi)
        return place, self.v[:, near] @ weight

    def at(self, xi: float) -> tuple[Array, Array]:
        """Position in m and velocity in m/s of the line at the unstrained length xi in m from its start, (axis,).

        Contacts stand at the tips of kinks; those go down to nothing within a link.
        """
        place, velocity = self.way(xi)
        h = float(self.structure.runs.h[self._runs[0]])
        for s, d in self.kinks:
            place = place + max(1.0 - abs(xi - s) / h, 0.0) * d
        return place, velocity

    def below(self, x: float, way: Array | None = None) -> float:
        """The xi in m of the line above or below a horizontal place x in m, along x or a level unit vector (x, y)."""
        ex, ey = _level(way)
        lines, runs = self.structure.lines, self.structure.runs
        run, u, *_ = seek_entry(lines, runs, self.r, self.number, ex, ey, x, self._weight[0], self._weight[1])
        return float(self.structure.lines.begin[run] + u * self.structure.runs.h[run])

    def height(self, x: float, way: Array | None = None) -> float:
        """Height of the line in m at a horizontal place in m; beyond its ends it goes on straight."""
        ex, ey = _level(way)
        lines, runs = self.structure.lines, self.structure.runs
        return float(height_entry(lines, runs, self.r, self.number, ex, ey, x, self._weight[0], self._weight[1]))


def _level(way: Array | None) -> tuple[float, float]:
    if way is None:
        return 1.0, 0.0
    return float(way[0]), float(way[1]) if way.size == 2 else 0.0


@dataclass
class SystemCarrier:
    """The system in motion with the loads on it; see `Carrier`."""

    system: System
    gravity: float  # m/s^2
    places: int  # coordinates that are places of contacts; those of bodies come after them
    longest: float  # s, of a step
    looks_ahead: bool = False
    steps: int = 0
    _known: tuple[System, tuple[Any, ...], Callable[..., tuple[int, float]], Intervals] | None = None

    def advance(self, dt: float, steps: int, intervals: Intervals | None = None) -> tuple[int, float]:
        """The kernel of the motion; what its arguments are is found out once, for those of the beginning."""
        if self._known is None:
            arguments, nowhere = self.system.arguments, Intervals.nowhere(self.system.bodies)
            self._known = self.system, arguments, entry_of(advance, (*arguments, dt, steps, nowhere)), nowhere
        (first, arguments, entry, nowhere), system = self._known, self.system
        if system is first:
            return entry(*arguments, dt, steps, nowhere if intervals is None else intervals)
        if system.structure is first.structure and system.state is first.state:  # no twin, and no window
            return entry(*system.arguments, dt, steps, nowhere)
        return system.advance(dt, steps)

    @property
    def t(self) -> float:
        """Time, s."""
        return float(self.system.state.t[0])

    @property
    def q(self) -> Array:
        """Places of the coordinates of bodies, m."""
        return self.system.state.u[self.places :]

    @property
    def v(self) -> Array:
        """Their velocities, m/s."""
        return self.system.state.w[self.places :]

    @property
    def legs(self) -> Records:
        """Tethers."""
        return self.system.bodies.tethers

    def line(self, k: int) -> SystemLine:
        """The line of contact k as it is now."""
        own, state = self.system.contacts, self.system.state
        number, dim = int(own[k]["line"]), state.r.shape[0]
        on = np.flatnonzero((own["line"] == number) & (own["state"] == ON))
        kinks = [(float(state.s[j]), (own[j]["d"] + own[j]["axial"] * own[j]["tangent"])[:dim]) for j in on]
        return SystemLine(self.system.structure, number, state.r, state.v, kinks)

    def is_on(self, k: int) -> bool:
        """Whether contact k is on its line."""
        return bool(self.system.contacts[k]["state"] == ON)

    def _own(self, k: int) -> slice:
        """Coordinates of contact k that has a body; none of others."""
        contact, dim = self.system.contacts[k], self.system.state.r.shape[0]
        return slice(int(contact["first"]), int(contact["first"]) + dim if contact["kind"] == BODY else 0)

    def motion(self, k: int) -> tuple[Array, Array]:
        """Place in m and velocity in m/s of contact k, which stands on its line, (axis,)."""
        own, state = self._own(k), self.system.state
        return state.u[own].copy(), state.w[own].copy()

    def height(self, k: int) -> float:
        """Height of contact k, or where it was last, m."""
        contact, top = self.system.contacts[k], self.system.state.r.shape[0] - 1
        return float(self.motion(k)[0][top] if contact["kind"] == BODY else contact["place"][top])

    def set_down(self, k: int, xi: float, speed: float = 0.0) -> None:
        """Let contact k stand on its line at xi in m, from where it goes along it at a speed in m/s."""
        self.take_up(k)
        contact, state, own = self.system.contacts[k], self.system.state, self._own(k)
        dim, tables = state.r.shape[0], self.system.tables
        self._lose_kink(k)
        line = self.line(k)
        place, velocity = line.way(xi)
        if speed:
            behind, ahead = (min(max(xi + way, 0.0), line.length) for way in (-self.reach(k), self.reach(k)))
            velocity = velocity + speed * (line.way(ahead)[0] - line.way(behind)[0]) / (ahead - behind)
        contact["state"], contact["been"], contact["comes"] = ON, 1, 0
        contact["begin"] = xi - float(tables.speed_value[contact["speed_first"]]) * self.t
        for name in ("place", "before", "p"):
            contact[name][:dim] = place
        for name in ("d", "axial", "was", "was_axial", "last", "lagged"):
            contact[name] = 0.0
        state.s[k] = contact["was_at"] = xi
        if contact["kind"] == BODY:
            before = self._foot_energy(own)
            state.u[own], state.w[own] = place, velocity  # a foot is set down as fast as the line moves
            self.give(self._foot_energy(own) - before)

    def _foot_energy(self, own: slice) -> float:
        """Energy of the mass of a foot, which its owner lifts, lowers and moves, J."""
        bodies, state = self.system.bodies, self.system.state
        weight = -float(bodies.force[own] @ state.u[own])
        return weight + 0.5 * float((bodies.mass[own] * state.w[own] ** 2).sum())

    def _lose_kink(self, k: int) -> None:
        """Let what is left of the kink of a contact that has gone straighten at once."""
        contact, buffers = self.system.contacts[k], self.system.buffers
        lost = float(buffers.pull[contact["link"]] @ contact["part"]) * float(contact["kink"])
        self.system.state.work[STRUCK] += lost
        contact["kink"] = 0.0

    def take_up(self, k: int) -> None:
        """Take contact k off its line; its kink straightens as fast as waves go on over a quarter of a link."""
        contact, state, own = self.system.contacts[k], self.system.state, self._own(k)
        if contact["state"] == ON:
            runs, run = self.system.structure.runs, int(contact["run"])
            state.work[STRUCK] += 0.5 * float(contact["firm"] * (contact["d"] ** 2).sum())
            state.work[STRUCK] += 0.5 * float(contact["aligned"] * contact["axial_stiffness"] * contact["axial"] ** 2)
            fast = np.sqrt(max(float(contact["tension"]), 0.0) / max(runs.rho[run], 1e-300)) / runs.h[run]
            contact["fade"] = 4.0 * fast * contact["kink"]
            self.lose(0.5 * float((self.system.bodies.mass[own] * state.w[own] ** 2).sum()))
        contact["state"], contact["comes"], contact["N"], contact["d"] = AWAY, 0, 0.0, 0.0
        contact["axial"] = 0.0
        state.w[own] = 0.0

    def launch(self, own: slice, v: Array) -> None:
        """Let some coordinates of bodies move at velocities in m/s from now on."""
        self.v[own] = v

    def hold(self, own: slice) -> None:
        """Let some coordinates of one body stand as on firm ground: nothing moves what has no end of mass."""
        bodies = self.system.bodies
        part = int(np.flatnonzero(bodies.at[:, 0] == self.places + own.start)[0])
        M, count = bodies.M[part], own.stop - own.start
        self.lose(0.5 * float(M[0, 0]) * float((self.v[own] ** 2).sum()))
        self.launch(own, np.zeros(count))
        np.fill_diagonal(M[:count], FIRM)

    def couple(self, vehicle: int, own: Array, k: int | None, across: Array, stiffness: float) -> None:
        """Let one spring act on a vehicle whose elongation is `own` @ q less that of contact k along `across`."""
        bodies = self.system.bodies
        K, n = bodies.K[vehicle], int(bodies.size[vehicle])
        K[:] = 0.0
        if k is None:
            return
        row = np.zeros(K.shape[0])
        row[: own.size] = own
        for i, c in enumerate(bodies.at[vehicle, :n]):
            if bodies.contact[c] == k:
                row[i] = -across[bodies.axis[c]]
        K += stiffness * np.outer(row, row)

    def give(self, work: float) -> None:
        """Book work of muscles or drives, J."""
        self.system.state.work[DRIVEN] += work

    def lose(self, energy: float) -> None:
        """Book what loads lose, J."""
        self.system.state.work[IN_BODIES] += energy

    def apply_push(self, k: int, push: ContactPush, every: float) -> None:
        """Let contact k do what a push says for some seconds: it slides on to there, or is put down anew."""
        contact, tables, state = self.system.contacts[k], self.system.tables, self.system.state
        away = push.xi - float(state.s[k])
        if contact["state"] != ON or abs(away) > self.reach(k):
            self.set_down(k, push.xi, push.speed)
            away = 0.0
        first, speed = int(contact["force_first"]), push.speed + away / every  # catches up until then
        tables.force_time[first], tables.force_time[first + 1] = self.t, self.t + every
        tables.force_value[:, first], tables.force_value[:, first + 1] = push.first, push.last
        tables.speed_value[contact["speed_first"]] = speed
        contact["begin"] = float(state.s[k]) - speed * self.t

    def set_interface(self, interface_coordinate: int, height: float, rise: float) -> None:
        """Put the far end of an interface's spring somewhere, and let it go on from there."""
        self.q[interface_coordinate], self.v[interface_coordinate] = height, rise

    def reach(self, k: int) -> float:
        """How far from where it has slid to contact k may be said to be without being put down anew, m."""
        structure = self.system.structure
        return seen.SLIDES * float(structure.runs.h[structure.lines.first[self.system.contacts[k]["line"]]])

    def given(self, contacts: Iterable[int]) -> Arrays:
        """What `apply_push` writes for some contacts."""
        tables, found = self.system.tables, Arrays()
        for k in contacts:
            contact = self.system.contacts[k]
            first, at = int(contact["force_first"]), int(contact["speed_first"])
            found[f"{k}.time"] = tables.force_time[first : first + 2]
            found[f"{k}.force"] = tables.force_value[:, first : first + 2]
            found[f"{k}.speed"] = tables.speed_value[at : at + 1]
        return found

    def stored(self, line: carrier.CarrierLine) -> Tree:
        """A line of `frozen` as data."""
        assert isinstance(line, SystemLine)
        return {"r": line.r.copy(), "v": line.v.copy(), "kinks": copied(line.kinks)}

    def frozen(self, k: int, tree: Tree | None = None) -> SystemLine:
        """The line of contact k as it is now, or as it was when `stored` gave a tree, to be looked at later."""
        line = self.line(k)
        if tree is None:
            return replace(line, r=line.r.copy(), v=line.v.copy())
        return replace(line, **copied(tree))

    def copy(self) -> SystemCarrier:
        """A twin that may go its own way."""
        return replace(self, system=self.system.copy())

    def go_on(self, h: float) -> None:
        """Move a twin on by h seconds, or up to where somebody is to be asked."""
        self.system.settle()
        self.go_far(self.t + h, alone=False)

    def go_far(self, end: float, *, alone: bool) -> int:
        """Go on to a time in s, by shorter steps where tensions of inextensible lines ask for them."""
        while (status := self._go(end, alone)[0]) == motion.TOO_LONG:
            pass
        return status

    def _go(self, end: float, alone: bool = False) -> tuple[int, int]:
        """Go on to a time in s, or until steps are too long for the tensions: they are shorter from then on."""
        status, steps = self.system.go(end, self.longest, alone, self.advance)
        self.steps += steps
        if status == motion.TOO_LONG:
            tight = self.system.buffers.tight
            assert tight is not None
            fit = float(np.sqrt(tight.time[3] / tight.time[2]))
            if not fit > WILD * self.longest:
                return motion.NOT_FINITE, steps
            self.longest = SHORTER * min(self.longest, fit)
            if end - self.t <= NEAR * self.longest:
                self.system.state.t[0], status = end, motion.RUNNING
        return status, steps

    def go(self, end: float) -> int:
        """Go on to a time in s where nobody is asked on the way; returns what has come of it."""
        status = motion.RUNNING
        for until in self.system.segments(end):
            status = self.go_far(until, alone=True)
            if status != motion.RUNNING:
                break
        return status

    def to(self, end: float) -> int:
        """Go on to a time in s, or until a leg lands or takes off; returns what has come of it.

        When it does is found by going back to before the step in which it has, and making that shorter.
        """
        system = self.system
        if (gap := system.gap()) <= 0.0:
            return motion.ASKED
        while True:
            before, begin = {} if gap == np.inf else copied(system.changing()), self.t
            status, steps = self._go(end)
            if status != motion.TOO_LONG:
                break
        if status != motion.ASKED:
            return status
        low, high, high_gap, side = 0.0, (self.t - begin) / steps, system.gap(), 0
        if steps > 1:
            then = self.t - high
            system.put(before)
            system.go(then, self.longest)
            before, begin = copied(system.changing()), then
        system.put(before)
        low_gap = system.gap()
        for _ in range(TRIES):  # Illinois variant of the false position
            part = low_gap / (low_gap - high_gap) if low_gap > 0.0 else 1.0
            tau = low + (high - low) * min(max(part, 1e-3), 1.0)
            system.put(before)
            system.go(begin + tau, self.longest)
            found = system.gap()
            if -CLOSE <= found <= 0.0 or (found <= 0.0 and tau - low < 1e-12 * begin):
                break
            if found > 0.0:
                low, low_gap, high_gap = tau, found, 0.5 * high_gap if side > 0 else high_gap
                side = 1
            else:
                high, high_gap, low_gap = tau, found, 0.5 * low_gap if side < 0 else low_gap
                side = -1
        return motion.ASKED
