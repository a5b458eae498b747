"""Draws pipeline.svg, the picture of the overview:  python docs/images/pipeline.py"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

INK, FAINT, FILL, DATA = "#333333", "#8A8A8A", "#EAF2F8", "#FDF3E1"
WIDTH, HEIGHT = 2.0, 1.0

# Boxes: place (column, row), folder, what it does; then the arrows between them with what passes along.
BOXES = {
    "file": ((0, 1), "scenario file", "YAML or JSON", DATA),
    "scenario": ((1, 1), "scenario/", "reads, finds\nevery mistake", FILL),
    "model": ((2, 1), "model/", "frozen\ndeclarations", FILL),
    "mechanics": ((3, 1), "mechanics/", "plain arrays,\nforce kernels", FILL),
    "solve": ((3, 0), "solve/", "rest, motion,\nslow motion", FILL),
    "results": ((2, 0), "results/", "frames, audit,\nrecorder", FILL),
    "dataset": ((1, 0), "xarray.Dataset", "and its file,\nNetCDF", DATA),
    "picture": ((0, 0), "table, figure,\nfilm", "", DATA),
}
ARROWS = [
    ("file", "scenario", "text"),
    ("scenario", "model", "Scenario"),
    ("model", "mechanics", "Strands,\nLoads"),
    ("mechanics", "solve", "State"),
    ("solve", "results", "State at each\ninstant"),
    ("results", "dataset", "Frame"),
    ("dataset", "picture", ""),
]


def centre(name: str) -> tuple[float, float]:
    """Where the middle of a box is."""
    column, row = BOXES[name][0]
    return 3.3 * column, 1.9 * row


def box(ax: Axes, name: str) -> None:
    """Draw one box with its folder and what it does."""
    _, title, text, colour = BOXES[name]
    x, y = centre(name)
    shape = "round,pad=0.08,rounding_size=0.12"
    ax.add_patch(FancyBboxPatch((x - WIDTH / 2, y - HEIGHT / 2), WIDTH, HEIGHT, boxstyle=shape, fc=colour, ec=FAINT))
    ax.text(x, y + (0.26 if text else 0.0), title, ha="center", va="center", color=INK, fontsize=9.5, fontweight="bold")
    ax.text(x, y - 0.2, text, ha="center", va="center", color=INK, fontsize=8.5)


def arrow(ax: Axes, begin: str, end: str, text: str) -> None:
    """Draw an arrow from box to box with what passes along it."""
    (x0, y0), (x1, y1) = centre(begin), centre(end)
    dx, dy = (WIDTH / 2 + 0.12) * ((x1 > x0) - (x1 < x0)), (HEIGHT / 2 + 0.12) * ((y1 > y0) - (y1 < y0))
    style = {"arrowstyle": "-|>", "color": INK, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (x1 - dx, y1 - dy), (x0 + dx, y0 + dy), arrowprops=style)
    x, y = 0.5 * (x0 + x1), 0.5 * (y0 + y1)
    if dx:
        ax.text(x, y + 0.1, text, ha="center", va="bottom", color=INK, fontsize=8)
    else:
        ax.text(x + 0.12, y, text, ha="left", va="center", color=INK, fontsize=8)


def draw() -> Figure:
    """The whole picture."""
    fig = Figure(figsize=(8.6, 2.5))
    ax = fig.add_axes((0.0, 0.0, 1.0, 1.0))
    for name in BOXES:
        box(ax, name)
    for begin, end, text in ARROWS:
        arrow(ax, begin, end, text)
    ax.set(xlim=(-1.25, 11.15), ylim=(-0.85, 2.75), aspect="equal")
    ax.axis("off")
    return fig


if __name__ == "__main__":
    # Text stays text: the file is small and can be searched.
    mpl.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "ropewalk", "font.family": "sans-serif"})
    draw().savefig(Path(__file__).with_suffix(".svg"), metadata={"Date": None, "Creator": None})
