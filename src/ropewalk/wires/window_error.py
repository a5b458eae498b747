"""Difference between the motion in a window and that of the whole line: both are computed for a while, and compared.

As long as no wave returns from the borders of a window three times as wide, that one is the whole line for its
contacts. Both begin at rest, at the beginning and once more so that the end of the run is their end.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ropewalk.results.contact_statistics import filtered
from ropewalk.wires.large import LargeMotion
from ropewalk.wires.plan import Array
from ropewalk.wires.small import SmallMotion
from ropewalk.wires.step_inputs import ON_WIRE, StepInputs

_WIDER = 3.0  # times as wide is what a window is compared with, for as many times as waves take to come back from it
_WAY = 6.0  # widths that contacts travel meanwhile, where no wave comes back
_LAST = 2.0 / 3.0  # of that time, which counts: in the first third nothing may have come back
_GROWTH = 1.2, 2.0  # of a width that is too narrow, at least and at most
_ORDER = 1.5  # of the error in the width, on overhead lines


class WindowError(NamedTuple):
    """By how much a window changes the motion of contacts, root mean squares; the largest of all contacts."""

    height: float  # m, of the wire under a contact
    force: float  # N, of a contact up to 20 Hz


def returns_after(c: float, speeds: Sequence[float]) -> float:
    """After how many s waves at c in m/s come back from the borders of a window of 1 m to the first of some contacts.

    W / (c - v) to the border towards which a contact moves at v, and W / (c + v) back; as long the other way. Infinite:
    none comes back.
    """
    return min((2.0 * c / (c**2 - v**2) for v in speeds if v < c), default=np.inf)


class WindowMeasure:
    """What the error of a window is found with.

    Args:
        motion: in its first state, and left so; its window in another width.
        given: what is given from an instant in s on, for so many rows.
        sample: s, of a row.
        rows: that the motion goes on by at once.
        steps: of each row.
        until: end of the run, s.
        returns: after how many s waves come back from the borders of a window of 1 m; infinite: none does.
        speed: m/s, of the fastest contact.
    """

    def __init__(
        self, motion: LargeMotion | SmallMotion, given: Callable[[float, int], StepInputs], sample: float, rows: int,
        steps: int, until: float, returns: float, speed: float,
    ) -> None:  # fmt: skip
        self._motion, self._given, self._sample, self._rows, self._steps = motion, given, sample, rows, steps
        self._until, self._returns, self._speed = until, returns, speed

    def of(self, width: float) -> WindowError:
        """The error of a window of a half width in m."""
        seconds = self._until
        if np.isfinite(self._returns):
            seconds = min(seconds, _WIDER * self._returns * width)
        elif self._speed > 0.0:
            seconds = min(seconds, _WAY * width / self._speed)
        count = max(1, round(seconds / self._sample))
        begins = {0.0, self._sample * max(round(self._until / self._sample) - count, 0)}
        found = [self._between(begin, count, width) for begin in begins]
        return WindowError(*np.max(found, axis=0).tolist())

    def enough(self, first: float, accuracy: float, widest: float) -> tuple[float, WindowError]:
        """A width in m with which the height under contacts is as accurate as wanted, and its error.

        Args:
            first: m, to begin with.
            accuracy: m, root mean square.
            widest: m, beyond which the window is given up: all moves, without an error.
        """
        width = first
        while width < widest:
            error = self.of(width)
            if error.height <= accuracy:
                return width, error
            width = float(np.ceil(width * np.clip((error.height / accuracy) ** (1.0 / _ORDER), *_GROWTH)))
        return np.inf, WindowError(0.0, 0.0)

    def _between(self, begin: float, count: int, width: float) -> WindowError:
        """The error in so many rows from an instant in s on."""
        motion = self._motion
        state, found = motion.get_state(), []
        for each in (_WIDER * width, width):
            motion.set_window(each)
            found.append(self._moved(begin, count))
            motion.set_state(state)
        (force, height), (one, other) = found
        last = slice(int((1.0 - _LAST) * count), None)
        forces = np.stack([filtered(column, self._sample) for column in (force - one).T], axis=1)
        return WindowError(_rms((height - other)[last]), _rms(forces[last]))

    def _moved(self, begin: float, count: int) -> tuple[Array, Array]:
        """Forces in N and heights in m at all contacts in so many rows, (row, contact); NaN where they are not."""
        parts = []
        for row in range(0, count, self._rows):
            inputs = self._given(begin + self._sample * row, min(self._rows, count - row))
            record, on = self._motion.go(inputs, self._steps), inputs.where[:-1] == ON_WIRE
            parts.append([np.where(on, each, np.nan) for each in (record.force, record.height)])
        force, height = (np.concatenate(each) for each in zip(*parts, strict=True))
        return force, height


def _rms(difference: Array) -> float:
    """Root mean square of what differs, (row, contact), of the contact where it is largest; 0 where there is none."""
    there = np.isfinite(difference)
    square = np.where(there, difference, 0.0) ** 2
    return float(np.sqrt((square.sum(axis=0) / np.maximum(there.sum(axis=0), 1)).max(initial=0.0)))
