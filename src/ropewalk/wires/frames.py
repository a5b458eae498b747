"""Frames of a run on wires."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.foreign.turns import TravelEndedError, Turns
from ropewalk.model.run import common_interval
from ropewalk.results.exchanges import exchanged, exchanging
from ropewalk.results.frame import IN_AIR, MOVES, OFF_LINE, Account, Frame, Layout
from ropewalk.wires.bearing import at_rest_together
from ropewalk.wires.beginning import along_moved, on_moved, small_under_loads
from ropewalk.wires.drive import ON_WIRE, Drive, Record
from ropewalk.wires.energy import Audit
from ropewalk.wires.equilibrium import Potential
from ropewalk.wires.journey import drive_of
from ropewalk.wires.large import LargeMotion
from ropewalk.wires.layout import axes_of, layout_of
from ropewalk.wires.mesh import riders_of
from ropewalk.wires.partners import SLIDES, Foreigner, Partner
from ropewalk.wires.plan import Array
from ropewalk.wires.rest import Rest, rows, vertical_stiffness
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


class Run:
    """A run under way: its layout, and its frames one after the other.

    Args:
        task: what is computed.
        times: output instants in s, from 0.
        account: filled in.
        sample: interval of samples in s; a part of the interval of outputs is taken that is no longer.
        step: largest step in s; None: as large as is stable.

    Raises:
        RopewalkError: there is no rest to begin with.
    """

    def __init__(
        self, task: Task, times: Array, account: Account, sample: float = SAMPLE, step: float | None = None
    ) -> None:
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
        interval = float(np.diff(times).max()) if times.size > 1 else sample
        self._axes = axes_of(task)
        self.turns = [
            foreigner.turns(len(self._axes), SLIDES * start.mesh.strands.h.max()) for foreigner in task.foreigners
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
            self._stiffness = vertical_stiffness(self.mesh)
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
        self._audit = Audit(self.mesh, self.riders, self.motion, start.position, start.unstrained)
        self._in_air = np.zeros(self.riders.owner.size)
        self._steep, self._pushed = set[str](), set[str]()  # contacts and wires that have been doubted
        self._partners = [self._partner(*pair) for pair in zip(task.foreigners, self.turns, strict=True)]
        watched = rows(self.motion.watched, self.mesh.nodes) @ self._at_rest[2]
        self._watched_at_rest = watched if start.rest is None else np.zeros_like(watched)

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

    def _doubt_shape(self, frame: Frame) -> None:
        """Loads on steep lines, and compression that no bending stiffness bears on the mesh."""
        if not isinstance(self.motion, LargeMotion):
            return
        strands, last, z, x = self.mesh.strands, 0, frame.position[:, -1], frame.position[:, 0]
        for k in np.flatnonzero((frame.contact_state != OFF_LINE) & (self.riders.size[self.riders.owner] > 0)):
            a = int(self.riders.wire[k])
            seat = seat_at(self.mesh, a, float(frame.contact_xi[k]) / float(strands.h[a]))
            slope = abs(float(seat.slope(z))) / max(abs(float(seat.slope(x))), 1e-300)
            name, wire = self.task.contacts[k], self.task.plan.wires[a].name
            if slope > _STEEP and name not in self._steep:
                self._steep.add(name)
                self.account.doubt(
                    f"load {name} rides where {wire} slopes by {slope:.2g}, at t = {frame.path:.4g} s",
                    "on lines with bending stiffness a load moves up and down only, its inertia along them is left out",
                    f"lines.{wire}.bending_stiffness", "leave it out, if the line is a rope",
                )  # fmt: skip
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

    def _partner(self, foreigner: Foreigner, turns: Turns) -> Partner:
        columns = np.flatnonzero(self.riders.owner == foreigner.journey)
        return Partner(
            turns, range(int(columns[0]), int(columns[-1]) + 1), int(self.riders.wire[columns[0]]), self.mesh,
            self.motion, self._axes, lambda drive: self.motion.go(drive, self.steps), self.sample,
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

    def frames(self) -> Iterator[Frame]:
        """The frames; a run that blows up ends with the last one before, and the account says so."""
        with exchanging(self.turns, self.account):
            for frame in self._frames():
                yield exchanged(frame, self.turns, self.account)

    def _frames(self) -> Iterator[Frame]:
        contacts = len(self.task.contacts)
        plan = self.task.plan
        nothing = Record.of(self.rows, self.riders, len(plan.ties), len(plan.holds), self.motion.watched).turned()
        before = np.full((self.rows, contacts), np.nan), Record(*(np.full_like(array, np.nan) for array in nothing))
        for i, t in enumerate(self.times):
            count = max(1, round((self.times[i + 1] - t) / self.sample)) if i + 1 < self.times.size else 1
            drive = self._drive(float(t), count)
            frame = self._picture(float(t), drive)
            try:
                record = self._go(float(t), drive)
            except RopewalkError as error:
                self.account.outcome = "travel ended" if isinstance(error, TravelEndedError) else "load failed"
                self.account.advice = f"stopped after t = {t:.6g} s: {error}"
                if i:
                    yield self._with_forces(frame, drive, nothing, *before)
                    return
                raise
            frame = self._with_forces(frame, drive, record, *before)
            self._doubt_shape(frame)
            yield frame
            if not self._is_sane():
                self.account.outcome, self.account.advice = "diverged", self._advice(float(t))
                return
            self.account.steps += count * self.steps if i + 1 < self.times.size else 0
            on = np.where(drive.where[:-1] == ON_WIRE, drive.station[:-1], np.nan)
            before = _padded(on, self.rows), Record(*(_padded(array, self.rows) for array in record))

    def _go(self, t: float, drive: Drive) -> Record:
        """Go on by the rows of a drive from t in s; foreign models are asked when it is time, and fill in theirs."""
        if not self._partners:
            return self.motion.go(drive, self.steps)
        parts, row, rows = [], 0, drive.station.shape[0] - 1
        first = round(t / self.sample)
        while row < rows:
            now = t + row * self.sample
            for partner in self._partners:
                if partner.rows_left(first + row) == partner.rows:
                    partner.exchange(now, partial(self._drive, now, partner.rows))
            end = min(rows, row + min(partner.rows_left(first + row) for partner in self._partners))
            piece = drive.rows(row, end)
            for partner in self._partners:
                partner.fill(piece, (first + row) % partner.rows)
            parts.append(self.motion.go(piece, self.steps))
            row = end
        return Record(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))

    def _drive(self, t: float, count: int) -> Drive:
        return drive_of(self.task.plan, self.task.journeys, t + self.sample * np.arange(count + 1.0))

    def _is_sane(self) -> bool:
        moved = self.motion.position - self._at_rest
        longest = max(wire.length for wire in self.task.plan.wires)
        return bool(np.isfinite(moved).all() and np.abs(moved).max() < _ESCAPED * longest)

    def _advice(self, t: float) -> str:
        what = f"after t = {t:.6g} s the motion grew beyond all bounds; "
        if self.account.step > self._stable:
            what += f"its step of {self.account.step:.3g} s is larger than the stable one of {self._stable:.3g} s: "
            return what + "write a smaller run.step, or leave it out"
        return what + "write a smaller run.step, and check masses, stiffnesses and what travels"

    def _picture(self, t: float, drive: Drive) -> Frame:
        """All of a frame but the forces of contacts and ties, which the next step finds."""
        contacts, dim, none = len(self.task.contacts), len(self._axes), np.zeros(0)
        position, velocity = self.motion.position, self.motion.velocity
        strain = self._strain()
        EA = np.repeat([wire.axial_stiffness for wire in self.task.plan.wires], self.mesh.strands.links)
        unknown, nowhere = np.full(contacts, np.nan), np.full((contacts, dim), np.nan)
        bodies, rates = self._bodies(drive, position[self._axes].T)
        return Frame(
            path=t, position=position[self._axes].T, velocity=velocity[self._axes].T, tension=EA * strain,
            strain=strain, contact_position=nowhere, contact_force=nowhere.copy(), hold_force=nowhere.copy(),
            contact_xi=unknown, contact_speed=unknown, contact_tension=np.full((contacts, 2), np.nan),
            contact_friction=unknown, contact_state=np.full(contacts, OFF_LINE), contact_in_air=np.zeros(contacts),
            friction_power=np.zeros(contacts), body_position=bodies, body_velocity=rates,
            reaction=self._reactions(position), energy=self._audit.now(), tie_force=none, sampled_station=none,
        )  # fmt: skip

    def _with_forces(self, frame: Frame, drive: Drive, now: Record, stations: Array, before: Record) -> Frame:
        motion, on = self.motion, drive.where[0] == ON_WIRE
        station, place, force = drive.station[0], frame.contact_position.copy(), frame.contact_force.copy()
        place[on], force[on], hold = 0.0, 0.0, frame.hold_force.copy()
        hold[on] = 0.0
        place[on, -1], force[on, -1] = now.height[0, on], now.force[0, on]
        both, xi = frame.contact_tension.copy(), frame.contact_xi.copy()
        first = np.concatenate([[0], np.cumsum(self.mesh.strands.links)[:-1]])
        for k in np.flatnonzero(on):
            a = int(self.riders.wire[k])
            seat = self._seat(int(k), float(station[k]), frame.position)
            place[k, :-1] = seat.value(frame.position.T)[:-1]
            xi[k] = seat.links * self.mesh.strands.h[a]
            both[k] = frame.tension[first[a] + min(int(seat.links), int(self.mesh.strands.links[a]) - 1)]
        counted = np.where(self.riders.material, 1.0, np.abs(self.mesh.strands.across[self.riders.wire, 1]))
        in_air = self.riders.lifts & (now.force[0] == 0.0)
        self._in_air += self.sample * ((before.force == 0.0) & self.riders.lifts).sum(axis=0)
        return replace(
            frame, contact_position=place, contact_force=force, hold_force=hold, contact_tension=both,
            contact_xi=xi, contact_speed=np.where(on, counted * (drive.station[1] - station) / self.sample, np.nan),
            contact_state=np.where(on, np.where(in_air, IN_AIR, MOVES), OFF_LINE), contact_in_air=self._in_air.copy(),
            reaction=np.vstack([frame.reaction, (now.hold[0] + motion.hold_at_rest)[:, self._axes]]),
            tie_force=now.tie[0] + motion.tie_at_rest,
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
        place, speed = (np.zeros((len(self.task.shown), len(self._axes))) for _ in range(2))
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

    def _reactions(self, position: Array) -> Array:
        """Forces of the ends on their wires, (end, axis) N."""
        strands, plan = self.mesh.strands, self.task.plan
        ends = np.stack([strands.first, strands.first + strands.links], axis=1).ravel()
        if isinstance(self.motion, LargeMotion):
            force = -self._potential.pull(position)[:, ends].T
        else:
            force = np.zeros((ends.size, 3))
            force[:, 2] = (self._stiffness @ position[2] + plan.gravity * self.mesh.mass)[ends]
            force[0::2, 0], force[1::2, 0] = -strands.tension, strands.tension
        return force[:, self._axes]


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
