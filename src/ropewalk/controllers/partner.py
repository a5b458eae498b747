"""Partners: loads that are external models."""

from __future__ import annotations

from dataclasses import dataclass, field

from ropewalk.checkpoint import Tree, copied, put
from ropewalk.controllers.carrier import Carrier, CarrierLine
from ropewalk.external.cosimulation_master import Bearer, ContactPush, CosimulationMaster, Pushes


@dataclass
class Partner(Bearer):
    """A load that is an external model, asked at equal intervals."""

    carrier: Carrier
    cosimulation: CosimulationMaster
    contacts: tuple[int, ...]
    interface_coordinates: tuple[
        int, ...
    ]  # coordinates that are the far ends of the interface's springs, one for each contact
    _looked: bool = False
    _heights: list[float] = field(default_factory=list)  # m, where contacts were at the last exchange

    def begin(self) -> None:
        """Reset the model, and ask it for the first time."""
        self.cosimulation.begin(self.line)
        self.act()

    def next(self, t: float) -> float:
        """Its next step."""
        return t if self._has_not_looked else self.cosimulation.next

    @property
    def _has_not_looked(self) -> bool:
        """Whether the first interval is to be agreed on, into which nobody could look before the motion began."""
        return self.carrier.looks_ahead and self.cosimulation.exchange.scheme == "iterated" and not self._looked

    def act(self) -> None:
        """Ask the model, if it is time: where its contacts are, and with what they press."""
        t = self.carrier.t
        if self._has_not_looked:
            self._looked = True
            self._apply_pushes(self.cosimulation.agree(t, self), self.carrier)
        if t < self.cosimulation.next * (1.0 - 1e-12):
            return
        before = [self.carrier.height(k) for k in self.contacts] if self.interface_coordinates else []
        pushes = self.cosimulation.ask(t, self)
        for number, place in enumerate(before):
            self.carrier.give(self._led(number, place, pushes[number]))
        self._apply_pushes(pushes, self.carrier)
        self._heights = [self.carrier.height(k) for k in self.contacts] if self.interface_coordinates else []

    def get_state(self) -> Tree:
        """Stored state of the exchange, and what the contacts are doing."""
        return {
            "turns": self.cosimulation.get_state(self.carrier.stored), "looked": self._looked,
            "heights": list(self._heights), "given": copied(self.carrier.given(self.contacts)),
        }  # fmt: skip

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self.cosimulation.set_state(tree["turns"], lambda line: self.carrier.frozen(self.contacts[0], line))
        self._looked, self._heights = tree["looked"], list(tree["heights"])
        put(self.carrier.given(self.contacts), tree["given"])

    def _led(self, number: int, place: float, push: ContactPush | None) -> float:
        """Work in J that has been done at the far end of an interface's spring since the last exchange, and now.

        It moved evenly; and now it is put where the model's contact has got to.
        """
        k, c, interface_coordinate = (
            self.cosimulation.exchange.stiffness,
            self.cosimulation.exchange.damping,
            self.interface_coordinates[number],
        )
        end, done = float(self.carrier.q[interface_coordinate]), 0.0
        if self._heights:
            way = float(self.carrier.v[interface_coordinate]) * self.cosimulation.every
            apart = end - way - self._heights[number], end - place
            done = (0.5 * k * (apart[0] + apart[1]) + c * (apart[1] - apart[0]) / self.cosimulation.every) * way
        to = place if push is None else push.height
        return done + 0.5 * k * ((to - place) ** 2 - (end - place) ** 2)

    @property
    def line(self) -> CarrierLine:
        """Its line."""
        return self.carrier.line(self.contacts[0])

    def frozen(self) -> CarrierLine:
        """The line as it is now, to be looked at later."""
        return self.carrier.frozen(self.contacts[0])

    def ahead(self, pushes: Pushes, h: float) -> CarrierLine | None:
        """The line as it would be after h seconds with these forces; it stays where it is."""
        if not self.carrier.looks_ahead:
            return None
        twin = self.carrier.copy()
        self._apply_pushes(pushes, twin)
        twin.go_on(h)
        return twin.line(self.contacts[0])

    def _apply_pushes(self, pushes: Pushes, carrier: Carrier) -> None:
        for number, (k, push) in enumerate(zip(self.contacts, pushes, strict=True)):
            if push is not None:
                carrier.apply_push(k, push, self.cosimulation.every)
            elif carrier.is_on(k):
                carrier.take_up(k)
            if self.interface_coordinates and push is not None:
                carrier.set_interface(self.interface_coordinates[number], push.height, push.rise)
            elif self.interface_coordinates:
                carrier.set_interface(self.interface_coordinates[number], carrier.height(k), 0.0)
