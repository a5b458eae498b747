"""A run that is taken up again gives to the last bit what one gives that was never interrupted."""

from __future__ import annotations

import shutil
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr
from resume_cases import KINDS, case

import ropewalk
from ropewalk.model import Scenario
from ropewalk.results import ResultError, recorder, slots
from ropewalk.simulate import output_times

SPENT = ("cpu_seconds", "wall_seconds")


@pytest.fixture
def at_once(monkeypatch):
    """Every frame is synchronised, with a checkpoint."""
    monkeypatch.setattr(recorder, "SYNC_SECONDS", 0.0)
    monkeypatch.setattr(slots, "SECONDS", 0.0)
    monkeypatch.setattr(slots, "SHARE", np.inf)


def killed(scenario: Scenario, file: Path, after: tuple[int, ...]) -> xr.Dataset:
    """Run a scenario; copies of the file are left as it was after some of the frames: as if it had been killed then."""
    total = output_times(scenario.run).size

    def progress(part: float) -> None:
        count = round(part * total)
        if count in after:
            shutil.copy(file, file.with_suffix(f".{count}.nc"))

    return ropewalk.simulate(scenario, file=file, progress=progress)


def assert_same(one: xr.Dataset, other: xr.Dataset, frames: int | None = None) -> None:
    assert set(one.variables) == set(other.variables)
    for name in one.variables:
        a, b = (np.asarray(each[name].values) for each in (one, other))
        if frames is not None and one[name].dims[:1] == ("time",):
            a, b = a[:frames], b[:frames]
        assert a.dtype == b.dtype
        assert np.array_equal(a, b, equal_nan=a.dtype.kind == "f"), name
    if frames is None:
        assert {k: v for k, v in one.attrs.items() if k not in SPENT} == {
            k: v for k, v in other.attrs.items() if k not in SPENT
        }


@pytest.mark.parametrize("kind", KINDS)
def test_what_comes_is_to_the_last_bit_what_would_have_come(kind, tmp_path, at_once):
    scenario, file = case(kind), tmp_path / "out.nc"
    total = output_times(scenario.run).size
    instants = (1, 2, total // 2, total - 1, total)
    whole = killed(scenario, file, instants)
    assert whole.sizes["time"] == total
    for count in instants:
        assert_same(whole, ropewalk.resume(tmp_path / f"out.{count}.nc"))


@pytest.mark.parametrize("kind", [kind for kind in KINDS if "pantograph" not in kind])
def test_a_complete_run_may_be_longer(kind, tmp_path):
    short, long = case(kind), case(kind)
    run = long.run
    every = run.every
    short = short.model_copy(update={"run": run.model_copy(update={"until": 6.0 * every})})
    ropewalk.simulate(short, file=tmp_path / "short.nc")
    found = ropewalk.resume(tmp_path / "short.nc", run.until)
    assert_same(ropewalk.simulate(long, file=tmp_path / "long.nc"), found)
