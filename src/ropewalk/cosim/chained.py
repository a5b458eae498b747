"""Chains moved from outside."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ropewalk.chains.beginning import initial_state
from ropewalk.chains.frames import ChainFrameBuilder
from ropewalk.checkpoint import Tree
from ropewalk.controllers.assembly import controllers_of
from ropewalk.cosim.on_carrier import OnCarrier, Silent
from ropewalk.cosim.outside import ContactOutput, Outside
from ropewalk.errors import RopewalkError
from ropewalk.mechanics.bodies import are_weightless
from ropewalk.mechanics.chain import OFF, Array
from ropewalk.mechanics.moving_contact import link_of
from ropewalk.mechanics.multibody_system import MultibodySystem
from ropewalk.model.exchange import Exchange
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.stepper import Stepper
from ropewalk.solve.carrier import ChainLine, RopeCarrier
from ropewalk.solve.choice import choose
from ropewalk.solve.motion import ChainMotion, Progress
from ropewalk.solve.splitting import RUNNING
from ropewalk.solve.start import setting_of


class Chained(OnCarrier):
    """Plain lines moved from outside; see `Stepwise`."""

    def __init__(self, scenario: Scenario, outside: Mapping[str, Outside]) -> None:
        super().__init__(scenario, outside)
        run = scenario.run
        assert isinstance(run, Dynamic)
        steppers = {
            name: Stepper(on=c.on, model=Silent(), exchange=Exchange(stiffness=c.stiffness, damping=c.damping))
            for name, c in outside.items()
        }
        whole = scenario.model_copy(update={"loads": {**scenario.loads, **steppers}})
        setting = setting_of(whole, run.until)
        if setting.multibody_system is not None:
            setting = replace(setting, multibody_system=_one_sided(setting.multibody_system, outside))
        self._state, self._bodies = initial_state(setting, whole)
        self.setting = setting
        names = [wheel.name for wheel in setting.wheels]
        self._contact = {name: names.index(name) for name in outside}
        self._springs = (
            {name: setting.multibody_system.interface_coordinates.get(name, ()) for name in outside}
            if setting.multibody_system
            else {}
        )
        self._moving = None if self._bodies is None or are_weightless(self._bodies) else self._bodies
        self.choice = choose(
            setting.strands, setting.loads, self._state, method=run.method, step=run.step, accuracy=run.accuracy,
            duration=run.until, supports=setting.supports, bodies=self._moving, guided=self._bodies is not None,
        )  # fmt: skip
        assert self._bodies is not None
        self._carrier = RopeCarrier(setting, self._state, self._bodies, setting.loads)
        self._controllers = controllers_of(self._carrier, setting.loading, scenario)
        for controller in self._controllers:
            controller.begin()
        self._progress = Progress()
        self._motion = ChainMotion(
            setting.strands, setting.loads, self._state, self.choice, run.precision, self._progress, setting.supports,
            self._moving, self._controllers, self._bodies,
        )  # fmt: skip
        self._carrier.look = self._motion.look

    @property
    def t(self) -> float:  # type: ignore[override]
        """The time it has come to, s."""
        return float(self._state.t[0])

    @property
    def dim(self) -> int:
        """Number of axes."""
        return len(self.setting.axes)

    def step(self, h: float) -> None:
        """Go on by h seconds.

        Raises:
            RopewalkError: the motion does not get there.
        """
        self._press(h)
        self._motion.to(self.t + h)
        if self._progress.status != RUNNING:
            outcome, advice = self._progress.ending()
            raise RopewalkError(f"the motion stopped at t = {self.t:.6g} s ({outcome}): {advice}")
        self._go_on(h)

    def output(self, name: str) -> ContactOutput:
        """What is seen of a contact now."""
        given, on, state = self._contact_input(name), self.outside[name].on, self._state
        line, k = self._line(on), self._contact[name]
        xi = min(max(given.xi, 0.0), line.length) if np.isfinite(given.xi) else 0.0
        b = int(state.moving_load[k])
        i, j = (b - 1, b + 1) if b >= 0 else self._link(k, on, xi)
        tangent = (state.r[:, j] - state.r[:, i]) / (state.X[j] - state.X[i])
        return self._seen(name, *line.at(xi), tangent, line.length)

    def support_forces(self) -> dict[str, Array]:
        """Forces of all supports on their lines, by name, (axis,) N."""
        frame = ChainFrameBuilder(self.setting, self._bodies).build(self._state)
        names = [f"{name}.{end}" for name in self.setting.lines for end in ("start", "end")]
        return dict(zip(names, frame.reaction, strict=True))

    def get_state(self) -> Tree:
        """All that changes, copied.

        Raises:
            RopewalkError: a load is an external model that gives no state.
        """
        return {"motion": self._motion.get_state(), "status": self._progress.status, **self._inputs_given()}

    def set_state(self, state: Tree) -> None:
        """Go back to what `get_state` gave."""
        self._motion.set_state(state["motion"])
        self._give_inputs(state)
        self._progress.status = state["status"]

    def _line(self, name: str) -> ChainLine:
        return ChainLine(self.setting, self._state, self.setting.lines.index(name))

    def _link(self, k: int, on: str, xi: float) -> tuple[int, int]:
        if self._state.moving_load[k] == OFF:
            i, _ = self._line(on)._place(xi)
        else:
            i = int(link_of(self.setting.strands, self.setting.loads, self._state, k))
        return i, i + 1


def _one_sided(multibody_system: MultibodySystem, outside: Mapping[str, Outside]) -> MultibodySystem:
    """Contacts whose body may leave the line: their springs become buffers, which only push."""
    bodies = multibody_system.bodies
    sided = [name for name, contact in outside.items() if contact.side is not None and contact.is_sprung]
    if not sided:
        return multibody_system
    K, buffers = bodies.K.copy(), []
    for name in sided:
        (interface_coordinate,) = multibody_system.interface_coordinates[name]
        v = int(
            np.flatnonzero((bodies.vehicles["first"] == interface_coordinate) & (bodies.vehicles["coordinates"] == 1))[
                0
            ]
        )
        K[v] = 0.0
        buffer = np.zeros(1, bodies.buffers.dtype)
        buffer["wheel"], buffer["coordinate"] = bodies.wheel[v, 0], interface_coordinate
        buffer["stiffness"] = outside[name].stiffness
        buffer["side"] = 1 if outside[name].side == "above" else -1
        buffers.append(buffer)
    return replace(multibody_system, bodies=bodies._replace(K=K, buffers=np.concatenate([bodies.buffers, *buffers])))
