"""A named unit of length holds for places in the summary, the tables and the figures."""

from __future__ import annotations

import numpy as np
import pytest

import ropewalk
from ropewalk.results import figure, figure_data, summary, tables, text
from ropewalk.results.display_units import DisplayUnits
from ropewalk.scenario import loads

FEET = 0.3048
ROPE = """
lines: {rope: {start: [0, 0], end: [20, 0], length: 20.1, mass: 1, axial_stiffness: 1 MN, elements: 6}}
loads: {w: {kind: force, on: rope, force: [0, -100], travel: {speed: 1, from: 5}}}
run: {kind: quasistatic, positions: 3}
"""


@pytest.fixture(scope="module")
def result():
    return ropewalk.simulate(loads(ROPE))


@pytest.fixture
def feet():
    return DisplayUnits.read("lbf,ft")


def test_no_place_of_the_summary_stays_in_metres(result, feet):
    said = text(summary(result), feet)
    assert " m" not in said.replace(" ms", "").replace("  method", "").replace(" mm", "")[: said.index("Method")]
    sag = summary(result)["largest_sag"]
    assert f"x = {sag['x'] / FEET:.2f} ft" in said


@pytest.mark.parametrize("units", ["mm", "cm", "kN,mm", "engineering"])
def test_parts_of_the_metre_leave_places_in_metres(result, units):
    said = text(summary(result), DisplayUnits.read(units))
    assert f"x = {summary(result)['largest_sag']['x']:.3f} m"[:8] in said


def test_tables_have_their_places_in_the_unit(result, feet):
    plain, shown = tables(result), tables(result, units=feet)
    assert shown["series"].index.name == "load_path [ft]"
    assert np.allclose(shown["series"].index * FEET, plain["series"].index)
    assert np.allclose(shown["series"]["w.position.x [ft]"] * FEET, plain["series"]["w.position.x [m]"])
    assert not [c for table in shown.values() for c in [*table.columns, table.index.name] if str(c).endswith("[m]")]
    rows = [table["summary"].set_index("quantity") for table in (plain, shown)]
    assert rows[1]["x [ft]"]["largest_tension"] * FEET == pytest.approx(rows[0]["x [m]"]["largest_tension"])
    assert "m" not in set(rows[1]["unit"].dropna())


def test_figures_have_their_places_in_the_unit(result, feet):
    shapes = figure(result, panels=["shapes"], units=feet).axes[0]
    assert (shapes.get_xlabel(), shapes.get_ylabel()[:6]) == ("x (ft)", "z (ft)")
    plain, shown = (figure_data(result, panels=["shapes"], units=units)["shapes"] for units in (None, feet))
    assert np.allclose(shown["x [ft]"] * FEET, plain["x [m]"])
