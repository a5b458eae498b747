"""Shapes of symbols on a page of Matplotlib: vehicles, cabins, pantographs, people, towers as polygons and strokes."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ropewalk.results import style
from ropewalk.results.frame import Array
from ropewalk.results.symbols import Symbol

SPACE = {"coach": (56, 12), "vehicle": (52, 12), "person": (34, 10), "mass": (16, 14), "force": (76, 12),
         "pantograph": (14, 50), "cabin": (16, 30), "trolley": (16, 22), "sheave": (16, 12)}  # fmt: skip
"""Pixels above and below the contacts that a symbol needs."""
_BOX, _LIGHT, _STEEL = style.BLUE, "#DCE9F3", "#6B6B6B"
_LEVEL = np.array([1.0, 0.0])
_FIGURE = 26.0  # pixels, a person


def _arc(first: float, last: float) -> Array:
    """Return points (17, 2) of an arc of the unit circle between two angles in degrees."""
    turn = np.radians(np.linspace(first, last, 17))
    return np.stack([np.cos(turn), np.sin(turn)], axis=1)


class Brush:
    """Polygons and strokes of a frame, in pixels.

    Args:
        scale: pixels per metre.
        size: how many times as large as usual symbols are.
    """

    def __init__(self, scale: float, size: float) -> None:
        self.scale, self.size = scale, size
        self.polygons, self.faces = list[Array](), list[str]()
        self.strokes, self.inks, self.widths = list[Array](), list[str](), list[float]()

    def length(self, metres: float, least: float, most: float) -> float:
        """Return a length in pixels: true to scale within limits that keep it legible."""
        return float(np.clip(metres * self.scale, least * self.size, most * self.size))

    def fill(self, points: Array, colour: str) -> None:
        """Fill a polygon (corner, 2)."""
        if np.isfinite(points).all():
            self.polygons.append(points)
            self.faces.append(colour)

    def circle(self, centre: Array, radius: float, colour: str) -> None:
        """Fill a circle."""
        self.fill(centre + radius * _arc(0.0, 360.0), colour)

    def box(self, foot: Array, along: Array, length: float, height: float, colour: str = _BOX) -> None:
        """Fill a rectangle above the middle `foot` of its lower side, which points `along`."""
        half, up = 0.5 * length * along, height * np.array([-along[1], along[0]])
        self.fill(foot + np.array([-half, half, half + up, -half + up]), colour)

    def stroke(self, points: Sequence[Array] | Array, colour: str = _STEEL, width: float = 1.6) -> None:
        """Draw a polyline (point, 2)."""
        path = np.asarray(points, dtype=float)
        if np.isfinite(path).all():
            self.strokes.append(path)
            self.inks.append(colour)
            self.widths.append(style.sized(width))

    def arrow(self, tip: Array, way: Array) -> None:
        """Draw an arrow that ends at `tip`, as long as `way`."""
        length = float(np.linalg.norm(way))
        if not length > 2.0 * self.size or not np.isfinite(tip).all():
            return
        ahead = way / length * min(0.6 * length, 15.0 * self.size)
        aside = 0.42 * np.array([-ahead[1], ahead[0]])
        self.stroke([tip - way, tip - 0.8 * ahead], style.RED, 2.6)
        self.fill(np.stack([tip, tip - ahead + aside, tip - ahead - aside]), style.RED)


def draw_symbol(brush: Brush, symbol: Symbol, places: Array, others: Array) -> None:
    """Draw a symbol, if it is anywhere.

    Args:
        brush: to draw with.
        symbol: what is drawn.
        places: (contact, 2) px, of its contacts, or where it stands.
        others: (body, 2) px, of its bodies, or the foot of its post.
    """
    draw = _SHAPES.get(symbol.kind)
    places = places[np.isfinite(places).all(axis=1)]
    if draw is not None and (len(places) or len(others)):
        draw(brush, symbol, places, others[np.isfinite(others).all(axis=1)])


def _vehicle(brush: Brush, symbol: Symbol, wheels: Array, bodies: Array) -> None:
    """A box above wheels, inclined as they are; a box on a spring above a single wheel."""
    if not len(wheels):
        return
    ends = wheels[[wheels[:, 0].argmin(), wheels[:, 0].argmax()]]
    base, middle = float(np.linalg.norm(ends[1] - ends[0])), ends.mean(axis=0)
    along = (ends[1] - ends[0]) / base if base > 1.0 else _LEVEL
    up, radius = np.array([-along[1], along[0]]), brush.length(0.46, 2.5, 8.0)
    height = brush.length(3.0 if symbol.kind == "coach" else 2.0, 14.0, 38.0)
    length = base + 2.0 * min(max(0.16 * base, radius), 2.2 * brush.scale) if base > 1.0 else 1.6 * height
    gap = (2.4 if base > 1.0 else 3.6) * radius
    for wheel in wheels:
        above = middle + gap * up + ((wheel - middle) @ along) * along
        brush.stroke([wheel + radius * up, above], style.INK, 2.4)
    brush.box(middle + gap * up, along, length, height)
    brush.box(middle + (gap + 0.5 * height) * up, along, 0.94 * length, 0.28 * height, _LIGHT)
    for wheel in wheels:
        brush.circle(wheel + radius * up, radius, style.INK)


def _hanging(brush: Brush, symbol: Symbol, wheels: Array, bodies: Array) -> None:
    """Wheels on the line and what hangs below: a cabin, or a payload."""
    for wheel in wheels:
        brush.stroke([wheels[0], wheel])
        brush.circle(wheel, brush.length(0.2, 3.0, 6.0), style.INK)
    is_cabin = symbol.kind == "cabin"
    wide, high = brush.length(3.2, 16.0, 42.0), brush.length(2.4, 13.0, 34.0)
    for body in bodies:
        if len(wheels):
            brush.stroke([wheels.mean(axis=0), body])
        wide, high = (wide, high) if is_cabin else (brush.length(1.0, 11.0, 16.0),) * 2
        brush.box(body - [0.0, 0.5 * high], _LEVEL, wide, high)
        if is_cabin:
            brush.box(body, _LEVEL, 0.8 * wide, 0.3 * high, _LIGHT)


def _pantograph(brush: Brush, symbol: Symbol, heads: Array, bodies: Array) -> None:
    """A head below the wire, on a frame with a knee."""
    if len(heads):
        top, size = heads.mean(axis=0), brush.size
        knee, foot = top + size * np.array([13.0, -20.0]), top + size * np.array([-4.0, -38.0])
        brush.stroke([top, knee, foot], _BOX, 2.4)
        brush.box(foot - [0.0, 4.0 * size], _LEVEL, 22.0 * size, 4.0 * size, _STEEL)
        brush.box(top - [0.0, 3.0 * size], _LEVEL, 18.0 * size, 3.0 * size, style.INK)


def _pedestrian(brush: Brush, symbol: Symbol, feet: Array, bodies: Array) -> None:
    """A person who stands on the line with the feet that touch it."""
    if len(feet):
        foot, size = feet.mean(axis=0), _FIGURE * brush.size
        up, aside = np.array([0.0, size]), np.array([0.14 * size, 0.0])
        hip, neck = foot + 0.45 * up, foot + 0.78 * up
        legs = feet if len(feet) > 1 and np.ptp(feet[:, 0]) < size else [foot - aside, foot + aside]
        for leg in legs:
            brush.stroke([leg, hip], _BOX, 2.4)
        brush.stroke([hip, neck], _BOX, 3.4)
        brush.stroke([hip - 1.3 * aside + 0.08 * up, neck - 0.04 * up, hip + 1.3 * aside + 0.08 * up], _BOX, 2.0)
        brush.circle(foot + 0.9 * up, 0.12 * size, _BOX)


def _mass(brush: Brush, symbol: Symbol, spots: Array, bodies: Array) -> None:
    """Balls: a mass on the line, and bodies tied to it."""
    for body in bodies if len(spots) else ():
        brush.stroke([spots.mean(axis=0), body])
    for spot in (*spots, *bodies) if symbol.kind == "mass" else ():
        brush.circle(spot, 6.0 * brush.size, style.RED)


def _post(brush: Brush, symbol: Symbol, tops: Array, feet: Array) -> None:
    """A tower with its shoe, a sheave, a saddle; a bearing without a post."""
    size = brush.size
    for top, foot in zip(tops, feet if symbol.foot is not None else (), strict=False):
        for side in (-size, size):
            aside = np.array([[2.0 * side, -2.0 * size], [6.0 * side, 0.0]])
            brush.stroke(np.stack([top, foot]) + aside, style.FAINT, 1.8)
    for top in tops:
        radius = brush.length(symbol.size, 6.0, 1e9)
        if symbol.kind == "sheave":
            brush.circle(top, min(radius, 14.0 * size), _STEEL)
            brush.circle(top, 2.0 * size, "white")
        elif symbol.kind == "saddle":
            brush.stroke(top - [0.0, radius + 3.0 * size] + radius * _arc(60.0, 120.0), _STEEL, 4.0)
        else:
            brush.fill(top + size * np.array([[0.0, -1.0], [7.0, -11.0], [-7.0, -11.0]]), style.INK)


def _place(brush: Brush, symbol: Symbol, spots: Array, bodies: Array) -> None:
    """A ring around a place whose curve is asked for."""
    if len(spots):
        brush.stroke(spots[0] + 5.0 * brush.size * _arc(0.0, 360.0), style.GREEN)


_SHAPES: dict[str, Callable[[Brush, Symbol, Array, Array], None]] = {
    "coach": _vehicle, "vehicle": _vehicle, "trolley": _hanging, "cabin": _hanging, "pantograph": _pantograph,
    "person": _pedestrian, "mass": _mass, "force": _mass, "tower": _post, "sheave": _post, "saddle": _post,
    "bearing": _post, "place": _place,
}  # fmt: skip
