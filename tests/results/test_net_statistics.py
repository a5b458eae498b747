"""The summary of nets and of lines in space says what can be computed by hand."""

from __future__ import annotations

import json

import numpy as np
import pytest
import spatial_cases as cases

from ropewalk.results import html_report, statistics, summary, text
from ropewalk.results.nets import depth_below
from ropewalk.results.sag import sideways


def plate(heights, pulls, shift=None):
    """A square of 2 m with five nodes and four triangles, whose middle has these heights."""
    plan = cases.layout({}, 5, "sail", cell=((0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)), cell_net=("sail",) * 4)
    flat = np.array([[0, 0, 1.0], [2, 0, 1.0], [2, 2, 3.0], [0, 2, 3.0], [1, 1, 0]])  # its edge slopes along y
    frames = []
    for k, (height, pull) in enumerate(zip(heights, pulls, strict=True)):
        place = flat.copy()
        place[4, 2] = height
        frames.append(
            cases.frame(plan, 0.5 * k, place + (0.0 if shift is None else shift), cell_tension=np.array(pull))
        )
    return cases.record(plan, frames, "A sail")


QUIET = [[10.0, 5.0]] * 4
PULLED = [[10.0, 5.0], [40.0, 0.0], [10.0, -1.0], [10.0, 5.0]]


def test_extremes_of_a_net_have_their_place_and_instant():
    found = summary(plate([2.0, 1.4, 1.7], [QUIET, PULLED, QUIET]))["nets"]["sail"]
    middle = {"x": pytest.approx(5 / 3), "y": 1.0, "z": pytest.approx((1.0 + 3.0 + 1.4) / 3)}
    assert found["largest_tension"] == {"value": 40.0, "unit": "N/m", **middle, "time": 0.5}
    assert found["smallest_tension"]["value"] == -1.0
    assert found["slack"] == {"value": 0.5, "unit": "1", "time": 0.5}
    assert found["largest_sag"] == {
        "value": pytest.approx(0.6), "unit": "m", "x": 1.0, "y": 1.0, "z": 1.4, "time": 0.5,
    }  # fmt: skip
    assert (found["nodes"], found["cells"]) == (5, 4)


def test_a_net_read_in_pieces_gives_the_same_answer(monkeypatch):
    net = cases.net(side=5)
    whole = summary(net)
    monkeypatch.setattr(statistics, "BLOCK_BYTES", 10_000)
    assert len(list(statistics.blocks(net))) > 5
    assert summary(net) == whole


def test_the_depth_of_a_net_counts_from_the_plane_through_its_edge():
    rim = np.array([[0, 0, 0], [1, 0, 0.5], [1, 1, 1.5], [0, 1, 1.0]])
    points = np.array([[0.5, 0.5, 0.0], [0.25, 0.5, 1.0]])
    np.testing.assert_allclose(depth_below(points, rim), [0.75, -0.375])
    upright = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1.0]])
    assert depth_below(points, upright) is None
    assert depth_below(points, rim[:2]) is None


def test_a_net_alone_has_a_table_without_lines_and_supports():
    net = cases.net(side=5)
    table = text(summary(net))
    assert not {"Lines", "Supports"} & set(table.splitlines())
    assert "tension jump" not in table
    for row in ("nodes 25 32 triangles", "largest sag 1.350 m at x = 3.000, y = 3.000, z = -1.350 m t = 1.000 s"):
        assert row.split() in [line.split() for line in table.splitlines()]
    assert any(line.startswith("largest tension per width") for line in table.splitlines())
    assert summary(net)["largest_tension"] is None


def test_lines_beside_nets_have_their_rows():
    table = text(summary(cases.net(side=5, ropes=True))).splitlines()
    assert "Lines" in table
    assert "Net net" in table
    assert not any(line.startswith("largest way sideways") for line in table)  # the ropes are straight


def test_a_net_of_which_nothing_is_known_has_none_and_json_takes_it():
    found = summary(cases.net(side=5, known=False))
    assert found["nets"]["net"]["largest_tension"] is None
    assert json.loads(json.dumps(found, allow_nan=False))["nets"]["net"]["cells"] == 32
    assert "Net net" in text(found)
    assert summary(cases.net(side=3, times=[]))["nets"]["net"]["largest_sag"] is None


def test_results_without_nets_have_none(result):
    assert summary(result)["nets"] == {}
    assert summary(result)["largest_sideways"] is None


def turned(result, angle):
    c, s = np.cos(angle), np.sin(angle)
    """The same with supports at different heights, turned about z."""
    place = result["position"].values.copy()
    place[..., 2] += 0.25 * place[..., 0]
    place = place @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return result.assign(position=(result["position"].dims, place, result["position"].attrs))


@pytest.mark.parametrize("angle", [0.0, 0.5, np.pi / 2, 2.5])
def test_sag_and_way_sideways_do_not_depend_on_the_direction_of_the_span(angle):
    whirl = turned(cases.whirl(), angle)
    found = summary(whirl)
    assert found["largest_sag"]["value"] == pytest.approx(1.1)  # 0.8 m of the whirl and 0.3 m
    assert found["largest_sag"]["time"] == 1.5
    assert found["largest_sideways"]["value"] == pytest.approx(0.8)
    assert found["largest_sideways"]["xi"] == 15.0
    assert sideways(whirl, "string").value[0, 15] == pytest.approx(0.8)  # to the left at first
    assert sideways(whirl, "string").value[10, 15] == pytest.approx(-0.8)


def test_the_way_sideways_of_a_hanging_line_is_its_distance_from_the_plumb_line():
    plan = cases.layout({"hanger": 2})
    place = np.array([[1, 1, 0], [1.3, 1.4, -1], [1, 1, -2.0]])
    hanger = cases.record(plan, [cases.frame(plan, 0.0, place)], "Hanger")
    assert summary(hanger)["largest_sideways"]["value"] == pytest.approx(0.5)
    assert summary(hanger)["largest_sag"] is None


def test_a_report_of_a_net_has_its_rows():
    page = html_report(cases.net(side=4, times=[1.0]))
    assert "largest tension per width" in page
    assert "Net net" in page
