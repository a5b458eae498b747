"""A run under way, whatever computes it: one loop over the frames that are still to come."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from ropewalk.checkpoint import Tree
from ropewalk.errors import RopewalkError
from ropewalk.external.cosimulation_master import CosimulationMaster, begun
from ropewalk.results.contract import numbers
from ropewalk.results.exchanges import exchanged, exchanging
from ropewalk.results.frame import Array, Frame, Layout, RunInfo
from ropewalk.results.frames import Frames, NotedInstants, Waiting


class Ending(NamedTuple):
    """Why a motion has ended early."""

    outcome: str
    advice: str


class MotionEngine(Protocol):
    """What computes a motion: it goes from output instant to output instant and notes what frames are made of."""

    @property
    def layout(self) -> Layout:
        """Names and coordinates of its frames."""

    @property
    def times(self) -> Array:
        """Output instants in s, from 0."""

    @property
    def cosimulation(self) -> Sequence[CosimulationMaster]:
        """Exchanges with external models."""

    @property
    def looks_ahead(self) -> bool:
        """Whether the frame of an instant needs the step after it: a longer run continues from before the last one."""

    @property
    def together(self) -> bool:
        """Whether what has been noted may wait to be made frames together with what comes."""

    def advance(self, i: int, most: int = 1) -> Ending | None:
        """Go on to output instant i, from that before it, and on to those that follow if nobody need look in between.

        Args:
            i: number of the instant.
            most: how many it may be. What comes of it does not depend on that.

        Returns:
            Why the motion has ended, if it has.
        """

    def note(self) -> NotedInstants:
        """What frames of the instants that `advance` came to will be made of, unchanged by what comes.

        They are none where a motion has broken down at once.
        """

    def frames(self, notes: Sequence[NotedInstants]) -> Frames:
        """The frames of some notes; the account is told what one should know of them."""

    def get_state(self) -> Tree:
        """All that changes."""

    def set_state(self, tree: Tree) -> None:
        """Go on from there."""


class TimeHistory:
    """A motion under way: its layout, and its frames one after the other.

    Args:
        engine: what computes it, in its first state.
        run_info: filled in.
        past: what `get_state` gave, to go on from there.
    """

    def __init__(self, engine: MotionEngine, run_info: RunInfo, past: Tree | None = None) -> None:
        self.engine, self.run_info = engine, run_info
        self._taken, self._last, self._is_between = 0, None, False
        if past is not None:
            with begun(engine.cosimulation):
                self._taken = past["frames"]
                engine.set_state(past["engine"])
                run_info.set_state(past["account"])

    @property
    def layout(self) -> Layout:
        """Names and coordinates of its frames."""
        return self.engine.layout

    @property
    def total(self) -> int:
        """How many frames it will have."""
        return int(self.engine.times.size)

    def get_state(self) -> Tree | None:
        """All that changes; of an engine that looks ahead, at the end, that before the last step.

        None where something was raised on the way: what has changed by then belongs to no frame.

        Raises:
            RopewalkError: a load is an external model that gives no state.
        """
        if self._last is not None:
            return self._last
        if self._is_between:
            return None
        return {"frames": self._taken, "engine": self.engine.get_state(), "account": self.run_info.get_state()}

    def blocks(self) -> Iterator[Frames]:
        """The frames that are still to come, some at a time; after a block all that changes is as at its last frame.

        A motion that breaks down ends with the last one, and the account says so.

        Raises:
            RopewalkError: it cannot begin.
        """
        engine, run_info, waiting = self.engine, self.run_info, Waiting(numbers(self.layout))
        with exchanging(engine.cosimulation, run_info):
            while (i := self._taken) < self.total:
                last = engine.looks_ahead and i == self.total - 1
                if last:
                    if waiting:
                        yield self._made(waiting.taken())
                    with suppress(RopewalkError):  # a model that gives no state
                        self._last = self.get_state()
                left = self.total - i - (engine.looks_ahead and not last)
                most = 1 if engine.cosimulation else min(waiting.ask(), left)
                try:
                    ending = engine.advance(i, most)
                except BaseException:  # what came before is there all the same
                    self._is_between = True
                    self._note(waiting)
                    if waiting:
                        yield self._made(waiting.taken())
                    raise
                if ending is not None:
                    run_info.outcome, run_info.advice = ending
                is_due = self._note(waiting)
                self._taken = max(self._taken, i + 1)  # of what has broken down nothing may be noted
                if waiting and (is_due or not engine.together or ending is not None or self._taken == self.total):
                    yield self._made(waiting.taken())
                if ending is not None:
                    return

    def _note(self, waiting: Waiting) -> bool:
        """Let what the engine has noted wait for its frames; says whether it is time to make these."""
        noted = self.engine.note()
        self._taken += noted.number
        return bool(noted.number) and waiting.append(noted, exchanged(self.engine.cosimulation, self.run_info))

    def _made(self, notes: Sequence[tuple[NotedInstants, Mapping[str, Array]]]) -> Frames:
        """The frames of what has been noted."""
        frames = self.engine.frames([note for note, _ in notes])
        return Frames(
            frames.path, {**frames.of, **{name: np.stack([of[name] for _, of in notes]) for name in notes[0][1]}}
        )

    def frames(self) -> Iterator[Frame]:
        """The same frames one by one."""
        return (frame for block in self.blocks() for frame in block)

    def last(self) -> Frame:
        """The frame of the last instant.

        Raises:
            RopewalkError: the motion does not come to it.
        """
        found = deque(self.frames(), maxlen=1)
        if not found or self.run_info.outcome not in ("running", "completed"):
            outcome, advice = self.run_info.outcome, self.run_info.advice
            raise RopewalkError(f"the run did not reach t = {self.engine.times[-1]:g} s ({outcome}): {advice}")
        return found[0]


class StaticEngine(Protocol):
    """What computes equilibria."""

    @property
    def layout(self) -> Layout:
        """Names and coordinates of its frames."""

    def loaded(self) -> Frame:
        """With the loads at their start."""

    def slowly(self, positions: int, turn: float | None) -> Iterator[Frame]:
        """At equal steps of the load path, and in between where a load's path turns by more than an angle in rad."""


@dataclass(frozen=True)
class Known:
    """Frames of all instants that come some at a time, and do not follow from one another."""

    layout: Layout
    given: Iterator[Frames]
    total: int

    def blocks(self) -> Iterator[Frames]:
        """All of them."""
        return self.given

    def get_state(self) -> None:
        """Nothing."""

    @classmethod
    def one_by_one(cls, layout: Layout, frames: Iterator[Frame], total: int) -> Known:
        """Frames between which nothing is to be remembered, each a block."""
        return cls(layout, (Frames.together([frame]) for frame in frames), total)


class Run(Protocol):
    """Who gives frames, whatever they are of."""

    @property
    def layout(self) -> Layout:
        """Names and coordinates of its frames."""

    @property
    def total(self) -> int:
        """How many frames it will have."""

    def blocks(self) -> Iterator[Frames]:
        """The frames that are still to come, some at a time."""

    def get_state(self) -> Tree | None:
        """All that changes, None where there is nothing to go on from."""


def followed(frames: Iterator[Frame], run_info: RunInfo) -> Iterator[Frame]:
    """Frames of quasi-static motion; one that ends where there is no equilibrium keeps those before.

    Raises:
        RopewalkError: there is not even the first one.
    """
    try:
        for frame in frames:
            run_info.steps += 1
            yield frame
    except RopewalkError as error:
        if run_info.steps == 0:
            raise
        run_info.outcome, run_info.advice = "no rest shape", str(error)
