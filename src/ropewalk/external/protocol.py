"""The step protocol: what a line and an external model know of each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array


class LineView(Protocol):
    """The line as a model sees it."""

    @property
    def length(self) -> float:
        """Unstrained length, m."""

    def at(self, xi: float) -> tuple[Array, Array]:
        """Position in m and velocity in m/s of the line at the unstrained length xi in m from its start, (axis,)."""

    def below(self, x: float) -> float:
        """The xi in m of the line above or below a horizontal place x in m."""


class SeenLine(LineView, Protocol):
    """The same with what a model's own contacts do to it."""

    def force(self, number: int = 0) -> Array:
        """Mean force in N on the line at a contact of the model since it was asked last, (axis,)."""


class Touch(NamedTuple):
    """A contact as a model answers it; it may as well answer (xi, force) or (xi, force, speed)."""

    xi: float  # m, unstrained, from the start of the line
    force: Any  # (axis,) N, on the line
    speed: float = 0.0  # m/s, along the line, until it is asked again
    motion: tuple[float, float] | None = None  # m and m/s, height of the contact itself where the model gives that


class Model(Protocol):
    """What a model must have: `step`. `contacts`, `reset`, `get_state`, `set_state` and `close` are used if present.

    `contacts` is the most contacts that it may have at a time (1 without it), and `reset(line)` is called once before
    the first step. `get_state()` gives anything from which `set_state(state)` makes the model what it was: the iterated
    scheme needs both, and so does a run that is to be taken up again from its file. For that the state must be data, or
    `pack_state(state)` gives data and `unpack_state(data)` the state. `close()` is called when the run has ended,
    however it did.
    """

    def step(self, t: float, h: float, line: SeenLine) -> Sequence[Any]:
        """Go on to time t in s, which is h after the last, with the line as it is then; answer with all contacts.

        It is asked for the first time at t = 0, where it has not gone on yet. It will be asked next at t + h.
        """


def touches(name: str, answer: Any, t: float, most: int, dim: int) -> list[Touch]:
    """Read the answer of a model.

    Args:
        name: of the load.
        answer: what `step` gave.
        t: when, s.
        most: how many contacts it may have.
        dim: number of axes.

    Raises:
        RopewalkError: there are too many contacts, or they are not as the protocol says.
    """
    try:
        found = list(answer)
    except TypeError as error:
        raise RopewalkError(
            f"load {name}: at t = {t:g} s its model gave {answer!r}; expected a list of contacts (xi, [Fx, Fz])"
        ) from error
    if len(found) > most:
        raise RopewalkError(
            f"load {name}: its model has {len(found)} contacts at t = {t:g} s, but declares contacts = "
            f"{most}; give the class an attribute contacts with the most it may have"
        )
    return [_touch(name, each, t, dim) for each in found]


def _touch(name: str, answer: Any, t: float, dim: int) -> Touch:
    try:
        xi, force = float(answer[0]), [float(component) for component in answer[1]]
        speed = float(answer[2]) if len(answer) > 2 else 0.0
        motion = answer[3] if len(answer) > 3 else None
        if motion is not None:
            motion = (float(motion[0]), float(motion[1]))
    except (TypeError, ValueError, IndexError) as error:
        raise RopewalkError(
            f"load {name}: at t = {t:g} s its model gave {answer!r}; each contact is (xi, [Fx, Fz]) or "
            "(xi, [Fx, Fz], speed)"
        ) from error
    if len(force) != dim or not all(map(math.isfinite, (xi, speed, *force, *(motion or ())))):
        raise RopewalkError(
            f"load {name}: at t = {t:g} s its model gave {answer!r}; expected finite numbers and "
            f"{dim} components of the force"
        )
    return Touch(xi, np.array(force), speed, motion)
