"""A motion of plain lines, from output to output."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace

import numpy as np
from numpy.typing import NDArray

from ropewalk.chains.beginning import initial_state
from ropewalk.chains.frames import ChainFrameBuilder, ManyStates, layout_of
from ropewalk.checkpoint import Tree
from ropewalk.controllers.assembly import controllers_of
from ropewalk.controllers.partner import Partner
from ropewalk.external.cosimulation_master import begun
from ropewalk.mechanics.bodies import are_weightless
from ropewalk.mechanics.chain import Array
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.results.exchanges import external_in
from ropewalk.results.frame import ENERGY_FORMS, Frame, RunInfo
from ropewalk.results.frames import Frames, NotedInstants
from ropewalk.results.running import Ending
from ropewalk.solve.carrier import RopeCarrier
from ropewalk.solve.choice import Choice, choose, cut_by_damping
from ropewalk.solve.diagnostics import counts, in_one_link, on_friction, on_parting, on_springing_up, who_met
from ropewalk.solve.motion import STOPPED, ChainMotion, Progress
from ropewalk.solve.splitting import END_OF_LINE, MET, RUNNING
from ropewalk.solve.start import PreparedRun, setting_of

_SHORTENED = (
    "lines.{line}.axial_damping reduces the stable step by a factor of {times:.2g}: lower it, or write fewer elements"
)
_COMPRESSION = (
    "at t = {time:.4g} s line {line} is in compression without any damping: a chain cannot carry that, and "
    "disturbances of the size of rounding errors grow; use law {{kind: tension_only}} or a little axial_damping"
)

_MOVING = "kinetic", "elastic", "load_kinetic"


class Chain:
    """Plain lines as the engine of a motion, in their first state.

    Args:
        scenario: what is computed.
        run_info: filled in.
        times: output instants in s, from 0.
        past: what `get_state` gave, to go on from there: method and step are those.

    Raises:
        RopewalkError: there is no state to begin with.
    """

    looks_ahead, together = False, True

    def __init__(self, scenario: Scenario, run_info: RunInfo, times: Array, past: Tree | None = None) -> None:
        run = scenario.run
        assert isinstance(run, Dynamic)
        self.setting = setting = setting_of(scenario, run.until)
        self.state, self.bodies = state, bodies = initial_state(setting, scenario)
        self.run_info, self.times = run_info, times
        moving = None if bodies is None or are_weightless(bodies) else bodies
        self.choice = choose(
            setting.strands, setting.loads, state, method=run.method, step=run.step, accuracy=run.accuracy,
            duration=run.until, supports=setting.supports, bodies=moving, guided=bodies is not None,
        ) if past is None else Choice(**past["choice"])  # fmt: skip
        run_info.method, run_info.reason, run_info.step = self.choice.method, self.choice.reason, self.choice.step
        run_info.warnings += in_one_link(setting)
        if (cut := cut_by_damping(setting.strands, self.state, self.choice)) is not None:
            run_info.warnings.append(_SHORTENED.format(line=setting.lines[cut[0]], times=cut[1]))
        self._builder, self.progress = ChainFrameBuilder(setting, self.bodies), Progress()
        carrier = None if bodies is None else RopeCarrier(setting, state, bodies, setting.loads)
        controllers = [] if carrier is None else controllers_of(carrier, setting.loading, scenario)
        self.cosimulation = [controller.cosimulation for controller in controllers if isinstance(controller, Partner)]
        with begun(self.cosimulation):
            for controller in controllers:
                controller.begin()
            self.motion = ChainMotion(
                setting.strands, setting.loads, self.state, self.choice, run.precision, self.progress,
                setting.supports, moving, controllers, self.bodies,
            )  # fmt: skip
        if carrier is not None:
            carrier.look = self.motion.look
        self._warned, self._parted, self._slipped = False, set[int](), set[int]()
        self._frame: Frame | None = None
        self._notes = self.motion.empty_notes(0)
        self._together = self._builder.together and not controllers  # frames of many instants are built at once
        self.layout = replace(layout_of(setting), external=external_in(scenario))

    def get_state(self) -> Tree:
        """All that changes."""
        return {
            "choice": asdict(self.choice), "motion": self.motion.get_state(), "frames": self._builder.get_state(),
            "warned": self._warned, "parted": sorted(self._parted), "slipped": sorted(self._slipped),
        }  # fmt: skip

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self._warned, self._parted, self._slipped = tree["warned"], set(tree["parted"]), set(tree["slipped"])
        self.motion.set_state(tree["motion"])
        self._builder.set_state(tree["frames"])

    def advance(self, i: int, most: int = 1) -> Ending | None:
        """Go on to output instant i, and to those after it if nobody need look in between."""
        progress, motion, through = self.progress, self.motion, self._together and self.motion.goes_through
        times = self.times[i : i + most if i and through else i + 1]
        self._frame, self._notes = None, motion.empty_notes(times.size if self._together else 0)
        if i and through:
            motion.through(times, self._notes)
        elif i:
            motion.to(float(times[0]))
        self.run_info.steps, begins = progress.steps, self.state.t[0] <= 0.0
        if progress.status == RUNNING:
            if not (i and through):
                self._note_present()
            return None
        if progress.status in (END_OF_LINE, MET, STOPPED) and not begins:  # of all others nothing can be trusted
            self._note_present()
        if progress.status == MET:
            progress.message = who_met(self.setting, self.state)
        outcome, advice = progress.ending()
        return Ending(outcome, f"stopped at t = {self.state.t[0]:.6g} s: {advice}")

    def _note_present(self) -> None:
        """Note the present state, or make its frame."""
        if self._together:
            self._notes.add()
            return
        self._frame = self._builder.build(self.state)
        if self.progress.status == RUNNING:
            self._remark(self._frame, None if self.bodies is None else self.bodies.wheels["parting"])

    def note(self) -> NotedInstants:
        """The frame of the instant that it has come to, or states at some and whether the motion goes on."""
        if self._frame is not None:
            return NotedInstants(1, self._frame)
        return NotedInstants(self._notes.noted, (self._notes, self.progress.status == RUNNING))

    def frames(self, notes: Sequence[NotedInstants]) -> Frames:
        """The frames of some notes."""
        if not self._together:
            return Frames.together([noted.of for noted in notes])
        states = ManyStates.of([noted.of[0] for noted in notes], self.state, self.bodies)
        frames = self._builder.build_many(states)
        parting = None if states.bodies is None else states.bodies.wheels["parting"]
        is_odd = self._is_odd(frames, parting)
        is_odd[-1] &= notes[-1].of[1]  # of an end nothing is remarked
        for i in np.flatnonzero(is_odd).tolist():
            self._remark(frames[i], None if parting is None else parting[i])
        return frames

    def _is_odd(self, frames: Frames, parting: Array | None) -> NDArray[np.bool_]:
        """Frames of which something may be to be remarked, (instant,); `parting` is (instant, wheel) J."""
        needed, given = frames.of["contact_friction"], self.setting.loads.friction
        odd = (frames.of["tension"] < 0.0).any(axis=1) | (needed > given).any(axis=1)
        return np.asarray(odd if parting is None else odd | counts(parting, _moving(frames.of["energy"])).any(axis=1))

    def _remark(self, frame: Frame, parting: Array | None) -> None:
        """Note what one should know of a frame of the motion.

        Args:
            parting: (wheel,) J, lost by lines when wheels left them; None: nothing has a mass.
        """
        if frame.path <= 0.0:
            return
        setting, run_info = self.setting, self.run_info
        self._warned = self._warned or _warn_of_compression(setting, frame, run_info)
        run_info.warnings += on_friction(setting, frame.contact_friction, frame.path, self._slipped)
        if parting is not None:
            moving = float(_moving(frame.energy))
            run_info.warnings += on_parting(setting, parting, moving, self._parted)
            for exchanged in on_springing_up(setting, parting, moving, self._parted):
                run_info.doubt(*exchanged)


def _moving(energy: Array) -> Array:
    """What moves and springs back of energies (..., form), J."""
    kinetic, elastic, of_loads = (energy[..., ENERGY_FORMS.index(form)] for form in _MOVING)
    return np.asarray(kinetic + elastic + of_loads)


def _warn_of_compression(setting: PreparedRun, frame: Frame, run_info: RunInfo) -> bool:
    begin = 0
    for s, name in enumerate(setting.lines):
        n = int(setting.strands.links[s])
        if setting.strands.damping[s] == 0.0 and frame.tension[begin : begin + n].min() < 0.0:
            run_info.warnings.append(_COMPRESSION.format(time=frame.path, line=name))
            return True
        begin += n
    return False
