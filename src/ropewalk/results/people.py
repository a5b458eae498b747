"""What crowds go through, told of each as a whole."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.model.crowd import Crowd
from ropewalk.results.contact_statistics import contacts_by_load

if TYPE_CHECKING:
    import xarray as xr


def crowds_in(dataset: xr.Dataset) -> dict[str, list[int]]:
    """The contacts of each crowd, by its name."""
    return contacts_by_load(dataset, Crowd)


def crowd_summary(dataset: xr.Dataset) -> dict[str, Any]:
    """Of each crowd how many there are, how many at most on the line, and what they press with on it, in all."""
    out = {}
    for name, own in crowds_in(dataset).items():
        pressing = -dataset["contact_force"].values[:, own, -1]
        there = np.isfinite(dataset["contact_xi"].values[:, own])
        people = there.reshape(there.shape[0], -1, 2).any(axis=2).sum(axis=1)
        total = np.where(there, np.nan_to_num(pressing), 0.0).sum(axis=1)
        out[name] = {
            "people": len(own) // 2, "most_on_line": int(people.max(initial=0)),
            "load": {
                "unit": "N", "max": float(total.max(initial=0.0)), "mean": float(total.sum()) / max(total.size, 1),
            },
        }  # fmt: skip
    return out
