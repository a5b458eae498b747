"""A run that is taken up again gives to the last bit what one gives that was never interrupted."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr
from typer.testing import CliRunner

import ropewalk
from resume_cases import KINDS, case
from ropewalk.cli.app import app
from ropewalk.model import Scenario
from ropewalk.results import ResultError, frames, open_result, recorder, slots
from ropewalk.results.checksums import CHECKED, FRAMES, HEAD, NONE
from ropewalk.results.slots import Past
from ropewalk.simulate import output_times

SPENT = ("cpu_seconds", "wall_seconds", "compile_seconds")


@pytest.fixture
def at_once(monkeypatch):
    """No frame waits for others, and every one is synchronised, with a checkpoint."""
    monkeypatch.setattr(frames, "WAIT", 0.0)
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


@pytest.fixture(scope="module")
def wholes() -> dict[str, xr.Dataset]:
    """Runs that were not interrupted, by their kinds."""
    return {}


@pytest.mark.parametrize("kind", KINDS)
def test_what_comes_is_to_the_last_bit_what_would_have_come(kind, tmp_path, at_once, wholes):
    """From its begin, from its middle and from its end; from either place of checkpoints."""
    scenario, file = case(kind), tmp_path / "out.nc"
    total = output_times(scenario.run).size
    instants = (1, total // 4 * 2, total)
    whole = killed(scenario, file, instants)
    wholes[kind] = whole.load()
    assert whole.sizes["time"] == total
    for count in instants:
        assert_same(whole, ropewalk.resume(tmp_path / f"out.{count}.nc"))


@pytest.mark.parametrize("kind", KINDS)
def test_a_complete_run_may_be_longer(kind, tmp_path, wholes):
    long = case(kind)
    run = long.run
    short = long.model_copy(update={"run": run.model_copy(update={"until": 6.0 * run.every})})
    ropewalk.simulate(short, file=tmp_path / "short.nc")
    whole = wholes[kind].copy() if kind in wholes else ropewalk.simulate(long, file=tmp_path / "long.nc")
    found = ropewalk.resume(tmp_path / "short.nc", run.until)
    # Why the method was chosen tells the length of the run, and so does an implicit step.
    for message in (whole, found):
        message.attrs["reason"] = message.attrs["reason"].partition(":")[0]
        message.attrs["step"] = min(message.attrs["step"], run.every)
        message.attrs.pop("scenario_file", None)  # another end is not as it was written
    assert_same(whole, found)


@pytest.mark.parametrize("kind", ["force", "mass", "coach on a beam", "net"])
def test_an_end_between_two_outputs_stays_in_a_longer_run(kind, tmp_path):
    long = case(kind)
    run = long.run
    short = long.model_copy(update={"run": run.model_copy(update={"until": 4.4 * run.every})})
    first = ropewalk.simulate(short, file=tmp_path / "out.nc")
    found = ropewalk.resume(tmp_path / "out.nc", run.until)
    assert found["time"].values[:6] == pytest.approx(first["time"].values, rel=1e-12)
    assert_same(first, found, 5)
    whole = ropewalk.simulate(long)
    beside = np.delete(np.arange(found.sizes["time"]), 5)
    assert found["time"].values[beside] == pytest.approx(whole["time"].values, rel=1e-12)
    # A step that ends at the old end changes what follows by what the method errs in a step.
    assert np.abs(found["position"].values[beside] - whole["position"].values).max() < 1e-4


def test_the_interval_of_output_stays_a_hundredth_of_the_first_end(tmp_path):
    scenario = case("force")
    short = scenario.model_copy(update={"run": scenario.run.model_copy(update={"until": 0.1, "every": None})})
    ropewalk.simulate(short, file=tmp_path / "out.nc")
    found = ropewalk.resume(tmp_path / "out.nc", 0.12)
    assert found["time"].values == pytest.approx(np.linspace(0.0, 0.12, 121), abs=1e-12)
    message = json.loads(found.attrs["scenario"])["run"]
    assert (message["until"], message["every"]) == (0.12, pytest.approx(1e-3))


def test_resumed_twice_and_made_longer_twice_is_the_same_as_at_once(tmp_path, at_once):
    scenario, file = case("mass"), tmp_path / "out.nc"
    run = scenario.run
    short = scenario.model_copy(update={"run": run.model_copy(update={"until": 6.0 * run.every})})
    killed(short, file, (3,))
    ropewalk.resume(tmp_path / "out.3.nc")
    ropewalk.resume(tmp_path / "out.3.nc", 8.0 * run.every)
    found = ropewalk.resume(tmp_path / "out.3.nc", run.until)
    assert_same(ropewalk.simulate(scenario, file=file), found)


@pytest.mark.parametrize("kind", ["walker", "stepper", "pantograph, small motion", "footbridge"])
def test_an_interrupted_run_goes_on(kind, tmp_path):
    scenario = case(kind)

    def stop(part: float) -> None:
        if part > 0.5:
            raise KeyboardInterrupt

    broken = ropewalk.simulate(scenario, file=tmp_path / "out.nc", progress=stop)
    assert broken.attrs["outcome"] == "interrupted"
    found = ropewalk.resume(tmp_path / "out.nc")
    assert_same(ropewalk.simulate(scenario, file=tmp_path / "whole.nc"), found)


RUN = """
import sys
import ropewalk
from ropewalk.results import frames, recorder, slots
from resume_cases import case

recorder.SYNC_SECONDS, slots.SECONDS, slots.SHARE, frames.WAIT = 0.0, 0.0, 1e9, 0.0
settings = ["run.every=0.1 ms", "run.until=4 s"]
ropewalk.simulate(case("mass", *settings), file=sys.argv[1], progress=lambda part: print(part, flush=True))
"""


@pytest.mark.parametrize("wait", [0.0, 0.013, 0.037])
def test_a_run_killed_at_any_moment_goes_on(wait, tmp_path):
    file, path = tmp_path / "out.nc", [*sys.path, str(Path(__file__).parents[1])]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path)}
    command = [sys.executable, "-c", RUN.replace("sys.argv[1]", "__import__('pathlib').Path(sys.argv[1])"), str(file)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as run:
        for _ in range(40):
            assert run.stdout.readline()
        time.sleep(wait)
        run.send_signal(signal.SIGKILL)
        run.wait()
    frames = open_result(file).sizes["time"]
    past = Past.of(file)
    assert 0 <= frames - past.count <= 1  # no more is lost than what was being written
    shortened = case("mass", "run.every=0.1 ms", "run.until=4 s")
    stop = (frames + 20) * 1e-4

    def enough(part: float) -> None:
        if part * 4.0 > stop:
            raise KeyboardInterrupt

    found = ropewalk.resume(file, progress=enough)
    whole = ropewalk.simulate(shortened, progress=enough)
    assert found.sizes["time"] >= frames + 20
    assert_same(whole, found, min(one.sizes["time"] for one in (whole, found)))


def spoilt(file: Path, slot: int) -> None:
    """Turn a byte within a checkpoint."""
    with netCDF4.Dataset(file, "r+") as data:
        data.set_auto_maskandscale(False)
        data["checkpoint"][slot, 100] = ~data["checkpoint"][slot, 100]


def test_a_torn_checkpoint_leaves_the_one_before(tmp_path, at_once):
    scenario, file = case("mass"), tmp_path / "out.nc"
    whole = killed(scenario, file, (7,))
    file = tmp_path / "out.7.nc"
    last = Past.of(file)
    spoilt(file, last.number % 2)
    assert (last.count, Past.of(file).count) == (7, 6)
    assert_same(whole, ropewalk.resume(file))


def test_without_a_whole_checkpoint_it_is_told_in_one_line(tmp_path):
    file = tmp_path / "out.nc"
    ropewalk.simulate(case("mass"), file=file)
    for slot in (0, 1):
        spoilt(file, slot)
    attribute(file)
    with pytest.raises(ResultError, match=r"^.*out.nc: has no checkpoint to continue from; run it again$"):
        ropewalk.resume(file, 1.0)


def attribute(file: Path, **given: object) -> None:
    with netCDF4.Dataset(file, "r+") as data:
        data.setncatts({**given, HEAD: NONE})


@pytest.mark.parametrize(
    ("given", "until", "message"),
    [
        ({}, None, r"is complete.* 0.2 s; give --until with a later time"),
        ({}, 0.1, r"covers 0.2 s; give --until with a later time, not 0.1 s"),
        ({"ropewalk_version": "0.0.1"}, 1.0, r"was written by ropewalk 0.0.1, this is .*; run it again"),
        ({"engine_number": 0}, 1.0, r"the result was computed by engine 0; .* engine 1 and .* Run the scenario again"),
        ({"scenario_sha256": "0" * 64}, 1.0, r"digests differ"),
        ({"outcome": "diverged"}, 1.0, r"the run stopped by itself \(diverged\)"),
        ({"Conventions": "CF-1.8"}, 1.0, r"no result of ropewalk"),
    ],
)
def test_what_cannot_go_on_is_refused_in_one_line_and_left_alone(given, until, message, tmp_path):
    file = tmp_path / "out.nc"
    ropewalk.simulate(case("mass"), file=file)
    attribute(file, **given)
    before = file.read_bytes()
    with pytest.raises(ResultError, match=message) as problem:
        ropewalk.resume(file, until)
    assert "\n" not in str(problem.value)
    assert file.read_bytes() == before


def test_what_is_no_result_is_told(tmp_path):
    (tmp_path / "text.nc").write_text("no result")
    xr.Dataset({"time": ("time", [1.0])}).to_netcdf(tmp_path / "other.nc", format="NETCDF3_64BIT")
    for name, message in (("text", "cannot be read"), ("other", "no result of ropewalk"), ("none", "there is no such")):
        with pytest.raises(ResultError, match=rf"{name}\.nc: {message}"):
            ropewalk.resume(tmp_path / f"{name}.nc", 1.0)


@pytest.mark.parametrize("kind", ["equilibrium", "linear"])
def test_runs_without_a_motion_are_refused(kind, tmp_path):
    settings = ["run={kind: linear, until: 0.2 s}"] if kind == "linear" else ["run={kind: equilibrium}"]
    ropewalk.simulate(case("force", *settings), file=tmp_path / "out.nc")
    with pytest.raises(ResultError, match=f"a run of kind {kind} cannot be resumed; run it again"):
        ropewalk.resume(tmp_path / "out.nc")


def test_a_model_without_a_state_is_told_by_its_name(tmp_path, at_once):
    scenario = case("stepper", "loads.m.model=resume_cases:Stateless", "loads.m.options={}")
    killed(scenario, tmp_path / "out.nc", (4,))
    with pytest.raises(ResultError, match="no checkpoint to continue from: load m: its model has no get_state and"):
        ropewalk.resume(tmp_path / "out.4.nc")


def test_an_object_of_python_is_in_no_file(tmp_path):
    import external_cases

    scenario = case("stepper")
    load = scenario.loads["m"].model_copy(update={"model": external_cases.Sprung()})
    ropewalk.simulate(scenario.model_copy(update={"loads": {"m": load}}), file=tmp_path / "out.nc")
    with pytest.raises(ResultError, match=r"loads\.m\.model is a function or an object of Python"):
        ropewalk.resume(tmp_path / "out.nc", 1.0)


def test_other_data_are_noticed(tmp_path):
    table, file = tmp_path / "rough.csv", tmp_path / "out.nc"
    table.write_text("0, 0\n1000, 0.001\n")
    name = next(iter(case("pantograph, small motion").loads))
    ropewalk.simulate(case("pantograph, small motion", f"loads.{name}.irregularity={table}"), file=file)
    table.write_text("0, 0\n1000, 0.002\n")
    with pytest.raises(ResultError, match=f"the file that loads.{name}.irregularity names was deleted or changed"):
        ropewalk.resume(file, 1.0)


def test_a_file_that_is_being_written_is_left_alone(tmp_path):
    file = tmp_path / "out.nc"

    def meanwhile(part: float) -> None:
        with pytest.raises(ResultError, match=f"is being written by process {os.getpid()} since"):
            ropewalk.resume(file)

    ropewalk.simulate(case("force"), file=file, progress=meanwhile)


def test_a_checkpoint_of_another_run_is_refused(tmp_path):
    for kind in ("mass", "force"):
        ropewalk.simulate(case(kind), file=tmp_path / f"{kind}.nc")
    scenario = Past.of(tmp_path / "force.nc").attributes
    attribute(tmp_path / "mass.nc", scenario=scenario["scenario"], scenario_sha256=scenario["scenario_sha256"])
    with pytest.raises(ResultError, match=r"its checkpoint does not fit its scenario \(.*\)$"):
        ropewalk.resume(tmp_path / "mass.nc", 1.0)


def test_a_file_may_be_cut_after_some_frames(tmp_path):
    whole = ropewalk.simulate(case("force"), file=tmp_path / "out.nc")
    slots.cut(tmp_path / "out.nc", 7)
    attribute(tmp_path / "out.nc", **{CHECKED: np.int32(0), FRAMES: NONE})  # as whoever cuts it does
    short = open_result(tmp_path / "out.nc")
    assert short.sizes["time"] == 7
    assert_same(short, whole, 7)


def test_files_of_rest_have_no_checkpoint(tmp_path):
    ropewalk.simulate(case("force", "run={kind: equilibrium}"), file=tmp_path / "out.nc")
    with netCDF4.Dataset(tmp_path / "out.nc") as data:
        assert "checkpoint" not in data.variables


def test_users_of_results_see_no_checkpoint(tmp_path):
    in_memory, in_file = ropewalk.simulate(case("force")), ropewalk.simulate(case("force"), file=tmp_path / "out.nc")
    assert_same(in_memory, in_file)
    assert not any("checkpoint" in str(name) for name in (*in_file.variables, *in_file.dims))


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("isolated", [False, True])
@pytest.mark.parametrize("kind", ["stepper", "beam, stepper"])
def test_a_line_with_an_fmu_goes_on(kind, version, isolated, tmp_path, at_once):
    fmu = with_fmu(kind, tmp_path, version, "canGetAndSetFMU{} canSerializeFMU{}", isolated=isolated)
    whole = killed(fmu, tmp_path / "out.nc", (1, 4, 11))
    for count in (1, 4, 11):
        assert_same(whole, ropewalk.resume(tmp_path / f"out.{count}.nc"))


def test_an_fmu_that_gives_no_bytes_is_told(tmp_path, at_once):
    for able, message in (("", "has no get_state"), ("canGetAndSetFMU{}", r"\(canSerializeFMUstate\)$")):
        killed(with_fmu("stepper", tmp_path, 2, able), tmp_path / "out.nc", (4,))
        with pytest.raises(ResultError, match=message):
            ropewalk.resume(tmp_path / "out.4.nc")


def with_fmu(kind: str, folder: Path, version: int, able: str, **keys: bool) -> Scenario:
    """A line under an FMU that says what it is able to."""
    pytest.importorskip("fmpy", reason="FMUs need FMPy")
    from external.fmus import c_fmu

    words = able.replace("{}", "state" if version == 2 else "State").split()
    file = c_fmu(folder, version, " ".join(f'{word}="true"' for word in words))
    message = {"force": "force", "height": "height", "velocity": "velocity", "place": "place"}
    travel = {"speed": 20.0, "from": 5.0}
    fmu = ropewalk.Fmu(on="s", file=str(file), contacts={"front": message}, travel=travel, every=0.01, **keys)
    return case(kind).model_copy(update={"loads": {"m": fmu}})


def test_the_command_goes_on_and_ends_as_run_does(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def stop(part: float) -> None:
        if part > 0.5:
            raise KeyboardInterrupt

    ropewalk.simulate(case("force"), file=Path("out.nc"), progress=stop).close()
    call = partial(CliRunner().invoke, app)
    out = call(["resume", "out.nc"])
    assert out.exit_code == 0, out.output
    assert "largest tension" in out.stdout
    assert out.stderr.startswith("continuing from t = ")
    assert out.stderr.endswith("result written to out.nc\n")
    out = call(["resume", "out.nc", "--until", "400 ms", "--json"])
    assert (out.exit_code, json.loads(out.stdout)["outcome"]) == (0, "completed")
    assert open_result("out.nc")["time"].values[-1] == pytest.approx(0.4)
    out = call(["resume", "out.nc"])
    assert (out.exit_code, out.stdout) == (2, "")
    assert out.stderr == "out.nc: is complete up to 0.4 s; give --until with a later time to continue\n"
    assert call(["resume", "none.nc"]).stderr == "none.nc: there is no such file\n"
    assert "3 parsecs" in call(["resume", "out.nc", "--until", "3 parsecs"]).stderr


@pytest.mark.parametrize("name", ["a" * 300 + ".nc", "loop.nc"])
def test_a_name_that_no_file_can_have_is_told(tmp_path, name):
    (tmp_path / "loop.nc").symlink_to(tmp_path / "loop.nc")
    with pytest.raises(ResultError, match="there is no such file"):
        ropewalk.resume(tmp_path / name)
