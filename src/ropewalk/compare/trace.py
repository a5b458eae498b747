"""Traces: what one wheel, or the feet of one person together, do on their line, along their path."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.compare.paths_on_nets import PathOnNet, paths_on_nets
from ropewalk.mechanics.chain import Array, Integers
from ropewalk.model.load import AnyLoad
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.run import Dynamic, Equilibrium, Linear
from ropewalk.model.scenario import Scenario
from ropewalk.results.contact_statistics import analysed_stations, filtered, has_samples, samples
from ropewalk.results.contract import path_name
from ropewalk.simulate import simulate

if TYPE_CHECKING:
    import xarray as xr

# What stands by its supports is compared with this part of the largest deflection at least: a local error of nothing
# over nothing, and that of the link next to a support, would say nothing of the model. A string comes to that part at
# 1.3 % of its span.
FLOOR = 0.05
_IN_PLANE = [0, 2]  # of x, y and z


@dataclass(frozen=True)
class Trace:
    """A wheel over the frames of a result (or the samples between them); NaN while it is off the line."""

    line: str  # that it is on
    time: Array  # (instant,) s; of quasi-static motion: path of the load, m
    xi: Array  # (instant,) m
    depth: Array  # (instant,) deflection of the line under it from rest, m, positive where loads press
    force: Array  # (instant, axis) N, on the line
    hold: Array  # (instant,) N, size of the hold force
    tension: Array  # (instant, 2) N, behind and ahead
    speed: Array  # (instant,) m/s as measured

    @property
    def size(self) -> Array:
        """Size of the contact force, (instant,) N; zero in the air, NaN off the line."""
        return np.where(np.isfinite(self.xi), np.linalg.norm(np.nan_to_num(self.force), axis=1), np.nan)

    @property
    def path(self) -> Array:
        """The way along the line in m that never falls: its place, or how far it went to and fro, from where it began.

        Feet that take turns move the place of their common force a little backwards, which does not count.
        """
        on = np.isfinite(self.xi)
        if not on.any():
            return np.full(self.xi.size, np.nan)
        xi = np.interp(np.arange(xi_size := self.xi.size), np.arange(xi_size)[on], self.xi[on])
        steps = np.diff(xi, prepend=xi[0])
        net = xi[-1] - xi[0]
        sign = -1.0 if net < 0.0 else 1.0
        if abs(net) >= 0.5 * np.abs(steps).sum():
            way = np.maximum.accumulate(sign * xi)
        else:
            way = sign * xi[0] + np.cumsum(np.abs(steps))
        return np.where(on, way, np.nan)


@dataclass(frozen=True)
class Level:
    """Where a line rests without loads, in the direction in which the loads press."""

    towards: Array  # (axis,) unit vector
    xi: dict[str, Array]  # of each line, (node,) m
    place: dict[str, Array]  # of each line and net, (node, axis) m
    paths: Mapping[str, PathOnNet] = field(default_factory=dict)  # of loads on nets

    def under(self, load: str, line: str, xi: Array) -> Array:
        """Places (..., axis) at rest of material points xi (...) of a line, or of the path of a load on a net, m."""
        if (path := self.paths.get(load)) is not None:
            return path.rest(xi, self.place[path.net])
        return np.stack([np.interp(xi, self.xi[line], row) for row in self.place[line].T], axis=-1)


def pressed(result: xr.Dataset) -> Array:
    """The direction along an axis, across the chord, in which the loads press most: a unit vector, mostly downwards."""
    force = np.nansum(np.nan_to_num(result["contact_force"].values), axis=(0, 1))
    place = result["position"].values[0]
    along = int(np.argmax(np.ptp(place, axis=0)))
    size = np.abs(force)
    size[along] = -1.0
    towards = np.zeros(force.size)
    towards[int(size.argmax())] = -1.0 if force[int(size.argmax())] <= 0.0 else 1.0
    if not size.max() > 0.0:
        towards[:] = 0.0
        towards[-1] = -1.0
    return towards


def level_of(
    scenario: Scenario | None, result: xr.Dataset, towards: Array, paths: Mapping[str, PathOnNet] | None = None
) -> Level:
    """Where the lines of a result rest without loads: how it begins, or a run of its own.

    Args:
        scenario: of the result; None: of a run that begins at rest.
        result: of any kind of run.
        towards: (axis,) direction in which deflections count.
        paths: of loads on nets, where no scenario says them.
    """
    bare, paths = result, paths_on_nets(scenario) if scenario is not None else paths or {}
    if scenario is not None and not _begins_at_rest(scenario):
        lines = scenario.lines
        if all((line.mass and scenario.gravity) or (line.length or 0.0) <= line.distance for line in lines.values()):
            bare = simulate(scenario.model_copy(update={"loads": {}, "run": Equilibrium()}))
    place, xi = bare["position"].values[0], bare["xi"].values
    names = dict.fromkeys(bare["line"].values.tolist())
    here = {name: np.flatnonzero(bare["line"].values == name) for name in names}
    places = {name: place[nodes] for name, nodes in here.items()}
    if bare is result and scenario is not None and not _begins_at_rest(scenario):  # slack and weightless: the chord
        part = {name: (xi[nodes] / max(float(xi[nodes[-1]]), 1e-300))[:, None] for name, nodes in here.items()}
        chords = {n: places[n][:1] + part[n] * (places[n][-1:] - places[n][:1]) for n in names}
        places |= {n: chord for n, chord in chords.items() if n not in scenario.nets}
    if place.shape[1] < towards.size:  # a simpler model that knows nothing of what lies aside
        towards = towards[_IN_PLANE]
    return Level(towards, {name: xi[nodes] for name, nodes in here.items()}, places, paths)


def _begins_at_rest(scenario: Scenario) -> bool:
    run = scenario.run
    if isinstance(run, Dynamic):
        return run.start.kind == "rest" and not run.start.with_loads
    return isinstance(run, Linear)


def traces(
    result: xr.Dataset, scenario: Scenario, wheels: Mapping[str, tuple[str, ...]], level: Level
) -> dict[str, Trace]:
    """What the wheels of a result do.

    Args:
        result: of one model.
        scenario: the full one, which knows the line of each load and which of them are pantographs.
        wheels: names of the contacts of the result that stand for each wheel of the full scenario.
        level: where the lines rest.
    """
    found = {}
    for wheel, names in wheels.items():
        name, load = name_of(scenario, wheel), load_of(scenario, wheel)
        line = scenario.carrier_of(load)
        each = [k for k, name in enumerate(result["load"].values.tolist()) if name in names]
        if isinstance(load, Pantograph):
            limits = analysed_stations(scenario.overhead_lines[load.on])
            found[wheel] = _filtered(_sampled(result, each[0], line, level, name), *limits)
        elif has_samples(result) and len(each) == 1:
            found[wheel] = _sampled(result, each[0], line, level, name)
        elif each:
            found[wheel] = _together([_framed(result, k, line, level, name) for k in each])
    return found


def name_of(scenario: Scenario, wheel: str) -> str:
    """The name of the load that a wheel belongs to."""
    return wheel if wheel in scenario.loads else wheel.rsplit(".", 1)[0]


def load_of(scenario: Scenario, wheel: str) -> AnyLoad:
    """The load that a wheel belongs to."""
    return scenario.loads[name_of(scenario, wheel)]


def _framed(result: xr.Dataset, k: int, line: str, level: Level, load: str) -> Trace:
    """A contact of a load at the frames of a result."""
    of = {name: result[f"contact_{name}"].values[:, k] for name in ("xi", "position", "force", "tension", "speed")}
    hold = np.linalg.norm(np.nan_to_num(result["hold_force"].values[:, k]), axis=1)
    depth = (of["position"] - level.under(load, line, of["xi"])) @ level.towards
    return Trace(line, result[path_name(result)].values, of["xi"], depth, of["force"], hold, of["tension"], of["speed"])


def _sampled(result: xr.Dataset, k: int, line: str, level: Level, load: str) -> Trace:
    """A contact at the samples between the frames; what these do not hold is that of the frames."""
    flat, frames = samples(result), _framed(result, k, line, level, load)
    time, xi = flat["time"].values, flat["station"].values[:, k]
    if time.size < frames.time.size:
        return frames
    force = np.zeros((time.size, frames.force.shape[1]))
    force[:, -1] = flat["force"].values[:, k]
    at = np.clip(np.searchsorted(frames.time, time), 0, frames.time.size - 1)
    rest = level.under(load, line, xi)
    place = rest.copy()
    place[:, -1] = flat["height"].values[:, k]
    depth, others = (place - rest) @ level.towards, (frames.hold[at], frames.tension[at], frames.speed[at])
    return Trace(line, time, xi, depth, force, *others)


def _filtered(trace: Trace, low: float, high: float) -> Trace:
    """A pantograph where statistics of it are made, its force up to 20 Hz as in EN 50318."""
    force = trace.force.copy()
    interval = float(np.median(np.diff(trace.time)))
    force[:, -1] = filtered(np.where(np.isfinite(trace.xi), force[:, -1], np.nan), interval)
    on = (trace.xi >= low) & (trace.xi <= high)
    gone = np.where(on, 0.0, np.nan)
    return replace(trace, xi=trace.xi + gone, depth=trace.depth + gone, force=force + gone[:, None])


def _together(parts: list[Trace]) -> Trace:
    """Several contacts as one: at the place of their common force, and as deep as the line is there in the mean."""
    if len(parts) == 1:
        return parts[0]
    force = np.stack([np.nan_to_num(part.force) for part in parts])
    weight = np.linalg.norm(force, axis=2)
    total = weight.sum(axis=0)

    def mean(name: str) -> Array:
        values = np.stack([np.nan_to_num(getattr(part, name)) for part in parts])
        shaped = weight.reshape(weight.shape + (1,) * (values.ndim - 2))
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray((shaped * values).sum(axis=0) / total.reshape(total.shape + (1,) * (values.ndim - 2)))

    hold = np.stack([part.hold for part in parts]).max(axis=0)
    first, tension, speed = parts[0], mean("tension"), mean("speed")
    return Trace(first.line, first.time, mean("xi"), mean("depth"), force.sum(axis=0), hold, tension, speed)


@dataclass(frozen=True)
class Difference:
    """How far the deflection under a wheel is from that of the full scenario, where both have been."""

    xi: Array  # (place,) m
    full: Array  # (place,) deflection of the full scenario, m
    other: Array  # (place,) m

    @property
    def scale(self) -> float:
        """The largest deflection of the full scenario under the wheel, m."""
        return float(np.abs(self.full).max(initial=0.0))

    @property
    def local(self) -> Array:
        """Relative to what the full scenario has in the same place, with a floor."""
        return np.asarray(np.abs(self.other - self.full) / np.maximum(np.abs(self.full), FLOOR * (self.scale or 1.0)))

    @property
    def rms(self) -> float:
        """Relative to the largest deflection; every place counts alike."""
        way = np.abs(np.diff(self.xi))
        square = (self.other - self.full) ** 2
        mean = float(((square[1:] + square[:-1]) / 2.0 @ way) / way.sum()) if way.sum() > 0.0 else float(square.mean())
        return float(np.sqrt(mean)) / (self.scale or 1.0)

    @property
    def largest(self) -> float:
        """Relative to the largest deflection."""
        return float(np.abs(self.other - self.full).max()) / (self.scale or 1.0)


def difference(full: Trace, other: Trace, *, timed: bool) -> Difference | None:
    """Compare the deflections under a wheel in equal places; of a load that stands still, at equal times.

    Args:
        full: of the full scenario.
        other: of another model.
        timed: whether both count time.
    """
    at, by = full.path, other.path
    if not np.isfinite(at).any() or not np.isfinite(by).any():
        return None
    if np.nanmax(at) - np.nanmin(at) <= 1e-9 * max(abs(float(np.nanmax(at))), 1e-9):
        if not timed:
            return None
        at, by = np.where(np.isfinite(at), full.time, np.nan), np.where(np.isfinite(by), other.time, np.nan)
    at, here = _rising(at)
    by, there = _rising(by)
    slack = 1e-9 * (abs(at[-1]) + abs(at[0]))
    both = (at >= by[0] - slack) & (at <= by[-1] + slack)
    if both.sum() < 2 or by.size < 2:
        return None
    return Difference(full.xi[here][both], full.depth[here][both], np.interp(at[both], by, other.depth[there]))


def _rising(path: Array) -> tuple[Array, Integers]:
    """The values that exceed all before them, and their indices."""
    on = np.flatnonzero(np.isfinite(path))
    values, first = np.unique(path[on], return_index=True)
    return values, on[first]
