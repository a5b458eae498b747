"""Lines that are given by a tension, compared with the mean tension that they have in equilibrium without loads."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.results.frame import OFF_LINE, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

_CLOSE = 0.005  # of the tension: a mean tension as close to it needs no warning


class GivenTensionWatch(Watch):
    """Watches the first frame of a run that begins in equilibrium without loads and without wind."""

    def _prepare(self) -> None:
        run = self.scenario.run
        calm = run.kind == "equilibrium" or (run.kind == "dynamic" and run.start.kind == "rest")
        calm = calm and not getattr(getattr(run, "start", None), "in_wind", False)
        lines = self.scenario.lines.items() if calm else ()
        self._given = {name: line.tension for name, line in lines if line.length is None and line.tension}
        self._found, self._begun = dict[str, float](), False

    def see(self, frames: Frames) -> None:
        """Take note of the mean tension of lines in the first frame."""
        begins, self._begun = not self._begun, True
        if not begins or (frames.of["contact_state"][0] != OFF_LINE).any():
            return
        for name in self._given:
            own = self.links_of(name)
            if own.size > 1:
                weights = np.gradient(self.layout.link_xi[own])
                self._found[name] = float(np.average(frames.of["tension"][0, own], weights=weights))

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """Yield a warning for each line whose mean tension is not the one that it is given by."""
        for name, mean in self._found.items():
            given = float(self._given[name])
            part = mean / given - 1.0
            if abs(part) > _CLOSE:
                yield (
                    f"lines.{name}.tension: the mean tension in equilibrium is {mean:.4g} N instead of "
                    f"{given:.4g} N ({100.0 * part:+.2g} %); write length instead, and adjust it until the tension fits"
                )
