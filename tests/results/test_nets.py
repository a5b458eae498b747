"""Nets in results: their triangles, edges and coarser drawings, and what counts as leaving the plane."""

from __future__ import annotations

import numpy as np
import pytest
import spatial_cases as cases
import travelling_wave as wave

from ropewalk.results import figure, links, open_result, summary
from ropewalk.results.nets import (
    NetTriangles,
    edges,
    in_space,
    is_spatial,
    line_ends,
    most_deflected,
    net_names,
    triangles,
)
from ropewalk.results.statistics import lines


def area(points: np.ndarray, cells: np.ndarray) -> float:
    a, b, c = (points[cells[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def test_a_net_survives_the_file(tmp_path):
    stored, kept = cases.net(file=tmp_path / "net.nc", side=4), cases.net(side=4)
    stored = open_result(tmp_path / "net.nc")
    assert stored["cell_node"].dtype == np.float64
    np.testing.assert_array_equal(triangles(stored), cases.grid(4))
    assert net_names(stored) == net_names(kept) == ["net"]
    assert stored["cell_tension"].dims == ("time", "cell", "direction")
    assert stored.sizes["link"] == 0
    assert summary(stored) == summary(kept)


def test_nodes_of_nets_make_no_line():
    assert lines(cases.net(side=3)) == []
    assert lines(cases.net(side=3, ropes=True)) == [f"rope {k}" for k in range(4)]
    assert net_names(cases.whirl()) == []
    assert triangles(cases.whirl()).shape == (0, 3)
    assert links(cases.net(side=3, ropes=True))["tension"].sizes["link"] == 16


def test_the_edge_of_a_net_goes_once_around_it_and_its_holes():
    cells = np.array(cases.grid(5))
    around = edges(cells)
    assert len(around) == 16
    np.testing.assert_array_equal(np.unique(around, return_counts=True)[1], 2)  # closed
    middle = np.array([6, 7, 8, 11, 12, 13, 16, 17, 18])
    holed = cells[~np.isin(cells, middle).all(axis=1)]
    assert len(edges(holed)) == 16 + 8


def test_vectors_in_the_plane_get_a_y_of_zero():
    np.testing.assert_array_equal(in_space(np.array([[1.0, 2.0]])), [[1.0, 0.0, 2.0]])
    assert in_space(np.ones((2, 4, 3))).shape == (2, 4, 3)


def test_only_what_leaves_the_plane_and_nets_are_spatial(result, make):
    flat = make(wave.layout(axes="xyz"))
    assert not is_spatial(result)
    assert not is_spatial(flat)
    aside = flat["position"] + np.array([0.0, 3.0, 0.0])  # another plane is a plane, too
    spots = flat["contact_position"] + np.array([0.0, 3.0, 0.0])
    assert not is_spatial(flat.assign(position=aside, contact_position=spots))
    assert is_spatial(flat.assign(position=aside))  # the load is 3 m aside now
    assert is_spatial(cases.whirl())
    assert is_spatial(cases.net(side=3, times=[0.0]))


def test_plane_results_keep_their_figure(make):
    at = np.array([0.9])
    titles = [
        [ax.get_title("left") for ax in figure(make(plan, times=at)).axes] for plan in (wave.layout(axes="xyz"), None)
    ]
    assert titles[0] == titles[1] == ["Shapes", "Tension along the line"]


def test_supports_are_marked_and_joints_are_not():
    bridge = cases.bridge(times=[0.0, 0.5, 1.0])
    ends = {line: line_ends(bridge, line).tolist() for line in lines(bridge)}
    assert ends["deck"] == [50, 74]
    assert all(not nodes for line, nodes in ends.items() if line.startswith("hanger"))
    renamed = bridge.assign_coords(support=np.array([f"tower {k}" for k in range(6)]))
    assert line_ends(renamed, "deck").tolist() == [50, 74]  # nothing else ends there
    assert line_ends(renamed.isel(time=[0]), "deck").tolist() == [50, 74]
    tent = cases.net(side=3, ropes=True, times=[0.3])
    assert line_ends(tent, "rope 1").tolist() == [5]  # its other end is a corner of the net


def test_the_most_deflected_instant_is_that_of_the_deepest_net():
    net = cases.net()
    deepest = int(net["position"].values[..., 2].min(axis=1).argmin())
    assert most_deflected(net) == deepest
    assert most_deflected(net.isel(time=[3, 3])) == 1  # nothing has moved: the last one


def test_a_coarser_mesh_covers_the_same_net_without_gaps():
    cells, points = np.array(cases.grid(41)), cases.net(side=41, times=[0.0])["position"].values[0]
    points[:, 2] = 0.0
    mesh = NetTriangles(cells, points, 400)
    assert 200 < len(mesh.cells) < 800
    # The corners of boxes at the edge lie on it, and the corners of the net stay: no area is lost.
    assert area(points, mesh.cells) == pytest.approx(36.0, rel=1e-9)
    assert len(edges(mesh.cells)) == len(np.unique(edges(mesh.cells)))
    np.testing.assert_array_equal(mesh.edges, edges(cells))  # the outline is that of the net itself


def test_a_coarser_mesh_keeps_means_of_values():
    cells, points = np.array(cases.grid(41)), cases.net(side=41, times=[0.0])["position"].values[0]
    mesh = NetTriangles(cells, points, 400)
    np.testing.assert_allclose(mesh.values(np.full(len(cells), 7.0)), 7.0)
    across = points[cells, 0].mean(axis=1)
    apart = np.abs(mesh.values(across) - points[mesh.cells, 0].mean(axis=1))
    assert apart.max() < 0.6  # half a box: side 6 m, 14 boxes
    unknown = np.where(across < 3.0, np.nan, across)
    assert np.isnan(mesh.values(unknown)).any()
    assert np.nanmin(mesh.values(unknown)) >= 3.0
    across[7] = np.nan
    assert np.isfinite(mesh.values(across)).all()  # the others of its box are known
    whole = NetTriangles(cells, points, len(cells))
    assert whole.values(across) is across
