"""What results show of lines whose nodes are elsewhere in each frame: the same places along them in all."""

from __future__ import annotations

import numpy as np

from ropewalk.mechanics.chain import Array, Integers
from ropewalk.results.frame import Frame, Layout
from ropewalk.system.equilibrium.split_lines import SplitRest


class FixedStations:
    """The nodes and links of a result."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        lines = dict.fromkeys(layout.link_line)
        node, link = np.array(layout.node_line), np.array(layout.link_line)
        self._node = {name: np.flatnonzero(node == name) for name in lines}
        self._link = {name: np.flatnonzero(link == name) for name in lines}
        self._vertices = np.flatnonzero(~np.isin(node, list(lines)))

    def of(self, rest: SplitRest, own: Frame, other: Layout) -> tuple[Array, Array, Array]:
        """Places of nodes (node, axis) in m, tensions (link,) in N and strains (link,) of links.

        Nodes are those of the curve through the nodes of a run, links have what these have in their middles.
        """
        n, links = len(self.layout.node_line), len(self.layout.link_line)
        position, axial = np.empty((n, rest.r.shape[0])), np.empty((2, links))
        theirs = np.array(other.link_line)
        for name, at in self._node.items():
            xi, mine, runs = self.layout.node_xi[at], self._link[name], rest.runs_of(name)
            ends = np.array([rest.stations(s)[-1] for s in runs[:-1]])
            of_node, of_link = np.searchsorted(ends, xi), np.searchsorted(ends, self.layout.link_xi[mine])
            values, at_links = np.array([own.tension, own.strain])[:, theirs == name], other.link_xi[theirs == name]
            run_of_link = np.searchsorted(ends, at_links)
            for i, s in enumerate(runs):
                nodes = rest.nodes_of(s)
                position[at[of_node == i]] = _through(rest.stations(s), rest.r[:, nodes].T, xi[of_node == i])
                there = run_of_link == i
                axial[:, mine[of_link == i]] = _between(
                    at_links[there], values[:, there].T, self.layout.link_xi[mine[of_link == i]]
                ).T
        if self._vertices.size:
            mine = np.flatnonzero(~np.isin(np.array(other.node_line), list(self._node)))
            position[self._vertices] = own.position[mine]
        return position, axial[0], axial[1]


def _through(at: Array, values: Array, wanted: Array) -> Array:
    """Values on the smooth curve through others."""
    if not wanted.size:
        return np.empty((0, values.shape[1]))
    nodes: Integers = np.searchsorted(at, wanted)
    if np.array_equal(at[np.minimum(nodes, at.size - 1)], wanted):
        return np.asarray(values[nodes])
    if at.size <= 2:
        return _between(at, values, wanted)
    from scipy.interpolate import CubicSpline  # lazy: it takes long to import

    return np.asarray(CubicSpline(at, values)(wanted))


def _between(at: Array, values: Array, wanted: Array) -> Array:
    """Values between others, and beyond the last ones straight on; (wanted, value)."""
    if at.size == 1:
        return np.repeat(values, wanted.size, axis=0)
    i = np.clip(np.searchsorted(at, wanted) - 1, 0, at.size - 2)
    part = ((wanted - at[i]) / (at[i + 1] - at[i]))[:, None]
    return np.asarray((1.0 - part) * values[i] + part * values[i + 1])
