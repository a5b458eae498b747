"""Balance to the side: where a person puts her feet across the line, and which of them bears.

Seen across the line, the body is an inverted pendulum whose foot stands `offset` beside the line,

    m y'' = -F,    F = k (line + offset - y),    k = m g/height

with the force F on the line. These are springs of negative stiffness between body, line and foot
(mechanics/multibody_system.py), so that momentum is handed over exactly and the pendulum's energy
-k (y - line - offset)^2 / 2 stands in the audit. Only a step changes the offset, or which place of the line is meant:
what this adds to the energy, muscles give.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.controllers.carrier import Carrier
from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array
from ropewalk.model.balance import Balance
from ropewalk.model.footsteps import FirstFoot

# A walker has fallen when her body leans to the side of her foot by this part of its height.
FALLEN = 0.7


@dataclass
class Upright:
    """Who keeps a person upright to the side."""

    carrier: Carrier
    balance: Balance
    mass: float  # kg
    first_foot: FirstFoot
    feet: tuple[int, int]
    own: slice  # coordinates of the body; that after them is the offset of the foot that bears
    vehicle: int
    left: Array  # (axis,) unit vector
    to_left: Array  # of the coordinates of the body, what they contribute to its place along that
    bears: int | None = None  # the foot that bears, of the two
    offsets: list[float] = field(default_factory=lambda: [0.0, 0.0])  # of the feet from the line, m

    @property
    def _rate(self) -> float:
        """Angular rate at which the pendulum falls, rad/s."""
        return math.sqrt(self.carrier.gravity / self.balance.height)

    def _side(self, foot: int) -> float:
        return 1.0 if (foot == 0) == (self.first_foot == "left") else -1.0

    def _lean(self, foot: int) -> tuple[float, float]:
        """How far in m, and how fast in m/s, the body is away from the place of the line where a foot stands."""
        place, speed = self.carrier.motion(self.feet[foot])
        q, v = self.carrier.q[self.own], self.carrier.v[self.own]
        return float(self.to_left @ q - self.left @ place), float(self.to_left @ v - self.left @ speed)

    def begin(self, foot: int, step: float, left: float) -> None:
        """Be where a steady walk would be: over the first foot, on the way from the one before it to the next.

        From landing to landing the body swings as cosh about the foot. Whatever is amiss decays within a few steps.

        Args:
            foot: that stands.
            step: time from landing to landing, s.
            left: of that until the next landing, s.
        """
        a = self._rate
        away, _ = self._lean(foot)
        self.carrier.q[self.own] -= away * self.to_left
        nearest = self.balance.width * math.exp(0.5 * a * step)  # to the foot, in the middle of a step
        since = 0.5 * step - left
        offset = self._side(foot) * nearest * math.cosh(0.5 * a * step)
        lean = offset - self._side(foot) * nearest * math.cosh(a * since)
        speed = -self._side(foot) * nearest * a * math.sinh(a * since)
        _, line = self._lean(foot)
        self.carrier.q[self.own] += lean * self.to_left
        self.carrier.launch(self.own, self.carrier.v[self.own] + (speed - line) * self.to_left)
        self._bear(foot, offset)

    def step(self, foot: int) -> None:
        """Put a foot down next to where the body is falling to, and let it bear."""
        before = self._energy()
        away, speed = self._lean(foot)
        self._bear(foot, away + speed / self._rate + self._side(foot) * self.balance.width)
        self.carrier.give(self._energy() - before)

    def lift(self, foot: int, loaded: list[int]) -> None:
        """Take a foot up; if it was bearing, one that still stands bears again."""
        if foot != self.bears:
            return
        before = self._energy()
        left = loaded[-1] if loaded else None
        self._bear(left, self.offsets[left] if left is not None else 0.0)
        self.carrier.give(self._energy() - before)

    def check(self, name: str) -> None:
        """See to it that she has not fallen to the side.

        Raises:
            RopewalkError: she has.
        """
        if self.bears is None:
            return
        away, _ = self._lean(self.bears)
        if abs(away - self.offsets[self.bears]) > FALLEN * self.balance.height:
            raise RopewalkError(
                f"load {name} has fallen to the side: balance needs a line that is stiffer to the side than m "
                f"g/height = {self._stiffness:.4g} N/m, and moves slower than the walker; use a heavier and tighter "
                "line, such as a deck, or leave balance out"
            )

    def get_state(self) -> Tree:
        """Which foot bears, and where they stand."""
        return {"bears": self.bears, "offsets": list(self.offsets)}

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""
        self.bears, self.offsets = tree["bears"], list(tree["offsets"])

    def rest(self) -> None:
        """Stand still, upright over the line."""
        self.carrier.give(-self._energy())
        self._bear(None, 0.0)

    @property
    def energy(self) -> float:
        """Of the body's motion and of the pendulum, J."""
        v = self.carrier.v[self.own]
        return 0.5 * self.mass * float(v @ v) + self._energy()

    def _energy(self) -> float:
        """Of the pendulum, J."""
        if self.bears is None:
            return 0.0
        away, _ = self._lean(self.bears)
        return -0.5 * self._stiffness * (away - float(self.carrier.q[self.own.stop])) ** 2

    @property
    def _stiffness(self) -> float:
        return self.mass * self._rate**2

    def _bear(self, foot: int | None, offset: float) -> None:
        self.bears = foot
        self.carrier.q[self.own.stop] = offset
        if foot is not None:
            self.offsets[foot] = offset
        own = np.append(self.to_left, -1.0)  # what of the elongation body and offset make
        k = None if foot is None else self.feet[foot]
        self.carrier.couple(self.vehicle, own, k, self.left, -self._stiffness)
