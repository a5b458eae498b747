"""Axes in three dimensions have true scales, or say how much larger they draw; nothing is cut off."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from ropewalk.results.scene import Scene


def scene(extent, **options) -> Scene:
    figure = Figure(figsize=(8.0, 5.0), layout="constrained")
    corners = np.array([[0.0, 0.0, 0.0], extent], dtype=float)
    drawn = Scene(figure.add_subplot(**options), corners)
    drawn.axes.plot(*corners.T)
    return drawn


@pytest.mark.parametrize(
    ("extent", "factor", "note"),
    [
        ((10.0, 6.0, 4.0), (1, 1, 1), "true to scale"),
        ((10.0, 0.0, 4.0), (1, 1, 1), "true to scale"),  # a plane has no thickness to exaggerate
        ((10.0, 6.0, 0.1), (1, 1, 20), "z drawn 20 times as large"),
        ((10.0, 0.5, 1.2), (1, 2, 2), "y and z drawn 2 times as large"),  # a circle across stays a circle
        ((10.0, 0.01, 1.0), (1, 200, 2), "drawn larger: y 200 times, z 2 times"),
        ((1.0, 10.0, 5.0), (2, 1, 1), "x drawn 2 times as large"),
    ],
)
def test_scales_are_equal_unless_something_is_flat(extent, factor, note):
    drawn = scene(extent)
    assert drawn.factor.tolist() == list(factor)
    assert drawn.note == note
    aspect = drawn.axes._box_aspect / (drawn.high - drawn.low)
    np.testing.assert_allclose(aspect / aspect[0], np.array(factor) / factor[0])


@pytest.mark.parametrize("extent", [(10.0, 6.0, 4.0), (60.0, 3.0, 7.0), (1.0, 8.0, 3.0)])
def test_the_scene_fills_its_panel_with_all_its_labels(extent):
    drawn = scene(extent)
    drawn.settle()
    drawn.axes.figure.draw_without_rendering()
    panel = drawn.panel.get_window_extent()
    parts = [axis.get_tightbbox() for axis in (drawn.axes.xaxis, drawn.axes.yaxis, drawn.axes.zaxis)]
    parts.append(drawn._drawn())
    low, high = (pick([box.get_points()[k] for box in parts], axis=0) for k, pick in ((0, np.min), (1, np.max)))
    assert (low >= panel.min - 1.0).all()  # a pixel: the fit is found by iteration
    assert (high <= panel.max + 1.0).all()
    free = (panel.size - (high - low)) / panel.size
    assert free.min() < 0.05


def test_labels_carry_units():
    axes = scene((10.0, 6.0, 0.1)).axes
    assert [axis.get_label_text() for axis in (axes.xaxis, axes.yaxis, axes.zaxis)] == ["x (m)", "y (m)", "z (m)"]
