"""The report of a result: a page that needs nothing else, and prints on A4."""

from __future__ import annotations

import datetime
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import ropewalk
from ropewalk.results import figure, html_report, open_result
from ropewalk.results.contract import scenario_text
from ropewalk.results.figures import panels_of, rows_of_panels
from ropewalk.scenario import brief, load, loads
from ropewalk.simulate import simulate

EXAMPLES = Path(__file__).parents[2] / "examples"
TRAMWAY = (EXAMPLES / "ropeway-tramway.yaml").read_text(encoding="utf-8")
SHORT = TRAMWAY.replace("until: 12 s", "until: 0.2 s").replace("elements: 200", "elements: 60")
SEVERAL = """\
title: A train on piers  # seen from below
gravity: 0 m/s^2
lines:
  deck:
    {start: [0 m, 0 m], end: [40 m, 0 m], length: 40 m, mass: 9 t/m, bending_stiffness: 7.8 GN*m^2,
     axial_stiffness: 10 GN, elements: 20, supports: {pier: {kind: guided, along: [1, 0], at: 16 m}}}
loads:
  train:
    {kind: axles, on: deck, forces: 100 kN, at: [0 m, 3 m], coaches: {count: 2, length: 20 m}, travel: {speed: 40 m/s}}
run: {kind: dynamic, geometry: linearised, until: 0.5 s, every: 10 ms}
"""


@pytest.fixture(scope="module")
def tramway() -> xr.Dataset:
    return simulate(loads(SHORT))


@pytest.fixture(scope="module")
def page(tramway) -> str:
    return html_report(tramway)


def cells(page: str, section: str) -> list[list[str]]:
    """Rows of the tables of a section."""
    part = page.split(f"<h2>{section}</h2>")[1].split("<h2>")[0]
    return [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in part.split("<tr>")[1:]]


def test_a_report_prints_on_a4_and_splits_no_figure(tramway, page):
    assert "@page { size: A4;" in page
    assert re.search(r"tbody, figure, tr, p \{ break-inside: avoid; \}", page)
    assert page.count("<figure>") == page.count("<img ") == len(rows_of_panels(tramway, "report"))


def test_every_row_of_panels_is_lower_than_a_page(result):
    rows = rows_of_panels(result, "report")
    assert [name for row in rows for name in row] == panels_of(result)
    for row in rows:
        wide, tall = figure(result, panels=row, size="report").get_size_inches()
        assert wide == pytest.approx(16.0 / 2.54)
        assert tall < 12.0 / 2.54


def test_a_report_begins_with_about_ten_rows_that_are_in_its_results(page):
    assert page.index("<h2>Summary</h2>") < page.index("<h2>Figures</h2>") < page.index("<h2>Results</h2>")
    short, whole = cells(page, "Summary"), cells(page, "Results")
    assert 5 <= len(short) <= 10
    for what, *values in short:
        assert [what.removeprefix("car: "), *values] in whole
    assert {"largest tension", "track.end", "car: largest wheel load", "largest energy residual"} <= {
        row[0] for row in short
    }


def test_a_report_tells_date_version_and_outcome(tramway, page):
    assert f"report of {datetime.date.today().isoformat()}" in page
    assert f"ropewalk {ropewalk.__version__}" in page
    assert f"{tramway.attrs['outcome']}; " in page


def test_a_carriage_has_one_block_and_its_wheels_none(page):
    rows = [row[0] for row in cells(page, "Results")]
    assert rows.count("Carriage car") == 1
    assert not [row for row in rows if re.search(r"car\.\d", row)]
    assert "car.cabin" in rows  # of its clearance


def test_spans_and_towers_are_in_a_table(tramway, page):
    rows = {row[0]: row for row in cells(page, "Structure")}
    assert rows["track"][1:5] == ["160 m", "30 m", "162.9 m", "11.7 kg/m"]
    assert rows["tower"][1:5] == ["saddle", "80 m", "19 m", "80 m"]
    assert rows["end"][1:5] == ["guided", "160 m", "30 m", "80 m"]
    force = float(rows["tower"][5].split()[0])
    assert force == pytest.approx(
        1e-3 * np.linalg.norm(tramway.reaction.sel(support="track.tower"), axis=1).max(), rel=1e-3
    )  # digits


def test_a_train_has_one_block_and_inner_supports_have_their_places():
    page = html_report(simulate(loads(SEVERAL)))
    rows = cells(page, "Results")
    assert [row[0] for row in rows].count("Train train") == 1
    assert ["axles", "4", "at most 3 of them on the line"] in rows
    spans = {row[0]: row for row in cells(page, "Structure")}
    assert spans["pier"][1:5] == ["guided", "16 m", "0 m", "16 m"]
    assert spans["end"][4] == "24 m"
    assert "# seen from below" in page


def test_a_report_has_the_scenario_as_its_user_wrote_it(page, tmp_path):
    file = tmp_path / "rope.yaml"
    file.write_text(SEVERAL)
    simulate(load(file), file=tmp_path / "rope.nc").close()
    with open_result(tmp_path / "rope.nc") as stored:
        assert stored.attrs["scenario_file"] == SEVERAL
        assert html_report(stored).split("<pre>")[1].startswith(SEVERAL)
    assert "# counterweight, over a sheave" in page


def test_a_scenario_that_is_not_as_written_is_given_as_short_yaml():
    scenario = loads(SEVERAL)
    changed = scenario.model_copy(update={"title": "Another"})
    for other in (changed, loads(SEVERAL, overrides=["title=Another"])):
        assert other.source_text == ""
        assert loads(brief(other)) == other == changed
    assert scenario.model_copy().source_text == SEVERAL
    assert loads(scenario_text(scenario)).source_text == ""  # JSON, as a result has it
    assert loads(brief(scenario)) == scenario


def test_short_yaml_reads_back_as_the_same_scenario():
    for name in ("ropeway-tramway", "highline-overload", "simple-ac-275", "trampoline-net", "overhead-line-limits"):
        scenario = load(EXAMPLES / f"{name}.yaml")
        assert loads(brief(scenario)) == scenario
        assert "null" not in brief(scenario)


def test_a_report_of_an_unreadable_scenario_has_its_text(make):
    result = make().assign_attrs(scenario='{"loads": {"w": {"force": "<module.function>"}}}')
    result.attrs.pop("scenario_file", None)
    assert "&lt;module.function&gt;" in html_report(result)
