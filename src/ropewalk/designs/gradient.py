"""Gradients of quantities with respect to keys, each derivative with an estimate of its error."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.designs.evaluation import Evaluation
from ropewalk.designs.variables import Space, Variable, number_of
from ropewalk.errors import Refused, RopewalkError, did_you_mean
from ropewalk.model import Dynamic, Scenario
from ropewalk.sweeps.case import FINE
from ropewalk.sweeps.keys import leaves, short_names, unit_at
from ropewalk.sweeps.parameters import refuse
from ropewalk.sweeps.store import Store
from ropewalk.units import to_si

if TYPE_CHECKING:
    import xarray as xr

STILL, MOVING = 1e-3, 1e-2
"""Steps of rest and linear theory, and of motions, whose extremes jump from one output instant to another."""


def gradient(
    scenario: Scenario,
    of: str | Sequence[str],
    to: str | Sequence[str],
    *,
    step: float | None = None,
    store: str | os.PathLike[str] | None = None,
    workers: int | None = None,
) -> xr.Dataset:
    """Differentiate quantities of a run with respect to numbers of its scenario.

    Central differences over a step and over half of it, and what both together say of a step of zero (L. F.
    Richardson, 1911): its error is of the fourth order in the step. Four runs for each key, side by side.

    Args:
        scenario: where.
        of: quantities, as `record` of a sweep has them.
        to: keys, with a number other than 0 at each.
        step: as a part of the value at each key (default: 0.001, of motions 0.01).
        store: file of JSON lines for the finished cases, shared with sweeps.
        workers: processes (default: one for each core).

    Returns:
        `gradient` and `error` over `quantity` and `key`, in SI units: d(quantity)/d(key). The error is what the half
        step has changed: it also feels roundness and roughness, and is no bound.

    Raises:
        ScenarioError: a quantity or a key is unknown, or a key has no number.
        RopewalkError: a run beside the scenario has no value; it says why.
    """
    import xarray as xr

    names = [part.strip() for part in of.split(",")] if isinstance(of, str) else list(of)
    keys = [to] if isinstance(to, str) else list(to)
    step = (MOVING if isinstance(scenario.run, Dynamic) else STILL) if step is None else step
    if not 0.0 < step < 0.5:
        refuse("step", "is a part of the value at each key", f"{step:g}", "write for example 0.001")
    space = _beside(scenario, keys, step)
    points = []
    for k in range(len(keys)):
        for part in (0.0, 0.25, 0.75, 1.0):
            point = space.own.copy()
            point[k] = part
            points.append(point)
    with Store(None if store is None else Path(store)) as kept:
        runs = Evaluation(scenario, space, {}, names, kept, workers)
        found = runs.together(points)
    for one in found:
        if one.outcome.outcome not in FINE:
            raise RopewalkError(f"there is no gradient: with {', '.join(one.settings)} {one.outcome.reason}")
    slopes, errors = np.zeros((len(names), len(keys))), np.zeros((len(names), len(keys)))
    for j, name in enumerate(names):
        for k, variable in enumerate(space.variables):
            low, near_low, near_high, high = (number_of(run.outcome, name) for run in found[4 * k : 4 * k + 4])
            width = variable.high - variable.low
            whole, half = (high - low) / width, (near_high - near_low) / (0.5 * width)
            slopes[j, k], errors[j, k] = (4.0 * half - whole) / 3.0, abs(half - whole)
    units = [next((run.outcome.values[name][1] for run in found), "") for name in names]
    coordinates: dict[str, Any] = {
        "quantity": names, "key": keys, "quantity_units": ("quantity", units), "key_units": ("key", list(space.units)),
    }  # fmt: skip
    dims = ("quantity", "key")
    doubtful = sorted({doubt for run in found for doubt in run.outcome.doubts})
    return xr.Dataset(
        {"gradient": (dims, slopes), "error": (dims, errors)}, coordinates, {"step": step, "doubts": doubtful}
    )


def _beside(scenario: Scenario, keys: Sequence[str], step: float) -> Space:
    """The space around the values of the scenario.

    Raises:
        ScenarioError: a key is unknown or has no number.
    """
    tree = scenario.model_dump(mode="json", by_alias=True, exclude_none=True)
    stands = dict(leaves(tree))
    variables, units = [], []
    for key in keys:
        if key not in stands:
            refuse(key, "the scenario has no value there", "", did_you_mean(key, stands, "write it into the scenario"))
        unit = unit_at(tree, key)
        try:
            value = to_si(stands[key], unit or "dimensionless")
        except Refused:
            value = 0.0
        if value == 0.0:
            refuse(key, "only numbers other than 0 have a step", str(stands[key]), "leave it out")
        low, high = sorted((value * (1.0 - step), value * (1.0 + step)))
        variables.append(Variable(key, low, high, unit))
        units.append(unit)
    return Space(tuple(variables), tuple(short_names(keys)), tuple(units), np.full(len(keys), 0.5))
