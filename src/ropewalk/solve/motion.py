"""Motion: the states of a run at the instants asked for, one after the other."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np

from ropewalk.errors import RopewalkError
from ropewalk.foreign.turns import TravelEndedError
from ropewalk.mechanics.bodies import Bodies
from ropewalk.mechanics.chain import Array, Buffers, Integers, Loads, State, Strands, Supports
from ropewalk.mechanics.compiled import entry_of
from ropewalk.solve.choice import RKN6_LIMIT, SAFETY_WITH_MASSES, Choice, bounds, is_compressed, verlet_step
from ropewalk.solve.composition import RKN6, VERLET
from ropewalk.solve.ends import ends_of
from ropewalk.solve.splitting import (
    ASKED,
    END_OF_LINE,
    MET,
    NO_CONVERGENCE,
    NOT_FINITE,
    RUNNING,
    TOO_MANY_STEPS,
    advance,
)

if TYPE_CHECKING:
    from ropewalk.solve.collocation import Workspace

# A run that needs more steps than this between two outputs will not end within a day.
MOST_STEPS = 10**11
# No law holds so far: a link that is stretched to this many times its length has torn.
LONGEST_STRETCH = 100.0


# Part of the time by which instants that are meant to be the same differ.
NEXT_TO_NOTHING = 1e-14

# So often a guide may be asked without a step in between.
MOST_QUESTIONS = 100
# A load that could not go on; the message says why.
STOPPED = 7


Look = Callable[[Loads, State, Bodies, float], None]
"""Moves a copy of a state ahead by some seconds, with loads of its own."""


class Guide(Protocol):
    """Who decides on the way what a load does: where feet stand, what a model of the user's own presses with."""

    def begin(self, state: State) -> None:
        """Take the first decisions, before anything moves."""

    def next(self, t: float) -> float:
        """The next instant after t, in s, at which to be asked again; infinity: only when something happens."""

    def act(self, state: State) -> None:
        """Decide, if it is time or something has happened."""


@runtime_checkable
class Foresighted(Guide, Protocol):
    """A guide who sends copies of the state ahead before deciding."""

    look: Look | None


@dataclass
class Progress:
    """How a motion has gone so far."""

    status: int = RUNNING
    steps: int = 0
    message: str = ""  # what has happened: to a load that could not go on, to two that have met

    def told(self) -> tuple[str, str]:
        """The outcome of a motion that has ended early, and advice."""
        outcome, advice = ADVICE[self.status]
        return outcome, "; ".join(part for part in (self.message, advice) if part)


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
    MET: (
        "loads met",
        "loads cannot pass or push each other: let one start elsewhere, change a speed, or end the run before; if they "
        "are meant to run so close (a quarter of a link, a whole one near supports), raise elements",
    ),
    STOPPED: ("load failed", ""),
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
    bodies: Bodies | None = None,
    guides: Sequence[Guide] = (),
) -> Iterator[State]:
    """Yield the state at each of the times; the same object every time, to be read before going on.

    Args:
        strands, loads, state: the model; state is changed.
        choice: method and largest step.
        accuracy: wanted accuracy in time, m (for the adaptive method).
        times: rising instants, s.
        progress: filled in; the iteration ends early if its status is no longer RUNNING.
        supports: what holds the ends; None: points that do not move.
        bodies: what has a mass of its own; changed with the state.
        guides: who decide on the way what loads do.

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
    step, idle = choice.step, 0
    entries: list[Callable[..., tuple[int, int]]] = []
    limits = bounds(strands, state.r, state.X, bool(loads.strand.size), supports, loads, bodies)

    def look(own: Loads, twin: State, moving: Bodies, h: float) -> None:
        """Go on with a copy."""
        until, rest = float(twin.t[0]) + h, _copied(room)
        carried = None if bodies is None else moving
        while twin.t[0] < until:
            status, taken = _advance(strands, own, twin, rest, choice, accuracy, until, step, ends, carried, entries)
            if status not in (RUNNING, ASKED) or (status == ASKED and taken == 0):
                return  # what is in the way there will be said when it is reached

    for guide in guides:
        if isinstance(guide, Foresighted):
            guide.look = look
    for time in times:
        stops = [*corners[(corners > state.t[0]) & (corners < time)], time]
        for stop in stops:
            while state.t[0] < stop:
                if stop - state.t[0] < NEXT_TO_NOTHING * stop:  # corners of two tables: no step is so short
                    state.t[0] = stop
                    break
                until = min([stop, *(guide.next(float(state.t[0])) for guide in guides)])
                progress.status, taken = _advance(
                    strands, loads, state, room, choice, accuracy, until, step, ends, bodies, entries
                )
                progress.steps += int(taken)
                if progress.status in (RUNNING, ASKED):
                    idle = idle + 1 if taken == 0 else 0
                    progress.status = _ask(guides, state, progress)
                    if idle > MOST_QUESTIONS:
                        progress.status, progress.message = STOPPED, "a load asks again and again without moving on"
                if progress.status != RUNNING:
                    yield state
                    return
        if _is_torn(strands, state):
            progress.status = NOT_FINITE
            yield state
            return
        yield state
        now = bounds(strands, state.r, state.X, bool(loads.strand.size), supports, loads, bodies)
        if now.frequency > 1.05 * limits.frequency and choice.method != "implicit":
            # The line has stiffened: keep the step in proportion.
            own = RKN6_LIMIT / now.frequency
            if choice.method == "verlet":
                own = verlet_step(now) * (SAFETY_WITH_MASSES if bodies is not None else 1.0)
            step = min(step, own)
        fine = choice.step * choice.compressed
        if fine < step and is_compressed(strands, state.r, state.X):
            step = fine


def _ask(guides: Sequence[Guide], state: State, progress: Progress) -> int:
    try:
        for guide in guides:
            guide.act(state)
    except TravelEndedError:
        return END_OF_LINE
    except RopewalkError as error:
        progress.message = str(error)
        return STOPPED
    return RUNNING


def _is_torn(strands: Strands, state: State) -> bool:
    """Whether some link has become so long that only a motion without bounds can have stretched it."""
    for i, n in zip(strands.first, strands.links, strict=True):
        d = np.diff(state.r[:, i : i + n + 1], axis=1)
        if not np.sqrt((d * d).sum(axis=0)).max() < LONGEST_STRETCH * np.diff(state.X[i : i + n + 1]).max():
            return True
    return False


def _copied(room: Any) -> Any:
    """The same room once more."""
    return type(room)(*(array.copy() for array in room)) if isinstance(room, tuple) else copy.deepcopy(room)


def _room_for(choice: Choice, loads: Loads, state: State) -> Buffers | Workspace:
    """Room for the steps of the chosen method."""
    if choice.method == "implicit":
        from ropewalk.solve.radau import workspace_for

        return workspace_for(loads, state)
    return Buffers.for_state(state)


def _advance(strands, loads, state, room, choice, accuracy, stop, step, ends, bodies, entries):
    if choice.method == "implicit":
        from ropewalk.solve.radau import advance_implicit

        return advance_implicit(strands, loads, state, room, stop, accuracy, step, MOST_STEPS)
    kicks, drifts = RKN6 if choice.method == "rkn6" else VERLET
    arguments = strands, loads, state, room, kicks, drifts, float(stop), float(step), MOST_STEPS, ends, bodies
    if not entries:
        entries.append(entry_of(advance, arguments))
    return entries[0](*arguments)


def _knots(times: Array, counts: Integers) -> Array:
    """Instants at which tables bend: steps end there, unless there are so many that the table is smooth."""
    return times if counts.size and counts.max() <= 200 else np.zeros(0)
