"""Statistics: what an engineer asks first, as a dictionary of plain SI values that fits into JSON."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.after_start import AFTER_START, PARTS, summary_after_start
from ropewalk.results.audit import AUDIT, rounding, turnover
from ropewalk.results.contact_statistics import scenario_of
from ropewalk.results.contact_summary import contact_summary
from ropewalk.results.contract import doubts_of, path_name
from ropewalk.results.exchanges import exchange_summary
from ropewalk.results.extremes import Summary, largest, span, vector
from ropewalk.results.frame import ENERGY_FORMS, MOVES, OFF_LINE, Array
from ropewalk.results.hanging import payload_summary
from ropewalk.results.joint_statistics import joint_summary
from ropewalk.results.line_response import response_summary
from ropewalk.results.nets import net_names, net_summary
from ropewalk.results.own_way import friction_of_steps, last_place, lowest_place, steps
from ropewalk.results.peaks import impulses
from ropewalk.results.ropeway import ropeway_summary
from ropewalk.results.sag import Distances, sag, sideways
from ropewalk.results.strength import strength_summary
from ropewalk.results.trains import crowd_summary, train_summary

if TYPE_CHECKING:
    import xarray as xr

BLOCK_BYTES = 64e6  # a large result is read in pieces of this size


def summary(dataset: xr.Dataset, only: Collection[str] | None = None) -> Summary:
    """Give the few numbers that describe a result; NaN (a load off its line) is left out, absent values are None.

    Every quantity is `{value, unit, ...}` with the place (`line`, `xi` in m, and where that is then: `x`, in space also
    `y`, in m) and the instant (`time` in s, or `load_path` in m) where it was found; forces list their `components` by
    axis.

    Args:
        dataset: a result, in memory or lazy.
        only: entries that are wanted; others may be missing (default: all).
    """
    entries = _entries(cast("xr.Dataset", _Looked(dataset)))
    entries[AFTER_START] = lambda: summary_after_start(dataset, _parts)
    whole = only is None or not entries.keys() >= set(only)
    wanted = [key for key in entries if whole or key in (only or ())]
    plain: Summary = _plain(_found(entries, wanted))
    return plain


def _found(entries: dict[str, Callable[[], Any]], wanted: Collection[str]) -> Summary:
    found: Summary = {}
    for key in wanted:
        if key in _SPREAD:
            found |= entries[key]()
        else:
            found[key] = entries[key]()
    return found


def _parts(dataset: xr.Dataset) -> Summary:
    """The parts of a summary that have extremes at output instants."""
    return _found(_entries(cast("xr.Dataset", _Looked(dataset))), PARTS)


_SPREAD = ("of ropeways", "of contacts")  # entries that are several


def _entries(dataset: xr.Dataset) -> dict[str, Callable[[], Any]]:
    """The parts of a summary in their order, each to be found when it is asked for."""
    name = path_name(dataset)

    def of_loads() -> Summary:
        many = {*train_summary(dataset), *crowd_summary(dataset)}
        loads = enumerate(dataset["load"].values.tolist())
        return {label: _contact(dataset, k) for k, label in loads if label.partition(".")[0] not in many}

    def of_supports() -> Summary:
        supports = enumerate(dataset["support"].values.tolist())
        return {label: vector(dataset, dataset["reaction"][:, k].values) for k, label in supports}

    warnings = str(dataset.attrs.get("warnings", "")).splitlines()
    return {
        "title": lambda: dataset.attrs.get("title", ""),
        "outcome": lambda: dataset.attrs.get("outcome", ""),
        "advice": lambda: dataset.attrs.get("advice", ""),
        "doubts": lambda: list(doubts_of(dataset)),
        "warnings": lambda: [text for text in warnings if text],
        "frames": lambda: dataset.sizes[name],
        "simulated": lambda: _simulated(dataset),
        "largest_tension": lambda: _extreme(dataset, "tension", np.nanmax),
        "smallest_tension": lambda: _extreme(dataset, "tension", np.nanmin),
        "largest_strain": lambda: _extreme(dataset, "strain", np.nanmax),
        "smallest_strain": lambda: _extreme(dataset, "strain", np.nanmin),
        "tension_over_strength": lambda: strength_summary(dataset),
        "largest_sag": lambda: _furthest(dataset, sag),
        "largest_sideways": lambda: _furthest(dataset, _aside) if "y" in dataset["axis"].values else None,
        "lines": lambda: response_summary(dataset),
        "nets": lambda: net_summary(dataset, blocks(dataset)),
        "supports": of_supports,
        "joints": lambda: joint_summary(dataset),
        "contacts": of_loads,
        "trains": lambda: train_summary(dataset),
        "crowds": lambda: crowd_summary(dataset),
        "payloads": lambda: payload_summary(dataset),
        "of ropeways": lambda: ropeway_summary(dataset),
        "of contacts": lambda: contact_summary(dataset),
        "exchanges": lambda: exchange_summary(dataset),
        "energy": lambda: _energy(dataset),
        "mesh": lambda: _mesh(dataset),
        "method": lambda: _method(dataset),
    }


class _Looked:
    """A dataset whose variables are put together once: that takes longer than to look at those of a small result."""

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = dataset
        self._known = dict[Any, Any]()

    def __getitem__(self, name: Any) -> Any:
        if not isinstance(name, str):
            return self._dataset[name]
        if name not in self._known:
            self._known[name] = self._dataset[name]
        return self._known[name]

    def __contains__(self, name: Any) -> bool:
        return name in self._dataset

    def __iter__(self) -> Iterator[Any]:
        return iter(self._dataset)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._dataset, name)


def blocks(dataset: xr.Dataset) -> Iterator[xr.Dataset]:
    """Pieces of a result along its leading dimension, small enough to be loaded."""
    name = path_name(dataset)
    frames = dataset.sizes[name]
    rows = max(1, int(BLOCK_BYTES // max(dataset.nbytes / max(frames, 1), 1)))
    if 0 < frames <= rows:
        yield dataset
        return
    for first in range(0, frames, rows):
        yield dataset.isel({name: slice(first, first + rows)})


def lines(dataset: xr.Dataset) -> list[str]:
    """Names of the lines, in the order of the result; the nodes of nets make no line."""
    nets = net_names(dataset)
    return [name for name in dict.fromkeys(dataset["line"].values.tolist()) if name not in nets]


def _simulated(dataset: xr.Dataset) -> Summary:
    name = path_name(dataset)
    path = dataset[name].values
    return {"value": path[-1] - path[0] if len(path) else 0.0, "unit": dataset[name].attrs["units"]}


Pick = Callable[[NDArray[Any]], Any]


def _extreme(dataset: xr.Dataset, name: str, pick: Pick) -> Summary | None:
    """The extreme value of a link quantity, where and when."""
    best: tuple[float, int, float, Summary] | None = None
    for block in blocks(dataset):
        values = block[name].values
        if not np.isfinite(values).any():
            continue
        value = pick(values)
        if best is None or pick(np.array([value, best[0]])) != best[0]:
            frame, link = np.argwhere(values == value)[0]
            when = float(block[path_name(block)].values[frame])
            best = float(value), int(link), when, _middle(block, int(frame), int(link))
    if best is None:
        return None
    value, link, when, there = best
    where = {"line": dataset["link_line"].values[link], "xi": dataset["link_xi"].values[link], **there}
    return {"value": value, "unit": dataset[name].attrs["units"], **where, path_name(dataset): when}


def _middle(dataset: xr.Dataset, frame: int, link: int) -> Summary:
    """Level coordinates of the middle of a link, m: between the nodes at both sides of its material coordinate."""
    nodes = np.flatnonzero(dataset["line"].values == dataset["link_line"].values[link])
    xi, here = dataset["xi"].values[nodes], float(dataset["link_xi"].values[link])
    place = dataset["position"][frame].values[nodes]
    return {
        axis: float(np.interp(here, xi, place[:, k])) for k, axis in enumerate(dataset["axis"].values.tolist()[:-1])
    }


def _furthest(dataset: xr.Dataset, away: Callable[[xr.Dataset, str], Distances]) -> Summary | None:
    """Where and when a line is furthest away from its chord, as measured by `away`."""
    best: Summary | None = None
    for block in blocks(dataset):
        for line in lines(dataset):
            found = away(block, line)
            if not np.isfinite(found.value).any():
                continue
            at = np.unravel_index(int(np.nanargmax(found.value)), found.value.shape)
            if best is None or found.value[at] > best["value"]:
                level = dataset["axis"].values.tolist()[:-1]
                place = dict(zip(level, found.place[at][:-1].tolist(), strict=True))
                best = {"value": found.value[at], "unit": "m", "line": line, "xi": found.xi[at], **place}
                best[path_name(dataset)] = block[path_name(block)].values[at[0]]
    return best


def _aside(dataset: xr.Dataset, line: str) -> Distances:
    found = sideways(dataset, line)
    return found._replace(value=np.abs(found.value))


def _reduce(function: Pick, values: Array) -> float | None:
    kept = values[np.isfinite(values)]
    return float(function(kept)) if kept.size else None


def _contact(dataset: xr.Dataset, k: int) -> Summary:
    """Statistics of one contact over the output instants at which its load is on the line."""
    force = dataset["contact_force"][:, k].values.copy()
    present = np.isfinite(force).all(axis=1)
    entering, leaving = impulses(np.linalg.norm(force, axis=1))
    blows = {"entering": _impulse(dataset, force, entering), "leaving": _impulse(dataset, force, leaving)}
    force[np.concatenate([entering, leaving])] = np.nan
    columns = {"magnitude": np.linalg.norm(force, axis=1)}
    columns |= {axis: force[:, i] for i, axis in enumerate(dataset["axis"].values.tolist())}
    measures: dict[str, Pick] = {"mean": np.mean, "std": np.std, "min": np.min, "max": np.max}
    statistics: Summary = {
        name: {measure: _reduce(function, values) for measure, function in measures.items()}
        for name, values in columns.items()
    }
    sides = dataset["contact_tension"][:, k].values
    jump = sides[:, 1] - sides[:, 0]
    path = dataset[path_name(dataset)].values
    tension_jump: Summary = {"value": None, "unit": "N", **span(jump)}
    if np.isfinite(jump).any():
        at = int(np.nanargmax(np.abs(jump)))
        tension_jump |= {"value": jump[at], path_name(dataset): path[at]}
    friction = np.asarray(dataset["contact_friction"][:, k].values)
    if steps(dataset, k):
        friction = friction_of_steps(friction, force)
    power = np.asarray(dataset["friction_power"][:, k].values)
    return {
        "force": {"unit": "N", **statistics},
        "impulses": blows,
        "tension_jump": tension_jump,
        "hold_force": vector(dataset, dataset["hold_force"][:, k].values),
        "friction_needed": largest(dataset, friction, "1") or {"value": None, "unit": "1"},
        "share_on_line": float(np.mean(present)) if present.size else None,
        "share_in_air": _share_in_air(dataset, k),
        "friction_power": largest(dataset, power, "W") or {"value": None, "unit": "W"},
        "friction_work": {"value": float(np.trapezoid(np.nan_to_num(power), path)), "unit": "J"},
        "last_speed": _last_speed(dataset, k),
        "last_place": last_place(dataset, k),
        "lowest_place": lowest_place(dataset, k),
    }


def _impulse(dataset: xr.Dataset, force: Array, at: NDArray[np.intp]) -> Summary | None:
    """The largest force of an impulse that is left out of the statistics; it is the impulse over one step."""
    size = np.full(len(force), np.nan)
    size[at] = np.linalg.norm(force[at], axis=1)
    return largest(dataset, size, "N")


def _share_in_air(dataset: xr.Dataset, k: int) -> float | None:
    """Part of the time up to where a load leaves its line for good that it spends in the air."""
    path, state = dataset[path_name(dataset)].values, dataset["contact_state"][:, k].values
    there = np.flatnonzero(state != OFF_LINE)
    if path_name(dataset) != "time" or there.size < 2:
        return None
    first, last = there[0], there[-1]
    in_air = dataset["contact_in_air"][:, k].values
    return float((in_air[last] - in_air[first]) / (path[last] - path[first]))


def _last_speed(dataset: xr.Dataset, k: int) -> Summary | None:
    """The speed at the last output before a load leaves its line or stops; None if it does neither, or never moves."""
    state, speed = dataset["contact_state"][:, k].values, dataset["contact_speed"][:, k].values
    moving = np.flatnonzero((state == MOVES) & np.isfinite(speed) & (speed != 0.0))
    if path_name(dataset) != "time" or not moving.size or moving[-1] == state.size - 1:
        return None
    last = moving[-1]
    return {"value": speed[last], "unit": "m/s", "time": dataset["time"].values[last]}


def _energy(dataset: xr.Dataset) -> Summary:
    energy = dataset["energy"].values
    if not len(energy):
        nothing = dict.fromkeys(("turnover", "largest_imbalance"))
        return {"unit": "J", "final": dict.fromkeys(ENERGY_FORMS), "always_zero": [], **nothing, "audit": ""}
    moved = float(np.max(turnover(energy)))
    audit = np.abs(energy[:, ENERGY_FORMS.index(AUDIT)])
    if (worst := largest(dataset, audit, "J")) is not None:
        counts = moved > 0.0 and worst["value"] > rounding(scenario_of(dataset), energy)
        worst["relative"] = worst["value"] / moved if counts else None  # of rounding size: no part of anything
    final = dict(zip(ENERGY_FORMS, energy[-1].tolist(), strict=True))
    idle = [form for form, values in zip(ENERGY_FORMS, energy.T, strict=True) if not values.any()]
    return {
        "unit": "J", "final": final, "always_zero": idle, "turnover": moved, "largest_imbalance": worst,
        "audit": str(dataset.attrs.get("audit", "")),
    }  # fmt: skip


def _mesh(dataset: xr.Dataset) -> Summary | None:
    """How far positions are estimated to be from those of the continuum; None where nobody asked."""
    metadata = dataset.attrs
    if "mesh" not in metadata:
        return None
    names = {"error": "mesh_error", "of_contacts": "mesh_error_of_contacts"}
    errors = {key: {"value": metadata.get(name, math.nan), "unit": "m"} for key, name in names.items()}
    return {"told": metadata["mesh"], "order": metadata.get("mesh_order", math.nan), **errors}


def _method(dataset: xr.Dataset) -> Summary:
    metadata = dataset.attrs
    wall, compiled = float(metadata.get("wall_seconds", math.nan)), float(metadata.get("compile_seconds", 0.0))
    simulated = _simulated(dataset)["value"] if path_name(dataset) == "time" else math.nan
    return {
        "name": metadata.get("method", ""),
        "reason": metadata.get("reason", ""),
        "step": {"value": metadata.get("step"), "unit": "s"},
        "steps": metadata.get("steps"),
        "cpu": {"value": metadata.get("cpu_seconds"), "unit": "s"},
        "wall": {"value": wall, "unit": "s"},
        "compiling": {"value": compiled, "unit": "s"},
        "real_time_factor": simulated / (wall - compiled) if wall > compiled and simulated > 0.0 else None,
    }


def _plain(value: Any) -> Any:
    """Numbers of NumPy become Python's, and values that are not finite become None, which JSON can say."""
    if isinstance(value, dict):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [_plain(entry) for entry in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not math.isfinite(value) else value
