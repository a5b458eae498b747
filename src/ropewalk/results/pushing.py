"""Whether lines whose law only pulls push by their dampers, at output instants.

`axial_damping` acts in links that are slack, too, which a rope would not do: there it hangs in a bow and nothing of it
gets longer or shorter. It keeps links that fly about from swinging for ever; here is told where that is felt.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.results.frame import Layout
from ropewalk.results.frames import Frames

if TYPE_CHECKING:
    from ropewalk.model import Scenario

_MUCH = 0.05  # part of the largest tension of all lines, from which on a push counts
_PULL_ONLY = ("tension_only", "webbing")


class PushWatch:
    """Watches lines that only pull for the largest push of their dampers.

    Args:
        layout: of the frames.
        scenario: the scenario.
    """

    def __init__(self, layout: Layout, scenario: Scenario) -> None:
        damped = [name for name, line in scenario.lines.items() if line.axial_damping and line.law.kind in _PULL_ONLY]
        self._layout = layout
        self._links = np.flatnonzero(np.isin(np.array(layout.link_line), damped)) if damped else np.zeros(0, np.intp)
        self._largest = 0.0  # N, tension of all lines
        self._push = 0.0, 0.0, ""  # N, path, and the line

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        pull = frames.of["tension"]
        if not self._links.size or not np.isfinite(pull).any():
            return
        self._largest = max(self._largest, float(np.nanmax(pull)))
        own = np.nan_to_num(pull[:, self._links])
        i, link = np.unravel_index(int(own.argmin()), own.shape)
        if -own[i, link] > self._push[0]:
            line = self._layout.link_line[int(self._links[link])]
            self._push = float(-own[i, link]), float(frames.path[i]), line

    def messages(self) -> Iterator[str]:
        """The line that pushes most, if that is much."""
        push, path, line = self._push
        if push > _MUCH * self._largest:
            when, unit = ("t =", "s") if self._layout.path == "time" else ("load path", "m")
            yield (
                f"tension-only line {line} has a compressive force of {push:.4g} N at {when} {path:.4g} {unit}: its "
                "axial_damping acts in slack links, too; repeat the run with half of it and compare the results"
            )
