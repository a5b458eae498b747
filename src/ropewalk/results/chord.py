"""Chords of lines: straight from each place that a line is supported at to the next one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.declared import declared
from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr

Supported = tuple[tuple[float, ...], tuple[tuple[float, ...], ...]]


def chord_height(dataset: xr.Dataset, line: str, place: Array, along: Array) -> Array | None:
    """Height of the chords of a line at its nodes, (frame, node) m; None where it is supported at its ends only.

    Inner supports hold a point of the line; over saddles it goes where it is level with their tops.

    Args:
        dataset: a result.
        line: name of the line.
        place: (frame, node, axis) m, of its nodes.
        along: (frame, node) m, level, from its start towards its end.
    """
    points, tops = _supported(declared(dataset, "lines").get(line, {}))
    if not points and not tops:
        return None
    xi, z = dataset["xi"].values[dataset["line"].values == line], place[..., -1]
    nodes = [int(np.abs(xi - at).argmin()) for at in points]
    out = np.full_like(z, np.nan)
    for f in range(len(z)):
        chord = place[f, -1, :-1] - place[f, 0, :-1]
        way = chord / max(float(np.linalg.norm(chord)), 1e-300)
        there = [float((np.array(top[:-1]) - place[f, 0, :-1]) @ way) for top in tops]
        inner = [(along[f, i], z[f, i]) for i in nodes]
        inner += [(at, max(top[-1], np.interp(at, along[f], z[f]))) for at, top in zip(there, tops, strict=True)]
        ends = [(0.0, z[f, 0]), (along[f, -1], z[f, -1])]
        knots = sorted([*ends, *((at, high) for at, high in inner if 0.0 < at < along[f, -1])])
        out[f] = np.interp(along[f], *np.transpose(knots))
    return out


def _supported(line: dict[str, Any]) -> Supported:
    """Stations of inner supports of a line as declared, m, and the tops of saddles that it lies on, m."""
    supports, saddles = line.get("supports") or {}, line.get("saddles") or {}
    return (
        tuple(float(one["at"]) for one in supports.values()),
        tuple(tuple(map(float, one["at"])) for one in saddles.values()),
    )
