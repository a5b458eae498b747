"""The model hierarchy: every simpler model is run and measured against the full one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.compare.assumptions import assumptions_of
from ropewalk.compare.constant import ConstantForces, wheels_in
from ropewalk.compare.quantities import QUANTITIES, errors_of, quantities_of, ways_of, weight_of
from ropewalk.compare.result import LevelResult, ModelHierarchy
from ropewalk.compare.simpler_models import FULL, LINEAR, MODELS, FullModel, SimplerModel, top_of
from ropewalk.compare.stretches import Reach, reach_of
from ropewalk.compare.trace import Level, level_of, load_of, pressed, traces
from ropewalk.compare.verdict import TOLERANCE, thresholds
from ropewalk.decouple import is_force
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
"""Called with the name of the model under way and the part of it that is done, 0 to 1."""


def model_hierarchy(
    scenario: Scenario,
    *,
    tolerance: float = TOLERANCE,
    tolerances: Mapping[str, float] | None = None,
    progress: Progress | None = None,
) -> ModelHierarchy:
    """Compare simpler models, from the linear theory upwards, with full feedback, and say which is good enough.

    Args:
        scenario: with loads; in time, linear or slow.
        tolerance: allowed relative distance from the full scenario, of every quantity.
        tolerances: the same of single quantities, by name (see QUANTITIES).
        progress: called with the model under way and the part of it that is done.

    Raises:
        ScenarioError: there is nothing to compare, or a tolerance is none.
        RopewalkError: the full scenario cannot be run.
    """
    allowed = thresholds(tolerance, tolerances)
    full_model, full, level = _full(scenario, progress)
    local = allowed["path"]
    steps = {name: full if name == FULL else _step(full_model, full, level, name, local, progress) for name in MODELS}
    top = full_model.top
    assert full.result is not None
    measured = assumptions_of(top, full.result, level, full.traces, _static(full_model), _linear(steps))
    return ModelHierarchy(top.title, allowed, steps, measured)


def distances(
    scenario: Scenario, models: Iterable[str] | None = None, *, tolerance: float = TOLERANCE
) -> dict[str, dict[str, float | None]]:
    """Relative distances of simpler models from the full scenario, and no more; only these and the full one are run.

    Args:
        scenario: as for `model_hierarchy`.
        models: names out of MODELS; None means all.
        tolerance: local error of the deflection under the load from which on a place counts for `share beyond`.

    Returns:
        For each model and each of QUANTITIES the distance, None where there is nothing to compare; and as
        `share beyond` the part of the way of the load on which the model is further off than the tolerance. All are
        None of a model that cannot be run, or not to its end, or is doubtful.

    Raises:
        ScenarioError: there is nothing to compare, a model is not known, or the tolerance is none.
        RopewalkError: the full scenario cannot be run, or is doubtful.
    """
    allowed = thresholds(tolerance)
    wanted = list(MODELS if models is None else models)
    for name in wanted:
        if name not in MODELS:
            raise ScenarioError([Problem("models", "no such model", repr(name), did_you_mean(str(name), MODELS))])
    full_model, full, level = _full(scenario, None)
    if full.doubts:
        raise RopewalkError(f"the full scenario is doubtful: {'; '.join(full.doubts)}")
    steps = {FULL: full}

    def step(name: str) -> LevelResult:
        if name not in steps:
            steps[name] = _step(full_model, full, level, name, allowed["path"], None)
        return step(steps[name].same_as) if steps[name].same_as else steps[name]

    found = {}
    for name in wanted:
        here = step(name)
        share = max((reach.share for reach in here.reach.values()), default=0.0 if here is full else None)
        errors = {**dict.fromkeys(QUANTITIES), **here.errors, "share beyond": share}
        broken = bool(here.reason or here.doubts) and here is not full
        found[name] = dict.fromkeys(errors) if broken else errors
    return found


def _full(scenario: Scenario, progress: Progress | None) -> tuple[FullModel, LevelResult, Level]:
    """Run the full scenario, which all others are measured against."""
    model = top_of(scenario)
    top = model.scenario
    assert top is not None
    result = _run(model, top, progress)
    path = result[path_name(result)].values
    if path.size < 2:
        text = f"{result.attrs['outcome']}: {result.attrs['advice']}"
        raise RopewalkError(f"the full scenario breaks off at once ({text}): there is nothing to compare with")
    towards = pressed(result)
    level = level_of(top, result, towards)
    wheels = wheels_in(top, result["load"].values.tolist())
    found = traces(result, top, wheels, level)
    if not any(np.isfinite(trace.xi).any() for trace in found.values()):
        raise RopewalkError("no load is on its line during the run: there is nothing to compare")
    full_model = FullModel(scenario, model, result, found)
    speeds = full_model.finds_speed(model)
    quantities = quantities_of(result, level, found, _limits(top), speeds=speeds)
    nothing = errors_of(quantities, quantities, ways_of(found, found, timed=True), weight_of(found))
    reason = ""
    if result.attrs["outcome"] not in ("completed", "doubtful"):
        reason = f"stopped early, and compared up to there ({result.attrs['outcome']}: {result.attrs['advice']})"
    step = LevelResult(
        FULL, quantities, nothing, 0.0, result=result, traces=found, remark=model.remark, reason=reason,
        doubts=doubts_of(result),
    )  # fmt: skip
    return full_model, step, level


def _step(
    full_model: FullModel, full: LevelResult, level: Level, name: str, tolerance: float, progress: Progress | None
) -> LevelResult:
    """Run a model and measure it."""
    model = full_model.simpler_model(name)
    if model.same_as or model.reason:
        if progress is not None:
            progress(name, 1.0)
        return LevelResult(name, same_as=model.same_as, remark=model.remark, reason=model.reason)
    try:
        assert model.scenario is not None
        result = _run(model, full_model.top, progress)
        own = _own_level(model, result, level)
        found = traces(result, full_model.top, model.wheels, own)
        quantities = quantities_of(result, own, found, _limits(full_model.top), speeds=full_model.finds_speed(model))
        if name == LINEAR:
            quantities = quantities.without_supports(_beams(full_model.top))
    except RopewalkError as error:
        return LevelResult(name, remark=model.remark, reason=" ".join(str(error).split()))
    assert full.quantities is not None
    timed = path_name(result) == path_name(full_model.result) == "time"
    ways = ways_of(full.traces, found, timed=timed)
    reach = {wheel: reach_of(way, tolerance) for wheel, way in ways.items() if way.scale > 0.0}
    errors = errors_of(full.quantities, quantities, ways, weight_of(full.traces))
    rms = max((way.rms for way in ways.values() if way.scale > 0.0), default=None)
    outcome, reason = result.attrs["outcome"], ""
    if outcome not in ("completed", "doubtful"):
        reason = f"{outcome}: {result.attrs['advice']}"
    return LevelResult(
        name, quantities, errors, rms, reach, result, found, ways, remark=model.remark, reason=reason,
        doubts=doubts_of(result),
    )  # fmt: skip


def _run(model: SimplerModel, top: Scenario, progress: Progress | None) -> xr.Dataset:
    def text(done: float) -> None:
        if progress is not None:
            progress(model.name, done)

    assert model.scenario is not None
    result = simulate(model.scenario, progress=text) if model.task is None else _on_wires(model, text)
    text(1.0)
    return result


def _on_wires(model: SimplerModel, progress: Callable[[float], None]) -> xr.Dataset:
    """The result of a task on wires, which no scenario says."""
    from ropewalk.results.recorder import Recorder
    from ropewalk.results.running import TimeHistory
    from ropewalk.wires.frames import Wires  # lazy: most runs do not need their kernels

    scenario, run_info = model.scenario, RunInfo()
    assert scenario is not None
    assert model.task is not None
    run = scenario.run
    assert isinstance(run, Dynamic)
    times = output_times(run)
    found = TimeHistory(Wires(model.task, times, run_info, run.sample, run.step), run_info)
    with Recorder(found.layout, scenario, run_info, None) as recorder:
        for frames in found.blocks():
            recorder.extend(frames)
            progress(min(recorder.frames / times.size, 1.0))
        return recorder.close()


def _own_level(model: SimplerModel, result: xr.Dataset, level: Level) -> Level:
    """Where a model rests: the linear theory knows another shape under the weight of a line than the full geometry."""
    if model.name == LINEAR:
        return level_of(None, result, level.towards, level.paths)
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


def _static(full_model: FullModel) -> dict[str, float | None]:
    """Force of each wheel at rest, N; None of given forces; of what is pressed from below, its mean."""
    found: dict[str, float | None] = {}
    for wheel in full_model.found:
        if is_force(load_of(full_model.top, wheel)):
            found[wheel] = None
            continue
        try:
            forces, names = ConstantForces(
                full_model.top, {wheel: full_model.found[wheel], **full_model.found}
            ).forces()
            force = getattr(forces[names[wheel][0]], "force", None)
            found[wheel] = float(np.linalg.norm(force)) if isinstance(force, tuple) else None
        except RopewalkError:
            found[wheel] = float(np.nanmean(full_model.found[wheel].size))
    return found


def _linear(steps: Mapping[str, LevelResult]) -> dict[str, Reach]:
    step = steps[LINEAR]
    return steps[step.same_as].reach if step.same_as else step.reach
