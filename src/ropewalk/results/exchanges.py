"""What is told of the exchange with external models: in frames, as warnings, in the summary."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.external.cosimulation_master import CosimulationMaster, closing
from ropewalk.model.load import ExternalModel
from ropewalk.model.scenario import Scenario
from ropewalk.results.frame import Array, RunInfo

if TYPE_CHECKING:
    import xarray as xr

MADE = 0.05  # of the work through an exchange: of energy made beyond that a run is doubtful, as of what is missing
REMEDY = "shorten `every`, give exchange.damping (which damps), or write exchange.scheme: iterated"


def external_in(scenario: Scenario) -> tuple[str, ...]:
    """Names of the loads that are external models."""
    return tuple(name for name, load in scenario.loads.items() if isinstance(load, ExternalModel))


@contextmanager
def exchanging(cosimulation: Sequence[CosimulationMaster], run_info: RunInfo) -> Iterator[None]:
    """Let all models go at the end, however it comes, and say how much energy they have made."""
    with closing(cosimulation):
        try:
            yield
        finally:
            for partner in cosimulation:
                if partner.made > MADE:
                    cause = "its response is delayed by too much of a vibration period of the line, or is discontinuous"
                    run_info.doubt(partner.verdict, cause, f"loads.{partner.name}.every", REMEDY)
                elif partner.made:
                    run_info.warnings.append(f"{partner.verdict}; {REMEDY}")


def exchanged(cosimulation: Sequence[CosimulationMaster], run_info: RunInfo) -> dict[str, Array]:
    """What has gone through all interfaces, by the names of `Frame`; what is to be reported goes to the account."""
    if not cosimulation:
        return {}
    for partner in cosimulation:
        run_info.warnings += [remark for remark in partner.diagnostics if remark not in run_info.warnings]
        partner.diagnostics.clear()
    work, residual, peak = np.array([partner.exchanged() for partner in cosimulation]).T
    return {"exchange_work": work, "exchange_residual": residual, "exchange_peak": peak}


def exchange_summary(dataset: xr.Dataset) -> dict[str, dict[str, Any]]:
    """What each exchange came to: work and energy made at the end, and the most that one interval made, in J."""
    if not dataset.sizes.get("foreign"):
        return {}
    found = {}
    for k, name in enumerate(dataset["foreign"].values.tolist()):
        work, made, peaks = (dataset[f"exchange_{what}"].values[:, k] for what in ("work", "residual", "peak"))
        at = int(np.abs(peaks).argmax())
        found[name] = {
            "unit": "J",
            "work": float(work[-1]),
            "made": float(made[-1]),
            "relative": float(made[-1] / work[-1]) if work[-1] else None,
            "peak": {"value": float(peaks[at]), "time": float(dataset["time"].values[at])},
        }
    return found
