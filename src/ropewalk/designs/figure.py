"""The figure of a design: its course, and all runs over each variable."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from ropewalk.results import style
from ropewalk.sweeps.dataset import named

if TYPE_CHECKING:
    import xarray as xr

BESIDE = 3  # panels in a row


def design_figure(course: xr.Dataset) -> Figure:
    """Draw a design.

    Args:
        course: its runs.
    """
    names = named(course, "parameters")
    objective = str(course.attrs["objective"])
    value = course[objective] if objective in course else course[names[_which(course, names, objective)]]
    numbers = np.asarray(value.values, dtype=np.float64)
    fine = np.asarray(course["keeps_limits"].values, dtype=bool)
    known = np.isfinite(numbers)
    sign = 1.0 if course.attrs["goal"] == "minimise" else -1.0
    best = int(np.argmin(np.where(fine & known, sign * numbers, np.inf))) if (fine & known).any() else None
    rows = 1 + -(-len(names) // BESIDE)
    figure = Figure(figsize=(9.2, 2.9 * rows + 0.5), dpi=style.DPI, layout="constrained")
    title = f"{course.attrs['title']}: {course.attrs['goal']} {objective} ({course.attrs['outcome']})"
    figure.suptitle(title, fontsize=style.LABEL, color=style.INK, x=0.01, ha="left")
    grid = figure.add_gridspec(rows, min(len(names), BESIDE))
    unit = str(value.attrs.get("units", ""))
    label = f"{objective.rpartition('.')[2] if objective not in course else objective} ({unit})".removesuffix(" ()")
    ax = figure.add_subplot(grid[0, :])
    ax.plot(np.flatnonzero(~fine & known), numbers[~fine & known], "x", color=style.BLACK, markersize=4.0,
            label="breaks a limit")  # fmt: skip
    ax.plot(
        np.flatnonzero(fine & known), numbers[fine & known], "o", color=style.BLUE, markersize=3.5, label="keeps all"
    )
    if objective in course:
        ax.step(np.arange(fine.size), course["best_so_far"].values, where="post", color=style.ORANGE,
                linewidth=style.LINE, label="best so far")  # fmt: skip
    style.dress(ax, "", "run", label)
    style.legend(ax)
    for k, name in enumerate(names):
        ax = figure.add_subplot(grid[1 + k // BESIDE, k % BESIDE])
        x = np.asarray(course[name].values, dtype=np.float64)
        y = numbers if objective in course else np.arange(fine.size)
        ax.plot(x[~fine & known], y[~fine & known], "x", color=style.BLACK, markersize=4.0)
        ax.plot(x[fine & known], y[fine & known], "o", color=style.BLUE, markersize=3.5)
        if best is not None:
            ax.plot(x[best : best + 1], y[best : best + 1], "o", color=style.ORANGE, markersize=8.0, fillstyle="none")
        unit = str(course[name].attrs.get("units", ""))
        style.dress(ax, "", f"{name} ({unit})".removesuffix(" ()"), label if objective in course else "run")
    return figure


def _which(course: xr.Dataset, names: list[str], key: str) -> int:
    return [str(course[name].attrs["key"]) for name in names].index(key)
