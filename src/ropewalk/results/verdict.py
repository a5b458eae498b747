"""Whether a run can be trusted: what its frames give reason to doubt, with cause, key and remedy."""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ropewalk.model.plausibility import implausible
from ropewalk.results.after_start import falls
from ropewalk.results.attachments import AttachmentWatch
from ropewalk.results.audit import ROUNDING
from ropewalk.results.axial_restraint import AxialRestraintWatch
from ropewalk.results.close_contacts import CloseContactsWatch
from ropewalk.results.contact_order import ContactOrderWatch
from ropewalk.results.energy_balance import RESIDUAL, EnergyWatch
from ropewalk.results.frame import OFF_LINE, Array, Doubt, Frame, Layout, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.given_tension import GivenTensionWatch
from ropewalk.results.ground import GroundWatch
from ropewalk.results.hanging import HangingWatch
from ropewalk.results.lifted_rope import LiftedRopeWatch
from ropewalk.results.lost_contact import LostContactWatch
from ropewalk.results.peaks import beside, lonely, missed, sharp, too_far_apart
from ropewalk.results.pushing import PushWatch
from ropewalk.results.ringing_contacts import RingingContactsWatch
from ropewalk.results.scenario_warnings import blows_at_once, phase_warnings, started_too_close, stiff_below
from ropewalk.results.start_position import StartPositionWatch
from ropewalk.results.strain_range import StrainRangeWatch
from ropewalk.results.strength import StrengthWatch
from ropewalk.results.watch import Watch

if TYPE_CHECKING:
    from ropewalk.model import AnyLoad, Scenario

WATCHES: tuple[type[Watch], ...] = (
    StrengthWatch, LiftedRopeWatch, CloseContactsWatch, ContactOrderWatch, StrainRangeWatch, AxialRestraintWatch,
    StartPositionWatch, RingingContactsWatch, PushWatch, GroundWatch, LostContactWatch, HangingWatch, GivenTensionWatch,
)  # fmt: skip
"""Watches of a single question each."""
OF_SCENARIOS = (started_too_close, stiff_below, blows_at_once, implausible)
"""Warnings that need no frames."""
VANISHING = 1e-100  # N: linearised motion begins with a little more than nothing
UNBALANCED = 1e-3  # of all weights: what the support forces at rest may miss
NOTHING = 1e-10  # of the largest tension, or of the weight of the line: a load that presses less does not press
_GROWING = ("pantograph",)  # loads whose forces grow from nothing
_DECIDING = ("footsteps", "stepper", "fmu")  # loads that may do so: what they press with at first says it
_NEVER_AT_REST = ("walker", "stepper", "fmu")  # loads that a run cannot begin at rest with
NOTABLE = 1e-4  # of the weight of a line: a smaller peak of its tension is not reported
_COUNTS = 0.3  # part of the largest tension of all lines, from which on the peak of a line counts
_AT_ONCE = 0.1  # of its largest force: with what a load is set down suddenly that may grow


class Verdict(Watch):
    """Sees the frames of a run, and judges it at the end; of each frame it keeps the forces only.

    Args:
        layout: of the frames.
        scenario: the scenario.
    """

    def __init__(self, layout: Layout, scenario: Scenario) -> None:
        super().__init__(layout, scenario)
        self._at_start: tuple[Array, Array] = np.zeros(0), np.zeros(0)  # states and xi of contacts in the first frame
        self._been = np.zeros(len(self.loads), dtype=np.bool_)  # contacts that have been on their lines
        self._missing = 0.0, 0.0  # support forces at rest without what they carry, and that, N
        self._attachments = AttachmentWatch(layout, scenario)
        self._energy = EnergyWatch(layout, scenario, self._attachments)
        self._watches = [watch(layout, scenario) for watch in WATCHES]
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
        for watch in (*self._watches, self._attachments, self._energy):
            watch.see(frames)
        self._been |= on.any(axis=0)
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
            run_info.doubts[:] = [doubt for doubt in run_info.doubts if not doubt.what.startswith(RESIDUAL)]
            run_info.warnings[:] = [text for text in run_info.warnings if not text.startswith(RESIDUAL)]  # of a part
            force = np.array(self._force).reshape(len(self._instants), len(self.loads))
            run_info.doubts += [doubt for doubt in self._doubts(run_info, force) if doubt not in run_info.doubts]
            found = self._warnings(run_info, force)
            run_info.warnings += [warning for warning in found if warning not in run_info.warnings]

    def _doubts(self, run_info: RunInfo, force: Array) -> Iterator[Doubt]:
        yield from self._absent(force)
        for watch in self._watches:
            yield from watch.doubts(run_info)
        if self.layout.path == "time":
            yield from (attached := list(self._attachments.findings(force)))
            yield from self._energy.doubts(run_info)
            yield from self._single_steps(force, {doubt.key for doubt in attached})
        missing, carried = self._missing
        if missing > max(UNBALANCED * carried, VANISHING):
            what = (
                f"the support forces differ by {missing:.4g} N from the {carried:.4g} N that they carry in equilibrium"
            )
            cause = "not identified, the computed shape is not in equilibrium"
            yield Doubt(
                what, cause, "lines", "check the support forces by another calculation, and write more elements"
            )

    def _rest(self, frame: Frame, on: NDArray[np.bool_]) -> None:
        """At rest supports carry all weights: the largest difference from that."""
        if not np.isfinite(self.layout.weight):
            return
        if self.layout.path == "time" and (on.any() or not self._begins_at_rest):
            return  # a motion that begins with loads on its lines is not at rest either
        pressing = float(np.nansum(frame.contact_force[on, -1]))
        missing = abs(float(np.nansum(frame.reaction[:, -1])) + pressing - self.layout.weight)
        carried = abs(self.layout.weight) + float(np.nansum(np.abs(frame.contact_force[on])))
        stiffest = max((line.axial_stiffness or 0.0 for line in self.scenario.lines.values()), default=0.0)
        known = max(stiffest, float(np.nan_to_num(np.abs(frame.reaction)).max(initial=0.0)))  # N
        carried += ROUNDING / UNBALANCED * known
        if missing > self._missing[0]:
            self._missing = missing, carried

    @property
    def _begins_at_rest(self) -> bool:
        run = self.scenario.run
        return run.kind == "equilibrium" or (run.kind == "dynamic" and run.start.kind == "rest")

    def _absent(self, force: Array) -> Iterator[Doubt]:
        """Loads that are never on their line, or never press on it."""
        for name in dict.fromkeys(self.loads):
            mine = np.array([load == name for load in self.loads])
            load = self.scenario.loads.get(name)
            if load is None:
                continue
            pressing = float(np.nan_to_num(force[:, mine]).max(initial=0.0))
            if not self._been[mine].any() and not pressing > 0.0:
                cause = "its start is not on the line, or it leaves within the first output interval"
                remedy = "write a start on the line, or a later end of the run"
                yield Doubt(f"load {name} is never on {load.on}", cause, f"loads.{name}.travel", remedy)
            elif pressing <= NOTHING * max(*self._tension, self._ordinary(load.on)):
                cause, key, remedy = self._weightless(name)
                yield Doubt(f"load {name} never exerts a force on {load.on}", cause, key, remedy)

    def _ordinary(self, on: str) -> float:
        """A force that is not small for a line, N: its weight on Earth."""
        line = self.scenario.lines.get(on)
        return 0.0 if line is None else 9.81 * line.mass * line.distance

    def _weightless(self, name: str) -> tuple[str, str, str]:
        load = self.scenario.loads[name]
        if self.scenario.gravity == 0.0 and load.kind not in ("force", "stepper", "fmu"):
            return "gravity is 0, so its mass has no weight", "gravity", "write gravity, or the weight as a force"
        if load.kind in ("stepper", "fmu"):
            return "the external model returns no force", f"loads.{name}", "check the forces that it returns"
        if load.kind == "pantograph":
            return "its static force is still small, or it lost contact", f"loads.{name}.ramp", "run longer than ramp"
        if load.kind == "force":
            return "its force is zero", f"loads.{name}.force", "give it a force"
        key = f"loads.{name}.weight" if load.kind == "matrices" else f"loads.{name}"
        return "it has no weight, or is never in contact", key, "check its weight and its start"

    def _single_steps(self, force: Array, doubted: set[str]) -> Iterator[Doubt]:
        """Peaks of contact forces and tensions that stand alone: they come from one step, and not from the line."""
        for k, name in enumerate(self.layout.contact_load):
            if (i := lonely(force[:, k])) is not None:
                at = np.array([np.interp(self._instants[i], self._times, self._energy.xi(k))])
                if f"loads.{self.loads[k]}.travel" in doubted and self._attachments.blamed(k, at)[0]:
                    continue
                what = f"the contact force of load {name} is {_alone(force[:, k], i, self._instants[i])}"
                yield Doubt(what, *_impact(self.scenario.loads.get(self.loads[k]), self.loads[k]))
        tension = np.array(self._tension)
        if (i := lonely(tension)) is not None:
            what = f"the largest tension is {_alone(tension, i, self._times[i])}"
            yield Doubt(
                what, "an impact that is shorter than the output interval", "run.every", "write a smaller run.every"
            )

    def _warnings(self, run_info: RunInfo, force: Array) -> Iterator[str]:
        for warnings in OF_SCENARIOS:
            yield from warnings(self.scenario)
        for watch in (*self._watches, self._energy):
            yield from watch.messages(run_info)
        yield from self._between_instants()
        yield from self._set_down(force)
        yield from phase_warnings(self.scenario, run_info)

    def _set_down(self, force: Array) -> Iterator[str]:
        """Loads that are set down suddenly at the start."""
        run = self.scenario.run
        if run.kind != "dynamic" or run.start.kind != "rest" or run.start.with_loads:
            return
        for name in dict.fromkeys(self.loads):
            load = self.scenario.loads.get(name)
            if load is None or load.on in self.scenario.nets or load.kind in _GROWING or falls(load):
                continue
            on, k = self.scenario.carrier_of(load), self.loads.index(name)
            if load.kind in _DECIDING and not self._presses_at_once(force, name):
                continue
            state, xi = (float(values[k]) for values in self._at_start)
            here = [x for x, line in zip(self.layout.node_xi, self.layout.node_line, strict=True) if line == on]
            if state != OFF_LINE and here and min(here) < xi < max(here):
                rest = "to begin in equilibrium with it write run.start: {with_loads: true}, or let it start at an end"
                stiff = any(line.has_bending_stiffness for line in self.scenario.lines.values())
                if stiff or load.kind in _NEVER_AT_REST:  # which begin without loads
                    rest = "let it start at an end to avoid that"
                if load.kind in ("stepper", "fmu"):
                    rest += ", or let its force grow from zero"
                yield (
                    f"load {name} is set down suddenly at t = 0, {xi:.4g} m along {load.on}: the results contain the "
                    f"vibration that this excites; {rest}"
                )

    def _between_instants(self) -> Iterator[str]:
        """The line with the sharpest largest tension, if output instants are too far apart for it."""
        if self.layout.path != "time" or not self._lines or lonely(np.array(self._tension)) is not None:
            return
        pull, found = np.array(self._pull).reshape(len(self._times), -1), list[tuple[float, int, int]]()
        for line, values in enumerate(pull.T):
            least = max(_COUNTS * pull.max(), NOTABLE * self._ordinary(self._lines[line]))
            if (i := sharp(values)) is not None and values[i] > least:
                found.append((missed(values, i), i, line))
        if found:
            _, i, line = max(found)
            yield too_far_apart(f"the largest tension of {self._lines[line]}", pull[:, line], np.array(self._times), i)

    def _presses_at_once(self, force: Array, name: str) -> bool:
        """Whether the contacts of a load press, in all, at t = 0 with a good part of what they press with at most."""
        own = np.nansum(force[:, [load == name for load in self.loads]], axis=1)
        return bool(own[0] > _AT_ONCE * own.max())


def _runs_of(names: Sequence[str]) -> tuple[list[str], list[int]]:
    """Names that stand next to each other, each once, and where they begin."""
    begin = [i for i, name in enumerate(names) if i == 0 or name != names[i - 1]]
    return [names[i] for i in begin], begin


def _impact(load: AnyLoad | None, name: str) -> tuple[str, str, str]:
    """Cause, key and remedy of a contact force that has a peak at a single sample."""
    parts = (load, *getattr(load, "wheels", {}).values())
    if any(getattr(part, "contact_stiffness", None) is not None for part in parts):
        return "an impact that is shorter than the output interval", "run.every", "write a smaller run.every"
    cause = "a rigid contact hits the line, and the force is its impulse divided by one step"
    if any("contact_stiffness" in type(part).model_fields for part in parts if part is not None):
        key = f"loads.{name}.wheels" if getattr(load, "wheels", None) else f"loads.{name}"
        return cause, key, "write lift_off: true and a contact_stiffness, or evaluate impulses only"
    return cause, f"loads.{name}", "write kind: vehicle with a contact_stiffness, or evaluate impulses only"


def _alone(values: Array, i: int, when: float) -> str:
    return f"{values[i]:.4g} N at t = {when:.4g} s alone, {beside(values, i):.4g} N just before and after"
