"""What is moved from outside, step by step: the contacts, what is seen of them, and a scenario in motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from typing_extensions import deprecated

from ropewalk.errors import RopewalkError, did_you_mean
from ropewalk.mechanics.chain import Array
from ropewalk.model.scenario import Scenario

Side = Literal["above", "below"]


@dataclass(frozen=True)
class Outside:
    """A contact that is moved from outside.

    Without stiffness and damping it presses with given forces. With them, a spring and a damper stand between the line
    and a body whose height is given: the step does not limit how fast they answer.
    """

    on: str  # name of the line
    stiffness: float = 0.0  # N/m
    damping: float = 0.0  # N s/m
    side: Side | None = None  # where the body is that may leave the line; None: it is held in both directions
    path: tuple[tuple[float, ...], ...] | None = None  # on a net: places [u, v] in m, through which it may be moved

    @property
    def is_sprung(self) -> bool:
        """Whether heights are given, and not forces."""
        return self.stiffness > 0.0


@dataclass
class ContactInput:
    """What a contact from outside does during the next step; everything linear in time over it."""

    xi: float = np.nan  # m, unstrained from the start of the line, at its beginning; NaN: it is not on the line
    speed: float = 0.0  # m/s
    first: tuple[float, ...] = (0.0,)  # (axis,) N on the line at its beginning
    last: tuple[float, ...] = (0.0,)  # and at its end
    height: float = 0.0  # m, of the body, at its beginning
    rise: float = 0.0  # m/s


class ContactOutput(NamedTuple):
    """What is seen of a contact."""

    place: Array  # (axis,) m
    velocity: Array  # (axis,) m/s, of the contact, which moves along the line
    slope: float  # dz/dx of the line
    force: Array  # (axis,) N on the line


class Stepwise:
    """A scenario in motion that is moved from outside.

    Made by `stepwise`.

    Args:
        scenario: of kind dynamic.
        outside: its contacts from outside, by name.
    """

    t = 0.0
    """The time it has come to, s."""

    def __init__(self, scenario: Scenario, outside: Mapping[str, Outside]) -> None:
        self.scenario, self.outside = scenario, dict(outside)
        self.contact_inputs = {name: ContactInput() for name in outside}

    def set_force(
        self,
        name: str,
        xi: float,
        force: float | tuple[float, ...],
        speed: float = 0.0,
        *,
        last: float | tuple[float, ...] | None = None,
    ) -> None:
        """Press on the line during the next step, and until it is told otherwise.

        Args:
            name: of the contact.
            xi: its place at the beginning of the step, m unstrained from the start of the line.
            force: on the line in N, upwards or (axis,).
            speed: along the line, m/s.
            last: force at the end of the step, linear in between; None: as at its beginning.

        Raises:
            RopewalkError: there is no such contact, it has a spring, or a force along a wire is given.
        """
        contact_input = self._contact_input(name, sprung=False)
        contact_input.xi, contact_input.speed = xi, speed
        contact_input.first = self._vector(name, force)
        contact_input.last = contact_input.first if last is None else self._vector(name, last)

    def set_motion(self, name: str, xi: float, height: float, rise: float = 0.0, speed: float = 0.0) -> None:
        """Give the height of a body on the spring of a contact during the next step.

        Args:
            name: of the contact.
            xi: its place at the beginning of the step, m unstrained from the start of the line.
            height: of the body at the beginning of the step, m.
            rise: its velocity during the step, m/s.
            speed: along the line, m/s.

        Raises:
            RopewalkError: there is no such contact, or it has no spring.
        """
        contact_input = self._contact_input(name, sprung=True)
        contact_input.xi, contact_input.speed, contact_input.height, contact_input.rise = xi, speed, height, rise

    def release(self, name: str) -> None:
        """Take a contact off its line."""
        self._contact_input(name).xi = np.nan

    @deprecated("press was renamed to set_force; the old name will be removed in the next release")
    def press(self, *given: Any, **named: Any) -> None:
        """`set_force`, as it was called before."""
        self.set_force(*given, **named)

    @deprecated("lead was renamed to set_motion; the old name will be removed in the next release")
    def lead(self, *given: Any, **named: Any) -> None:
        """`set_motion`, as it was called before."""
        self.set_motion(*given, **named)

    @deprecated("lift was renamed to release; the old name will be removed in the next release")
    def lift(self, name: str) -> None:
        """`release`, as it was called before."""
        self.release(name)

    @deprecated("sight was renamed to output; the old name will be removed in the next release")
    def sight(self, name: str) -> ContactOutput:
        """`output`, as it was called before."""
        return self.output(name)

    @property
    def dim(self) -> int:
        """Number of axes."""
        raise NotImplementedError

    def step(self, h: float) -> None:
        """Go on by h seconds.

        Raises:
            RopewalkError: the motion does not get there.
        """
        raise NotImplementedError

    def length(self, line: str) -> float:
        """Unstrained length of a line (of what is linearised, its chord), m."""
        raise NotImplementedError

    def at(self, line: str, xi: float) -> tuple[Array, Array]:
        """Position in m and velocity of the material in m/s of a line, (axis,)."""
        raise NotImplementedError

    def below(self, line: str, x: float) -> float:
        """The xi in m of a line above or below a horizontal place x in m."""
        raise NotImplementedError

    def output(self, name: str) -> ContactOutput:
        """What is seen of a contact now."""
        raise NotImplementedError

    def support_forces(self) -> dict[str, Array]:
        """Forces of all supports on their lines, by name, (axis,) N."""
        raise NotImplementedError

    def get_state(self) -> Any:
        """All that changes, copied.

        Raises:
            RopewalkError: something in it cannot go back in time.
        """
        raise NotImplementedError

    def set_state(self, state: Any) -> None:
        """Go back to what `get_state` gave."""
        raise NotImplementedError

    def _go_on(self, h: float) -> None:
        """Where contacts from outside are after a step of h seconds."""
        for contact_input in self.contact_inputs.values():
            contact_input.xi += contact_input.speed * h
            contact_input.first = contact_input.last
            contact_input.height += contact_input.rise * h

    def _contact_input(self, name: str, sprung: bool | None = None) -> ContactInput:
        if name not in self.contact_inputs:
            raise RopewalkError(f"there is no contact {name} from outside; {did_you_mean(name, self.contact_inputs)}")
        if sprung is not None and self.outside[name].is_sprung != sprung:
            has, remedy = ("no", "set_force") if sprung else ("a", "set_motion")
            raise RopewalkError(f"contact {name} has {has} spring: use {remedy}")
        return self.contact_inputs[name]

    def _vector(self, name: str, force: float | tuple[float, ...]) -> tuple[float, ...]:
        """A force on the line at a contact, (axis,) N."""
        if isinstance(force, int | float):
            return (0.0,) * (self.dim - 1) + (float(force),)
        if len(force) != self.dim:
            raise RopewalkError(f"a force of {len(force)} components was given; the scenario has {self.dim} axes")
        return tuple(map(float, force))
