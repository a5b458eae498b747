"""Figures: an overview of a result and its single views, drawn on Figure objects without pyplot's global state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure

from ropewalk.results import style
from ropewalk.results.contact_figure import contact_figure, is_of_overhead_line
from ropewalk.results.contract import path_name
from ropewalk.results.nets import is_spatial
from ropewalk.results.space_figure import SPACE_VIEWS, space_figure, space_single
from ropewalk.results.views import VIEWS, any_of, headline, shapes, tension_along

if TYPE_CHECKING:
    import xarray as xr


def figure(dataset: xr.Dataset) -> Figure:
    """Draw the overview: shapes, tension, contact, energy and support forces, all axes with units.

    Hold forces give way to contact forces where there are none, the imbalance of the energy to friction where nothing
    moves in time; loads that lose power to friction get a row for that and for their speed. Pantographs have a figure
    of their own; so has what leaves the x-z plane.

    Args:
        dataset: a result; one with a single frame (an equilibrium) gets its shape and its tension.
    """
    frames = dataset.sizes[path_name(dataset)]
    if frames > 1 and is_of_overhead_line(dataset):
        return contact_figure(dataset)
    if frames and is_spatial(dataset):
        return space_figure(dataset)
    if frames < 2:
        return _rest_figure(dataset)
    force = "hold_force" if any_of(dataset, "hold_force") or not any_of(dataset, "contact_force") else "contact_force"
    audit = "imbalance" if path_name(dataset) == "time" else "contact_friction"
    layout: list[Any] = [["shapes", "shapes"], ["tension", "contact_height"], ["energy", force]]
    if any_of(dataset, "friction_power"):
        layout.append(["contact_speed", "friction_power"])
    layout.append([audit, "reactions"])
    rows = len(layout)
    fig = Figure(figsize=(11.0, 2.1 + 2.1 * rows), dpi=style.DPI, layout="constrained")
    ax = fig.subplot_mosaic(layout, height_ratios=(1.35, *(1.0,) * (rows - 2), 0.8))
    headline(fig, dataset)
    for name, panel in ax.items():
        VIEWS[name](dataset, panel)
    below = [ax[name] for row in layout[1:] for name in row]
    for other in below[1:]:
        other.sharex(below[0])
    for upper in below[:-2]:
        upper.set_xlabel("")
        upper.tick_params(labelbottom=False)
    for row in layout[1:]:
        style.lift_titles([ax[name] for name in row])
    for column in range(2):
        fig.align_ylabels([ax[row[column]] for row in layout[1:]])
    return fig


def single(dataset: xr.Dataset, view: str) -> Figure:
    """Draw one of the VIEWS, or of the SPACE_VIEWS, on a figure of its own.

    Raises:
        ValueError: there is no such view.
    """
    if view in SPACE_VIEWS:
        return space_single(dataset, view)
    if view not in VIEWS:
        raise ValueError(f"no view {view!r}; there are {', '.join((*VIEWS, *SPACE_VIEWS))}")
    fig = Figure(figsize=(8.0, 4.5), dpi=style.DPI, layout="constrained")
    VIEWS[view](dataset, fig.add_subplot())
    return fig


def _rest_figure(dataset: xr.Dataset) -> Figure:
    fig = Figure(figsize=(11.0, 6.5), dpi=style.DPI, layout="constrained")
    upper, lower = fig.subplots(2, 1, height_ratios=(1.4, 1.0))
    headline(fig, dataset)
    if dataset.sizes[path_name(dataset)]:
        shapes(dataset, upper)
        tension_along(dataset, lower)
    return fig
