"""The overview of a result in space shows what there is: lines or nets, a plan, and only panels with data."""

from __future__ import annotations

import numpy as np
import pytest
import spatial_cases as cases
import xarray as xr
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from ropewalk.results import figure, single
from ropewalk.results.figures import panels_of
from ropewalk.results.scene import MESH, space
from ropewalk.results.shape_views import CELLS, Chosen, shading

FEW = np.linspace(0.0, 2.0, 5)


def three(drawn: Figure) -> Axes3D:
    return next(ax for ax in drawn.axes if isinstance(ax, Axes3D))


def titles(drawn: Figure) -> list[str]:
    return [title for ax in drawn.axes if (title := ax.get_title("left"))]


@pytest.fixture(scope="module")
def tent() -> Figure:
    return figure(cases.net(times=FEW, side=5, ropes=True))


def test_a_few_lines_are_drawn_at_several_instants_with_their_paths():
    whirl = cases.whirl(times=np.linspace(0.0, 2.0, 41))
    drawn = single(whirl, "space")
    curves = [line for line in three(drawn).lines if len(line.get_data_3d()[0]) == 31]
    assert len(curves) == 7
    np.testing.assert_allclose(np.transpose(curves[3].get_data_3d()), whirl["position"].values[20])
    assert "Shapes" in titles(drawn)


def test_many_lines_are_drawn_once_and_shaded_by_tension():
    bridge = cases.bridge(times=FEW)
    drawn = single(bridge, "space")
    ropes = [part for part in three(drawn).collections if isinstance(part, Line3DCollection)]
    assert len(ropes) == 25 + 1  # lines, and what ties the body to its contact
    assert titles(drawn) == ["Shape at time 1.000 s, the most deflected"]
    shade = shading(bridge["tension"].values[2], "plasma")
    deck = np.flatnonzero(bridge["link_line"].values == "deck")
    np.testing.assert_allclose(ropes[2].get_colors(), shade.to_rgba(bridge["tension"].values[2, deck]))
    assert "tension (kN)" in [ax.get_ylabel() for ax in drawn.axes]


def test_nets_are_triangles_shaded_by_their_larger_tension(tent):
    faces = next(part for part in three(tent).collections if isinstance(part, Poly3DCollection))
    assert len(faces.get_facecolor()) == 32
    labels = [ax.get_ylabel() for ax in tent.axes]
    assert {"tension of the net (kN/m)", "tension of the lines (kN)", "z (m)"} <= set(labels)
    net = cases.net(times=[1.0], side=5)
    scene = space(net, Figure().add_subplot())
    colours = scene.axes.collections[0]._facecolor3d
    expected = shading(net["cell_tension"].values[0].max(axis=1), "plasma").to_rgba(
        net["cell_tension"].values[0].max(axis=1)
    )
    np.testing.assert_allclose(colours, expected)


def test_a_net_of_unknown_tension_is_shaded_by_height():
    scene = space(cases.net(times=[1.0], side=5, known=False), Figure().add_subplot())
    assert [ax.get_ylabel() for ax in scene.panel.figure.axes if ax.get_label() == "<colorbar>"] == ["z (m)"]


def test_sides_of_a_fine_net_are_not_drawn_and_a_very_fine_one_is_coarser():
    def edge_colours(side):
        scene = space(cases.net(times=[1.0], side=side), Figure().add_subplot())
        faces = scene.axes.collections[0]
        return np.array_equal(faces._edgecolor3d, faces._facecolor3d), len(faces._facecolor3d)

    assert edge_colours(10) == (False, 162)
    assert edge_colours(30) == (True, 2 * 29**2)
    assert MESH < 2 * 29**2
    assert edge_colours(110)[1] <= 1.2 * CELLS < 2 * 109**2  # about so many


def test_every_panel_has_labels_with_units_and_a_title(tent):
    for drawn in (tent, figure(cases.net(times=[0.4], side=5))):
        for ax in drawn.axes:
            if isinstance(ax, Axes3D) or not ax.axison:
                continue
            assert ax.get_title("left") or ax.get_label() == "<colorbar>"
            assert ax.get_ylabel().endswith(")")
        assert "Plan" in titles(drawn)


def test_panels_without_anything_to_show_are_left_out(tent):
    assert {"Tension", "Support forces on the line", "Place of the load sideways"} <= set(titles(tent))
    alone, slow = panels_of(cases.net(times=FEW, side=5)), panels_of(cases.bridge(times=FEW, path="load_path"))
    assert "net_tension" in alone
    assert not {"tension", "reactions", "friction_power"} & set(alone)
    assert "imbalance" in alone
    assert not {"net_tension", "imbalance"} & set(slow)
    assert panels_of(cases.whirl(times=FEW)) == ["space", "plan", "tension", "energy", "reactions"]
    assert panels_of(cases.whirl(times=[0.0])) == ["space", "plan", "tension_along"]
    assert panels_of(cases.net(times=[0.0], side=3)) == ["space", "plan"]


def test_titles_and_legends_of_neighbours_do_not_meet(tent):
    tent.draw_without_rendering()
    boxes = [ax.get_tightbbox() for ax in tent.axes if not isinstance(ax, Axes3D) and ax.axison]
    for k, box in enumerate(boxes):
        for other in boxes[:k]:
            across = min(box.x1, other.x1) - max(box.x0, other.x0)
            up = min(box.y1, other.y1) - max(box.y0, other.y0)
            assert min(across, up) <= 1.0  # pixels


def test_of_many_support_forces_the_sizes_are_drawn():
    bridge = cases.bridge(times=FEW)
    force = bridge["reaction"] * np.array([1.0, 5.0, 1.0, 4.0, 1.0, 3.0])[None, :, None]
    curves = {line.get_label(): line.get_ydata() for line in
              single(bridge.assign(reaction=force), "reactions").axes[0].lines}  # fmt: skip
    assert len(curves) == 6
    own = bridge["support"].values.tolist().index("cable a.end")
    np.testing.assert_allclose(curves["size of cable a.end"], np.linalg.norm(force.values[:, own], axis=1))


def test_of_more_than_seven_curves_the_three_largest_and_a_band_are_drawn():
    bridge = cases.bridge(times=FEW)
    twice = xr.concat([bridge[["reaction"]]] * 2, "support") * np.arange(1.0, 13.0)[None, :, None]
    names = np.array([f"s{k}" for k in range(12)])
    many = bridge.drop_dims("support").assign(reaction=twice["reaction"].drop_vars("support", errors="ignore"))
    many = many.assign_coords(support=("support", names))
    many["reaction"].attrs = bridge["reaction"].attrs
    ax = single(many, "reactions").axes[0]
    sizes = np.linalg.norm(many["reaction"].transpose("time", "support", "axis").values, axis=2)
    labels = [line.get_label() for line in ax.lines]
    assert labels[:2] == ["_least", "_largest"]
    assert len(labels) == 5
    largest = np.argsort(-np.abs(sizes).max(axis=0), kind="stable")[:3]
    assert labels[2:] == [f"size of s{k}" for k in largest]
    np.testing.assert_allclose(ax.lines[0].get_ydata(), sizes.min(axis=1))
    np.testing.assert_allclose(ax.lines[1].get_ydata(), sizes.max(axis=1))


def test_the_tensions_of_many_lines_are_those_of_the_most_pulled():
    drawn = single(cases.bridge(times=FEW), "tension")
    labels = [line.get_label() for line in drawn.axes[0].lines]
    assert labels[:4] == ["largest", "largest in cable a", "largest in cable b", "largest in deck"]
    np.testing.assert_allclose(drawn.axes[0].lines[1].get_ydata(), 3200.0)


def test_the_plan_has_true_widths_or_says_how_much_they_are_exaggerated():
    whirl = cases.whirl(times=FEW)
    assert single(whirl, "plan").axes[0].get_title("right") == "true to scale"
    slim = whirl.assign(position=(whirl["position"] * [1.0, 0.01, 1.0]).assign_attrs(whirl["position"].attrs))
    drawn = single(slim, "plan").axes[0]
    assert drawn.get_aspect() == 50.0  # nice(2 * 0.05 * 12 m / 0.016 m)
    assert drawn.get_title("right") == "drawn 50 times as wide"


def test_loads_off_their_lines_and_bodies_are_no_fault():
    bridge = cases.bridge(times=FEW)
    gone = bridge["contact_position"].where(bridge["time"] < 0.9)
    assert np.isfinite(Chosen.of(bridge).points).all()
    single(bridge.assign(contact_position=gone), "space")
