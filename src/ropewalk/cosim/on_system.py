"""What the engine of the system moves, moved from outside: joined lines, lines over sheaves and in wind, nets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from ropewalk.capabilities import SYSTEM
from ropewalk.checkpoint import Tree, copied, put
from ropewalk.cosim.chained import Silent
from ropewalk.cosim.outside import ContactInput, ContactOutput, Outside, Stepwise
from ropewalk.errors import Problem, RopewalkError, ScenarioError
from ropewalk.external.cosimulation_master import ContactPush
from ropewalk.mechanics.chain import Array
from ropewalk.model.capabilities import refusal
from ropewalk.model.exchange import Exchange
from ropewalk.model.missing import missing
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.stepper import Stepper
from ropewalk.results.frame import RunInfo
from ropewalk.system.dynamics.carrier import SystemLine
from ropewalk.system.dynamics.moving import SystemMotion

_WHAT = "joined lines, lines over sheaves, saddles and in wind, inextensible lines and nets"
_NEVER = 1e9  # s, after which contacts from outside would be asked for the first time
_BESIDE = 0.5  # of a link, on both sides of a contact, over which its slope is taken


class OnSystem(Stepwise):
    """Joined lines, lines over sheaves, saddles and in wind, inextensible lines, nets; see `Stepwise`.

    Raises:
        ScenarioError: the engine does not move such lines, or not with such contacts.
    """

    def __init__(self, scenario: Scenario, outside: Mapping[str, Outside]) -> None:
        super().__init__(scenario, outside)
        run = scenario.run
        assert isinstance(run, Dynamic)
        contacts = {name: _stepper(scenario, name, contact) for name, contact in outside.items()}
        whole = scenario.model_copy(update={"loads": {**scenario.loads, **contacts}})
        for found in SYSTEM.motion.unsupported(whole.parts):
            raise refusal(found)
        for name, contact in outside.items():
            if contact.side is not None and contact.is_sprung:
                feature, remedy = "a body from outside that may leave its line", "leave side out: the body is held"
                raise refusal(missing((f"contact {name}", "side"), _WHAT, contact.side, remedy, feature=feature))
        self._motion = SystemMotion(whole, RunInfo(), np.array([0.0, run.until]))
        self._carrier = self._motion.carrier
        names = [wheel.name for wheel in self._motion.loading.wheels]
        self._contact = {name: names.index(name) for name in outside}
        bodies = self._motion.loading.multibody_system
        self._springs = {} if bodies is None else {n: bodies.interface_coordinates.get(n, ()) for n in outside}

    @property
    def t(self) -> float:  # type: ignore[override]
        """The time it has come to, s."""
        return float(self._motion.state.t[0])

    @property
    def dim(self) -> int:
        """Number of axes."""
        return int(self._motion.rest.shape[0])

    def step(self, h: float) -> None:
        """Go on by h seconds.

        Raises:
            RopewalkError: the motion does not get there.
        """
        for name, contact_input in self.contact_inputs.items():
            self._press(name, contact_input, h)
        self._carrier.system.settle()
        self._motion.times = np.array([self.t, self.t + h])
        if (ending := self._motion.advance(1)) is not None:
            raise RopewalkError(f"the motion stopped ({ending.outcome}): {ending.advice}")
        for contact_input in self.contact_inputs.values():
            contact_input.xi += contact_input.speed * h
            contact_input.first = contact_input.last
            contact_input.height += contact_input.rise * h

    def _press(self, name: str, given: ContactInput, h: float) -> None:
        """Let a contact do what it is told, from now on."""
        k, length = self._contact[name], self.length(self.outside[name].on)
        if not 0.0 <= given.xi <= length:  # NaN is not, either
            if self._carrier.is_on(k):
                self._carrier.take_up(k)
            return
        # The contact stops at an end of the line: what goes on beyond it is lifted with the next step.
        end = min(max(given.xi + given.speed * h, 0.0), length)
        push = ContactPush(given.xi, (end - given.xi) / h, np.array(given.first), np.array(given.last))
        self._carrier.apply_push(k, push, h)
        for spring in self._springs.get(name, ()):
            self._carrier.set_interface(spring, given.height, given.rise)

    def length(self, line: str) -> float:
        """Unstrained length of a line, or of the path of contacts on a net, m."""
        return self._line(line).length

    def at(self, line: str, xi: float) -> tuple[Array, Array]:
        """Position in m and velocity of the material in m/s of a line, (axis,)."""
        return self._line(line).at(xi)

    def below(self, line: str, x: float) -> float:
        """The xi in m of a line above or below a horizontal place x in m."""
        return self._line(line).below(x)

    def _line(self, name: str) -> SystemLine:
        for own, k in self._contact.items():
            if self.outside[own].on == name:
                return self._carrier.line(k)
        number = list(dict.fromkeys(self._motion.assembled.line)).index(name)
        state = self._motion.state
        return SystemLine(self._motion.structure, number, state.r, state.v, [])

    def output(self, name: str) -> ContactOutput:
        """What is seen of a contact now."""
        given, outside, line = self._contact_input(name), self.outside[name], self._carrier.line(self._contact[name])
        xi = min(max(given.xi, 0.0), line.length) if np.isfinite(given.xi) else 0.0
        place, velocity = line.at(xi)
        aside = _BESIDE * float(self._motion.structure.runs.h[self._motion.structure.lines.first[line.number]])
        behind, ahead = max(xi - aside, 0.0), min(xi + aside, line.length)
        tangent = (line.spline(ahead)[0] - line.spline(behind)[0]) / (ahead - behind)
        velocity, force = velocity + given.speed * tangent, np.zeros(self.dim)
        if 0.0 <= given.xi <= line.length:  # at the beginning it is not on the line yet
            force = np.array(given.first, dtype=np.float64) if len(given.first) == self.dim else force
            if outside.is_sprung:
                apart, faster = given.height - place[-1], given.rise - velocity[-1]
                force[-1] = outside.stiffness * apart + outside.damping * faster
        slope = float(tangent[-1] / tangent[0]) if tangent[0] else np.inf
        return ContactOutput(place, velocity, slope, force)

    def support_forces(self) -> dict[str, Array]:
        """Forces of all supports on their lines, by name, (axis,) N."""
        note = self._motion.note()
        assert note is not None
        reaction = self._motion.frames([note]).of["reaction"][0]
        return dict(zip(self._motion.layout.support, reaction, strict=True))

    def get_state(self) -> Tree:
        """All that changes, copied.

        Raises:
            RopewalkError: a load is an external model that gives no state.
        """
        given = {name: asdict(contact_input) for name, contact_input in self.contact_inputs.items()}
        pressed = copied(self._carrier.given(self._contact.values()))
        return {"motion": self._motion.get_state(), "given": pressed, "hands": given}

    def set_state(self, state: Tree) -> None:
        """Go back to what `get_state` gave."""
        self._motion.set_state(state["motion"])
        put(self._carrier.given(self._contact.values()), state["given"])
        self.contact_inputs.update({name: ContactInput(**own) for name, own in state["hands"].items()})


def _stepper(scenario: Scenario, name: str, contact: Outside) -> Stepper:
    """The load that stands for a contact from outside: a model that is asked by nobody."""
    own: dict[str, Any] = {}
    if contact.on in scenario.nets:
        loads = [load for load in scenario.loads.values() if load.on == contact.on]
        paths = (getattr(load, "path", None) or load.travel.path for load in loads)  # type: ignore[union-attr]
        own["path"] = contact.path or next(paths, None)
        if own["path"] is None:
            remedy = "give it a path, or let a load of the scenario travel there, whose path it takes"
            raise ScenarioError([Problem(f"contact {name}", "on a net it needs a path", contact.on, remedy)])
    exchange = Exchange(stiffness=contact.stiffness, damping=contact.damping)
    return Stepper(on=contact.on, model=Silent(), every=_NEVER, exchange=exchange, **own)
