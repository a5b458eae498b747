"""Chords of lines: straight from each place that a line is supported at to the next one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.contract import path_name
from ropewalk.results.declared import declared
from ropewalk.results.frame import Array
from ropewalk.results.lifted_rope import is_touched

if TYPE_CHECKING:
    import xarray as xr

Supported = tuple[tuple[float, ...], dict[str, tuple[float, ...]]]


def chord_height(dataset: xr.Dataset, line: str, place: Array, along: Array) -> Array | None:
    """Height of the chords of a line at its nodes, (frame, node) m; None where it is supported at its ends only.

    Inner supports hold a point of the line; over saddles it goes where it is level with their tops. A saddle that bears
    no force in a frame supports nothing then: the chord spans it.

    Args:
        dataset: a result.
        line: name of the line.
        place: (frame, node, axis) m, of its nodes.
        along: (frame, node) m, level, from its start towards its end.
    """
    points, tops = _supported(declared(dataset, "lines").get(line, {}))
    if not points and not tops:
        return None
    touched = {saddle: _is_touched(dataset, f"{line}.{saddle}", line) for saddle in tops}
    xi, z = dataset["xi"].values[dataset["line"].values == line], place[..., -1]
    nodes = [int(np.abs(xi - at).argmin()) for at in points]
    out = np.full_like(z, np.nan)
    for f in range(len(z)):
        chord = place[f, -1, :-1] - place[f, 0, :-1]
        way = chord / max(float(np.linalg.norm(chord)), 1e-300)
        here = [top for saddle, top in tops.items() if touched[saddle][f]]
        there = [float((np.array([top[0], *top[1:-1], 0.0][: len(way)]) - place[f, 0, :-1]) @ way) for top in here]
        inner = [(along[f, i], z[f, i]) for i in nodes]
        inner += [(at, max(top[-1], np.interp(at, along[f], z[f]))) for at, top in zip(there, here, strict=True)]
        ends = [(0.0, z[f, 0]), (along[f, -1], z[f, -1])]
        knots = sorted([*ends, *((at, high) for at, high in inner if 0.0 < at < along[f, -1])])
        out[f] = np.interp(along[f], *np.transpose(knots))
    return out


def _is_touched(dataset: xr.Dataset, support: str, line: str) -> NDArray[np.bool_]:
    """Whether a saddle touches its line, (frame,); where no force of it is known it does."""
    known = dataset["support"].values.tolist()
    if support not in known:
        return np.ones(dataset.sizes[path_name(dataset)], dtype=np.bool_)
    links = np.flatnonzero(dataset["link_line"].values == line)
    reaction = dataset["reaction"].isel(support=known.index(support)).values
    return is_touched(reaction, dataset["tension"].isel(link=links).values)


def _supported(line: dict[str, Any]) -> Supported:
    """Stations of inner supports of a line as declared, m, and the tops of its saddles by name, m."""
    supports, saddles = line.get("supports") or {}, line.get("saddles") or {}
    return (
        tuple(float(one["at"]) for one in supports.values()),
        {name: tuple(map(float, one["at"])) for name, one in saddles.items()},
    )
