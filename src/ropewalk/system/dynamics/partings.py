"""What parts on the way, at a time or where it is pulled too much: it is looked at after each step."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from ropewalk.checkpoint import Tree
from ropewalk.results.frame import RunInfo
from ropewalk.system.dynamics import motion
from ropewalk.system.dynamics.asking import Asking
from ropewalk.system.dynamics.carrier import System

if TYPE_CHECKING:
    from ropewalk.system.dynamics.implicit import Implicit


class Parting(ABC):
    """Things of one kind that part."""

    @property
    @abstractmethod
    def any(self) -> bool:
        """Whether there are any."""

    @abstractmethod
    def next(self) -> float:
        """The next instant in s at which one parts; infinity: there is none."""

    @abstractmethod
    def is_watched(self) -> bool:
        """Whether one may still part because it is pulled too much."""

    @abstractmethod
    def excess(self, system: System) -> float:
        """By how much the most pulled one is above its strength, over this; negative: none is."""

    @abstractmethod
    def until(self, system: System) -> list[str]:
        """Part what is to part up to now; returns what is to be told of it."""

    @abstractmethod
    def overpulled(self, system: System) -> list[str]:
        """Part what is pulled too much; returns what is to be told of it."""

    @abstractmethod
    def crossed(self) -> str | None:
        """A load that has come to where a line has parted."""

    @abstractmethod
    def get_state(self) -> Tree:
        """What has parted."""

    @abstractmethod
    def set_state(self, tree: Tree) -> None:
        """All as it was then."""


class Partings:
    """All that parts in a motion.

    Args:
        kinds: by name.
        run_info: told of what parts.
    """

    def __init__(self, kinds: dict[str, Parting], run_info: RunInfo) -> None:
        self._kinds, self._run_info = kinds, run_info

    @property
    def any(self) -> bool:
        """Whether there is anything that may part."""
        return any(kind.any for kind in self._kinds.values())

    def to(self, asking: Asking, end: float) -> int:
        """Go on to a time in s, and part on the way what is to part; returns as `Asking.to`."""
        while (time := min(kind.next() for kind in self._kinds.values())) <= end:
            if time > asking.carrier.t and (status := self._go(asking, time)) != motion.RUNNING:
                return status
            self._tell(kind.until(asking.carrier.system) for kind in self._kinds.values())
        return self._go(asking, end) if end > asking.carrier.t else motion.RUNNING

    def _go(self, asking: Asking, end: float) -> int:
        """Go on to a time in s, step by step as long as anything may be pulled too much."""
        carrier = asking.carrier
        begin, count = carrier.t, max(1, math.ceil((end - carrier.t) / carrier.longest - 1e-9))
        for i in range(1, count + 1):
            watched = any(kind.is_watched() for kind in self._kinds.values())
            time = begin + i * (end - begin) / count if watched and i < count else end
            if (status := asking.to(time)) != motion.RUNNING:
                return status
            if watched:
                self._tell(kind.overpulled(carrier.system) for kind in self._kinds.values())
            if time == end:
                break
        return motion.RUNNING

    def implicitly(self, implicit: Implicit, end: float) -> int:
        """Go on to a time in s by implicit steps, which end where something parts; returns what has come of it."""
        system = implicit.system
        while True:
            time = min(end, *(kind.next() for kind in self._kinds.values()))
            if time > system.state.t[0]:
                watched = any(kind.is_watched() for kind in self._kinds.values())
                status = implicit.to(time, self._excess(system) if watched else None)
                if status != motion.RUNNING:
                    return status
                self._tell(kind.overpulled(system) for kind in self._kinds.values())
            if system.state.t[0] >= time:
                self._tell(kind.until(system) for kind in self._kinds.values())
            if system.state.t[0] >= end:
                return motion.RUNNING

    def _excess(self, system: System) -> Callable[[], float]:
        return lambda: max(kind.excess(system) for kind in self._kinds.values())

    def _tell(self, found: Iterable[list[str]]) -> None:
        for messages in found:
            self._run_info.warnings += messages

    def crossed(self) -> str | None:
        """A load that has come to where its line has parted."""
        return next((found for kind in self._kinds.values() if (found := kind.crossed()) is not None), None)

    def get_state(self) -> Tree:
        """What has parted."""
        return {name: kind.get_state() for name, kind in self._kinds.items()}

    def set_state(self, tree: Tree) -> None:
        """All as it was then."""
        for name, kind in self._kinds.items():
            kind.set_state(tree[name])
