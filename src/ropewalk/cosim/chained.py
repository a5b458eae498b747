"""Chains moved from outside."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from ropewalk.chains.beginning import initial_state
from ropewalk.chains.frames import ChainFrameBuilder
from ropewalk.checkpoint import Tree, copied, put
from ropewalk.controllers.assembly import controllers_of
from ropewalk.cosim.outside import ContactInput, ContactOutput, Outside, Stepwise
from ropewalk.errors import RopewalkError
from ropewalk.external.cosimulation_master import ContactPush
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


class Silent:
    """Stands for a model that is asked by nobody: its contacts are moved from outside."""

    def step(self, t: float, h: float, line: Any) -> list[Any]:
        """Press nowhere."""
        return []

    def get_state(self) -> None:
        """Nothing changes in it."""

    def set_state(self, state: None) -> None:
        """Nothing changes in it."""


class Chained(Stepwise):
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
        self._interface_coordinate = (
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
        for name, contact_input in self.contact_inputs.items():
            self._hold(name, contact_input, h)
        self._motion.to(self.t + h)
        if self._progress.status != RUNNING:
            outcome, advice = self._progress.ending()
            raise RopewalkError(f"the motion stopped at t = {self.t:.6g} s ({outcome}): {advice}")
        for contact_input in self.contact_inputs.values():
            contact_input.xi += contact_input.speed * h
            contact_input.first = contact_input.last
            contact_input.height += contact_input.rise * h

    def _hold(self, name: str, contact_input: ContactInput, h: float) -> None:
        """Let a contact do what it is told, from now on."""
        k = self._contact[name]
        length = self.length(self.outside[name].on)
        if not 0.0 <= contact_input.xi <= length:  # NaN is not, either
            if self._carrier.is_on(k):
                self._carrier.take_up(k)
            return
        # The contact stops at an end of the line: what goes on beyond it is lifted with the next step.
        end = min(max(contact_input.xi + contact_input.speed * h, 0.0), length)
        push = ContactPush(
            contact_input.xi, (end - contact_input.xi) / h, np.array(contact_input.first), np.array(contact_input.last)
        )
        self._carrier.apply_push(k, push, h)
        for interface_coordinate in self._interface_coordinate.get(name, ()):
            self._carrier.set_interface(interface_coordinate, contact_input.height, contact_input.rise)

    def length(self, line: str) -> float:
        """Unstrained length of a line, m."""
        return self._line(line).length

    def at(self, line: str, xi: float) -> tuple[Array, Array]:
        """Position in m and velocity of the material in m/s of a line, (axis,)."""
        return self._line(line).at(xi)

    def below(self, line: str, x: float) -> float:
        """The xi in m of a line above or below a horizontal place x in m."""
        return self._line(line).below(x)

    def output(self, name: str) -> ContactOutput:
        """What is seen of a contact now."""
        contact_input, outside, state, k = (
            self._contact_input(name),
            self.outside[name],
            self._state,
            self._contact[name],
        )
        line = self._line(outside.on)
        xi = min(max(contact_input.xi, 0.0), line.length) if np.isfinite(contact_input.xi) else 0.0
        place, velocity = line.at(xi)
        b = int(state.moving_load[k])
        i, j = (b - 1, b + 1) if b >= 0 else self._link(k, outside.on, xi)
        tangent = (state.r[:, j] - state.r[:, i]) / (state.X[j] - state.X[i])
        velocity = velocity + contact_input.speed * tangent
        force = np.zeros(self.dim)
        if 0.0 <= contact_input.xi <= line.length:  # at the beginning it is not on the line yet
            force = np.array(contact_input.first, dtype=np.float64) if len(contact_input.first) == self.dim else force
            if outside.is_sprung:
                apart, faster = contact_input.height - place[-1], contact_input.rise - velocity[-1]
                force[-1] = _within(outside, outside.stiffness * apart + outside.damping * faster)
        slope = float(tangent[-1] / tangent[0]) if tangent[0] else np.inf
        return ContactOutput(place, velocity, slope, force)

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
        pressed = copied(self._carrier.given(self._contact.values()))
        contact_inputs = {name: asdict(contact_input) for name, contact_input in self.contact_inputs.items()}
        return {
            "motion": self._motion.get_state(),
            "given": pressed,
            "hands": contact_inputs,
            "status": self._progress.status,
        }

    def set_state(self, state: Tree) -> None:
        """Go back to what `get_state` gave."""
        self._motion.set_state(state["motion"])
        put(self._carrier.given(self._contact.values()), state["given"])
        self._progress.status = state["status"]
        self.contact_inputs.update(
            {name: ContactInput(**contact_input) for name, contact_input in state["hands"].items()}
        )

    def _line(self, name: str) -> ChainLine:
        return ChainLine(self.setting, self._state, self.setting.lines.index(name))

    def _link(self, k: int, on: str, xi: float) -> tuple[int, int]:
        if self._state.moving_load[k] == OFF:
            i, _ = self._line(on)._place(xi)
        else:
            i = int(link_of(self.setting.strands, self.setting.loads, self._state, k))
        return i, i + 1


def _within(outside: Outside, force: float) -> float:
    """A force on the line that a body on one side can exert."""
    if outside.side is None:
        return force
    return min(force, 0.0) if outside.side == "above" else max(force, 0.0)


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
