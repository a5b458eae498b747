"""Paths of loads on nets and membranes: where the net below each of their points rests."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ropewalk.mechanics.chain import Array
from ropewalk.model.load import AnyLoad
from ropewalk.model.scenario import Scenario
from ropewalk.system.assembling.membranes import MembraneMesh, sheet_of
from ropewalk.system.assembling.surface_paths import patch

_APART = 0.25  # of a cell, between two points of a path that are looked at


@dataclass(frozen=True)
class PathOnNet:
    """The path of a load, point by point."""

    net: str
    xi: Array  # (point,) m along the path
    share: Array  # (point, vertex) how vertices share each point, as those of contacts do

    def rest(self, xi: Array, place: Array) -> Array:
        """Places (..., axis) of points xi (...) of the path where the vertices of its net are at (vertex, axis), m."""
        points = self.share @ place
        return np.stack([np.interp(xi, self.xi, row) for row in points.T], axis=-1)


def paths_on_nets(scenario: Scenario) -> dict[str, PathOnNet]:
    """The paths of all loads that are on nets, by load."""
    meshes = {name: sheet_of(name, net) for name, net in scenario.nets.items()}
    return {name: _path(meshes[load.on], corners) for name, load, corners in _on_nets(scenario)}


def _on_nets(scenario: Scenario) -> Iterator[tuple[str, AnyLoad, Array]]:
    for name, load in scenario.loads.items():
        if load.on in scenario.nets:
            corners = getattr(load, "path", None) or load.travel.path  # type: ignore[union-attr]
            yield name, load, np.array(corners, dtype=float)


def _path(sheet: MembraneMesh, corners: Array) -> PathOnNet:
    """A path along the sides of a sheet, (corner, 2) m."""
    surface, size = sheet.surface, float(np.sqrt(2.0 * sheet.surface.areas.mean()))
    upto = np.append(0.0, np.cumsum(np.hypot(*np.diff(corners, axis=0).T)))
    count = max(2, int(np.ceil(upto[-1] / (_APART * size))) + 1)
    xi = np.unique(np.concatenate([np.linspace(0.0, upto[-1], count), upto]))
    places = sheet.in_plan(np.stack([np.interp(xi, upto, own) for own in corners.T], axis=1))
    share = np.zeros((xi.size, surface.plan.shape[0]))
    for row, place in zip(share, places, strict=True):
        below = patch(surface, place)
        if below is not None:  # it leads over the edge nowhere: the full scenario has been run
            np.add.at(row, below[0], below[1])
    return PathOnNet(sheet.name, xi, share)
