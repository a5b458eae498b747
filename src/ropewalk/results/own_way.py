"""What loads that go by themselves have come to, and which of them step."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.contract import path_name
from ropewalk.results.display_units import Column, number
from ropewalk.results.frame import OFF_LINE, Array

if TYPE_CHECKING:
    import xarray as xr

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


def whereabouts(place: dict[str, Any], say: Column) -> Iterator[str]:
    """The rest of a last place in words: where on the line, and how fast."""
    yield f"xi = {number(place['xi'])} m"
    if place["speed"]["value"] is not None:
        yield f"at {say(place['speed']['value'], 'm/s')} along the line"


def _declared(dataset: xr.Dataset, k: int) -> tuple[str, str]:
    """Kinds of the load of contact k and of its travel, also of scenarios with models that no text can make again."""
    return _kinds(str(dataset.attrs.get("scenario", ""))).get(
        str(dataset["load"].values[k]).partition(".")[0], ("", "")
    )


@lru_cache(maxsize=4)
def _kinds(text: str) -> dict[str, tuple[str, str]]:
    try:
        loads = json.loads(text)["loads"]
    except (ValueError, KeyError, TypeError):
        return {}
    travels = {name: load.get("travel") or {} for name, load in loads.items()}
    return {name: (str(load.get("kind", "")), str(travels[name].get("kind", ""))) for name, load in loads.items()}
