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
    spots, at = _contacts(dataset, line)
    knots, station = _knots(dataset, line, place, xi)
    if "sheaves" not in declared(dataset, "lines").get(line, {}):
        run, there = _onward(spots, place)
        is_beyond = (there < 0.0) | (there > run)  # of its ends: it is on another line
        spots = np.where(is_beyond[..., None], np.nan, spots)
    points, at = np.concatenate([place, spots], axis=1), np.concatenate([xi, at], axis=1)
    return Distances(_height(points, at, knots, station) - points[..., -1], at, points)


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
    run, _ = _onward(place, place)
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


def supported(dataset: xr.Dataset, line: str) -> Array:
    """Return xi of the points that a line hangs from, (frame, knot) m, in their order."""
    return _knots(dataset, line, *_nodes(dataset, line))[1]


def _knots(dataset: xr.Dataset, line: str, place: Array, xi: Array) -> tuple[Array, Array]:
    """Return places (frame, knot, axis) and xi (frame, knot) of what a line hangs from, m, in the order of xi.

    These are its ends, inner supports, sheaves and saddles. A saddle that bears no force in a frame supports nothing
    then: the chord spans it, and its knot is at the start.
    """
    of = declared(dataset, "lines").get(line, {})
    nodes = [0, -1, *(int(np.abs(xi[0] - float(one["at"])).argmin()) for one in (of.get("supports") or {}).values())]
    places, stations = [place[:, i] for i in nodes], [xi[:, i] for i in nodes]
    if "sheave_station" in dataset:
        known = dataset["sheave"].values.tolist()
        for name, sheave in (of.get("sheaves") or {}).items():
            places.append(np.broadcast_to(_top(sheave, place), places[0].shape))
            stations.append(dataset["sheave_station"].values[:, known.index(f"{line}.{name}")])
    for name, saddle in (of.get("saddles") or {}).items():
        top = np.broadcast_to(_top(saddle, place), places[0].shape)[:, None]
        _, along = _onward(place, place)
        run, there = _onward(top, place)
        rope = np.array([[np.interp(w, u, x), np.interp(w, u, z)] for w, u, x, z in zip(
            there[:, 0], along, xi, place[..., -1], strict=True)])  # fmt: skip
        top = np.concatenate([top[:, 0, :-1], np.maximum(top[:, 0, -1], rope[:, 1])[:, None]], axis=1)
        bears = _is_touched(dataset, f"{line}.{name}", line) & ((there > 0.0) & (there < run))[:, 0]
        places.append(np.where(bears[:, None], top, place[:, 0]))
        stations.append(np.where(bears, rope[:, 0], xi[:, 0]))
    order = np.argsort(np.stack(stations, axis=1), axis=1, kind="stable")
    return (
        np.take_along_axis(np.stack(places, axis=1), order[..., None], axis=1),
        np.take_along_axis(np.stack(stations, axis=1), order, axis=1),
    )


def _top(support: dict[str, Any], place: Array) -> Array:
    """Return where a sheave or saddle is, (axis,) m; its file may have two or three components."""
    at = [float(value) for value in support["at"]]
    return np.array([at[0], *([at[1] if len(at) == 3 else 0.0] if place.shape[-1] == 3 else []), at[-1]])


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


def _onward(points: Array, place: Array) -> tuple[Array, Array]:
    """Level length of a chord (frame, 1) and the way of points along it (frame, point), m, from the start of the line.

    Args:
        points: (frame, point, axis) m.
        place: the same of the nodes of the line.
    """
    chord = (place[:, -1:] - place[:, :1])[..., :-1]
    run = np.linalg.norm(chord, axis=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        along = ((points - place[:, :1])[..., :-1] * (chord / run[..., None])).sum(axis=2)
    return run, along


def _is_touched(dataset: xr.Dataset, support: str, line: str) -> NDArray[np.bool_]:
    """Whether a saddle touches its line, (frame,); where no force of it is known it does."""
    known = dataset["support"].values.tolist()
    if support not in known:
        return np.ones(dataset.sizes[path_name(dataset)], dtype=np.bool_)
    links = np.flatnonzero(dataset["link_line"].values == line)
    reaction = dataset["reaction"].isel(support=known.index(support)).values
    return is_touched(reaction, dataset["tension"].isel(link=links).values)
