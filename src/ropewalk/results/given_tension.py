"""Lines that are given by a tension, compared with the mean tension that they have in equilibrium without loads."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.results.frame import OFF_LINE, Layout
from ropewalk.results.frames import Frames

if TYPE_CHECKING:
    from ropewalk.model import Scenario

_CLOSE = 0.005  # of the tension: a mean tension as close to it needs no warning


class GivenTensionWatch:
    """Watches the first frame of a run that begins in equilibrium without loads and without wind.

    Args:
        layout: of the frames.
        scenario: the scenario.
    """

    def __init__(self, layout: Layout, scenario: Scenario) -> None:
        run = scenario.run
        calm = run.kind == "equilibrium" or (run.kind == "dynamic" and run.start.kind == "rest")
        calm = calm and not getattr(getattr(run, "start", None), "in_wind", False)
        lines = scenario.lines.items() if calm else ()
        self._given = {name: line.tension for name, line in lines if line.length is None and line.tension}
        self._layout, self._found, self._begun = layout, dict[str, float](), False

    def see(self, frames: Frames) -> None:
        """Take note of the mean tension of lines in the first frame."""
        begins, self._begun = not self._begun, True
        if not begins or (frames.of["contact_state"][0] != OFF_LINE).any():
            return
        names, xi = np.array(self._layout.link_line), self._layout.link_xi
        for name in self._given:
            own = np.flatnonzero(names == name)
            if own.size > 1:
                self._found[name] = float(np.average(frames.of["tension"][0, own], weights=np.gradient(xi[own])))

    def messages(self) -> Iterator[str]:
        """Yield a warning for each line whose mean tension is not the one that it is given by."""
        for name, mean in self._found.items():
            given = float(self._given[name])
            part = mean / given - 1.0
            if abs(part) > _CLOSE:
                yield (
                    f"lines.{name}.tension: the mean tension in equilibrium is {mean:.4g} N instead of "
                    f"{given:.4g} N ({100.0 * part:+.2g} %); write length instead, and adjust it until the tension fits"
                )
