"""Frames of a motion of plain lines."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, replace

from ropewalk.checkpoint import Tree
from ropewalk.foreign.turns import begun
from ropewalk.mechanics.bodies import Bodies, are_weightless
from ropewalk.mechanics.chain import Array, State
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.results.exchanges import exchanged, exchanging, foreign_in
from ropewalk.results.frame import ENERGY_FORMS, Account, Frame
from ropewalk.results.snapshot import Camera, layout_of
from ropewalk.solve.choice import Choice, choose, cut_by_damping
from ropewalk.solve.guides import Partner, guides_of
from ropewalk.solve.motion import STOPPED, Motion, Progress
from ropewalk.solve.remarks import in_one_link, on_friction, on_parting, on_springing_up, who_met
from ropewalk.solve.splitting import END_OF_LINE, MET, RUNNING
from ropewalk.solve.start import Setting

_SHORTENED = (
    "lines.{line}.axial_damping makes the step {times:.2g} times shorter than it is without: lower it, or write fewer "
    "elements"
)
_COMPRESSION = (
    "at t = {time:.4g} s line {line} is in compression without any damping: a chain cannot carry that, and "
    "disturbances of the size of rounding errors grow; use law {{kind: tension_only}} or a little axial_damping"
)


class Chain:
    """A motion of plain lines under way: its layout, and its frames one after the other.

    Args:
        scenario: what is computed.
        setting, state, bodies: the same made ready, in its first state; state and bodies are changed.
        account: filled in.
        times: output instants in s, from 0.
        past: what `get_state` gave, to go on from there.
    """

    def __init__(
        self,
        scenario: Scenario,
        setting: Setting,
        state: State,
        bodies: Bodies | None,
        account: Account,
        times: Array,
        past: Tree | None = None,
    ) -> None:
        run = scenario.run
        assert isinstance(run, Dynamic)
        self.account, self.times = account, times
        self.setting, self.state, self.bodies = setting, state, bodies
        moving = None if bodies is None or are_weightless(bodies) else bodies
        self.choice = choose(
            setting.strands, setting.loads, self.state, method=run.method, step=run.step, accuracy=run.accuracy,
            duration=run.until, supports=setting.supports, bodies=moving, guided=self.bodies is not None,
        ) if past is None else Choice(**past["choice"])  # fmt: skip
        account.method, account.reason, account.step = self.choice.method, self.choice.reason, self.choice.step
        account.warnings += in_one_link(setting)
        if (cut := cut_by_damping(setting.strands, self.state, self.choice)) is not None:
            account.warnings.append(_SHORTENED.format(line=setting.lines[cut[0]], times=cut[1]))
        self.camera, self.progress = Camera(setting, self.bodies), Progress()
        guides = guides_of(setting, scenario, self.bodies)
        self.turns = [guide.turns for guide in guides if isinstance(guide, Partner)]
        with begun(self.turns):
            for guide in guides:
                guide.begin(self.state)
            self.motion = Motion(
                setting.strands, setting.loads, self.state, self.choice, run.precision, self.progress,
                setting.supports, moving, guides, self.bodies,
            )  # fmt: skip
            self._taken, self._warned, self._parted, self._slipped = 0, False, set[int](), set[int]()
            if past is not None:
                self._set_state(past)
        self.layout = replace(layout_of(setting), foreign=foreign_in(scenario))

    @property
    def total(self) -> int:
        """How many frames it will have."""
        return int(self.times.size)

    def get_state(self) -> Tree:
        """All that changes."""
        return {
            "frames": self._taken, "choice": asdict(self.choice), "motion": self.motion.get_state(),
            "camera": self.camera.get_state(), "account": self.account.get_state(), "warned": self._warned,
            "parted": sorted(self._parted), "slipped": sorted(self._slipped),
        }  # fmt: skip

    def _set_state(self, tree: Tree) -> None:
        self._taken, self._warned = tree["frames"], tree["warned"]
        self._parted, self._slipped = set(tree["parted"]), set(tree["slipped"])
        self.motion.set_state(tree["motion"])
        self.camera.set_state(tree["camera"])
        self.account.set_state(tree["account"])

    def frames(self) -> Iterator[Frame]:
        """The frames that are still to come."""
        with exchanging(self.turns, self.account):
            for time in self.times[self._taken :]:
                if self._taken:
                    self.motion.to(float(time))
                frame = self._frame()
                self._taken += 1
                if frame is not None:
                    yield frame
                if self.progress.status != RUNNING:
                    return

    def _frame(self) -> Frame | None:
        """The present frame, with all that is to be said of it; of a motion that has broken down there may be none."""
        setting, account, progress, state = self.setting, self.account, self.progress, self.state
        account.steps = progress.steps
        if progress.status != RUNNING:
            if progress.status == MET:
                progress.message = who_met(setting, state)
            account.outcome, advice = progress.told()
            account.advice = f"stopped at t = {state.t[0]:.6g} s: {advice}"
            if state.t[0] <= 0.0 or progress.status not in (END_OF_LINE, MET, STOPPED):
                return None
        frame = exchanged(self.camera.take(state), self.turns, account)
        if progress.status == RUNNING and self._taken:
            self._remark(frame)
        return frame

    def _remark(self, frame: Frame) -> None:
        """Note what one should know of a frame."""
        setting, account, bodies = self.setting, self.account, self.bodies
        self._warned = self._warned or _warn_of_compression(setting, frame, account)
        account.warnings += on_friction(setting, frame.contact_friction, frame.path, self._slipped)
        if bodies is not None:
            moving = sum(
                float(frame.energy[ENERGY_FORMS.index(form)]) for form in ("kinetic", "elastic", "load_kinetic")
            )
            account.warnings += on_parting(setting, bodies, moving, self._parted)
            for told in on_springing_up(setting, bodies, moving, self._parted):
                account.doubt(*told)


def _warn_of_compression(setting: Setting, frame: Frame, account: Account) -> bool:
    begin = 0
    for s, name in enumerate(setting.lines):
        n = int(setting.strands.links[s])
        if setting.strands.damping[s] == 0.0 and frame.tension[begin : begin + n].min() < 0.0:
            account.warnings.append(_COMPRESSION.format(time=frame.path, line=name))
            return True
        begin += n
    return False
