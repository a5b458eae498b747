"""Sideways: level and across the way of who walks, on lines and on nets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.model.footsteps import FirstFoot, Footsteps
from ropewalk.model.line import spatial
from ropewalk.model.net import AnyNet
from ropewalk.model.scenario import Scenario
from ropewalk.model.walker import Walker


@dataclass(frozen=True)
class Sideways:
    """The level direction, across her way, to the side of one foot of who walks: one for each straight piece of it."""

    side: Array  # (piece, 2) unit vectors (x, y)
    begin: Array  # (piece,) m along the way, where its pieces begin
    length: float = np.inf  # m, of the way, where it is known

    @staticmethod
    def of(scenario: Scenario, load: Footsteps | Walker, foot: FirstFoot) -> Sideways:
        """Across the chord of a line, or across each piece of a path on a net.

        An overhead line runs along x.
        """
        net = scenario.nets.get(load.on)
        if net is None or load.path is None:
            line = scenario.lines.get(load.on)
            run = (1.0, 0.0) if line is None else np.subtract(spatial(line.end), spatial(line.start))[:2]
            return Sideways.across(np.array([run]), load.towards, foot)
        runs = np.diff(np.array(load.path, dtype=float), axis=0)
        sizes = np.hypot(*runs.T)
        if not sizes.any():  # she stands
            return Sideways.across(np.zeros((1, 2)), load.towards, foot)
        runs, sizes = runs[sizes > 0.0], sizes[sizes > 0.0]
        end = np.cumsum(sizes)
        return Sideways.across((runs @ _ways(net))[:, :2], load.towards, foot, end - sizes, float(end[-1]))

    @staticmethod
    def across(
        runs: Array, towards: str, foot: FirstFoot, begin: Array | None = None, length: float = np.inf
    ) -> Sideways:  # fmt: skip
        """Across the level runs (piece, 2) of a way, for who walks towards one of its ends.

        Where a way has no level run, such as on a vertical line, she looks along x.
        """
        runs = np.where(np.any(runs, axis=1, keepdims=True), runs, [1.0, 0.0])
        runs = runs / np.linalg.norm(runs, axis=1)[:, None] * (1.0 if towards == "end" else -1.0)
        left = np.stack([-runs[:, 1], runs[:, 0]], axis=1)
        return Sideways(left if foot == "left" else -left, np.zeros(1) if begin is None else begin, length)

    def at(self, place: Array) -> Array:
        """The direction (..., 2) at places along the way, m."""
        piece = np.searchsorted(self.begin, place, side="right") - 1
        return np.asarray(self.side[np.maximum(piece, 0)])


def _ways(net: AnyNet) -> Array:
    """Unit vectors (2, axis) along which places on a net are counted."""
    if net.sides is not None:
        both = np.array([spatial(side) for side in net.sides])
        return np.asarray(both / np.linalg.norm(both, axis=1)[:, None])
    assert net.boundary is not None
    points = np.array([spatial(point) for point in net.boundary])
    normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    along = points[1] - points[0]
    both = np.array([along, np.cross(normal, along)])
    return np.asarray(both / np.linalg.norm(both, axis=1)[:, None])
