"""Places at which bodies are drawn: those of vehicles above their wheels.

Springs of vehicles have no length of their own, so in results a body is below its wheels by their compression. Drawn
so, a train would hang below its bridge.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ropewalk.results.declared import declared
from ropewalk.results.frame import OFF_LINE, Array
from ropewalk.results.ties import ties

if TYPE_CHECKING:
    import xarray as xr

ON_SPRINGS = ("oscillator", "vehicle", "matrices", "train")  # kinds of loads whose bodies are above their contacts
_HIGHEST = 0.04  # of the width of the lines: height of a body over what it stands on
_SAME = 1e-3  # of the deepest compression: bodies of one level


def drawn_bodies(dataset: xr.Dataset) -> Array:
    """Return the places of bodies in a picture, (frame, body, axis) m; NaN of vehicles that are off their lines.

    Bodies of vehicles are raised by their compression in the first frame on the line, and by a height for each level of
    springs below them: a body that is compressed more stands on one that is compressed less.

    Args:
        dataset: a result, or the frames of it that are drawn.
    """
    place = np.array(dataset["body_position"].values, dtype=float)
    if not place.size:
        return place
    loads, bodies = declared(dataset, "loads"), dataset["body"].values.tolist()
    on = dataset["contact_state"].values != OFF_LINE
    spots, pairs = dataset["contact_position"].values[..., -1], ties(dataset)
    for name in dict.fromkeys(body.rpartition(".")[0] or body for body in bodies):
        if loads.get(name.partition(".")[0], {}).get("kind") not in ON_SPRINGS:
            continue
        own = [i for i, body in enumerate(bodies) if (body.rpartition(".")[0] or body) == name]
        below = sorted({k for i, k in pairs if i in own})
        near = [k for k in below if str(dataset["load"].values[k]).startswith(f"{name}.")] or below
        here = on[:, near].any(axis=1) if near else np.zeros(len(place), dtype=np.bool_)
        if here.any():
            first = int(here.argmax())
            depth = np.nanmean(spots[first, near]) - place[first, own, -1]
            place[:, own, -1] += np.maximum(depth, 0.0) + _levels(depth) * _height(dataset, place[here][:, own, -1])
        place[~here[:, None] & np.isin(np.arange(len(bodies)), own)] = np.nan
    return place


def _levels(depth: Array) -> Array:
    """Level of each body above the wheels, from 1: the number of different compressions up to its own."""
    steps = np.unique(np.round(depth / max(_SAME * float(np.abs(depth).max()), 1e-12)), return_inverse=True)[1]
    return np.asarray(1.0 + steps)


def _height(dataset: xr.Dataset, z: Array) -> float:
    """Height of a level, m: that of what else is drawn, but small compared with the width of it."""
    lines = dataset["position"].values
    extent = max(float(np.nanmax(lines[..., -1]) - np.nanmin(lines[..., -1])), float(np.ptp(z, axis=0).max()))
    return min(extent, _HIGHEST * float(np.nanmax(lines[..., 0]) - np.nanmin(lines[..., 0])))
