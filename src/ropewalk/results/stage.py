"""Pictures of a film: the description of a frame, drawn in pixels over a ground that all frames share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.markers import CARETUP
from matplotlib.transforms import IdentityTransform
from numpy.typing import NDArray

from ropewalk.results import style
from ropewalk.results.axis_units import show_units
from ropewalk.results.contact_figure import is_of_overhead_line
from ropewalk.results.contact_statistics import line_statistics
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import DisplayUnits
from ropewalk.results.film_panels import (
    MARGIN,
    Diagram,
    FilmArrays,
    FlatView,
    ForceTrack,
    Meter,
    SpaceView,
    label_heights,
    reading,
)
from ropewalk.results.film_symbols import SPACE, Brush, draw_symbol
from ropewalk.results.frame import Array
from ropewalk.results.nets import in_space
from ropewalk.results.picture import AROUND
from ropewalk.results.scene import LONG, MESH
from ropewalk.results.shape_views import bar, shading
from ropewalk.results.tempo import Tempo

if TYPE_CHECKING:
    import xarray as xr

Image = NDArray[np.uint8]

WIDTH, DPI = 960, 100  # pixels, pixels per inch
LEAST, MOST = 240, 520  # pixels: height of the view of a structure
SPATIAL = (560, 460)  # pixels: the same in space, and where it is long
DIAGRAM, FORCES, REST = 105, 150, 70  # pixels: of a diagram, of contact forces, of titles and labels
ARROW = 60.0  # pixels, of the largest force
ASIDE = 0.18  # of the length of a bridge: ground at both ends
TEXT_LINES = 3  # forces for which there is space above the lines
TRACED = 3  # loads whose paths are drawn
TRACES = ("force", "mass", "person", "trolley")  # kinds of symbols with paths
SLACK = 0.0  # N


class Stage:
    """The picture, laid out once; for each frame only what moves is drawn again.

    Args:
        dataset: a result.
        timing: the frames to show.
        pixels: width and height, if they are given.
        units: that numbers are shown in.
    """

    def __init__(
        self,
        dataset: xr.Dataset,
        timing: Tempo,
        pixels: tuple[int, int] | None = None,
        units: DisplayUnits | None = None,
    ) -> None:
        name, self._units = path_name(dataset), units or DisplayUnits.read(None)
        displayed = dataset.isel({name: timing.frames})
        self._path: Array = displayed[name].values
        self._arrays, self._displayed = FilmArrays(displayed), displayed
        self._ends = self._arrays.drawn(self._arrays.strokes[:2]).T
        self._follows = is_of_overhead_line(dataset)
        self._set_forces()
        self._clock_text = f"{name.replace('_', ' ')} {{:.{style.digits(self._path)}f}} {dataset[name].attrs['units']}"
        self._centre = self._followed()
        self._set_up(dataset, timing, pixels)
        self._ground = self._canvas.copy_from_bbox(self._figure.bbox)

    def __len__(self) -> int:
        return len(self._path)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        width, height = self._canvas.get_width_height()
        return width, height

    def picture(self, k: int) -> Image:
        """Draw the k-th frame shown, an array (height, width, 3)."""
        self._canvas.restore_region(self._ground)
        self._move(k)
        for artist in self._artists:
            artist.axes.draw_artist(artist)
        return np.asarray(self._canvas.buffer_rgba())[:, :, :3].copy()

    # -- Layout ------------------------------------------------------------------------------------------------------

    def _set_forces(self) -> None:
        """Forces of contacts as arrows, and of whole loads as numbers."""
        self._forces: Array = self._displayed["contact_force"].values
        loads = [contact.partition(".")[0] for contact in self._displayed["load"].values.tolist()]
        names, sizes = list(dict.fromkeys(loads)), [np.zeros((len(self), 0))]
        for name in names:
            own = self._forces[:, [load == name for load in loads]]
            size = np.linalg.norm(np.nansum(own, axis=1), axis=1)
            sizes.append(np.where(np.isfinite(own).any(axis=(1, 2)), size, np.nan)[:, None])
        self._meter = Meter(names, np.concatenate(sizes, axis=1), self._units)
        self._largest = float(np.nanmax(np.linalg.norm(self._forces, axis=2), initial=0.0)) or 1.0

    def _followed(self) -> Array:
        """Return x at the middle of the view in every frame, m: zero unless it follows pantographs."""
        self._half = AROUND
        if not self._follows:
            return np.zeros(len(self))
        own = [k for symbol in self._arrays.picture.symbols if symbol.kind == "pantograph" for k in symbol.contacts]
        x = self._arrays.contacts[:, own, 0]
        there = np.flatnonzero(np.isfinite(x).any(axis=1))
        if not there.size:
            return np.zeros(len(self))
        first, last = np.nanmin(x[there], axis=1), np.nanmax(x[there], axis=1)
        self._half += 0.5 * float(np.max(last - first))
        return np.asarray(np.interp(np.arange(len(self)), there, 0.5 * (first + last)))

    def _corners(self) -> tuple[Array, Array]:
        """Return the least and the largest places to be in view."""
        arrays, moving = self._arrays, [np.zeros((0, 3))]
        for symbol in arrays.picture.symbols:
            if symbol.kind not in ("coach", "vehicle", "pantograph"):
                moving += [arrays.contacts[:, symbol.contacts].reshape(-1, 3), *arrays.at(symbol, 0)]
                moving.append(arrays.bodies[:, symbol.bodies].reshape(-1, 3))
        points = np.concatenate([arrays.nodes.reshape(-1, 3), *moving])
        points = points[np.isfinite(points).all(axis=1)]
        low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.ones(3))
        aside = np.array([(ASIDE if arrays.has_trains else MARGIN) * float(np.ptp([low[0], high[0]]) or 1.0), 0.0, 0.0])
        if self._follows:
            low[0], high[0], aside[0] = -self._half, self._half, 0.0
        return (low, high) if arrays.picture.is_spatial and not self._follows else (low - aside, high + aside)

    def _clearance(self) -> tuple[float, float]:
        """Return the pixels that symbols need above and below everything."""
        kinds = {symbol.kind for symbol in self._arrays.picture.symbols}
        above, below = zip(*(SPACE.get(kind, (14, 14)) for kind in kinds or {"place"}), strict=True)
        lines = 1 + min(len(self._meter.label(0).splitlines()), TEXT_LINES)
        return style.sized(max(*above, 12 + 17 * lines)), style.sized(max(below))

    def _set_up(self, dataset: xr.Dataset, timing: Tempo, pixels: tuple[int, int] | None) -> None:
        picture, corners = self._arrays.picture, self._corners()
        spatial, extent = picture.is_spatial and not self._follows, corners[1] - corners[0]
        above, below = self._clearance()
        tall = np.clip(0.85 * WIDTH * extent[2] / max(extent[0], 1e-9) + above + below, LEAST, MOST)
        if spatial:
            tall = SPATIAL[int(extent[0] > LONG * extent[1])]
        rows = [float(tall), *([] if spatial else [DIAGRAM] * len(picture.diagrams)), *([FORCES] * self._follows)]
        width, height = pixels or (WIDTH, int(sum(rows) + REST) // 2 * 2)  # video wants even numbers
        self._figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, layout="constrained")
        self._canvas: Any = FigureCanvasAgg(self._figure)
        panels = self._figure.subplots(len(rows), 1, height_ratios=rows, squeeze=False, sharex=not spatial)[:, 0]
        self._panel = panels[0]
        self._view = (SpaceView if spatial else FlatView)(self._panel, corners, (above, below))
        self._set_colours()
        self._tracks: list[Diagram | ForceTrack] = [
            Diagram(panel, self._arrays, quantity, self._rope_shade if quantity is picture.diagrams[0] else None,
                    self._units, 1.1 * self._half if self._follows else np.inf)
            for panel, quantity in zip(panels[1:], picture.diagrams if not spatial else (), strict=False)
        ]  # fmt: skip
        if self._follows:
            self._tracks.append(ForceTrack(panels[-1], dataset, self._path, self._start()))
        self._set_artists(panels)
        self._label(timing, panels, spatial)

    def _label(self, timing: Tempo, panels: Any, spatial: bool) -> None:
        picture = self._arrays.picture
        drawn = [timing.label, self._view.note]
        drawn += [f"heights drawn {picture.height_factor:g} times as large"] * (picture.height_factor != 1.0)
        drawn += [f"displacements drawn {picture.factor:g} times as large"] * (picture.factor != 1.0)
        style.dress(self._panel, str(self._displayed.attrs.get("title", "")))
        style.remark(self._panel, "; ".join(filter(None, drawn)))
        if not spatial:
            middle = "pantograph" if self._half == AROUND else "middle of the pantographs"
            along = f"distance from the {middle} (m)" if self._follows else "x (m)"
            panels[-1].set_xlabel(along, fontsize=style.LABEL, color=style.INK)
            for panel in panels[:-1]:
                panel.tick_params(labelbottom=False)
            self._figure.align_ylabels(panels)
        show_units(self._figure, self._units)
        for _ in range(2):  # labels of heights change the layout
            self._figure.draw_without_rendering()
            style.settle([[self._panel]])
            self._view.settle()
            if not spatial:
                label_heights(self._panel, self._arrays, self._units)
        self._figure.set_layout_engine("none")
        self._draw_ground(spatial)
        self._canvas.draw()  # the ground that all pictures share

    def _set_colours(self) -> None:
        """Colours of nets and lines, with bars where no diagram shows the same."""
        arrays, colour = self._arrays, self._arrays.picture.colour
        self._net_shade = self._rope_shade = None
        if len(arrays.cells):
            self._is_tense = bool(np.isfinite(arrays.shades).any())
            shades = arrays.shades if self._is_tense else self._heights(slice(None))
            self._net_shade = shading(shades, style.TENSION if self._is_tense else style.HEIGHT)
            bar(self._panel, self._net_shade, "tension of the net (N/m)" if self._is_tense else "z (m)")
        if colour is not None and np.isfinite(arrays.colours).any():
            is_tension = colour.of == "link" and not len(arrays.cells)
            self._rope_shade = shading(arrays.colours, style.TENSION if is_tension else style.INSTANTS)
            if not (arrays.picture.diagrams and arrays.picture.diagrams[0].name == colour.name):
                lines = " of the lines" if len(arrays.cells) else ""
                bar(self._panel, self._rope_shade, f"{colour.label}{lines} ({colour.unit})")

    def _heights(self, k: Any) -> Array:
        """Return the heights of the triangles of nets, m."""
        return np.asarray(self._arrays.nodes[k][..., self._arrays.cells, 2].mean(axis=-1))

    def _set_artists(self, panels: Any) -> None:
        """Everything that moves: in pixels on the view, those behind first."""
        page: dict[str, Any] = {"transform": IdentityTransform(), "animated": True}

        def added(artist: Any) -> Any:
            self._panel.add_collection(artist, autolim=False)
            if isinstance(self._view, FlatView):
                artist.set_clip_path(self._panel.patch)
            return artist

        ink = style.INK
        self._net = added(PolyCollection([], linewidths=style.sized(0.3), **page))
        self._rim = added(LineCollection([], colors=[ink], linewidths=style.LINE, **page))
        self._halo = added(LineCollection([], colors=["white"], linewidths=style.sized(2.4), alpha=0.7, **page))
        dotted: dict[str, Any] = {"colors": [ink], "linewidths": style.THIN, "linestyles": [(0, (1, 1.2))]}
        self._traces = added(LineCollection([], **dotted, **page))
        self._droppers = added(LineCollection([], linewidths=style.sized(1.2), **page))
        self._ropes = added(LineCollection([], linewidths=style.sized(3.0), capstyle="round", colors=[ink], **page))
        self._strokes = added(LineCollection([], capstyle="round", joinstyle="round", **page))
        self._shapes = added(PolyCollection([], edgecolors="white", linewidths=style.sized(0.7), **page))
        self._clock = reading(self._panel, self._free_side())
        self._artists: list[Any] = [self._net, self._rim, self._halo, self._traces, self._droppers, self._ropes,
                                    self._strokes, self._shapes, self._clock]  # fmt: skip
        self._posts = list[Any]()
        if self._follows:
            self._set_posts(panels)
        self._artists = [*self._posts, *self._artists, *(artist for track in self._tracks for artist in track.artists)]

    def _set_posts(self, panels: Any) -> None:
        """Dashed lines at the supports of an overhead line, through all panels."""
        stations = sorted(support.station for line in line_statistics(self._displayed, ties=False).values()
                          for support in line.supports.values())  # fmt: skip
        self._supports = np.array(stations) + self._start()
        look: dict[str, Any] = {"colors": [style.FAINT], "linewidths": 1.0, "linestyles": [(0, (2, 2))]}
        for panel in panels:
            posts = LineCollection([], transform=panel.get_xaxis_transform(), animated=True, **look)
            self._posts.append(panel.add_collection(posts, autolim=False))

    def _free_side(self) -> str:
        """Return the side at which there is more space above the lines."""
        if self._arrays.picture.is_spatial or not len(self._arrays.ends):
            return "right"
        ends = self._arrays.nodes[0, self._arrays.ends]
        left, right = ends[ends[:, 0].argmin(), 2], ends[ends[:, 0].argmax(), 2]
        return "left" if right > left + 0.1 * np.ptp(self._arrays.nodes[0, :, 0]) else "right"

    def _start(self) -> float:
        """Return x at which the stations of an overhead line begin, m."""
        wires = self._displayed["line"].values.tolist()
        first = next(k for k, wire in enumerate(wires) if str(wire).endswith(".contact"))
        return float(self._arrays.picture.reference[first, 0])

    def _draw_ground(self, spatial: bool) -> None:
        """Draw supports, and the ground that trains come from."""
        ends = self._view(self._arrays.nodes[0, self._arrays.ends])
        foot: dict[str, Any] = {"linestyle": "none", "marker": CARETUP, "markersize": style.sized(9)}
        if len(ends) and not self._follows:
            self._panel.plot(*ends.T, color=style.INK, transform=IdentityTransform(), clip_on=False, **foot)
        if len(ends) and self._arrays.has_trains and not spatial:
            box = self._panel.get_window_extent()
            for end, edge in ((ends[ends[:, 0].argmin()], box.x0), (ends[ends[:, 0].argmax()], box.x1)):
                look: dict[str, Any] = {"color": style.FAINT, "linewidth": style.sized(3.0), "zorder": 1}
                self._panel.plot([end[0], edge], [end[1]] * 2, transform=IdentityTransform(), **look)

    # -- Frames ------------------------------------------------------------------------------------------------------

    def _move(self, k: int) -> None:
        arrays, shift = self._arrays, float(self._centre[k])
        self._view.shift = shift
        place = arrays.nodes[k]
        page = self._view(place)
        if len(arrays.cells):
            self._move_net(k, place, page)
        ends = page[self._ends]
        seen = (ends[..., 0].max(axis=1) > 0.0) & (ends[..., 0].min(axis=1) < self._figure.bbox.width)
        self._ropes.set_segments(ends[seen])
        if self._rope_shade is not None:
            values = arrays.colours[k][seen]
            colours = self._rope_shade.to_rgba(values)
            colours[~np.isfinite(values)] = to_rgba(style.INK)
            self._ropes.set_color(colours)
        self._move_loads(k)
        self._move_droppers(k, page)
        for track in self._tracks:
            track.move(k, shift)
        for posts in self._posts:
            posts.set_segments([[(x, 0.0), (x, 1.0)] for x in self._supports - shift if abs(x) < self._half])
        self._clock.set_text("\n".join((self._clock_text.format(self._path[k]), self._meter.label(k))).strip())

    def _move_net(self, k: int, place: Array, page: Array) -> None:
        arrays = self._arrays
        order = np.argsort(-self._view.away(place[arrays.cells]).mean(axis=1))  # those behind first
        values = arrays.shades[k] if self._is_tense else self._heights(k)
        assert self._net_shade is not None
        colours = self._net_shade.to_rgba(values[order])
        self._net.set_verts(page[arrays.cells[order]])
        self._net.set_facecolor(colours)
        self._net.set_edgecolor(0.75 * colours + [0.0, 0.0, 0.0, 0.25] if len(order) <= MESH else colours)
        self._rim.set_segments(page[arrays.edges])

    def _move_droppers(self, k: int, page: Array) -> None:
        droppers = [symbol for symbol in self._arrays.picture.symbols if symbol.kind == "dropper"]
        if droppers:
            names = self._displayed["tie"].values.tolist()
            pull = self._displayed["tie_force"][k].values[[names.index(symbol.name) for symbol in droppers]]
            self._droppers.set_segments(page[self._arrays.drawn(np.array([symbol.nodes for symbol in droppers]))])
            self._droppers.set_color([style.RED if force <= SLACK else style.GREEN for force in pull])

    def _move_loads(self, k: int) -> None:
        """Symbols, forces and paths of loads."""
        arrays, brush, paths = self._arrays, Brush(self._view.scale, style.sized(1.0)), list[Array]()
        for symbol in arrays.picture.symbols:
            places, others = arrays.at(symbol, k)
            draw_symbol(brush, symbol, self._view(places), self._view(others))
            if symbol.kind in TRACES and len(paths) < TRACED:
                so_far = arrays.contacts[: k + 1, symbol.contacts]
                paths += [self._view(so_far[:, i]) for i in range(so_far.shape[1])]
            for contact in symbol.contacts if symbol.kind in ("force", "mass") else ():
                brush.arrow(self._view(arrays.contacts[k, contact]), self._way(k, contact))
        self._halo.set_segments(paths)
        self._traces.set_segments(paths)
        self._shapes.set_verts(brush.polygons)
        self._shapes.set_facecolor(brush.faces)
        self._strokes.set_segments(brush.strokes)
        self._strokes.set_color(brush.inks)
        self._strokes.set_linewidth(brush.widths or [1.0])

    def _way(self, k: int, contact: int) -> Array:
        """Return the arrow of a contact force, (2,) px."""
        force = self._forces[k, contact]
        size = float(np.linalg.norm(force))
        if not size > 0.0:
            return np.zeros(2)
        start, end = self._view(np.stack([np.zeros(3), in_space(force) / size / self._view.stretch]))
        way = end - start
        return np.asarray(way / max(np.linalg.norm(way), 1e-9) * style.sized(ARROW) * size / self._largest)
