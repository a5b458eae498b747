"""Tempo of films: the frames shown, for how long each, and the scale of time in words."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.contract import path_name

if TYPE_CHECKING:
    import xarray as xr

FRAMES, FRAMES_FOLLOWING = 151, 401  # most pictures; of films that follow pantographs
DELAYS = (40, 50, 60, 80, 100, 120, 150, 200)  # ms between pictures; GIF counts in 10 ms, 40 ms look fluent


@dataclass(frozen=True)
class Tempo:
    """Which frames are shown, for how long, and what that means for the scale of time."""

    frames: NDArray[np.intp]
    delay: int  # ms
    label: str


def tempo(dataset: xr.Dataset, most: int = FRAMES) -> Tempo:
    """Choose evenly spaced frames and a delay that gives a round scale of time, if there is one.

    Args:
        dataset: a result with at least two frames.
        most: most frames to show.
    """
    name = path_name(dataset)
    path = dataset[name].values
    stride = -(-(len(path) - 1) // max(most - 1, 1))
    step = float(np.median(np.diff(path))) * stride
    instants = np.arange(path[0], path[-1] + 0.5 * step, step)[:most]
    right = np.clip(np.searchsorted(path, instants), 1, len(path) - 1)
    chosen = np.where(instants - path[right - 1] <= path[right] - instants, right - 1, right)
    if name != "time":
        return Tempo(chosen, DELAYS[0], "quasi-static path of the load, no scale of time")
    ratios = {delay: step / (delay / 1000) for delay in DELAYS}
    real = (delay for delay, ratio in ratios.items() if abs(ratio - 1.0) < 1e-6)
    simple = (delay for delay, ratio in ratios.items() if _simple(ratio))
    delay = next(real, next(simple, DELAYS[0]))
    return Tempo(chosen, delay, _timing_text(ratios[delay]))


def _simple(ratio: float) -> str:
    """A ratio such as 1/4 or 2 as text, or nothing if it is not so simple."""
    fraction = Fraction(ratio).limit_denominator(1000)
    larger = max(fraction.numerator, fraction.denominator)
    while larger % 10 == 0:
        larger //= 10
    exact = abs(float(fraction) - ratio) < 1e-6 * ratio and min(fraction.numerator, fraction.denominator) == 1
    return str(fraction) if exact and larger in (1, 2, 4, 5, 25) else ""


def _timing_text(ratio: float) -> str:
    if abs(ratio - 1.0) < 1e-6:
        return "real speed"
    text = _simple(ratio) or f"{ratio:.3g}"
    return f"{text} of real speed" if ratio < 1.0 else f"{text} times real speed"
