"""The course of a prescribed travel, exact: a speed that is piecewise linear in time, integrated once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from ropewalk.model.history import SpeedTable


@dataclass(frozen=True)
class Piece:
    """A stretch of time with the place offset + speed tau + slope tau^2 / 2, where tau counts from begin."""

    begin: float  # s
    duration: float  # s
    offset: float  # m
    speed: float  # m/s
    slope: float  # m/s^2

    def place(self, time: float) -> float:
        """Place in m at a time in s of this stretch."""
        tau = time - self.begin
        return self.offset + tau * (self.speed + 0.5 * self.slope * tau)

    def mirrored(self) -> Piece:
        """The same stretch with the place counted backwards."""
        return Piece(self.begin, self.duration, -self.offset, -self.speed, -self.slope)


def course(speed: float | SpeedTable, start: float, until: float) -> list[Piece]:
    """Integrate a speed from time 0 to `until` (s), beginning at `start` (m)."""
    times, values = (speed.time, speed.value) if isinstance(speed, SpeedTable) else ((0.0,), (speed,))
    knots = list(zip(times, values, strict=True))
    knots = [(-math.inf, knots[0][1]), *knots, (math.inf, knots[-1][1])]
    segments: list[Piece] = []
    place = start
    for (t0, v0), (t1, v1) in pairwise(knots):
        begin, end = max(t0, 0.0), min(t1, until)
        if end <= begin:
            continue
        slope = (v1 - v0) / (t1 - t0) if math.isfinite(t1 - t0) else 0.0
        piece = Piece(begin, end - begin, place, v0 + slope * (begin - t0) if slope else v0, slope)
        segments.append(piece)
        place = piece.place(end)
    return segments


def place_at(segments: Sequence[Piece], time: float) -> float:
    """Place in m at a time in s within the course."""
    return next((piece for piece in reversed(segments) if piece.begin <= time), segments[0]).place(time)


def between(ahead: Sequence[Piece], behind: Sequence[Piece]) -> list[Piece]:
    """The distance of two courses over the same time, as a course."""
    times = sorted({piece.begin for piece in (*ahead, *behind)})
    end = ahead[-1].begin + ahead[-1].duration
    segments = []
    for begin, stop in pairwise([*times, end]):
        a, b = (next(piece for piece in reversed(way) if piece.begin <= begin) for way in (ahead, behind))
        speed = a.speed + a.slope * (begin - a.begin) - b.speed - b.slope * (begin - b.begin)
        segments.append(Piece(begin, stop - begin, a.place(begin) - b.place(begin), speed, a.slope - b.slope))
    return segments


def first_at_most(segments: Sequence[Piece], level: float) -> float | None:
    """The first time in s at which the place is `level` (m) or less, None if that never happens."""
    for piece in segments:
        height = piece.offset - level
        if height <= 0.0:
            return piece.begin
        roots = [root for root in _roots(0.5 * piece.slope, piece.speed, height) if 0.0 < root <= piece.duration]
        if roots:
            return piece.begin + min(roots)
    return None


def _roots(a: float, b: float, c: float) -> list[float]:
    """Real roots of a x^2 + b x + c, without cancellation."""
    if a == 0.0:
        return [] if b == 0.0 else [-c / b]
    inside = b * b - 4.0 * a * c
    if inside < 0.0:
        return []
    q = -0.5 * (b + math.copysign(math.sqrt(inside), b))
    return [q / a] if q == 0.0 else [q / a, c / q]
