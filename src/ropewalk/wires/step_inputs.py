"""What moving loads do during a run, and what is recorded of it: in rows at equal times, each of some steps."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.wires.mesh import MovingLoads, Places
from ropewalk.wires.plan import Array, Integers

ABSENT, ON_WIRE, ON_GROUND = 0, 1, 2


class StepInputs(NamedTuple):
    """What is given at each row, and after the last one; linear in between."""

    station: Array  # (row, contact) m along the wire
    where: Integers  # (row, contact) ABSENT, ON_WIRE or ON_GROUND: level ground of the height of the wire's end
    rough: Array  # (row, contact) m, irregularity: height that the contact feels beside that of the wire
    given: Array  # (row, contact) N upwards on the wire, beside what a moving load does
    push: Array  # (row, moving load, C) N on the coordinates
    time: Array  # (row,) s
    aside: Array  # (row, contact) m, how far the wire is to the left of the middle of the moving load

    def rows(self, begin: int, end: int) -> StepInputs:
        """Some of the rows, and that after them."""
        return StepInputs(*(array[begin : end + 1] for array in self))  # type: ignore[arg-type]

    def together(self, instants: int = 1) -> StepInputs:
        """The same with a number of output instants first, each of as many rows."""
        rows = self.time.size // instants
        parts = (array.reshape(instants, rows, *array.shape[1:]) for array in self)
        return StepInputs(*parts)  # type: ignore[arg-type]


class Record(NamedTuple):
    """What is found at each row."""

    force: Array  # (row, contact) N upwards on the wire
    height: Array  # (row, contact) m, of the wire at the contact
    body: Array  # (row, moving load, C) m, coordinates
    tie: Array  # (row, tie) N, change of pull since rest
    hold: Array  # (row, hold, 3) N on the wire; in small motion its change since rest
    watched: Array  # (row, point) m, height of watched points over rest

    @staticmethod
    def of(
        rows: int, moving_loads: MovingLoads, ties: int, holds: int, watched: Places, instants: int | None = None
    ) -> Record:  # fmt: skip
        """Room for a number of rows, which come last where there is an entry for each tie, hold or watched point.

        Args:
            rows: their number.
            moving_loads, ties, holds, watched: what there is.
            instants: each of as many rows, that come first of all; None: there are none.
        """
        contacts, bodies = moving_loads.owner.size, moving_loads.mass.shape[:2]
        first = () if instants is None else (instants,)
        unknown = (np.full((*first, rows, *shape), np.nan) for shape in ((contacts,), (contacts,), bodies))
        # Zeros cost nothing until they are touched: in this order, what lies beyond a window is not.
        each = ((ties,), (holds, 3), (watched.base.size,))
        return Record(*unknown, *(np.zeros((*first, *shape, rows)) for shape in each))

    def turned(self) -> Record:
        """The same with rows before entries everywhere."""
        tie, hold, watched = (array.swapaxes(-1, -2) for array in (self.tie, self.hold, self.watched))
        return Record(self.force, self.height, self.body, tie, hold.swapaxes(-2, -3), watched)

    def together(self) -> Record:
        """The same of one output instant, which comes first."""
        return Record(*(array[None] for array in self))

    def first(self) -> Record:
        """That of the first instant alone."""
        return Record(*(array[0] for array in self))
