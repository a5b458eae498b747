"""Extremes of quantities over the output instants of a result, in the form that summaries have them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.contract import path_name
from ropewalk.results.frame import Array

if TYPE_CHECKING:
    import xarray as xr

Summary = dict[str, Any]


def largest(
    dataset: xr.Dataset, values: Array, unit: str, of: Sequence[str] = (), pick: Callable[..., Any] = np.nanargmax
) -> Summary | None:
    """Return the largest of the finite values, with unit and instant; None where there is none.

    Args:
        dataset: a result.
        values: (frame,) or (frame, which).
        unit: of the values.
        of: names of the second dimension; the result has one of them as `of`.
        pick: gives the number of the value; `np.nanargmin` for the smallest.
    """
    known = np.where(np.isfinite(values), values, np.nan)
    if np.isnan(known).all():
        return None
    at = np.unravel_index(int(pick(known)), known.shape)
    name = path_name(dataset)
    found: Summary = {"value": float(known[at]), "unit": unit, name: float(dataset[name].values[at[0]])}
    return found | ({"of": of[int(at[1])]} if len(of) else {})


def span(values: Array) -> Summary:
    """Return the smallest and the largest of the finite values, None where there is none."""
    kept = values[np.isfinite(values)]
    return {"min": float(kept.min()), "max": float(kept.max())} if kept.size else {"min": None, "max": None}


def vector(dataset: xr.Dataset, force: Array) -> Summary:
    """Return the largest magnitude of a force (frame, axis) N with its instant, and the range of each component."""
    axes = dataset["axis"].values.tolist()
    found = largest(dataset, np.linalg.norm(force, axis=1), "N") or {"value": None, "unit": "N"}
    return found | {"components": {axis: span(force[:, k]) for k, axis in enumerate(axes)}}
