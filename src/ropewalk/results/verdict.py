"""Whether a run can be trusted: what its frames give reason to doubt, with cause, key and remedy."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.audit import AUDIT, turnover
from ropewalk.results.calm import started_too_close
from ropewalk.results.foundation_step import phase_warnings
from ropewalk.results.frame import ENERGY_FORMS, OFF_LINE, Array, Doubt, Frame, Layout, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.ground import GroundWatch
from ropewalk.results.hanging import HangingWatch
from ropewalk.results.lost_contact import LostContactWatch
from ropewalk.results.peaks import beside, lonely, missed, sharp, too_far_apart
from ropewalk.results.pushing import PushWatch
from ropewalk.results.roof_springs import stiff_below
from ropewalk.results.strength import StrengthWatch

if TYPE_CHECKING:
    from ropewalk.model import AnyLoad, Scenario

AUDITED = ENERGY_FORMS.index(AUDIT)
IMBALANCE = 0.05  # of the energy turned over: beyond it a run is doubtful
ROUNDING = 1e-10  # of the largest energy: what the audit cannot resolve
VANISHING = 1e-100  # N: small motion begins with a little more than nothing
UNBALANCED = 1e-3  # of all weights: what the support forces at rest may miss
NOTHING = 1e-10  # of the largest tension, or of the weight of the line: a load that presses less does not press
SLACK = 100.0  # times the speed of waves: a line is slack there
FAST = 0.8  # of the speed of transverse waves: forces of masses are hard to resolve beyond
_GROWING = ("pantograph",)  # loads whose forces grow from nothing
_DECIDING = ("footsteps", "stepper", "fmu")  # loads that may do so: what they press with at first says it
_NEVER_AT_REST = ("walker", "stepper", "fmu")  # loads that a run cannot begin at rest with
_COUNTS = 0.3  # part of the largest tension of all lines, from which on the peak of a line counts
_AT_ONCE = 0.1  # of its largest force: with what a load is set down suddenly that may grow


class _Balance:
    """The energy audit over the frames: how much was turned over, and how much is missing."""

    def __init__(self) -> None:
        self.cause: tuple[str, str, str] | None = None  # of the steepest growth of what is missing
        self._first: Array | None = None
        self._moved = self._largest = 0.0  # energy turned over, and largest of its forms, J
        self._worst = 0.0, 0.0  # energy missing, J, and when, s
        self._before = self._steepest = 0.0  # energy missing before, and its largest growth over a frame, J
        self._whole = True  # whether all audits were numbers

    def see(self, path: Array, energy: Array) -> int | None:
        """Take note of frames; gives the last one since whose predecessor more than ever before has got lost.

        Args:
            path: (frame,) s.
            energy: (frame, form) J.
        """
        missed = np.abs(energy[:, AUDITED])
        if self._first is None:
            self._first = energy[0].copy()
        self._moved = max(self._moved, float(turnover(energy, self._first).max()))
        self._largest = max(self._largest, float(np.abs(np.nan_to_num(np.delete(energy, AUDITED, axis=1))).max()))
        self._whole &= bool(np.isfinite(missed).all())
        growth, known = np.diff(missed, prepend=self._before), np.where(np.isnan(missed), -1.0, missed)
        growth[np.isnan(growth)] = -1.0
        worst, steepest, self._before = int(known.argmax()), int(growth.argmax()), float(missed[-1])
        if known[worst] > self._worst[0]:
            self._worst = float(known[worst]), float(path[worst])
        if growth[steepest] <= self._steepest:
            return None
        self._steepest = float(growth[steepest])
        return steepest

    def doubts(self) -> Iterator[Doubt]:
        """What is missing, if it is too much."""
        if not self._whole:
            remedy = "do not trust its energies, and check forces and deflections otherwise"
            yield Doubt("no energy audit was kept", "none is known for this combination", "run", remedy)
            return
        missed, when = self._worst
        if missed > max(IMBALANCE * self._moved, ROUNDING * self._largest):
            share = f"{100.0 * missed / self._moved:.3g} % of" if self._moved > 0.0 else "and not"
            what = f"{missed:.4g} J are missing at t = {when:.4g} s, {share} the energy turned over"
            assert self.cause is not None
            yield Doubt(what, *self.cause)


class Watch:
    """Watches the frames of a run, and judges it at the end; of each frame it keeps the forces only.

    Args:
        layout: of the frames.
        scenario: what is run.
    """

    def __init__(self, layout: Layout, scenario: Scenario) -> None:
        self.layout, self.scenario = layout, scenario
        self.loads = [name.partition(".")[0] for name in layout.contact_load]
        contacts = len(self.loads)
        self._before: tuple[float, Array] | None = None  # path, and states of contacts, in the last frame
        self._slowness = np.array([self._slowness_of(name) for name in self.loads])  # (contact,) (kg/m)^(1/2)
        self._at_start: tuple[Array, Array] = np.zeros(0), np.zeros(0)  # states and xi of contacts in the first frame
        self._been = np.zeros(contacts, dtype=np.bool_)  # contacts that have been on their lines
        self._fastest = np.zeros(contacts)  # speeds over those of transverse waves beside the contacts
        self._missing = 0.0, 0.0  # support forces at rest without what they carry, and that, N
        self._balance, self._strengths = _Balance(), StrengthWatch(layout, scenario)
        self._pushing = PushWatch(layout, scenario)
        self._over_ground, self._lost_contact = GroundWatch(layout, scenario), LostContactWatch(layout, scenario)
        self._hanging = HangingWatch(layout, scenario)
        self._force = array("d")  # on the line, of each sample and contact, N
        self._instants = array("d")  # of these samples, s
        self._tension = array("d")  # largest, of each frame, N
        self._lines, self._of_line = _runs_of(layout.link_line)
        self._pull = array("d")  # largest of each frame and line, N
        self._times = array("d")  # of the frames, s

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        of, path, state = frames.of, frames.path, frames.of["contact_state"]
        on = state != OFF_LINE
        if not self._times:
            self._at_start = state[0].copy(), of["contact_xi"][0].copy()
        for i in range(len(frames) if self.layout.path == "load_path" else int(not self._times)):
            self._rest(frames[i], on[i])
        self._strengths.see(frames)
        self._pushing.see(frames)
        self._over_ground.see(frames)
        self._lost_contact.see(frames)
        self._hanging.see(frames)
        self._been |= on.any(axis=0)
        fastest = np.fmax.accumulate(np.concatenate([self._fastest[None], self._in_waves(of)]))[1:]
        self._fastest = fastest[-1]
        if (steepest := self._balance.see(path, of["energy"])) is not None:
            before = (float(path[steepest - 1]), state[steepest - 1]) if steepest else self._before
            if before is not None:
                self._balance.cause = self._cause(before[0], before[1], frames[steepest], fastest[steepest])
        self._before = float(path[-1]), state[-1].copy()
        pull = of["tension"]
        pull = np.where(np.isfinite(pull), pull, 0.0)
        self._tension.extend(pull.max(axis=1, initial=0.0))
        if self._lines:
            self._pull.frombytes(np.maximum.reduceat(pull, self._of_line, axis=1).tobytes())
        self._times.extend(path)
        if "sampled_force" in of and of["sampled_force"].size:
            force = np.where(np.isfinite(of["sampled_station"]), np.abs(of["sampled_force"]), np.nan)
            self._instants.extend((path[:, None] + np.array(self.layout.sample)).ravel())
        else:
            force = np.where(on, np.linalg.norm(of["contact_force"], axis=2), np.nan)
            self._instants.extend(path)
        self._force.frombytes(np.ascontiguousarray(force, dtype=np.float64).tobytes())

    def judge(self, run_info: RunInfo) -> None:
        """Note all doubts and remarks about what was seen."""
        if self._times:
            force = np.array(self._force).reshape(len(self._instants), len(self.loads))
            run_info.doubts += [doubt for doubt in self._doubts(run_info, force) if doubt not in run_info.doubts]
            run_info.warnings += [remark for remark in self._diagnostics(force) if remark not in run_info.warnings]
            run_info.warnings += phase_warnings(self.scenario, run_info)

    def _doubts(self, run_info: RunInfo, force: Array) -> Iterator[Doubt]:
        yield from self._absent(force)
        yield from self._strengths.doubts()
        if self.layout.path == "time":
            if not run_info.audit and len(self._times) > 1:
                yield from self._balance.doubts()
            yield from self._single_steps(force)
        missing, carried = self._missing
        if missing > max(UNBALANCED * carried, VANISHING):
            what = f"at rest the support forces differ by {missing:.4g} N from the {carried:.4g} N that they carry"
            remedy = "write more elements, and check supports and lengths"
            yield Doubt(what, "the shape that was found is not in balance", "lines", remedy)

    def _rest(self, frame: Frame, on: NDArray[np.bool_]) -> None:
        """At rest supports carry all weights: the largest difference from that."""
        if not np.isfinite(self.layout.weight):
            return
        if self.layout.path == "time" and (on.any() or not self._begins_at_rest):
            return  # a motion that begins with loads on its lines is not at rest either
        pressing = float(np.nansum(frame.contact_force[on, -1]))
        missing = abs(float(np.nansum(frame.reaction[:, -1])) + pressing - self.layout.weight)
        carried = abs(self.layout.weight) + float(np.nansum(np.abs(frame.contact_force[on])))
        carried += ROUNDING / UNBALANCED * float(np.nan_to_num(np.abs(frame.reaction)).max(initial=0.0))
        if missing > self._missing[0]:
            self._missing = missing, carried

    @property
    def _begins_at_rest(self) -> bool:
        run = self.scenario.run
        return run.kind == "equilibrium" or (run.kind == "dynamic" and run.start.kind == "rest")

    def _in_waves(self, of: Mapping[str, Array]) -> Array:
        """Speeds of contacts over those of transverse waves in the looser part beside them; zero where unknown."""
        pull, speed = of["contact_tension"].min(axis=2), np.abs(of["contact_speed"])
        known = np.isfinite(pull) & (speed > 0.0)
        return np.where(known, speed * self._slowness / np.sqrt(np.where(known, np.maximum(pull, 1e-300), 1.0)), 0.0)

    def _slowness_of(self, name: str) -> float:
        """Root of the mass of the line below a load, which tells the speed of its waves; zero where there is none."""
        load = self.scenario.loads.get(name)
        line = self.scenario.lines.get(load.on) if load is not None else None
        return 0.0 if line is None or line.has_bending_stiffness else float(np.sqrt(line.mass))

    def _cause(self, earlier: float, state: Array, frame: Frame, fastest: Array) -> tuple[str, str, str]:
        """What went on from frame to frame while energy was lost: the likely cause, the key to blame, the remedy."""
        when = f"between t = {earlier:.4g} and {frame.path:.4g} s"
        for k, name in enumerate(self.layout.contact_load):
            left, came = state[k] != OFF_LINE, frame.contact_state[k] != OFF_LINE
            if left != came:
                did, end = ("left its line", "end the run before") if left else ("came onto its line", "start within")
                remedy = f"write more elements, or {end}; the rest of the run may be fine without it"
                return f"load {name} {did} {when}", f"loads.{self.loads[k]}.travel", remedy
        if fastest.max(initial=0.0) > FAST:
            k = int(fastest.argmax())
            times = fastest[k]
            fast = f"{times:.3g} times" if times < SLACK else "far above"  # beside slack line waves hardly travel
            text = f"load {self.layout.contact_load[k]} goes at {fast} the speed of transverse waves"
            return text, f"loads.{self.loads[k]}.travel.speed", "write a lower speed, or more tension or elements"
        pull = np.nan_to_num(frame.tension)
        if pull.size and pull.min() < -ROUNDING * np.abs(pull).max():
            line = self.layout.link_line[int(pull.argmin())]
            remedy = "write law: {kind: tension_only}, or more axial_damping"
            return f"line {line} is in compression {when}", f"lines.{line}.law", remedy
        remedy = "halve run.step: if the imbalance stays, write more elements"
        return f"the step or the mesh is too coarse for what goes on {when}", "run.step", remedy

    def _absent(self, force: Array) -> Iterator[Doubt]:
        """Loads that are never on their line, or never press on it."""
        for name in dict.fromkeys(self.loads):
            mine = np.array([load == name for load in self.loads])
            load = self.scenario.loads.get(name)
            if load is None:
                continue
            pressing = float(np.nan_to_num(force[:, mine]).max(initial=0.0))
            if not self._been[mine].any() and not pressing > 0.0:
                cause, remedy = "it starts off its line, or leaves at once", "let it start on its line, or run longer"
                yield Doubt(f"load {name} is never on {load.on}", cause, f"loads.{name}.travel", remedy)
            elif pressing <= NOTHING * max(*self._tension, self._ordinary(load.on)):
                cause, key, remedy = self._weightless(name)
                yield Doubt(f"load {name} never presses on {load.on}", cause, key, remedy)

    def _ordinary(self, on: str) -> float:
        """A force that is not small for a line, N: its weight on Earth."""
        line = self.scenario.lines.get(on)
        return 0.0 if line is None else 9.81 * line.mass * line.distance

    def _weightless(self, name: str) -> tuple[str, str, str]:
        load = self.scenario.loads[name]
        if self.scenario.gravity == 0.0 and load.kind not in ("force", "stepper", "fmu"):
            return "without gravity its mass has no weight", "gravity", "give gravity, or the weight as a force"
        if load.kind in ("stepper", "fmu"):
            return "the model answers with no force", f"loads.{name}", "look at what it gives"
        if load.kind == "pantograph":
            return "its forces have hardly grown, or it lost contact", f"loads.{name}.ramp", "run longer than ramp"
        if load.kind == "force":
            return "its force is zero", f"loads.{name}.force", "give it a force"
        key = f"loads.{name}.weight" if load.kind == "matrices" else f"loads.{name}"
        return "it has no weight, or is in the air all the time", key, "check its weight, and where it starts"

    def _single_steps(self, force: Array) -> Iterator[Doubt]:
        """Peaks of contact forces and tensions that stand alone: they come from one step, and not from the line."""
        for k, name in enumerate(self.layout.contact_load):
            if (i := lonely(force[:, k])) is not None:
                what = f"the contact force of load {name} is {_alone(force[:, k], i, self._instants[i])}"
                cause = "a rigid contact strikes the line, and the force is its impulse over one step"
                remedy = "give it a contact_stiffness, or look at impulses only"
                yield Doubt(what, cause, f"loads.{self.loads[k]}", remedy)
        tension = np.array(self._tension)
        if (i := lonely(tension)) is not None:
            what = f"the largest tension is {_alone(tension, i, self._times[i])}"
            yield Doubt(what, "a blow that the step does not resolve", "run.step", "write a smaller run.step and every")

    def _diagnostics(self, force: Array) -> Iterator[str]:
        yield from started_too_close(self.scenario)
        yield from stiff_below(self.scenario)
        yield from self._between_instants()
        yield from self._pushing.messages()
        yield from self._over_ground.messages()
        yield from self._lost_contact.messages()
        yield from self._hanging.messages()
        run = self.scenario.run
        if run.kind != "dynamic" or run.start.kind != "rest" or run.start.with_loads:
            return
        for name in dict.fromkeys(self.loads):
            load = self.scenario.loads.get(name)
            if load is None or load.on in self.scenario.nets or load.kind in _GROWING or _falls(load):
                continue
            on, k = self.scenario.carrier_of(load), self.loads.index(name)
            if load.kind in _DECIDING and not self._presses_at_once(force, name):
                continue
            state, xi = (float(values[k]) for values in self._at_start)
            here = [x for x, line in zip(self.layout.node_xi, self.layout.node_line, strict=True) if line == on]
            if state != OFF_LINE and here and min(here) < xi < max(here):
                rest = "to begin at rest with it write run.start: {with_loads: true}, or let it start at an end"
                stiff = any(line.has_bending_stiffness for line in self.scenario.lines.values())
                if stiff or load.kind in _NEVER_AT_REST:  # which begin without loads
                    rest = "let it start at an end to avoid that"
                if load.kind in ("stepper", "fmu"):
                    rest += ", or let its force grow from zero"
                yield (
                    f"load {name} is set down suddenly at t = 0, {xi:.4g} m along {load.on}: what swings from that is "
                    f"part of the answer; {rest}"
                )

    def _between_instants(self) -> Iterator[str]:
        """The line with the sharpest largest tension, if output instants are too far apart for it."""
        if self.layout.path != "time" or not self._lines or lonely(np.array(self._tension)) is not None:
            return
        pull, found = np.array(self._pull).reshape(len(self._times), -1), list[tuple[float, int, int]]()
        for line, values in enumerate(pull.T):
            if (i := sharp(values)) is not None and values[i] > _COUNTS * pull.max():
                found.append((missed(values, i), i, line))
        if found:
            _, i, line = max(found)
            yield too_far_apart(f"the largest tension of {self._lines[line]}", pull[:, line], np.array(self._times), i)

    def _presses_at_once(self, force: Array, name: str) -> bool:
        """Whether the contacts of a load press, in all, at t = 0 with a good part of what they press with at most."""
        own = np.nansum(force[:, [load == name for load in self.loads]], axis=1)
        return bool(own[0] > _AT_ONCE * own.max())


def _runs_of(names: Sequence[str]) -> tuple[list[str], list[int]]:
    """Names that stand beside each other, each once, and where they begin."""
    begin = [i for i, name in enumerate(names) if i == 0 or name != names[i - 1]]
    return [names[i] for i in begin], begin


def _falls(load: AnyLoad) -> bool:
    """Whether nearly all that a load weighs hangs on a rope that is slack at first: to fall is what it is there for."""
    if load.kind != "trolley" or load.payload is None or load.payload.at is None:
        return False
    return load.mass < load.payload.mass and math.hypot(*load.payload.at) < load.payload.length


def _alone(values: Array, i: int, when: float) -> str:
    return f"{values[i]:.4g} N at t = {when:.4g} s alone, {beside(values, i):.4g} N just before and after"
