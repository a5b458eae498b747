"""Films in three dimensions: the frames they announce, everything moves, and nothing is left over."""

from __future__ import annotations

import numpy as np
import pytest
import spatial_cases as cases
from matplotlib.markers import CARETUP
from PIL import Image

from ropewalk.results import film
from ropewalk.results import space_film as under_test
from ropewalk.results.animation import tempo
from ropewalk.results.space_film import SpaceStage

FEW = np.linspace(0.0, 2.0, 5)


def stage(result) -> SpaceStage:
    timing = tempo(result)
    return SpaceStage(result, timing.frames, timing.label)


@pytest.mark.parametrize("name", ["bridge", "net"])
def test_a_film_moves_and_leaves_nothing_behind(name):
    displayed = stage(getattr(cases, name)(times=FEW))
    first, later = displayed.picture(0), displayed.picture(2)
    assert first.shape == (*displayed.size[::-1], 3)
    assert all(size % 2 == 0 for size in displayed.size)  # video wants even numbers
    assert (first != later).any()
    np.testing.assert_array_equal(displayed.picture(0), first)


def test_lines_nets_loads_and_bodies_are_where_they_belong():
    result = cases.bridge(times=FEW)
    displayed = stage(result)
    displayed.picture(3)
    place = result["position"].values[3]
    strokes = np.array(displayed._ropes._segments3d)
    np.testing.assert_array_equal(strokes[:24, 0], place[:24])
    np.testing.assert_array_equal(strokes[23, 1], place[24])
    np.testing.assert_array_equal(strokes[24, 0], place[25])  # the next line begins anew
    spot, body = result["contact_position"].values[3, 0], result["body_position"].values[3, 0]
    np.testing.assert_array_equal(np.ravel(displayed._dots.get_data_3d()), spot)
    np.testing.assert_array_equal(np.ravel(displayed._masses.get_data_3d()), body)
    np.testing.assert_array_equal(displayed._ties._segments3d[0], [spot, body])
    assert len(displayed._traces[0].get_data_3d()[0]) == 4
    np.testing.assert_array_equal(displayed._arrows._segments3d[0][1], spot)
    assert displayed._clock.get_text() == "time 1.5 s\nwalker  801 N"
    tent = cases.net(times=FEW, side=5, ropes=True)
    displayed = stage(tent)
    displayed.picture(2)
    corners = tent["position"].values[2][np.array(tent["cell_node"].values, dtype=int)]
    drawn = displayed._net._faces[..., :3]
    np.testing.assert_allclose(drawn, corners)


def test_colours_belong_to_the_frame():
    net = cases.net(times=FEW, side=5)
    displayed = stage(net)
    displayed.picture(1)
    colours = displayed._net_shade.to_rgba(net["cell_tension"].values[1].max(axis=1))
    np.testing.assert_allclose(displayed._net._facecolor3d, colours)
    assert len(np.unique(colours, axis=0)) > 3
    high = stage(cases.net(times=FEW, side=5, known=False))
    high.picture(1)
    assert "z (m)" in [ax.get_ylabel() for ax in high._figure.axes]


def test_supports_that_move_are_not_marked():
    def marked(result):
        feet = [line for line in stage(result)._scene.axes.lines if line.get_marker() == CARETUP]
        return sum(len(line.get_data_3d()[0]) for line in feet)

    whirl = cases.whirl(times=FEW)
    swaying = whirl["position"].values.copy()
    swaying[:, -1, 0] += 0.1 * FEW
    assert marked(whirl) == 2
    assert marked(whirl.assign(position=(whirl["position"].dims, swaying, whirl["position"].attrs))) == 1


def test_a_load_off_the_line_is_not_drawn_and_no_fault():
    bridge = cases.bridge(times=FEW)
    there = bridge["time"] < 0.9
    gone = {name: bridge[name].where(there) for name in ("contact_position", "contact_force")}
    displayed = stage(bridge.assign(gone))
    displayed.picture(4)
    assert len(displayed._arrows._segments3d) == 0


def test_a_fine_net_is_filmed_coarser(monkeypatch):
    monkeypatch.setattr(under_test, "CELLS", 100)
    displayed = stage(cases.net(times=FEW, side=21))
    displayed.picture(1)
    assert 50 < len(displayed._net._facecolor3d) < 200


def test_film_picks_three_dimensions_and_writes_every_frame(tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(SpaceStage, "_move", lambda self, k, move=SpaceStage._move: (seen.append(k), move(self, k))[1])
    film(cases.net(times=FEW, side=4), tmp_path / "film.gif")
    with Image.open(tmp_path / "film.gif") as gif:
        assert gif.n_frames == 5
    assert set(seen) == set(range(5))


def test_mp4_gets_every_frame(tmp_path):
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    film(cases.net(times=FEW, side=4), tmp_path / "film.mp4")
    assert imageio_ffmpeg.count_frames_and_secs(str(tmp_path / "film.mp4"))[0] == 5
