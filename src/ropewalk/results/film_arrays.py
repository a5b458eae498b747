"""Arrays of all frames of a film, of what is drawn alone: places with displacements as drawn, colours, diagrams."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ropewalk.results import style
from ropewalk.results.contract import path_name
from ropewalk.results.frame import Array
from ropewalk.results.nets import NetTriangles, cell_values, in_space, line_ends, triangles
from ropewalk.results.picture import DrawnQuantity, Picture
from ropewalk.results.symbols import Symbol

if TYPE_CHECKING:
    import xarray as xr

CELLS, LINKS = 4_000, 1_500  # most triangles drawn, and most links of one line
TOGETHER = 2_000_000  # numbers of nodes that are read at once
_SMALL = ("contact_position", "contact_reference", "body_position", "body_reference", "wheel_position")


class FilmArrays:
    """What is drawn of each frame. Nodes are those drawn alone: a film of a large net needs little memory.

    Args:
        dataset: the frames shown of a result.
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        self.picture = Picture(dataset)
        self._dataset, self._lines = dataset, dataset["line"].values
        self.mesh = NetTriangles(triangles(dataset), in_space(dataset["position"][0].values), CELLS)
        self.strokes = self._strokes()
        ends = [node for line in self.picture.lines for node in line_ends(dataset, line).tolist()]
        symbols = [node for symbol in self.picture.symbols for node in symbol.nodes]
        parts = (self.strokes[:2].ravel(), self.mesh.cells.ravel(), np.array([*ends, *symbols], dtype=np.intp))
        self._kept = np.unique(np.concatenate(parts))
        self.ends, self.cells, self.edges = (self.drawn(np.array(part, dtype=np.intp))
                                             for part in (ends, self.mesh.cells, self.mesh.edges))  # fmt: skip
        self.diagrams = {q.name: self._nodes_of(q) for q in self.picture.diagrams}
        self._read()

    def drawn(self, nodes: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return the numbers of nodes of the result among those that are drawn."""
        return np.searchsorted(self._kept, nodes)

    def placed(self, points: Array) -> Array:
        """Return where points (..., axis) m that are not displaced are drawn, (..., 3) m."""
        out = np.array(points, dtype=float)
        out[..., -1] = (out[..., -1] - self.origin) * self.picture.height_factor
        return in_space(out)

    def line_of(self, nodes: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return numbers of the lines of nodes."""
        return np.unique(self._lines, return_inverse=True)[1][nodes]

    def _strokes(self) -> NDArray[np.intp]:
        """Return the nodes at both ends of every link drawn, and its number, (3, stroke)."""
        found = [np.empty((3, 0), dtype=np.intp)]
        for line in self.picture.lines:
            nodes, links = (np.flatnonzero(names == line) for names in (self._lines, self._dataset["link_line"].values))
            kept = style.thinned(len(nodes), LINKS + 1)
            if len(links):
                found.append(np.stack((nodes[kept[:-1]], nodes[kept[1:]], links[kept[:-1]])))
        return np.concatenate(found, axis=1)

    def _nodes_of(self, quantity: DrawnQuantity) -> NDArray[np.intp]:
        """Return the nodes of a diagram from line to line."""
        lines = [line for line in self.picture.lines if line in quantity.lines or not quantity.lines]
        own = [np.flatnonzero(self._lines == line) for line in lines]
        return np.concatenate([nodes[style.thinned(len(nodes), LINKS)] for nodes in own] or [np.zeros(0, np.intp)])

    def _read(self) -> None:
        name = path_name(self._dataset)
        every = max(TOGETHER // max(self._dataset.sizes["node"], 1), 1)
        parts = dict[str, list[Array]]()
        for first in range(0, self._dataset.sizes[name], every):
            frames = self._dataset.isel({name: slice(first, first + every)})
            for key, values in self._taken(frames, self.picture.add(frames)).items():
                parts.setdefault(key, []).append(values)
        found = {key: np.concatenate(values) for key, values in parts.items()}
        reference, level = self.picture.reference, np.ptp(self.picture.reference[:, -1]) <= 1e-6 * self.picture.extent
        self.is_level = bool(level) and self.picture.factor != 1.0 and not self.picture.is_spatial
        self.origin = float(reference[0, -1]) if self.is_level else 0.0
        self.nodes = self._displaced(found["position"], reference[self._kept])
        self.contacts = self._displaced(found["contact_position"], found["contact_reference"])
        self.bodies = self._displaced(found["body_position"], found["body_reference"])
        self.has_trains = "wheel_position" in found
        if self.has_trains:
            off = ~np.isfinite(self.contacts[..., 0])
            self.contacts[off] = self.placed(found["wheel_position"])[off]
        self.values = {key.removeprefix("of "): found[key] for key in found if key.startswith("of ")}
        self.colours, self.shades = found["colour"], found.get("shade", np.zeros((0, 0)))

    def _displaced(self, place: Array, reference: Array) -> Array:
        reference = np.where(np.isfinite(reference), reference, place)  # as of contacts on nets
        return self.placed(reference + self.picture.factor * (place - reference))

    def _taken(self, frames: xr.Dataset, arrays: dict[str, Array]) -> dict[str, Array]:
        """Return what is drawn of the arrays of some frames: values of diagrams have an `of` before their names."""
        out = {key: arrays[key] for key in _SMALL if key in arrays}
        out["position"] = arrays["position"][:, self._kept]
        colour, count = self.picture.colour, self.strokes.shape[1]
        out["colour"] = np.full((len(out["position"]), count), np.nan)
        if colour is not None and colour.of == "link":
            out["colour"] = arrays[colour.name][:, self.strokes[2]]
        elif colour is not None and colour.of == "node":
            own = np.isin(self._lines[self.strokes[0]], colour.lines or self.picture.lines)
            values = arrays[colour.name][:, self.strokes[:2]].mean(axis=1)
            out["colour"] = np.where(own, values, np.nan)
        out |= {f"of {key}": arrays[key][:, nodes] for key, nodes in self.diagrams.items()}
        if len(self.mesh.cells):
            out["shade"] = np.stack([self.mesh.values(cell_values(frames, k)) for k in range(len(out["position"]))])
        return out

    def at(self, symbol: Symbol, k: int) -> tuple[Array, Array]:
        """Return where the contacts and bodies of a symbol, or else its nodes and fixed places, are in a frame."""
        if symbol.contacts or symbol.bodies:
            return self.contacts[k, list(symbol.contacts)], self.bodies[k, list(symbol.bodies)]
        fixed = self.placed(np.array([symbol.at])) if symbol.at else np.zeros((0, 3))
        nodes = self.nodes[k, self.drawn(np.array(symbol.nodes, dtype=np.intp))]
        foot = fixed.copy()
        if symbol.foot is not None and len(foot):
            foot[:, 2] = (symbol.foot - self.origin) * self.picture.height_factor
        return (fixed if len(fixed) else nodes), foot
