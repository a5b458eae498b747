"""Figures of sweeps: curves over one parameter, maps or families over two, clouds of drawn cases, tornado diagrams."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ropewalk.errors import did_you_mean
from ropewalk.results import style
from ropewalk.results.acceptance import SEPARATOR
from ropewalk.sweeps.dataset import counted, named
from ropewalk.sweeps.parameters import refuse
from ropewalk.sweeps.quantities import broken_name
from ropewalk.sweeps.swings import SWINGS

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

MAP = 5  # values of both parameters from which on a map is drawn
MOST = 12  # curves in one panel
DOUBTFUL: dict[str, Any] = {
    "marker": "o", "s": 60, "facecolors": "none", "edgecolors": style.ORANGE, "linewidths": 1.6, "zorder": 4,
}  # fmt: skip
FAILED: dict[str, Any] = {"marker": "x", "s": 30, "color": style.BLACK, "linewidths": 1.2, "zorder": 4}


def sweep_figure(dataset: xr.Dataset, quantities: Sequence[str] | None = None) -> Figure:
    """Draw a sweep: a panel for each quantity, with doubtful cases in rings and those without a value as crosses.

    Over one parameter curves; over two maps with contours, or families of curves where one of them has few values or
    no numbers; over more families; of cases that were drawn or zipped, points over each parameter; of parameters one at
    a time a tornado: bars between what they let a quantity swing, the longest on top.

    Args:
        dataset: from `sweep`, or a part of it.
        quantities: which (default: all).

    Raises:
        ScenarioError: there is no such quantity, or there would be too many curves.
    """
    known = named(dataset, "quantities")
    for name in quantities or ():
        if name not in known:
            refuse("quantity", "there is no such quantity", repr(name), did_you_mean(name, known))
    chosen = list(quantities or known)
    varied = [name for name in named(dataset, "parameters") if dataset[name].size > 1] or named(dataset, "parameters")
    if set(SWINGS) <= set(dataset.data_vars):
        figure, panels = _panels(dataset, len(chosen), 1, height=1.0 + 0.45 * len(named(dataset, "parameters")))
        for ax, quantity in zip(panels[:, 0], chosen, strict=True):
            _tornado(ax, dataset, quantity)
    elif "case" in dataset.dims:
        figure, panels = _panels(dataset, len(chosen), len(varied))
        for row, quantity in zip(panels, chosen, strict=True):
            for ax, name in zip(row, varied, strict=True):
                _cloud(ax, dataset, quantity, name)
    elif len(varied) == 2 and all(_is_numeric(dataset[name]) and dataset[name].size >= MAP for name in varied):
        columns = min(len(chosen), 2)
        figure, panels = _panels(dataset, -(-len(chosen) // columns), columns, height=3.9)
        for ax in panels.flat[len(chosen) :]:
            ax.set_axis_off()
        for ax, quantity in zip(panels.flat, chosen, strict=False):
            _map(figure, ax, dataset, quantity, varied)
    else:
        figure, panels = _panels(dataset, len(chosen), 1)
        for ax, quantity in zip(panels[:, 0], chosen, strict=True):
            _family(ax, dataset, quantity, varied)
    return figure


def _panels(dataset: xr.Dataset, rows: int, columns: int, height: float = 2.9) -> tuple[Figure, NDArray[Any]]:
    width = 7.6 if columns == 1 else 4.6 * columns
    figure = Figure(figsize=(width, height * rows + 0.7), dpi=style.DPI, layout="constrained")
    text = ", ".join(f"{number} {name}" for name, number in counted(dataset).items())
    cut = "" if dataset.attrs["outcome"] == "completed" else f" ({dataset.attrs['outcome']})"
    figure.suptitle(f"{dataset.attrs['title']}: {text}{cut}", fontsize=style.LABEL, color=style.INK, x=0.01, ha="left")
    return figure, figure.subplots(rows, columns, squeeze=False)


def _label(dataset: xr.Dataset, name: str) -> str:
    unit = dataset[name].attrs.get("units", "")
    return f"{name.replace('_', ' ')} ({unit})" if unit and unit != "1" else name.replace("_", " ")


def _is_numeric(values: xr.DataArray) -> bool:
    return values.dtype.kind == "f"


def _along(dataset: xr.Dataset, name: str) -> tuple[NDArray[Any], NDArray[Any]]:
    """Where the values of a parameter stand along an axis, and their order there."""
    values = dataset[name].values
    if not _is_numeric(dataset[name]):
        values = np.unique(values.astype(str), return_inverse=True)[1]
    place = np.asarray(values, dtype=np.float64)
    return place, np.argsort(place, kind="stable")


def _dress(ax: Axes, dataset: xr.Dataset, x: str, y: str, title: str = "") -> None:
    style.dress(ax, title, _label(dataset, x), y)
    if not _is_numeric(dataset[x]):
        words = np.unique(dataset[x].values.astype(str))
        ax.set_xticks(range(len(words)), [str(word) for word in words])
    elif _is_geometric(dataset[x].values):
        ax.set_xscale("log")


def _is_geometric(values: NDArray[np.float64]) -> bool:
    """Whether values stand further apart the larger they are, over more than a decade."""
    if values.size < 3 or not (values > 0.0).all() or values.max() < 10.0 * values.min():
        return False
    steps = np.diff(np.log(np.sort(values)))
    return bool(steps.max() < 1.5 * steps.min())


def _mark(ax: Axes, x: NDArray[Any], y: NDArray[Any], outcome: NDArray[Any], colour: Any = style.BLACK) -> None:
    """Rings around what is doubtful, crosses at the foot for what has no value."""
    doubtful = (outcome == "doubtful") & np.isfinite(y)
    without = ~np.isfinite(y)
    if doubtful.any():
        ax.scatter(x[doubtful], y[doubtful], **DOUBTFUL, label="_doubtful" if _has(ax, "doubtful") else "doubtful")
    if without.any():
        foot = ax.get_xaxis_transform()
        at = np.full(int(without.sum()), 0.03)
        label = "_no value" if _has(ax, "no value") else "no value"
        ax.scatter(x[without], at, **(FAILED | {"color": colour}), transform=foot, label=label, clip_on=False)


def _has(ax: Axes, label: str) -> bool:
    return label in ax.get_legend_handles_labels()[1]


def _family(ax: Axes, dataset: xr.Dataset, quantity: str, varied: list[str]) -> None:
    """Curves over the parameter with most numbers, one for each combination of the others."""
    x = max(varied, key=lambda name: (_is_numeric(dataset[name]), dataset[name].size))
    others = [name for name in varied if name != x]
    sizes = [dataset[name].size for name in others]
    if math.prod(sizes) > MOST:
        remedy = "draw a part of it, such as dataset.isel(...), or write a table"
        refuse("figure", f"{math.prod(sizes)} curves are too many for one panel", ", ".join(others), remedy)
    place, order = _along(dataset, x)
    shades = style.colours(style.INSTANTS)(np.linspace(0.0, 1.0, max(math.prod(sizes), 2)))
    few = math.prod(sizes) <= len(style.CYCLE)
    for k, chosen in enumerate(product(*map(range, sizes))):
        part = dataset.isel(dict(zip(others, chosen, strict=True))).squeeze()
        values = np.atleast_1d(np.asarray(part[quantity].values, dtype=np.float64))[order]
        label = ", ".join(_text(dataset, name, i) for name, i in zip(others, chosen, strict=True))
        colour = style.CYCLE[k] if few else shades[k]
        joined = "-" if _is_numeric(dataset[x]) else "none"
        dots: dict[str, Any] = {"marker": "o", "markersize": 3.0, "linestyle": joined, "linewidth": style.LINE}
        ax.plot(place[order], values, color=colour, label=label, **dots)
        _mark(ax, place[order], values, np.atleast_1d(part["outcome"].values)[order], colour)
        _name_limits(ax, place[order], values, _broken(part, quantity)[order], colour)
    _dress(ax, dataset, x, _label(dataset, quantity))
    style.legend(ax)


def _broken(dataset: xr.Dataset, quantity: str) -> NDArray[Any]:
    """Names of the limits that a quantity counts as broken, as texts; empty ones where it counts none."""
    name = broken_name(quantity)
    known = name is not None and name in dataset.data_vars
    return np.atleast_1d(dataset[name].values.astype(str) if known else np.full(dataset[quantity].shape, ""))


def _name_limits(ax: Axes, x: NDArray[Any], y: NDArray[Any], texts: NDArray[Any], colour: Any) -> None:
    """Write the names of broken limits next to a curve, where others are broken than at the value before."""
    before = ""
    for at, value, text in zip(x, y, texts, strict=True):
        if text not in ("", before) and np.isfinite(value):
            paper = {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1.0}  # over the curve
            beside: dict[str, Any] = {"textcoords": "offset points", "va": "top", "ha": "right", "bbox": paper}
            label = text.replace(SEPARATOR, "\n")
            ax.annotate(label, (at, value), (-5, 0), fontsize=style.NOTE, color=colour, **beside)
        before = text


def _broken_anywhere(dataset: xr.Dataset, quantity: str) -> str:
    """All limits that some case breaks, for panels in which there is no room next to the points."""
    names = dict.fromkeys(name for text in _broken(dataset, quantity).flat if text for name in text.split(SEPARATOR))
    return f"broken somewhere: {SEPARATOR.join(names)}" if names else ""


def _text(dataset: xr.Dataset, name: str, i: int) -> str:
    value = dataset[name].values[i]
    unit = dataset[name].attrs.get("units", "")
    return f"{name} {value:g} {unit}".strip() if _is_numeric(dataset[name]) else f"{name} {value}"


def _map(figure: Figure, ax: Axes, dataset: xr.Dataset, quantity: str, varied: list[str]) -> None:
    """Colours and contours over two parameters."""
    x, y = varied
    part = dataset.squeeze().transpose(y, x, ...)
    (px, ox), (py, oy) = _along(dataset, x), _along(dataset, y)
    values = np.asarray(part[quantity].values, dtype=np.float64)[np.ix_(oy, ox)]
    outcome = part["outcome"].values[np.ix_(oy, ox)]
    gx, gy = np.meshgrid(px[ox], py[oy])
    known = values[np.isfinite(values)]
    if known.size:
        filled = ax.pcolormesh(gx, gy, values, cmap=style.colours(style.INSTANTS), shading="nearest", rasterized=True)
        bar = figure.colorbar(filled, ax=ax)
        bar.set_label(_label(dataset, quantity), fontsize=style.LABEL, color=style.INK)
        bar.ax.tick_params(labelsize=style.TICK, colors=style.INK, width=0.6, length=3)
        if known.max() > known.min():
            lines = ax.contour(gx, gy, values, colors="white", linewidths=style.THIN)
            ax.clabel(lines, fontsize=style.NOTE, fmt="%g")
    doubtful, without = outcome == "doubtful", ~np.isfinite(values)
    if doubtful.any():
        ax.scatter(gx[doubtful], gy[doubtful], **DOUBTFUL, label="doubtful")
    if without.any():
        ax.scatter(gx[without], gy[without], **FAILED, label="no value")
    _dress(ax, dataset, x, _label(dataset, y), _broken_anywhere(dataset, quantity))
    if _is_geometric(dataset[y].values):
        ax.set_yscale("log")
    ax.grid(visible=False)
    style.legend(ax)


def _tornado(ax: Axes, dataset: xr.Dataset, quantity: str) -> None:
    """Bars from the value of the scenario as it is to those of the cases in which one parameter is another."""
    usual, between = float(dataset[quantity].values[0]), dataset.sel(quantity=quantity)
    order = np.argsort(np.nan_to_num(between["largest"] - between["least"]), kind="stable")  # the longest on top
    names = [str(between["parameter"].values[k]) for k in order]
    for row, name in enumerate(names):
        _bars(ax, dataset, quantity, name, row)
    if np.isfinite(usual):
        ax.axvline(usual, color=style.INK, linewidth=style.THIN, zorder=3)
    style.dress(ax, "", _label(dataset, quantity), "")
    labels = [f"{_label(dataset, name)}\nscenario: {_value(dataset, name, 0)}" for name in names]
    ax.set_yticks(range(len(names)), labels)
    ax.margins(x=0.15)
    ax.grid(visible=False, axis="y")
    style.legend(ax)


def _bars(ax: Axes, dataset: xr.Dataset, quantity: str, name: str, row: int) -> None:
    """The row of one parameter: bars to its smallest and largest value, ticks at the others; rings and crosses."""
    values, own = np.asarray(dataset[quantity].values, dtype=np.float64), dataset[name].values
    others = np.flatnonzero(own != own[0])
    known = others[np.isfinite(values[others])]
    ends = _outermost(own, known)
    for i in ends:
        label, colour = ("another", style.GREEN)
        if _is_numeric(dataset[name]):
            label, colour = ("smaller than in the scenario", style.BLUE) if own[i] < own[0] else ("larger", style.RED)
        once = f"_{label}" if _has(ax, label) else label
        ax.barh(row, values[i] - values[0], left=values[0], height=0.6, edgecolor="white", linewidth=0.5, color=colour,
                label=once)  # fmt: skip
    for side, beside in (("right", values[ends] < values[0]), ("left", values[ends] >= values[0])):
        if beside.any():
            end = values[ends][beside].min() if side == "right" else values[ends][beside].max()
            text = ", ".join(_value(dataset, name, i) for i in ends[beside])
            ax.annotate(text, (end, row), (-3 if side == "right" else 3, 0), textcoords="offset points", va="center",
                        ha=side, fontsize=style.NOTE, color=style.INK)  # fmt: skip
    inner = np.setdiff1d(known, ends)
    ax.plot(values[inner], np.full(inner.size, row), "|", color="white", markersize=6.0, zorder=3)
    doubtful = known[dataset["outcome"].values[known] == "doubtful"]
    if doubtful.size:
        label = "_doubtful" if _has(ax, "doubtful") else "doubtful"
        ax.scatter(values[doubtful], np.full(doubtful.size, row), **DOUBTFUL, label=label)
    if known.size < others.size:
        label = "_no value" if _has(ax, "no value") else "no value"
        ax.scatter([0.99], [row], **FAILED, transform=ax.get_yaxis_transform(), label=label)


def _outermost(own: NDArray[Any], known: NDArray[Any]) -> NDArray[Any]:
    """The cases with the smallest and the largest value, each if it is beyond that of the scenario; of words all."""
    if not known.size or own.dtype.kind != "f":
        return known
    ends = np.array([known[np.argmin(own[known])], known[np.argmax(own[known])]])
    return ends[[own[ends[0]] < own[0], own[ends[1]] > own[0]]]


def _value(dataset: xr.Dataset, name: str, case: int) -> str:
    value = dataset[name].values[case]
    return f"{value:g}" if _is_numeric(dataset[name]) else str(value)


def _cloud(ax: Axes, dataset: xr.Dataset, quantity: str, name: str) -> None:
    """Points of all cases over one parameter."""
    place, _ = _along(dataset, name)
    values = np.asarray(dataset[quantity].values, dtype=np.float64)
    ax.plot(place, values, "o", markersize=3.0, color=style.BLUE)
    _mark(ax, place, values, dataset["outcome"].values)
    _dress(ax, dataset, name, _label(dataset, quantity), _broken_anywhere(dataset, quantity))
    style.legend(ax)
