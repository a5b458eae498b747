"""The coverage of a plane: on how much of it a model is good enough, and where, in a sentence."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ropewalk.compare.axes import Axis
from ropewalk.mechanics.chain import Array

Flags = NDArray[np.bool_]

WORDS = {
    "linear": "the linear theory",
    "quasi-static": "the quasi-static theory",
    "moving force": "a moving force",
    "moving mass": "a moving mass",
    "feedback cut": "a load without feedback",
    "full": "the full model",
}

Block = tuple[int, int, int, int]
"""A block of points: first and last along y, first and last along x."""


@dataclass(frozen=True)
class Coverage:
    """On how much of the plane a model is good enough, and where."""

    adequate: int  # points where it is
    points: int  # of the plane
    without: int  # points without an answer
    text: str

    def __str__(self) -> str:
        return self.text


def coverage_of(distance: Array, x: Axis, y: Axis, model: str, quantity: str, tolerance: float) -> Coverage:
    """Say where a model is good enough.

    Args:
        distance: (y, x) relative distance from the full model; NaN: none is known.
        x: first parameter.
        y: second parameter.
        model: the model.
        quantity: in which it is compared.
        tolerance: up to which it is good enough.
    """
    known, good = np.isfinite(distance), distance <= tolerance  # NaN is not good
    adequate, points, without = int(good.sum()), int(good.size), int((~known).sum())
    subject, limit = words(model), percent(tolerance)
    if without == points:
        return Coverage(0, points, without, f"{quantity}: {subject} has no answer anywhere in the plane")
    worst, best = _place(distance, x, y, np.nanargmax(distance)), _place(distance, x, y, np.nanargmin(distance))
    if not adequate:
        text = f"{subject} is within {limit} of the full answer nowhere in the plane; the smallest error is at {best}"
    elif adequate == points:
        text = (
            f"{subject} is within {limit} of the full answer everywhere in the plane; the largest error is at {worst}"
        )
    else:
        block = largest_block(good)
        share = f"{100.0 * adequate / points:.0f} % of the plane ({adequate} of {points} points)"
        text = f"{subject} is within {limit} of the full answer on {share}: {_region(block, x, y)}"
        rest = adequate - (block[1] - block[0] + 1) * (block[3] - block[2] + 1)
        if rest:
            text += f", and at {rest} more {_points(rest)}"
        text += f"; the largest error is at {worst}"
    if without:
        text += f"; {without} {_points(without)} {'have' if without > 1 else 'has'} no answer"
    return Coverage(adequate, points, without, f"{quantity}: {text}")


def largest_block(good: Flags) -> Block:
    """The largest block of points that are all good; of equal ones the first."""
    most, found = 0, (0, 0, 0, 0)
    count, width = good.shape
    for first in range(count):
        columns = np.ones(width, dtype=bool)
        for last in range(first, count):
            columns &= good[last]
            if not columns.any():
                break
            left, right = _longest_run(columns)
            if (size := (right - left + 1) * (last - first + 1)) > most:
                most, found = size, (first, last, left, right)
    return found


def _longest_run(good: Flags) -> tuple[int, int]:
    """First and last of the longest run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], good.astype(int), [0]))))
    k = int(np.argmax(edges[1::2] - edges[::2]))
    return int(edges[2 * k]), int(edges[2 * k + 1]) - 1


def _region(block: Block, x: Axis, y: Axis) -> str:
    (label_y, all_y), (label_x, all_x) = _range(y, *block[:2]), _range(x, *block[2:])
    if all_y and not all_x:
        return f"for {label_x} at {label_y}"
    return f"for {label_y} at {label_x}" if all_x else f"for {label_y} with {label_x}"


def _range(axis: Axis, first: int, last: int) -> tuple[str, bool]:
    """A range of values in words, and whether it is all of the axis."""
    low, high = axis.caption(axis.values[first]), axis.caption(axis.values[last])
    ends = (first == 0, last == len(axis.values) - 1)
    several = f"{axis.name}s" if axis.is_ratio else axis.name
    if all(ends):
        return f"any {axis.name} from {low} to {high}", True
    if first == last:
        return f"{axis.name} {low}", False
    if ends[0]:
        return f"{several} up to {high}", False
    return (f"{several} from {low}" if ends[1] else f"{several} from {low} to {high}"), False


def _place(distance: Array, x: Axis, y: Axis, at: np.intp) -> str:
    j, i = (int(k) for k in np.unravel_index(int(at), distance.shape))
    label = f"{x.name} {x.caption(x.values[i])} and {y.name} {y.caption(y.values[j])}"
    return f"{label} ({percent(float(distance[j, i]))})"


def words(model: str) -> str:
    """A model in a sentence."""
    return WORDS.get(model, model)


def percent(part: float) -> str:
    """A part as people say it."""
    value = 100.0 * part
    return f"{value:.2g} %" if value < 99.5 else f"{value:.0f} %"


def _points(count: int) -> str:
    return "point" if count == 1 else "points"
