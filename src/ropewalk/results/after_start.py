"""The transient after a start out of equilibrium: until when it lasts, and the summary without it.

A load that is set down suddenly, or that starts at speed on a line at rest, sends out waves. The transient lasts until
they have returned to the load from the supports at both sides, 1.1 * 2 max(a, b) / c: a and b are the distances to the
supports, and c is the phase speed of the first mode of the span L between them, c^2 = (T + EI (pi/L)^2) / m. Within
that time a light load reaches its first extreme. Later values, with further reflections, count as the response.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ropewalk.results.contact_statistics import scenario_of
from ropewalk.results.contract import path_name
from ropewalk.results.display_units import Row, number
from ropewalk.results.extremes import Summary
from ropewalk.results.frame import OFF_LINE
from ropewalk.results.sag import supported

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario

AFTER_START = "after_start"
"""Entry of the summary without the transient."""
PARTS = ("largest_tension", "smallest_tension", "largest_strain", "smallest_strain", "largest_sag", "largest_sideways",
         "supports", "contacts", "trains", "payloads", "of ropeways")  # fmt: skip
"""Entries of the summary that it has."""
_MARGIN = 1.1  # the first mode is the fastest of those that disperse, and a wave has a width
_BY_THEMSELVES = ("pantograph",)  # loads that are not set down: their forces grow from nothing

_WHEN = re.compile(r"t = \S+ s")


class StartUp(NamedTuple):
    """The transient of a run."""

    loads: tuple[str, ...]  # that cause it
    end: float  # s


def summary_after_start(dataset: xr.Dataset, entries: Callable[[xr.Dataset], Summary]) -> Summary | None:
    """Return the parts of a summary over the output instants after the transient; None where there is none.

    `from` is its end in s and `loads` are those that cause it. If the run ends before, there is nothing else.

    Args:
        dataset: a result.
        entries: gives the parts of the summary of a result.
    """
    if (found := start_up(dataset)) is None:
        return None
    head: Summary = {"from": {"value": found.end, "unit": "s"}, "loads": list(found.loads)}
    later = int(np.searchsorted(dataset["time"].values, found.end))
    return head if later >= dataset.sizes["time"] else head | entries(dataset.isel(time=slice(later, None)))


def start_up(dataset: xr.Dataset) -> StartUp | None:
    """Return the transient of a run that starts out of equilibrium; None of one that does not, or has no end known.

    Args:
        dataset: a result.
    """
    scenario = scenario_of(dataset)
    if scenario is None or path_name(dataset) != "time" or dataset.sizes["time"] < 2:
        return None
    run = scenario.run
    if run.kind != "dynamic" or run.start.kind != "rest":
        return None
    ends: dict[str, float] = {}
    state, xi, speed = (dataset[f"contact_{name}"][0].values for name in ("state", "xi", "speed"))
    for k, contact in enumerate(dataset["load"].values.tolist()):
        name = contact.partition(".")[0]
        load = scenario.loads.get(name)
        if load is None or load.kind in _BY_THEMSELVES or state[k] == OFF_LINE or falls(load):
            continue
        if run.start.with_loads and not np.nan_to_num(speed[k]):
            continue
        line = scenario.carrier_of(load)
        end = _return(dataset, scenario, line, xi[k]) if line in scenario.lines else math.nan
        if np.isfinite(end):
            ends[name] = max(ends.get(name, 0.0), end)
    return StartUp(tuple(ends), max(ends.values())) if ends else None


def falls(load: Any) -> bool:
    """Whether nearly all that a load weighs hangs on a rope that is slack at first: to fall is its purpose."""
    if load.kind != "trolley" or load.payload is None or load.payload.at is None:
        return False
    return bool(load.mass < load.payload.mass and math.hypot(*load.payload.at) < load.payload.length)


def _return(dataset: xr.Dataset, scenario: Scenario, line: str, xi: float) -> float:
    """Time in s after which waves from a place on a line have returned from both sides; NaN where it is not known."""
    own, links = (np.flatnonzero(dataset[name].values == line) for name in ("line", "link_line"))
    station, declared = dataset["xi"].values[own], scenario.lines[line]
    stations = supported(dataset, line)[0]
    low, high = (stations[stations < xi].max(initial=-np.inf), stations[stations > xi].min(initial=np.inf))
    if not (np.isfinite(low) and np.isfinite(high)):
        return math.nan  # it starts at an end
    tension = dataset["tension"][0].values[links]
    wave = np.pi / (high - low)
    square = (tension + float(declared.bending_stiffness or 0.0) * wave**2) / declared.mass
    square += float(declared.foundation or 0.0) / (declared.mass * wave**2)
    inside = (station[1:] > low) & (station[:-1] < high)
    if not (square[inside] > 0.0).all():
        return math.nan
    times = np.where(inside, np.diff(station), 0.0) / np.sqrt(np.where(inside, square, 1.0))
    passed = np.interp([low, xi, high], station, np.concatenate([[0.0], np.cumsum(times)]))
    return _MARGIN * 2.0 * float(np.diff(passed).max())


def rows_after_start(found: Summary, rows: Callable[[Summary], Iterable[Row]]) -> Iterator[Row]:
    """Rows of a table whose values differ without the transient.

    Args:
        found: what `summary` gives.
        rows: the table of a summary.
    """
    later, plain = found.get(AFTER_START), found | {AFTER_START: None}
    if later is None:
        return
    end = f"t = {number(later['from']['value'], 3)} s"
    cause = f"{', '.join(later['loads'])} starts out of equilibrium; its waves return from the supports until this time"
    if later.keys() == {"from", "loads"}:
        yield "Start-up transient", "", ""
        yield "ends at", end, f"after the run, so all values include it; {cause}"
        return
    whole = {(what, value, _WHEN.sub("", where)) for what, value, where in rows(plain)}
    heading, rest = "", list[Row]()
    for what, value, where in rows(plain | later):
        heading = heading if value else what.partition(" ")[2]
        if value and (what, value, _WHEN.sub("", where)) not in whole:
            rest.append((f"{heading}: {what}" if heading else what, value, where))
    if rest:
        yield "Without the start-up transient", "", ""
        yield "from", end, cause
        yield from rest
