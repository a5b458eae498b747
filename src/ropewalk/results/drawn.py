"""Where lines are drawn: bent where loads touch them, though nodes beside a load lie on a curve.

Beside a sharp bend nodes are up to a tenth of a link away from the line (docs/notes/gate-of-contacts.md): a load would
be seen to hang below it. What results say of nodes stays as it is.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ropewalk.results.declared import declared, line_of
from ropewalk.results.frame import IN_AIR, Array

if TYPE_CHECKING:
    import xarray as xr

_SEEN = 0.02  # of a link: nearer to the straight line between its nodes no contact is seen to be off it


def drawn_position(dataset: xr.Dataset) -> Array:
    """Return positions of nodes (frame, node, axis), m; those within a link of a load are on straight lines there.

    Args:
        dataset: the frames of a result that are to be drawn.
    """
    position = np.array(dataset["position"].values, dtype=float)
    places, xi, loads = dataset["contact_position"].values, dataset["contact_xi"].values, declared(dataset, "loads")
    touch = (dataset["contact_state"].values > IN_AIR) & np.isfinite(xi) & np.isfinite(places).all(axis=-1)
    names, node_xi = dataset["line"].values, dataset["xi"].values
    on = np.array([line_of(contact, loads) for contact in dataset["load"].values.tolist()], dtype=object)
    for name in dict.fromkeys(on.tolist()):
        own, here = np.flatnonzero(names == name), on == name
        stations = node_xi[own]
        if own.size <= 2 or not np.isfinite(stations).all():
            continue
        for frame in np.flatnonzero((touch & here).any(axis=1)):
            k = touch[frame] & here
            position[frame, own] = _bent(position[frame, own], stations, places[frame, k], xi[frame, k])
    return position


def _bent(nodes: Array, stations: Array, places: Array, xi: Array) -> Array:
    """The nodes of a line, which is bent at places of contacts that are seen not to be on its links."""
    links = np.diff(stations)
    link = np.clip(np.searchsorted(stations, xi, side="right") - 1, 0, links.size - 1)
    h = links[link]
    part = np.clip((xi - stations[link]) / h, 0.0, 1.0)[:, None]
    off = np.linalg.norm(places - (1.0 - part) * nodes[link] - part * nodes[link + 1], axis=1)
    seen = (off > _SEEN * h) & (xi > stations[0]) & (xi < stations[-1])
    if not seen.any():
        return nodes
    places, xi, h = places[seen], xi[seen], h[seen]
    near = (np.abs(stations[:, None] - xi) < h).any(axis=1)
    near[[0, -1]] = False
    corners = np.concatenate([stations[~near], xi])
    order = np.argsort(corners, kind="stable")
    shape = np.concatenate([nodes[~near], places])[order]
    bent = nodes.copy()
    for axis in range(nodes.shape[1]):
        bent[near, axis] = np.interp(stations[near], corners[order], shape[:, axis])
    nearest = 1 + np.abs(stations[1:-1, None] - xi).argmin(axis=0)
    bent[nearest] = places
    return bent
