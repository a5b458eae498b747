"""Views of what carriages of ropeways go through over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results import style
from ropewalk.results.frame import Array
from ropewalk.results.ropeway import courses
from ropewalk.results.shape_views import colour_of
from ropewalk.results.views import Curve, draw_curves, finish_loads, path_label

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_DASHES: tuple[Any, ...] = ("-", (0, (4, 1.5)), (0, (1, 1.2)))


def _curve(label: str, k: int, n: int, values: Array) -> Curve:
    """A curve of a carriage and a quantity, given by their numbers."""
    return label, values, {"color": colour_of(k), "linestyle": _DASHES[n]}


def _named(dataset: xr.Dataset, ax: Axes, wanted: Mapping[str, str]) -> None:
    own = enumerate(courses(dataset).items())
    draw_curves(dataset, ax, [
        _curve(f"{name}, {what}" if what else name, k, n, course[key][0])
        for k, (name, course) in own for n, (key, what) in enumerate(wanted.items())
        if key in course and np.isfinite(course[key][0]).any()
    ])  # fmt: skip


def sway(dataset: xr.Dataset, ax: Axes) -> None:
    """Draw the angles of the hangers of all carriages from the vertical."""
    _named(dataset, ax, {"sway": "", "side_sway": "to the side"})
    style.dress(ax, "Sway along the line", path_label(dataset), "angle (rad)")
    finish_loads(dataset, ax)


def hauling_rope(dataset: xr.Dataset, ax: Axes) -> None:
    """Draw the pull of hauling and counter ropes at all carriages, and at their drives."""
    _named(dataset, ax, {"pull": "hauling rope", "drive_tension": "at the drive", "counter_pull": "counter rope"})
    style.dress(ax, "Hauling rope", path_label(dataset), "pull (N)")
    finish_loads(dataset, ax)


def wheel_load(dataset: xr.Dataset, ax: Axes) -> None:
    """Draw the largest and the least load of a wheel of all carriages."""
    loads = {name: course["wheel_load"][0] for name, course in courses(dataset).items()}
    draw_curves(dataset, ax, [
        _curve(f"{name}, {what}", k, n, pick.reduce(values, axis=1))
        for k, (name, values) in enumerate(loads.items())
        for n, (what, pick) in enumerate((("largest", np.fmax), ("least", np.fmin)))
    ])  # fmt: skip
    style.dress(ax, "Wheel load", path_label(dataset), "across the rope (N)")
    finish_loads(dataset, ax)


VIEWS_OF_CARRIAGES: Mapping[str, Callable[[xr.Dataset, Axes], None]] = {
    "sway": sway, "hauling_rope": hauling_rope, "wheel_load": wheel_load,
}  # fmt: skip


def seen_of_carriages(dataset: xr.Dataset) -> list[str]:
    """The views in which there is something to see."""
    present = {key for course in courses(dataset).values() for key in course}
    return [view for view, key in (("sway", "sway"), ("hauling_rope", "pull"), ("wheel_load", "wheel_load"))
            if key in present]  # fmt: skip
