"""Division of a net or a membrane into triangles, in the plan in which it is laid out.

A rectangle is divided by hand into halved cells. Any other outline gets equal pieces on each side, an equilateral grid
inside and Delaunay's triangulation of both. Where sides come close to each other, that triangulation may cross the
outline; then its edges are turned until the outline is among them. Thin triangles get a vertex at the centre of their
circumcircle (Ruppert, J. Algorithms 18 (1995)), and inner vertices move to the middle of their neighbours.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ropewalk.mechanics.chain import Array, Integers

_MOST = 1_000_000  # vertices
_MOST_INSIDE, _MOST_ON_SIDE = 200_000, 2_000  # of an outline: its division takes up to 10 s, with the square of a side
_CLEARANCE = 0.6  # spacings between inner vertices and the outline: between 0.5, thin at the rim, and 0.87, the grid's
_ON_EDGE = 1e-12  # barycentric coordinate that still counts as inside
_THIN = 1.0 / (2.0 * np.sin(np.radians(26.0)))  # radius of the circumcircle by the shortest edge
_ROUNDS_OF_POINTS, _ROUNDS_OF_SMOOTHING, _ROUNDS_OF_TURNING = 12, 8, 200
# While they are triangulated, straight sides are bent outwards by this share of their length, a thousand roundings at
# the very least between neighbours: vertices in line would make triangles without area.
_BULGE = 1e-6


@dataclass(frozen=True, eq=False)
class Surface:
    """A net or a membrane divided into triangles, in the plan (u, v) in which it is laid out."""

    plan: Array  # (vertex, 2) m
    triangle: Integers  # (triangle, 3) vertices, counter-clockwise
    across: Integers  # (triangle, 3) the triangle beyond the edge opposite to each corner, -1 at the rim
    rim: Integers  # vertices of the closed outline in order, counter-clockwise, first not repeated

    @property
    def areas(self) -> Array:
        """Area of each triangle, m^2."""
        return 0.5 * _double_areas(self.plan, self.triangle)


def rectangle(sides: tuple[float, float], cells: tuple[int, int]) -> Surface:
    """Divide a rectangle into cells, each halved by a diagonal, in the manner of the union jack.

    The diagonals of neighbouring cells meet at one vertex in two. With even numbers of cells the division is symmetric
    about both middles.

    Args:
        sides: lengths along u and v, m.
        cells: numbers along u and v; vertex (i, j) is number i + j (cells[0] + 1).

    Raises:
        ValueError: a side that is not positive, or less than one cell.
    """
    if not all(np.isfinite(side) and side > 0.0 for side in sides):
        raise ValueError(f"the sides of a rectangle must be finite and positive, not {sides}")
    if not all(int(count) == count and count >= 1 for count in cells):
        raise ValueError(f"a rectangle needs whole numbers of cells, at least 1 along each side, not {cells}")
    m, n = int(cells[0]), int(cells[1])
    _check_number((m + 1) * (n + 1), "use fewer cells")
    u, v = sides[0] * np.arange(m + 1) / m, sides[1] * np.arange(n + 1) / n
    plan = np.stack([np.tile(u, n + 1), np.repeat(v, m + 1)], axis=1)
    number = np.arange((m + 1) * (n + 1), dtype=np.int64).reshape(n + 1, m + 1)
    a, b, c, d = (corner.ravel() for corner in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]))
    even = ((np.arange(m) + np.arange(n)[:, np.newaxis]) % 2 == 0).ravel()[:, np.newaxis]
    one = np.where(even, np.stack([a, b, c], axis=1), np.stack([a, b, d], axis=1))
    two = np.where(even, np.stack([a, c, d], axis=1), np.stack([b, c, d], axis=1))
    triangle = np.stack([one, two], axis=1).reshape(-1, 3)
    rim = np.concatenate([number[0, :-1], number[:-1, -1], number[-1, :0:-1], number[:0:-1, 0]])
    return Surface(plan, triangle, neighbours(triangle), rim)


def polygon(points: ArrayLike, spacing: float) -> Surface:
    """Divide the inside of a simple outline, which may be concave but has no holes.

    The vertices of the rim come first, in order, from the first corner. The same outline gives the same division.

    Args:
        points: corners (corner, 2) in m, either way round; the first may be repeated at the end.
        spacing: largest distance of neighbours on the rim, and that of the grid inside, m.

    Raises:
        ValueError: fewer than three corners, an outline that crosses or touches itself, a spacing out of range.
    """
    corners = _checked_outline(points)
    if not (np.isfinite(spacing) and spacing > 0.0):
        raise ValueError(f"the spacing must be finite and positive, not {spacing}")
    extent = np.ptp(corners, axis=0)
    lengths = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
    expected = extent.prod() / spacing**2 + lengths.sum() / spacing
    _check_number(expected, "use a larger spacing", _MOST_INSIDE)
    segments = np.maximum(np.ceil(lengths / spacing - 1e-9), 1.0).astype(np.int64)
    if segments.max() > _MOST_ON_SIDE:
        raise ValueError(
            f"a side of {lengths.max():g} m would have {segments.max()} vertices, more than {_MOST_ON_SIDE}; "
            "use a larger spacing"
        )
    straight, rim = _subdivided(corners, segments, 0.0), _subdivided(corners, segments, _BULGE)
    inner = _grid(corners, rim, spacing)
    if not len(inner):
        raise ValueError(
            f"a spacing of {spacing:g} m is too large for an outline of {extent[0]:g} m x {extent[1]:g} m: "
            "no vertex fits inside; use a smaller one"
        )
    plan = np.concatenate([rim, inner])
    for _ in range(_ROUNDS_OF_POINTS):
        more = _cures(plan, _triangulated(plan, len(rim)), len(rim))
        if not len(more):
            break
        plan = np.concatenate([plan, more])
    triangle = _triangulated(plan, len(rim))
    for _ in range(_ROUNDS_OF_SMOOTHING):
        moved = _smoothed(plan, triangle, len(rim))
        turned = _triangulated(moved, len(rim))
        if _thinnest(moved, turned) < _thinnest(plan, triangle):
            break
        plan, triangle = moved, turned
    plan[: len(rim)] = straight
    flat = _double_areas(plan, triangle) <= 0.0
    if np.any(flat):
        raise _too_close(plan[triangle[flat][0, 0]])
    return Surface(plan, triangle, neighbours(triangle), np.arange(len(rim), dtype=np.int64))


def locate(surface: Surface, point: ArrayLike) -> tuple[int, Array]:
    """Find the triangle in which a point of the plan lies.

    Args:
        surface: where to look.
        point: (u, v) in m.

    Returns:
        The number of the triangle and the barycentric coordinates (3,) in it, which add up to 1; of several triangles
        that meet in the point, the first. -1 and three times NaN outside of the rim.
    """
    p = np.asarray(point, dtype=np.float64)
    if p.shape != (2,):
        raise ValueError(f"a point of the plan has two coordinates, not shape {p.shape}")
    away = surface.plan[surface.triangle] - p
    one, two = np.roll(away, -1, axis=1), np.roll(away, -2, axis=1)
    share = _cross(one, two)
    with np.errstate(divide="ignore", invalid="ignore"):  # so far away that rounding leaves no area: in no triangle
        share /= share.sum(axis=1, keepdims=True)
    lowest = share.min(axis=1)
    inside = np.flatnonzero(lowest >= -_ON_EDGE)
    return (int(inside[0]), share[inside[0]]) if inside.size else (-1, np.full(3, np.nan))


def neighbours(triangle: Integers) -> Integers:
    """Return the triangle beyond the edge opposite to each corner, (triangle, 3), -1 where there is none."""
    ends = np.sort(_edges(triangle), axis=-1).reshape(-1, 2)
    order = np.lexsort(ends.T)
    ends = ends[order]
    twin = np.flatnonzero(np.all(ends[1:] == ends[:-1], axis=1))
    across = np.full(triangle.size, -1, dtype=np.int64)
    across[order[twin]], across[order[twin + 1]] = order[twin + 1] // 3, order[twin] // 3
    return across.reshape(-1, 3)


def _edges(triangle: Integers) -> Integers:
    """Ends of the edge opposite to each corner, counter-clockwise, (triangle, 3, 2)."""
    return np.stack([np.roll(triangle, -1, axis=1), np.roll(triangle, -2, axis=1)], axis=-1)


def _cross(one: Array, two: Array) -> Array:
    return np.asarray(one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0])


def _double_areas(plan: Array, triangle: Integers) -> Array:
    a, b, c = plan[triangle].transpose(1, 0, 2)
    return _cross(b - a, c - a)


def _check_number(vertices: float, remedy: str, most: int = _MOST) -> None:
    if vertices > most:
        raise ValueError(f"this would make about {vertices:.2g} vertices, more than {most:.0e}; {remedy}")


def _checked_outline(points: ArrayLike) -> Array:
    """The corners counter-clockwise."""
    corners = np.array(points, dtype=np.float64)
    if corners.ndim != 2 or corners.shape[1] != 2:
        raise ValueError(f"an outline is a list of points (u, v), not an array of shape {corners.shape}")
    if not np.all(np.isfinite(corners)):
        raise ValueError("the points of an outline must be finite")
    if len(corners) > 1 and np.array_equal(corners[0], corners[-1]):
        corners = corners[:-1]
    if len(corners) < 3:
        raise ValueError(f"an outline needs at least 3 different points, not {len(corners)}")
    following = np.roll(corners, -1, axis=0)
    for k in np.flatnonzero(np.all(corners == following, axis=1)):
        raise ValueError(f"the points {k + 1} and {(k + 1) % len(corners) + 1} of the outline are the same; drop one")
    _require_simple(corners, following)
    area = _cross(corners - corners[0], following - corners[0]).sum()
    return corners if area > 0.0 else np.concatenate([corners[:1], corners[:0:-1]])


def _require_simple(corners: Array, following: Array) -> None:
    """Raise ValueError if two sides have a point in common beside the corner between neighbours."""
    count = len(corners)
    tiny = 1e-14 * float(np.ptp(corners, axis=0).max()) ** 2
    for i in range(count - 1):
        others = np.arange(i + 1, count)
        a, b, c, d = corners[i], following[i], corners[others], following[others]
        # On which side of each the ends of the other are; a zero counts as either.
        one = _signs(_cross(b - a, c - a), tiny) * _signs(_cross(b - a, d - a), tiny)
        two = _signs(_cross(d - c, a - c), tiny) * _signs(_cross(d - c, b - c), tiny)
        meet = (one <= 0) & (two <= 0)
        overlap = np.all(np.maximum(a, b) >= np.minimum(c, d), axis=1) & np.all(
            np.minimum(a, b) <= np.maximum(c, d), axis=1
        )
        meet &= overlap
        for k in others[meet]:
            if k == i + 1 and not _folds_back(a, b, following[k], tiny):
                continue
            if i == 0 and k == count - 1 and not _folds_back(corners[k], a, b, tiny):
                continue
            raise ValueError(
                f"the outline crosses or touches itself: side {i + 1}, from {_text(a)} to {_text(b)}, and side "
                f"{k + 1}, from {_text(corners[k])} to {_text(following[k])}; give the points in order along the rim"
            )


def _signs(values: Array, tiny: float) -> NDArray[np.int64]:
    return np.where(np.abs(values) <= tiny, 0, np.sign(values)).astype(np.int64)


def _folds_back(a: Array, b: Array, c: Array, tiny: float) -> bool:
    """Whether the way from a over b to c comes back along itself."""
    return bool(abs(_cross(b - a, c - b)) <= tiny and (b - a) @ (c - b) < 0.0)


def _text(point: Array) -> str:
    return f"({point[0]:g}, {point[1]:g})"


def _subdivided(corners: Array, segments: Integers, bulge: float) -> Array:
    """The vertices of the rim, each side bent outwards by a share of its length."""
    parts = []
    for a, b, n in zip(corners, np.roll(corners, -1, axis=0), segments, strict=True):
        s = (np.arange(n) / n)[:, np.newaxis]
        parts.append(a + s * (b - a) + 4.0 * bulge * s * (1.0 - s) * [b[1] - a[1], a[0] - b[0]])
    return np.concatenate(parts)


def _grid(corners: Array, rim: Array, spacing: float) -> Array:
    """Points of an equilateral grid about the middle, inside and clear of the rim."""
    from scipy.spatial import KDTree

    low, high = corners.min(axis=0), corners.max(axis=0)
    row_height = 0.5 * np.sqrt(3.0) * spacing
    columns, rows = np.ceil(0.5 * (high - low) / [spacing, row_height]).astype(np.int64) + 1
    i, j = np.meshgrid(np.arange(-columns, columns + 1), np.arange(-rows, rows + 1))
    points = np.stack([spacing * (i + 0.5 * (j % 2)), row_height * j], axis=-1).reshape(-1, 2) + 0.5 * (low + high)
    points = points[_inside(corners, points)]
    # Vertices and middles of the rim stand for all of it: its pieces are no longer than the spacing.
    marks = np.concatenate([rim, 0.5 * (rim + np.roll(rim, -1, axis=0))])
    return np.asarray(points[KDTree(marks).query(points)[0] >= _CLEARANCE * spacing]) if len(points) else points


def _inside(corners: Array, points: Array) -> NDArray[np.bool_]:
    """Whether points lie in the outline: a ray to the right crosses it an odd number of times."""
    inside = np.zeros(len(points), dtype=np.bool_)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        if a[1] != b[1]:
            u = a[0] + (points[:, 1] - a[1]) * ((b[0] - a[0]) / (b[1] - a[1]))
            inside ^= ((points[:, 1] < a[1]) != (points[:, 1] < b[1])) & (points[:, 0] < u)
    return inside


def _triangulated(plan: Array, count: int) -> Integers:
    """Triangles inside the rim, which are the first `count` vertices: Delaunay's, as far as the rim allows."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import Delaunay

    triangle = Delaunay(plan).simplices.astype(np.int64)
    back = _double_areas(plan, triangle) < 0.0
    triangle[back] = triangle[back, ::-1]
    turned = _turn_to_rim(plan, triangle, count)
    edges, across = _edges(triangle), neighbours(triangle)
    # Inside is what can be reached from the inner side of the rim without crossing it.
    first, last = edges[..., 0], edges[..., 1]
    inner_side = (first < count) & (last == (first + 1) % count)
    outer_side = (last < count) & (first == (last + 1) % count)
    one, corner = np.nonzero((across >= 0) & ~inner_side & ~outer_side)
    graph = coo_array((np.ones(len(one)), (one, across[one, corner])), shape=(len(triangle), len(triangle)))
    _, part = connected_components(graph, directed=False)
    triangle = np.ascontiguousarray(triangle[np.isin(part, part[np.nonzero(inner_side)[0]])])
    if turned:
        _turn_to_delaunay(plan, triangle)
    return triangle


def _turn_to_rim(plan: Array, triangle: Integers, count: int) -> bool:
    """Turn edges that cross the rim until every piece of it is an edge (Sloan, Comput. Struct. 47 (1993))."""
    edges = _edges(triangle).reshape(-1, 2)
    there = set((edges.min(axis=1) * len(plan) + edges.max(axis=1)).tolist())
    rim = [(p, (p + 1) % count) for p in range(count)]
    missing = [(p, q) for p, q in rim if min(p, q) * len(plan) + max(p, q) not in there]
    for p, q in missing:
        _turn_towards(plan, triangle, p, q)
    return bool(missing)


def _turn_to_delaunay(plan: Array, triangle: Integers) -> None:
    """Turn inner edges until the angles opposite to each add up to no more than 180 degrees (Lawson)."""
    for _ in range(_ROUNDS_OF_TURNING):
        across = neighbours(triangle)
        one, corner = np.nonzero(across > np.arange(len(triangle))[:, np.newaxis])
        two = across[one, corner]
        c, (a, b) = triangle[one, corner], _edges(triangle)[one, corner].T
        d = triangle[two].sum(axis=1) - a - b
        to = [(plan[a] - plan[e], plan[b] - plan[e]) for e in (c, d)]
        (sine, cosine), (other_sine, other_cosine) = ((_cross(x, y), (x * y).sum(axis=1)) for x, y in to)
        total = sine * other_cosine - other_sine * cosine  # the other angle is seen clockwise
        wrong = np.flatnonzero(total < -1e-12 * (np.abs(sine * other_cosine) + np.abs(other_sine * cosine)))
        if not wrong.size:
            return
        busy: set[int] = set()
        for k in wrong:
            pair = {int(one[k]), int(two[k])}
            if not pair & busy:
                busy |= pair
                triangle[one[k]], triangle[two[k]] = (c[k], a[k], d[k]), (d[k], b[k], c[k])


def _turn_towards(plan: Array, triangle: Integers, p: int, q: int) -> None:
    edges = _edges(triangle).reshape(-1, 2)
    edges = edges[edges[:, 0] < edges[:, 1]]
    crossing = deque(edge for edge in edges[_crosses(plan, edges, p, q)].tolist())
    patience = 10 * len(crossing) ** 2 + 10
    while crossing and patience:
        patience -= 1
        a, b = crossing.popleft()
        one, two = np.flatnonzero(np.any(triangle == a, axis=1) & np.any(triangle == b, axis=1))
        c, d = (int(triangle[t][(triangle[t] != a) & (triangle[t] != b)][0]) for t in (one, two))
        if not _crosses(plan, np.array([[a, b]]), c, d)[0]:
            crossing.append([a, b])  # the two triangles are not convex together; later they will be
            continue
        triangle[one], triangle[two] = (a, d, c), (b, c, d)
        for t in (one, two):
            if _double_areas(plan, triangle[t : t + 1])[0] < 0.0:
                triangle[t] = triangle[t, ::-1]
        if _crosses(plan, np.array([[c, d]]), p, q)[0]:
            crossing.append([c, d])
    edges = _edges(triangle).reshape(-1, 2)
    if not np.any(np.all(edges == (p, q), axis=1)):
        raise _too_close(plan[p])


def _too_close(point: Array) -> ValueError:
    return ValueError(f"the outline is too close to itself near {_text(point)}; keep its sides apart")


def _crosses(plan: Array, edges: Integers, p: int, q: int) -> NDArray[np.bool_]:
    """Whether edges cross the one from p to q, in a point that is no end of either."""
    a, b = plan[edges[:, 0]], plan[edges[:, 1]]
    apart = ~np.any((edges == p) | (edges == q), axis=1)
    sides = _cross(plan[q] - plan[p], a - plan[p]) * _cross(plan[q] - plan[p], b - plan[p])
    return np.asarray(apart & (sides < 0.0) & (_cross(b - a, plan[p] - a) * _cross(b - a, plan[q] - a) < 0.0))


def _circles(plan: Array, triangle: Integers) -> tuple[Array, Array, Array]:
    """Centre and radius of the circumcircles, and their radius by the shortest edge."""
    a, b, c = plan[triangle].transpose(1, 0, 2)
    b, c = b - a, c - a
    double = 2.0 * _cross(b, c)[:, np.newaxis]
    bb, cc = (b**2).sum(axis=1, keepdims=True), (c**2).sum(axis=1, keepdims=True)
    centre = np.concatenate([c[:, 1:] * bb - b[:, 1:] * cc, b[:, :1] * cc - c[:, :1] * bb], axis=1) / double
    radius = np.hypot(*centre.T)
    shortest = np.sqrt(np.minimum(np.minimum(bb, cc)[:, 0], ((c - b) ** 2).sum(axis=1)))
    return a + centre, radius, radius / shortest


def _thinnest(plan: Array, triangle: Integers) -> float:
    """The smallest angle, by the shares that radius and shortest edge have: its sine, doubled."""
    return float(1.0 / _circles(plan, triangle)[2].max())


def _cures(plan: Array, triangle: Integers, count: int) -> Array:
    """Centres of the circumcircles of thin triangles, where they are clear of the rim and of each other."""
    from scipy.spatial import KDTree

    centre, radius, ratio = _circles(plan, triangle)
    order = np.argsort(-ratio, kind="stable")
    order = order[ratio[order] > _THIN]
    order = order[_inside(plan[:count], centre[order])]
    order = order[KDTree(plan).query(centre[order])[0] > 0.9 * radius[order]] if order.size else order
    ahead = np.roll(plan[:count], -1, axis=0)
    middle, half = 0.5 * (plan[:count] + ahead), 0.5 * np.hypot(*(ahead - plan[:count]).T)
    taken: list[Array] = []
    for t in order:
        clear = np.all(((centre[t] - middle) ** 2).sum(axis=1) > (1.05 * half) ** 2)
        near = any(((centre[t] - other) ** 2).sum() < radius[t] ** 2 for other in taken)
        if clear and not near:
            taken.append(centre[t])
    return np.array(taken).reshape(-1, 2)


def _smoothed(plan: Array, triangle: Integers, count: int) -> Array:
    """Inner vertices in the middle of their neighbours; those whose triangles would turn over stay."""
    ends = _edges(triangle).reshape(-1, 2)
    total, degree = np.zeros_like(plan), np.bincount(ends[:, 0], minlength=len(plan))
    np.add.at(total, ends[:, 0], plan[ends[:, 1]])
    moved = total / np.maximum(degree, 1)[:, np.newaxis]
    moved[:count] = plan[:count]
    while np.any(over := _double_areas(moved, triangle) <= 0.0):
        stay = np.unique(triangle[over])
        if np.array_equal(moved[stay], plan[stay]):
            return plan
        moved[stay] = plan[stay]
    return moved
