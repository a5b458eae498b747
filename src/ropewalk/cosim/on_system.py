"""What the engine of the system moves, moved from outside: joined lines, lines over sheaves and in wind, nets."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ropewalk.capabilities import SYSTEM
from ropewalk.checkpoint import Tree
from ropewalk.cosim.on_carrier import OnCarrier, Silent
from ropewalk.cosim.outside import ContactOutput, Outside
from ropewalk.errors import Problem, RopewalkError, ScenarioError
from ropewalk.mechanics.chain import Array
from ropewalk.model.capabilities import refusal
from ropewalk.model.exchange import Exchange
from ropewalk.model.missing import missing
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.model.stepper import Stepper
from ropewalk.results.frame import RunInfo
from ropewalk.system.dynamics.carrier import SystemCarrier, SystemLine
from ropewalk.system.dynamics.moving import SystemMotion

_WHAT = "joined lines, lines over sheaves, saddles and in wind, inextensible lines and nets"
_NEVER = 1e9  # s, after which contacts from outside would be asked for the first time
_BESIDE = 0.5  # of a link, on both sides of a contact, over which its slope is taken


class OnSystem(OnCarrier):
    """Joined lines, lines over sheaves, saddles and in wind, inextensible lines, nets; see `Stepwise`.

    Raises:
        ScenarioError: the engine does not move such lines, or not with such contacts.
    """

    _carrier: SystemCarrier

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
        self._press(h)
        self._carrier.system.settle()
        self._motion.times = np.array([self.t, self.t + h])
        if (ending := self._motion.advance(1)) is not None:
            raise RopewalkError(f"the motion stopped ({ending.outcome}): {ending.advice}")
        self._go_on(h)

    def _line(self, name: str) -> SystemLine:
        for own, k in self._contact.items():
            if self.outside[own].on == name:
                return self._carrier.line(k)
        number = list(dict.fromkeys(self._motion.assembled.line)).index(name)
        state = self._motion.state
        return SystemLine(self._motion.structure, number, state.r, state.v, [])

    def output(self, name: str) -> ContactOutput:
        """What is seen of a contact now."""
        given, line = self._contact_input(name), self._carrier.line(self._contact[name])
        xi = min(max(given.xi, 0.0), line.length) if np.isfinite(given.xi) else 0.0
        aside = _BESIDE * float(self._motion.structure.runs.h[self._motion.structure.lines.first[line.number]])
        behind, ahead = max(xi - aside, 0.0), min(xi + aside, line.length)
        tangent = (line.way(ahead)[0] - line.way(behind)[0]) / (ahead - behind)
        return self._seen(name, *line.at(xi), tangent, line.length)

    def support_forces(self) -> dict[str, Array]:
        """Forces of all supports on their lines, by name, (axis,) N."""
        reaction = self._motion.frames([self._motion.note_present()]).of["reaction"][0]
        return dict(zip(self._motion.layout.support, reaction, strict=True))

    def get_state(self) -> Tree:
        """All that changes, copied.

        Raises:
            RopewalkError: a load is an external model that gives no state.
        """
        return {"motion": self._motion.get_state(), **self._inputs_given()}

    def set_state(self, state: Tree) -> None:
        """Go back to what `get_state` gave."""
        self._motion.set_state(state["motion"])
        self._give_inputs(state)


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
