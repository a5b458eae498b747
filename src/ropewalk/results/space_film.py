"""Pictures for the film of a result in space: nets and lines shaded by tension, loads as arrows with their paths."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.markers import CARETUP
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from ropewalk.results import style
from ropewalk.results.axis_units import show_units
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import DisplayUnits
from ropewalk.results.drawn import drawn_position
from ropewalk.results.drawn_bodies import drawn_bodies
from ropewalk.results.frame import Array
from ropewalk.results.meter import Meter
from ropewalk.results.nets import NetTriangles, cell_values, in_space, line_ends, triangles
from ropewalk.results.scene import LONG, Scene, faces, segments
from ropewalk.results.space_figure import HEIGHT, NET, ROPE, bar, shading
from ropewalk.results.statistics import lines
from ropewalk.results.ties import tied, ties

if TYPE_CHECKING:
    import xarray as xr

Image = NDArray[np.uint8]

WIDTH, TALL, LOW = 960, 660, 540  # pixels; LOW for what is long
CELLS = 4_000  # most triangles drawn
LINKS = 1_500  # most links drawn of one line
SAMPLED = 25  # frames from which the ranges of colours are taken
MESH = 1_500  # with fewer triangles than these their sides are drawn


class SpaceStage:
    """The picture, laid out once; for each frame only what moves is drawn again. It has the interface of `Stage`.

    Frames are read one by one, so that a film of a large net needs little memory.

    Args:
        dataset: a result.
        frames: those to show, by number.
        timing: the scale of time, in words.
        pixels: width and height, if they are given.
        units: that forces and tensions are shown in.
    """

    def __init__(
        self,
        dataset: xr.Dataset,
        frames: NDArray[np.intp],
        timing: str,
        pixels: tuple[int, int] | None = None,
        units: DisplayUnits | None = None,
    ) -> None:
        self._dataset, self._frames = dataset, frames
        name = path_name(dataset)
        self._path: Array = dataset[name].values[frames]
        self._clock_text = f"{name.replace('_', ' ')} {{:.{style.digits(self._path)}f}} {dataset[name].attrs['units']}"
        self._spots = in_space(dataset["contact_position"].values[frames])
        self._forces = in_space(dataset["contact_force"].values[frames])
        self._bodies = in_space(drawn_bodies(dataset.isel({path_name(dataset): frames})))
        size = np.linalg.norm(self._forces, axis=2)
        self._unit = float(np.nanmax(size, initial=0.0)) or 1.0
        self._meter = Meter(dataset["load"].values.tolist(), size, units)
        self._pairs = ties(dataset)
        self._mesh = NetTriangles(triangles(dataset), self._place(0), CELLS)
        self._links = self._strokes()
        points = self._reach()
        extent = np.nanmax(points, axis=0) - np.nanmin(points, axis=0)
        width, height = pixels or (WIDTH, LOW if extent[0] > LONG * extent[1] else TALL)
        self._figure = Figure(figsize=(width / 100, height / 100), dpi=100, layout="constrained")
        self._canvas = _canvas(self._figure)
        self._scene = Scene(self._figure.add_subplot(), points)
        self._artists: list[Any] = []
        self._set_up(timing)
        show_units(self._figure, units or DisplayUnits.read(None))
        self._scene.settle()
        self._canvas.draw()  # the ground that all pictures share
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
            if hasattr(artist, "do_3d_projection"):
                artist.do_3d_projection()
            self._scene.axes.draw_artist(artist)
        return np.asarray(self._canvas.buffer_rgba())[:, :, :3].copy()

    def _place(self, k: int) -> Array:
        """Nodes in the k-th frame shown, (node, 3) m."""
        return in_space(drawn_position(self._dataset.isel({path_name(self._dataset): [int(self._frames[k])]}))[0])

    def _pull(self, k: int) -> Array:
        """Tensions of the links drawn in the k-th frame shown, N."""
        return np.asarray(self._dataset["tension"][int(self._frames[k])].values[self._links[2]])

    def _shades(self, k: int) -> Array:
        """What the triangles are shaded by in the k-th frame shown: tension per width, or height."""
        if not self._is_tense:
            return np.asarray(self._place(k)[self._mesh.cells, 2].mean(axis=1))
        return self._mesh.values(cell_values(self._dataset, int(self._frames[k])))

    def _strokes(self) -> NDArray[np.intp]:
        """Nodes at both ends of every link drawn and the link that gives its colour, (3, stroke)."""
        found = [np.empty((3, 0), dtype=np.intp)]
        for line in lines(self._dataset):
            nodes = np.flatnonzero(self._dataset["line"].values == line)
            links = np.flatnonzero(self._dataset["link_line"].values == line)
            kept = style.thinned(len(nodes), LINKS + 1)
            found.append(np.stack((nodes[kept[:-1]], nodes[kept[1:]], links[kept[:-1]])))
        return np.concatenate(found, axis=1)

    def _reach(self) -> Array:
        """Corners of what must be in view: everything in all frames shown, (point, 3) m."""
        extremes = [self._spots.reshape(-1, 3), self._bodies.reshape(-1, 3)]
        for k in range(len(self)):
            place = self._place(k)
            extremes.append(np.stack((np.nanmin(place, axis=0), np.nanmax(place, axis=0))))
        return np.concatenate(extremes)

    def _set_up(self, timing: str) -> None:
        scene = self._scene
        moving: dict[str, Any] = {"animated": True}
        sample = style.thinned(len(self), SAMPLED)
        if len(self._mesh.cells):
            self._is_tense = bool(np.isfinite(cell_values(self._dataset, int(self._frames[-1]))).any())
            values = np.concatenate([self._shades(int(k)) for k in sample])
            self._net_shade = shading(values, NET if self._is_tense else HEIGHT)
            corners = self._place(0)
            options: dict[str, Any] = {
                "facecolors": "white",
                "edgecolors": "white",
                "linewidths": style.sized(0.3),
                **moving,
            }
            self._net = scene.axes.add_collection3d(faces(corners[self._mesh.cells], **options))
            rim: dict[str, Any] = {"colors": style.INK, "linewidths": style.LINE, **moving}
            self._rim = scene.axes.add_collection3d(segments(corners[self._mesh.edges], **rim))
            bar(scene.panel, self._net_shade, "tension of the net (N/m)" if self._is_tense else "z (m)")
            self._artists += [self._net, self._rim]
        if self._links.size:
            both = bool(len(self._mesh.cells))
            self._rope_shade = shading(np.concatenate([self._pull(int(k)) for k in sample]), ROPE if both else NET)
            bar(scene.panel, self._rope_shade, "tension of the lines (N)" if both else "tension (N)")
            thick: dict[str, Any] = {"linewidths": style.sized(3.0), "capstyle": "round", **moving}
            self._ropes = scene.axes.add_collection3d(segments(np.zeros((1, 2, 3)), **thick))
            self._artists.append(self._ropes)
            self._feet()
        self._set_loads(moving)
        self._clock = scene.panel.text(
            0.985, 0.985, "", ha="right", va="top", transform=scene.panel.transAxes, family="monospace",
            fontsize=style.LABEL, color=style.INK, **moving,
        )  # fmt: skip
        self._artists.append(self._clock)
        style.dress(scene.panel, str(self._dataset.attrs.get("title", "")))
        style.remark(scene.panel, f"{timing}; {scene.note}")

    def _feet(self) -> None:
        """Supports that stand still."""
        ends = [node for line in lines(self._dataset) for node in line_ends(self._dataset, line).tolist()]
        way = self._dataset["position"].isel(node=ends).values
        still = np.ptp(way, axis=0).max(axis=-1, initial=0.0) <= 1e-9 * np.ptp(self._scene.high - self._scene.low)
        foot: dict[str, Any] = {
            "linestyle": "none",
            "marker": CARETUP,
            "markersize": style.sized(9),
            "color": style.INK,
        }
        if still.any():
            self._scene.axes.plot(*in_space(way[0][still]).T, **foot)

    def _set_loads(self, moving: dict[str, Any]) -> None:
        axes, none = self._scene.axes, np.zeros((1, 2, 3))
        dashed: dict[str, Any] = {"color": style.INK, "linewidth": style.THIN, "linestyle": (0, (1, 1.2)), **moving}
        dashed["path_effects"] = [withStroke(linewidth=2.5, foreground="white")]  # nets may be as dark as the path
        halo: dict[str, Any] = {"path_effects": [withStroke(linewidth=4.0, foreground="white")], **moving}
        self._traces = [axes.plot([], [], [], **dashed)[0] for _ in range(self._spots.shape[1])]
        self._arrows = axes.add_collection3d(segments(none, colors=style.INK, linewidths=style.sized(2.0), **halo))
        self._ties = axes.add_collection3d(segments(none, colors=style.BLUE, linewidths=style.LINE, **moving))
        dot: dict[str, Any] = {"linestyle": "none", "markeredgecolor": "white", **moving}
        (self._dots,) = axes.plot([], [], [], color=style.INK, marker="o", markersize=style.sized(7), **dot)
        (self._masses,) = axes.plot([], [], [], color=style.BLUE, marker="s", markersize=style.sized(8), **dot)
        self._artists += [*self._traces, self._arrows, self._ties, self._dots, self._masses]

    def _move(self, k: int) -> None:
        place = self._place(k)
        if len(self._mesh.cells):
            colours = self._net_shade.to_rgba(self._shades(k))
            self._net.set_verts(place[self._mesh.cells])
            self._net.set_facecolor(colours)
            drawn = len(self._mesh.cells) <= MESH
            self._net.set_edgecolor(0.75 * colours + [0.0, 0.0, 0.0, 0.25] if drawn else colours)
            self._rim.set_segments(place[self._mesh.edges])
        if self._links.size:
            self._ropes.set_segments(np.stack((place[self._links[0]], place[self._links[1]]), axis=1))
            self._ropes.set_color(self._rope_shade.to_rgba(self._pull(k)))
        for j, trace in enumerate(self._traces):
            trace.set_data_3d(*self._spots[: k + 1, j].T)
        spots, bodies = self._spots[k], self._bodies[k]
        there = np.isfinite(spots).all(axis=1) & np.isfinite(self._forces[k]).all(axis=1)
        self._arrows.set_segments(self._scene.arrows(spots[there], self._forces[k][there], self._unit))
        self._ties.set_segments(tied(bodies, spots, self._pairs))
        self._dots.set_data_3d(*spots.T)
        self._masses.set_data_3d(*bodies.T)
        self._clock.set_text("\n".join((self._clock_text.format(self._path[k]), self._meter.label(k))).strip())


def _canvas(figure: Figure) -> Any:
    return FigureCanvasAgg(figure)  # its methods carry no types
