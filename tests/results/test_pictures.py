"""Figures carry labels with units and true scales; films have the frames and the scale of time they claim."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import travelling_wave as wave
from PIL import Image

from ropewalk.results import ResultError, figure, film, single
from ropewalk.results.figures import VIEWS
from ropewalk.results.stage import Stage
from ropewalk.results.tempo import tempo


def flattened(result, factor):
    axes = np.array([1.0] * (result.sizes["axis"] - 1) + [factor])
    changed = {name: result[name] * axes for name in ("position", "contact_position")}
    return result.assign({name: array.assign_attrs(result[name].attrs) for name, array in changed.items()})


@pytest.mark.parametrize(
    "case",
    [{}, {"plan": wave.layout(loads=(), path="load_path", axes="xyz")}, {"times": np.array([0.9])}],
    ids=["dynamic", "no loads", "equilibrium"],
)
def test_every_axis_has_a_label_with_its_unit(case, make):
    fig = figure(make(**case))
    fig.canvas.draw()
    for ax in fig.axes:
        for axis, displayed in ((ax.xaxis, ax.xaxis.get_tick_params().get("labelbottom", True)), (ax.yaxis, True)):
            label = axis.get_label_text()
            texts = any(tick.get_text() for tick in axis.get_ticklabels())
            assert not (displayed and texts) or label.split(", drawn")[0].endswith(")"), (ax.get_title("left"), label)
        assert ax.get_title("left") or ax.get_label() == "<colorbar>"


@pytest.mark.parametrize("view", VIEWS)
def test_every_view_stands_alone(view, result, tmp_path):
    fig = single(result, view)
    fig.savefig(tmp_path / "view.svg")
    assert all(label.endswith(")") for label in (fig.axes[0].get_xlabel(), fig.axes[0].get_ylabel()))


def test_an_unknown_view_is_refused_with_a_list(result):
    with pytest.raises(ResultError, match="no panel 'tensoin' in this result; did you mean tension"):
        single(result, "tensoin")


@pytest.mark.parametrize(("factor", "drawn"), [(1.0, 1.0), (0.02, 50.0), (1e-4, 10_000.0)])
def test_shapes_have_a_true_scale_or_say_how_much_heights_are_exaggerated(factor, drawn, result):
    ax = single(flattened(result, factor), "shapes").axes[0]
    assert ax.get_aspect() == pytest.approx(drawn)
    note = f", drawn {drawn:g} times as high" if drawn != 1.0 else ""
    unit = "m" if factor == 1.0 else "mm"  # small heights are lengths
    assert ax.get_ylabel() == f"z ({unit}){note}"


def test_legends_hide_no_data(result):
    fig = figure(result)
    fig.canvas.draw()
    for ax in fig.axes:
        if (legend := ax.get_legend()) is not None:
            assert legend.get_window_extent().y0 >= ax.get_window_extent().y1 - 1.0


def test_a_panel_without_curves_says_why(result, make):
    without = result.assign(hold_force=0 * result["hold_force"])
    notes = [single(r, "hold_force").axes[0].texts[0].get_text() for r in (without, make(wave.layout(loads=())))]
    assert notes == ["zero throughout", "no loads"]
    assert not single(result, "hold_force").axes[0].texts


def test_drawing_a_lazy_result_does_not_load_it_whole(make, tmp_path):
    from ropewalk.results import open_result

    make(file=tmp_path / "out.nc")
    with open_result(tmp_path / "out.nc", lazy=True) as lazy:
        figure(lazy).savefig(tmp_path / "lazy.pdf")
        assert not lazy["position"].variable._in_memory


def test_figures_leave_pyplot_alone(tmp_path):
    code = (
        f"import sys; sys.path[:0] = [{str(Path(__file__).parent)!r}]; import conftest; "
        "from ropewalk.results import figure, film; r = conftest.record(); figure(r); "
        f"film(r, {str(tmp_path / 'a.gif')!r}, frames=3); assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-W", "ignore", "-c", code], check=True, timeout=60)


def test_a_film_has_every_frame_it_announces(result, tmp_path):
    done = []
    film(result, tmp_path / "film.gif", frames=19, progress=done.append)
    with Image.open(tmp_path / "film.gif") as gif:
        assert gif.n_frames == len(tempo(result, 19).frames) == 19
        assert gif.info["duration"] == tempo(result, 19).delay
        assert gif.convert("RGB").getpixel((3, 3)) == (255, 255, 255)
    assert done == sorted(done)
    assert done[-1] == 1.0


def test_a_film_moves(result):
    stage = Stage(result, tempo(result, 3))
    first, last = stage.picture(0), stage.picture(1)
    assert first.shape == (*stage.size[::-1], 3)
    assert (first != last).any()
    np.testing.assert_array_equal(stage.picture(0), first)  # nothing is left over from other frames


@pytest.mark.parametrize(
    ("count", "every", "frames", "delay", "label"),
    [
        (151, 0.010, 151, 40, "1/4 of real speed"),
        (181, 0.010, 91, 40, "1/2 of real speed"),
        (16, 0.100, 16, 100, "real speed"),
        (16, 0.400, 16, 40, "10 times real speed"),
        (101, 0.007, 101, 40, "0.175 of real speed"),
    ],
)
def test_the_scale_of_time_is_the_one_stated(count, every, frames, delay, label, make):
    timing = tempo(make(wave.layout(links=2), times=every * np.arange(count)))
    assert (len(timing.frames), timing.delay, timing.label) == (frames, delay, label)


def test_films_keep_time_where_frames_are_missing(make):
    times = np.delete(0.01 * np.arange(101), np.arange(40, 60))
    result = make(wave.layout(links=2), times=times)
    displayed = times[tempo(result, 101).frames]
    assert len(displayed) == 101
    assert np.abs(displayed - 0.01 * np.arange(101)).max() <= 0.11


def test_a_slow_motion_of_the_load_claims_no_scale_of_time(make):
    assert "no scale of time" in tempo(make(wave.layout(links=2, path="load_path"))).label


def test_a_load_off_the_line_is_not_drawn_and_no_fault(make):
    stage = Stage(result := make(times=np.linspace(-0.2, 0.2, 5)), tempo(result))
    for k in range(5):
        stage.picture(k)


@pytest.mark.parametrize("name", ["film.avi", "missing/film.gif", "short.gif"])
def test_films_that_cannot_be_made_are_refused_clearly(name, result, tmp_path):
    given = result.isel(time=slice(0, 1)) if name == "short.gif" else result.isel(time=slice(0, 3))
    with pytest.raises(ResultError, match=r"ends in .gif or .mp4|cannot be written|at least two frames"):
        film(given, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_mp4_without_its_package_says_what_to_install(result, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(ResultError, match=r"pip install 'ropewalk\[film\]'"):
        film(result, tmp_path / "film.mp4")


def test_mp4_gets_every_frame(result, tmp_path):
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    film(result, tmp_path / "film.mp4", frames=10)
    assert imageio_ffmpeg.count_frames_and_secs(str(tmp_path / "film.mp4"))[0] == len(tempo(result, 10).frames)
