"""Figures for reports and journals: panels, sizes and units as asked, nothing hidden, nothing empty, all as data."""

from __future__ import annotations

import itertools

import numpy as np
import pandas as pd
import pytest
import travelling_wave as wave
from matplotlib.colors import to_hex
from typer.testing import CliRunner

from ropewalk.cli.app import app
from ropewalk.errors import Refused
from ropewalk.results import DisplayUnits, ResultError, figure, figure_data, film
from ropewalk.results.figures import panels_of
from ropewalk.results.film_panels import Meter
from ropewalk.results.stage import Stage
from ropewalk.results.style import Page
from ropewalk.results.tempo import tempo


def titles(fig):
    return [title for ax in fig.axes if (title := ax.get_title("left"))]


@pytest.mark.parametrize(
    ("size", "inches"),
    [("16x9cm", (16 / 2.54, 9 / 2.54)), ("80 x 60 mm", (80 / 25.4, 60 / 25.4)), ("640x480px", (6.4, 4.8))],
)
def test_a_figure_has_the_panels_and_the_size_asked_for(size, inches, result):
    fig = figure(result, panels=["tension", "energy"], size=size)
    np.testing.assert_allclose(fig.get_size_inches(), inches)
    assert titles(fig) == ["Tension", "Energy since the start"]


def test_a_page_of_a_journal_has_one_column_and_smaller_letters(result):
    fig = figure(result, size="journal")
    assert fig.get_size_inches()[0] == pytest.approx(8.8 / 2.54)
    assert len({round(ax.get_position().x0, 3) for ax in fig.axes if ax.get_title("left")}) == 1
    sizes = {ax.yaxis.label.get_fontsize() for ax in fig.axes}
    assert max(sizes) < 7.5
    assert fig.get_suptitle() == ""  # the caption has it
    assert figure(result).axes[0].xaxis.label.get_fontsize() == 9.5  # and the next figure is as ever


@pytest.mark.parametrize(("size", "said"), [("A4", "expected a size"), ("9000x2cm", "cannot be drawn")])
def test_a_size_that_cannot_be_drawn_is_refused(size, said):
    with pytest.raises(Refused, match=said):
        Page.of(size)


def test_a_panel_that_is_not_there_is_refused(result):
    with pytest.raises(ResultError, match=r"no panel 'tnsion' in this result; did you mean tension\?"):
        figure(result, panels=["tnsion"])


def test_axes_are_labelled_in_the_units_shown_and_without_a_factor(result):
    large = result.assign(tension=(1e6 * result["tension"]).assign_attrs(result["tension"].attrs))
    for units, unit, size in (
        (None, "MN", 1e6),
        (DisplayUnits.read("SI"), "10⁹ N", 1e9),
        (DisplayUnits.read("kN"), "10⁶ kN", 1e9),
    ):
        fig = figure(large, panels=["tension"], units=units)
        fig.draw_without_rendering()
        ax = fig.axes[0]
        assert ax.get_ylabel() == f"tension ({unit})"
        assert ax.yaxis.get_offset_text().get_text() == ""
        displayed = [float(tick.get_text().replace("−", "-")) for tick in ax.get_yticklabels()]
        np.testing.assert_allclose(displayed, np.array(ax.get_yticks()) / size, rtol=1e-6)


def test_small_numbers_are_labelled_with_a_power_of_ten(result):
    small = result.assign(energy=(1e-9 * result["energy"]).assign_attrs(result["energy"].attrs))
    ax = figure(small, panels=["energy"]).axes[0]
    assert ax.get_ylabel().startswith("energy (10⁻")
    assert ax.get_ylabel().endswith(" J)")


@pytest.mark.parametrize("size", [None, "report", "journal"])
def test_legends_meet_neither_axes_nor_titles(size, make):
    several = make(wave.layout(loads=("first wheel", "second wheel", "third wheel")))
    fig = figure(several, size=size)
    fig.draw_without_rendering()
    for ax in fig.axes:
        if (legend := ax.get_legend()) is not None:
            box = legend.get_window_extent()
            assert box.y0 >= ax.get_window_extent().y1 - 1.0
            assert box.y1 <= ax._left_title.get_window_extent().y0 + 2.0  # pixels
            assert box.x1 <= fig.bbox.width + 1.0


def test_no_panel_of_the_overview_is_empty(result, make):
    without = result.assign(
        hold_force=0.0 * result["hold_force"],
        reaction=(0.0 * result["reaction"]).assign_attrs(result["reaction"].attrs),
    )
    assert "reactions" in panels_of(result)
    assert not {"hold_force", "reactions"} & set(panels_of(without))
    for case in (result, without, make(wave.layout(loads=()))):
        notes = [text.get_text() for ax in figure(case).axes for text in ax.texts]
        assert not {"zero throughout", "no loads"} & set(notes)


def test_five_tensions_can_be_told_apart_without_colours(make):
    several = make(wave.layout(loads=("a", "b")))
    lines = [line for line in figure(several, panels=["tension"]).axes[0].lines if line.get_label()[0] != "_"]
    assert len(lines) == 7
    looks = [(line.get_marker(), line.get_linestyle()) for line in lines]
    assert len(set(looks)) == len(lines)
    assert all(to_hex(line.get_color()).upper() != "#F0E442" for line in lines)  # the yellow that vanishes on white


def test_every_figure_is_there_as_data(result):
    fig = figure(result, panels=["tension", "contact_force"], units=DisplayUnits.read("kN"))
    found = figure_data(result, panels=["tension", "contact_force"], units=DisplayUnits.read("kN"))
    for ax, (_, table) in zip(fig.axes, found.items(), strict=True):
        assert list(table.columns) == ["curve", "time [s]", ax.get_ylabel().replace("(", "[").replace(")", "]")]
        assert set(table["curve"]) == {line.get_label() for line in ax.lines}
    largest = found["tension"].query("curve == 'largest'")["tension [kN]"]
    np.testing.assert_allclose(largest, result["tension"].values.max(axis=1) / 1e3)
    every = figure_data(result)
    assert list(every) == panels_of(result)
    assert every["shapes"]["curve"].str.startswith("rope at time").any()


def test_the_command_line_draws_panels_and_writes_their_data(make, tmp_path):
    make(file=tmp_path / "a.nc", times=np.linspace(0.0, 1.0, 11)).close()

    def call(name, *more):
        return CliRunner().invoke(app, ["show", str(tmp_path / "a.nc"), "-o", str(tmp_path / name), *more])

    assert call("a.svg", "--panels", "tension,energy", "--size", "16x9cm").exit_code == 0
    assert 'width="453.5' in (tmp_path / "a.svg").read_text("utf-8")  # points
    assert call("a.csv", "--panels", "tension,energy", "--units", "kN").exit_code == 0
    assert pd.read_csv(tmp_path / "a.csv").columns[-1] == "tension [kN]"
    assert pd.read_csv(tmp_path / "a.energy.csv").columns[0] == "curve"
    refused = [call("a.png", "--size", "A4"), call("a.csv", "--size", "16x9cm"), call("a.html", "--panels", "energy")]
    assert [done.exit_code for done in refused] == [2, 2, 2]
    assert "--size A4: expected a size" in refused[0].output


def test_a_film_has_the_size_asked_for_and_the_force_as_a_number(result, tmp_path):
    from PIL import Image

    film(result, tmp_path / "film.gif", frames=3, size="1281x720")
    with Image.open(tmp_path / "film.gif") as gif:
        assert gif.size == (1280, 720)  # even, as video wants it
    stage = Stage(result, tempo(result, 3))
    stage.picture(1)
    assert stage._clock.get_text().splitlines()[1].startswith("walker ")
    assert stage._clock.get_text().endswith(" N")
    with pytest.raises(Refused, match="cannot be made"):
        film(result, tmp_path / "film.gif", size="20x20")


def test_numbers_of_a_film_keep_their_width():
    forces = np.array([[1.0, 2000.0], [np.nan, -3.0], [900.0, 0.0]])
    message = [Meter(["a", "long"], forces).label(k) for k in range(3)]
    assert message[0].splitlines() == ["a     0.00 kN", "long  2.00 kN"]
    assert all(len(line) == len(first) for first, line in itertools.pairwise("\n".join(message).splitlines()))
