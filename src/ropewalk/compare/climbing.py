"""Climbing the ladder: every rung is run and measured against the full one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.compare.assumptions import assumptions_of
from ropewalk.compare.constant import ConstantForces, is_force, wheels_in
from ropewalk.compare.quantities import QUANTITIES, errors_of, quantities_of, ways_of, weight_of
from ropewalk.compare.result import Ladder, LevelResult
from ropewalk.compare.rungs import FULL, LINEAR, RUNGS, Climb, Rung, top_of
from ropewalk.compare.stretches import Reach, reach_of
from ropewalk.compare.trace import Level, level_of, load_of, pressed, traces
from ropewalk.compare.verdict import TOLERANCE, thresholds
from ropewalk.errors import Problem, RopewalkError, ScenarioError, did_you_mean
from ropewalk.model.overhead import CONTACT_WIRE
from ropewalk.model.run import Dynamic
from ropewalk.model.scenario import Scenario
from ropewalk.results.contact_statistics import analysed_stations
from ropewalk.results.contract import doubts_of, path_name
from ropewalk.results.frame import RunInfo
from ropewalk.simulate import output_times, simulate

if TYPE_CHECKING:
    import xarray as xr

Progress = Callable[[str, float], None]
"""Called with the name of the rung under way and the part of it that is done, 0 to 1."""


def ladder(
    scenario: Scenario,
    *,
    tolerance: float = TOLERANCE,
    tolerances: Mapping[str, float] | None = None,
    progress: Progress | None = None,
) -> Ladder:
    """Let a scenario climb the ladder, from the linear theory to full feedback, and say which rung is good enough.

    Args:
        scenario: with loads; in time, linear or slow.
        tolerance: allowed relative distance from the full scenario, of every quantity.
        tolerances: the same of single quantities, by name (see QUANTITIES).
        progress: called with the rung under way and the part of it that is done.

    Raises:
        ScenarioError: there is nothing to compare, or a tolerance is none.
        RopewalkError: the full scenario cannot be run.
    """
    allowed = thresholds(tolerance, tolerances)
    climb, full, level = _full(scenario, progress)
    local = allowed["path"]
    steps = {name: full if name == FULL else _step(climb, full, level, name, local, progress) for name in RUNGS}
    top = climb.top
    assert full.result is not None
    measured = assumptions_of(top, full.result, level, full.traces, _static(climb), _linear(steps))
    return Ladder(top.title, allowed, steps, measured)


def distances(
    scenario: Scenario, rungs: Iterable[str] | None = None, *, tolerance: float = TOLERANCE
) -> dict[str, dict[str, float | None]]:
    """Relative distances of rungs from the full scenario, without the rest; only these and the full one are run.

    Args:
        scenario: as for `ladder`.
        rungs: names out of RUNGS; None means all.
        tolerance: local error of the deflection under the load from which on a place counts for `share beyond`.

    Returns:
        For each rung and each of QUANTITIES the distance, None where there is nothing to compare; and as `share beyond`
        the part of the way of the load on which the rung is further off than the tolerance. All are None of a rung that
        cannot be run, or not to its end, or is doubtful.

    Raises:
        ScenarioError: there is nothing to compare, a rung is not known, or the tolerance is none.
        RopewalkError: the full scenario cannot be run, or is doubtful.
    """
    allowed = thresholds(tolerance)
    wanted = list(RUNGS if rungs is None else rungs)
    for name in wanted:
        if name not in RUNGS:
            raise ScenarioError([Problem("rungs", "no such rung", repr(name), did_you_mean(str(name), RUNGS))])
    climb, full, level = _full(scenario, None)
    if full.doubts:
        raise RopewalkError(f"the full scenario is doubtful: {'; '.join(full.doubts)}")
    steps = {FULL: full}

    def step(name: str) -> LevelResult:
        if name not in steps:
            steps[name] = _step(climb, full, level, name, allowed["path"], None)
        return step(steps[name].same_as) if steps[name].same_as else steps[name]

    found = {}
    for name in wanted:
        here = step(name)
        share = max((reach.share for reach in here.reach.values()), default=0.0 if here is full else None)
        errors = {**dict.fromkeys(QUANTITIES), **here.errors, "share beyond": share}
        broken = bool(here.reason or here.doubts) and here is not full
        found[name] = dict.fromkeys(errors) if broken else errors
    return found


def _full(scenario: Scenario, progress: Progress | None) -> tuple[Climb, LevelResult, Level]:
    """Run the full scenario, which all others are measured against."""
    rung = top_of(scenario)
    top = rung.scenario
    assert top is not None
    result = _run(rung, top, progress)
    path = result[path_name(result)].values
    if path.size < 2:
        told = f"{result.attrs['outcome']}: {result.attrs['advice']}"
        raise RopewalkError(f"the full scenario breaks off at once ({told}): there is nothing to compare with")
    towards = pressed(result)
    level = level_of(top, result, towards)
    wheels = wheels_in(top, result["load"].values.tolist())
    found = traces(result, top, wheels, level)
    if not any(np.isfinite(trace.xi).any() for trace in found.values()):
        raise RopewalkError("no load is on its line during the run: there is nothing to compare")
    climb = Climb(scenario, rung, result, found)
    speeds = climb.finds_speed(rung)
    quantities = quantities_of(result, level, found, _limits(top), speeds=speeds)
    nothing = errors_of(quantities, quantities, ways_of(found, found, timed=True), weight_of(found))
    reason = ""
    if result.attrs["outcome"] not in ("completed", "doubtful"):
        reason = f"stopped early, and compared up to there ({result.attrs['outcome']}: {result.attrs['advice']})"
    step = LevelResult(
        FULL, quantities, nothing, 0.0, result=result, traces=found, remark=rung.remark, reason=reason,
        doubts=doubts_of(result),
    )  # fmt: skip
    return climb, step, level


def _step(
    climb: Climb, full: LevelResult, level: Level, name: str, tolerance: float, progress: Progress | None
) -> LevelResult:
    """Run a rung and measure it."""
    rung = climb.rung(name)
    if rung.same_as or rung.reason:
        if progress is not None:
            progress(name, 1.0)
        return LevelResult(name, same_as=rung.same_as, remark=rung.remark, reason=rung.reason)
    try:
        assert rung.scenario is not None
        result = _run(rung, climb.top, progress)
        own = _own_level(rung, result, level)
        found = traces(result, climb.top, rung.wheels, own)
        quantities = quantities_of(result, own, found, _limits(climb.top), speeds=climb.finds_speed(rung))
        if name == LINEAR:
            quantities = quantities.without_supports(_beams(climb.top))
    except RopewalkError as error:
        return LevelResult(name, remark=rung.remark, reason=" ".join(str(error).split()))
    assert full.quantities is not None
    timed = path_name(result) == path_name(climb.result) == "time"
    ways = ways_of(full.traces, found, timed=timed)
    reach = {wheel: reach_of(way, tolerance) for wheel, way in ways.items() if way.scale > 0.0}
    errors = errors_of(full.quantities, quantities, ways, weight_of(full.traces))
    rms = max((way.rms for way in ways.values() if way.scale > 0.0), default=None)
    outcome, reason = result.attrs["outcome"], ""
    if outcome not in ("completed", "doubtful"):
        reason = f"{outcome}: {result.attrs['advice']}"
    return LevelResult(
        name, quantities, errors, rms, reach, result, found, ways, remark=rung.remark, reason=reason,
        doubts=doubts_of(result),
    )  # fmt: skip


def _run(rung: Rung, top: Scenario, progress: Progress | None) -> xr.Dataset:
    def told(done: float) -> None:
        if progress is not None:
            progress(rung.name, done)

    assert rung.scenario is not None
    result = simulate(rung.scenario, progress=told) if rung.task is None else _on_wires(rung, told)
    told(1.0)
    return result


def _on_wires(rung: Rung, progress: Callable[[float], None]) -> xr.Dataset:
    """The result of a task on wires, which no scenario says."""
    from ropewalk.results.recorder import Recorder
    from ropewalk.results.running import TimeHistory
    from ropewalk.wires.frames import Wires  # lazy: most runs do not need their kernels

    scenario, run_info = rung.scenario, RunInfo()
    assert scenario is not None
    assert rung.task is not None
    run = scenario.run
    assert isinstance(run, Dynamic)
    times = output_times(run)
    found = TimeHistory(Wires(rung.task, times, run_info, run.sample, run.step), run_info)
    with Recorder(found.layout, scenario, run_info, None) as recorder:
        for frames in found.blocks():
            recorder.extend(frames)
            progress(min(recorder.frames / times.size, 1.0))
        return recorder.close()


def _own_level(rung: Rung, result: xr.Dataset, level: Level) -> Level:
    """Where a rung rests: the linear theory knows another shape under the weight of a line than the full geometry."""
    if rung.name == LINEAR:
        return level_of(None, result, level.towards)
    return level


def _beams(scenario: Scenario) -> tuple[str, ...]:
    """Supports of lines whose shear forces the linear theory here does not tell."""
    stiff = [name for name, line in scenario.lines.items() if line.bending_stiffness]
    return tuple(f"{name}.{end}" for name in stiff for end in ("start", "end"))


def _limits(scenario: Scenario) -> dict[str, tuple[float, float]]:
    """Where deflections of overhead lines count: where statistics are made."""
    return {
        f"{name}.{CONTACT_WIRE}": analysed_stations(line) for name, line in scenario.overhead_lines.items()
    }  # fmt: skip


def _static(climb: Climb) -> dict[str, float | None]:
    """Force of each wheel at rest, N; None of given forces; of what is pressed from below, its mean."""
    found: dict[str, float | None] = {}
    for wheel in climb.found:
        if is_force(load_of(climb.top, wheel)):
            found[wheel] = None
            continue
        try:
            forces, names = ConstantForces(climb.top, {wheel: climb.found[wheel], **climb.found}).forces()
            force = forces[names[wheel][0]].force
            found[wheel] = float(np.linalg.norm(force)) if isinstance(force, tuple) else None
        except RopewalkError:
            found[wheel] = float(np.nanmean(climb.found[wheel].size))
    return found


def _linear(steps: Mapping[str, LevelResult]) -> dict[str, Reach]:
    step = steps[LINEAR]
    return steps[step.same_as].reach if step.same_as else step.reach
