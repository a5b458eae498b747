"""A given function of time, such as a load's place or its force, as a polynomial on panels."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

from ropewalk.theory import _panels
from ropewalk.theory._wave import FloatArray

__all__ = ["Given", "PiecewiseFunction", "course"]

Given = Callable[[FloatArray], ArrayLike] | tuple[ArrayLike, ArrayLike] | float

FIRST_PANELS = 16
MOST_PANELS = 20000
NARROWEST = 2.0**-44  # panel, of the whole time


@dataclass(frozen=True)
class PiecewiseFunction:
    """Function of time between the first and the last edge."""

    edges: FloatArray
    coefficients: FloatArray  # (panel, degree), Legendre

    def __call__(self, t: FloatArray) -> FloatArray:
        index, place = self._find(t)
        return _panels.at(self.coefficients[index], place)

    def rate(self) -> "PiecewiseFunction":
        """The derivative."""
        slopes = legendre.legder(self.coefficients, axis=1) * (2.0 / np.diff(self.edges))[:, np.newaxis]
        return PiecewiseFunction(self.edges, slopes)

    def integral(self) -> "PiecewiseFunction":
        """The integral from the first edge."""
        widths = np.diff(self.edges)[:, np.newaxis]
        rises = 0.5 * widths * legendre.legint(self.coefficients, lbnd=-1, axis=1)
        ends = np.sum(rises, axis=1)
        rises[:, 0] += np.concatenate([[0.0], np.cumsum(ends)[:-1]])
        return PiecewiseFunction(self.edges, rises)

    def times_at(self, level: float) -> FloatArray:
        """Times inside panels at which the function takes a value."""
        found = []
        for low, width, given in zip(self.edges, np.diff(self.edges), self.coefficients, strict=False):
            polynomial = given.copy()
            polynomial[0] -= level
            # Leading coefficients of rounding size would only add roots far away.
            large = np.flatnonzero(np.abs(polynomial) > 1e-15 * np.max(np.abs(polynomial)))
            if len(large) and large[-1] > 0:
                roots = legendre.legroots(polynomial[: large[-1] + 1])
                real = np.real(roots[np.abs(np.imag(roots)) < 1e-7])
                found.append(low + 0.5 * width * (real[np.abs(real) <= 1.0] + 1.0))
        return np.concatenate(found) if found else np.zeros(0)

    def _find(self, t: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
        index = np.clip(np.searchsorted(self.edges, t, side="right") - 1, 0, len(self.edges) - 2)
        return index, (t - self.edges[index]) / (self.edges[index + 1] - self.edges[index])


def course(name: str, given: Given, start: float, end: float, *, scale: float | None = None) -> PiecewiseFunction:
    """Return a number, a table (times, values) or a function of an array of times as a course.

    A table is linear between its times and ends with them. A function is followed from start to end to rounding of its
    size or of ``scale``; a kink or jump is hunted down to 1e-13 of the time. Without a scale only the integral counts:
    a panel may then add 1e-12 of the largest value times the time to it, so that noise does no harm. `ValueError` for
    values that are not finite, tables that are not of two equal rows with increasing times, functions with too many
    features.
    """
    if isinstance(given, tuple):
        return _table(name, *given)
    if not callable(given):
        if not np.isfinite(given):
            raise ValueError(f"{name} must be finite, not {given}")
        return PiecewiseFunction(np.array([start, end]), np.array([[float(given), 0.0]]))
    done: list[tuple[FloatArray, FloatArray]] = []
    low = np.linspace(start, end, FIRST_PANELS + 1)
    low, high, largest = low[:-1], low[1:], 0.0
    while len(low):
        # The ends are looked at, too: a kink between the last Gauss point and the end would be missed.
        places = np.array([0.0, *_panels.POINTS, 1.0])
        times = low[:, np.newaxis] + (high - low)[:, np.newaxis] * places
        values = np.broadcast_to(np.asarray(given(times), dtype=np.float64), times.shape)
        if not np.all(np.isfinite(values)):
            raise ValueError(f"{name} must be finite between {start:g} and {end:g} s")
        fitted = values[:, 1:-1] @ _panels.FIT.T
        size = np.maximum(np.max(np.abs(fitted), axis=1), scale or 0.0)
        largest = max(largest, float(np.max(size)))
        missed = np.abs(_panels.at(fitted[:, np.newaxis, :], places[[0, -1]][np.newaxis]) - values[:, [0, -1]])
        tail = np.maximum(np.max(np.abs(fitted[:, -2:]), axis=1), 1e-2 * np.max(missed, axis=1))
        good = tail <= np.maximum(1e-14 * size, 1e-300)  # numbers next to the smallest have few digits
        if scale is None:
            good |= tail * (high - low) <= 1e-12 * largest * (end - start)
        good |= high - low <= NARROWEST * (end - start)
        done.append((low[good], fitted[good]))
        middle = 0.5 * (low + high)[~good]
        low, high = np.concatenate([low[~good], middle]), np.concatenate([middle, high[~good]])
        if len(low) > MOST_PANELS:
            raise ValueError(f"{name} has too many features between {start:g} and {end:g} s to be followed")
    starts = np.concatenate([part[0] for part in done])
    order = np.argsort(starts)
    coefficients = np.concatenate([part[1] for part in done])[order]
    return PiecewiseFunction(np.append(starts[order], end), coefficients)


def _table(name: str, times: ArrayLike, values: ArrayLike) -> PiecewiseFunction:
    t, y = np.asarray(times, dtype=np.float64), np.asarray(values, dtype=np.float64)
    if t.ndim != 1 or t.shape != y.shape or len(t) < 2 or not np.all(np.diff(t) > 0.0):
        raise ValueError(f"{name} as a table must be (times, values), both of one length, the times increasing")
    if not (np.all(np.isfinite(t)) and np.all(np.isfinite(y))):
        raise ValueError(f"{name} must be finite")
    return PiecewiseFunction(t, 0.5 * np.stack([y[1:] + y[:-1], np.diff(y)], axis=1))
