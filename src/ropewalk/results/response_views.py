"""Views of named places of lines and of carriages, and figures of trains that are not drawn axle by axle."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results import style
from ropewalk.results.frame import Array
from ropewalk.results.line_response import UNITS, histories
from ropewalk.results.ropeway import courses
from ropewalk.results.shape_views import colour_of
from ropewalk.results.trains import crowds_in, trains_in
from ropewalk.results.views import Curve, draw_curves, finish_loads, path_label

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_TITLES = {
    "deflection": "Deflection, downward", "acceleration": "Acceleration, filtered",
    "lateral_deflection": "Lateral deflection",
    "lateral_acceleration": "Lateral acceleration, filtered", "moment": "Bending moment", "shear": "Shear",
}  # fmt: skip


def _of_places(dataset: xr.Dataset, ax: Axes, *, quantity: str) -> None:
    """Draw a quantity at all named places."""
    own = [(name.rpartition(".")[0], values) for name, values, _ in histories(dataset) if name.endswith(f".{quantity}")]
    draw_curves(dataset, ax, [(name, values, {}) for name, values in own if np.isfinite(values).any()])
    label = f"{quantity.replace('_', ' ')} ({UNITS[quantity].replace('^2', '²')})"
    style.dress(ax, _TITLES[quantity], path_label(dataset), label)
    style.legend(ax)


VIEWS_OF_PLACES: Mapping[str, Callable[[xr.Dataset, Axes], None]] = {
    quantity: partial(_of_places, quantity=quantity)
    for quantity in _TITLES
}  # fmt: skip


def seen_at_places(dataset: xr.Dataset) -> list[str]:
    """The views in which there is something to see."""
    there = {name.rpartition(".")[2] for name, values, _ in histories(dataset) if np.isfinite(values).any()}
    return [quantity for quantity in VIEWS_OF_PLACES if quantity in there]


def with_first_axles(dataset: xr.Dataset) -> xr.Dataset:
    """The same result with one contact for each crowd and train, which carries the name and the forces of the whole."""
    trains, names = trains_in(dataset), dataset["load"].values.tolist()
    groups = {name: own for name, own in {**trains, **crowds_in(dataset)}.items() if len(own) > 1}
    others = {k for own in groups.values() for k in own[1:]}
    if not others:
        return dataset
    first = {own[0]: name for name, own in groups.items()}
    kept = [k for k in range(len(names)) if k not in others]
    labels = np.array([first.get(k, names[k]) for k in kept], dtype=np.str_)
    bodies = dataset["body"].values.tolist() if "body" in dataset.coords else []
    drawn, seen = list[int](), set[str]()
    for k, body in enumerate(bodies):
        train = body.partition(".")[0]
        if train not in trains or train not in seen:
            drawn.append(k)
        seen.add(train)
    reduced = dataset.isel(contact=kept, body=drawn) if bodies else dataset.isel(contact=kept)
    for name in ("contact_force", "hold_force"):
        force, total = dataset[name].values, reduced[name].values.copy()
        for k, load in first.items():
            own = force[:, groups[load]]
            whole = np.where(np.isfinite(own).any(axis=1), np.nansum(own, axis=1), np.nan)
            total[:, kept.index(k)] = whole
        reduced = reduced.assign({name: (dataset[name].dims, total, dataset[name].attrs)})
    return reduced.assign_coords(load=("contact", labels, dataset["load"].attrs))


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
