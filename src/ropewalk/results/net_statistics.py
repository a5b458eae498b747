"""Statistics of nets and membranes: the largest tension per width, how much is slack, and how deep they hang."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.contract import path_name
from ropewalk.results.frame import Array
from ropewalk.results.nets import Indices, edges, in_space, net_names, triangles

if TYPE_CHECKING:
    import xarray as xr

STEEP = 1e-6  # least to largest width of the edge as seen from above, below which a net has no depth

Summary = dict[str, Any]


def net_summary(dataset: xr.Dataset, segments: Iterable[xr.Dataset]) -> dict[str, Summary]:
    """Give for every net its `nodes` and `cells`, and where and when extremes occur; None for unknown values.

    `largest_tension` and `smallest_tension` are in N/m, at the middle of a cell; `slack` is the largest share of cells
    that pull in one direction at most; `largest_sag` is the depth in m below the plane through the edge (by least
    squares).

    Args:
        dataset: a result.
        segments: the same along its leading dimension, small enough to be loaded.
    """
    nets = net_names(dataset)
    if not nets:
        return {}
    cells, owner = triangles(dataset), dataset["cell_net"].values
    own = {net: cells[owner == net] for net in nets}
    found: dict[str, Summary] = {
        net: {
            "nodes": len(np.unique(own[net])),
            "cells": len(own[net]),
            **dict.fromkeys(("largest_tension", "smallest_tension", "slack", "largest_sag")),
        }
        for net in nets
    }
    for piece in segments:
        path, position = piece[path_name(piece)].values, in_space(piece["position"].values)
        for net in nets:
            if "cell_tension" in piece:
                here = np.flatnonzero(owner == net)
                _tensions(found[net], piece["cell_tension"].values[:, here], position, own[net], path)
            _deepest(found[net], position, own[net], path)
            for entry in found[net].values():
                if isinstance(entry, dict) and "when" in entry:
                    entry[path_name(dataset)] = entry.pop("when")
    return found


def _tensions(found: Summary, pull: Array, position: Array, cells: Indices, path: Array) -> None:
    """Take the extremes of tensions (frame, cell, direction) into what has been found so far."""
    if not np.isfinite(pull).any():
        return
    for name, pick, sign in (("largest_tension", np.nanargmax, 1.0), ("smallest_tension", np.nanargmin, -1.0)):
        frame, cell, direction = np.unravel_index(int(pick(pull)), pull.shape)
        value = float(pull[frame, cell, direction])
        if found[name] is None or sign * value > sign * found[name]["value"]:
            middle = position[frame, cells[cell]].mean(axis=0)
            found[name] = {"value": value, "unit": "N/m", **_at(middle), "when": path[frame]}
    idle = (np.nan_to_num(pull, nan=1.0) <= 0.0).any(axis=2).mean(axis=1)
    most = int(np.argmax(idle))
    if found["slack"] is None or idle[most] > found["slack"]["value"]:
        found["slack"] = {"value": float(idle[most]), "unit": "1", "when": path[most]}


def _deepest(found: Summary, position: Array, cells: Indices, path: Array) -> None:
    nodes, rim = np.unique(cells), np.unique(edges(cells))
    for frame in range(len(path)):
        depth = depth_below(position[frame, nodes], position[frame, rim])
        if depth is None:
            return
        deepest = int(np.argmax(depth))
        if found["largest_sag"] is None or depth[deepest] > found["largest_sag"]["value"]:
            place = position[frame, nodes[deepest]]
            found["largest_sag"] = {"value": float(depth[deepest]), "unit": "m", **_at(place), "when": path[frame]}


def depth_below(points: Array, rim: Array) -> Array | None:
    """Depth of points below the plane that fits an edge best, in m; None if that plane stands upright.

    Args:
        points: (point, 3) m.
        rim: (node, 3) m, the edge.
    """
    if len(rim) < 3 or not np.isfinite(rim).all():
        return None
    middle = rim.mean(axis=0)
    across = rim - middle
    widths = np.linalg.svd(across[:, :2], compute_uv=False)
    if widths[1] <= STEEP * max(widths[0], float(np.ptp(rim[:, 2]))):
        return None
    slope = np.linalg.lstsq(across[:, :2], across[:, 2], rcond=None)[0]
    return np.asarray(middle[2] + (points[:, :2] - middle[:2]) @ slope - points[:, 2])


def _at(place: Array) -> Summary:
    return dict(zip("xyz", place.tolist(), strict=True))
