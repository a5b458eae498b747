"""Stills in three dimensions: lines and nets with their loads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.markers import CARETUP

from ropewalk.results import style
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import number
from ropewalk.results.nets import NetTriangles, cell_values, line_ends, net_names, triangles
from ropewalk.results.scene import LONG, Scene, faces, segments
from ropewalk.results.shape_views import CELLS, POINTS, Chosen, bar, instants_bar, paths, shading, word
from ropewalk.results.statistics import lines
from ropewalk.results.ties import tied, ties

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

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
    values, label, name = cell_values(dataset, int(chosen.frames[0])), "tension of the net (N/m)", style.TENSION
    values = mesh.values(values)
    if not np.isfinite(values).any():
        values, label, name = place[mesh.cells, 2].mean(axis=1), "z (m)", style.HEIGHT
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
        shade = shading(pull, style.INSTANTS if net_names(dataset) else style.TENSION)
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
    foot: dict[str, Any] = {"linestyle": "none", "marker": CARETUP, "markersize": style.sized(8), "color": style.INK}
    if ends:
        scene.axes.plot(*chosen.position[0, ends].T, **foot, zorder=4)


def _loads(dataset: xr.Dataset, scene: Scene, chosen: Chosen) -> None:
    """Paths of loads and bodies, and where they are at the instants."""
    for label, path, look in paths(dataset, chosen) if len(chosen.contacts) > 1 else ():
        scene.axes.plot(*path.T, **{**look, "zorder": 6})
        scene.panel.plot([], [], label=label, **look)
    pairs = ties(dataset)
    for frame, colour in zip(chosen.frames, chosen.colours, strict=True):
        contacts, bodies = chosen.contacts[frame], chosen.bodies[frame]
        parts = tied(bodies, contacts, pairs)
        if len(parts):
            scene.axes.add_collection3d(segments(parts, colors=[colour], linewidths=style.THIN, zorder=7))
        dot: dict[str, Any] = {"linestyle": "none", "color": colour, "markeredgecolor": "white", "zorder": 8}
        scene.axes.plot(*contacts.T, marker="o", markersize=style.sized(6), **dot)
        scene.axes.plot(*bodies.T, marker="s", markersize=style.sized(6), **dot)


def is_long(dataset: xr.Dataset) -> bool:
    """Whether a result is much longer than wide."""
    extent = np.nanmax(points := Chosen.of(dataset).points, axis=0) - np.nanmin(points, axis=0)
    return bool(extent[0] > LONG * extent[1])
