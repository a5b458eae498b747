"""The look of all figures and films: colours safe for colour-blind readers, light axes, sizes of pages and letters."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.errors import Refused, did_you_mean

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.legend import Legend

# Okabe and Ito (2008), https://jfly.uni-koeln.de/color/, without the yellow that vanishes on white
CYCLE = BLUE, RED, GREEN, ORANGE, PURPLE, SKY, BLACK = (
    "#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9", "#222222"
)  # fmt: skip
LOAD = RED
INSTANTS = "viridis"  # early to late
TENSION = "plasma"  # low to high
HEIGHT = "cividis"
RANGE = (0.0, 0.88)  # of both maps: their light ends are hard to see on white

INK = "#333333"
FAINT = "#8A8A8A"
GRID = "#E3E3E3"
if TYPE_CHECKING:
    TITLE: float
    LABEL: float
    TICK: float
    NOTE: float
    LINE: float
    THIN: float
_POINTS = {"TITLE": 10.5, "LABEL": 9.5, "TICK": 8.5, "NOTE": 8.0, "LINE": 1.5, "THIN": 0.9}
_SCALE: ContextVar[float] = ContextVar("scale", default=1.0)  # of all these
DPI = 150
LEGEND_COLUMNS = 3
LINE_HEIGHT = 1.4  # of legends, in letters
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
_MARK, _MARKS = 4.0, 8  # points, and how many along a curve


def __getattr__(name: str) -> float:
    """Sizes of letters and lines in points, as the page wants them."""
    if name not in _POINTS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return sized(_POINTS[name])


@contextmanager
def scaled(scale: float) -> Iterator[None]:
    """Draw with letters and lines that are so many times as large."""
    token = _SCALE.set(scale)
    try:
        yield
    finally:
        _SCALE.reset(token)


def sized(size: float) -> float:
    """A size in points, as the page wants it."""
    return size * _SCALE.get()


def points(name: str) -> float:
    """One of the sizes, as the page wants it."""
    return __getattr__(name)


def marks(k: int, of: int, points: int) -> dict[str, Any]:
    """Marks along the k-th of several curves, which tell them apart without colours; none on a curve that is alone."""
    if of < 2:
        return {}
    spread = max(points // _MARKS, 1)
    size: dict[str, Any] = {"markersize": sized(_MARK), "markeredgewidth": 0.6, "markeredgecolor": "white"}
    return {"marker": MARKERS[k % len(MARKERS)], "markevery": (k * spread // of, spread), **size}


def colours(name: str) -> LinearSegmentedColormap:
    """The part of a colour map that is easy to see on white."""
    from matplotlib import colormaps  # the summary of a run looks in here, too, and draws nothing
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list(name, colormaps[name](np.linspace(*RANGE, 256)))


def dress(ax: Axes, title: str = "", x: str = "", y: str = "") -> None:
    """Give axes their look, a title and labels (with units, as in "time (s)")."""
    ax.set_title(title, loc="left", **_title())
    ax.set_xlabel(x, fontsize=points("LABEL"), color=INK)
    ax.set_ylabel(y, fontsize=points("LABEL"), color=INK)
    ax.tick_params(labelsize=points("TICK"), colors=INK, width=0.6, length=3)
    ax.grid(visible=True, color=GRID, linewidth=0.6)
    ax.set_axisbelow(True)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        ax.spines[side].set(color=FAINT, linewidth=0.6)


def _title() -> dict[str, Any]:
    return {"fontsize": points("TITLE"), "color": INK, "fontweight": "bold"}


def remark(ax: Axes, text: str) -> None:
    """A small remark at the right end of the title."""
    ax.set_title(text, loc="right", fontsize=points("NOTE"), color=FAINT)


def legend(ax: Axes, columns: int = LEGEND_COLUMNS) -> None:
    """A legend between title and axes, where it hides nothing, if anything carries a label.

    The label of a single solid curve stands at the right end of the title, if that is empty.
    """
    handles, labels = ax.get_legend_handles_labels()
    if len(handles) == 1 and getattr(handles[0], "get_linestyle", str)() == "-" and not ax.get_title("right"):
        remark(ax, labels[0])
        return
    if not handles:
        return
    options: dict[str, Any] = {"fontsize": points("NOTE"), "labelcolor": INK, "handlelength": 1.8, "columnspacing": 1.4}
    options["labelspacing"] = 0.3
    place: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "borderaxespad": 0.2}
    ax.legend(handles, labels, **options, **place, ncols=columns, frameon=False, borderpad=0.1)
    lift_titles([ax])


def settle(rows: Iterable[Sequence[Axes]]) -> None:
    """Give legends as many columns as there is room for, once axes have their places.

    Args:
        rows: panels that stand side by side.
    """
    for row in rows:
        for ax in row:
            if (found := ax.get_legend()) is not None:
                legend(ax, _columns(ax, found))
            _part_titles(ax)
            lift_titles([ax])


def _part_titles(ax: Axes) -> None:
    """A remark that there is no room for beside the title goes below it."""
    title, note = ax.get_title("left"), ax.get_title("right")
    if not note:
        return
    letter = points("NOTE") * ax.figure.dpi / 72.0
    drawn: Any = ax  # whose types do not know of these
    widths = [text.get_window_extent().width for text in (drawn._left_title, drawn._right_title)]
    if sum(widths) + 2.0 * letter > ax.get_window_extent().width:
        ax.set_title(f"{title}\n{note}", loc="left", **_title())
        ax.set_title("", loc="right")


def legend_rows(axes: Iterable[Axes]) -> int:
    """Lines of the largest legend above some axes."""
    legends: list[Any] = [found for ax in axes if (found := ax.get_legend()) is not None]
    return max((math.ceil(len(found.get_texts()) / found._ncols) for found in legends), default=0)


def _columns(ax: Axes, found: Legend) -> int:
    """How many columns of a legend fit above its axes."""
    letter = points("NOTE") * ax.figure.dpi / 72.0
    widths = [text.get_window_extent().width + 4.2 * letter for text in found.get_texts()]  # handle and gaps included
    space = ax.get_window_extent().width + 1.4 * letter
    fitting = (n for n in range(len(widths), 1, -1) if sum(map(max, np.array_split(widths, n))) <= space)
    return next(fitting, 1)


def lift_titles(axes: Iterable[Axes]) -> None:
    """Put the titles of neighbouring axes at one height, above the largest of their legends."""
    axes = list(axes)
    pad = 6.0 + LINE_HEIGHT * points("NOTE") * legend_rows(axes)
    for ax in axes:
        ax.set_title(ax.get_title("left"), loc="left", pad=pad, **_title())


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


INCHES = {"cm": 1.0 / 2.54, "mm": 0.1 / 2.54, "in": 1.0}
NAMED = {"screen": 11.0, "report": 16.0 / 2.54, "journal": 8.8 / 2.54}  # in: widths of the screen, of text, of a column
SCREEN_DPI, PRINT_DPI, PIXEL_DPI = 150, 300, 100
NARROW = 12.0 / 2.54  # in: narrower pages have one column of panels
TALLEST = 24.0 / 2.54  # in: what fits on a sheet of A4
LEAST, MOST = 0.1, 100.0  # in
_SIZE = re.compile(r"(\d+(?:\.\d+)?)\s*[x×]\s*(\d+(?:\.\d+)?)\s*(cm|mm|in|px)?")


@dataclass(frozen=True)
class Page:
    """A size; without a height it is as high as the panels need, on paper up to that of a sheet."""

    width: float  # in
    height: float | None  # in
    dpi: int

    @classmethod
    def of(cls, size: str | None) -> Page:
        """Read a size: `screen` (also None), `report`, `journal`, or as "16x9cm", in cm, mm, in or px.

        Raises:
            Refused: (a ValueError) it is none, or too small or large to draw on.
        """
        name = (size or "screen").strip()
        if name in NAMED:
            return cls(NAMED[name], None, SCREEN_DPI if name == "screen" else PRINT_DPI)
        width, height, unit = read_size(name, "cm")
        inch = 1.0 / PIXEL_DPI if unit == "px" else INCHES[unit]
        if not all(LEAST <= side * inch <= MOST for side in (width, height)):
            raise Refused(f"a figure of {name} cannot be drawn", f"stay within {LEAST:g} to {MOST:g} in")
        return cls(width * inch, height * inch, PIXEL_DPI if unit == "px" else PRINT_DPI)

    @property
    def scale(self) -> float:
        """How large letters are, 1 on a screen: 8 points for labels in a report, 7 in a journal."""
        return min(0.6 + 0.4 * self.width / NAMED["screen"], 1.2)

    @property
    def columns(self) -> int:
        """How many panels stand side by side."""
        return 1 if self.width < NARROW else 2

    def tall(self, wanted: float) -> float:
        """The height in inches, if panels want so much."""
        if self.height is not None:
            return self.height
        return wanted if self.dpi == SCREEN_DPI else min(wanted, TALLEST)


def read_size(text: str, unit: str) -> tuple[float, float, str]:
    """Read width, height and their unit (without one `unit`) from a text such as "16x9cm".

    Raises:
        Refused: (a ValueError) it is no size.
    """
    found = _SIZE.fullmatch(text.strip())
    if found is None:
        remedy = did_you_mean(text, NAMED, otherwise=f"write as 16x9cm or 1280x720px, or {', '.join(NAMED)}")
        raise Refused("expected a size", remedy)
    return float(found[1]), float(found[2]), found[3] or unit
