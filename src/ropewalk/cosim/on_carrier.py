"""Contacts from outside on what an engine lets controllers see: `ropewalk.controllers.carrier.Carrier`."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from ropewalk.checkpoint import Tree, copied, put
from ropewalk.controllers.carrier import Carrier, CarrierLine
from ropewalk.cosim.outside import ContactInput, ContactOutput, Outside, Stepwise
from ropewalk.external.cosimulation_master import ContactPush
from ropewalk.mechanics.chain import Array


class Silent:
    """Stands for a model that is asked by nobody: its contacts are moved from outside."""

    def step(self, t: float, h: float, line: Any) -> list[Any]:
        """Press nowhere."""
        return []

    def get_state(self) -> None:
        """Nothing changes in it."""

    def set_state(self, state: None) -> None:
        """Nothing changes in it."""


class OnCarrier(Stepwise):
    """Lines moved from outside whose engine has a carrier; see `Stepwise`."""

    _carrier: Carrier
    _contact: Mapping[str, int]  # numbers of the contacts from outside
    _springs: Mapping[str, Sequence[int]]  # and where their springs begin, as coordinates

    @abstractmethod
    def _line(self, name: str) -> CarrierLine:
        """A line as it is now."""

    def _press(self, h: float) -> None:
        """Let all contacts do what they are told, from now on and for h seconds."""
        for name, given in self.contact_inputs.items():
            k, length = self._contact[name], self.length(self.outside[name].on)
            if not 0.0 <= given.xi <= length:  # NaN is not, either
                if self._carrier.is_on(k):
                    self._carrier.take_up(k)
                continue
            # The contact stops at an end of the line: what continues beyond it is lifted with the next step.
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

    def _seen(self, name: str, place: Array, velocity: Array, tangent: Array, length: float) -> ContactOutput:
        """What is seen of a contact at a place in m, where the material has a velocity in m/s, on a line so long, m."""
        given, outside = self._contact_input(name), self.outside[name]
        velocity, force = velocity + given.speed * tangent, np.zeros(self.dim)
        if 0.0 <= given.xi <= length:  # at the beginning it is not on the line yet
            force = np.array(given.first, dtype=np.float64) if len(given.first) == self.dim else force
            if outside.is_sprung:
                apart, faster = given.height - place[-1], given.rise - velocity[-1]
                force[-1] = _within(outside, outside.stiffness * apart + outside.damping * faster)
        slope = float(tangent[-1] / tangent[0]) if tangent[0] else np.inf
        return ContactOutput(place, velocity, slope, force)

    def _inputs_given(self) -> Tree:
        """What contacts are told, copied."""
        inputs = {name: asdict(contact_input) for name, contact_input in self.contact_inputs.items()}
        return {"given": copied(self._carrier.given(self._contact.values())), "hands": inputs}

    def _give_inputs(self, state: Tree) -> None:
        """Go back to what `_inputs_given` gave."""
        put(self._carrier.given(self._contact.values()), state["given"])
        self.contact_inputs.update({name: ContactInput(**own) for name, own in state["hands"].items()})


def _within(outside: Outside, force: float) -> float:
    """A force on the line that a body on one side can exert."""
    if outside.side is None:
        return force
    return min(force, 0.0) if outside.side == "above" else max(force, 0.0)
