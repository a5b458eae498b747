"""How far lines are from their chords: sag below them, and what they are to the side of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.contract import path_name
from ropewalk.results.declared import declared, line_of
from ropewalk.results.frame import IN_AIR, Array
from ropewalk.results.lifted_rope import is_touched

if TYPE_CHECKING:
    import xarray as xr

_STEEP = 0.02  # level over straight length of a chord: below, its line hangs, and has no sag


class Distances(NamedTuple):
    """How far points of a line are from its chord."""

    value: Array  # (frame, point) m, NaN where there is none
    xi: Array  # (frame, point) m, where they are along the line
    place: Array  # (frame, point, axis) m


def sag(dataset: xr.Dataset, line: str) -> Distances:
    """Depth of a line below the straight chord between its ends, or between its inner supports or sheaves, in m.

    At its nodes, and where loads touch it: there it is bent, and may be deepest.

    Args:
        dataset: a result.
        line: name of the line.

    Returns:
        Of nodes, then of contacts; positive below the chord, NaN where the chord is vertical to within 1 degree.
    """
    place, xi = _nodes(dataset, line)
    if (knots := _over_sheaves(dataset, line, place, xi)) is not None:
        points, at = (np.concatenate(both, axis=1) for both in zip((place, xi), _contacts(dataset, line), strict=True))
        return Distances(_height(points, at, *knots) - points[..., -1], at, points)
    away = place - place[:, :1]
    run, along = _onward(away, away)
    rise, z = away[:, -1:, -1], place[..., -1]
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = np.where(run > _STEEP * np.hypot(run, rise), rise / run, np.nan)
    height = _chord_height(dataset, line, place, along)
    spots, at = _contacts(dataset, line)
    _, there = _onward(spots - place[:, :1], away)
    there = np.where((there >= 0.0) & (there <= run), there, np.nan)  # beyond its ends it is on another line
    if height is None:
        chord, below = z[:, :1] + slope * along, z[:, :1] + slope * there
    else:
        chord = np.where(np.isfinite(slope), height, np.nan)
        below = np.reshape([np.interp(x, u, h) for x, u, h in zip(there, along, chord, strict=True)], there.shape)
    depth = np.concatenate([chord - z, below - spots[..., -1]], axis=1)
    return Distances(depth, np.concatenate([xi, at], axis=1), np.concatenate([place, spots], axis=1))


def sideways(dataset: xr.Dataset, line: str) -> Distances:
    """Level distance of the nodes of a line from the upright plane through its ends, in m.

    Args:
        dataset: a result with an axis y.
        line: name of the line.

    Returns:
        Positive to the left of the way from start to end; where the chord is vertical, the level distance from it.
    """
    place, xi = _nodes(dataset, line)
    away = place - place[:, :1]
    run, _ = _onward(away, away)
    with np.errstate(divide="ignore", invalid="ignore"):
        left = (away[:, -1:, 0] * away[..., 1] - away[:, -1:, 1] * away[..., 0]) / run
    upright = run <= 1e-9 * np.abs(away[:, -1:]).max(axis=2)
    return Distances(np.where(upright, np.hypot(away[..., 0], away[..., 1]), left), xi, place)


def _nodes(dataset: xr.Dataset, line: str) -> tuple[Array, Array]:
    """Places of the nodes of a line (frame, node, axis), and their xi (frame, node), m."""
    own = np.flatnonzero(dataset["line"].values == line)
    place = dataset["position"].isel(node=own).values
    return place, np.broadcast_to(dataset["xi"].values[own], place.shape[:2])


def _contacts(dataset: xr.Dataset, line: str) -> tuple[Array, Array]:
    """Places of the contacts of a line, and their xi, m; NaN where they do not touch it."""
    loads = declared(dataset, "loads")
    own = [k for k, load in enumerate(dataset["load"].values.tolist()) if line_of(load, loads) == line]
    touch = dataset["contact_state"].values[:, own] > IN_AIR
    place, xi = dataset["contact_position"].values[:, own], dataset["contact_xi"].values[:, own]
    return np.where(touch[..., None], place, np.nan), np.where(touch, xi, np.nan)


def _over_sheaves(dataset: xr.Dataset, line: str, place: Array, xi: Array) -> tuple[Array, Array] | None:
    """Places (frame, knot, axis) and xi (frame, knot) of ends and sheaves of a line, m; None without sheaves."""
    sheaves = declared(dataset, "lines").get(line, {}).get("sheaves")
    if not sheaves or "sheave_station" not in dataset:
        return None
    known = dataset["sheave"].values.tolist()
    station = dataset["sheave_station"].values[:, [known.index(f"{line}.{name}") for name in sheaves]]
    written = [one["at"] for one in sheaves.values()]  # with two or three components, as in results or not
    top = np.array([(at[0], at[1] if len(at) == 3 else 0.0, at[-1]) for at in written], dtype=float)
    top = top[:, :: 1 if place.shape[-1] == 3 else 2]
    tops = np.broadcast_to(top, (len(place), *top.shape))
    where = np.concatenate([place[:, :1], tops, place[:, -1:]], axis=1)
    return where, np.concatenate([xi[:, :1], station, xi[:, -1:]], axis=1)


def _height(points: Array, at: Array, knots: Array, station: Array) -> Array:
    """Height of chords from knot to knot at points (frame, point, axis), m; NaN where they are nearly vertical."""
    part = (at[:, :, None] >= station[:, None, 1:-1]).sum(axis=2)[..., None]
    low, high = np.take_along_axis(knots, part, axis=1), np.take_along_axis(knots, part + 1, axis=1)
    chord = high - low
    level = (chord[..., :-1] ** 2).sum(axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = ((points - low)[..., :-1] * chord[..., :-1]).sum(axis=2) / level
    height = low[..., -1] + share * chord[..., -1]
    return np.where(level > _STEEP**2 * (chord**2).sum(axis=2), height, np.nan)


def _onward(away: Array, of_line: Array) -> tuple[Array, Array]:
    """Level length of a chord (frame, 1) and the way of points along it (frame, point), m, from the start of the line.

    Args:
        away: of the points from the start, (frame, point, axis) m.
        of_line: the same of the nodes of the line.
    """
    chord = of_line[:, -1:, :-1]
    run = np.linalg.norm(chord, axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        along = (away[..., :-1] * (chord / run[..., None])).sum(axis=2)
    return run, along


def _chord_height(dataset: xr.Dataset, line: str, place: Array, along: Array) -> Array | None:
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


def _supported(line: dict[str, Any]) -> tuple[tuple[float, ...], dict[str, tuple[float, ...]]]:
    """Stations of inner supports of a line as declared, m, and the tops of its saddles by name, m."""
    supports, saddles = line.get("supports") or {}, line.get("saddles") or {}
    return (
        tuple(float(one["at"]) for one in supports.values()),
        {name: tuple(map(float, one["at"])) for name, one in saddles.items()},
    )
