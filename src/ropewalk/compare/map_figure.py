"""The figure of an adequacy map: distances from the full model as contours, the tolerance as their boldest line."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import Rectangle
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator
from numpy.typing import NDArray

from ropewalk.compare.axes import Axis
from ropewalk.compare.coverage import Coverage, percent, words
from ropewalk.mechanics.chain import Array
from ropewalk.results import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ropewalk.compare.adequacy import AdequacyMap

Flags = NDArray[np.bool_]

COLUMNS = 3  # of maps side by side
HEAD, SPACING = style.TITLE + 1.5, 1.35  # points; lines for each line
# What is good enough is blue, what is not is brown, and both are darker further away from the tolerance.
GOOD, BAD = ("#0B5A8A", "#7DB3D3", "#E3EEF4"), ("#FBEFD9", "#E9A94B", "#9A3B00")
HATCH: dict[str, Any] = {"facecolor": "#F4F4F4", "edgecolor": "#BDBDBD", "hatch": "////", "linewidth": 0.0}
LEAST = 1e-5  # smaller distances are drawn as this: contours are those of the logarithm
DECADES = 2.0  # that are coloured on each side of the tolerance
STEPS = (1.0, 2.0, 5.0)
SPACE = 0.1  # of the plane's width, around a label
FINE = 161  # points along each side where room for labels is looked for


def map_figure(found: AdequacyMap, models: Sequence[str], quantity: str, tolerance: float) -> Figure:
    """Draw the maps of one model or of several, side by side.

    Args:
        found: the map.
        models: the simpler models.
        quantity: in which they are compared with the full one.
        tolerance: relative distance that is drawn bold.

    Raises:
        ScenarioError: there is no such model or quantity.
    """
    maps = [found.of(model, quantity) for model in models]
    columns = 2 if len(maps) == 4 else min(len(maps), COLUMNS)
    rows = -(-len(maps) // columns)
    width, height = (7.6, 5.0) if len(maps) == 1 else (3.6 * columns + 1.2, 3.3 * rows)
    verdicts = [str(found.coverage(model, quantity, tolerance)) for model in models]
    marks = _marks(found, maps)
    notes = _wrapped([found.title, *(verdicts if len(maps) == 1 else ()), *marks], width)
    model = words(models[0]) if len(maps) == 1 else "a simpler model"
    head = _wrapped([f"Where {model} is within {percent(tolerance)} of the full model: {quantity}"], width, HEAD)
    above, below = (len(lines) * size * SPACING / 72.0 + 0.15 for lines, size in ((head, HEAD), (notes, style.NOTE)))
    whole = height + above + below
    layout = ConstrainedLayoutEngine(rect=(0.0, below / whole, 1.0, height / whole), h_pad=0.08, w_pad=0.08)
    figure = Figure(figsize=(width, whole), dpi=style.DPI, layout=layout)
    text: dict[str, Any] = {"ha": "left", "color": style.INK, "linespacing": SPACING / 1.2}
    figure.text(0.01, 1.0 - 0.1 / whole, "\n".join(head), va="top", fontsize=HEAD, fontweight="bold", **text)
    figure.text(0.01, 0.1 / whole, "\n".join(notes), va="bottom", fontsize=style.NOTE, **text)
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    levels = _levels(tolerance, maps)
    colours = _colours(levels, tolerance)
    for k, ax in enumerate(grid.flat):
        if k >= len(maps):
            ax.set_axis_off()
            continue
        _draw(ax, found, maps[k], tolerance, levels, colours)
        last = k + columns >= len(maps)
        title = _panel(models[k], found.coverage(models[k], quantity, tolerance)) if len(maps) > 1 else ""
        style.dress(ax, title, found.x.label if last else "", "" if k % columns else found.y.label)
        ax.tick_params(labelbottom=last)
        ax.grid(visible=False)
    _bar(figure, grid, levels, colours, tolerance)
    return figure


def _wrapped(paragraphs: Sequence[str], width: float, size: float = style.NOTE) -> list[str]:
    """Lines of text of a size in points that go into a width in inches; a sign is about half as wide as high."""
    signs = int(width * 72.0 / (size * (0.64 if size > style.NOTE else 0.55)))
    return [line for paragraph in paragraphs for line in textwrap.wrap(paragraph, signs)]


def _panel(model: str, coverage: Coverage) -> str:
    """The title of one of several maps."""
    name = words(model)
    return f"{name[:1].upper()}{name[1:]}: on {100.0 * coverage.adequate / coverage.points:.0f} %"


def _levels(tolerance: float, maps: Sequence[Array]) -> Array:
    """Edges of the colours: 1, 2, 5, 10, ... over what there is, and the tolerance."""
    known = np.concatenate([values[np.isfinite(values)] for values in maps])
    known = np.maximum(known, LEAST) if known.size else np.array([tolerance])
    reach = 10.0**DECADES
    low = max(min(float(known.min()), tolerance / 2.0), tolerance / reach)
    high = min(max(float(known.max()), 2.0 * tolerance), tolerance * reach)
    nice = [step * 10.0**power for power in range(-8, 5) for step in STEPS]
    inner = [level for level in nice if low <= level <= high and abs(np.log(level / tolerance)) > 0.1]
    below = max(level for level in nice if level < min(low, *inner, tolerance))
    above = min(level for level in nice if level > max(high, *inner, tolerance) * 0.999)
    return np.unique([below, *inner, tolerance, above])


def _colours(levels: Array, tolerance: float) -> LinearSegmentedColormap:
    """One colour for each step between levels, changing side at the tolerance."""
    good, bad = int((levels < tolerance).sum()), int((levels > tolerance).sum())
    shades = [
        *LinearSegmentedColormap.from_list("good", GOOD)(np.linspace(0.0, 1.0, good) if good > 1 else [0.5]),
        *LinearSegmentedColormap.from_list("bad", BAD)(np.linspace(0.0, 1.0, bad) if bad > 1 else [0.5]),
    ]
    return LinearSegmentedColormap.from_list("adequacy", shades, N=len(shades))


def _draw(
    ax: Axes, found: AdequacyMap, values: Array, tolerance: float, levels: Array, colours: LinearSegmentedColormap
) -> None:
    x, y = found.x, found.y
    ax.set_xscale(x.scale)
    ax.set_yscale(y.scale)
    ax.set_xlim(x.values[0], x.values[-1])
    ax.set_ylim(y.values[0], y.values[-1])
    for side, axis in ((ax.xaxis, x), (ax.yaxis, y)):
        if axis.scale == "log":
            _ticks(side, axis)
    ax.add_patch(Rectangle((0, 0), 1, 1, transform=ax.transAxes, zorder=0, **HATCH))
    known = np.isfinite(values)
    # Between points, the logarithm of the distance is taken for linear.
    logs = np.ma.masked_invalid(np.log10(np.clip(np.where(known, values, np.nan), LEAST, None)))
    edges, drawn = np.log10(levels), np.clip(logs, np.log10(levels[0]), np.log10(levels[-1]))
    if (known[:-1, :-1].astype(int) + known[1:, :-1] + known[:-1, 1:] + known[1:, 1:] >= 3).any():
        norm = BoundaryNorm(edges, colours.N)
        ax.contourf(x.values, y.values, drawn, edges, cmap=colours, norm=norm, zorder=1)
        ax.contour(
            x.values,
            y.values,
            drawn,
            edges[1:-1],
            colors="white",
            linestyles="solid",
            linewidths=0.5,
            alpha=0.7,
            zorder=2,
        )
        limit = np.log10(tolerance)
        if logs.min() < limit < logs.max():
            ax.contour(
                x.values, y.values, logs, [limit], colors=style.INK, linestyles="solid", linewidths=2.6, zorder=3
            )
    across, along = np.meshgrid(x.values, y.values)
    failed = np.array([[bool(reason) for reason in row] for row in found.reasons])
    silent = ~known & ~failed
    cross: dict[str, Any] = {"marker": "x", "color": style.RED, "ms": 6.0, "mew": 1.5}
    ring: dict[str, Any] = {"marker": "o", "color": style.FAINT, "ms": 4.0, "mew": 1.0, "mfc": "none"}
    dot: dict[str, Any] = {"marker": ".", "color": style.INK, "ms": 2.6, "mew": 0.0, "alpha": 0.55}
    for which, how in ((known, dot), (failed, cross), (silent, ring)):
        if which.any():
            ax.plot(across[which], along[which], ls="none", zorder=5, clip_on=False, **how)
    _name(ax, x, y, logs.filled(np.nan), np.log10(tolerance))


def _marks(found: AdequacyMap, maps: Sequence[Array]) -> list[str]:
    """What the marks in the maps mean, if there are any."""
    failed = sum(bool(reason) for row in found.reasons for reason in row)
    silent = max(int((~np.isfinite(values)).sum()) for values in maps) - failed
    caption = [f"× failed ({failed})"] if failed else []
    return ["   ".join(caption + (["○ nothing to compare"] if silent else []))] if failed or silent else []


def _ticks(axis: Any, scale: Axis) -> None:
    """Plain numbers at 1, 2, 5, 10, ... that lie on a logarithmic axis; at powers of ten where these are many."""
    low, high = scale.values[0], scale.values[-1]
    steps = STEPS if high / low < 10.0**2.5 else (1.0,)
    powers = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    places = [step * 10.0**power for power in powers for step in steps]
    kept = [place for place in places if low * 0.999 <= place <= high * 1.001]
    axis.set_major_locator(FixedLocator(kept if len(kept) > 1 else [low, high]))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.4g}"))
    axis.set_minor_locator(NullLocator())


def _name(ax: Axes, x: Axis, y: Axis, logs: Array, limit: float) -> None:
    """Write into the two regions what they are, where there is room for it."""
    side = np.linspace(0.0, 1.0, FINE)
    places = [_along(axis, side) for axis in (x, y)]
    rows = np.array([np.interp(places[0], np.arange(len(x.values)), row) for row in logs])
    fine = np.array([np.interp(places[1], np.arange(len(y.values)), column) for column in rows.T]).T
    for inside, text, colour in ((fine <= limit, "adequate", "#06304A"), (fine > limit, "not adequate", "#5A2300")):
        space, at = _roomiest(inside)
        if space > SPACE * (0.5 if text == "adequate" else 0.75):
            ax.text(side[at[1]], side[at[0]], text, transform=ax.transAxes, ha="center", va="center", color=colour,
                    fontsize=style.TITLE, fontweight="bold", zorder=6, bbox={"boxstyle": "round,pad=0.25",
                    "fc": "white", "ec": "none", "alpha": 0.75})  # fmt: skip


def _along(axis: Axis, side: Array) -> Array:
    """Numbers of points, in fractions, at parts of the side of the drawn plane."""
    values = np.log(axis.values) if axis.scale == "log" else np.asarray(axis.values)
    return np.asarray(np.interp(values[0] + side * (values[-1] - values[0]), values, np.arange(values.size)))


def _roomiest(inside: Flags) -> tuple[float, tuple[int, int]]:
    """The place furthest inside of a region, and how far that is, in widths of the plane; across counts a third."""
    from scipy.ndimage import distance_transform_edt

    framed = np.zeros((FINE + 2, FINE + 2), dtype=bool)
    framed[1:-1, 1:-1] = inside
    depth = distance_transform_edt(framed, sampling=(1.0, 0.4))[1:-1, 1:-1]  # text is wider than high
    j, i = (int(k) for k in np.unravel_index(int(depth.argmax()), depth.shape))
    return float(depth[j, i]) / FINE, (j, i)


def _bar(figure: Figure, grid: Any, levels: Array, colours: LinearSegmentedColormap, tolerance: float) -> None:
    from matplotlib.cm import ScalarMappable

    norm = BoundaryNorm(np.log10(levels), colours.N)
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=grid, ticks=np.log10(levels), spacing="proportional",
                          aspect=28, pad=0.02)  # fmt: skip
    labels = [percent(level) for level in levels]
    labels[0], labels[-1] = f"≤ {labels[0]}", f"≥ {labels[-1]}"
    bar.set_ticklabels(labels, fontsize=style.TICK, color=style.INK)
    bar.set_label("distance from the full model", fontsize=style.LABEL, color=style.INK)
    bar.ax.axhline(np.log10(tolerance), color=style.INK, lw=2.6)
    bar.ax.tick_params(length=2.0, width=0.6)
    bar.outline.set_visible(False)
