"""Tables say what the result says: every column with its unit, every number of the summary in a row."""

from __future__ import annotations

import json

import numpy as np
import openpyxl
import pandas as pd
import pytest
from typer.testing import CliRunner

from ropewalk.cli.app import app
from ropewalk.results import ResultError, summary, tables, write_tables

UNIT = r"^.+ \[(1|m|m/s|s|N|N/m|J|W)\]$"


def test_columns_hold_the_quantities_of_the_result(result):
    series = tables(result)["series"]
    assert series.index.name == "time [s]"
    np.testing.assert_array_equal(series.index, result["time"])
    assert series.columns.is_unique
    assert series.columns.str.match(UNIT).all()
    name = result["load"].values[0]
    np.testing.assert_array_equal(series[f"{name}.force.z [N]"], result["contact_force"].sel(axis="z")[:, 0])
    support = result["support"].values[1]
    np.testing.assert_array_equal(series[f"{support}.reaction.x [N]"], result["reaction"].sel(axis="x")[:, 1])
    np.testing.assert_array_equal(series["energy.kinetic [J]"], result["energy"].sel(form="kinetic"))
    line = result["line"].values[0]
    here = result["link_line"].values == line
    np.testing.assert_array_equal(series[f"{line}.largest_tension [N]"], result["tension"].values[:, here].max(axis=1))


def test_every_number_of_the_summary_has_a_row(result):
    rows = tables(result)["summary"].set_index("quantity")
    assert rows.index.is_unique
    found = summary(result)
    largest = rows.loc["largest_tension"]
    assert (largest["value"], largest["unit"]) == (found["largest_tension"]["value"], "N")
    assert largest["xi [m]"] == found["largest_tension"]["xi"]
    assert largest["time [s]"] == found["largest_tension"]["time"]
    assert rows.loc["outcome", "text"] == found["outcome"]
    assert rows.loc["energy.largest_imbalance.relative", "unit"] == "1"
    assert rows["value"].notna().sum() == len(list(numbers(found)))


def numbers(found):
    """All numbers of a summary but places and instants, which stand in the rows of what was found there."""
    places = ("line", "xi", "x", "y", "time", "load_path") if "value" in found else ()
    for key, value in found.items():
        if isinstance(value, dict):
            yield from numbers(value)
        elif isinstance(value, int | float) and not isinstance(value, bool) and key not in places:
            yield value


@pytest.mark.parametrize(("every", "at", "rows"), [(0.5, None, 5), (None, [0.1, 1.9], 2), (1.0, [0.1], 4)])
def test_rows_can_be_chosen(every, at, rows, make):
    result = make(times=np.linspace(0.0, 2.0, 21))
    series = tables(result, every=every, at=at)["series"]
    wanted = sorted({*(at or []), *(np.arange(0.0, 2.0001, every) if every else [])})
    assert len(series) == rows
    np.testing.assert_allclose(series.index, wanted, atol=1e-12)


@pytest.mark.parametrize(("asked", "said"), [({"every": 0.0}, "above zero"), ({"at": [9.0]}, "from 0 to 2 s")])
def test_rows_that_are_not_there_are_refused(asked, said, make):
    with pytest.raises(ResultError, match=said):
        tables(make(times=np.linspace(0.0, 2.0, 5)), **asked)


def test_files_are_read_by_pandas(result, tmp_path):
    wanted = tables(result)
    assert write_tables(result, tmp_path / "a.csv") == [tmp_path / "a.csv", tmp_path / "a.summary.csv"]
    series = pd.read_csv(tmp_path / "a.csv", index_col=0)
    pd.testing.assert_frame_equal(series, wanted["series"], check_dtype=False)
    write_tables(result, tmp_path / "a.parquet")
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "a.parquet"), wanted["series"])
    assert pd.read_parquet(tmp_path / "a.summary.parquet")["quantity"].tolist() == list(wanted["summary"]["quantity"])


def test_a_workbook_has_a_sheet_for_each_table_and_units_in_its_heads(result, tmp_path):
    write_tables(result, tmp_path / "a.xlsx")
    book = openpyxl.load_workbook(tmp_path / "a.xlsx")
    assert book.sheetnames == ["series", "summary"]
    heads = [cell.value for cell in book["series"][1]]
    assert heads[0] == "time [s]"
    assert all(pd.Series(heads).str.match(UNIT))
    assert book["series"].max_row == result.sizes["time"] + 1


def test_a_package_that_is_missing_is_named(result, tmp_path, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(ResultError, match=r"openpyxl is not installed; pip install 'ropewalk\[tables\]'"):
        write_tables(result, tmp_path / "a.xlsx")


def test_the_command_line_writes_tables(make, tmp_path):
    make(file=tmp_path / "a.nc", times=np.linspace(0.0, 2.0, 21)).close()
    run = CliRunner().invoke(app, ["show", str(tmp_path / "a.nc"), "-o", str(tmp_path / "a.csv"), "--every", "500 ms"])
    assert run.exit_code == 0, run.output
    assert "a.csv" in run.output
    assert "a.summary.csv written" in " ".join(run.output.split())
    assert len(pd.read_csv(tmp_path / "a.csv")) == 5
    refused = CliRunner().invoke(app, ["show", str(tmp_path / "a.nc"), "-o", str(tmp_path / "a.png"), "--at", "1 s"])
    assert refused.exit_code == 2
    assert "--every and --at choose the rows of tables" in refused.output
    assert json.loads(CliRunner().invoke(app, ["show", str(tmp_path / "a.nc"), "--json"]).output)["frames"] == 21
