"""Watches of the frames of a run: what each of them has to find, and words for lines and instants."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.results.frame import Doubt, Integers, Layout, RunInfo
from ropewalk.results.frames import Frames

if TYPE_CHECKING:
    from ropewalk.model import Scenario


class Watch:
    """Sees all frames of a run, and yields doubts and warnings at its end.

    Args:
        layout: of the frames.
        scenario: the scenario.
    """

    def __init__(self, layout: Layout, scenario: Scenario) -> None:
        self.layout, self.scenario = layout, scenario
        self._prepare()

    def _prepare(self) -> None:
        """Choose the loads and lines to watch."""

    def see(self, frames: Frames) -> None:
        """Take note of frames."""

    def doubts(self, run_info: RunInfo) -> Iterator[Doubt]:
        """Yield reasons to doubt the results, with cause, key and remedy."""
        return iter(())

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """Yield warnings, with place, instant and remedy."""
        return iter(())

    @cached_property
    def loads(self) -> list[str]:
        """Load of each contact, without the name of its wheel or foot."""
        return [name.partition(".")[0] for name in self.layout.contact_load]

    def nodes_of(self, line: str) -> Integers:
        """Return the numbers of the nodes of a line."""
        return np.flatnonzero(np.array(self.layout.node_line) == line)

    def links_of(self, line: str) -> Integers:
        """Return the numbers of the links of a line."""
        return np.flatnonzero(np.array(self.layout.link_line) == line)

    def at(self, path: float) -> str:
        """Return an instant in s, or a length of the load path in m, in words."""
        return f"t = {path:.4g} s" if self.layout.path == "time" else f"load path {path:.4g} m"
