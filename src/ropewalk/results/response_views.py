"""Views of what named places of lines go through, and figures of trains that are not drawn axle by axle."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.results import style
from ropewalk.results.line_response import UNITS, histories
from ropewalk.results.trains import crowds_in, trains_in
from ropewalk.results.views import draw_curves, path_label

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
