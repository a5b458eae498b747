"""A result file as arrays: what it says of itself is what its dataset says, without what takes long to import."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import travelling_wave as wave

from ropewalk.model import Scenario
from ropewalk.results import Recorder, RunInfo, open_result, summary
from ropewalk.results.arrays import open_arrays

EXAMPLE = Path(__file__).parents[2] / "examples" / "moving-force.yaml"
LINES = {"line": {"start": (0, 0), "end": (10, 0), "tension": 1e3, "mass": 1, "axial_stiffness": 1e5, "elements": 4}}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    scenario = Scenario.model_validate({"lines": LINES, "loads": {}, "run": {"kind": "dynamic", "until": 1.0}})
    plan, path = wave.layout(), tmp_path / "one.nc"
    run_info = RunInfo(method="rkn6", reason="undamped", step=1e-3, steps=181, wall_seconds=0.5, cpu_seconds=0.4)
    with Recorder(plan, scenario, run_info, path) as recorder:
        for frame in wave.frames(plan, np.linspace(0.0, 1.8, 61)):
            recorder.append(frame)
    return path


def test_arrays_are_those_of_the_dataset(file: Path) -> None:
    with open_arrays(file) as arrays, open_result(file) as dataset:
        assert dict(arrays.sizes) == dict(dataset.sizes)
        assert arrays.attrs == dataset.attrs
        assert set(arrays.coords) == set(dataset.coords)
        assert set(arrays.data_vars) == set(dataset.data_vars)
        for name in dataset.variables:
            np.testing.assert_array_equal(arrays[name].values, dataset[name].values)
            assert arrays[name].dims == dataset[name].dims
            assert {**arrays[name].attrs} == {key: dataset[name].attrs[key] for key in arrays[name].attrs}
            assert arrays[name].values.dtype == dataset[name].values.dtype


@pytest.mark.parametrize("key", [3, slice(2, 9), (slice(None), 1), (4, slice(1, 3), 0), np.array([5, 2])])
def test_a_part_is_that_of_the_dataset(file: Path, key: object) -> None:
    with open_arrays(file) as arrays, open_result(file) as dataset:
        own, whole = arrays["position"][key], dataset["position"][key]
        np.testing.assert_array_equal(own.values, whole.values)
        assert own.dims == whole.dims


def test_a_part_by_names_is_that_of_the_dataset(file: Path) -> None:
    at = {"time": slice(5, 9), "node": [1, 3], "axis": 0}
    with open_arrays(file) as arrays, open_result(file) as dataset:
        own, whole = arrays["position"].isel(**at), dataset["position"].isel(**at)
        np.testing.assert_array_equal(own.values, whole.values)
        assert own.dims == whole.dims


def test_the_summary_is_that_of_the_dataset(file: Path) -> None:
    with open_arrays(file) as arrays, open_result(file) as dataset:
        assert summary(arrays) == summary(dataset)


def test_what_only_xarray_knows_is_asked_of_the_dataset(file: Path) -> None:
    with open_arrays(file) as arrays, open_result(file) as dataset:
        assert float(arrays["tension"].isel(link=0).max("time")) == float(dataset["tension"].isel(link=0).max("time"))
        assert arrays.isel(time=3).identical(dataset.isel(time=3))


def test_a_run_imports_no_xarray(tmp_path: Path) -> None:
    code = (
        "import sys\n"
        f"sys.argv = ['ropewalk', 'run', {str(EXAMPLE)!r}, '--set', 'run.until=0.02 s', '-o', 'one.nc']\n"
        "from ropewalk.__main__ import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code\n"
        "heavy = {'xarray', 'pandas', 'dask', 'pint', 'scipy.sparse', 'scipy.optimize', 'matplotlib'}\n"
        "print(sorted(heavy & sys.modules.keys()))\n"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path)
    assert found.stdout.splitlines()[-1] == "[]"
