"""Peaks of sampled forces that come from one step: blows of rigid contacts, and impulses of entering and leaving."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.frame import Array

ALONE = 10.0  # a value that is so many times its neighbours' and the usual one comes from one step
SHARP = 0.1  # part of a value by which a largest one may stand out: 2.5 % may be missed then
EDGE = 2  # samples after entering and before leaving whose peaks are impulses of entering and leaving


def lonely(values: Array) -> int | None:
    """Find the largest of values, if it is alone: many times those next to it and the usual one, and at neither end.

    Args:
        values: (sample,) not negative; NaN where there is nothing.

    Returns:
        Its index, None if there is no such value.
    """
    there = np.flatnonzero(np.isfinite(values))
    if there.size < 2 * EDGE + 3:
        return None
    usual, inner = float(np.median(values[there])), there[EDGE:-EDGE]
    i = int(inner[values[inner].argmax()])
    return i if values[i] > ALONE * max(usual, beside(values, i)) and usual > 0.0 else None


def sharp(values: Array) -> int | None:
    """Find the largest of values, if it stands out from the mean of the two next to it by a good part of itself.

    Of a sine with n values in a period that is A (1 - cos(2 pi / n)).

    Args:
        values: (instant,) not negative.

    Returns:
        Its index, None if there is no such value.
    """
    if values.size < 3:
        return None
    i = 1 + int(values[1:-1].argmax())
    bend = values[i] - 0.5 * (values[i - 1] + values[i + 1])
    return i if values[i] == values.max() and bend > SHARP * values[i] else None


def missed(values: Array, i: int) -> float:
    """By which part of itself the peak of a sine may be larger between instants: a quarter of how it stands out."""
    return float(0.25 * (values[i] - 0.5 * (values[i - 1] + values[i + 1])) / values[i])


def too_far_apart(what: str, values: Array, instants: Array, i: int) -> str:
    """Say that the largest of values, in N, is a peak that output instants, in s, are too far apart for.

    Args:
        what: it is.
        values: (instant,) N.
        instants: (instant,) s.
        i: its index, see `sharp`.
    """
    return (
        f"{what}, {values[i]:.4g} N at t = {instants[i]:.4g} s, is a peak shorter than the output interval: "
        f"{values[i - 1]:.4g} N {instants[i] - instants[i - 1]:.3g} s before and {values[i + 1]:.4g} N after; the "
        f"true peak may be larger by {100.0 * missed(values, i):.2g} % or more; write a smaller run.every"
    )


def beside(values: Array, i: int) -> float:
    """The larger one of the values before and after an inner one, zero where there are none."""
    return float(np.nan_to_num(values[[i - 1, i + 1]]).max())


def impulses(values: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Find samples after entering and before leaving that stand out: impulses over a step, and no forces.

    Args:
        values: (sample,) not negative; NaN where a load is not on its line.

    Returns:
        Indices of those after entering, and of those before leaving.
    """
    there = np.flatnonzero(np.isfinite(values))
    if there.size < 2 * EDGE + 3:
        return there[:0], there[:0]
    most = ALONE * float(values[there[EDGE:-EDGE]].max())
    # Who is there from the first sample to the last has neither entered nor left.
    first = there[:EDGE] if there[0] > 0 else there[:0]
    last = there[-EDGE:] if there[-1] < values.size - 1 else there[:0]
    return first[values[first] > most], last[values[last] > most]
