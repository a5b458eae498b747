"""Current collection in the summary of a result: pantographs with the ranges they should meet, overhead lines."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.model.pantograph import LEADING, TRAILING, Pantograph
from ropewalk.results.acceptance import SEPARATOR, UNKNOWN, Judgement, acceptance_of, judged
from ropewalk.results.contact_statistics import (
    BETWEEN,
    CUTOFF,
    ORDER,
    UNITS,
    ContactStatistics,
    LineStatistics,
    contact_statistics,
    filtered,
    has_samples,
    interval_of,
    line_statistics,
    samples,
    scenario_of,
)
from ropewalk.results.contract import doubts_of
from ropewalk.results.course import courses, on_strips, transitions
from ropewalk.results.extremes import Summary

if TYPE_CHECKING:
    import xarray as xr

    from ropewalk.model import Scenario
    from ropewalk.results.acceptance import Acceptance

_TURNS = {"pitch": (LEADING, TRAILING), "roll": ("left", "right")}


@dataclass(frozen=True)
class StripStatistics:
    """A collector strip while its pantograph is in the analysed spans, of its force up to 20 Hz."""

    mean: float  # N
    deviation: float  # N, standard deviation
    maximum: float  # N
    minimum: float  # N
    loss: float  # share of the time without contact, of the force as computed


STRIP_UNITS = {"mean": "N", "deviation": "N", "maximum": "N", "minimum": "N", "loss": "1"}


_FILTER = {"kind": "Butterworth, zero phase", "order": ORDER, "unit": "Hz", "limit": CUTOFF, "between": BETWEEN}


def contact_summary(dataset: xr.Dataset) -> Summary:
    """Give `pantographs` and `overhead_lines` of a result, by name; of one without samples droppers alone.

    Args:
        dataset: a result, in memory or lazy.
    """
    if not has_samples(dataset):
        lines = line_statistics(dataset) if dataset.sizes.get("tie", 0) else {}
        return {"pantographs": {}, "overhead_lines": {name: _line(found) for name, found in lines.items()}}
    scenario = scenario_of(dataset)
    every = contact_statistics(dataset)
    judgements = limits_of(dataset, scenario, every)
    passed, strips = dict[str, list[Summary]](), dict[str, dict[str, StripStatistics]]()
    if every:
        flat = samples(dataset.drop_vars("sampled_tie_force", errors="ignore"))
        passed, strips = transitions(scenario, flat), strip_statistics(dataset, flat, every)
    return {
        "pantographs": {
            name: _pantograph(scenario, name, found, judgements.get(name), passed.get(name))
            | {"strips": _strips(strips.get(name, {})), "rotations": _rotations(dataset, scenario, name)}
            for name, found in every.items()
        },
        "overhead_lines": {name: _line(found) for name, found in line_statistics(dataset).items()} if every else {},
    }


def limits_of(
    dataset: xr.Dataset, scenario: Scenario | None, every: dict[str, ContactStatistics]
) -> dict[str, Judgement]:
    """Compare pantographs with the limits of their lines, by name; only where a line has limits.

    Args:
        dataset: a result.
        scenario: that made it.
        every: statistics of its pantographs, by name.
    """
    if scenario is None:
        return {}
    doubtful, out = bool(doubts_of(dataset)), {}
    for name, found in every.items():
        load = scenario.loads.get(name)
        limits = scenario.overhead_lines[found.line].limits if found.line in scenario.overhead_lines else None
        if limits is not None and isinstance(load, Pantograph):
            steady = isinstance(load.travel.speed, float)
            out[name] = judged(limits, found, steady=steady, doubtful=doubtful)
    return out


def _pantograph(
    scenario: Scenario | None,
    name: str,
    found: ContactStatistics,
    judgement: Judgement | None,
    passed: list[Summary] | None,
) -> Summary:
    values = {key: {"value": getattr(found, key), "unit": unit} for key, unit in UNITS.items()}
    spans = None
    if scenario is not None and found.line in scenario.overhead_lines:
        spans = list(scenario.overhead_lines[found.line].analysed) if passed is None else None
    return {
        "line": found.line,
        "analysed_spans": spans,
        "complete": found.complete,
        "filter": _FILTER,
        **values,
        "acceptance": _acceptance(acceptance_of(scenario, name, found)),
        "limits": _limits(judgement),
        "overlaps": [{"unit": "m", **one} for one in passed or []],
    }


def _strips(found: dict[str, StripStatistics]) -> Summary:
    return {
        strip: {key: {"value": getattr(own, key), "unit": unit} for key, unit in STRIP_UNITS.items()}
        for strip, own in found.items()
    }


def _rotations(dataset: xr.Dataset, scenario: Scenario | None, name: str) -> Summary:
    """Least and largest angles of a head at the output instants."""
    load = None if scenario is None else scenario.loads.get(name)
    if not isinstance(load, Pantograph) or load.head is None:
        return {}
    ranges = rotation_ranges(dataset, name, load.head.ends)
    return {
        rotation: {key: {"value": value, "unit": "rad"} for key, value in zip(("min", "max"), ends, strict=True)}
        for rotation, ends in ranges.items()
    }


def _limits(found: Judgement | None) -> Summary | None:
    if found is None:
        return None
    # JSON knows no infinity: a limit that there is not is none.
    checks = [asdict(c) | {k: getattr(c, k) if math.isfinite(getattr(c, k)) else None for k in ("value", "low", "high")}
              for c in found.checks]  # fmt: skip
    count = None if found.verdict == UNKNOWN else float(len(found.broken))
    failures = {"value": count, "unit": "1"}  # for sweeps, which keep numbers
    broken = SEPARATOR.join(found.broken)
    text = {"title": found.title, "remark": found.remark, "verdict": found.verdict}
    return text | {"failures": failures, "broken": broken, "checks": checks}


def _acceptance(found: Acceptance | None) -> Summary | None:
    if found is None:
        return None
    checks = [asdict(check) | {"inside": check.is_inside} for check in found.checks]
    text = {"title": found.title, "remark": found.remark, "provisional": found.provisional, "met": found.is_met}
    return text | {"checks": checks}


UNITS_OF_LINE = {
    "station": "m", "uplift": "m", "length": "m", "force": "N", "largest": "N", "smallest": "N", "slack": "1",
    "slack_time": "s",
}  # fmt: skip


def _line(found: LineStatistics) -> Summary:
    droppers = found.droppers
    inner = [name for name, dropper in droppers.items() if dropper.analysed]  # the ends of a line are not typical
    largest = max(inner, key=lambda name: droppers[name].largest, default=None)
    slackest = max(inner, key=lambda name: droppers[name].slack, default=None)
    out: Summary = {
        "unit": UNITS_OF_LINE,
        "supports": {name: asdict(support) for name, support in found.supports.items()},
        "droppers": {name: asdict(dropper) for name, dropper in droppers.items()},
        "largest_dropper_force": None,
        "most_slack": None,
        "slackened": sum(dropper.slack > 0.0 for dropper in droppers.values()),
    }
    if largest is not None and slackest is not None:
        for key, name, value, unit in (
            ("largest_dropper_force", largest, droppers[largest].largest, "N"),
            ("most_slack", slackest, droppers[slackest].slack, "1"),
        ):
            out[key] = {"value": value, "unit": unit, "dropper": name, "station": droppers[name].station}
    return out


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
            dataset["body_position"].values[:, bodies.index(f"{name}.head.{end}"), -1] for end in _TURNS[rotation]
        )
        angle = (one - other) / distance
        out[rotation] = (float(np.nanmin(angle)), float(np.nanmax(angle)))
    return out
