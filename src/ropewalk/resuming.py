"""Runs that go on from where their result file ends: interrupted, killed, or complete and to be longer."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import ropewalk
from ropewalk.checkpoint import ENGINE_NUMBER, CheckpointError
from ropewalk.errors import ScenarioError
from ropewalk.model.history import SpeedTable
from ropewalk.model.pantograph import Pantograph
from ropewalk.model.run import Dynamic, every_of
from ropewalk.model.scenario import Scenario
from ropewalk.results.contract import CONVENTIONS, LACKING
from ropewalk.results.files import ResultError, alone, open_result
from ropewalk.results.frame import Array, RunInfo
from ropewalk.results.slots import Past, digests
from ropewalk.scenario import loads
from ropewalk.simulate import Clock, output_times, record, run_of

if TYPE_CHECKING:
    import xarray as xr

_ENDED = ("completed", "doubtful")
_CUT_SHORT = ("running", "interrupted", "failed")
_SAME = 1e-6  # of the interval of output, by which instants that are meant to be the same differ


def resume(
    path: str | Path, until: float | None = None, *, progress: Callable[[float], None] | None = None
) -> xr.Dataset:
    """Go on with a run from the last checkpoint in its result file, and write on in that file.

    What comes is to the last bit what comes of a run that was never interrupted.

    Args:
        path: the result file of a motion that was interrupted or killed, or is to be longer than it was.
        until: new end of the run in s (default: the end that its scenario says).
        progress: called with the part that is done, 0 to 1.

    Returns:
        The result, as from `simulate`.

    Raises:
        ResultError: it cannot be resumed; the file is left as it is.
        RopewalkError: an external model cannot be put to work, or the file cannot be written.
    """
    with taken_up(Path(path), until) as rest:
        return rest.run(progress)


@dataclass(frozen=True)
class Remainder:
    """What is still to be computed of a run."""

    past: Past
    scenario: Scenario
    times: Array  # s, all output instants

    @property
    def begin(self) -> float:
        """The instant of the last frame that need not be computed again, s."""
        return float(self.times[max(self.past.count - 1, 0)])

    def run(
        self, progress: Callable[[float], None] | None = None, opened: Callable[[Path], xr.Dataset] = open_result
    ) -> xr.Dataset:
        """Compute it.

        Args:
            progress: called with the part that is done.
            opened: what opens the file at the end.
        """
        from ropewalk.results.recorder import Recorder

        past, run_info = self.past, RunInfo()
        assert past.checkpoint is not None
        spent = (float(s) if isfinite(s) else 0.0 for s in past.checkpoint["seconds"])
        watch = Clock(*spent)
        try:
            run = run_of(self.scenario, run_info, self.times, past.checkpoint["run"])
        except (CheckpointError, TypeError, ValueError, LookupError, AttributeError) as problem:
            raise ResultError(f"{past.path}: its checkpoint does not fit its scenario ({problem})") from problem
        with Recorder(run.layout, self.scenario, run_info, past.path, run=run, past=past, opened=opened) as recorder:
            return record(run, recorder, run_info, watch, progress)


@contextmanager
def taken_up(path: Path, until: float | None) -> Iterator[Remainder]:
    """Look into a result file and keep it to oneself: what is there to be computed?

    Raises:
        ResultError: nothing, or it cannot be done.
    """
    if not os.path.isfile(path):
        raise ResultError(f"{path}: there is no such file")
    if not os.access(path, os.R_OK | os.W_OK):
        raise ResultError(f"{path}: no permission to read and write it")
    with alone(path):
        past = Past.of(path)
        scenario = _checked(past)
        run = scenario.run
        assert isinstance(run, Dynamic)
        complete = past.attributes["outcome"] in _ENDED
        if complete and until is None:
            raise ResultError(f"{path}: is complete up to {run.until:g} s; give --until with a later time to continue")
        if until is not None and not (run.until < until or (until == run.until and not complete)):
            raise ResultError(f"{path}: covers {run.until:g} s; give --until with a later time, not {until:g} s")
        if until is not None and until != run.until:
            _refuse_histories(past, scenario)
            scenario = _longer(past, run, float(until))
        yield Remainder(past, scenario, _instants(scenario, past.times))


def _checked(past: Past) -> Scenario:
    """The scenario of a run that may go on.

    Raises:
        ResultError: why it may not.
    """
    path, metadata = past.path, past.attributes
    if metadata.get("Conventions") != CONVENTIONS:
        raise ResultError(f"{path}: no result of ropewalk (attribute Conventions is not {CONVENTIONS})")
    text = str(metadata.get("scenario", ""))
    try:
        tree = json.loads(text)
        kind = tree["run"]["kind"]
    except (ValueError, TypeError, KeyError) as problem:
        raise ResultError(f"{path}: its scenario cannot be read") from problem
    if kind != "dynamic":
        raise ResultError(f"{path}: a run of kind {kind} cannot be resumed; run it again")
    _refuse_other_engine(past)
    version = metadata.get("ropewalk_version")
    if version != ropewalk.__version__:
        raise ResultError(f"{path}: was written by ropewalk {version}, this is {ropewalk.__version__}; run it again")
    if metadata.get("scenario_sha256") != hashlib.sha256(text.encode()).hexdigest():
        raise ResultError(f"{path}: its scenario was changed after the run (digests differ); run it again")
    if (named := _named_only(tree)) is not None:
        raise ResultError(f"{path}: {named} is a function or an object of Python, which no file holds; run it again")
    outcome = metadata.get("outcome")
    if outcome not in (*_ENDED, *_CUT_SHORT):
        raise ResultError(f"{path}: the run stopped by itself ({outcome}), it cannot be resumed")
    if past.checkpoint is None:
        why = f": {metadata[LACKING]}" if LACKING in metadata else "; run it again"
        raise ResultError(f"{path}: has no checkpoint to continue from{why}")
    try:
        scenario = loads(text, f"{path}.json")
    except ScenarioError as problem:
        raise ResultError(f"{path}: its scenario cannot be run any more: {problem}") from problem
    scenario.__dict__["source_text"] = str(metadata.get("scenario_file", ""))
    was, now = past.checkpoint["data"], digests(scenario)
    for key in {**was, **now}:
        if was.get(key) != now.get(key):
            raise ResultError(f"{path}: the file that {key} names was deleted or changed; run it again")
    return scenario


def _refuse_other_engine(past: Past) -> None:
    """Refuse a file whose result or checkpoint was computed by another engine.

    Raises:
        ResultError: with both engine numbers.
    """
    numbers = {"result": past.attributes.get("engine_number")}
    if past.checkpoint is not None:
        numbers["checkpoint"] = past.checkpoint.get("engine_number")
    for part, number in numbers.items():
        if number != ENGINE_NUMBER:
            written = "an older version, without an engine number" if number is None else f"engine {number}"
            raise ResultError(
                f"{past.path}: the {part} was computed by {written}; this version has engine {ENGINE_NUMBER} and "
                "cannot continue it. Run the scenario again from the start"
            )


def _longer(past: Past, run: Dynamic, until: float) -> Scenario:
    """Return the scenario with a later end in s.

    Raises:
        ResultError: such a run is refused.
    """
    settings = [f"run.until={until!r} s", f"run.every={min(every_of(run), run.until)!r} s"]
    try:
        return loads(str(past.attributes["scenario"]), f"{past.path}.json", settings)
    except ScenarioError as problem:
        raise ResultError(f"{past.path}: cannot be continued until {until:g} s: {problem}") from problem


def _named_only(tree: Any, where: str = "") -> str | None:
    """The key of what a scenario in a file names, but does not hold; None if there is nothing."""
    if isinstance(tree, str):
        return where if tree.startswith("<") and tree.endswith(">") and where != "title" else None
    inner = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    found = (_named_only(value, f"{where}.{key}".lstrip(".")) for key, value in inner)
    return next((each for each in found if each is not None), None)


def _refuse_histories(past: Past, scenario: Scenario) -> None:
    """Refuse a later end where what has been goes by the end: a mean force that is wanted while the speed changes."""
    for name, load in scenario.loads.items():
        if isinstance(load, Pantograph) and load.wanted_mean is not None:
            speed = load.travel.speed
            if isinstance(speed, SpeedTable) and len(set(speed.value)) > 1:
                raise ResultError(
                    f"{past.path}: load {name} has a mean force at variable speed, which depends on the end of the "
                    "run: run it again"
                )


def _instants(scenario: Scenario, stored: Array) -> Array:
    """Output instants in s: those that are asked for, and those that have been an earlier end of the run."""
    assert isinstance(scenario.run, Dynamic)
    times, near = output_times(scenario.run), _SAME * every_of(scenario.run)
    own = [t for t in stored if t - times[np.searchsorted(times, t + near, side="right") - 1] > near]
    return np.sort(np.concatenate([times, own]))
