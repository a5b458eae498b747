"""Motion: the states of a run at the instants asked for, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.checkpoint import Arrays, Tree, arrays_of, copied, put
from ropewalk.controllers.carrier import Controller
from ropewalk.errors import RopewalkError
from ropewalk.external.cosimulation_master import TravelEndedError
from ropewalk.mechanics.bodies import Bodies, noted_of
from ropewalk.mechanics.chain import Array, ChainBuffers, ChainState, Integers, Loads, Strands, Supports
from ropewalk.mechanics.compiled import entry_of
from ropewalk.mechanics.law import tangent
from ropewalk.mechanics.notes import STEPS, Notes, numbers_of
from ropewalk.mechanics.portions import portion
from ropewalk.solve.choice import (
    PUSHES,
    RKN6_LIMIT,
    SAFETY_WITH_MASSES,
    Bounds,
    Choice,
    bounds,
    is_compressed,
    verlet_step,
)
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
)
from ropewalk.solve.stops import LONGEST_STRETCH, LOOK, NEXT_TO_NOTHING, Stops, advance
from ropewalk.solve.strained import LENGTH, REST, STIFFNESS, strained

if TYPE_CHECKING:
    from ropewalk.solve.collocation import Workspace

# How often a step looks at a node, about.
_EFFORT = {"verlet": 1, "rkn6": 11, "implicit": 100}
# A run that needs more steps than this between two outputs will not end within a day.
MOST_STEPS = 10**11
# Times that the largest frequency grows, from which on the step follows it.
_STIFFENED = 1.05

# So often a guide may be asked without a step in between.
MOST_QUESTIONS = 100
# A load that could not go on; the message says why.
STOPPED = 7


@dataclass
class Progress:
    """How a motion has gone so far."""

    status: int = RUNNING
    steps: int = 0
    message: str = ""  # what has happened: to a load that could not go on, to two that have met

    def ending(self) -> tuple[str, str]:
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


class ChainMotion:
    """A motion under way, moved from instant to instant.

    Args:
        strands, loads, state: the model; state is changed.
        choice: method and largest step.
        accuracy: wanted accuracy in time, m (for the adaptive method).
        progress: filled in.
        supports: what holds the ends; None: points that do not move.
        bodies: what has a mass of its own; changed with the state.
        controllers: who decide on the way what loads do.
        contacts: what controllers put down and take up where nothing has a mass, and `bodies` is None.

    Raises:
        RopewalkError: the method does not know what the supports do.
    """

    def __init__(
        self,
        strands: Strands,
        loads: Loads,
        state: ChainState,
        choice: Choice,
        accuracy: float,
        progress: Progress,
        supports: Supports | None = None,
        bodies: Bodies | None = None,
        controllers: Sequence[Controller] = (),
        contacts: Bodies | None = None,
    ) -> None:
        self.strands, self.loads, self.state, self.choice = strands, loads, state, choice
        self.accuracy, self.progress, self.supports, self.bodies = accuracy, progress, supports, bodies
        self.controllers, self._contacts = controllers, bodies if bodies is not None else contacts
        self._ends = ends_of(strands, supports) if supports is not None else None
        self._buffers = _capacity_for(choice, loads, state)
        knots = [_knots(loads.speed_time, loads.speed_count), _knots(loads.force_time, loads.force_count)]
        if supports is not None:
            knots.append(_knots(supports.motion_time, supports.motion_count))
        self._corners = np.unique(np.concatenate(knots))
        self._step, self._idle = choice.step, 0
        self._entries: list[Callable[..., tuple[int, int]]] = []
        self._numbers = numbers_of(state if bodies is None else [*state, *noted_of(bodies)])
        self._limits, self._one_stop = self._bounds(), Stops.to(0.0, len(self._numbers))
        yields = supports is not None and bool(supports.free.any())
        self._swings = (strands.links > 1) | yields  # (strand,) whose waves count, as in `bounds`
        self._calm, self._pushed = np.zeros(strands.h.size), np.array([-PUSHES * tangent(p, 0.0) for p in strands.law])
        self._calm_down(_STIFFENED * (1.0 - 1e-9) * self._fastest(self._extremes()[:, STIFFNESS]))

    def to(self, time: float) -> None:
        """Go on to a time in s; the progress is no longer RUNNING where that fails."""
        state, progress = self.state, self.progress
        for stop in [*self._corners[(self._corners > state.t[0]) & (self._corners < time)], time]:
            while state.t[0] < stop:
                if stop - state.t[0] < NEXT_TO_NOTHING * stop:  # corners of two tables: no step is so short
                    state.t[0] = stop
                    break
                until = min([stop, *(controller.next(float(state.t[0])) for controller in self.controllers)])
                progress.status, taken = self._advance(self.loads, state, self._buffers, self.bodies, until)
                progress.steps += int(taken)
                if progress.status in (RUNNING, ASKED):
                    self._idle = self._idle + 1 if taken == 0 else 0
                    progress.status = _ask(self.controllers, progress)
                    if self._idle > MOST_QUESTIONS:
                        progress.status, progress.message = (
                            STOPPED,
                            "the controller of a load decides again and again without advancing",
                        )
                if progress.status != RUNNING:
                    return
        extremes = self._extremes()
        if not (extremes[:, LENGTH] < LONGEST_STRETCH * extremes[:, REST]).all():  # or not a number
            progress.status = NOT_FINITE  # only a motion without bounds can have stretched a link so far
            return
        self._shorten(extremes)

    def empty_notes(self, most: int) -> Notes:
        """Room for notes of some instants, each of all arrays of the state, and of what changes of bodies."""
        return Notes.empty(self._numbers, most)

    @property
    def goes_through(self) -> bool:
        """Whether nobody need look at it between output instants."""
        lightly = self._contacts is not None and self.bodies is None
        return not self.controllers and not lightly and self.choice.method != "implicit"

    def through(self, times: Array, notes: Notes) -> None:
        """Go on to output instants in s, one after the other, and note each; to fewer where one takes long.

        Results do not depend on how many they are.
        """
        state, progress = self.state, self.progress
        corners = self._corners[(self._corners > state.t[0]) & (self._corners < times[-1])]
        instants = np.union1d(corners, times) if corners.size else times
        is_output = np.isin(instants, times).astype(np.int64)
        extremes, before = np.empty((self.strands.h.size, 4)), notes.gone[STEPS]
        longest = _portion(self.choice, state)
        try:
            while (done := notes.noted) < times.size:
                left = slice(int(np.searchsorted(instants, times[done - 1], side="right")) if done else 0, None)
                finely = self.choice.step * self.choice.compressed < self._step
                pushed = self._pushed if finely else np.full_like(self._pushed, -np.inf)
                stops = Stops(instants[left], is_output[left], self._calm, pushed, extremes, notes)
                progress.status, _ = self._call(longest, stops)
                if progress.status == LOOK:
                    progress.status = RUNNING
                    self._shorten(extremes)
                elif progress.status != RUNNING:
                    break
        finally:
            progress.steps += int(notes.gone[STEPS] - before)
        self._idle = 0
        if progress.status in (TOO_MANY_STEPS, ASKED):
            progress.status = RUNNING  # the last step may have come to the instant
            self.to(float(times[notes.noted]))
            if progress.status == RUNNING:
                notes.add()

    def get_state(self) -> Tree:
        """All that changes."""
        own = {
            "state": arrays_of(self.state), "bodies": self._of_bodies, "room": arrays_of(self._buffers),
            "step": self._step, "idle": self._idle, "steps": self.progress.steps,
        }  # fmt: skip
        return {**copied(own), "guides": [controller.get_state() for controller in self.controllers]}

    def set_state(self, tree: Tree) -> None:
        """Be what it was when `get_state` gave this."""
        put(arrays_of(self.state), tree["state"])
        put(self._of_bodies, tree["bodies"])
        put(arrays_of(self._buffers), tree["room"])
        self._step, self._idle, self.progress.steps = tree["step"], tree["idle"], tree["steps"]
        for controller, own in zip(self.controllers, tree["guides"], strict=True):
            controller.set_state(own)

    @property
    def _of_bodies(self) -> Arrays:
        """What of the bodies changes: masses and stiffnesses where walkers stop or stand on another foot."""
        if self._contacts is None:
            return {}
        return arrays_of(self._contacts, "wheels", "order", "ordered", "coordinates", "tethers", "M", "K")

    def _bounds(self, extremes: Array | None = None) -> Bounds:
        state, loads = self.state, self.loads
        some = bool(loads.strand.size)
        return bounds(self.strands, state.r, state.X, some, self.supports, loads, self.bodies, extremes)

    def _extremes(self) -> Array:
        return np.asarray(
            strained(self.strands.first, self.strands.links, self.strands.law, self.state.r, self.state.X)
        )  # fmt: skip

    def _fastest(self, stiffness: Array) -> float:
        """Largest frequency of any line in rad/s, but for a factor that is the same for all and always."""
        strands = self.strands
        return float((np.sqrt(np.maximum(stiffness, 0.0) / strands.rho) / strands.h)[self._swings].max(initial=0.0))

    def _calm_down(self, frequency: float) -> None:
        """Note that the step stays as it is up to a frequency of the lines."""
        strands = self.strands
        own = np.where(self._swings, strands.rho * (strands.h * frequency) ** 2, np.inf)
        np.maximum(self._calm, own, out=self._calm)

    def _shorten(self, extremes: Array) -> None:
        """Keep the step in proportion where the line has stiffened, and small once it is in compression."""
        choice, now = self.choice, self._bounds(extremes)
        self._calm_down((1.0 - 1e-9) * self._fastest(extremes[:, STIFFNESS]))
        if now.frequency > _STIFFENED * self._limits.frequency and choice.method != "implicit":
            own = RKN6_LIMIT / now.frequency
            if choice.method == "verlet":
                own = verlet_step(now) * (SAFETY_WITH_MASSES if self.bodies is not None else 1.0)
            self._step = min(self._step, own)
        fine = choice.step * choice.compressed
        if fine < self._step and is_compressed(self.strands, self.state.r, self.state.X, extremes):
            self._step = fine

    def look(self, own: Loads, twin: ChainState, moving: Bodies, h: float) -> None:
        """Go on with a copy."""
        until, rest = float(twin.t[0]) + h, copied(self._buffers)
        carried = None if self.bodies is None else moving
        while twin.t[0] < until:
            status, taken = self._advance(own, twin, rest, carried, until)
            if status not in (RUNNING, ASKED) or (status == ASKED and taken == 0):
                return  # what is in the way there will be said when it is reached

    def _advance(
        self, loads: Loads, state: ChainState, buffers: ChainBuffers | Workspace, bodies: Bodies | None, stop: float
    ) -> tuple[int, int]:
        status, steps, most = TOO_MANY_STEPS, 0, _portion(self.choice, state)
        while status == TOO_MANY_STEPS and steps < MOST_STEPS:
            status, taken = self._advance_by(most, loads, state, buffers, bodies, stop)
            steps += taken
        return status, steps

    def _advance_by(
        self,
        most: int,
        loads: Loads,
        state: ChainState,
        buffers: ChainBuffers | Workspace,
        bodies: Bodies | None,
        stop: float,
    ) -> tuple[int, int]:
        """Go on to a time, but by no more than some steps."""
        if self.choice.method == "implicit":
            from ropewalk.solve.radau import advance_implicit

            found = advance_implicit(self.strands, loads, state, buffers, stop, self.accuracy, self._step, most)
            return int(found[0]), int(found[1])
        self._one_stop.time[0] = stop
        return self._call(most, self._one_stop, loads, state, buffers, bodies)

    def _call(self, most: int, stops: Stops, *of: Any) -> tuple[int, int]:
        """Call the kernel of the motion: for its own state, or for other loads, state, buffers and bodies."""
        loads, state, buffers, bodies = of or (self.loads, self.state, self._buffers, self.bodies)
        kicks, drifts = RKN6 if self.choice.method == "rkn6" else VERLET
        arguments = (
            self.strands, loads, state, buffers, kicks, drifts, stops, float(self._step), most, self._ends, bodies,
        )  # fmt: skip
        if not self._entries:
            self._entries.append(entry_of(advance, arguments))
        status, taken = self._entries[0](*arguments)
        return int(status), int(taken)


def move(
    strands: Strands,
    loads: Loads,
    state: ChainState,
    choice: Choice,
    accuracy: float,
    times: Iterable[float] | Array,
    progress: Progress,
    supports: Supports | None = None,
    bodies: Bodies | None = None,
    controllers: Sequence[Controller] = (),
) -> Iterator[ChainState]:
    """Yield the state at each of the times; the same object every time, to be read before going on.

    Args:
        strands, loads, state, choice, accuracy, progress, supports, bodies, controllers: see `Motion`.
        times: rising instants, s; the iteration ends early if the progress is no longer RUNNING.
    """
    motion = ChainMotion(strands, loads, state, choice, accuracy, progress, supports, bodies, controllers)
    for time in times:
        motion.to(float(time))
        yield state
        if progress.status != RUNNING:
            return


def _portion(choice: Choice, state: ChainState) -> int:
    return portion(state.X.size, _EFFORT[choice.method])


def _ask(controllers: Sequence[Controller], progress: Progress) -> int:
    try:
        for controller in controllers:
            controller.act()
    except TravelEndedError:
        return END_OF_LINE
    except RopewalkError as error:
        progress.message = str(error)
        return STOPPED
    return RUNNING


def _capacity_for(choice: Choice, loads: Loads, state: ChainState) -> ChainBuffers | Workspace:
    """Room for the steps of the chosen method."""
    if choice.method == "implicit":
        from ropewalk.solve.radau import workspace_for

        return workspace_for(loads, state)
    return ChainBuffers.for_state(state)


def _knots(times: Array, counts: Integers) -> Array:
    """Instants at which tables bend: steps end there, unless there are so many that the table is smooth."""
    return times if counts.size and counts.max() <= 200 else np.zeros(0)
