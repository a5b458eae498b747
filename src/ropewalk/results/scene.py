"""Views in three dimensions: axes with equal scales unless something is flat, and stills of lines and nets on them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from ropewalk.results import style
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import number
from ropewalk.results.frame import Array
from ropewalk.results.nets import SIDEWAYS, NetTriangles, cell_values, net_names, triangles
from ropewalk.results.shape_views import (
    CELLS,
    Chosen,
    add_strokes,
    bar,
    draw_lines,
    draw_loads,
    instants_bar,
    shading,
    word,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

FLATTEST = 0.14  # what is flatter than this (to the largest extent) is drawn exaggerated
THINNEST = 0.05  # least thickness of the box, to its largest extent as drawn
ALIKE = 5.0  # factors across the span that differ by no more than this are made equal
SPACE = 0.04  # free space around everything, in extents as drawn
LONG = 3.0  # a span this many times as long as it is wide is looked at from aside
EYES = {"square": (36.0, -58.0), "long": (20.0, -66.0)}  # degrees: elevation, azimuth
EDGE = 3.0  # points around everything
PAD = 15.0  # points between axes and labels, before `settle`
TICKS = 7  # most ticks of the longest side


class Scene:
    """Three-dimensional axes that stand in the place of a panel, with orthographic view: parallels stay parallel.

    Draw on `axes`, and `settle` it when everything else is on the figure.

    Args:
        panel: empty axes that hold the place; they carry title, legend and colour bars.
        points: (point, 3) m, what must be in view; NaN is left out.
    """

    def __init__(self, panel: Axes, points: Array) -> None:
        self.panel = panel
        panel.set_axis_off()
        points = points[np.isfinite(points).all(axis=1)]
        self.low, self.high, self.factor = _box(points)
        options: dict[str, Any] = {"proj_type": "ortho", "computed_zorder": False}
        figure: Any = panel.get_figure(root=True)
        self.axes: Any = Axes3D(figure, panel.get_position().bounds, **options)
        figure.add_axes(self.axes)
        self.axes.set_in_layout(False)  # it is larger than what is drawn on it, and `settle` gives it its place
        self._dress()

    def _dress(self) -> None:
        ax = self.axes
        drawn = (self.high - self.low) * self.factor
        ax.set(xlim=(self.low[0], self.high[0]), ylim=(self.low[1], self.high[1]), zlim=(self.low[2], self.high[2]))
        ax.set_box_aspect(drawn, zoom=0.6)  # axes cut off what is beyond them: `settle` makes them larger instead
        is_long = drawn[0] > LONG * drawn[1]
        ax.view_init(*EYES["long" if is_long else "square"])
        eye = self._eye()
        seen = drawn * np.sqrt(1.0 - eye**2)  # lengths of the sides on the page
        ax.patch.set_visible(False)
        for k, axis in enumerate((ax.xaxis, ax.yaxis, ax.zaxis)):
            count = max(1, round(TICKS * seen[k] / seen.max()))
            axis.set_major_locator(MaxNLocator(count, steps=[1, 2, 5, 10]))
            if count == 1:  # numbers on so short a side would cover each other
                marks = axis.get_majorticklocs()
                marks = marks[(marks >= self.low[k]) & (marks <= self.high[k])]
                axis.set_ticks(marks[[0, -1]] if len(marks) > 1 else marks)
            axis.set_label_text(f"{'xyz'[k]} (m)", fontsize=style.LABEL, color=style.INK)
            axis.labelpad = 2.5 * PAD if is_long and k == 0 else PAD  # beside a slanting axis it needs more room
            axis.set_pane_color("#F7F7F7")
            axis.line.set(color=style.FAINT, linewidth=0.6)
            axis._axinfo["grid"].update(color=style.GRID, linewidth=0.6)
            axis._axinfo["tick"].update(inward_factor=0.0, outward_factor=0.15)
            ax.tick_params(axis="xyz"[k], labelsize=style.TICK, labelcolor=style.INK, color=style.FAINT, pad=3.0)

    @property
    def note(self) -> str:
        """What is not drawn to scale, in words."""
        names = {axis: f for axis, f in zip("xyz", self.factor.tolist(), strict=True) if f != 1.0}
        if not names:
            return "true to scale"
        if len(set(names.values())) == 1:
            return f"{' and '.join(names)} drawn {next(iter(names.values())):g} times as large"
        return "drawn larger: " + ", ".join(f"{axis} {f:g} times" for axis, f in names.items())

    def settle(self) -> None:
        """Fix the layout of the figure, and make the axes so large that they fill the panel, labels included."""
        figure: Any = self.panel.get_figure(root=True)
        if (engine := figure.get_layout_engine()) is not None:
            engine.execute(figure)
        figure.set_layout_engine("none")
        place = self.panel.get_window_extent().padded(-EDGE * figure.dpi / 72)
        self.axes.set_position(_square(place.x0, place.y0, min(place.width, place.height), figure))
        heavy = [*(ax for ax in figure.axes if ax is not self.axes), *self.axes.collections]
        displayed = [artist for artist in heavy if artist.get_visible()]
        for artist in displayed:  # the labels are all that is measured
            artist.set_visible(False)
        for _ in range(4):  # labels keep their size: the rest grows around them
            figure.draw_without_rendering()
            whole, inner = self.axes.get_window_extent(), self._drawn()
            labels = (axis.get_tightbbox() for axis in (self.axes.xaxis, self.axes.yaxis, self.axes.zaxis))
            seen = Bbox.union([inner, *(label for label in labels if label is not None)])
            over = seen.width - inner.width, seen.height - inner.height
            scale = min((place.width - over[0]) / inner.width, (place.height - over[1]) / inner.height)
            side = whole.width * max(scale, 0.1)
            aside = (np.sum(seen.get_points() - whole.get_points(), axis=0) / 2) * side / whole.width
            x, y = np.sum(place.get_points(), axis=0) / 2 - aside - side / 2
            self.axes.set_position(_square(x, y, side, figure))
        for artist in displayed:
            artist.set_visible(True)

    def _drawn(self) -> Bbox:
        """Bounding box of the drawn box on the page, in pixels."""
        corners = np.array(np.meshgrid(*zip(self.low, self.high, strict=True))).reshape(3, -1)
        across, up, _, scale = self.axes.get_proj() @ np.vstack((corners, np.ones(8)))
        places = self.axes.transData.transform(np.stack((across, up), axis=1) / scale[:, None])
        return Bbox([places.min(axis=0), places.max(axis=0)])

    def _eye(self) -> Array:
        elevation, azimuth = np.radians((self.axes.elev, self.axes.azim))
        flat = np.cos(elevation)
        return np.array([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)])


def _box(points: Array) -> tuple[Array, Array, Array]:
    """Least and largest coordinates of the box to draw, and how many times each side is drawn as large."""
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.ones(3))
    extent = high - low
    largest = float(extent.max()) or 1.0
    factor = np.ones(3)
    for k in range(3):
        if SIDEWAYS * largest < extent[k] < FLATTEST * largest:
            factor[k] = max(style.nice(2 * FLATTEST * largest / extent[k]), 1.0)
    if (factor[1:] > 1.0).all() and factor[1:].max() <= ALIKE * factor[1:].min():
        factor[1:] = factor[1:].min()  # a circle across the span stays a circle
    thin = np.maximum(THINNEST * largest / factor - extent, 0.0) / 2
    space = SPACE * np.maximum(extent, THINNEST * largest / factor)
    return low - thin - space, high + thin + space, factor


def _square(x: float, y: float, side: float, figure: Any) -> tuple[float, float, float, float]:
    """A square in pixels as a position in parts of the figure."""
    width, height = figure.bbox.width, figure.bbox.height
    return x / width, y / height, side / width, side / height


MESH = 1_500  # with fewer triangles than these their sides are drawn


def space(dataset: xr.Dataset, panel: Axes) -> Scene:
    """Draw a few lines at several instants, many lines and nets when they are most deflected, and paths of the loads.

    Nets are shaded by their larger tension per width, or by height if that is nowhere known; lines at one instant by
    their tension. All scales are equal unless something is flat: then the label says how much it is exaggerated.

    Args:
        dataset: a result with at least one frame.
        panel: empty axes, in whose place the scene stands; `settle` it when the figure is full.
    """
    chosen = Chosen.of(dataset)
    scene = Scene(panel, chosen.points)
    if net_names(dataset):
        _nets(dataset, scene, chosen)
    shade = None
    if len(chosen.frames) == 1 and dataset.sizes["link"]:
        has_nets = bool(net_names(dataset))
        pull = dataset["tension"][int(chosen.frames[0])].values
        shade = shading(pull, style.INSTANTS if has_nets else style.TENSION)
        bar(panel, shade, "tension of the lines (N)" if has_nets else "tension (N)")
    draw_lines(dataset, scene.axes, chosen, [0, 1, 2], shade)
    draw_loads(dataset, scene.axes, panel, chosen, [0, 1, 2])
    values, unit = dataset[path_name(dataset)].values[chosen.frames], dataset[path_name(dataset)].attrs["units"]
    title = "Shapes"
    if len(values) == 1:
        title = f"Shape at {word(dataset)} {number(float(values[0]))} {unit}"
        title += ", the most deflected" if dataset.sizes[path_name(dataset)] > 1 else ""
    style.dress(panel, title)
    style.remark(panel, scene.note)
    if len(chosen.frames) > 1:
        instants_bar(panel, values, f"{word(dataset)} ({unit})")
    style.legend(panel)
    return scene


def _nets(dataset: xr.Dataset, scene: Scene, chosen: Chosen) -> None:
    place = chosen.position[0]
    mesh = NetTriangles(triangles(dataset), place, CELLS)
    values, label, name = cell_values(dataset, int(chosen.frames[0])), "tension of the net (N/m)", style.TENSION
    values = mesh.values(values)
    if not np.isfinite(values).any():
        values, label, name = place[mesh.cells, 2].mean(axis=1), "z (m)", style.HEIGHT
    shade = shading(values, name)
    colours = shade.to_rgba(values)
    sides: dict[str, Any] = {"edgecolors": colours, "linewidths": 0.3}  # or else the ground shines through the seams
    if len(mesh.cells) <= MESH:
        sides["edgecolors"] = 0.75 * colours + [0.0, 0.0, 0.0, 0.25]
    scene.axes.add_collection3d(Poly3DCollection(place[mesh.cells], facecolors=colours, zorder=1, **sides))
    add_strokes(scene.axes, place[mesh.edges], colors=style.INK, linewidths=style.LINE, zorder=2)
    bar(scene.panel, shade, label)


def is_long(dataset: xr.Dataset) -> bool:
    """Whether a result is much longer than wide."""
    extent = np.nanmax(points := Chosen.of(dataset).points, axis=0) - np.nanmin(points, axis=0)
    return bool(extent[0] > LONG * extent[1])
