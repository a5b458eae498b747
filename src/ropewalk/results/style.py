"""The look of all figures and films: colours safe for colour-blind readers, light axes, one place to change them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import LinearSegmentedColormap

# Okabe and Ito (2008), https://jfly.uni-koeln.de/color/, without the yellow that vanishes on white
BLUE, ORANGE, GREEN, RED, PURPLE, SKY, BLACK = (
    "#0072B2",
    "#E69F00",
    "#009E73",
    "#D55E00",
    "#CC79A7",
    "#56B4E9",
    "#222222",
)
CYCLE = (BLUE, RED, GREEN, ORANGE, PURPLE, SKY, BLACK)
LOAD = RED
INSTANTS = "viridis"  # early to late
TENSION = "plasma"  # low to high
RANGE = (0.0, 0.88)  # of both maps: their light ends are hard to see on white

INK = "#333333"
FAINT = "#8A8A8A"
GRID = "#E3E3E3"
LINE = 1.5
THIN = 0.9
TITLE, LABEL, TICK, NOTE = 10.5, 9.5, 8.5, 8.0  # points
DPI = 150
LEGEND_COLUMNS = 3
_TITLE: dict[str, Any] = {"fontsize": TITLE, "color": INK, "fontweight": "bold"}


def colours(name: str) -> LinearSegmentedColormap:
    """The part of a colour map that is easy to see on white."""
    from matplotlib import colormaps  # the summary of a run looks in here, too, and draws nothing
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list(name, colormaps[name](np.linspace(*RANGE, 256)))


def dress(ax: Axes, title: str = "", x: str = "", y: str = "") -> None:
    """Give axes their look, a title and labels (with units, as in "time (s)")."""
    ax.set_title(title, loc="left", **_TITLE)
    ax.set_xlabel(x, fontsize=LABEL, color=INK)
    ax.set_ylabel(y, fontsize=LABEL, color=INK)
    ax.tick_params(labelsize=TICK, colors=INK, width=0.6, length=3)
    ax.grid(visible=True, color=GRID, linewidth=0.6)
    ax.set_axisbelow(True)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        ax.spines[side].set(color=FAINT, linewidth=0.6)


def remark(ax: Axes, text: str) -> None:
    """A small remark at the right end of the title."""
    ax.set_title(text, loc="right", fontsize=NOTE, color=FAINT)


def legend(ax: Axes) -> None:
    """A legend between title and axes, where it hides nothing, if anything carries a label."""
    handles, labels = ax.get_legend_handles_labels()
    if not handles:
        return
    options: dict[str, Any] = {"fontsize": NOTE, "labelcolor": INK, "handlelength": 1.8, "columnspacing": 1.4}
    place: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "borderaxespad": 0.2}
    ax.legend(handles, labels, **options, **place, ncols=LEGEND_COLUMNS, frameon=False, borderpad=0.1)
    lift_titles([ax])


def lift_titles(axes: Iterable[Axes]) -> None:
    """Put the titles of neighbouring axes at one height, above the largest of their legends."""
    axes = list(axes)
    legends = [found for ax in axes if (found := ax.get_legend()) is not None]
    rows = max((math.ceil(len(found.get_texts()) / LEGEND_COLUMNS) for found in legends), default=0)
    for ax in axes:
        ax.set_title(ax.get_title("left"), loc="left", pad=6.0 + 1.35 * NOTE * rows, **_TITLE)


def nice(value: float) -> float:
    """The largest of 1, 2, 5, 10, 20, ... (and 0.5, 0.2, ...) that does not exceed a positive value."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (5.0, 2.0, 1.0) if step * power <= value * (1 + 1e-9))


def thinned(count: int, most: int) -> NDArray[np.intp]:
    """Indices of at most `most` of `count` points, evenly spread, with the first and the last."""
    if count <= most:
        return np.arange(count)
    return np.unique(np.linspace(0, count - 1, most).round().astype(np.intp))


def colour_range(tension: NDArray[np.float64]) -> tuple[float, float, str]:
    """Range of the colours without rare spikes, and the side(s) where the bar says that there is more."""
    kept = tension[np.isfinite(tension)]
    if not kept.size:
        return 0.0, 1.0, "neither"
    lowest, highest = float(kept.min()), float(kept.max())
    low, high = (float(v) for v in np.percentile(kept, (0.2, 99.8)))
    spread = high - low
    low = lowest if low - lowest < 0.25 * spread else low
    high = highest if highest - high < 0.25 * spread else high
    beyond = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}
    side = beyond[low > lowest, high < highest]
    return (low, high, side) if high > low else (low - 0.5, high + 0.5, side)


def digits(path: NDArray[np.float64]) -> int:
    """Decimals that tell neighbouring values of the path apart."""
    step = float(np.median(np.diff(path)))
    return int(np.clip(np.ceil(-np.log10(step)), 0, 6)) if step > 0.0 else 0
