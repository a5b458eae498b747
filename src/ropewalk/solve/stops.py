"""The stops of a motion of plain lines: from stop to stop in one call, with a note at each output instant.

Python wakes when all stops are done, or where it has to look: at a motion that ends, a step to be chosen anew, or one
stop that takes more steps than a call may.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.chain import Array, ChainState, Integers
from ropewalk.mechanics.compiled import lean
from ropewalk.mechanics.notes import STEPS, Notes, write_note
from ropewalk.solve.splitting import NOT_FINITE, RUNNING, advance_to
from ropewalk.solve.strained import LENGTH, REST, STIFFNESS, TENSION, find_extremes

# What a kernel says where Python is to choose the step anew.
LOOK = 8
# No law holds so far: a link that is stretched to this many times its length has torn.
LONGEST_STRETCH = 100.0
# Part of the time by which instants that are meant to be the same differ.
NEXT_TO_NOTHING = 1e-14


class Stops(NamedTuple):
    """Where a motion goes, and what is looked at there."""

    time: Array  # (stop,) s
    is_output: Integers  # (stop,) 1: an output instant, 0: a corner of a table, at which only steps end
    calm: Array  # (strand,) N, stiffness of a link up to which the step stays as it is
    pushed: Array  # (strand,) N, tension of a link below which it does not
    extremes: Array  # (strand, 4) as `strained` gives them, at the last output instant
    notes: Notes

    @staticmethod
    def to(time: float, noted: int = len(ChainState._fields)) -> Stops:
        """To one instant, at which nothing is looked at; kernels are compiled for a number of arrays that are noted."""
        nothing = np.zeros(0)
        return Stops(
            np.array([time]), np.zeros(1, dtype=np.int64), nothing, nothing, np.zeros((0, 4)),
            Notes.empty((nothing,) * noted, 0),
        )  # fmt: skip


@lean
def advance(strands, loads, state, buffers, kicks, drifts, stops, longest, most, ends=None, bodies=None):
    """Move `state` along its stops.

    Args:
        strands, loads, state, buffers, kicks, drifts, ends, bodies: as of `advance_to`.
        stops: its stops; notes and extremes are written.
        longest: largest step, s.
        most: largest number of steps to one stop.

    Returns:
        Status (RUNNING when all stops are done, LOOK when the step is to be chosen anew, else what went wrong) and the
        number of steps taken.
    """
    steps = 0
    for i in range(stops.time.size):
        stop = stops.time[i]
        if state.t[0] < stop:
            if stop - state.t[0] < NEXT_TO_NOTHING * stop:  # corners of two tables: no step is so short
                state.t[0] = stop
            else:
                status, taken = advance_to(
                    strands, loads, state, buffers, kicks, drifts, stop, longest, most, ends, bodies
                )  # fmt: skip
                steps += taken
                stops.notes.gone[STEPS] += taken
                if status != RUNNING:
                    return status, steps
        if stops.is_output[i] == 0:
            continue
        looks = False
        find_extremes(strands.first, strands.links, strands.law, state.r, state.X, stops.extremes)
        for s in range(strands.first.size):
            own = stops.extremes[s]
            if not own[LENGTH] < LONGEST_STRETCH * own[REST]:  # or not a number
                return NOT_FINITE, steps  # only a motion without bounds can have stretched a link so far
            looks = looks or own[STIFFNESS] > stops.calm[s] or own[TENSION] < stops.pushed[s]
        write_note(stops.notes)
        if looks:
            return LOOK, steps
    return RUNNING, steps
