"""Division of plans into triangles: topology, areas, angles, symmetry and refusals."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ropewalk.mechanics.chain import Array
from ropewalk.system.assembling.surface import Surface, locate, polygon, rectangle


def shoelace(points: Array) -> float:
    u, v = (points - points[0]).T
    return float(0.5 * np.sum(u * np.roll(v, -1) - v * np.roll(u, -1)))


def regular(corners: int, radius: float = 1.0, turn: float = 0.0) -> Array:
    angle = turn + 2.0 * np.pi * np.arange(corners) / corners
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def smallest_angle(surface: Surface) -> float:
    p = surface.plan[surface.triangle]
    one, two = np.roll(p, -1, axis=1) - p, np.roll(p, -2, axis=1) - p
    cosine = (one * two).sum(axis=-1) / np.sqrt((one**2).sum(axis=-1) * (two**2).sum(axis=-1))
    return float(np.degrees(np.arccos(cosine.max())))


def opposite_angles(surface: Surface) -> Array:
    """Sum of the two angles opposite to each inner edge, degrees."""
    p = surface.plan[surface.triangle]
    one, two = np.roll(p, -1, axis=1) - p, np.roll(p, -2, axis=1) - p
    angle = np.arctan2(one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0], (one * two).sum(axis=-1))
    t, k = np.nonzero(surface.across >= 0)
    beyond = surface.across[t, k]
    back = np.argmax(surface.across[beyond] == t[:, np.newaxis], axis=1)
    return np.degrees(angle[t, k] + angle[beyond, back])


def require_sound(surface: Surface, area: float) -> None:
    """A disc of triangles: positive, without gaps and overlaps, with its neighbours on record."""
    triangle, across, rim = surface.triangle, surface.across, surface.rim
    assert surface.areas.min() > 0.0
    assert surface.areas.sum() == pytest.approx(area, rel=1e-12)  # sum of up to a few thousand roundings
    edges: dict[tuple[int, int], int] = {}
    for t, corners in enumerate(triangle.tolist()):
        for k in range(3):
            edge = corners[(k + 1) % 3], corners[(k + 2) % 3]
            assert edge not in edges
            edges[edge] = t
    for (a, b), t in edges.items():
        opposite = next(k for k in range(3) if triangle[t, k] not in (a, b))
        assert across[t, opposite] == edges.get((b, a), -1)
    border = {(a, b) for a, b in edges if (b, a) not in edges}
    assert border == set(zip(rim.tolist(), np.roll(rim, -1).tolist(), strict=True))
    assert np.array_equal(np.unique(triangle), np.arange(len(surface.plan)))
    assert len(surface.plan) - (len(edges) + len(border)) // 2 + len(triangle) == 1


@pytest.mark.parametrize("cells", [(1, 1), (2, 3), (4, 6), (7, 1)])
def test_a_rectangle_is_divided_soundly(cells: tuple[int, int]) -> None:
    surface = rectangle((3.0, 2.0), cells)
    require_sound(surface, 6.0)
    assert len(surface.triangle) == 2 * cells[0] * cells[1]
    assert len(surface.rim) == 2 * sum(cells)
    assert surface.areas == pytest.approx(3.0 / cells[0] / cells[1], rel=1e-13)
    assert surface.plan[1 + (cells[0] + 1)] == pytest.approx([3.0 / cells[0], 2.0 / cells[1]])  # vertex (1, 1)


@pytest.mark.parametrize("axis", [0, 1])
def test_even_cells_are_symmetric_about_the_middles(axis: int) -> None:
    sides, m = (3.0, 2.0), 4
    surface = rectangle(sides, (m, 6))
    mirrored = surface.plan.copy()
    mirrored[:, axis] = sides[axis] - mirrored[:, axis]
    away = ((mirrored[:, np.newaxis] - surface.plan) ** 2).sum(axis=-1)
    image = away.argmin(axis=1)
    assert away.min(axis=1).max() < 1e-30
    triangles = {frozenset(corners) for corners in surface.triangle.tolist()}
    assert {frozenset(image[corners].tolist()) for corners in surface.triangle} == triangles


CONVEX = {
    "square": regular(4, 1.0, np.pi / 4),
    "triangle": regular(3),
    "pentagon": regular(5, 1.0, 0.3),
    "hexagon": regular(6),
    "right triangle": np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 2.0]]),
    "strip": np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 1.5], [0.0, 1.5]]),
    "circle": regular(60),  # its sides are shorter than the spacing: the division is graded
}


@pytest.mark.parametrize("outline", CONVEX.values(), ids=CONVEX.keys())
@pytest.mark.parametrize("part", [0.25, 0.1])
def test_convex_outlines_are_divided_into_thick_triangles(outline: Array, part: float) -> None:
    spacing = part * float(np.ptp(outline, axis=0).min())
    surface = polygon(outline, spacing)
    require_sound(surface, shoelace(outline))
    assert smallest_angle(surface) > 25.0  # Ruppert's 26 degrees; smoothing never makes it worse
    # Most of a large inside is the grid, with triangles of sqrt(3)/4 spacing^2, but for what the rim moves.
    if part == 0.1 and len(outline) < 10:
        assert np.median(surface.areas) == pytest.approx(0.433 * spacing**2, rel=0.15)


def test_every_side_is_divided_equally_and_keeps_its_corners() -> None:
    outline = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]])
    surface = polygon(outline, 0.3)
    require_sound(surface, 4.0)
    rim = surface.plan[surface.rim]
    segments = np.hypot(*(np.roll(rim, -1, axis=0) - rim).T)
    # 2 m in 7, 1 m in 4, 2 m in 7, 3 m in 10 pieces
    expected = np.repeat([2 / 7, 1 / 4, 1 / 4, 2 / 7, 1 / 4, 3 / 10], [7, 4, 4, 7, 4, 10])
    assert segments == pytest.approx(expected, rel=1e-13)
    assert rim[[0, 7, 11, 15, 22, 26]] == pytest.approx(outline, abs=0.0)


def test_direction_start_and_repetition_of_the_outline_do_not_matter() -> None:
    outline = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [1.0, 1.0]])
    forward = polygon(outline, 0.3)
    again, closed = polygon(outline, 0.3), polygon(np.vstack([outline, outline[:1]]), 0.3)
    backward = polygon(outline[[0, 3, 2, 1]], 0.3)
    for other in (again, closed, backward):
        assert np.array_equal(forward.plan, other.plan)
        assert np.array_equal(forward.triangle, other.triangle)


def test_sides_close_to_each_other_stay_apart() -> None:
    """A slot much narrower than the spacing, across which Delaunay's edges would run."""
    slot = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [2.02, 3.0], [2.02, 2.8],  # vertices are not opposite
                     [2.0, 0.5], [1.98, 3.0], [0.0, 3.0]])  # fmt: skip
    neck = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 0.99], [2.2, 0.99], [5.0, 0.99], [5.0, 0.0], [7.0, 0.0],
                     [7.0, 2.0], [5.0, 2.0], [5.0, 1.01], [2.0, 1.01], [2.0, 2.0], [0.0, 2.0]])  # fmt: skip
    spikes = np.array([[0.47, 0.78], [0.03, 0.1], [0.0, 0.02], [0.16, 3.66],
                       [-0.18, -0.28], [0.33, -0.23], [0.11, -0.05], [2.5, -0.78]])  # fmt: skip
    for outline in (slot, neck, spikes):
        surface = polygon(outline, 0.3)
        require_sound(surface, shoelace(outline))
        # Nor are there thinner triangles than need be: the angles opposite to an edge add up to 180 degrees at most,
        # but for the bulge of straight sides, a millionth of their length.
        assert opposite_angles(surface).max() < 180.0 + 0.1


@st.composite
def stars(draw: st.DrawFn) -> Array:
    """Corners in all directions from the origin, which sees all of the outline."""
    count = draw(st.integers(3, 9))
    gap = np.array(draw(st.lists(st.floats(0.3, 1.0), min_size=count, max_size=count)))
    angle = 2.0 * np.pi * np.cumsum(gap) / gap.sum()
    radius = np.array(draw(st.lists(st.floats(0.3, 1.0), min_size=count, max_size=count)))
    outline = radius[:, np.newaxis] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    assume(np.diff(angle, append=angle[0] + 2.0 * np.pi).max() < 3.0)  # the origin is inside
    return outline + draw(st.floats(-3.0, 3.0))


@settings(deadline=None, max_examples=60)
@given(stars(), st.floats(0.08, 0.15))
def test_any_star_is_divided_soundly(outline: Array, spacing: float) -> None:
    try:
        surface = polygon(outline, spacing)
    except ValueError as error:
        if "no vertex fits" in str(error):  # a thin star that the grid misses
            return
        raise
    require_sound(surface, shoelace(outline))


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 3), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_a_point_is_found_in_the_triangle_that_holds_it(which: int, one: float, two: float) -> None:
    surface = polygon(CONVEX["pentagon"], 0.3) if which % 2 else rectangle((2.0, 1.0), (4, 3))
    t = (which * 7919 + int(1e6 * one)) % len(surface.triangle)
    share = np.array([one, (1.0 - one) * two, (1.0 - one) * (1.0 - two)])
    point = share @ surface.plan[surface.triangle[t]]
    found, coordinates = locate(surface, point)
    assert coordinates.sum() == pytest.approx(1.0, rel=1e-14)
    assert coordinates.min() >= -1e-12
    assert coordinates @ surface.plan[surface.triangle[found]] == pytest.approx(point, abs=1e-14)
    if share.min() > 1e-9:  # not on an edge
        assert found == t
        assert coordinates == pytest.approx(share, abs=1e-12)


def test_corners_are_on_the_surface_and_points_beyond_are_not() -> None:
    surface = polygon([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]], 0.3)
    for vertex in surface.rim:
        found, coordinates = locate(surface, surface.plan[vertex])
        assert surface.triangle[found, int(coordinates.argmax())] == vertex
        assert coordinates.max() == pytest.approx(1.0, abs=1e-12)
    for point in ([1.5, 1.5], [-1e-6, 1.0], [3.0, 0.5], [3.5, 1e18]):  # in the notch, just off, far off
        found, coordinates = locate(surface, point)
        assert found == -1
        assert np.all(np.isnan(coordinates))
    with pytest.raises(ValueError, match="two coordinates"):
        locate(surface, [1.0, 2.0, 3.0])


SQUARE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]


@pytest.mark.parametrize(
    ("outline", "spacing", "said"),
    [
        ([[0, 0], [1, 0]], 0.1, "at least 3 different points, not 2"),
        ([[0, 0], [1, 0], [0, 0]], 0.1, "at least 3 different points, not 2"),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], 0.1, "not an array of shape"),
        ([[0, 0], [1, 0], [np.nan, 1]], 0.1, "must be finite"),
        ([[0, 0], [1, 0], [1, 0], [0, 1]], 0.1, "points 2 and 3 of the outline are the same"),
        ([[0, 0], [1, 1], [1, 0], [0, 1]], 0.1, "crosses or touches itself: side 1, .* and side 3"),
        ([[0, 0], [4, 0], [4, 3], [2, 0], [0, 3]], 0.1, "touches itself: side 1"),  # a corner on another side
        ([[0, 0], [1, 0], [2, 0]], 0.1, "crosses or touches itself"),  # all in line
        ([[0, 0], [2, 0], [2, 2], [2, 1], [0, 1]], 0.1, "crosses or touches itself"),  # back along itself
        (SQUARE, 1.5, "too large for an outline of 1 m x 1 m"),
        (SQUARE, 1e-4, "more than 2e\\+05; use a larger spacing"),
        ([[0, 0], [4, 0], [4, 10_000], [0, 3]], 0.8, "would have 12500 vertices, more than 2000; use a larger spacing"),
        (SQUARE, 0.0, "^the spacing must"),
        (SQUARE, np.inf, "^the spacing must"),
    ],
)
def test_impossible_outlines_are_refused(outline: list[list[float]], spacing: float, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        polygon(outline, spacing)


@pytest.mark.parametrize(
    ("sides", "cells", "said"),
    [
        ((0.0, 1.0), (2, 2), "^the sides"),
        ((1.0, np.inf), (2, 2), "^the sides"),
        ((1.0, 1.0), (0, 2), "^a rectangle needs"),
        ((1.0, 1.0), (2, 2.5), "^a rectangle needs"),
        ((1.0, 1.0), (2000, 2000), "use fewer cells"),
    ],
)
def test_impossible_rectangles_are_refused(sides: tuple[float, float], cells: tuple[int, int], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        rectangle(sides, cells)
