"""Intervals of a motion of the system: from output instant to output instant in one call, with a note at each."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.mechanics.compiled import lean
from ropewalk.mechanics.notes import STEPS, Notes, write_note
from ropewalk.system.dynamics.motion import LOOK, NOT_FINITE, RUNNING, advance_by
from ropewalk.system.loads.bodies import BodyArrays, with_step

NOTED = 17  # arrays that are noted: kernels are compiled for so many
KINDS = 16  # lengths of steps of one intervals: between outputs they are as long as ever, but for rounding


class Intervals(NamedTuple):
    """Output instants to which a motion goes on without Python, and what is noted there."""

    end: Array  # (instant,) s
    dt: Array  # (instant,) s, of the steps that lead there
    steps: Integers  # (instant,) their number
    inverse: Array  # (kind, 2, part, size, size) of `BodyArrays.inverse`, for all lengths of steps
    kind: Integers  # (instant,) which of these
    reaction: Array  # (restraint, axis) N, room
    elastic: Array  # (1,) J, what is stored in lines and contacts at the last instant
    notes: Notes

    @staticmethod
    def through(
        begin: float, times: Array, longest: float, most: int, bodies: BodyArrays, notes: Notes, elastic: Array,
        reaction: Array,
    ) -> Intervals:  # fmt: skip
        """Through some instants in s, by equal steps between two; to fewer, if steps are of many lengths or too many.

        Args:
            begin: s, where it begins.
            times: (instant,) s.
            longest: s, the most that a step may be.
            most: number of steps to one instant that a call may take.
            bodies: what has a mass.
            notes: room for that many.
            elastic, reaction: see above.
        """
        span = np.diff(times, prepend=begin)
        steps = np.maximum(np.ceil(span / longest - 1e-9), 1.0)
        dt = span / steps
        _, first = np.unique(dt, return_index=True)
        count = int(np.sort(first)[KINDS]) if first.size > KINDS else dt.size
        count = int(np.argmax(np.append(steps[:count], np.inf) > most))
        lengths, kind = np.unique(dt[:count], return_inverse=True)
        inverse = np.zeros((lengths.size, *bodies.inverse.shape))
        for own, length in zip(inverse, lengths.tolist(), strict=True):
            own[:] = with_step(bodies, length).inverse
        return Intervals(
            times[:count], dt[:count], steps[:count].astype(np.int64), inverse, kind, np.zeros_like(reaction), elastic,
            notes,
        )  # fmt: skip

    @staticmethod
    def nowhere(bodies: BodyArrays) -> Intervals:
        """Without any instants."""
        x, n = np.zeros(0), np.zeros(0, dtype=np.int64)
        inverse = np.zeros((0, *bodies.inverse.shape))
        return Intervals(x, x, n, inverse, n, np.zeros((0, 0)), np.zeros(1), Notes.empty((x,) * NOTED, 0))


@lean
def advance(structure, buffers, contacts, tables, bodies, state, table, out, A, b, method, dt, steps, intervals):
    """Move a state by some steps of the length dt in s, or along a intervals if that has any instants.

    One kernel for all, which is compiled once.

    Args:
        method: its kicks and drifts.
        steps: see `advance_by`.
        intervals: contacts give way within the steps that lead to each of its instants, where all is noted.

    Returns:
        RUNNING, or what went wrong; and, if nothing moves, the energy stored in all runs with their kinks, J.
    """
    if intervals.end.size == 0:
        return advance_by(structure, buffers, contacts, tables, bodies, state, table, out, A, b, method, dt, steps)
    for i in range(intervals.end.size):
        begin, own, count = state.t[0], intervals.dt[i], intervals.steps[i]
        for k in range(contacts.size):
            contacts[k].step = own
        inverse = intervals.inverse[intervals.kind[i]]
        for half in range(inverse.shape[0]):
            for p in range(inverse.shape[1]):
                for c in range(inverse.shape[2]):
                    for d in range(inverse.shape[3]):
                        bodies.inverse[half, p, c, d] = inverse[half, p, c, d]
        status, _ = advance_by(
            structure, buffers, contacts, tables, bodies, state, table, out, A, b, method, own, count
        )
        intervals.notes.gone[STEPS] += count if status == RUNNING else round((state.t[0] - begin) / own)
        if status in (RUNNING, NOT_FINITE):
            state.t[0] = intervals.end[i]
        if status != RUNNING:
            return status, 0.0
        for e in range(intervals.reaction.shape[0]):
            for a in range(intervals.reaction.shape[1]):
                intervals.reaction[e, a] = buffers.reaction[e, a]
        _, stored = advance_by(structure, buffers, contacts, tables, bodies, state, table, out, A, b, method, 0.0, LOOK)
        intervals.elastic[0] = stored
        for e in range(intervals.reaction.shape[0]):
            for a in range(intervals.reaction.shape[1]):
                buffers.reaction[e, a] = intervals.reaction[e, a]
        write_note(intervals.notes)
    return RUNNING, 0.0
