"""Contacts of one line that pass each other, and wheels of one vehicle that an end of their line draws together."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from ropewalk.results.frame import MOVES, STICKS, Doubt, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

_BODIES = ("mass", "oscillator", "vehicle", "matrices")  # what has a mass on its line
_PRESSING = (*_BODIES, "force", "axles")
_TOGETHER = 0.98  # of the largest distance of two wheels: below, they have been drawn together
_LEVEL = 0.5  # the same where their level distance is what stays


class ContactOrderWatch(Watch):
    """Watches the contacts of dynamic runs for their order along the line, and wheels for their distances."""

    def _prepare(self) -> None:
        scenario = self.scenario
        kinds = {
            name: load.kind for name, load in scenario.loads.items()
            if load.kind in _PRESSING and load.on in scenario.lines and not getattr(load, "also_on", ())
        }  # fmt: skip
        known = [k for k, name in enumerate(self.loads) if name in kinds] if scenario.run.kind == "dynamic" else []
        self._pairs = [
            (i, k) for i, k in combinations(known, 2)
            if scenario.loads[self.loads[i]].on == scenario.loads[self.loads[k]].on
            and {kinds[self.loads[i]], kinds[self.loads[k]]} & {*_BODIES}
        ]  # fmt: skip
        self._gap = dict[tuple[int, int], float]()  # the last known, of two loads; the largest, of two wheels, m
        self._found = dict[tuple[str, str], tuple[float, float]]()  # loads, and the times before and after, s
        self._last = 0.0  # s

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        xi, state = frames.of["contact_xi"], frames.of["contact_state"]
        before = np.concatenate([[self._last], frames.path[:-1]])
        for i, k in self._pairs:
            on = ((state[:, (i, k)] == STICKS) | (state[:, (i, k)] == MOVES)).all(axis=1)
            gap = xi[on, k] - xi[on, i]
            if not gap.size or (pair := (self.loads[i], self.loads[k])) in self._found:
                continue
            begin = self._gap.get((i, k), gap[0])
            if pair[0] == pair[1]:
                largest = np.maximum.accumulate(np.append(begin, np.abs(gap)))[1:]
                wrong, self._gap[i, k] = np.abs(gap) < self._least(pair[0]) * largest, float(largest[-1])
            else:
                wrong, self._gap[i, k] = gap * begin < 0.0, float(gap[-1])
            if wrong.any():
                at = np.flatnonzero(on)[wrong.argmax()]
                self._found[pair] = float(before[at]), float(frames.path[at])
        self._last = float(frames.path[-1])

    def _least(self, name: str) -> float:
        """Part of the largest distance along the line that wheels of a load keep, 0 unless they stay at an end."""
        travel = getattr(self.scenario.loads[name], "travel", None)
        if getattr(travel, "at_end", "") != "stay":
            return 0.0
        return _LEVEL if getattr(travel, "measured", "") == "horizontal" else _TOGETHER

    def doubts(self, run_info: RunInfo) -> Iterator[Doubt]:
        """Yield a doubt for each vehicle that is drawn together, and for each two loads that pass each other."""
        for (one, two), (begin, end) in self._found.items():
            when, on = f"between t = {begin:.4g} and {end:.4g} s", self.scenario.loads[two].on
            earlier = f"end the run before t = {begin:.4g} s"
            if one == two:
                what, cause = f"distance of wheels of load {two} decreases {when}", f"wheels stop at the end of {on}"
                yield Doubt(what, cause, f"loads.{two}.travel.at_end", f"write at_end: leave, or {earlier}")
            else:
                what, cause = f"loads {one} and {two} pass each other {when}", f"masses cannot pass along {on}"
                kinds = {getattr(getattr(self.scenario.loads[name], "travel", None), "kind", "") for name in (one, two)}
                remedy = f"{earlier}, or change from or speed"
                if "free" not in kinds:
                    remedy += ", or write kind: force (contact: clamped) with its weight for both"
                yield Doubt(what, cause, f"loads.{two}.travel", remedy)
