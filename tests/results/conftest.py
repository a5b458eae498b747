"""Results made without a solver, for all tests of this folder."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
import xarray as xr

sys.path.insert(0, str(Path(__file__).parent))

import travelling_wave as wave

from ropewalk.results import Recorder


def record(plan=None, *, file=None, times=None, run_info=None) -> xr.Dataset:
    plan = plan or wave.layout()
    with Recorder(plan, wave.scenario(), run_info or wave.run_info(), file) as recorder:
        for frame in wave.frames(plan, times):
            recorder.append(frame)
    return recorder.close()


@pytest.fixture(scope="session")
def result() -> xr.Dataset:
    return record()


@pytest.fixture(scope="session")
def make():
    return record
