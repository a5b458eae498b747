"""Films in three dimensions: the frames they announce, everything moves, and nothing is left over."""

from __future__ import annotations

import numpy as np
import pytest
import spatial_cases as cases
from matplotlib.markers import CARETUP
from PIL import Image

from ropewalk.results import film, film_panels
from ropewalk.results.stage import Stage
from ropewalk.results.tempo import tempo

FEW = np.linspace(0.0, 2.0, 5)


def stage(result) -> Stage:
    return Stage(result, tempo(result))


@pytest.mark.parametrize("name", ["bridge", "net"])
def test_a_film_moves_and_leaves_nothing_behind(name):
    displayed = stage(getattr(cases, name)(times=FEW))
    first, later = displayed.picture(0), displayed.picture(2)
    assert first.shape == (*displayed.size[::-1], 3)
    assert all(size % 2 == 0 for size in displayed.size)  # video wants even numbers
    assert (first != later).any()
    np.testing.assert_array_equal(displayed.picture(0), first)


def test_lines_and_nets_are_where_they_belong():
    result = cases.bridge(times=FEW)
    displayed = stage(result)
    displayed.picture(3)
    page = displayed._view(result["position"].values[3])
    strokes = np.array(displayed._ropes.get_segments())
    np.testing.assert_allclose(strokes[:24, 0], page[:24])
    np.testing.assert_allclose(strokes[23, 1], page[24])
    np.testing.assert_allclose(strokes[24, 0], page[25])  # the next line begins anew
    assert displayed._clock.get_text() == "time 1.5 s\nwalker  801 N"
    tent = cases.net(times=FEW, side=5, ropes=True)
    displayed = stage(tent)
    displayed.picture(2)
    corners = displayed._view(tent["position"].values[2][np.array(tent["cell_node"].values, dtype=int)])
    drawn = np.array([path.vertices[:3] for path in displayed._net.get_paths()])
    assert {tuple(c.round(6).ravel()) for c in drawn} == {tuple(c.round(6).ravel()) for c in corners}


def test_triangles_in_front_cover_those_behind():
    displayed = stage(cases.net(times=FEW, side=5))
    displayed.picture(1)
    view, drawn = displayed._view, displayed._net.get_paths()
    corners = displayed._arrays.nodes[1][displayed._arrays.cells]
    last = np.argmin(np.linalg.norm(view(corners).mean(axis=1) - drawn[-1].vertices[:3].mean(axis=0), axis=1))
    away = view.away(corners).mean(axis=1)
    assert away[last] == pytest.approx(away.min())


def test_colours_belong_to_the_frame():
    net = cases.net(times=FEW, side=5)
    displayed = stage(net)
    displayed.picture(1)
    colours = displayed._net_shade.to_rgba(net["cell_tension"].values[1].max(axis=1))
    drawn = displayed._net.get_facecolor()
    np.testing.assert_allclose(np.sort(drawn, axis=0), np.sort(colours, axis=0))
    assert len(np.unique(colours, axis=0)) > 3
    high = stage(cases.net(times=FEW, side=5, known=False))
    high.picture(1)
    assert "z (m)" in [ax.get_ylabel() for ax in high._figure.axes]


def test_supports_that_move_are_not_marked():
    def marked(result):
        feet = [line for line in stage(result)._panel.lines if line.get_marker() == CARETUP]
        return sum(len(line.get_xdata()) for line in feet)

    whirl = cases.whirl(times=FEW)
    swaying = whirl["position"].values.copy()
    swaying[:, -1, 0] += 0.1 * FEW
    assert marked(whirl) == 2
    assert marked(whirl.assign(position=(whirl["position"].dims, swaying, whirl["position"].attrs))) == 1


def test_a_load_off_the_line_is_not_drawn_and_no_fault():
    bridge = cases.bridge(times=FEW)
    there = bridge["time"] < 0.9
    gone = {name: bridge[name].where(there) for name in ("contact_position", "contact_force", "body_position")}
    displayed = stage(bridge.assign(gone))
    displayed.picture(0)
    assert displayed._shapes.get_paths()
    displayed.picture(4)
    assert not displayed._shapes.get_paths()


def test_a_fine_net_is_filmed_coarser_and_needs_few_nodes(monkeypatch):
    monkeypatch.setattr(film_panels, "CELLS", 100)
    monkeypatch.setattr(film_panels, "TOGETHER", 900)  # read in several parts
    fine = cases.net(times=FEW, side=21)
    displayed = stage(fine)
    displayed.picture(1)
    assert 50 < len(displayed._net.get_facecolor()) < 200
    assert displayed._arrays.nodes.shape[1] < fine.sizes["node"] / 2


def test_film_picks_three_dimensions_and_writes_every_frame(tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(Stage, "_move", lambda self, k, move=Stage._move: (seen.append(k), move(self, k))[1])
    film(cases.net(times=FEW, side=4), tmp_path / "film.gif")
    with Image.open(tmp_path / "film.gif") as gif:
        assert gif.n_frames == 5
    assert set(seen) == set(range(5))


def test_mp4_gets_every_frame(tmp_path):
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    film(cases.net(times=FEW, side=4), tmp_path / "film.mp4")
    assert imageio_ffmpeg.count_frames_and_secs(str(tmp_path / "film.mp4"))[0] == 5
