"""The answer of a design: the best values, what holds them back, the course of the search, the scenario."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

import ropewalk
from ropewalk.designs.certificate import Neighbour
from ropewalk.designs.evaluation import Evaluated
from ropewalk.designs.task import Task
from ropewalk.model import Scenario
from ropewalk.scenario import dump

if TYPE_CHECKING:
    import xarray as xr

KIND = "design"
DRIFTS = "a neighbour is better: the search has ended before it was there; give it more runs, or other bounds"


@dataclass(frozen=True)
class Design:
    """What was found.

    Args:
        task: what was asked, with all runs.
        outcome: completed, doubtful (its run is), not at an optimum (a neighbour is better), interrupted, or that no
            design keeps the limits or has a value.
        best: the best point that keeps all limits.
        neighbours: points around it.
        active: numbers of the limits that are reached there.
        left: the part of the gradient that active limits and bounds do not balance; None: unknown, or none is active.
    """

    task: Task
    outcome: str
    best: Evaluated | None
    neighbours: tuple[Neighbour, ...]
    active: tuple[int, ...]
    left: float | None

    @property
    def values(self) -> dict[str, str]:
        """The best values by key, as a file has them."""
        return {} if self.best is None else dict(setting.split("=", 1) for setting in self.best.settings)

    @property
    def value(self) -> float:
        """The quantity, in SI units; NaN if there is no design."""
        return np.nan if self.best is None else self.task.sign * self.task.of(self.best)[0]

    @property
    def unit(self) -> str:
        """The unit of the quantity."""
        runs = self.task.runs
        keys = [one.key for one in runs.space.variables]
        if self.task.objective in keys:
            return runs.space.units[keys.index(self.task.objective)]
        return next((e.outcome.values[self.task.objective][1] for e in runs.course if e.outcome.values), "")

    @property
    def scenario(self) -> Scenario:
        """The scenario with the best values.

        Raises:
            ValueError: there is no design.
        """
        if self.best is None:
            raise ValueError(self.outcome)
        return self.task.runs.scenario_at(self.best.settings)

    @property
    def limits_reached(self) -> list[str]:
        """Limits and bounds that hold the best design back."""
        if self.best is None:
            return []
        found = [self.task.limits[k].text for k in self.active]
        for one, part in zip(self.task.runs.space.variables, self.best.point, strict=True):
            if part in (0.0, 1.0):
                found.append(f"{one.key} {'>=' if part == 0.0 else '<='} {one.at(float(part))}")
        return found

    @property
    def doubts(self) -> list[str]:
        """Why the best design must not be trusted."""
        found = [] if self.best is None else list(self.best.outcome.doubts)
        return [*found, DRIFTS] if self.outcome == "not at an optimum" else found

    @property
    def course(self) -> xr.Dataset:
        """All runs in the order in which they were asked for, over `case`, as a sweep of drawn cases."""
        import xarray as xr

        runs = self.task.runs
        coordinates: dict[str, Any] = {"case": np.arange(len(runs.course))}
        for k, (name, one) in enumerate(zip(runs.space.names, runs.space.variables, strict=True)):
            unit = one.unit or runs.space.units[k]
            values = [runs.space.values(found.point)[k] for found in runs.course]
            coordinates[name] = "case", values, {"key": one.key, **({"units": unit} if unit else {})}
        variables: dict[str, Any] = {}
        for name in runs.record:
            pairs = [found.outcome.values.get(name, (None, "")) for found in runs.course]
            unit = next((unit for _, unit in pairs if unit), "")
            numbers = [np.nan if value is None else value for value, _ in pairs]
            variables[name] = "case", numbers, {"units": unit} if unit else {}
        judged = [self.task.of(found) for found in runs.course]
        kept = [bool(np.isfinite(value) and (excess <= 0.0).all()) for value, excess in judged]
        so_far, best = [], np.inf
        for (value, _), fine in zip(judged, kept, strict=True):
            best = min(best, value) if fine else best
            so_far.append(self.task.sign * best if np.isfinite(best) else np.nan)
        variables["keeps_limits"] = "case", kept
        variables["best_so_far"] = "case", so_far, {"units": self.unit} if self.unit else {}
        for name in ("outcome", "reason"):
            variables[name] = "case", [getattr(found.outcome, name) for found in runs.course]
        variables["doubts"] = "case", ["\n".join(found.outcome.doubts) for found in runs.course]
        seconds = [found.outcome.seconds for found in runs.course]
        variables["seconds"] = "case", seconds, {"units": "s", "long_name": "time that the run took"}
        about: dict[str, Any] = {
            "title": runs.scenario.title, "kind": KIND, "outcome": self.outcome, "ropewalk": ropewalk.__version__,
            "scenario": dump(runs.scenario), "parameters": list(runs.space.names), "quantities": list(runs.record),
            "objective": self.task.objective, "goal": "minimise" if self.task.sign > 0.0 else "maximise",
            "limits": json.dumps([limit.text for limit in self.task.limits]),
        }  # fmt: skip
        return xr.Dataset(variables, coordinates, about)

    def as_dict(self) -> dict[str, Any]:
        """As plain values that fit into JSON."""
        space = self.task.runs.space
        around = [
            {
                "variable": space.variables[n.variable].key,
                "value": space.variables[n.variable].at(n.point[n.variable]),
                "objective": self.task.sign * n.value if np.isfinite(n.value) else None, "verdict": n.verdict,
            }
            for n in self.neighbours
        ]  # fmt: skip
        return {
            "outcome": self.outcome, "objective": self.task.objective,
            "goal": "minimise" if self.task.sign > 0.0 else "maximise",
            "value": None if np.isnan(self.value) else self.value, "unit": self.unit, "values": self.values,
            "limits_reached": self.limits_reached, "runs": len(self.task.runs.course), "neighbours": around,
            "gradient_left": self.left, "doubts": self.doubts,
        }  # fmt: skip

    def figure(self) -> Any:
        """The course of the search, and the quantity over each variable."""
        from ropewalk.designs.figure import design_figure

        return design_figure(self.course)
