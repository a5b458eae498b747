"""Statistics of payloads below trolleys: how far they sway, how much their ropes or leashes pull."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.results.contact_statistics import scenario_of
from ropewalk.results.contract import path_name
from ropewalk.results.frame import Array
from ropewalk.results.hanging import SUFFIX, pull_of
from ropewalk.results.own_way import lowest
from ropewalk.results.ties import ties

if TYPE_CHECKING:
    import xarray as xr

Summary = dict[str, Any]


def payload_summary(dataset: xr.Dataset) -> dict[str, Summary]:
    """Give for every payload, by the name of its load, how it hangs over the output instants.

    `sway` is the largest level distance from its trolley in m, `swing` the largest angle from the vertical of its rope
    in rad while it pulls, `speed` the largest speed in m/s, `pull` the largest pull of its rope in N, `slack` the share
    of the instants at which the rope does not pull; these two are None where the scenario is not known. `lowest_place`
    is its least height in m, and how far `below` the first one that is.

    The pull is k (l - L) + c dl/dt of the rope as declared, with the length l between trolley and payload; its rate is
    that of a parabola through three instants.

    Args:
        dataset: a result.
    """
    bodies, name = dataset["body"].values.tolist(), path_name(dataset)
    hung = [(i, k) for i, k in ties(dataset) if bodies[i].endswith(SUFFIX)]
    if not hung or not dataset.sizes[name]:
        return {}
    scenario, path = scenario_of(dataset), dataset[name].values
    found: dict[str, Summary] = {}
    for i in dict.fromkeys(i for i, _ in hung):
        load, on = bodies[i].removesuffix(SUFFIX), [k for body, k in hung if body == i]  # one contact for each line
        span = dataset["body_position"].values[:, i] - dataset["contact_position"].values[:, on].mean(axis=1)
        aside = np.linalg.norm(span[:, :-1], axis=1)
        angle = np.arctan2(aside, -span[:, -1])
        pull = pull_of(scenario, load, span, path) if name == "time" else None
        slack = None if pull is None else float(np.mean(pull[np.isfinite(pull)] <= 0.0))
        found[load] = {
            "sway": _largest(aside, "m", path, name),
            "swing": _largest(angle if pull is None else np.where(pull > 0.0, angle, np.nan), "rad", path, name),
            "speed": _largest(np.linalg.norm(dataset["body_velocity"].values[:, i], axis=1), "m/s", path, name),
            "pull": None if pull is None else _largest(pull, "N", path, name),
            "slack": {"value": slack, "unit": "1"},
            "lowest_place": lowest(
                dataset, dataset["body_position"].values[:, i, -1], np.ones(path.size, dtype=np.bool_)
            ),
        }
    return found


def _largest(values: Array, unit: str, path: Array, name: str) -> Summary | None:
    if not np.isfinite(values).any():
        return None
    at = int(np.nanargmax(values))
    return {"value": float(values[at]), "unit": unit, name: float(path[at])}
