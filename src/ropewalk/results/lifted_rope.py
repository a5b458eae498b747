"""Ropes that lift off their saddles, or were found below them: where, when, and by how much."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.frame import Array, Doubt, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch

_NO_FORCE = 1e-9  # of the largest tension: a saddle that bears no more does not touch the rope
_LINKS = 4  # per radius of a groove, with which equilibria find the rope on it
_GAP = 1e-3  # m, from which a gap is worth a warning: links are straight where the groove is round


def is_touched(reaction: Array, tension: Array) -> NDArray[np.bool_]:
    """Whether a saddle bears a force, (frame,).

    Args:
        reaction: (frame, axis) N, of the saddle.
        tension: (frame, link) N, of the line.
    """
    largest = np.nan_to_num(np.abs(tension)).max(axis=1, initial=0.0)
    return np.asarray(np.linalg.norm(np.nan_to_num(reaction), axis=1) > _NO_FORCE * largest)


class LiftedRopeWatch(Watch):
    """Watches saddles for frames in which their rope does not touch them."""

    def _prepare(self) -> None:
        supports = list(self.layout.support)
        self._saddles = [
            (name, key, supports.index(f"{name}.{key}"), np.array(saddle.at))
            for name, line in self.scenario.lines.items() for key, saddle in line.saddles.items()
            if f"{name}.{key}" in supports
        ]  # fmt: skip
        self._nodes = {name: self.nodes_of(name) for name, *_ in self._saddles}
        self._links = {name: self.links_of(name) for name, *_ in self._saddles}
        self._first: dict[tuple[str, str], float] = {}  # s or m, the first frame without contact
        self._gaps: dict[tuple[str, str], list[tuple[float, float]]] = {}  # m over the crown, and when; the extremes

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        for name, key, support, crown in self._saddles:
            tension = frames.of["tension"][:, self._links[name]]
            for f in np.flatnonzero(~is_touched(frames.of["reaction"][:, support], tension)):
                place = frames.of["position"][f, self._nodes[name]]
                way = place[-1, :-1] - place[0, :-1]
                along = (place[:, :-1] - place[0, :-1]) @ way
                there = float((crown[: way.size] - place[0, :-1]) @ way) if crown.size == place.shape[1] else np.nan
                gap, when = float(np.interp(there, along, place[:, -1]) - crown[-1]), float(frames.path[f])
                if abs(gap) > _GAP:
                    self._first.setdefault((name, key), when)
                    gaps = sorted([*self._gaps.get((name, key), []), (gap, when)])
                    self._gaps[name, key] = [gaps[0], gaps[-1]]

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """The saddles that their rope lifts off, with instant, gap and remedy."""
        for (name, key), (_, (gap, when)) in self._gaps.items():
            if gap > 0.0:
                yield (
                    f"line {name} does not touch saddle {key} from {self.at(self._first[name, key])} on: it is up to "
                    f"{gap:.4g} m above its crown ({self.at(when)}), and spans from the supports before and after it; "
                    f"raise lines.{name}.saddles.{key}.at by more than {gap:.3g} m, or give the line less tension"
                )

    def doubts(self, run_info: RunInfo) -> Iterator[Doubt]:
        """The saddles below which their rope was found, though it lies on them."""
        for (name, key), ((gap, when), _) in self._gaps.items():
            if gap < 0.0:
                line = self.scenario.lines[name]
                links, radius = len(self._links[name]), line.saddles[key].radius
                length = line.length or line.distance
                count = max(math.ceil(_LINKS * length / radius), 2 * links)
                what = f"line {name} is {-gap:.4g} m below the crown of saddle {key} at {self.at(when)}, untouched"
                cause = f"links of {length / links:.3g} m are too long for its groove of radius {radius:.4g} m"
                where, remedy = f"lines.{name}.elements", f"write lines.{name}.elements: {count} or more"
                if links * radius >= _LINKS * length:
                    cause, where = "the search for its equilibrium has passed the saddle", f"lines.{name}.saddles.{key}"
                    remedy = f"write {where}.radius: {2.0 * radius:.4g} m for all of its saddles, or other elements"
                yield Doubt(what, cause, where, remedy)
