"""A heavy elastic rope between two anchors with one load: forces by Newton's method in closed-form reaches.

The force n(s) that the part ahead exerts on the part behind obeys n' = (0, w); a piece of unstrained length l that
begins under n = (h, v) reaches by Irvine's closed forms (Cable Structures)

    x = h l/EA + (h/w) [asinh(v/h)],    z = [v^2]/(2 w EA) + [sqrt(h^2 + v^2)]/w,

written without differences, so that taut and light ropes lose no digits. Scalars only: a calculator asks for some
hundred such ropes in a second.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, hypot, inf, log1p, sqrt

_ROUNDS = 200
_EXACT = 1e-13  # part of the length by which the end is missed


@dataclass(frozen=True)
class Hanging:
    """A rope at rest: forces (x, z) in N, places in m from the first anchor, z upwards."""

    start: tuple[float, float]  # internal force at the first anchor
    behind: tuple[float, float]  # behind the load
    ahead: tuple[float, float]  # ahead of it
    end: tuple[float, float]  # at the second anchor
    place: tuple[float, float]  # of the load
    sag: float  # m, largest depth below the chord

    @property
    def largest_tension(self) -> float:
        """Of the whole rope, N: the tension of a heavy rope is largest at an end of a piece."""
        return max(hypot(*n) for n in (self.start, self.behind, self.ahead, self.end))


def reach(h: float, v: float, length: float, weight: float, compliance: float) -> tuple[float, float]:
    """Vector in m from the beginning to the end of a piece that begins under the force (h, v) in N."""
    v_end = v + weight * length
    t_0, t_1 = hypot(h, v), hypot(h, v_end)
    mean = max(0.5 * (t_0 + t_1), 1e-300)
    return h * length * compliance + h * _per_tension(h, v, v_end, t_0, t_1, length, weight), (
        length * (v + 0.5 * weight * length) * (compliance + 1.0 / mean)
    )


def hang(
    span: float, height: float, length: float, weight: float, axial_stiffness: float, place: float, load: float
) -> Hanging:
    """Find a rope at rest.

    Args:
        span: m between the anchors, level.
        height: m of the second anchor above the first.
        length: m, unstrained.
        weight: N/m.
        axial_stiffness: N; infinite: inextensible.
        place: unstrained length behind the load as a part of all of it, between 0 and 1.
        load: N, downwards.

    Raises:
        ValueError: the rope does not reach, or pulls on nothing.
    """
    compliance, distance = 1.0 / axial_stiffness, hypot(span, height)
    if compliance == 0.0 and length <= distance:
        raise ValueError(f"an inextensible rope of {length:g} m does not hang between anchors {distance:g} m apart")
    parts, total = (place * length, (1.0 - place) * length), weight * length + load
    if not total > 0.0:
        raise ValueError("a rope without weight and load has no definite shape")
    h, v = _guess(span, height, length, total, compliance), 0.0
    v = h * height / span - (0.5 * weight * length + (1.0 - place) * load)
    scale = max(length, distance)
    gap, slope = _miss(h, v, parts, weight, compliance, load, span, height)
    miss = hypot(*gap)
    for _ in range(_ROUNDS):
        if miss <= _EXACT * scale:
            break
        xx, xz, zz = slope
        det = xx * zz - xz * xz
        dh, dv = -(zz * gap[0] - xz * gap[1]) / det, -(xx * gap[1] - xz * gap[0]) / det
        size = 1.0
        while size > 1e-12:
            new = h + size * dh
            if new > 0.0:
                gap_new, slope_new = _miss(new, v + size * dv, parts, weight, compliance, load, span, height)
                if hypot(*gap_new) < miss * (1.0 - 1e-4 * size):
                    break
            size *= 0.5
        else:
            break
        h, v, gap, slope, miss = new, v + size * dv, gap_new, slope_new, hypot(*gap_new)
    if miss > 1e-9 * scale:
        raise ValueError("no rest was found")
    behind = h, v + weight * parts[0]
    ahead = h, behind[1] + load
    spot = reach(h, v, parts[0], weight, compliance)
    depth = _depth((h, v), parts[0], weight, compliance, (0.0, 0.0), height / span)
    depth = max(depth, _depth(ahead, parts[1], weight, compliance, spot, height / span))
    return Hanging((h, v), behind, ahead, (h, ahead[1] + weight * parts[1]), spot, depth)


def _guess(span: float, height: float, length: float, total: float, compliance: float) -> float:
    """Horizontal force of a parabola, N: its sag d makes the rope 8 d^2/(3 distance) longer than the chord."""
    distance = hypot(span, height)
    low, high = 1e-9 * total, 1e9 * total + (distance / length - 1.0) / compliance if compliance else 1e9 * total
    for _ in range(80):
        h = sqrt(low * high)
        long = distance * (1.0 + (total / h) ** 2 / 24.0) - length * (1.0 + h * distance / span * compliance)
        low, high = (h, high) if long > 0.0 else (low, h)
    return h


def _miss(
    h: float, v: float, parts: tuple[float, float], weight: float, compliance: float, load: float, span: float,
    height: float,
) -> tuple[tuple[float, float], tuple[float, float, float]]:  # fmt: skip
    """By how much the end is missed, m, and its derivatives xx, xz, zz by the force at the start, m/N."""
    x, z, xx, xz, zz = -span, -height, 0.0, 0.0, 0.0
    for length in parts:
        dx, dz = reach(h, v, length, weight, compliance)
        v_end = v + weight * length
        t_0, t_1 = max(hypot(h, v), 1e-300), max(hypot(h, v_end), 1e-300)
        cut = length / (t_0 + t_1)
        vertical = cut * (1.0 + (h / t_0) * (h / t_1) - (v / t_0) * (v_end / t_1))
        xz -= cut * ((h / t_0) * (v_end / t_1) + (v / t_0) * (h / t_1))
        xx += max(_per_tension(h, v, v_end, t_0, t_1, length, weight) - vertical, 0.0) + compliance * length
        zz += vertical + compliance * length
        x, z, v = x + dx, z + dz, v_end + load
    return (x, z), (xx, xz, zz)


def _per_tension(h: float, v: float, v_end: float, t_0: float, t_1: float, length: float, weight: float) -> float:
    """Integral of ds/|n| over a piece, [asinh(v/h)]/w without the difference, m/N."""
    plus = h * (h / (t_0 - v)) if v < 0.0 else t_0 + v
    minus = h * (h / (t_1 + v_end)) if v_end > 0.0 else t_1 - v_end
    rest = max(plus + minus, 1e-250)
    ratio = 2.0 * weight * length / rest
    return log1p(ratio) / weight if ratio > 1e-300 else 2.0 * length / rest


def _depth(
    n: tuple[float, float], length: float, weight: float, compliance: float, at: tuple[float, float], slope: float
) -> float:
    """Largest depth of a piece below the line of the given slope through the first anchor, m."""
    parallel = (slope * n[0] - n[1]) / weight if weight > 0.0 else inf
    depths = []
    for s in (0.0, min(max(parallel, 0.0), length), length):
        x, z = reach(*n, s, weight, compliance) if s > 0.0 else (0.0, 0.0)
        depths.append(slope * (at[0] + x) - (at[1] + z))
    return max(depths)


def fall(n: tuple[float, float]) -> float:
    """Angle in rad by which a rope with the internal force n falls towards its second anchor."""
    return atan2(-n[1], n[0])
