"""Nets and lines in space: triangles of nets, their edges and statistics, and whether a result is in a plane."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ropewalk.results import style
from ropewalk.results.contract import path_name
from ropewalk.results.extremes import Summary
from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr

Indices = NDArray[np.intp]

FAR = 0.01  # of the size: supports that move further are not marked
LOOKED_AT = 101  # frames that are searched for what stands out
SIDEWAYS = 1e-6  # extents sideways below this part of the size are round-off


def net_names(dataset: xr.Dataset) -> list[str]:
    """Names of the nets and membranes, in the order of the result."""
    return list(dict.fromkeys(dataset["cell_net"].values.tolist())) if "cell_net" in dataset.coords else []


def triangles(dataset: xr.Dataset) -> Indices:
    """Numbers of the nodes at the corners of all cells, (cell, corner)."""
    if "cell_node" not in dataset.coords:
        return np.empty((0, 3), dtype=np.intp)
    return np.asarray(dataset["cell_node"].values).astype(np.intp)


def edges(cells: Indices) -> Indices:
    """Sides that belong to one triangle alone, (edge, 2): the edge of a net, its holes included."""
    sides = np.concatenate([cells[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    _, first, times = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True)
    return np.asarray(sides[np.sort(first[times == 1])])


def in_space(vectors: Array) -> Array:
    """Vectors (..., axis) of two or three components as (..., 3), with y = 0 where there is none."""
    if vectors.shape[-1] == 3:
        return vectors
    out = np.zeros((*vectors.shape[:-1], 3))
    out[..., [0, 2]] = vectors
    return out


def is_spatial(dataset: xr.Dataset) -> bool:
    """Whether there are nets, or anything is further aside of the x-z plane than the rest."""
    if net_names(dataset):
        return True
    if "y" not in dataset["axis"].values or not dataset.sizes[path_name(dataset)]:
        return False
    frames = style.thinned(dataset.sizes[path_name(dataset)], LOOKED_AT)
    displayed = dataset[["position", "contact_position", "body_position"]].isel({path_name(dataset): frames})
    points = np.concatenate([displayed[name].values.reshape(-1, 3) for name in displayed.data_vars])
    points = points[np.isfinite(points).all(axis=1)]
    extent = np.ptp(points, axis=0) if len(points) else np.zeros(3)
    return bool(extent[1] > SIDEWAYS * extent.max())


def most_deflected(dataset: xr.Dataset) -> int:
    """Number of the frame in which a node is furthest from its place in the first one; of those looked at."""
    frames = style.thinned(dataset.sizes[path_name(dataset)], LOOKED_AT)
    start = dataset["position"][0].values
    away = [np.nanmax(np.linalg.norm(dataset["position"][int(k)].values - start, axis=-1)) for k in frames]
    return int(frames[np.argmax(away)]) if max(away) > 0.0 else int(frames[-1])


def line_ends(dataset: xr.Dataset, line: str) -> Indices:
    """Numbers of the nodes at the ends of a line that supports hold: joints with other lines and nets are left out.

    An end that another line shares counts as held if a support bears its name, or if it never moves; one that moves far
    is at a winch, a weight or a machine.
    """
    here = np.flatnonzero(dataset["line"].values == line)
    others = np.flatnonzero(dataset["line"].values != line)
    named = set(dataset["support"].values.tolist())
    first = dataset["position"][0].values
    size = np.nanmax(np.ptp(first, axis=0))
    restrained = []
    paths = dataset["position"].isel(node=here[[0, -1]]).values
    for node, end in ((here[0], "start"), (here[-1], "end")):
        away = float(np.nanmax(np.ptp(paths[:, int(end == "end")], axis=0), initial=0.0))
        if away > FAR * size:
            continue
        alone = not (np.abs(first[others] - first[node]).max(axis=1) <= 1e-9 * size).any()
        still = dataset.sizes[path_name(dataset)] > 1 and away <= 1e-9 * size
        if alone or still or f"{line}.{end}" in named:
            restrained.append(node)
    return np.array(restrained, dtype=np.intp)


def cell_values(dataset: xr.Dataset, frame: int) -> Array:
    """The larger tension per width of every cell in a frame, (cell,) N/m; NaN where none is known."""
    if "cell_tension" not in dataset:
        return np.full(len(triangles(dataset)), np.nan)
    return np.asarray(np.fmax.reduce(dataset["cell_tension"][frame].values, axis=1))


class NetTriangles:
    """The triangles of all nets as they are drawn: of a fine net, a coarser one whose corners are some of its nodes.

    Nodes in one box of a grid become one corner: the outermost of those on the edge, or else the one next to their
    middle. Triangles with three different corners stay. There are no gaps, and the corners move with their nodes.

    Args:
        cells: (cell, 3) numbers of nodes.
        points: (node, 3) m, where the nodes are when the grid is laid.
        most: about how many triangles there may be.
    """

    def __init__(self, cells: Indices, points: Array, most: int) -> None:
        self.cells, self.edges = cells, edges(cells)
        self.is_whole = len(cells) <= most
        if self.is_whole:
            return
        nodes, corner = np.unique(cells, return_inverse=True)
        where, self._of = points[nodes], corner.reshape(cells.shape)
        sides = np.linalg.norm(where[self._of] - where[self._of[:, [1, 2, 0]]], axis=2)
        step = float(np.median(sides)) * np.sqrt(len(cells) / most)
        boxes = np.floor((where - where.min(axis=0)) / step + 0.5).astype(np.intp)
        _, group = np.unique(boxes, axis=0, return_inverse=True)
        self._group = group.ravel()
        count = int(self._group.max()) + 1
        total = np.stack([np.bincount(self._group, w, count) for w in where.T], axis=1)
        middle = total / np.bincount(self._group, minlength=count)[:, None]
        rank = np.linalg.norm(where - middle[self._group], axis=1)
        outer = np.isin(nodes, self.edges)
        rank[outer] = -np.linalg.norm(where[outer] - where.mean(axis=0), axis=1)
        order = np.argsort(rank)[::-1]
        keeper = np.empty(count, dtype=np.intp)
        keeper[self._group[order]] = nodes[order]  # the lowest rank is written last
        kept = self._group[self._of]
        kept = kept[(kept != kept[:, [1, 2, 0]]).all(axis=1)]
        _, first = np.unique(np.sort(kept, axis=1), axis=0, return_index=True)
        self._corners = kept[np.sort(first)]
        self.cells = keeper[self._corners]

    def values(self, of_cells: Array) -> Array:
        """Values (cell,) of the net as values of the triangles drawn: means of what they stand for."""
        if self.is_whole:
            return of_cells
        known = np.isfinite(of_cells)
        groups = self._group[self._of[known]].ravel()
        count = int(self._group.max()) + 1
        total = np.bincount(groups, np.repeat(of_cells[known], 3), count)
        with np.errstate(invalid="ignore"):
            mean = total / np.bincount(groups, minlength=count)
        return np.asarray(mean[self._corners].mean(axis=1))


STEEP = 1e-6  # least to largest width of the edge as seen from above, below which a net has no depth


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
