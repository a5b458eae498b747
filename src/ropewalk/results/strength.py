"""Whether lines bear what they feel: their tensions over their strengths, at output instants."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.contact_statistics import scenario_of
from ropewalk.results.contract import path_name
from ropewalk.results.frame import Array, Doubt, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario


def strengths(scenario: Scenario) -> dict[str, float]:
    """Strengths of lines that have one, N."""
    return {name: line.strength for name, line in scenario.lines.items() if line.strength is not None}


class StrengthWatch(Watch):
    """Watches tensions of lines for the first that their strength does not bear."""

    def _prepare(self) -> None:
        self._of = strengths(self.scenario)
        self._links = {name: self.links_of(name) for name in self._of}
        self._first = dict[str, tuple[float, float, float]]()  # path, xi in m, tension in N

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        for name, strength in self._of.items():
            pull = frames.of["tension"][:, self._links[name]]
            over = np.flatnonzero((pull > strength).any(axis=1))
            if name not in self._first and over.size:
                i, link = int(over[0]), int(np.nanargmax(pull[over[0]]))
                xi = float(self.layout.link_xi[self._links[name]][link])
                self._first[name] = float(frames.path[i]), xi, float(pull[i, link])

    def doubts(self, run_info: RunInfo) -> Iterator[Doubt]:
        """Lines that would have failed."""
        for name, (path, xi, pull) in self._first.items():
            what = f"line {name} would break {xi:.4g} m from its start, at {self.at(path)}"
            cause = f"its tension of {pull:.4g} N exceeds its strength of {self._of[name]:.4g} N; it stays intact"
            remedy = f"increase strength, reduce the load, or write cut: {{at: {xi:.4g} m, ...}} to compute the failure"
            yield Doubt(what, cause, f"lines.{name}.strength", remedy)


def strength_summary(dataset: xr.Dataset) -> dict[str, Any]:
    """Largest tension over strength of each line that has a strength, where and when; over the output instants."""
    scenario, path = scenario_of(dataset), path_name(dataset)
    found: dict[str, Any] = {}
    for name, strength in strengths(scenario).items() if scenario is not None and dataset.sizes[path] else ():
        own = np.flatnonzero(dataset["link_line"].values == name)
        pull: Array = dataset["tension"].values[:, own]
        if np.isfinite(pull).any():
            i, link = np.unravel_index(int(np.nanargmax(pull)), pull.shape)
            xi, when = float(dataset["link_xi"].values[own[link]]), float(dataset[path].values[i])
            found[name] = {"value": float(pull[i, link]) / strength, "unit": "1", "xi": xi, path: when}
    return found
