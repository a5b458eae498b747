"""A motion of wires, from output to output, and its frames."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np

from ropewalk.checkpoint import Tree, arrays_of, copied, put
from ropewalk.errors import RopewalkError
from ropewalk.foreign.turns import TravelEndedError, Turns
from ropewalk.mechanics.portions import portion
from ropewalk.model.run import common_interval
from ropewalk.results.frame import IN_AIR, MOVES, OFF_LINE, Account, Contacts, Frame, Layout
from ropewalk.results.running import Ending
from ropewalk.wires.bearing import at_rest_together
from ropewalk.wires.beginning import along_moved, on_moved, small_under_loads
from ropewalk.wires.drive import ON_WIRE, Drive, Record
from ropewalk.wires.energy import Energies
from ropewalk.wires.equilibrium import Potential
from ropewalk.wires.journey import drive_of
from ropewalk.wires.large import LargeMotion
from ropewalk.wires.layout import Reactions, axes_of, axial_force, layout_of
from ropewalk.wires.mesh import riders_of
from ropewalk.wires.partners import SLIDES, Foreigner, Partner
from ropewalk.wires.plan import Array
from ropewalk.wires.rest import Rest, beds, rows, vertical_stiffness
from ropewalk.wires.seat import Seat, seat_at, seat_below
from ropewalk.wires.small import SmallMotion
from ropewalk.wires.stability import largest_step, largest_step_along
from ropewalk.wires.task import Task, ready

SAMPLE = 1e-3  # s, interval of samples where none is asked for
_NOTHING = 1e-100  # m: small motion begins with a little more than nothing
_SLIGHT = 1e-9  # strain that is none
_SHALLOW = 1.0 / 8.0  # of the chord: a line that hangs further through is none of small motion
_STEEP = 0.2  # slope from which on loads miss their inertia along the line: 2 % of deflections, 10 % of contact forces
_ESCAPED = 2.0  # lengths of the longest wire: a node of a wire that is held does not get further, unless a run blows up


class Wires:
    """Wires as the engine of a motion, in their first state.

    Args:
        task: what is computed.
        times: output instants in s, from 0.
        account: filled in.
        sample: interval of samples in s (default: 1 ms, or `step`); a part of the interval of outputs is taken that is
            no longer.
        step: largest step in s; None: as large as is stable.

    Raises:
        RopewalkError: there is no rest to begin with.
    """

    looks_ahead = True

    def __init__(
        self, task: Task, times: Array, account: Account, sample: float | None = None, step: float | None = None
    ) -> None:
        sample = sample or max(SAMPLE, step or 0.0)
        self.task, start = ready(task)
        if task.with_loads and start.rest is None:
            self.task, start = at_rest_together(self.task, start)
        begun = None if task.beginning is None else task.beginning(start)
        if begun is not None:
            self.task = replace(self.task, journeys=on_moved(start, self.task.journeys, *begun))
        account.warnings += task.remarks
        self.start, self.mesh, self._at_rest = start, start.mesh, start.position
        self.account = account
        self.riders = riders_of([journey.rider for journey in self.task.journeys])
        interval = float(times[1] - times[0]) if times.size > 1 else sample  # none is longer
        self.axes, self._supports = axes_of(task), Reactions(self.mesh)
        self.turns = [
            foreigner.turns(len(self.axes), SLIDES * start.mesh.strands.h.max()) for foreigner in task.foreigners
        ]
        shared = common_interval([interval, *(partner.every for partner in self.turns)]) if self.turns else interval
        assert shared is not None
        self.sample = shared / max(1, int(np.ceil(shared / sample * (1.0 - 1e-9))))
        self.rows = round(interval / self.sample)
        self.times = _snapped(times, self.sample)
        along = largest_step_along(self.mesh, task.inertia) if start.rest is None else np.inf
        self._stable = largest_step(self.mesh, self.riders)
        if np.isinf(self.riders.spring).any():  # rigid contacts go on by the steps of axial waves
            self._stable = min(self._stable, along)
        self.steps = _parts(self.sample, self._stable if step is None else step)
        account.method, account.step = "explicit", self.sample / self.steps
        if account.step > self._stable * (1.0 + 1e-9):
            account.warnings.append(
                f"the step of {account.step:.3g} s is larger than {self._stable:.3g} s, up to which the motion is "
                "stable: it may swing without reason even where it does not grow beyond all bounds; write a smaller "
                "run.step, or leave it out"
            )
        inner = _parts(account.step, along)
        if start.rest is None:
            account.reason = "Stoermer's method for all components" + (
                f"; {inner} inner steps of the wires alone follow axial waves" if inner > 1 else ""
            )
            self._potential = Potential(self.mesh, start.unstrained)
            self.motion: LargeMotion | SmallMotion = LargeMotion(
                self.mesh, start.position, start.unstrained, self.riders, account.step, self._first("first"), inner,
                task.inertia, space=task.space,
            )  # fmt: skip
        else:
            account.reason = "Stoermer's method for small vertical motion about rest, with constant tensions"
            ends = self._supports.ends
            self._end_stiffness = vertical_stiffness(self.mesh)[ends]
            self._risen = (beds(self.mesh) * self.mesh.straight()[2])[ends]
            self._end_weight = self.task.plan.gravity * self.mesh.mass[ends]
            self._doubt_sag(start.rest)
            self.motion = SmallMotion(
                self.mesh, start.rest, self.riders, account.step, self._first("first"), task.window
            )
            if task.with_loads:
                u, journeys = small_under_loads(self.motion, self.task.journeys)
                self.task = replace(self.task, journeys=along_moved(start, journeys, u))
                self.motion.pace.q[:] = self.motion.pace.last[:] = self._first("first")
                self.motion.begin(u, np.zeros_like(u))
        if begun is not None and isinstance(self.motion, LargeMotion):
            self.motion.begin(*begun)
        elif begun is not None:
            assert isinstance(self.motion, SmallMotion)
            self.motion.begin(begun[0][2] - self.motion.level, begun[1][2])
        self.motion.pace.last[:] -= account.step * self._first("rate")
        self._energies = Energies(self.mesh, self.riders, self.motion, start.position, start.unstrained)
        self._in_air = np.zeros(self.riders.owner.size)
        # Contacts and wires that have been doubted.
        self._steep, self._pushed, self._left = set[str](), set[str](), set[str]()
        self._partners = [self._partner(*pair) for pair in zip(task.foreigners, self.turns, strict=True)]
        watched = rows(self.motion.watched, self.mesh.nodes) @ self._at_rest[2]
        self._watched_at_rest = watched if start.rest is None else np.zeros_like(watched)
        contacts = len(self.task.contacts)
        self._nothing = Record.of(
            self.rows, self.riders, len(task.plan.ties), len(task.plan.holds), self.motion.watched
        ).turned()
        self._stations = np.full((self.rows, contacts), np.nan)  # since the last frame, as is what was recorded
        self._before = Record(*(np.full_like(array, np.nan) for array in self._nothing))
        self._now: Frame | None = None
        self._failed = False

    def get_state(self) -> Tree:
        """All that changes.

        Raises:
            RopewalkError: a load is a model of somebody else's that gives no state.
        """
        return {
            "motion": self.motion.get_state(), "energies": self._energies.get_state(),
            "partners": [partner.get_state() for partner in self._partners],
            "stations": self._stations.copy(), "before": copied(arrays_of(self._before)),
            "in_air": self._in_air.copy(), "steep": sorted(self._steep), "pushed": sorted(self._pushed),
            "left": sorted(self._left),
        }  # fmt: skip

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self.motion.set_state(tree["motion"])
        self._energies.set_state(tree["energies"])
        for partner, own in zip(self._partners, tree["partners"], strict=True):
            partner.set_state(own)
        put({"stations": self._stations, "in_air": self._in_air} | arrays_of(self._before),
            {"stations": tree["stations"], "in_air": tree["in_air"]} | tree["before"])  # fmt: skip
        self._steep, self._pushed, self._left = (set(tree[key]) for key in ("steep", "pushed", "left"))

    def _doubt_sag(self, rest: Rest) -> None:
        """Small motion is about a rest that is nearly straight: nothing that sags stretches there."""
        sag = np.abs(rest.position[2] - self.mesh.straight()[2])
        for i, wire in enumerate(self.task.plan.wires):
            depth = float(sag[self.mesh.of(i)].max())
            if depth > _SHALLOW * wire.chord:
                self.account.doubt(
                    f"at rest {wire.name} hangs {depth:.3g} m through over {wire.chord:.3g} m",
                    "small motion knows no tension that grows with the sag", "run.geometry",
                    "write geometry: nonlinear, or give tension",
                )  # fmt: skip

    def remark(self, frame: Frame) -> None:
        """Doubt loads on steep lines, those thrown off wires, and compression that no bending stiffness bears."""
        self._doubt_leaving(frame)
        if self._failed or not isinstance(self.motion, LargeMotion):
            return
        strands, last, z, x = self.mesh.strands, 0, frame.position[:, -1], frame.position[:, 0]
        for k in np.flatnonzero((frame.contact_state != OFF_LINE) & (self.riders.size[self.riders.owner] > 0)):
            a = int(self.riders.wire[k])
            seat = seat_at(self.mesh, a, float(frame.contact_xi[k]) / float(strands.h[a]))
            slope = abs(float(seat.slope(z))) / max(abs(float(seat.slope(x))), 1e-300)
            name, wire = self.task.contacts[k], self.task.plan.wires[a].name
            if slope > _STEEP and name not in self._steep:
                self._steep.add(name)
                key, remedy = f"lines.{wire}.bending_stiffness", "leave it out, if the line is a rope"
                if section := wire.rpartition(".")[0]:
                    key, remedy = f"overhead_lines.{section}.contact_wire.tension", "give more of it, or a lighter load"
                self.account.doubt(
                    f"load {name} rides where {wire} slopes by {slope:.2g}, at t = {frame.path:.4g} s",
                    "on such lines a load moves up and down only, its inertia along them is left out",
                    key,
                    remedy,
                )
        for a, wire_ in enumerate(self.task.plan.wires):
            first, last = last, last + int(strands.links[a])
            pushed = -float(frame.tension[first:last].min())
            borne = np.pi**2 * wire_.bending_stiffness / float(strands.h[a]) ** 2
            if pushed > max(borne, _SLIGHT * wire_.axial_stiffness) and wire_.name not in self._pushed:
                self._pushed.add(wire_.name)
                self.account.doubt(
                    f"{wire_.name} is pushed together with {pushed:.4g} N at t = {frame.path:.4g} s",
                    f"between two nodes it bears {borne:.4g} N and buckles beyond, into waves that no mesh resolves",
                    f"lines.{wire_.name}.bending_stiffness",
                    "leave it out and write law: {kind: tension_only}, or give more drag",
                )  # fmt: skip

    def _doubt_leaving(self, frame: Frame) -> None:
        """At the fixed end of a string the path of a mass jumps, however slow it is: the mesh bounds its force."""
        for k in np.flatnonzero((frame.contact_state == OFF_LINE) & np.isinf(self.riders.spring)):
            journey, wire = self.task.journeys[self.riders.owner[k]], self.task.plan.wires[self.riders.wire[k]]
            begin, name = float(journey.place(np.zeros(1))[0] - self.riders.behind[k]), self.task.contacts[k]
            if "." in wire.name and name not in self._left and 0.0 <= begin <= wire.length:
                self._left.add(name)
                self.account.doubt(
                    f"load {name} left {wire.name} at t = {frame.path:.4g} s on a rigid wheel",
                    "close to the end of a wire the force of such a wheel grows without bounds with finer links",
                    f"loads.{name.partition('.')[0]}", "give it a contact_stiffness, or end the run before",
                )  # fmt: skip

    def _partner(self, foreigner: Foreigner, turns: Turns) -> Partner:
        columns = np.flatnonzero(self.riders.owner == foreigner.journey)
        return Partner(
            turns, range(int(columns[0]), int(columns[-1]) + 1), int(self.riders.wire[columns[0]]), self.mesh,
            self.motion, self.axes, lambda drive: self.motion.go(drive, self.steps), self.sample,
        )  # fmt: skip

    def _first(self, what: Literal["first", "rate"]) -> Array:
        """Coordinates of all riders at the beginning, (rider, C) m; or their rates, m/s."""
        first = np.zeros(self.riders.mass.shape[:2])
        for i, journey in enumerate(self.task.journeys):
            own = getattr(journey, what)
            first[i, : own.size] = own
        return first

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the result."""
        sample = tuple(self.sample * (np.arange(self.rows) - self.rows))
        foreign = tuple(partner.name for partner in self.turns)
        return layout_of(self.task, self.mesh, foreign=foreign, sample=sample)

    def advance(self, i: int) -> Ending | None:
        """Look at output instant i, and go on to the next one: forces at an instant are those of the step after it."""
        t, final = float(self.times[i]), i == self.times.size - 1
        count = 1 if final else max(1, round((self.times[i + 1] - t) / self.sample))
        drive = self._drive(t, count)
        picture = self._picture(t, drive)
        try:
            record = self._go(t, drive)
        except RopewalkError as error:
            if not i:
                raise
            self._now, self._failed = self._with_forces(*picture, drive, self._nothing), True
            outcome = "travel ended" if isinstance(error, TravelEndedError) else "load failed"
            return Ending(outcome, f"stopped after t = {t:.6g} s: {error}")
        self._now = self._with_forces(*picture, drive, record)
        on = np.where(drive.where[:-1] == ON_WIRE, drive.station[:-1], np.nan)
        self._stations = _padded(on, self.rows)
        self._before = Record(*(_padded(each, self.rows) for each in record))
        self.account.steps += 0 if final else count * self.steps
        return None if self.is_sane() else Ending("diverged", self._advice(t))

    def frame(self) -> Frame | None:
        """That of the instant looked at last."""
        return self._now

    def _go(self, t: float, drive: Drive) -> Record:
        """Go on by the rows of a drive from t in s; foreign models are asked when it is time, and fill in theirs."""
        parts, row, rows = [], 0, drive.station.shape[0] - 1
        most = portion(self.mesh.nodes, self.steps)
        first = round(t / self.sample)
        while row < rows:
            now = t + row * self.sample
            for partner in self._partners:
                if partner.rows_left(first + row) == partner.rows:
                    partner.exchange(now, partial(self._drive, now, partner.rows))
            end = min([rows, row + most, *(row + partner.rows_left(first + row) for partner in self._partners)])
            piece = drive.rows(row, end)
            for partner in self._partners:
                partner.fill(piece, (first + row) % partner.rows)
            parts.append(self.motion.go(piece, self.steps))
            row = end
        return parts[0] if len(parts) == 1 else Record(*(np.concatenate(each) for each in zip(*parts, strict=True)))

    def _drive(self, t: float, count: int) -> Drive:
        return drive_of(self.task.plan, self.task.journeys, t + self.sample * np.arange(count + 1.0))

    def is_sane(self) -> bool:
        """Whether no node has got further away than a wire that is held can."""
        moved = self.motion.position - self._at_rest
        longest = max(wire.length for wire in self.task.plan.wires)
        return bool(np.isfinite(moved).all() and np.abs(moved).max() < _ESCAPED * longest)

    def _advice(self, t: float) -> str:
        what = f"after t = {t:.6g} s the motion grew beyond all bounds; "
        if self.account.step > self._stable:
            what += f"its step of {self.account.step:.3g} s is larger than the stable one of {self._stable:.3g} s: "
            return what + "write a smaller run.step, or leave it out"
        return what + "write a smaller run.step, and check masses, stiffnesses and what travels"

    def _picture(self, t: float, drive: Drive) -> tuple[Frame, Contacts]:
        """All of a frame but contacts, which are to be filled in, and ties: the next step finds their forces."""
        position, velocity, strain = self.motion.position, self.motion.velocity, self._strain()
        EA = np.repeat([wire.axial_stiffness for wire in self.task.plan.wires], self.mesh.strands.links)
        bodies, rates = self._bodies(drive, position[self.axes].T)
        seen, tension = Contacts(len(self.task.contacts), len(self.axes)), EA * strain
        if isinstance(self.motion, LargeMotion):
            tension = axial_force(self.mesh, tension, position)
        frame = Frame(
            path=t, position=position[self.axes].T, velocity=velocity[self.axes].T, tension=tension,
            strain=strain, **seen.told(), body_position=bodies,
            body_velocity=rates, reaction=np.zeros(0), energy=self._energies.now(),
        )  # fmt: skip
        return frame, seen

    def _with_forces(self, frame: Frame, seen: Contacts, drive: Drive, now: Record) -> Frame:
        motion, on, before, stations = self.motion, drive.where[0] == ON_WIRE, self._before, self._stations
        station, tie = drive.station[0], now.tie[0] + self.motion.tie_at_rest
        seen.position[on], seen.force[on], seen.hold[on] = 0.0, 0.0, 0.0
        seen.position[on, -1], seen.force[on, -1] = now.height[0, on], now.force[0, on]
        first = np.concatenate([[0], np.cumsum(self.mesh.strands.links)[:-1]])
        for k in np.flatnonzero(on):
            a = int(self.riders.wire[k])
            seat = self._seat(int(k), float(station[k]), frame.position)
            seen.position[k, :-1] = seat.value(frame.position.T)[:-1]
            seen.xi[k] = seat.links * self.mesh.strands.h[a]
            seen.tension[k] = frame.tension[first[a] + min(int(seat.links), int(self.mesh.strands.links[a]) - 1)]
        counted = np.where(self.riders.material, 1.0, np.abs(self.mesh.strands.across[self.riders.wire, 1]))
        in_air = self.riders.lifts & (now.force[0] == 0.0)
        self._in_air += self.sample * ((before.force == 0.0) & self.riders.lifts).sum(axis=0)
        seen.speed[on] = (counted * (drive.station[1] - station) / self.sample)[on]
        seen.state[on], seen.in_air[:] = np.where(in_air, IN_AIR, MOVES)[on], self._in_air
        return replace(
            frame, reaction=self.reactions(motion.hold_at_rest + now.hold[0], tie, position=frame.position),
            tie_force=tie,
            sampled_station=stations, sampled_force=before.force,
            sampled_height=before.height, sampled_tie_force=before.tie + motion.tie_at_rest,
            sampled_uplift=np.where(np.abs(before.watched) < _NOTHING, 0.0, before.watched - self._watched_at_rest),
        )  # fmt: skip

    def _strain(self) -> Array:
        strands = self.mesh.strands
        if isinstance(self.motion, LargeMotion):
            strain = self.motion.strain()
            return np.concatenate([strain[i : i + n] for i, n in zip(strands.first, strands.links, strict=True)])
        return np.repeat([wire.tension / wire.axial_stiffness for wire in self.task.plan.wires], strands.links)

    def _seat(self, k: int, station: float, position: Array) -> Seat:
        """Where contact k is on its wire, whose nodes are at positions (node, axis); beyond an end, at the end."""
        a, strands = int(self.riders.wire[k]), self.mesh.strands
        inside = min(max(station, 0.0), self.task.plan.wires[a].length)
        if isinstance(self.motion, LargeMotion) and not self.riders.material[k]:
            begin, along = strands.across[a]
            return seat_below(self.mesh, a, position[:, 0], float(begin + along * inside))
        return seat_at(self.mesh, a, inside / float(strands.h[a]))

    def _bodies(self, drive: Drive, position: Array) -> tuple[Array, Array]:
        place, speed = (np.zeros((len(self.task.shown), len(self.axes))) for _ in range(2))
        pace, last = self.motion.pace, drive.station.shape[0] - 1
        for i, body in enumerate(self.task.shown):
            k = int(np.flatnonzero(self.riders.owner == body.journey)[body.wheel])
            a, n = int(self.riders.wire[k]), body.row.size
            q, moved = pace.q[body.journey, :n], pace.q[body.journey, :n] - pace.last[body.journey, :n]
            along, length = float(self.mesh.strands.across[a, 1]), self.task.plan.wires[a].length
            station = [float(drive.station[row, k]) for row in (0, min(1, last))]
            beyond = [s - min(max(s, 0.0), length) for s in station]
            x = [
                self._seat(k, s, position).value(position.T)[0] + along * b
                for s, b in zip(station, beyond, strict=True)
            ]
            place[i, 0], place[i, -1] = x[0] + np.sign(along) * body.ahead, body.base + body.row @ q
            speed[i, 0], speed[i, -1] = (x[1] - x[0]) / self.sample, body.row @ moved / pace.step
        return place, speed

    def holds_at_first(self) -> Array:
        """Forces of all holds on their wires at the beginning, (hold, 3) N."""
        if not isinstance(self.motion, LargeMotion):
            return self.motion.hold_at_rest
        node = self.mesh.holds.node
        at_ends = -self._potential.bare_pull(self._at_rest)[:, np.maximum(node, 0)].T
        return np.where((node < 0)[:, None], self._potential.hold_forces(self._at_rest), at_ends)

    def ties_at_first(self) -> Array:
        """Forces of all ties at the beginning, (tie,) N."""
        is_large = isinstance(self.motion, LargeMotion)
        return self._potential.tie_forces(self._at_rest) if is_large else self.motion.tie_at_rest

    def reactions(self, hold: Array, tie: Array, position: Array | None = None) -> Array:
        """Forces of all that holds wires on them, (support, axis) N.

        Args:
            hold: (hold, 3) N, those of holds.
            tie: (tie,) N, those of ties.
            position: (node, axis) m; None: of now.
        """
        strands, supports, r = self.mesh.strands, self._supports, self.motion.position
        if position is not None:
            r[self.axes] = position.T
        if isinstance(self.motion, LargeMotion):
            return supports.of(self._potential.bare_pull(r)[:, supports.ends].T, hold, tie, r)[:, self.axes]
        bare = np.zeros((supports.ends.size, 3))
        bare[:, 2] = self._risen - self._end_stiffness @ r[2] - self._end_weight
        force = supports.of(bare, hold, tie, r)
        force[: 2 * strands.first.size, 0] = np.stack([-strands.tension, strands.tension], axis=1).ravel()
        return force[:, self.axes]


def _parts(whole: float, largest: float) -> int:
    """Number of equal parts that are no longer than the largest."""
    return max(1, int(np.ceil(whole / largest * (1.0 - 1e-9))))


def _snapped(times: Array, sample: float) -> Array:
    """Output instants with a last interval of whole samples."""
    out = times.copy()
    if times.size > 1:
        out[-1] = times[-2] + sample * max(1, round((times[-1] - times[-2]) / sample))
    return out


def _padded(array: Array, count: int) -> Array:
    if array.shape[0] == count:
        return array
    out = np.full((count, *array.shape[1:]), np.nan)
    out[count - array.shape[0] :] = array[:count]
    return out
