"""Statistics of single collector strips, and how far heads of pantographs turn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.model.pantograph import LEADING, TRAILING
from ropewalk.results.contact_statistics import ContactStatistics, filtered, interval_of, scenario_of
from ropewalk.results.course import courses, on_strips

if TYPE_CHECKING:
    import xarray as xr

_ENDS = {"pitch": (LEADING, TRAILING), "roll": ("left", "right")}


@dataclass(frozen=True)
class StripStatistics:
    """A collector strip while its pantograph is in the analysed spans, of its force up to 20 Hz."""

    mean: float  # N
    deviation: float  # N, standard deviation
    maximum: float  # N
    minimum: float  # N
    loss: float  # share of the time without contact, of the force as computed


UNITS = {"mean": "N", "deviation": "N", "maximum": "N", "minimum": "N", "loss": "1"}


def strip_statistics(
    dataset: xr.Dataset, flat: xr.Dataset, every: dict[str, ContactStatistics]
) -> dict[str, dict[str, StripStatistics]]:
    """Statistics of each strip of pantographs that have two, by pantograph and strip.

    Args:
        dataset: a result with samples.
        flat: what `samples` gives of it.
        every: statistics of its pantographs, by name.
    """
    names, interval = flat["load"].values.tolist(), interval_of(flat)
    out = dict[str, dict[str, StripStatistics]]()
    for name, course in courses(scenario_of(dataset), names).items():
        station, found = flat["station"].values[:, names.index(name)], every[name]
        here = (station >= found.first) & (station <= found.last)
        if here.sum() < 2:
            continue
        for strip, raw in on_strips(course, flat["share"].values).items():
            own = here & np.isfinite(raw)
            force = filtered(raw, interval)[own]
            values = force.mean(), force.std(), force.max(), force.min(), np.mean(raw[own] == 0.0)
            out.setdefault(name, {})[strip] = StripStatistics(*map(float, values))
    return out


def rotation_ranges(dataset: xr.Dataset, name: str, spacing: dict[str, float]) -> dict[str, tuple[float, float]]:
    """Least and largest angles of a head at the output instants, rad: pitch, leading strip up; roll, left up.

    Args:
        dataset: a result.
        name: of the pantograph.
        spacing: m, distances between the ends of its head that turn up and down, by rotation.
    """
    bodies, out = dataset["body"].values.tolist(), {}
    for rotation, distance in spacing.items():
        one, other = (
            dataset["body_position"].values[:, bodies.index(f"{name}.head.{end}"), -1] for end in _ENDS[rotation]
        )
        angle = (one - other) / distance
        out[rotation] = (float(np.nanmin(angle)), float(np.nanmax(angle)))
    return out
