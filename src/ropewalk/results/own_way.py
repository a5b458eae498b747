"""What loads that go by themselves have come to, and which of them step."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.contract import path_name
from ropewalk.results.declared import declared
from ropewalk.results.display_units import Column, Row
from ropewalk.results.frame import OFF_LINE, Array

if TYPE_CHECKING:
    import xarray as xr

FELT = 1e-3
"""m, by which something must go down to be worth a row."""
STEPPING = ("stepper", "walker", "footsteps")
"""Kinds of loads whose contacts are feet, or what else a model sets down."""
PRESSED = 0.1
"""Part of its largest force with which a foot presses that needs friction: one that is lifted shows what swings."""


def steps(dataset: xr.Dataset, k: int) -> bool:
    """Whether contact k is one that is set down and lifted."""
    return _declared(dataset, k)[0] in STEPPING


def friction_of_steps(friction: Array, force: Array) -> Array:
    """The friction coefficients that a foot needs, NaN where it hardly presses.

    Args:
        friction: (frame,) that it needs at each output instant, 1.
        force: (frame, axis) N, NaN off the line.
    """
    size = np.linalg.norm(force, axis=1)
    largest = np.nanmax(size, initial=0.0) if np.isfinite(size).any() else 0.0
    return np.where(size >= PRESSED * largest, friction, np.nan)


def last_place(dataset: xr.Dataset, k: int) -> dict[str, Any] | None:
    """Where contact k was at the last output instant at which it was on its line, and how fast along it.

    None of loads whose way is prescribed, and of runs that know no time. What stands still, as a foot, has no speed.
    """
    kind, travel = _declared(dataset, k)
    there = np.flatnonzero(dataset["contact_state"][:, k].values != OFF_LINE)
    if (kind not in STEPPING and travel != "free") or path_name(dataset) != "time" or not there.size:
        return None
    last, moved = there[-1], float(dataset["contact_speed"].values[there[-1], k])
    return {
        "value": float(dataset["contact_position"].values[last, k, 0]), "unit": "m",
        "xi": float(dataset["contact_xi"].values[last, k]), "time": float(dataset["time"].values[last]),
        "speed": {"value": moved if moved else None, "unit": "m/s"},
    }  # fmt: skip


def lowest(dataset: xr.Dataset, z: Array, on: Array) -> dict[str, Any] | None:
    """The lowest of the places of a load or its payload at output instants, and how far below the first one it is.

    None where no time is known, and of what goes down by nothing.

    Args:
        z: (frame,) m, how high it is.
        on: whether it is on its line then.
    """
    there = np.flatnonzero(on & np.isfinite(z))
    if path_name(dataset) != "time" or not there.size:
        return None
    at = there[z[there].argmin()]
    down = float(z[there[0]] - z[at])
    if not down > 0.0:
        return None
    return {"value": float(z[at]), "unit": "m", "time": float(dataset["time"].values[at]),
            "below": {"value": down, "unit": "m"}}  # fmt: skip


def lowest_place(dataset: xr.Dataset, k: int) -> dict[str, Any] | None:
    """The same of contact k; None of pantographs, which press from below."""
    if _declared(dataset, k)[0] == "pantograph":
        return None
    on = dataset["contact_state"][:, k].values != OFF_LINE
    return lowest(dataset, dataset["contact_position"].values[:, k, -1], on)


def place_rows(found: dict[str, Any], say: Column) -> Iterator[Row]:
    """Rows of a table: where a load came to, and how far down it or its payload went.

    Args:
        found: its summary.
        say: numbers in words.
    """
    if (place := found.get("last_place")) is not None:
        speed = place["speed"]["value"]
        fast = () if speed is None else (f"at {say(speed, 'm/s')} along the line",)
        where = "  ".join((*say.when(place), f"xi = {say.place(place['xi'])}", *fast))
        yield "last place", f"x = {say.place(place['value'])}", where
    if (place := found["lowest_place"]) is not None and place["below"]["value"] > FELT:
        down = f"{say(place['below']['value'], 'm')} below its start"
        yield "lowest place", f"z = {say.place(place['value'])}", "  ".join((*say.when(place), down))


def _declared(dataset: xr.Dataset, k: int) -> tuple[str, str]:
    """Kinds of the load of contact k and of its travel, also of scenarios with models that no text can make again."""
    load = declared(dataset, "loads").get(str(dataset["load"].values[k]).partition(".")[0], {})
    return str(load.get("kind", "")), str((load.get("travel") or {}).get("kind", ""))
