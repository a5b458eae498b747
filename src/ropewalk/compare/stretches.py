"""Stretches: where along the way of a load a model is within its tolerance."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from ropewalk.compare.trace import Difference
from ropewalk.coupling import percent
from ropewalk.mechanics.chain import Array
from ropewalk.results.display_units import number
from ropewalk.results.extremes import Summary

# Curves that cross agree for a moment, which means nothing: good stretches shorter than this part of the way between
# bad ones are none.
SHORTEST = 0.02


@dataclass(frozen=True)
class Reach:
    """Where the local error of a model stays within a tolerance, along the way of one wheel; lengths in m."""

    tolerance: float
    begin: float  # the part of the line that was compared: from here
    end: float  # to here
    beyond: tuple[tuple[float, float], ...]  # where the error is larger, from and to, rising
    worst: float  # largest local error
    worst_at: float  # where, m

    @property
    def from_start(self) -> float:
        """Up to where, from the place nearest to the start of the line, the model holds, m."""
        return self.beyond[0][0] if self.beyond else self.end

    @property
    def to_end(self) -> float:
        """Length at the far end of the way along which it holds again, m; 0 where it fails up to there."""
        return self.end - self.beyond[-1][1] if self.beyond else self.end - self.begin

    @property
    def share(self) -> float:
        """Part of the way on which it fails."""
        whole = self.end - self.begin
        return float(min(sum(b - a for a, b in self.beyond) / whole, 1.0)) if whole > 0.0 else float(bool(self.beyond))

    def as_dict(self) -> Summary:
        """Plain values that fit into JSON."""
        return {**asdict(self), "from_start": self.from_start, "to_end": self.to_end, "share": self.share}

    def text(self, model: str) -> str:
        """A sentence about it, without a full stop."""
        within, near = f"{100.0 * self.tolerance:.3g} %", SHORTEST * (self.end - self.begin)
        if not self.beyond:
            return (
                f"{model} is within {within} along the whole path, {number(self.begin, 3)} to {number(self.end, 3)} m"
            )
        first, last = self.beyond[0], self.beyond[-1]
        starts, ends = first[0] <= self.begin + near, last[1] >= self.end - near
        worst = f"{percent(self.worst)} off at {number(self.worst_at, 3)} m"
        if starts and ends and len(self.beyond) == 1:
            return f"{model} is nowhere within {within} ({worst})"
        if len(self.beyond) > 1:
            parts = " and ".join(f"{number(a, 3)} to {number(b, 3)} m" for a, b in self.beyond[:3])
            more = ", ..." if len(self.beyond) > 3 else ""
            return f"{model} is within {within} but for {parts}{more} ({worst})"
        if ends:
            rest = f"on the last {number(self.end - first[0], 3)} m of the path"
            return (
                f"{model} is within {within} up to {number(first[0], 3)} m from the start; {rest} it is not ({worst})"
            )
        if starts:
            return f"{model} is within {within} from {number(last[1], 3)} m on; before it is not ({worst})"
        return (
            f"{model} is within {within} up to {number(first[0], 3)} m from the start and on the last "
            f"{number(self.to_end, 3)} m; between them it is not ({worst})"
        )


def reach_of(way: Difference, tolerance: float) -> Reach:
    """Find where the local error of the deflection under a wheel exceeds a tolerance."""
    order = np.argsort(way.xi, kind="stable")
    xi, error = way.xi[order], way.local[order]
    bad = error > tolerance
    begin, end = float(xi[0]), float(xi[-1])
    found: list[tuple[float, float]] = []
    edges = np.diff(np.concatenate([[0], bad.astype(np.int8), [0]]))
    for first, last in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1, strict=True):
        a = _crossing(xi, error, int(first) - 1, tolerance) if first > 0 else begin
        b = _crossing(xi, error, int(last), tolerance) if last + 1 < xi.size else end
        if found and a - found[-1][1] < SHORTEST * (end - begin):
            found[-1] = (found[-1][0], b)
        else:
            found.append((a, b))
    at = int(error.argmax())
    return Reach(tolerance, begin, end, tuple(found), float(error[at]), float(xi[at]))


def _crossing(xi: Array, error: Array, i: int, tolerance: float) -> float:
    """Where between places i and i + 1 the error passes the tolerance, m."""
    a, b = float(error[i]), float(error[i + 1])
    part = (tolerance - a) / (b - a) if a != b else 0.5
    return float(xi[i] + part * (xi[i + 1] - xi[i]))
