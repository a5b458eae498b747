"""The answer of a sweep: one dataset over its parameters, and the same as a table."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

import ropewalk
from ropewalk.model.sweep import FOR_EFFECTS, ONE_AT_A_TIME
from ropewalk.scenario import dump
from ropewalk.sweeps.case import MISSING, Outcome
from ropewalk.sweeps.plan import Plan
from ropewalk.sweeps.quantities import broken_name
from ropewalk.sweeps.swings import SWINGS, swings

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

KIND = "sweep"
_OVER = ("quantity", "parameter")


def dataset_of(plan: Plan, done: Mapping[str, Outcome], outcome: str) -> xr.Dataset:
    """Put all outcomes together.

    Args:
        plan: of the sweep.
        done: outcomes by the keys of the cases.
        outcome: of the sweep as a whole.
    """
    import xarray as xr

    nothing = Outcome(MISSING, {}, reason="the sweep was interrupted before")
    found = [plan.outcome(row, done, nothing) for row in plan.rows]
    dims = plan.names if plan.is_grid else ("case",)
    shape = tuple(len(p.levels) for p in plan.parameters) if plan.is_grid else (len(plan.rows),)
    coordinates: dict[str, Any] = {} if plan.is_grid else {"case": np.arange(len(plan.rows))}
    for k, (name, parameter) in enumerate(zip(plan.names, plan.parameters, strict=True)):
        values, unit = plan.coordinate(k)
        described = {"key": parameter.key, **({"units": unit} if unit else {})}
        coordinates[name] = (name if plan.is_grid else "case", values, described)

    def over(values: Any, **about: str) -> Any:
        return dims, np.array(values).reshape(shape), about

    variables = {}
    for name in plan.sweep.record:
        pairs = [one.values.get(name, (None, "")) for one in found]
        unit = next((unit for _, unit in pairs if unit), "")
        numbers = [np.nan if value is None else value for value, _ in pairs]
        variables[name] = over(numbers, **({"units": unit} if unit else {}))
        if (names := broken_name(name)) is not None:
            variables[names] = over([one.broken.get(name, "") for one in found], long_name="limits that are broken")
    about_effects = {}
    if plan.sweep.combine in (ONE_AT_A_TIME, *FOR_EFFECTS):
        about_effects = {"parameter": list(plan.names), "quantity": list(plan.sweep.record)}
        variables |= _effects(plan, {name: variables[name][1] for name in plan.sweep.record})
    variables["outcome"] = over([one.outcome for one in found])
    variables["doubts"] = over(["\n".join(one.doubts) for one in found])
    variables["reason"] = over([one.reason for one in found])
    variables["seconds"] = over([one.seconds for one in found], units="s", long_name="time that the run took")
    asked = plan.sweep.model_dump(mode="json")
    about: dict[str, Any] = {
        "title": plan.scenario.title, "kind": KIND, "outcome": outcome, "ropewalk": ropewalk.__version__,
        "scenario": dump(plan.scenario), "sweep": json.dumps(asked), "parameters": list(plan.names),
        "quantities": list(plan.sweep.record),
    }  # fmt: skip
    return xr.Dataset(variables, coordinates | about_effects, about)


def _effects(plan: Plan, values: Mapping[str, Any]) -> dict[str, Any]:
    """How much each parameter matters for each quantity."""
    if plan.sweep.combine == ONE_AT_A_TIME:
        between = swings([len(p.levels) for p in plan.parameters], values)
        return {name: (_OVER, between[name], {"long_name": meaning}) for name, meaning in SWINGS.items()}
    from ropewalk.sweeps.sensitivity import EFFECTS, effects, points  # lazy: its library takes seconds to import

    how, count, seed = plan.sweep.combine, plan.sweep.count, plan.sweep.seed
    assert count is not None
    found = effects(how, points(len(plan.parameters), how, count, seed), values, seed)
    return {name: (_OVER, found[name], {"long_name": meaning}) for name, (_, meaning) in EFFECTS[how].items()}


def effects_table(dataset: xr.Dataset) -> pd.DataFrame | None:
    """How much each parameter matters: one row for each quantity and parameter; None if the sweep does not tell.

    Args:
        dataset: from `sweep` with combine one_at_a_time, morris or saltelli.
    """
    names = [name for name in dataset.data_vars if dataset[name].dims == _OVER]
    return dataset[names].to_dataframe().reset_index() if names else None


def named(dataset: xr.Dataset, attribute: str) -> list[str]:
    """The parameters or the quantities of a sweep; a file holds one name as text."""
    value = dataset.attrs[attribute]
    return [value] if isinstance(value, str) else list(value)


def sweep_table(dataset: xr.Dataset) -> pd.DataFrame:
    """Give a sweep as a table: one row for each case, every column with its unit in its name.

    Args:
        dataset: from `sweep`.

    Returns:
        Columns of the parameters, the quantities, each that counts broken limits with their names next to it,
        `outcome`, `doubts`, `reason` and `seconds`.
    """
    quantities = [
        column
        for name in named(dataset, "quantities")
        for column in (name, broken_name(name))
        if column in dataset.data_vars
    ]
    columns = [*named(dataset, "parameters"), *quantities, "outcome", "doubts", "reason", "seconds"]
    units = {name: str(dataset[name].attrs.get("units", "")) for name in columns}
    kept = dataset[[name for name in columns if name in dataset.data_vars]]
    return (
        kept.to_dataframe()
        .reset_index()[columns]
        .rename(columns={name: f"{name} [{unit}]" for name, unit in units.items() if unit not in ("", "1")})
    )


def counted(dataset: xr.Dataset) -> dict[str, int]:
    """How many cases have each outcome."""
    names, numbers = np.unique(dataset["outcome"].values.astype(str), return_counts=True)
    return {str(name): int(number) for name, number in zip(names, numbers, strict=True)}
