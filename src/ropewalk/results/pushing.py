"""Whether lines whose law only pulls push by their dampers, at output instants.

`axial_damping` acts in links that are slack, too, which a rope would not do: there it hangs in a bow and nothing of it
gets longer or shorter. It keeps links that fly about from swinging for ever; here is told where that is felt.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.results.frame import RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

_MUCH = 0.05  # part of the largest tension of all lines, from which on a push counts
_PULL_ONLY = ("tension_only", "webbing")


class PushWatch(Watch):
    """Watches lines that only pull for the largest push of their dampers."""

    def _prepare(self) -> None:
        lines = self.scenario.lines.items()
        damped = [name for name, line in lines if line.axial_damping and line.law.kind in _PULL_ONLY]
        self._links = np.concatenate([np.zeros(0, np.intp), *map(self.links_of, damped)])
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
            line = self.layout.link_line[int(self._links[link])]
            self._push = float(-own[i, link]), float(frames.path[i]), line

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """The line that pushes most, if that is much."""
        push, path, line = self._push
        if push > _MUCH * self._largest:
            yield (
                f"tension-only line {line} has a compressive force of {push:.4g} N at {self.at(path)}: its "
                "axial_damping acts in slack links, too; repeat the run with half of it and compare the results"
            )
