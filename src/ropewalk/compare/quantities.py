"""Quantities: what an engineer asks of each model, and how far that is from the full scenario."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.compare.trace import Difference, Level, Trace, difference
from ropewalk.coupling import largest
from ropewalk.mechanics.chain import Array
from ropewalk.results.contract import path_name
from ropewalk.results.extremes import Summary
from ropewalk.results.nets import net_names
from ropewalk.results.statistics import lines

if TYPE_CHECKING:
    import xarray as xr

QUANTITIES = ("deflection", "path", "tension", "support force", "contact force", "speed", "hold force")
"""What is compared: the largest of each over the run, and `path`, the deflection under the load all along its way."""
JUDGED = QUANTITIES[:-1]
"""What a verdict asks for by itself: hold forces are none of a clamped force, and say nothing of its other effects."""
# What is smaller than this part of the largest of its kind (of another line, support or wheel) is compared with that.
SMALL = 0.01
# Parts of loads and lengths that are rounding errors.
NOTHING = 1e-9
EVERYWHERE = (-np.inf, np.inf)


@dataclass(frozen=True)
class Quantities:
    """What one model says: lines, supports and wheels by name, values in SI units with place (xi) and instant."""

    lines: dict[str, Summary]  # deflection (m), tension (N; of nets N/m)
    supports: dict[str, Summary]  # force (N)
    wheels: dict[str, Summary]  # contact_force: largest, mean, deviation (N); hold_force (N), last_speed (m/s)

    def as_dict(self) -> Summary:
        """Plain values that fit into JSON."""
        return {"lines": self.lines, "supports": self.supports, "wheels": self.wheels}

    def without_supports(self, names: Collection[str]) -> Quantities:
        """The same without the forces of some supports."""
        kept = {name: support for name, support in self.supports.items() if name not in names}
        return replace(self, supports=kept)

    def over(self, path: str) -> Quantities:
        """The same of a quasi-static motion, which has no time but a path."""

        def renamed(found: Summary | None) -> Summary | None:
            return found and {path if key == "time" else key: value for key, value in found.items()}

        return Quantities(
            {name: {key: renamed(value) for key, value in line.items()} for name, line in self.lines.items()},
            {name: renamed(support) or {} for name, support in self.supports.items()},
            {name: {key: renamed(value) for key, value in wheel.items()} for name, wheel in self.wheels.items()},
        )

    def values(self, quantity: str) -> dict[str, float | None]:
        """The values of one of QUANTITIES but `path`, by line, support or wheel."""
        if quantity in ("deflection", "tension"):
            return {name: line[quantity]["value"] for name, line in self.lines.items()}
        if quantity == "support force":
            return {name: support["value"] for name, support in self.supports.items()}
        key = {"contact force": "contact_force", "hold force": "hold_force", "speed": "last_speed"}[quantity]
        return {name: (wheel[key] or {"value": None})["value"] for name, wheel in self.wheels.items()}


def quantities_of(
    result: xr.Dataset,
    level: Level,
    found: Mapping[str, Trace],
    limits: Mapping[str, tuple[float, float]] = MappingProxyType({}),
    *,
    speeds: bool,
) -> Quantities:
    """Look them up in a result.

    Args:
        result: of one model.
        level: where its lines rest.
        found: its wheels.
        limits: places in m between which deflections of a line count, by line; elsewhere its ends would speak.
        speeds: whether its loads find their speeds by themselves; else these say nothing of the model.
    """
    path = result[path_name(result)].values
    of_lines: dict[str, Summary] = {}
    for line in lines(result):
        here = np.flatnonzero(result["line"].values == line)
        links = np.flatnonzero(result["link_line"].values == line)
        xi, middle = result["xi"].values[here], result["link_xi"].values[links]
        deep = (result["position"].values[:, here] - level.place[line]) @ level.towards
        under = [trace for trace in found.values() if trace.line == line]
        seen = (xi >= limits.get(line, EVERYWHERE)[0]) & (xi <= limits.get(line, EVERYWHERE)[1])
        of_lines[line] = {
            "deflection": _deepest([largest(deep[:, seen], xi[seen], path), *map(_under, under)]),
            "tension": largest(result["tension"].values[:, links], middle, path),
        }
    for net in net_names(result):
        of_lines[net] = _of_net(result, net, level, [trace for trace in found.values() if trace.line == net])
    supports: dict[str, Summary] = {}
    for k, name in enumerate(result["support"].values.tolist()):
        size = np.linalg.norm(result["reaction"].values[:, k], axis=1)
        at = int(np.nanargmax(size)) if np.isfinite(size).any() else 0
        supports[name] = {"value": float(size[at]) if np.isfinite(size[at]) else None, "time": float(path[at])}
    wheels = {wheel: _wheel(trace, speeds=speeds) for wheel, trace in found.items()}
    found_here = Quantities(of_lines, supports, wheels)
    return found_here if path_name(result) == "time" else found_here.over(path_name(result))


def _of_net(result: xr.Dataset, net: str, level: Level, under: list[Trace]) -> Summary:
    """The largest deflection of a net in m, and its largest tension in N/m; places of a net are none along a line."""
    path, here = result[path_name(result)].values, np.flatnonzero(result["line"].values == net)
    deep = (result["position"].values[:, here] - level.place[net]) @ level.towards
    cells = np.flatnonzero(result["cell_net"].values == net)
    pull = result["cell_tension"].values[:, cells].max(axis=2)
    deepest, most = (largest(values, np.zeros(values.shape[1]), path) for values in (deep, pull))
    return {
        "deflection": {**_deepest([deepest, *map(_under, under)]), "xi": None},
        "tension": {**most, "xi": None},
    }  # fmt: skip


def _under(trace: Trace) -> Summary | None:
    """The largest deflection under a wheel, which often stands between the nodes."""
    if not np.isfinite(trace.depth).any():
        return None
    at = int(np.nanargmax(trace.depth))
    return {"value": float(trace.depth[at]), "xi": float(trace.xi[at]), "time": float(trace.time[at])}


def _deepest(found: list[Summary | None]) -> Summary:
    return max((one for one in found if one is not None), key=lambda one: float(one["value"]))


def _wheel(trace: Trace, *, speeds: bool) -> Summary:
    size = trace.size
    on = np.isfinite(size)
    if not on.any():
        return {"contact_force": None, "hold_force": None, "last_speed": None}
    at = int(np.nanargmax(size))
    pull = np.where(on, trace.hold, -1.0)
    known = np.flatnonzero(np.isfinite(trace.speed) & on)
    last = {"value": float(trace.speed[known[-1]]), "time": float(trace.time[known[-1]])} if known.size else None
    return {
        "contact_force": {
            "value": float(size[at]), "mean": float(size[on].mean()), "deviation": _deviation(size[on]),
            "time": float(trace.time[at]),
        },
        "hold_force": {"value": float(trace.hold[int(pull.argmax())]), "time": float(trace.time[int(pull.argmax())])},
        "last_speed": last if speeds else None,
    }  # fmt: skip


def _deviation(size: Array) -> float:
    """Standard deviation; nothing where it is a rounding error."""
    deviation = float(size.std())
    return deviation if deviation > NOTHING * float(size.mean()) else 0.0


def errors_of(
    full: Quantities, other: Quantities, ways: Mapping[str, Difference], weight: float
) -> dict[str, float | None]:
    """Relative distance of a model from the full scenario for each of QUANTITIES: that of the line, support or wheel
    with the largest; None where there is nothing to compare.

    Args:
        full, other: what both say.
        ways: differences of the deflections under the wheels.
        weight: N, of all loads: forces that are nothing compared with it are none.
    """
    found: dict[str, float | None] = {}
    for quantity in QUANTITIES:
        if quantity == "path":
            found[quantity] = max((way.largest for way in ways.values() if way.scale > 0.0), default=None)
            continue
        floor = NOTHING * weight if quantity in ("tension", "support force", "contact force", "hold force") else 0.0
        found[quantity] = _distance(full.values(quantity), other.values(quantity), floor)
    return found


def _distance(full: Mapping[str, float | None], other: Mapping[str, float | None], floor: float) -> float | None:
    scale = max((abs(value) for value in full.values() if value is not None), default=0.0)
    if scale <= floor:
        return None
    parts = [
        abs(other[name] - value) / max(abs(value), SMALL * scale)  # type: ignore[operator]
        for name, value in full.items()
        if value is not None and other.get(name) is not None
    ]
    return float(max(parts)) if parts else None


def ways_of(full: Mapping[str, Trace], other: Mapping[str, Trace], *, timed: bool) -> dict[str, Difference]:
    """Differences of the deflections under all wheels that have been where the same wheel of the full scenario was."""
    both = {name: difference(trace, other[name], timed=timed) for name, trace in full.items() if name in other}
    return {name: way for name, way in both.items() if way is not None}


def weight_of(found: Mapping[str, Trace]) -> float:
    """Mean force of all wheels of a result together, N."""
    means = [float(np.nanmean(trace.size)) for trace in found.values() if np.isfinite(trace.size).any()]
    return float(sum(means))
