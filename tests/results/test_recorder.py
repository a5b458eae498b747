"""The recorder keeps the contract of a result, in memory and on disk."""

from __future__ import annotations

import dataclasses
import hashlib
import json

import numpy as np
import pytest
import travelling_wave as wave
import xarray as xr

import ropewalk
from ropewalk.results import Recorder, ResultError, links, open_result
from ropewalk.results.contract import scenario_text
from ropewalk.results.frame import ENERGY_FORMS
from ropewalk.results.recorder import block_rows
from ropewalk.scenario import loads

CONTRACT = {
    "position": (("time", "node", "axis"), "m"),
    "velocity": (("time", "node", "axis"), "m/s"),
    "tension": (("time", "link"), "N"),
    "strain": (("time", "link"), "1"),
    "contact_position": (("time", "contact", "axis"), "m"),
    "contact_force": (("time", "contact", "axis"), "N"),
    "hold_force": (("time", "contact", "axis"), "N"),
    "contact_xi": (("time", "contact"), "m"),
    "contact_speed": (("time", "contact"), "m/s"),
    "contact_friction": (("time", "contact"), "1"),
    "contact_tension": (("time", "contact", "side"), "N"),
    "contact_state": (("time", "contact"), "1"),
    "contact_in_air": (("time", "contact"), "s"),
    "friction_power": (("time", "contact"), "W"),
    "body_position": (("time", "body", "axis"), "m"),
    "body_velocity": (("time", "body", "axis"), "m/s"),
    "reaction": (("time", "support", "axis"), "N"),
    "energy": (("time", "form"), "J"),
}


def test_names_dimensions_and_units_are_those_of_the_contract(result):
    assert {name: (result[name].dims, result[name].units) for name in result.data_vars} == CONTRACT
    assert result["time"].dims == ("time",)
    assert result["time"].units == "s"


def test_everything_has_a_unit_and_a_long_name(result):
    assert [name for name, v in result.variables.items() if not (v.attrs["units"] and v.attrs["long_name"])] == []


def test_coordinates_name_lines_loads_supports_and_forms(result):
    assert result["axis"].values.tolist() == ["x", "z"]
    assert set(result["line"].values.tolist()) == set(result["link_line"].values.tolist()) == {"rope"}
    assert result["line"].dims == result["xi"].dims == ("node",)
    assert result["link_line"].dims == result["link_xi"].dims == ("link",)
    assert result["load"].dims == ("contact",)
    assert result["load"].values.tolist() == ["walker"]
    assert result["side"].values.tolist() == ["behind", "ahead"]
    assert result["support"].values.tolist() == ["rope.start", "rope.end"]
    assert tuple(result["form"].values.tolist()) == ENERGY_FORMS
    assert float(result["tension"].sel(time=0.5)[3]) == result["tension"].values[50, 3]


def test_link_quantities_alone_carry_the_short_names(result):
    alone = links(result)
    assert set(alone.data_vars) == {"tension", "strain"}
    assert alone["xi"].dims == alone["line"].dims == ("link",)
    np.testing.assert_array_equal(alone["xi"], result["link_xi"])


def test_the_values_are_those_of_the_frames(result):
    frame = list(wave.frames(wave.layout()))[77]
    for name in CONTRACT:
        np.testing.assert_array_equal(result[name].values[77], getattr(frame, name), err_msg=name)
    assert result["time"].values[77] == frame.path


def test_a_record_that_never_begins_leaves_the_earlier_one(make, tmp_path):
    file = tmp_path / "out.nc"
    make(file=file)
    before = file.read_bytes()
    with pytest.raises(RuntimeError), Recorder(wave.layout(), wave.scenario(), wave.run_info(), file):
        raise RuntimeError("no first frame")
    assert file.read_bytes() == before


def test_a_quasistatic_result_leads_with_the_load_path(make):
    result = make(wave.layout(path="load_path"))
    assert result["position"].dims == ("load_path", "node", "axis")
    assert result["load_path"].units == "m"
    assert "time" not in result.variables


@pytest.mark.parametrize(
    "plan",
    [
        wave.layout(),
        wave.layout(loads=()),
        wave.layout(loads=("first", "zweite Last, schwer ü")),
        wave.layout(path="load_path", axes="xyz"),
        wave.layout(links=1),
    ],
    ids=["plane", "no loads", "two loads", "spatial quasistatic", "one link"],
)
def test_a_file_gives_the_same_as_memory(plan, make, tmp_path):
    run_info = wave.run_info()
    run_info.warnings += ["compression in 3 links", "more\nlines"]
    run_info.steps, run_info.wall_seconds = 3, 0.25
    memory = make(plan, run_info=run_info)
    file = make(plan, file=tmp_path / "out.nc", run_info=run_info)
    again = open_result(tmp_path / "out.nc")
    lazy = open_result(tmp_path / "out.nc", lazy=True)
    for other in (file, again, lazy):
        xr.testing.assert_identical(memory, other)
        assert {k: v.dtype for k, v in other.variables.items()} == {k: v.dtype for k, v in memory.variables.items()}
        assert {k: type(v) for k, v in other.attrs.items()} == {k: type(v) for k, v in memory.attrs.items()}
    lazy.close()


def test_a_file_opens_with_plain_xarray(make, tmp_path):
    make(file=tmp_path / "out.nc")
    with xr.open_dataset(tmp_path / "out.nc") as plain:
        assert plain["time"].dtype == np.float64
        assert {"line", "xi", "load"} <= set(plain.coords)
        assert plain["support"].values.tolist() == ["rope.start", "rope.end"]


def test_a_lazy_result_does_not_read_what_is_not_asked_for(make, tmp_path):
    make(file=tmp_path / "out.nc")
    with open_result(tmp_path / "out.nc", lazy=True) as lazy:
        assert not lazy["position"].variable._in_memory
        assert lazy["position"].isel(node=3, axis=1).values.shape == (181,)
        assert not lazy["position"].variable._in_memory


def test_a_run_without_frames_is_a_result(make, tmp_path):
    memory, file = make(times=np.array([])), make(times=np.array([]), file=tmp_path / "out.nc")
    xr.testing.assert_identical(memory, file)
    assert file.sizes["time"] == 0


def test_the_attributes_hold_the_scenario_its_hash_and_how_it_went(result):
    message = result.attrs
    scenario = wave.scenario()
    assert loads(message["scenario"], "scenario.json") == scenario
    assert message["scenario_sha256"] == hashlib.sha256(message["scenario"].encode()).hexdigest()
    assert message["title"] == scenario.title
    assert message["ropewalk_version"] == ropewalk.__version__
    assert (message["outcome"], message["method"], message["steps"], message["step"]) == (
        "completed",
        "rkn6",
        3600,
        5e-4,
    )
    assert message["reason"].startswith("undamped")


def test_a_table_in_the_scenario_can_be_run_again():
    scenario = wave.scenario()
    force = {"time": [0.0, 1.0], "value": [[0.0, 0.0], [0.0, -800.0]]}
    tree = json.loads(scenario_text(scenario))
    tree["loads"]["walker"]["force"] = force
    scenario = type(scenario).model_validate(tree)
    assert loads(scenario_text(scenario)) == scenario


def test_a_callable_in_the_scenario_is_recorded_by_its_name():
    def pulse(time: float) -> tuple[float, float]:
        return 0.0, -time

    scenario = wave.scenario()
    load = scenario.loads["walker"].model_copy(update={"force": pulse})
    scenario = scenario.model_copy(update={"loads": {"walker": load}})
    message = Recorder(wave.layout(), scenario, wave.run_info()).close().attrs
    assert json.loads(message["scenario"])["loads"]["walker"]["force"].endswith("pulse>")


def test_a_frame_may_be_used_again_after_it_was_recorded():
    frame = next(wave.frames(wave.layout()))
    recorder = Recorder(wave.layout(), wave.scenario(), wave.run_info())
    recorder.append(frame)
    before = frame.position.copy()
    frame.position[:] = -1.0
    recorder.append(frame)
    np.testing.assert_array_equal(recorder.close()["position"].values[0], before)


def test_a_frame_of_another_shape_is_refused():
    frame = next(wave.frames(wave.layout()))
    recorder = Recorder(wave.layout(), wave.scenario(), wave.run_info())
    with pytest.raises(ValueError, match=r"tension has shape \(1,\), the layout requires \(40,\)"):
        recorder.append(dataclasses.replace(frame, tension=np.zeros(1)))


@pytest.mark.parametrize("file", [None, "out.nc"])
@pytest.mark.parametrize(
    ("problem", "outcome"), [(KeyboardInterrupt(), "interrupted"), (ArithmeticError("Newton failed"), "failed")]
)
def test_an_exception_leaves_what_was_recorded_with_its_outcome(file, problem, outcome, tmp_path):
    file = file and tmp_path / file
    run_info = wave.run_info()
    recorder = Recorder(wave.layout(), wave.scenario(), run_info, file)

    def simulate():
        with recorder:
            for count, frame in enumerate(wave.frames(wave.layout())):
                if count == 30:
                    raise problem
                recorder.append(frame)

    with pytest.raises(type(problem)):
        simulate()
    result = open_result(file) if file else recorder.close()
    assert (result.sizes["time"], result.attrs["outcome"]) == (30, outcome)
    assert result.attrs["advice"] == str(problem)
    assert recorder.frames == 30


@pytest.mark.parametrize(("words", "moves"), [(1000, False), (30_000, True)])
def test_attributes_that_grow_move_the_data_only_beyond_the_reserve(words, moves, make, tmp_path):
    run_info = wave.run_info()
    file = tmp_path / "out.nc"
    with Recorder(wave.layout(), wave.scenario(), run_info, file) as recorder:
        for frame in wave.frames(wave.layout()):
            recorder.append(frame)
        recorder._store._flush(run_info, ())
        size = file.stat().st_size
        run_info.advice = "try " * words
    assert (file.stat().st_size > size) == moves
    xr.testing.assert_identical(open_result(file), make(run_info=run_info))


def test_a_long_scenario_fits(tmp_path):
    scenario = wave.scenario(title="ä" * 100_000)
    with Recorder(wave.layout(), scenario, wave.run_info(), tmp_path / "out.nc") as recorder:
        recorder.append(next(wave.frames(wave.layout())))
    result = open_result(tmp_path / "out.nc")
    assert result.attrs["title"] == scenario.title
    assert loads(result.attrs["scenario"]) == scenario


def test_frames_wait_for_no_more_than_a_megabyte():
    for count in (1, 40, 2000, 100_000):
        plan = wave.layout(links=count)
        assert block_rows(plan) == 1 or block_rows(plan) * 8 * 6 * count < 1.1e6


def test_many_counts_of_steps_survive(make, tmp_path):
    run_info = wave.run_info()
    run_info.steps = 3_000_000_000
    assert make(file=tmp_path / "out.nc", run_info=run_info).attrs["steps"] == 3_000_000_000


def test_a_missing_folder_is_refused_before_anything_is_computed(tmp_path):
    with pytest.raises(ResultError, match=r"the folder .* does not exist"):
        Recorder(wave.layout(), wave.scenario(), wave.run_info(), tmp_path / "no" / "out.nc")


def test_an_existing_result_is_replaced_but_another_file_is_left_alone(make, tmp_path):
    make(file=tmp_path / "out.nc")
    restrained = open_result(tmp_path / "out.nc", lazy=True)
    make(wave.layout(links=7), file=tmp_path / "out.nc")
    assert open_result(tmp_path / "out.nc").sizes["link"] == 7
    assert restrained["tension"].values.shape == (181, 40)  # a reader keeps the earlier result
    restrained.close()
    precious = tmp_path / "scenario.yaml"
    precious.write_text("title: precious\n")
    with pytest.raises(ResultError, match="exists and is not a result"):
        make(file=precious)
    assert precious.read_text() == "title: precious\n"


@pytest.mark.parametrize(
    ("name", "why"),
    [("missing.nc", "no such file"), ("text.nc", "is no NetCDF file"), ("other.nc", "not a result of ropewalk")],
)
def test_what_is_no_result_is_refused_when_opened(name, why, tmp_path):
    (tmp_path / "text.nc").write_text("no NetCDF")
    xr.Dataset({"a": ("b", [1.0])}).to_netcdf(tmp_path / "other.nc")
    with pytest.raises(ResultError, match=why):
        open_result(tmp_path / name)
