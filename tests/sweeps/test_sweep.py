"""Sweeps: right, kept, the same on any number of workers, and honest about what has no value."""

from __future__ import annotations

import os

import numpy as np
import pytest
import xarray as xr

import ropewalk
import sweep_cases as cases
from ropewalk.errors import ScenarioError
from ropewalk.model import Sweep
from ropewalk.results import named_numbers
from ropewalk.sweeps import sweeping
from ropewalk.sweeps.case import Case, Outcome, computed
from ropewalk.sweeps.command import table_text
from ropewalk.sweeps.dataset import dataset_of, named
from ropewalk.sweeps.plan import Plan
from ropewalk.sweeps.quantities import measured
from ropewalk.sweeps.writing import read, write

LENGTH, FORCE = "lines.rope.length", "loads.man.force.1"
FELT = (
    {"over": {LENGTH: "uniform(10.2 m, 12 m)"}}, {"derived": {FORCE: "-(10 N/m) * length"}}, {"combine": "random"},
    {"count": 5}, {"seed": 2}, {"record": ["largest_tension"]},
)  # fmt: skip
"""Another value of each key of a sweep."""


@pytest.fixture
def counted(monkeypatch):
    """The keys of the cases that are computed."""
    return cases.counted(monkeypatch, sweeping)


@pytest.fixture(scope="module")
def result():
    with ropewalk.simulate(cases.scenario()) as dataset:
        yield dataset


def swept(over, **more):
    return ropewalk.sweep(more.pop("scenario", None) or cases.scenario(), over, **{"workers": 0, **more})


def test_each_case_is_the_run_with_its_values(counted):
    found = swept({LENGTH: "10.5:10.7:0.1 m", FORCE: [-100, -200]}, record="max tension, largest_sag")
    assert found["max tension"].dims == ("length", "force.1")
    assert found["max tension"].attrs["units"] == "N"
    assert found["length"].values.tolist() == [10.5, 10.6, 10.7]
    assert (found["outcome"] == "completed").all()
    one = cases.scenario(lines={"rope": cases.TREE["lines"]["rope"] | {"length": 10.6}})
    one = one.model_copy(update={"loads": {"man": one.loads["man"].model_copy(update={"force": (0.0, -200.0)})}})
    with ropewalk.simulate(one) as run:
        message = ropewalk.summary(run)
    here = found.sel({"length": 10.6, "force.1": -200.0})
    assert float(here["max tension"]) == message["largest_tension"]["value"]
    assert float(here["largest_sag"]) == message["largest_sag"]["value"]
    assert len(counted) == 6


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("largest_tension", lambda r: r.tension.max()),
        ("max tension", lambda r: r.tension.max()),
        ("smallest tension", lambda r: r.tension.min()),
        ("min contact_force", lambda r: 100.0),
        ("max contacts.man.force.magnitude", lambda r: 100.0),
        ("mean man.force.z", lambda r: -100.0),
        ("mean rope.largest_tension", lambda r: r.tension.max()),
        ("sigma rope.largest_tension", lambda r: 0.0),
        ("max *.largest_sag", lambda r: ropewalk.summary(r)["largest_sag"]["value"]),
        ("contacts.man.force.z.mean", lambda r: -100.0),
        ("frames", lambda r: 1.0),
    ],
)
def test_quantities_are_those_of_the_summary_and_of_the_series(result, name, value):
    assert measured(result, [name])[name][0] == pytest.approx(float(value(result)), rel=1e-12)


def test_only_what_is_asked_for_is_looked_up_in_results_alike(result, monkeypatch):
    names = ["max tension", "min contact_force", "mean man.force.z"]
    whole = measured(result, names)
    looked = []

    def noted(dataset, only=None):
        looked.append(only)
        return named_numbers(dataset, only)

    monkeypatch.setattr("ropewalk.sweeps.quantities.named_numbers", noted)
    assert measured(result, names) == whole
    assert looked == [{"largest_tension", "contacts"}]
    few = named_numbers(result, {"largest_tension"})
    assert {name.partition(".")[0] for name in few} == {"largest_tension"}
    assert few.items() <= named_numbers(result).items()
    assert named_numbers(result, {"what only some have"}) == named_numbers(result)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("max tensoin", "did you mean max tension"),
        ("largst_tension", "did you mean largest_tension"),
        ("sigma pantographs.front", "no such quantity"),
        ("mean man.force.*", "may be man.force.x or man.force.z"),
        ("max rope", "no such quantity"),
        ("max strain of what is carried by somebody", "known: max tension, max strain, "),
        ("impact factor of rope", "write outputs: {impact: true}"),
    ],
)
def test_an_unknown_quantity_is_refused(result, name, wrong):
    with pytest.raises(ScenarioError, match=wrong):
        measured(result, [name])


def test_unknown_quantities_are_told_before_a_case_is_computed(counted):
    with pytest.raises(ScenarioError, match="did you mean max tension") as message:
        swept({LENGTH: [10.5]}, record="max tensoin, largst_sag")
    assert len(message.value.problems) == 2
    assert counted == []


def test_only_what_is_new_is_computed(tmp_path, counted):
    store = tmp_path / "s.jsonl"
    first = swept({LENGTH: [10.5, 10.6]}, record="largest_sag", store=store)
    assert len(counted) == 2
    wider = swept({LENGTH: [10.4, 10.5, 10.6], FORCE: [-100]}, record="largest_sag", store=store)
    assert len(counted) == 3
    np.testing.assert_array_equal(wider["largest_sag"].values[1:, 0], first["largest_sag"].values)
    swept({LENGTH: [10.5]}, record="largest_strain", store=store)  # other quantities
    assert len(counted) == 4
    renamed = cases.scenario(title="Another title")
    swept({LENGTH: [10.5]}, record="largest_strain", store=store, scenario=renamed)
    assert len(counted) == 4


def test_what_cannot_be_is_a_row_with_its_reason(counted):
    found = swept({LENGTH: [10.5, -1, 10.6]}, record="largest_sag")
    assert found["outcome"].values.tolist() == ["completed", "failed", "completed"]
    assert "positive" in str(found["reason"].values[1])
    assert np.isnan(found["largest_sag"].values[1])
    assert len(counted) == 2


def test_a_run_that_stops_early_is_a_row_with_its_reason():
    run = {"kind": "dynamic", "until": 0.2, "every": 0.02}
    travels = [{"speed": speed, "from": 5, "measured": "arc"} for speed in (1, 100)]
    found = swept({"loads.man.travel": travels}, record="largest_sag", scenario=cases.scenario(run=run))
    assert (found["outcome"].values == "failed").tolist() == [False, True]
    assert "travel ended" in str(found["reason"].values[1])
    assert np.isfinite(found["largest_sag"].values).tolist() == [True, False]


@pytest.mark.parametrize(
    ("over", "more", "wrong"),
    [
        ({"lines.rope.lenght": [1]}, {}, "did you mean length"),
        ({LENGTH: [1], "lines.rope": [{}]}, {}, "is set twice"),
        ({LENGTH: [10.5]}, {"derived": {FORCE: "-speeed * 1 kg/s"}}, "unknown name speeed; did you mean"),
        ({LENGTH: [10.5]}, {"derived": {FORCE: "2 s"}}, "does not fit: expected a force"),
        ({LENGTH: "normal(1, 2)"}, {}, "drawn from a distribution"),
        ({LENGTH: "normal(1, 2)"}, {"combine": "random"}, "number of sampled cases"),
        ({LENGTH: [10.5]}, {"combine": "cartesian"}, "combine"),
        ({}, {}, "nothing varies"),
        (None, {}, "nothing varies"),
        ({LENGTH: [10.5]}, {"workers": -1}, "must not be negative"),
    ],
)
def test_mistakes_are_told_before_anything_is_computed(over, more, wrong, counted):
    with pytest.raises(ScenarioError, match=wrong):
        swept(over, **more)
    assert counted == []


def test_values_follow_from_others():
    found = swept({LENGTH: [10.5, 11.0]}, derived={FORCE: "-(10 N/m) * length"}, record="max contact_force")
    assert found["max contact_force"].values.tolist() == [105.0, 110.0]


def test_the_file_says_what_the_sweep_is_and_what_is_given_comes_first():
    block = {"over": {LENGTH: "uniform(10.2 m, 11 m)"}, "combine": "sobol", "count": 4, "seed": 1,
             "record": ["largest_sag"]}  # fmt: skip
    found = swept(None, scenario=cases.scenario(sweep=block))
    assert found["largest_sag"].dims == ("case",)
    assert found["length"].attrs == {"key": LENGTH, "units": "m"}
    assert ((found["length"] > 10.2) & (found["length"] < 11.0)).all()
    assert (np.diff(found["largest_sag"].values[np.argsort(found["length"].values)]) > 0.0).all()
    assert swept(None, scenario=cases.scenario(sweep=block), count=2).sizes["case"] == 2


@pytest.mark.parametrize("changed", FELT, ids=lambda changed: next(iter(changed)))
def test_every_key_of_a_sweep_is_felt(changed):
    block = {"over": {LENGTH: "uniform(10.2 m, 11 m)"}, "combine": "sobol", "count": 4, "record": ["largest_sag"]}
    one, other = (
        swept(None, scenario=cases.scenario(sweep=block | more)).drop_vars("seconds") for more in ({}, changed)
    )
    assert not one.equals(other)
    assert {next(iter(case)) for case in FELT} == set(Sweep.model_fields)


def test_an_interrupt_leaves_what_there_is(monkeypatch, tmp_path):
    store, done = tmp_path / "s.jsonl", []

    def stopping(case):
        if len(done) == 1:
            raise KeyboardInterrupt
        done.append(case)
        return computed(case)

    monkeypatch.setattr(sweeping, "computed", stopping)
    found = swept({LENGTH: [10.5, 10.6]}, record="largest_sag", store=store)
    assert found.attrs["outcome"] == "interrupted"
    assert found["outcome"].values.tolist() == ["completed", "not computed"]
    monkeypatch.setattr(sweeping, "computed", computed)
    again = swept({LENGTH: [10.5, 10.6]}, record="largest_sag", store=store)
    assert again.attrs["outcome"] == "completed"
    assert again["largest_sag"].values[0] == found["largest_sag"].values[0]


def test_the_key_of_a_case_knows_what_it_starts_from(tmp_path):
    file = tmp_path / "before.nc"
    start = {"start": {"kind": "result", "file": str(file)}}
    scenario = cases.scenario(run={"kind": "dynamic", "until": 1.0, **start})
    keys = set()
    for content in (b"one", b"other"):
        file.write_bytes(content)
        os.utime(file, ns=(len(keys) + 1, len(keys) + 1))
        keys.add(Case.of(scenario, ("frames",)).key)
    assert len(keys) == 2


def test_results_do_not_depend_on_the_number_of_workers():
    """To the last bit, of motions and of rest."""
    run = {"kind": "dynamic", "until": 0.2, "every": 0.02}
    over = {"run.kind": ["dynamic"], LENGTH: "10.2:10.8:0.2", FORCE: [-100, -300]}
    record = "max tension, min tension, largest_sag, turnover, std rope.largest_tension"
    found = [
        ropewalk.sweep(cases.scenario(run=run), over, record=record, workers=workers).drop_vars("seconds")
        for workers in (1, 2)
    ]
    xr.testing.assert_identical(*found)
    assert np.isfinite(found[0]["max tension"].values).all()


def test_the_table_has_a_row_for_each_case_with_units():
    found = swept({LENGTH: ["10.5 m", "-1 m"]}, record="largest_sag")
    table = ropewalk.sweep_table(found)
    assert list(table.columns) == ["length [m]", "largest_sag [m]", "outcome", "doubts", "reason", "seconds [s]"]
    assert table["length [m]"].tolist() == [10.5, -1.0]


def test_names_of_broken_limits_stand_beside_their_number_which_has_no_unit(tmp_path):
    count = "rear.limits.failures"
    plan = Plan.of(cases.scenario(), Sweep(over={LENGTH: [10.5, 10.7]}, record=[count]))
    none, two = {count: (0.0, "1")}, {count: (2.0, "1")}
    text = "standard deviation sigma; largest force; Fm + 3 sigma; largest uplift at a support"
    found = [Outcome("completed", none), Outcome("completed", two, broken={count: text})]
    swept = dataset_of(plan, {row.case.key: one for row, one in zip(plan.rows, found, strict=True)}, "completed")
    columns = ["length [m]", count, "rear.limits.broken", "outcome", "doubts", "reason", "seconds [s]"]
    table = ropewalk.sweep_table(swept)
    assert list(table.columns) == columns
    assert table["rear.limits.broken"].tolist() == ["", text]
    assert named(swept, "quantities") == [count]  # what figures and maps draw
    assert text in table_text(swept)
    assert "limits.broken" not in table_text(swept.isel(length=[0]))
    write(swept, tmp_path / "s.nc")
    again = read(tmp_path / "s.nc")
    assert again["rear.limits.broken"].values.tolist() == ["", text]
