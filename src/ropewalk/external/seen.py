"""What an external model sees of its line: as it is, or as it was foreseen to be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from ropewalk.external.protocol import LineView
from ropewalk.mechanics.chain import Array


@dataclass(slots=True)
class Seen:
    """A line at an instant, and the forces that the contacts of one model have exerted on it."""

    line: LineView
    forces: Callable[[LineView, int], Array]
    looked: dict[float, tuple[Array, Array]] = field(default_factory=dict)  # a place is often looked at twice

    @property
    def length(self) -> float:
        return self.line.length

    def at(self, xi: float) -> tuple[Array, Array]:
        found = self.looked.get(xi)
        if found is None:
            found = self.looked[xi] = self.line.at(xi)
        return found

    def below(self, x: float) -> float:
        return self.line.below(x)

    def force(self, number: int = 0) -> Array:
        return self.forces(self, number)


class ForeseenContact(NamedTuple):
    """Where a contact is foreseen to be."""

    xi: float  # m
    place: Array  # (axis,) m


@dataclass(frozen=True)
class Foreseen:
    """A line as it would be a while later: contacts go on as they did, particles elsewhere keep their velocities."""

    line: LineView
    later: float  # s
    courses: list[ForeseenContact]
    reach: float  # m, from a contact, within which its course tells

    @property
    def length(self) -> float:
        return self.line.length

    def at(self, xi: float) -> tuple[Array, Array]:
        place, velocity = self.line.at(xi)
        for course in self.courses:
            # Beside a contact that moves along, particles jump in their velocity: theirs is not that of the contact.
            if abs(xi - course.xi) <= self.reach:
                return course.place, velocity
        return place + self.later * velocity, velocity

    def below(self, x: float) -> float:
        return self.line.below(x)
