"""Figure 7 shows an overhead line with what the model gives, and names what it is drawn for."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba

from ropewalk.model.run import Geometry
from ropewalk.paper import AVAILABLE, figure7, figures
from ropewalk.paper.figure7 import runs
from ropewalk.results.contact_statistics import contact_statistics
from ropewalk.results.style import RED


@cache
def coarse() -> dict[Geometry, xr.Dataset]:
    """Both motions, with links of 0.5 m."""
    return runs(0.5)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(figure7, "runs", coarse)


@pytest.mark.usefixtures("quick")
def test_figure_7_is_written(tmp_path: Path) -> None:
    (written,) = figures(tmp_path, only=[7])
    assert written.name == "figure-7.png"
    assert written.stat().st_size > 50_000
    assert 7 in AVAILABLE


@pytest.mark.usefixtures("quick")
def test_figure_7_names_its_data_marks_slack_droppers_and_compares_two_motions() -> None:
    figure = figure7.draw()
    line, _, force = figure.axes
    text = figure._supxlabel.get_text()
    for part in ("10 spans of 60 m", "1.35 kg/m, 20 kN", "1.07 kg/m, 16 kN", "droppers 100 kN/m at 5, 10.5, 17",
                 "15 and 7.2 kg on 50 and 4200 N/m", "120 N, contact 50 kN/m, V = 250 km/h"):  # fmt: skip
        assert part in text
    assert "times as high" in line.get_ylabel()
    drawn = {c.get_label(): c for c in line.collections if isinstance(c, LineCollection)}
    assert tuple(drawn["slack ones"].get_colors()[0]) == to_rgba(RED)
    # Before and behind the support at 300 m, whose neighbours the pantograph and its waves relieve.
    assert {segment[0, 0] for segment in drawn["slack ones"].get_segments()} >= {295.0, 305.0}
    for kind, label in (("nonlinear", "fully nonlinear"), ("linearised", "linearised")):
        found = contact_statistics(coarse()[kind])["pantograph"]
        assert f"{label}: {found.mean:.1f} N, σ {found.deviation:.1f} N" in force.get_legend_handles_labels()[1]


def test_droppers_of_figure_7_are_slack_where_their_ends_are_closer_than_their_length() -> None:
    result = coarse()["nonlinear"]
    rest, now = (figure7.shape_at(result, place) for place in (figure7.START, figure7.DISPLAYED))
    far, at_rest = (np.linalg.norm(s.droppers[:, 1] - s.droppers[:, 0], axis=1) for s in (now, rest))
    length = at_rest - rest.pull / 100e3
    slack = now.pull <= 0.0
    assert 2 <= slack.sum() < 20
    # Nodes stand where droppers are, but in motion wires are splines beside them: 0.1 mm, and a slack one by 17 mm.
    assert (far[slack] < length[slack] + 3e-4).all()
    assert (far[slack] < length[slack] - 1e-2).any()
    np.testing.assert_allclose(far[~slack], (length + now.pull / 100e3)[~slack], atol=3e-4)
    assert now.place == pytest.approx(
        figure7.DISPLAYED, abs=1e-4
    )  # along a wire that hangs by hundredths of a millimetre


def test_both_motions_of_figure_7_are_one_key_apart_and_nearly_the_same() -> None:
    large, small = (figure7.scenario(kind).model_dump() for kind in ("nonlinear", "linearised"))
    assert [key for key in large["run"] if large["run"][key] != small["run"][key]] == ["geometry"]
    assert large | {"run": None} == small | {"run": None}
    (x, F), (station, G) = (figure7.force_along(coarse()[kind]) for kind in ("nonlinear", "linearised"))
    inside = (x > 240.0) & (x < 360.0)
    apart = (F - np.interp(x, station, G))[inside]
    # tests/overhead/test_en50318_2002.py: sigma differs by 0.7 N of 28; the course of the force by 4 N rms.
    assert 0.5 < apart.std() < 6.0
