"""Stills in three dimensions: lines and nets with their loads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from ropewalk.results import style
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import number
from ropewalk.results.nets import NetTriangles, cell_values, net_names, triangles
from ropewalk.results.scene import LONG, Scene
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
