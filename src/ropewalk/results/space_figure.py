"""Stills in three dimensions: lines and nets with their loads, and a plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.markers import CARETUP
from numpy.typing import NDArray

from ropewalk.results import style
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import number
from ropewalk.results.drawn import drawn_position
from ropewalk.results.drawn_bodies import drawn_bodies
from ropewalk.results.frame import Array
from ropewalk.results.nets import NetTriangles, cell_values, in_space, line_ends, most_deflected, net_names, triangles
from ropewalk.results.scene import LONG, Scene, faces, segments
from ropewalk.results.statistics import lines
from ropewalk.results.ties import tied, ties
from ropewalk.results.views import POINTS, SHAPES, instants_bar, load_colour, set_scale, word

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

CELLS = 12_000  # most triangles drawn in a still
CROWD = 6  # more lines than these are drawn at one instant
SLIMMEST = 0.05  # slimmer plans than this (width to length) are drawn wider
MESH = 1_500  # with fewer triangles than these their sides are drawn
NET, ROPE, HEIGHT = style.TENSION, style.INSTANTS, "cividis"  # colour maps: tension of nets and lines, height
_PATH: dict[str, Any] = {"linewidth": style.LINE, "linestyle": (0, (1, 1.2))}
_BODY: dict[str, Any] = {"linewidth": style.THIN, "linestyle": (0, (4, 1.5)), "color": style.FAINT}
_SIDE: dict[str, Any] = {"fraction": 0.03, "pad": 0.01, "aspect": 25}


@dataclass(frozen=True)
class Chosen:
    """The instants that are drawn: several of a few lines, that of the largest deflection of nets and many lines."""

    frames: NDArray[np.intp]
    position: Array  # (frame, node, 3) m
    contacts: Array  # (frame of the result, contact, 3) m
    bodies: Array  # (frame of the result, body, 3) m

    @classmethod
    def of(cls, dataset: xr.Dataset, instants: int = SHAPES) -> Chosen:
        """Choose and load them."""
        name = path_name(dataset)
        one = bool(net_names(dataset)) or len(lines(dataset)) > CROWD
        frames = np.array([most_deflected(dataset)]) if one else style.thinned(dataset.sizes[name], instants)
        return cls(
            frames,
            in_space(drawn_position(dataset.isel({name: frames}))),
            in_space(dataset["contact_position"].values),
            in_space(drawn_bodies(dataset)),
        )

    @property
    def points(self) -> Array:
        """All places that must be in view, (point, 3) m."""
        return np.concatenate([part.reshape(-1, 3) for part in (self.position, self.contacts, self.bodies)])

    @property
    def colours(self) -> Any:
        """A colour for each instant, early to late; one alone is dark."""
        if len(self.frames) == 1:
            return [style.INK]
        return style.colours(style.INSTANTS)(np.linspace(0.0, 1.0, len(self.frames)))


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
    _ropes(dataset, scene, chosen)
    _loads(dataset, scene, chosen)
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
    values, label, name = mesh.values(cell_values(dataset, int(chosen.frames[0]))), "tension of the net (N/m)", NET
    if not np.isfinite(values).any():
        values, label, name = place[mesh.cells, 2].mean(axis=1), "z (m)", HEIGHT
    shade = shading(values, name)
    colours = shade.to_rgba(values)
    sides: dict[str, Any] = {"edgecolors": colours, "linewidths": 0.3}  # or else the ground shines through the seams
    if len(mesh.cells) <= MESH:
        sides["edgecolors"] = 0.75 * colours + [0.0, 0.0, 0.0, 0.25]
    scene.axes.add_collection3d(faces(place[mesh.cells], facecolors=colours, zorder=1, **sides))
    scene.axes.add_collection3d(segments(place[mesh.edges], colors=style.INK, linewidths=style.LINE, zorder=2))
    bar(scene.panel, shade, label)


def _ropes(dataset: xr.Dataset, scene: Scene, chosen: Chosen) -> None:
    """Lines at every instant, one alone shaded by tension, and their supports."""
    shade, ends = None, []
    if len(chosen.frames) == 1 and dataset.sizes["link"]:
        pull = dataset["tension"][int(chosen.frames[0])].values
        shade = shading(pull, ROPE if net_names(dataset) else NET)
        bar(scene.panel, shade, "tension of the lines (N)" if net_names(dataset) else "tension (N)")
    for line in lines(dataset):
        nodes = np.flatnonzero(dataset["line"].values == line)
        kept = style.thinned(len(nodes), POINTS)
        for place, colour in zip(chosen.position[:, nodes[kept]], chosen.colours, strict=True):
            if shade is None:
                scene.axes.plot(*place.T, color=colour, linewidth=style.LINE, zorder=3)
            else:
                links = np.flatnonzero(dataset["link_line"].values == line)[kept[:-1]]
                strokes = np.stack((place[:-1], place[1:]), axis=1)
                options: dict[str, Any] = {"linewidths": style.sized(2.5), "capstyle": "round", "zorder": 3}
                scene.axes.add_collection3d(segments(strokes, colors=shade.to_rgba(pull[links]), **options))
        ends += line_ends(dataset, line).tolist()
    foot: dict[str, Any] = {
        "linestyle": "none",
        "marker": CARETUP,
        "markersize": style.sized(8),
        "color": style.INK,
        "zorder": 4,
    }
    if ends:
        scene.axes.plot(*chosen.position[0, ends].T, **foot)


def _loads(dataset: xr.Dataset, scene: Scene, chosen: Chosen) -> None:
    """Paths of loads and bodies, and where they are at the instants."""
    for i, body in enumerate(dataset["body"].values.tolist()):
        _labelled(scene, chosen.bodies[:, i], f"path of {body}", **_BODY, zorder=5)
    for k, load in enumerate(dataset["load"].values.tolist()):
        _labelled(scene, chosen.contacts[:, k], f"path of {load}", **_PATH, color=load_colour(dataset, k), zorder=6)
    pairs = ties(dataset)
    for frame, colour in zip(chosen.frames, chosen.colours, strict=True):
        contacts, bodies = chosen.contacts[frame], chosen.bodies[frame]
        parts = tied(bodies, contacts, pairs)
        if len(parts):
            scene.axes.add_collection3d(segments(parts, colors=[colour], linewidths=style.THIN, zorder=7))
        dot: dict[str, Any] = {"linestyle": "none", "color": colour, "markeredgecolor": "white", "zorder": 8}
        scene.axes.plot(*contacts.T, marker="o", markersize=style.sized(6), **dot)
        scene.axes.plot(*bodies.T, marker="s", markersize=style.sized(6), **dot)


def _labelled(scene: Scene, path: Array, label: str, **options: Any) -> None:
    """A curve of the scene, with its entry in the legend of the panel."""
    if len(path) < 2:
        return
    scene.axes.plot(*path.T, **options)
    scene.panel.plot([], [], label=label, **options)


def plan(dataset: xr.Dataset, ax: Axes) -> None:
    """Draw the same from above: nets shaded by height; widths are exaggerated if all is too slim, as the label says."""
    chosen = Chosen.of(dataset)
    place = chosen.position[0]
    if net_names(dataset):
        mesh = NetTriangles(triangles(dataset), place, CELLS)
        height = place[mesh.cells, 2].mean(axis=1)
        shade = shading(height, HEIGHT)
        options: dict[str, Any] = {"facecolors": height, "cmap": shade.cmap, "norm": shade.norm}
        ax.tripcolor(place[:, 0], place[:, 1], mesh.cells, **options, edgecolors="face", linewidth=0.6, zorder=1)
        bar(ax, shade, "z (m)")
        rim: dict[str, Any] = {"colors": style.INK, "linewidths": style.THIN, "zorder": 2}
        ax.add_collection(LineCollection(list(place[mesh.edges][..., :2]), **rim), autolim=False)
    ends = []
    for line in lines(dataset):
        nodes = np.flatnonzero(dataset["line"].values == line)
        nodes = nodes[style.thinned(len(nodes), POINTS)]
        for shape, colour in zip(chosen.position[:, nodes], chosen.colours, strict=True):
            ax.plot(shape[:, 0], shape[:, 1], color=colour, linewidth=style.LINE, zorder=3)
        ends += line_ends(dataset, line).tolist()
    if ends:
        foot: dict[str, Any] = {
            "linestyle": "none",
            "marker": "s",
            "markersize": style.sized(4),
            "zorder": 4,
            "clip_on": False,
        }
        ax.plot(*place[ends, :2].T, color=style.INK, **foot)
    flat = [*np.moveaxis(chosen.contacts, 1, 0), *np.moveaxis(chosen.bodies, 1, 0)]
    for i in range(chosen.bodies.shape[1]):
        ax.plot(*chosen.bodies[:, i, :2].T, **_BODY, zorder=5)
    for k in range(chosen.contacts.shape[1]):
        ax.plot(*chosen.contacts[:, k, :2].T, **_PATH, color=load_colour(dataset, k), zorder=6)
        there = chosen.contacts[chosen.frames, k]
        ax.scatter(
            there[:, 0],
            there[:, 1],
            c=chosen.colours,
            s=style.sized(style.sized(26)),
            zorder=7,
            edgecolors="white",
            linewidths=0.7,
        )
    factor = set_scale(ax, chosen.position[..., :2], [curve[:, :2] for curve in flat], flattest=SLIMMEST)
    style.dress(ax, "Plan", "x (m)", "y (m)")
    style.remark(ax, "true to scale" if factor == 1.0 else f"drawn {factor:g} times as wide")


def is_long(dataset: xr.Dataset) -> bool:
    """Whether a result is much longer than wide."""
    extent = np.nanmax(points := Chosen.of(dataset).points, axis=0) - np.nanmin(points, axis=0)
    return bool(extent[0] > LONG * extent[1])


def shading(values: Array, name: str) -> ScalarMappable:
    """Colours for values (NaN is light grey), without rare spikes; the bar says where there is more."""
    low, high, beyond = style.colour_range(values)
    colours: Any = style.colours(name).with_extremes(bad="#DDDDDD")
    colours.colorbar_extend = beyond
    return ScalarMappable(Normalize(low, high), colours)


def bar(panel: Axes, shade: ScalarMappable, label: str) -> None:
    """A bar beside a panel that tells the colours."""
    text = panel.figure.colorbar(shade, ax=panel, **_SIDE)
    text.set_label(label, fontsize=style.LABEL, color=style.INK)
    text.ax.tick_params(labelsize=style.TICK, colors=style.INK, width=0.6, length=3)
    text.outline.set_visible(False)
