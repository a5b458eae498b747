"""Small drawings as SVG: lines, arrows, supports, labels. Coordinates in pixels, y down."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import escape

Point = tuple[float, float]
INK, FAINT, KEY, LOAD = "#333333", "#8a8a8a", "#0b5cad", "#b3470f"
WIDTH = 720


class Drawing:
    """A picture of WIDTH pixels and a height."""

    def __init__(self, height: int, title: str) -> None:
        self.height, self.title, self.parts = height, title, list[str]()

    def path(
        self, points: Sequence[Point], colour: str = INK, width: float = 2.0, dash: str = "", fill: str = "none"
    ) -> None:
        """A polygon through points, open unless it is filled."""
        d = "M" + " L".join(f"{x:.1f} {y:.1f}" for x, y in points) + (" Z" if fill != "none" else "")
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(f'<path d="{d}" fill="{fill}" stroke="{colour}" stroke-width="{width}"{dashed}/>')

    def circle(self, at: Point, radius: float, colour: str = INK, fill: str = "#ffffff") -> None:
        """A circle."""
        place = f'cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius}"'
        self.parts.append(f'<circle {place} fill="{fill}" stroke="{colour}" stroke-width="1.6"/>')

    def box(self, at: Point, width: float, height: float, colour: str = INK, fill: str = "#ffffff") -> None:
        """A rectangle about its middle."""
        (x, y), w, h = at, 0.5 * width, 0.5 * height
        self.path([(x - w, y - h), (x + w, y - h), (x + w, y + h), (x - w, y + h)], colour, 1.6, fill=fill)

    def text(self, at: Point, words: str, colour: str = INK, anchor: str = "middle", size: int = 14) -> None:
        """Plain words."""
        self._write(at, words, colour, anchor, size, "system-ui, sans-serif")

    def key(self, at: Point, words: str, anchor: str = "middle") -> None:
        """A key of the file."""
        self._write(at, words, KEY, anchor, 14, "ui-monospace, monospace")

    def _write(self, at: Point, words: str, colour: str, anchor: str, size: int, font: str) -> None:
        self.parts.append(
            f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" fill="{colour}" text-anchor="{anchor}" font-size="{size}" '
            f'font-family="{font}" stroke="#ffffff" stroke-width="4" paint-order="stroke">{escape(words)}</text>'
        )

    def arrow(self, start: Point, end: Point, colour: str = INK, both: bool = False) -> None:
        """An arrow, or one with two heads."""
        self.path([start, end], colour, 1.6)
        for tip, tail in [(end, start), *([(start, end)] if both else [])]:
            a = math.atan2(tip[1] - tail[1], tip[0] - tail[0])
            wings = [(tip[0] - 9 * math.cos(a + s), tip[1] - 9 * math.sin(a + s)) for s in (-0.4, 0.4)]
            self.path([tip, *wings], colour, 1.0, fill=colour)

    def measure(self, start: Point, end: Point, words: str, away: float = -7.0) -> None:
        """A length with the key that gives it, in the middle."""
        self.arrow(start, end, FAINT, both=True)
        upright = abs(end[0] - start[0]) < abs(end[1] - start[1])
        x, y = 0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])
        self.key((x + 8, y + 5) if upright else (x, y + away), words, "start" if upright else "middle")

    def ground(self, at: Point, width: float = 30.0, upside_down: bool = False) -> None:
        """A support that does not give way."""
        (x, y), s, w = at, -1 if upside_down else 1, 0.5 * width
        self.path([(x, y), (x - 0.6 * w, y + 14 * s), (x + 0.6 * w, y + 14 * s)], INK, 1.6, fill="#ffffff")
        self.hatch((x - w, y + 14 * s), (x + w, y + 14 * s), s)

    def hatch(self, start: Point, end: Point, side: float = 1.0) -> None:
        """The edge of what is solid, level."""
        self.path([start, end], INK, 1.6)
        for k in range(int((end[0] - start[0]) / 8)):
            self.path([(start[0] + 8 * k + 7, start[1]), (start[0] + 8 * k, start[1] + 7 * side)], FAINT, 1.0)

    def spring(self, start: Point, end: Point, colour: str = INK) -> None:
        """A spring between two points."""
        (x0, y0), (x1, y1) = start, end
        length = math.hypot(x1 - x0, y1 - y0)
        tx, ty = (x1 - x0) / length, (y1 - y0) / length
        middle = [
            (x0 + tx * length * s - 5 * ty * side, y0 + ty * length * s + 5 * tx * side)
            for s, side in zip((0.2, 0.26, 0.38, 0.5, 0.62, 0.74, 0.8), (0, 1, -1, 1, -1, 1, 0), strict=True)
        ]
        self.path([start, *middle, end], colour, 1.4)

    def damper(self, start: Point, end: Point) -> None:
        """A damper between two points, one above the other."""
        x, (y0, y1) = start[0], sorted((start[1], end[1]))
        y = 0.5 * (y0 + y1)
        self.path([(x, y0), (x, y)], INK, 1.4)
        self.path([(x - 4, y), (x + 4, y)], INK, 1.8)
        self.path([(x - 6, y - 5), (x - 6, y + 5), (x + 6, y + 5), (x + 6, y - 5)], INK, 1.4)
        self.path([(x, y + 5), (x, y1)], INK, 1.4)

    def save(self, path: Path) -> None:
        """Write it."""
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {self.height}" width="{WIDTH}" '
            f'height="{self.height}" role="img"><title>{escape(self.title)}</title>'
        )
        ground = f'<rect width="{WIDTH}" height="{self.height}" fill="#ffffff"/>'
        path.write_text("\n".join([head, ground, *self.parts, "</svg>"]) + "\n", encoding="utf-8")


def hanging(start: Point, end: Point, sag: float, count: int = 60) -> list[Point]:
    """A rope that hangs by sag below its chord in the middle (a parabola)."""
    (x0, y0), (x1, y1) = start, end
    along = [k / count for k in range(count + 1)]
    return [(x0 + (x1 - x0) * s, y0 + (y1 - y0) * s + 4 * sag * s * (1 - s)) for s in along]


def on(rope: Sequence[Point], part: float) -> Point:
    """The point of a rope after a part of it."""
    return rope[round(part * (len(rope) - 1))]
