"""Heights over the ground of `outputs.ground`, and a remark where something would be below it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ropewalk.model.carriage import Carriage
from ropewalk.results.frame import Array, RunInfo
from ropewalk.results.frames import Frames
from ropewalk.results.watch import Watch


def heights(place: Array, below: float, ground: Array) -> Array:
    """Heights in m over the ground of what is so far `below` the points `place`, (..., axis) m; NaN beyond its ends.

    Args:
        place: points, x first and z last.
        below: m.
        ground: (corner, 2) m, x and z of its corners from the first x on.
    """
    x, z = ground.T
    return np.asarray(place[..., -1] - below - np.interp(place[..., 0], x, z, left=np.nan, right=np.nan))


class GroundWatch(Watch):
    """Watches lines and cabins for what comes below the ground: it is measured from, and stops nothing."""

    def _prepare(self) -> None:
        self._ground: Array = np.array(self.scenario.outputs.ground or (), dtype=float).reshape(-1, 2)
        bodies = list(self.layout.body)
        self._watched = [("position", name, self.nodes_of(name), 0.0) for name in self.scenario.lines]
        for name, load in self.scenario.loads.items():
            cabin = f"{name}.cabin"
            if isinstance(load, Carriage) and load.cabin is not None and cabin in bodies:
                self._watched.append(("body_position", cabin, np.array([bodies.index(cabin)]), load.cabin.floor))
        self._lowest: dict[str, tuple[float, float, float]] = {}  # height in m, x in m, and when

    def see(self, frames: Frames) -> None:
        """Take note of frames."""
        if not self._ground.size:
            return
        for kind, name, own, below in self._watched:
            place = frames.of[kind][:, own]
            height = heights(place, below, self._ground)
            if np.isfinite(height).any():
                i, j = np.unravel_index(int(np.nanargmin(height)), height.shape)
                found = float(height[i, j]), float(place[i, j, 0]), float(frames.path[i])
                self._lowest[name] = min(self._lowest.get(name, found), found)

    def messages(self, run_info: RunInfo) -> Iterator[str]:
        """What has been below the ground."""
        for name, (height, x, when) in self._lowest.items():
            if height < 0.0:
                yield (
                    f"{name} comes {-height:.3g} m below the ground of outputs.ground, at x = {x:.4g} m, "
                    f"{self.at(when)}: contact with the ground is not computed; raise the supports or the tension, or "
                    "correct outputs.ground"
                )
