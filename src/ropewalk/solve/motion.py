"""Motion: the states of a run at the instants asked for, one after the other."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.mechanics.chain import Array, Buffers, Integers, Loads, State, Strands, Supports
from ropewalk.solve.choice import RKN6_LIMIT, Choice, bounds, is_compressed, verlet_step
from ropewalk.solve.composition import RKN6, VERLET
from ropewalk.solve.ends import ends_of
from ropewalk.solve.splitting import END_OF_LINE, NO_CONVERGENCE, NOT_FINITE, RUNNING, TOO_MANY_STEPS, advance

if TYPE_CHECKING:
    from ropewalk.solve.collocation import Workspace

# A run that needs more steps than this between two outputs will not end within a day.
MOST_STEPS = 10**11
# No law holds so far: a link that is stretched to this many times its length has torn.
LONGEST_STRETCH = 100.0


@dataclass
class Progress:
    """How a motion has gone so far."""

    status: int = RUNNING
    steps: int = 0


ADVICE = {
    END_OF_LINE: (
        "travel ended",
        "a load came to the end of its line; shorten `until`, or say travel.at_end: leave (or stay)",
    ),
    NOT_FINITE: (
        "diverged",
        "the motion grew without bounds or a link collapsed; use law {kind: tension_only}, add some axial_damping, "
        "lower `step`, or check stiffness and forces",
    ),
    NO_CONVERGENCE: (
        "no convergence",
        "the implicit method found no step small enough; use method: explicit, law {kind: tension_only}, or a finer "
        "mesh, and check stiffness and forces",
    ),
    TOO_MANY_STEPS: ("too many steps", "raise `step`, use fewer elements, or method: implicit"),
}


def move(
    strands: Strands,
    loads: Loads,
    state: State,
    choice: Choice,
    accuracy: float,
    times: Array,
    progress: Progress,
    supports: Supports | None = None,
) -> Iterator[State]:
    """Yield the state at each of the times; the same object every time, to be read before going on.

    Args:
        strands, loads, state: the model; state is changed.
        choice: method and largest step.
        accuracy: wanted accuracy in time, m (for the adaptive method).
        times: rising instants, s.
        progress: filled in; the iteration ends early if its status is no longer RUNNING.
        supports: what holds the ends; None: points that do not move.

    Raises:
        RopewalkError: the method does not know what the supports do.
    """
    ends = ends_of(strands, supports) if supports is not None else None
    if ends is not None and choice.method == "implicit":
        raise RopewalkError("the implicit method does not know supports that yield or move; use verlet")
    room = _room_for(choice, loads, state)
    knots = [_knots(loads.speed_time, loads.speed_count), _knots(loads.force_time, loads.force_count)]
    if supports is not None:
        knots.append(_knots(supports.motion_time, supports.motion_count))
    corners = np.unique(np.concatenate(knots))
    step = choice.step
    limits = bounds(strands, state.r, state.X, bool(loads.strand.size), supports)
    for time in times:
        stops = [*corners[(corners > state.t[0]) & (corners < time)], time]
        for stop in stops:
            if state.t[0] >= stop:
                continue
            progress.status, taken = _advance(strands, loads, state, room, choice, accuracy, stop, step, ends)
            progress.steps += int(taken)
            if progress.status != RUNNING:
                yield state
                return
        if _is_torn(strands, state):
            progress.status = NOT_FINITE
            yield state
            return
        yield state
        now = bounds(strands, state.r, state.X, bool(loads.strand.size), supports)
        if now.frequency > 1.05 * limits.frequency and choice.method != "implicit":
            # The line has stiffened: keep the step in proportion.
            own = verlet_step(now) if choice.method == "verlet" else RKN6_LIMIT / now.frequency
            step = min(step, own)
        fine = choice.step * choice.compressed
        if fine < step and is_compressed(strands, state.r, state.X):
            step = fine


def _is_torn(strands: Strands, state: State) -> bool:
    """Whether some link has become so long that only a motion without bounds can have stretched it."""
    for i, n in zip(strands.first, strands.links, strict=True):
        d = np.diff(state.r[:, i : i + n + 1], axis=1)
        if not np.sqrt((d * d).sum(axis=0)).max() < LONGEST_STRETCH * np.diff(state.X[i : i + n + 1]).max():
            return True
    return False


def _room_for(choice: Choice, loads: Loads, state: State) -> Buffers | Workspace:
    """Room for the steps of the chosen method."""
    if choice.method == "implicit":
        from ropewalk.solve.radau import workspace_for

        return workspace_for(loads, state)
    return Buffers.for_state(state)


def _advance(strands, loads, state, room, choice, accuracy, stop, step, ends):
    if choice.method == "implicit":
        from ropewalk.solve.radau import advance_implicit

        return advance_implicit(strands, loads, state, room, stop, accuracy, step, MOST_STEPS)
    kicks, drifts = RKN6 if choice.method == "rkn6" else VERLET
    yielding = () if ends is None else (ends,)
    return advance(strands, loads, state, room, kicks, drifts, stop, step, MOST_STEPS, *yielding)


def _knots(times: Array, counts: Integers) -> Array:
    """Instants at which tables bend: steps end there, unless there are so many that the table is smooth."""
    return times if counts.size and counts.max() <= 200 else np.zeros(0)
