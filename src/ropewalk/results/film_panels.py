"""Panels of a film: arrays of all frames, views of the structure on the page, diagrams along it, and contact forces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.ticker import NullLocator
from numpy.typing import NDArray

from ropewalk.results import style
from ropewalk.results.axis_units import round_axis
from ropewalk.results.contact_statistics import CUTOFF, contact_statistics, filtered, interval_of, samples
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import DisplayUnits, decimals, number
from ropewalk.results.frame import Array
from ropewalk.results.nets import NetTriangles, cell_values, in_space, line_ends, triangles
from ropewalk.results.picture import DrawnQuantity, Picture
from ropewalk.results.scene import Scene
from ropewalk.results.symbols import Symbol

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

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


Corners = tuple[Array, Array]
LISTED = 6  # loads whose forces are written
MARGIN = 0.03  # of the width: free space at both ends
_TEXT: dict[str, Any] = {"va": "top", "family": "monospace", "animated": True, "zorder": 9,
                         "bbox": {"boxstyle": "square,pad=0.15", "facecolor": "white", "edgecolor": "none",
                                  "alpha": 0.8}}  # fmt: skip
_NAME: dict[str, Any] = {"va": "top", "fontsize": "small", "fontweight": "bold", "color": style.INK}


def reading(panel: Axes, side: str = "right") -> Any:
    """Return an empty text in an upper corner of a panel, which changes from frame to frame."""
    place: dict[str, Any] = {"transform": panel.transAxes, "ha": side, "fontsize": style.LABEL, "color": style.INK}
    return panel.text(0.99 if side == "right" else 0.01, 0.97, "", **place, **_TEXT)


class FlatView:
    """View of the x-z plane: places (..., 3) m become pixels. `shift` is the x at the zero of the axis, m.

    Args:
        panel: axes to set.
        corners: least and largest places to be in view, (3,) m.
        clearance: pixels above and below these.
    """

    def __init__(self, panel: Axes, corners: Corners, clearance: tuple[float, float]) -> None:
        self._panel, self._corners, self._clearance, self.shift = panel, corners, clearance, 0.0
        panel.set_xlim(corners[0][0], corners[1][0])
        self.note, self.stretch = "", np.ones(3)

    def settle(self) -> None:
        """Set the limits, with one scale for lengths and heights, once the panel has its size."""
        box, (low, high), (above, below) = self._panel.get_window_extent(), self._corners, self._clearance
        wide, tall = high[0] - low[0], max(high[2] - low[2], 1e-9)
        self.scale = min(box.width / wide, max(box.height - above - below, 0.3 * box.height) / tall)
        aside = 0.5 * (box.width / self.scale - wide)
        spare = 0.5 * (box.height - tall * self.scale - above - below)
        self._panel.set_xlim(low[0] - aside, high[0] + aside)
        self._panel.set_ylim(low[2] - (below + spare) / self.scale, high[2] + (above + spare) / self.scale)

    def __call__(self, places: Array) -> Array:
        """Return where places are on the page, (..., 2) px."""
        flat = places[..., [0, 2]] - [self.shift, 0.0]
        return np.asarray(self._panel.transData.transform(flat.reshape(-1, 2))).reshape(flat.shape)

    def away(self, places: Array) -> Array:
        """Return distances from the eye; all the same."""
        return np.zeros(places.shape[:-1])


class SpaceView:
    """View in space: places (..., 3) m become pixels; arguments as of `FlatView`."""

    shift = 0.0

    def __init__(self, panel: Axes, corners: Corners, clearance: tuple[float, float]) -> None:
        self._scene = Scene(panel, np.stack(corners))
        self.note, self.stretch = self._scene.note, self._scene.factor

    def settle(self) -> None:
        """Give the scene its place."""
        self._scene.settle()
        self._matrix, ends = self._scene.axes.get_proj(), np.stack([self._scene.low, self._scene.high])
        sides = np.stack([ends[0], [ends[1][0], *ends[0][1:]]])
        self.scale = float(np.linalg.norm(np.diff(self(sides), axis=0)) / max(ends[1][0] - ends[0][0], 1e-9))

    def _projected(self, places: Array) -> Array:
        flat = np.concatenate([places.reshape(-1, 3), np.ones((places.size // 3, 1))], axis=1) @ self._matrix.T
        return np.asarray(flat[:, :3] / flat[:, 3:])

    def __call__(self, places: Array) -> Array:
        """Return where places are on the page, (..., 2) px."""
        flat = self._scene.axes.transData.transform(self._projected(places)[:, :2])
        return np.asarray(flat).reshape(*places.shape[:-1], 2)

    def away(self, places: Array) -> Array:
        """Return distances from the eye."""
        return self._projected(places)[:, 2].reshape(places.shape[:-1])


def label_heights(panel: Axes, arrays: FilmArrays, units: DisplayUnits) -> None:
    """Label heights of a flat view, or displacements where these alone are seen; else there is no scale."""
    picture = arrays.picture
    if picture.factor == 1.0:
        round_axis(panel.yaxis, units.place.size * picture.height_factor)
        label = f"z ({units.place.symbol})"
    elif arrays.is_level:
        scale = picture.factor * picture.height_factor
        unit = units.of("m", [np.asarray(panel.get_ylim()) / scale])
        round_axis(panel.yaxis, unit.size * scale)
        label = f"displacement ({unit.symbol})"
    else:
        panel.yaxis.set_major_locator(NullLocator())
        label = ""
    panel.set_ylabel(label, fontsize=style.LABEL, color=style.INK)


class Diagram:
    """A quantity along the lines, in a frame and between its extremes of all frames.

    Args:
        panel: empty axes.
        arrays: of the film.
        quantity: one of the diagrams of the picture.
        shade: colours, where the lines are coloured by the quantity.
        units: to show.
        reach: on each side of the middle of a view that moves along, m; else infinite.
    """

    def __init__(
        self, panel: Axes, arrays: FilmArrays, quantity: DrawnQuantity, shade: Any, units: DisplayUnits, reach: float
    ) -> None:
        nodes, self._values = arrays.diagrams[quantity.name], arrays.values[quantity.name]
        self._x = arrays.picture.reference[nodes, 0]
        self._pairs = np.flatnonzero(np.diff(arrays.line_of(nodes)) == 0)
        self._shade, self._reach, self._unit = shade, reach, units.of(quantity.unit, [self._values])
        low, high = np.fmin.reduce(self._values), np.fmax.reduce(self._values)
        for part in np.split(np.arange(len(nodes)), 1 + np.flatnonzero(np.diff(arrays.line_of(nodes)))):
            if reach == np.inf:
                panel.fill_between(self._x[part], low[part], high[part], color=style.GRID, linewidth=0.0)
        self._most = self._largest(np.concatenate([low, high]))
        ends = np.array([min(np.nanmin(low, initial=0.0), 0.0), max(np.nanmax(high, initial=0.0), 0.0)])
        ends += np.array([-0.45, 0.06] if quantity.down else [-0.06, 0.45]) * (np.ptp(ends) or 1.0)  # space for text
        panel.set_ylim(*(ends[::-1] if quantity.down else ends))
        panel.axhline(0.0, color=style.FAINT, linewidth=0.6)
        style.dress(panel, "", "", f"({quantity.unit})")
        panel.text(0.008, 0.95, quantity.label, transform=panel.transAxes, **_NAME)
        self._curve: Any = LineCollection([], linewidths=style.sized(2.4), colors=[style.BLUE], animated=True)
        panel.add_collection(self._curve, autolim=False)
        self._text = reading(panel)
        self.artists = [self._curve, self._text]

    def _largest(self, values: Array) -> str:
        """Return the value of the largest size, as text."""
        kept = values[np.isfinite(values)]
        most = float(kept[np.abs(kept).argmax()]) if kept.size else 0.0
        return f"{number(most / self._unit.size, 3)} {self._unit.symbol}".replace("*", "·")

    def move(self, k: int, shift: float) -> None:
        """Show a frame."""
        points = np.stack([self._x - shift, self._values[k]], axis=1)
        pairs = self._pairs[np.abs(points[self._pairs, 0]) < self._reach]
        self._curve.set_segments(np.stack([points[pairs], points[pairs + 1]], axis=1))
        if self._shade is not None:
            self._curve.set_color(self._shade.to_rgba(self._values[k][pairs]))
        self._text.set_text(f"largest {self._largest(self._values[k])} of {self._most} in the film")


class ForceTrack:
    """The contact forces of pantographs so far, along the line.

    Args:
        panel: empty axes.
        dataset: the whole result, with samples.
        time: (frame,) s, of the frames shown.
        start: x at which stations begin, m.
    """

    def __init__(self, panel: Axes, dataset: xr.Dataset, time: Array, start: float) -> None:
        names = list(contact_statistics(dataset))
        own = [dataset["load"].values.tolist().index(name) for name in names]
        flat = samples(dataset.drop_vars("sampled_tie_force", errors="ignore")).isel(contact=own)
        self._time, self._instant, self._x = time, flat["time"].values, flat["station"].values + start
        raw = np.where(np.isfinite(self._x), flat["force"].values, np.nan)
        self._forces = raw, np.stack([filtered(one, interval_of(flat)) for one in raw.T], axis=1)
        self.artists: list[Any] = []
        for i, name in enumerate(names):
            look: dict[str, Any] = {"color": style.CYCLE[i % len(style.CYCLE)], "animated": True}
            thin = panel.plot([], [], linewidth=style.sized(0.6), alpha=0.45, **look)
            self.artists += [*thin, *panel.plot([], [], linewidth=style.sized(1.8), **look, label=name)]
        seen = raw[np.isfinite(raw)]
        largest = float(np.percentile(seen, 99.5)) if seen.size else 1.0
        panel.set_ylim(-0.03 * largest, 1.35 * largest)
        style.dress(panel, "", "", "(N)")
        panel.text(0.008, 0.96, f"contact force (thick: up to {CUTOFF:g} Hz)", transform=panel.transAxes, **_NAME)
        if len(names) > 1:
            options: dict[str, Any] = {"loc": "upper right", "frameon": False, "fontsize": style.NOTE}
            panel.legend(ncols=3, borderaxespad=0.1, **options)

    def move(self, k: int, shift: float) -> None:
        """Show a frame."""
        so_far = self._instant <= self._time[k] + 1e-9
        for n, curve in enumerate(self.artists):
            curve.set_data(self._x[so_far, n // 2] - shift, self._forces[n % 2][so_far, n // 2])


class Meter:
    """Writes forces of fixed width, so that numbers do not jump.

    Args:
        names: of the loads; without names for one that is alone.
        forces: (frame, load) N, their sizes; NaN off the line.
        units: that they are shown in.
    """

    def __init__(self, names: Sequence[str], forces: Array, units: DisplayUnits | None = None) -> None:
        self._names, self._forces = names[:LISTED], forces[:, :LISTED]
        self._unit = (units or DisplayUnits.read(None)).of("N", [self._forces])
        kept = np.abs(self._forces[np.isfinite(self._forces)])
        largest = float(kept.max(initial=0.0)) / self._unit.size or 1.0
        self._decimals = decimals(largest, 3)
        self._width = len(f"{-largest:.{self._decimals}f}")
        self._longest = max(map(len, self._names), default=0)

    def label(self, k: int) -> str:
        """The forces in the k-th frame shown."""
        lines = []
        for name, force in zip(self._names, self._forces[k] / self._unit.size, strict=True):
            number = f"{force:{self._width}.{self._decimals}f}" if np.isfinite(force) else "–".rjust(self._width)
            lines.append(f"{name:{self._longest}} {number} {self._unit.symbol}")
        return "\n".join(lines)
