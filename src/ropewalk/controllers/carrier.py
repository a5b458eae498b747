"""Carriers: what an engine lets controllers see and do while a motion goes on.

Contacts, coordinates of bodies and legs are numbered as in `mechanics/multibody_system.py`, whatever the engine makes
of them.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol, Self

from ropewalk.checkpoint import Arrays, Tree
from ropewalk.external.cosimulation_master import ContactPush
from ropewalk.mechanics.bodies import Records
from ropewalk.mechanics.chain import Array

# Part of a link up to which a contact of a model slides to where it is said to be.
SLIDES = 0.5


class CarrierLine(Protocol):
    """A line as a load sees it while the motion continues."""

    @property
    def length(self) -> float:
        """Unstrained length, m."""

    @property
    def chord(self) -> Array:
        """From its start to its end, (axis,) m."""

    def at(self, xi: float) -> tuple[Array, Array]:
        """Position in m and velocity in m/s of the line at the unstrained length xi in m from its start, (axis,)."""

    def below(self, x: float, way: Array | None = None) -> float:
        """The xi in m of the line above or below a horizontal place x in m, along x or a level unit vector (x, y)."""

    def height(self, x: float, way: Array | None = None) -> float:
        """Height of the line in m at a horizontal place in m; beyond its ends it continues straight."""


class Carrier(Protocol):
    """A structure in motion with the loads on it."""

    @property
    def t(self) -> float:
        """Time, s."""

    @property
    def gravity(self) -> float:
        """Downwards, m/s^2."""

    @property
    def q(self) -> Array:
        """Places of the coordinates of bodies, m; to be written to."""

    @property
    def v(self) -> Array:
        """Their velocities, m/s; written to by `launch`."""

    @property
    def legs(self) -> Records:
        """Tethers: on, watch, length, full, growth, across, reach; to be written to."""

    def line(self, k: int) -> CarrierLine:
        """The line of contact k as it is now."""

    def is_on(self, k: int) -> bool:
        """Whether contact k is on its line."""

    def motion(self, k: int) -> tuple[Array, Array]:
        """Place in m and velocity in m/s of contact k, which stands on its line, (axis,)."""

    def height(self, k: int) -> float:
        """Height of contact k, or where it was last, m."""

    def set_down(self, k: int, xi: float) -> None:
        """Let contact k stand on its line at xi in m, moving as the line does."""

    def take_up(self, k: int) -> None:
        """Take contact k off its line; it is held where it is."""

    def launch(self, own: slice, v: Array) -> None:
        """Let some coordinates of bodies move at velocities in m/s from now on."""

    def hold(self, own: slice) -> None:
        """Let some coordinates of one body stand as on firm ground; what moves there is lost."""

    def couple(self, vehicle: int, own: Array, k: int | None, across: Array, stiffness: float) -> None:
        """Let one spring act on a vehicle whose elongation is `own` @ q less that of contact k along `across`.

        Args:
            vehicle: its number.
            own: (coordinate,) factors.
            k: contact; None: no spring.
            across: (axis,) direction.
            stiffness: N/m.
        """

    def give(self, work: float) -> None:
        """Book work of muscles or drives, J."""

    def lose(self, energy: float) -> None:
        """Book what loads lose, J."""

    def apply_push(self, k: int, push: ContactPush, every: float) -> None:
        """Let contact k do what a push says for some seconds: it slides on to there, or is put down anew."""

    def set_interface(self, interface_coordinate: int, height: float, rise: float) -> None:
        """Put the far end of an interface's spring somewhere, and let it go on from there."""

    def reach(self, k: int) -> float:
        """How far from where it has slid to contact k may be said to be without being put down anew, m."""

    def given(self, contacts: Iterable[int]) -> Arrays:
        """What `apply_push` has written for some contacts."""

    def stored(self, line: CarrierLine) -> Tree:
        """A line of `frozen` as data."""

    def frozen(self, k: int, tree: Tree | None = None) -> CarrierLine:
        """The line of contact k as it is now, or as it was when `stored` gave a tree, to be looked at later."""

    @property
    def looks_ahead(self) -> bool:
        """Whether twins can go on: not before the motion has begun."""

    def copy(self) -> Self:
        """A twin that may go its own way."""

    def go_on(self, h: float) -> None:
        """Move a twin on by h seconds, or up to the next decision of a person."""


class Controller(Protocol):
    """Who decides on the way what a load does: where feet stand, what a model of the user's own presses with."""

    def begin(self) -> None:
        """Take the first decisions, before anything moves."""

    def next(self, t: float) -> float:
        """The next instant after t, in s, at which to be asked again; infinity: only when something happens."""

    def act(self) -> None:
        """Decide, if it is time or something has happened."""

    def get_state(self) -> Tree:
        """All that changes in who decides, as data."""

    def set_state(self, tree: Tree) -> None:
        """Decide as who gave this."""
