"""A motion of wires, from output to output, and its frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Literal, NamedTuple

import numpy as np

from ropewalk.checkpoint import Tree, arrays_of, copied, put
from ropewalk.errors import EquilibriumError, RopewalkError
from ropewalk.external.cosimulation_master import CosimulationMaster, TravelEndedError
from ropewalk.mechanics.portions import portion
from ropewalk.model.run import common_interval
from ropewalk.results.frame import MEAN, OFF_LINE, Layout, RunInfo
from ropewalk.results.frames import Frames, NotedInstants
from ropewalk.results.running import Ending
from ropewalk.wires.absorbing_layer import THICK
from ropewalk.wires.bearing import at_rest_together
from ropewalk.wires.beginning import along_moved, on_moved, small_under_loads
from ropewalk.wires.energy import Energies, Then
from ropewalk.wires.equilibrium import WirePotential
from ropewalk.wires.frame_arrays import Pictures, WireNote
from ropewalk.wires.large import LargeMotion
from ropewalk.wires.layout import axes_of, layout_of
from ropewalk.wires.line_doubts import LineDoubts
from ropewalk.wires.mesh import moving_loads_of
from ropewalk.wires.partners import SLIDES, WireExternalModel, WirePartner
from ropewalk.wires.plan import Array, Integers
from ropewalk.wires.prescribed_motion import inputs_of
from ropewalk.wires.rest import WiresAtRest
from ropewalk.wires.small import SmallMotion
from ropewalk.wires.small_arrays import x_of
from ropewalk.wires.stability import largest_step, largest_step_along, refuse_tiny_steps
from ropewalk.wires.step_inputs import ON_WIRE, Record, StepInputs
from ropewalk.wires.task import WireTask, ready
from ropewalk.wires.window_error import WindowMeasure, returns_after

SAMPLE = 1e-3  # s, interval of samples where none is asked for
_AHEAD = 256  # rows of what is given that are found at once
_SHALLOW = 1.0 / 8.0  # of the chord: a line that hangs further through is none of small motion
_ESCAPED = 2.0  # lengths of the longest wire: a node of a wire that is held does not get further, unless a run blows up


class _Ahead(NamedTuple):
    """What is given from one output instant up to others, found at once: that costs little more than for one."""

    first: int  # number of that instant
    begin: Integers  # where the rows of each instant begin
    given: StepInputs


class Wires:
    """Wires as the engine of a motion, in their first state.

    Args:
        task: what is computed.
        times: output instants in s, from 0.
        run_info: filled in.
        sample: interval of samples in s (default: 1 ms, or `step`); a part of the interval of outputs is taken that is
            no longer.
        step: largest step in s; None: as large as is stable.

    Raises:
        RopewalkError: there is no rest to begin with.
    """

    looks_ahead, together = True, True

    def __init__(
        self, task: WireTask, times: Array, run_info: RunInfo, sample: float | None = None, step: float | None = None
    ) -> None:
        sample = sample or max(SAMPLE, step or 0.0)
        self.task, start = ready(task)
        if task.with_loads and start.rest is None:
            self.task, start = at_rest_together(self.task, start)
        begun = None if task.beginning is None else task.beginning(start)
        if begun is not None:
            self.task = replace(self.task, prescribed_motions=on_moved(start, self.task.prescribed_motions, *begun))
        run_info.warnings += task.diagnostics
        self.start, self.mesh, self._at_rest = start, start.mesh, start.position
        self.run_info = run_info
        if self.mesh.strands.fourth.all():
            run_info.curvature = MEAN
        self.moving_loads = moving_loads_of(
            [prescribed_motion.moving_load for prescribed_motion in self.task.prescribed_motions]
        )
        interval = float(times[1] - times[0]) if times.size > 1 else sample  # none is longer
        self.axes, potential = axes_of(task), None
        self.cosimulation = [
            external_model.cosimulation(len(self.axes), SLIDES * start.mesh.strands.h.max())
            for external_model in task.external_models
        ]
        shared = (
            common_interval([interval, *(partner.every for partner in self.cosimulation)])
            if self.cosimulation
            else interval
        )
        assert shared is not None
        self.sample = shared / max(1, int(np.ceil(shared / sample * (1.0 - 1e-9))))
        self.rows = round(interval / self.sample)
        self.times = _snapped(times, self.sample)
        # Rows from each output instant to the next one.
        self._counts = [*(max(1, round(float(each) / self.sample)) for each in np.diff(self.times)), 1]
        along = largest_step_along(self.mesh, task.inertia) if start.rest is None else np.inf
        self._stable = largest_step(self.mesh, self.moving_loads, along=start.rest is None)
        if np.isinf(self.moving_loads.spring).any():  # rigid contacts go on by the steps of axial waves
            self._stable = min(self._stable, along)
        self.steps = _parts(self.sample, self._stable if step is None else step)
        run_info.method, run_info.step = "explicit", self.sample / self.steps
        if run_info.step > self._stable * (1.0 + 1e-9):
            run_info.warnings.append(
                f"the step of {run_info.step:.3g} s is larger than {self._stable:.3g} s, up to which the motion is "
                "stable: spurious vibrations are possible even if they do not grow without bounds; write a smaller "
                "run.step, or leave it out"
            )
        inner = _parts(run_info.step, along)
        refuse_tiny_steps(self.mesh, self.steps * inner, self.sample)
        if start.rest is None:
            run_info.reason = "Stoermer's method for all components" + (
                f"; {inner} inner steps of the wires alone follow axial waves" if inner > 1 else ""
            )
            potential = WirePotential(self.mesh, start.unstrained)
            self.motion: LargeMotion | SmallMotion = LargeMotion(
                self.mesh, start.position, start.unstrained, self.moving_loads, run_info.step, self._first("first"),
                inner, task.inertia, space=task.space, window=task.window, hold_at_rest=self._hold_forces(potential),
            )  # fmt: skip
        else:
            run_info.reason = (
                "Stoermer's method for vertical motion linearised about equilibrium, with constant tensions"
            )
            self._doubt_sag(start.rest)
            self.motion = SmallMotion(
                self.mesh, start.rest, self.moving_loads, run_info.step, self._first("first"), task.window
            )
            if task.with_loads:
                u, prescribed_motions = small_under_loads(self.motion, self.task.prescribed_motions)
                self.task = replace(self.task, prescribed_motions=along_moved(start, prescribed_motions, u))
                self.motion.stepping.q[:] = self.motion.stepping.last[:] = self._first("first")
                self.motion.begin(u, np.zeros_like(u))
        if begun is not None and isinstance(self.motion, LargeMotion):
            self.motion.begin(*begun)
        elif begun is not None:
            assert isinstance(self.motion, SmallMotion)
            self.motion.begin(begun[0][2] - self.motion.level, begun[1][2])
        self.motion.stepping.last[:] -= run_info.step * self._first("rate")
        self._width = task.window  # m
        if np.isfinite(task.window):
            self._open_window()
        self._doubts, self._left = LineDoubts(self.task, self.mesh, self.moving_loads, run_info), set[str]()
        self._partners = [self._partner(*pair) for pair in zip(task.external_models, self.cosimulation, strict=True)]
        self._pictures = Pictures(
            self.task, self.mesh, self.moving_loads, self.motion, self.sample, potential,
            Energies(self.mesh, self.moving_loads, self.motion, start.position, start.unstrained),
        )  # fmt: skip
        self._potential, self._ahead = potential, _Ahead(0, np.zeros(1, dtype=np.int64), self._inputs(0.0, 1))
        contacts = len(self.task.contacts)
        self._nothing = Record.of(
            self.rows, self.moving_loads, len(task.plan.ties), len(task.plan.holds), self.motion.watched
        ).turned()
        self._stations = np.full((self.rows, contacts), np.nan)  # since the last frame, as is what was recorded
        self._before = Record(*(np.full_like(array, np.nan) for array in self._nothing))
        self._now: WireNote | None = None
        self._escaped = _ESCAPED * max(wire.length for wire in task.plan.wires)  # m
        self._failed, self._one_by_one = False, 0  # the instant before which none are gone through

    def get_state(self) -> Tree:
        """All that changes.

        Raises:
            RopewalkError: a load is an external model that gives no state.
        """
        return {
            "motion": self.motion.get_state(), "width": self._width, **self._pictures.get_state(),
            "partners": [partner.get_state() for partner in self._partners],
            "stations": self._stations.copy(), "before": copied(arrays_of(self._before)),
            **self._doubts.get_state(), "left": sorted(self._left),
        }  # fmt: skip

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        if tree["width"] != self._width:  # found for a run of another length
            self._width = tree["width"]
            self.motion.set_window(self._width)
        self.motion.set_state(tree["motion"])
        self._pictures.set_state(tree)
        for partner, own in zip(self._partners, tree["partners"], strict=True):
            partner.set_state(own)
        put({"stations": self._stations} | arrays_of(self._before), {"stations": tree["stations"]} | tree["before"])
        self._doubts.set_state(tree)
        self._left = set(tree["left"])

    def _open_window(self) -> None:
        """Let only what is around contacts move; find how wide that must be, if it is asked for, and its error."""
        task, run_info, until = self.task, self.run_info, float(self.times[-1])
        end, s = np.array([0.0, until]), self.mesh.strands
        speeds = [abs(float(np.diff(own.place(end))[0])) / max(until, 1e-300) for own in task.prescribed_motions]
        c = float(np.sqrt(np.maximum(s.tension, 0.0) / s.rho).max())
        returns = returns_after(c, speeds)
        width, error = task.window, None
        if not task.external_models and task.prescribed_motions:
            measure = WindowMeasure(
                self.motion, self._inputs, self.sample, self.rows, self.steps, until, returns, max(speeds)
            )
            if task.accuracy is None:
                error = measure.of(width)
            else:
                width, error = measure.enough(width, task.accuracy, float((s.h * s.links).max()))
            self._width = width
            self.motion.set_window(width)
        self._refuse_what_tears_at_rest()
        back = "no wave returns from its boundaries"
        if np.isfinite(returns):
            back = f"waves return from its boundaries after {width * returns:.3g} s"
        moves = f"{width:g} m around contacts move, {back}" if np.isfinite(width) else "all moves"
        run_info.reason += f"; {moves}"
        if error is not None:
            run_info.window = {"window": width, "window_height_error": error.height, "window_force_error": error.force}
            run_info.reason += (
                f"; estimated difference from the whole line: {1e3 * error.height:.2g} mm under contacts, and "
                f"{error.force:.2g} N of their forces up to 20 Hz, rms"
            )

    def _refuse_what_tears_at_rest(self) -> None:
        """What bears more than its strength at rest tears at once, all along the line, where nothing could respond."""
        ties, force = self.task.plan.ties, self.motion.tie_at_rest
        torn = [i for i, tie in enumerate(ties) if force[i] > tie.strength]
        if torn:
            worst = max(torn, key=lambda i: float(force[i] / ties[i].strength))
            raise EquilibriumError(
                f"run.window: {len(torn)} droppers bear more than their strength of {ties[worst].strength:g} N in "
                f"equilibrium, {ties[worst].name} {force[worst]:.4g} N: they tear at once, and beyond a window nothing "
                "moves that could take over; leave run.window out, or give a larger strength"
            )

    def _doubt_sag(self, rest: WiresAtRest) -> None:
        """Small motion is about a rest that is nearly straight: nothing that sags stretches there."""
        sag = np.abs(rest.position[2] - self.mesh.straight()[2])
        for i, wire in enumerate(self.task.plan.wires):
            depth = float(sag[self.mesh.of(i)].max())
            if depth > _SHALLOW * wire.chord:
                self.run_info.doubt(
                    f"in equilibrium {wire.name} sags {depth:.3g} m over a span of {wire.chord:.3g} m",
                    "linearised motion neglects the increase of tension with sag", "run.geometry",
                    "write geometry: nonlinear, or give tension",
                )  # fmt: skip

    def _doubt_leaving(self, frames: Frames) -> None:
        """At the fixed end of a string the path of a mass jumps, however slow it is: the mesh bounds its force."""
        for k in np.flatnonzero(np.isinf(self.moving_loads.spring)):
            prescribed_motion, wire = (
                self.task.prescribed_motions[self.moving_loads.owner[k]],
                self.task.plan.wires[self.moving_loads.wire[k]],
            )
            begin, name = (
                float(prescribed_motion.place(np.zeros(1))[0] - self.moving_loads.behind[k]),
                self.task.contacts[k],
            )
            left = frames.of["contact_state"][:, k] == OFF_LINE
            if "." in wire.name and name not in self._left and 0.0 <= begin <= wire.length and left.any():
                self._left.add(name)
                self.run_info.doubt(
                    f"load {name} left {wire.name} at t = {frames.path[left.argmax()]:.4g} s on a rigid wheel",
                    "close to the end of a wire the force of such a wheel grows without bounds with finer links",
                    f"loads.{name.partition('.')[0]}", "give it a contact_stiffness, or end the run before",
                )  # fmt: skip

    def _partner(self, external_model: WireExternalModel, cosimulation: CosimulationMaster) -> WirePartner:
        columns = np.flatnonzero(self.moving_loads.owner == external_model.prescribed_motion)
        return WirePartner(
            cosimulation, range(int(columns[0]), int(columns[-1]) + 1), int(self.moving_loads.wire[columns[0]]),
            self.mesh,
            self.motion, self.axes, lambda inputs: self.motion.go(inputs, self.steps), self.sample,
        )  # fmt: skip

    def _first(self, what: Literal["first", "rate"]) -> Array:
        """Coordinates of all moving loads at the beginning, (moving load, C) m; or their rates, m/s."""
        first = np.zeros(self.moving_loads.mass.shape[:2])
        for i, prescribed_motion in enumerate(self.task.prescribed_motions):
            own = getattr(prescribed_motion, what)
            first[i, : own.size] = own
        return first

    @property
    def layout(self) -> Layout:
        """Names and coordinates of the result."""
        sample = tuple(self.sample * (np.arange(self.rows) - self.rows))
        external = tuple(partner.name for partner in self.cosimulation)
        return layout_of(self.task, self.mesh, external=external, sample=sample)

    def advance(self, i: int, most: int = 1) -> Ending | None:
        """Look at output instant i, and go on to the next one: forces at an instant are those of the step after it.

        The same for those that follow, if nobody need look in between.
        """
        self._now = None
        count = self._count_through(i, most)
        if count > 1 and self._go_through(i, count):
            return None
        t, final = float(self.times[i]), i == self.times.size - 1
        inputs, then, failed = self._inputs_from(i), Then.of(self.motion), self.motion.failed.copy()
        try:
            record = self._go(t, inputs)
        except RopewalkError as error:
            if not i:
                raise
            self._failed = True
            self._now = self._noted(np.array([t]), then, inputs.together(), self._nothing.together())
            outcome = "travel ended" if isinstance(error, TravelEndedError) else "load failed"
            return Ending(outcome, f"stopped after t = {t:.6g} s: {error}")
        self._tell_of_failures(failed)
        on = np.where(inputs.where[:-1] == ON_WIRE, inputs.station[:-1], np.nan)
        self._now = self._noted(np.array([t]), then, inputs.together(), record.together())
        self._stations = _padded(on, self.rows)
        self._before = Record(*(_padded(each, self.rows) for each in record))
        self.run_info.steps += 0 if final else on.shape[0] * self.steps
        return None if self.is_sane() else Ending("diverged", self._advice(t))

    def _count_through(self, i: int, most: int) -> int:
        """How many intervals of samples lie ahead that need not be looked at one by one."""
        looks = self._width < np.inf or bool(self._partners)
        if i < self._one_by_one or looks or self.rows > portion(self.mesh.nodes, self.steps):
            return 1
        ahead = self._counts[i : i + min(most, self.times.size - 1 - i)]
        return next((k for k, rows in enumerate(ahead) if rows != self.rows), len(ahead))

    def _go_through(self, i: int, count: int) -> bool:
        """Look at some output instants, and go on to that after the last of them.

        Returns:
            Whether the motion has come there; if it has grown beyond bounds, it is where it was, to be looked at.
        """
        motion, times, failed = self.motion, self.times[i : i + count], self.motion.failed.copy()
        before, instants = motion.get_state(), times[:, None] + self.sample * np.arange(self.rows + 1.0)
        inputs = inputs_of(self.task.plan, self.task.prescribed_motions, instants.ravel()).together(count)
        both, notes = np.empty((count, *np.shape(motion.both))), motion.empty_notes(count)
        record = motion.through(inputs, self.steps, both, notes)
        if not self._are_sane(np.concatenate([both[1:, 0], motion.both[0][None]])):
            motion.set_state(before)
            self._one_by_one = i + count
            return False
        self._tell_of_failures(failed)
        self._now = self._noted(times, Then.noted(motion, both, notes), inputs, record)
        self.run_info.steps += count * self.rows * self.steps
        return True

    def _noted(self, t: Array, then: Then, inputs: StepInputs, record: Record) -> WireNote:
        """Notes of some instants, which come first, at t in s, with what has been recorded since the one before."""
        stations, before = self._stations[None], self._before.together()
        if t.size > 1:  # all of them have as many rows
            on = np.where(inputs.where[:, :-1] == ON_WIRE, inputs.station[:, :-1], np.nan)
            stations = np.concatenate([stations, on[:-1]])
            before = Record(*(np.concatenate([old, new[:-1]]) for old, new in zip(before, record, strict=True)))
            self._stations, self._before = on[-1].copy(), Record(*(array[-1].copy() for array in record))
        return WireNote.of(t, then, inputs, record, stations, before)

    def _tell_of_failures(self, before: Array) -> None:
        """Say which ties have failed since they were as before."""
        now = self.motion.failed
        for i in sorted(np.flatnonzero(now[:, 0] < before[:, 0]), key=lambda i: float(now[i, 0])):
            (t, force), tie = now[i], self.task.plan.ties[i]
            self.run_info.warnings.append(f"at t = {t:.4g} s {tie.name} failed under {force:.4g} N")
            if self._width < np.inf and t < tie.fails_at:
                self._doubt_tearing(int(i), float(t))

    def _doubt_tearing(self, i: int, t: float) -> None:
        """What tears far from the contacts of a window may go on tearing beyond its border: there nothing is torn."""
        inputs, ties = self._inputs(t, 1), self.mesh.ties.one
        on = inputs.where[0] == ON_WIRE
        x = x_of(self.mesh, self.moving_loads.wire[on], inputs.station[0, on])
        away = float(np.abs(x - x_of(self.mesh, ties.wire, ties.station)[i]).min(initial=np.inf))
        known = any(doubt.key == "run.window" for doubt in self.run_info.doubts)
        if away > (1.0 - THICK) * self._width and not known:
            self.run_info.doubt(
                f"{self.task.plan.ties[i].name} failed at t = {t:.4g} s, near the border of the window",
                "droppers tear one after the other, and beyond the window none is torn", "run.window",
                "leave run.window out, or give a wider one",
            )  # fmt: skip

    def note(self) -> NotedInstants:
        """What the frames of the instants looked at last will be made of."""
        return NotedInstants(0, None) if self._now is None else NotedInstants(self._now.t.size, self._now)

    def frames(self, notes: Sequence[NotedInstants]) -> Frames:
        """The frames of some notes."""
        frames = self._pictures.build([noted.of for noted in notes])
        self._doubt_leaving(frames)
        if isinstance(self.motion, LargeMotion):
            self._doubts.look(frames, len(frames) - self._failed)
        return frames

    def _inputs_from(self, i: int) -> StepInputs:
        """What is given from output instant i on up to the next one, rows of its own."""
        if not self._ahead.first <= i < self._ahead.first + self._ahead.begin.size - 1:
            last = min(i + 1 + _AHEAD // self.rows, self.times.size)
            times = [self.times[j] + self.sample * np.arange(self._counts[j] + 1.0) for j in range(i, last)]
            begin = np.cumsum([0, *(own.size for own in times)])
            self._ahead = _Ahead(
                i, begin, inputs_of(self.task.plan, self.task.prescribed_motions, np.concatenate(times))
            )
        begin, end = self._ahead.begin[i - self._ahead.first : i - self._ahead.first + 2].tolist()
        return self._ahead.given.rows(begin, end - 1)

    def _go(self, t: float, inputs: StepInputs) -> Record:
        """Go on by the rows of a drive from t in s; external models are asked when it is time, and fill in theirs."""
        parts, row, rows = [], 0, inputs.station.shape[0] - 1
        most = portion(self.mesh.nodes, self.steps * getattr(self.motion, "inner", 1))
        first = round(t / self.sample)
        while row < rows:
            now = t + row * self.sample
            for partner in self._partners:
                if partner.rows_left(first + row) == partner.rows:
                    partner.exchange(now, partial(self._inputs, now, partner.rows))
            end = min([rows, row + most, *(row + partner.rows_left(first + row) for partner in self._partners)])
            piece = inputs if end - row == rows else inputs.rows(row, end)
            for partner in self._partners:
                partner.fill(piece, (first + row) % partner.rows)
            gone = self.motion.failed[:, 0] < np.inf
            parts.append(self.motion.go(piece, self.steps))
            parts[-1].tie[:, gone] = -self.motion.tie_at_rest[gone]  # which is beyond the window, too
            row = end
        return parts[0] if len(parts) == 1 else Record(*(np.concatenate(each) for each in zip(*parts, strict=True)))

    def _inputs(self, t: float, count: int) -> StepInputs:
        return inputs_of(self.task.plan, self.task.prescribed_motions, t + self.sample * np.arange(count + 1.0))

    def is_sane(self) -> bool:
        """Whether no node has got further away than a wire that is held can."""
        moved = self.motion.position - self._at_rest
        return bool(np.abs(moved).max() < self._escaped)  # and not NaN

    def _are_sane(self, places: Array) -> bool:
        """The same at some instants, at which `motion.both` was so: (instant, node) in small motion, else (instant, 3,
        node) m."""
        motion, rest = self.motion, self._at_rest
        if isinstance(motion, LargeMotion):
            return bool(np.abs(places - rest).max() < self._escaped)
        aside = float(np.abs(motion.rest.position[:2] - rest[:2]).max(initial=0.0))
        return bool(max(float(np.abs(motion.level + places - rest[2]).max()), aside) < self._escaped)

    def _advice(self, t: float) -> str:
        what = f"after t = {t:.6g} s the motion became unstable; "
        if self.run_info.step > self._stable:
            what += f"its step of {self.run_info.step:.3g} s is larger than the stable one of {self._stable:.3g} s: "
            return what + "write a smaller run.step, or leave it out"
        return what + "write a smaller run.step, and check masses, stiffnesses and loads"

    def holds_at_first(self) -> Array:
        """Forces of all holds on their wires at the beginning, (hold, 3) N."""
        if self._potential is None:
            return self.motion.hold_at_rest
        return self._hold_forces(self._potential)

    def _hold_forces(self, potential: WirePotential) -> Array:
        """Forces of all holds at rest, (hold, 3) N."""
        node = self.mesh.holds.node
        at_ends = -potential.bare_pull(self._at_rest)[:, np.maximum(node, 0)].T
        return np.asarray(np.where((node < 0)[:, None], potential.hold_forces(self._at_rest), at_ends))

    def ties_at_first(self) -> Array:
        """Forces of all ties at the beginning, (tie,) N."""
        return self.motion.tie_at_rest if self._potential is None else self._potential.tie_forces(self._at_rest)

    def reactions(self, hold: Array, tie: Array) -> Array:
        """Forces of all that holds wires on them now, (support, axis) N.

        Args:
            hold: (hold, 3) N, those of holds.
            tie: (tie,) N; those of ties.
        """
        failed, r, v = self.motion.failed[None, :, 0] < np.inf, self.motion.position[None], self.motion.velocity[None]
        return np.asarray(self._pictures.reactions(hold[None], tie[None], r, v, failed)[0])


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
