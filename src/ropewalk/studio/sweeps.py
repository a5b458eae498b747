"""Sweeps as a page shows them: all cases with their numbers, and the scenario of one of them."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from ruamel.yaml import YAML

from ropewalk.errors import Problem, RopewalkError, ScenarioError
from ropewalk.model import Scenario, Sweep
from ropewalk.scenario import dump, loads
from ropewalk.studio.folder import check_inside
from ropewalk.sweeps.dataset import counted, named
from ropewalk.sweeps.parameters import parameters_of
from ropewalk.sweeps.plan import Plan

if TYPE_CHECKING:
    import xarray as xr

MOST_CASES = 20_000
_LONG = re.compile(r"-?\d+\.\d{5,}")


def described(dataset: xr.Dataset) -> dict[str, Any]:
    """A sweep as plain values: parameters, quantities and outcomes, each with one entry for each case.

    Raises:
        RopewalkError: there are too many cases for a page.
    """
    count = int(dataset["outcome"].size)
    if count > MOST_CASES:
        raise RopewalkError(f"this sweep has {count} cases, a page shows at most {MOST_CASES}")

    def column(name: str) -> dict[str, Any]:
        values = dataset[name].broadcast_like(dataset["outcome"]).transpose(*dataset["outcome"].dims).values.ravel()
        is_numeric = values.dtype.kind in "fiu"
        kept = [float(v) if np.isfinite(v) else None for v in values] if is_numeric else [str(v) for v in values]
        return {"name": name, "unit": str(dataset[name].attrs.get("units", "")), "numeric": is_numeric, "values": kept}

    return {
        "title": str(dataset.attrs["title"]), "outcome": str(dataset.attrs["outcome"]), "counted": counted(dataset),
        "grid": "case" not in dataset.dims,
        **{kind: [column(name) for name in named(dataset, kind)] for kind in ("parameters", "quantities")},
        **{key: column(key)["values"] for key in ("doubts", "reason")}, "outcomes": column("outcome")["values"],
    }  # fmt: skip


def checked_plan(scenario: Scenario, sweep: Sweep, allow: Callable[[Scenario], None], folder: Path) -> Plan:
    """What a sweep computes, if all its cases are allowed.

    Args:
        scenario: what the cases are changes of.
        sweep: what is asked.
        allow: refuses a scenario.
        folder: where files may be.

    Raises:
        ScenarioError: a case reads files outside, runs code or is huge; or see `Plan.of`.
    """
    allow(scenario)
    for parameter in parameters_of(sweep.over):
        for level in parameter.levels:
            tree = YAML(typ="safe", pure=True).load(level) if isinstance(level, str) else level
            for part in reversed(parameter.key.split(".")):
                tree = {part: tree}
            check_inside(tree, folder)  # before a file is read to see what is in it
    plan = Plan.of(scenario, sweep)
    if len(plan.rows) > MOST_CASES:
        remedy = f"use at most {MOST_CASES} cases"
        raise ScenarioError([Problem("sweep", "has too many cases for a page", str(len(plan.rows)), remedy)])
    for row in plan.rows:
        if row.case is not None:
            allow(row.case.scenario)
    return plan


def case_of(dataset: xr.Dataset, row: int, allow: Callable[[Scenario], None], folder: Path) -> dict[str, Any]:
    """The scenario of one case of a sweep that was computed before.

    Args:
        dataset: of the sweep.
        row: number of the case, as in `described`.
        allow: refuses a scenario.
        folder: where files may be.

    Raises:
        RopewalkError: the file holds only a part of its sweep, or there is no such case.
    """
    sweep = Sweep(**json.loads(str(dataset.attrs["sweep"])))
    plan = checked_plan(loads(str(dataset.attrs["scenario"]), "the sweep"), sweep, allow, folder)
    if len(plan.rows) != dataset["outcome"].size:
        raise RopewalkError("this file contains a part of its sweep; open the complete file")
    if not 0 <= row < len(plan.rows):
        raise RopewalkError(f"case {row}: there is no such case")
    found = plan.rows[row]
    if found.case is None:
        raise RopewalkError(f"this case is no scenario: {found.refused}")
    names = dict(zip(plan.sweep.over, plan.names, strict=True))
    pairs = (_LONG.sub(lambda number: f"{float(number[0]):.4g}", one).partition("=") for one in found.settings)
    short = [f"{names[key]} {value}" for key, _, value in pairs if key in names]
    title = ", ".join([plan.scenario.title, *short])
    settings = "".join(f"# {setting}\n" for setting in found.settings)
    text = dump(found.case.scenario.model_copy(update={"title": title}))
    return {"text": f"# One case of a sweep:\n{settings}{text}", "title": title}
