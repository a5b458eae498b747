"""Where the contact wire runs across the head of a pantograph, on straight track and on curves, and what arms bear.

Between two supports the wire is straight in plan view, the track an arc of curvature k = 1 / R, positive to the left.
From the middle of the track, with staggers b1 and b2, it is at

    y(x) = b1 + (b2 - b1) x / L + k x (L - x) / 2,

as if a load k T pulled it to the inside. At a support its tension T pulls aside with T times the change of its
direction: with equal staggers T L / R, for equal spans L.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ropewalk.model.overhead import OverheadLine, stations_of
from ropewalk.wires.plan import Array

BIN = 0.05  # m, width of the strips of a head in which the wire's way is counted
_POINTS = 400  # of each span


def aside_of(line: OverheadLine, span: int, x: Array) -> Array:
    """Distance of the contact wire from the middle of the track, positive to the left, m.

    Args:
        line: with a stagger, or without one.
        span: counted from 0.
        x: m, from the start of the span.
    """
    length = line.span_lengths[span]
    b1, b2 = (line.staggers or (0.0,) * (len(line.span_lengths) + 1))[span : span + 2]
    return np.asarray(b1 + (b2 - b1) * x / length + 0.5 * line.curvatures[span] * x * (length - x))


def across(line: OverheadLine, station: Array) -> Array:
    """The same at stations in m of the line.

    Args:
        line: with a stagger, or without one.
        station: m, within its ends.
    """
    supports = np.array(stations_of(line))
    span = np.clip(np.searchsorted(supports, station, side="right") - 1, 0, supports.size - 2)
    out = np.empty_like(station)
    for i in np.unique(span):
        out[span == i] = aside_of(line, int(i), station[span == i] - supports[i])
    return out


def widest(line: OverheadLine) -> float:
    """Largest distance of the contact wire from the middle of the track, on either side, m."""
    return blown_off(line, 0.0)


def on_the_strip(line: OverheadLine) -> tuple[Array, Array]:
    """How the way along the analysed spans is shared by the places of a head, which wears with it.

    Returns:
        Edges of strips that are `BIN` wide, (strip + 1,) m from the middle, and the share of the way in each, (strip,).
    """
    first, last = line.analysed
    share = (np.arange(_POINTS) + 0.5) / _POINTS
    aside = [aside_of(line, span, share * line.span_lengths[span]) for span in range(first - 1, last)]
    y, weight = np.concatenate(aside), np.repeat(line.span_lengths[first - 1 : last], _POINTS)
    low, high = np.floor(y.min() / BIN + 1e-9), np.floor(y.max() / BIN + 1e-9) + 1.0
    edges = BIN * np.arange(low, high + 1.0)
    return edges, np.histogram(y, edges, weights=weight)[0] / weight.sum()


def radial_forces(line: OverheadLine) -> Array:
    """Force aside with which steady arms hold the wire at the supports between spans, positive to the left, N.

    T (s1 - s2), s1 and s2 the wire's directions, from that of the track, on both sides of the support.
    """
    b = np.array(line.staggers or (0.0,) * (len(line.span_lengths) + 1))
    lengths = np.array(line.span_lengths)
    half = 0.5 * np.array(line.curvatures) * lengths
    slope = np.diff(b) / lengths
    kinks = [(one - h1) - (two + h2) for (one, two), (h1, h2) in zip(pairwise(slope), pairwise(half), strict=True)]
    return line.contact_wire.tension * np.array(kinks, dtype=np.float64)


def blown_off(line: OverheadLine, load: float) -> float:
    """Largest distance from the middle of the track under an even side load in N/m, from either side, m."""
    b = line.staggers or (0.0,) * (len(line.span_lengths) + 1)
    spans = zip(line.span_lengths, pairwise(b), line.curvatures, strict=True)
    return max(wind_deflection(length, *ends, line.contact_wire.tension, load, k) for length, ends, k in spans)


def wind_deflection(
    span: float, begin: float, end: float, tension: float, load: float, curvature: float = 0.0
) -> float:
    """Largest distance from the track's middle of a wire between two supports under an even load sideways, m.

    A string: y = b1 + (b2 - b1) x / L + (q + k T) x (L - x) / (2 T), and the same for the other direction of the load.

    Args:
        span: L, m.
        begin: where the first support holds it, b1, m.
        end: where the second one does, b2, m.
        tension: T, N.
        load: q, N/m.
        curvature: of the track, k, 1/m.
    """
    largest = max(abs(begin), abs(end))
    for q in (curvature * tension + load, curvature * tension - load):
        x = 0.5 * span + (end - begin) / span * tension / q if q else 0.0
        if 0.0 < x < span:
            largest = max(largest, abs(begin + (end - begin) * x / span + q * x * (span - x) / (2.0 * tension)))
    return largest
