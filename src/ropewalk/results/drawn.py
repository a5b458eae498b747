"""Where lines are drawn: bent where loads touch them, though nodes beside a load lie on a curve.

Beside a sharp bend nodes are up to a tenth of a link away from the line (docs/notes/gate-of-contacts.md): a load would
be seen to hang below it. What results say of nodes stays as it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.declared import declared, line_of
from ropewalk.results.frame import IN_AIR, Array

if TYPE_CHECKING:
    import xarray as xr

BENT = ("position", "contact_position", "contact_xi", "contact_state")
_SEEN = 0.02  # of a link: nearer to the straight line between its nodes no contact is seen to be off it


class Bends:
    """Where lines are bent by loads.

    Args:
        node_line: names of the lines of nodes.
        node_xi: (node,) m, along these.
        contacts: names of contacts.
        loads: of each load the lines that it is `on` and `also_on`.
    """

    def __init__(
        self, node_line: Sequence[str], node_xi: Array, contacts: Sequence[str], loads: Mapping[str, Any]
    ) -> None:
        names, on = np.asarray(node_line), [line_of(contact, loads) for contact in contacts]
        nodes = {name: np.flatnonzero(names == name) for name in dict.fromkeys(on)}
        self._lines = [
            (own, node_xi[own], np.array([line == name for line in on]))
            for name, own in nodes.items() if own.size > 2 and np.isfinite(node_xi[own]).all()
        ]  # fmt: skip

    def drawn(self, position: Array, places: Array, xi: Array, state: Array) -> Array:
        """Positions (frame, node, axis), m; of nodes within a link of a load on straight lines that meet there.

        Args:
            position: of the nodes.
            places: (frame, contact, axis) m, of contacts.
            xi: (frame, contact) m, of these along their lines.
            state: (frame, contact) codes, as in results.
        """
        position = np.array(position, dtype=float)
        touch = (state > IN_AIR) & np.isfinite(xi) & np.isfinite(places).all(axis=-1)
        for own, stations, here in self._lines:
            for frame in np.flatnonzero((touch & here).any(axis=1)):
                k = touch[frame] & here
                position[frame, own] = _bent(position[frame, own], stations, places[frame, k], xi[frame, k])
        return position


def drawn_position(dataset: xr.Dataset) -> Array:
    """Positions of nodes (frame, node, axis), m; those within a link of a load are on straight lines that meet there.

    Args:
        dataset: the frames of a result that are to be drawn.
    """
    bends = Bends(
        dataset["line"].values.tolist(),
        dataset["xi"].values,
        dataset["load"].values.tolist(),
        declared(dataset, "loads"),
    )
    return bends.drawn(*(dataset[name].values for name in BENT))


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
