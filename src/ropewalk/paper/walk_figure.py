"""The common page of Figures 2 to 4: shapes, locus, tensions, hold force, friction and slope of a slow walk."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from ropewalk.paper.slow_walk import LoadPath, Rope, linear_string, way
from ropewalk.results.style import BLUE, DPI, FAINT, INK, LINE, NOTE, ORANGE, RED, SKY, THIN, TITLE, dress
from ropewalk.theory.locus import ellipse

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SHAPES = 25  # load positions whose shapes are drawn
ARROWS = 9  # of them with the hold force
ARROW, LONGEST = 2.0, 2.4  # m in the picture: a hold force as large as the load, and the most that is drawn
STEEPEST = (-2.2, 3.4)  # slopes, coefficients and forces over W that are drawn
ENERGY = (
    "hold force: the change of energy of rope and load per metre of x; W dz/dx in a rope without weight and stretch"
)
LINEAR: dict[str, Any] = {"color": FAINT, "lw": LINE, "ls": (0, (5, 2))}


@dataclass(frozen=True)
class Walks:
    """One rope and its two walks, with the colours of the contacts."""

    rope: Rope
    name: str  # added to the contact in legends
    clamped: LoadPath
    frictionless: LoadPath
    colours: tuple[str, str]
    width: float

    @property
    def beneath(self) -> float:
        """How much wider the frictionless path is drawn, for where the clamped one covers it (the ellipse)."""
        return 0.0 if self.rope.weight or isfinite(self.rope.axial_stiffness) else 1.6

    def each(self) -> tuple[tuple[LoadPath, str, str], ...]:
        """Way, colour and name of both contacts."""
        names = (f"{contact}{self.name}" for contact in ("clamped", "frictionless"))
        return tuple(zip((self.clamped, self.frictionless), self.colours, names, strict=True))


def walks(rope: Rope, name: str = "", second: bool = False) -> Walks:
    """Both walks on a rope, in the colours of the first or of the second rope of a figure."""
    colours, width = ((SKY, ORANGE), THIN) if second else ((BLUE, RED), LINE)
    name = f", {name}" if name else ""
    return Walks(rope, name, way(rope, "clamped"), way(rope, "frictionless"), colours, width)


def draw_walks(title: str, first: Walks, second: Walks | None = None, *, depth: float, window: float) -> Figure:
    """Draw the page.

    Args:
        title: headline.
        first: the rope whose shapes are drawn.
        second: a rope to compare with, by its locus and its forces.
        depth: of the pictures of shapes, m.
        window: width of the close-up before the right support, m.
    """
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    figure = Figure(figsize=(10.5, 8.9), dpi=DPI, layout=ConstrainedLayoutEngine(h_pad=0.07))
    figure.suptitle(title, x=0.01, ha="left", fontsize=TITLE + 1.5, color=INK, fontweight="bold")
    ax = figure.subplot_mosaic(
        [["clamped", "frictionless"], ["tension", "hold"], ["slope", "close"]], height_ratios=(0.66, 1.0, 1.0)
    )
    both = (first,) if second is None else (first, second)
    _shapes(ax["clamped"], first, first.clamped, BLUE, depth)
    _shapes(ax["frictionless"], first, first.frictionless, RED, depth)
    dress(ax["clamped"], "Vertical force only, clamped: two tensions", "x (m)", "z (m)")
    dress(ax["frictionless"], "Frictionless: one tension, and a hold force (arrows)", "x (m)", "z (m)")
    _tension(ax["tension"], both)
    _hold(ax["hold"], both)
    _slope(ax["slope"], both)
    _close_up(ax["close"], both, window)
    for name in ("tension", "hold", "slope"):
        ax[name].set_xlim(ax["clamped"].get_xlim())
    notes = [walks.rope.label() for walks in both]
    figure.supxlabel("\n".join([*notes, _linear_note(first), ENERGY]), fontsize=NOTE, color=INK)
    return figure


def _linear_note(walks: Walks) -> str:
    return (
        f"linear string: W x (X - x)/(P X){' plus its own sag' if walks.rope.weight else ''} with P = "
        f"{walks.clamped.middle_pull:.0f} N, the rope's horizontal tension under a load in the middle"
    )


def _linear(ax: Axes, walks: Walks, slope: bool = False) -> None:
    x = np.linspace(0.0, walks.rope.span, 101)
    ax.plot(x, linear_string(walks.rope, walks.clamped.middle_pull, x)[slope], **LINEAR, label="linear string")


def _shapes(ax: Axes, walks: Walks, found: LoadPath, colour: str, depth: float) -> None:
    chosen = found.nearest(SHAPES)
    for k in chosen:
        ax.plot(*found.shapes[k], color=colour, lw=0.7, alpha=0.38)
        ax.plot(found.x[k], found.z[k], "o", color=colour, ms=2.6, mew=0.0)
    ax.plot(found.x, found.z, color=colour, lw=1.8, label="path of the load")
    _linear(ax, walks)
    for k in chosen[:: max(len(chosen) // ARROWS, 1)]:
        force = np.clip(ARROW * found.hold[k] / walks.rope.load, -LONGEST, LONGEST)
        if abs(force) > 0.2:
            arrow = {"arrowstyle": "-|>", "color": INK, "lw": 1.0, "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 7}
            ax.annotate("", (found.x[k] + force, found.z[k]), (found.x[k], found.z[k]), arrowprops=arrow)
    ax.plot([0.0, walks.rope.span], [0.0, 0.0], "^", color=INK, ms=6, mew=0.0, zorder=4)
    ax.set_aspect("equal")
    ax.set(xlim=(-0.19 * walks.rope.span, 1.19 * walks.rope.span), ylim=(-depth, 0.09 * depth))
    _legend(ax, loc="lower center", ncols=2)


def _tension(ax: Axes, both: tuple[Walks, ...]) -> None:
    for walks in both:
        clamped, free = walks.each()
        ax.plot(free[0].x, free[0].behind, color=free[1], lw=walks.width, label=f"{free[2]}, both sides")
        ax.plot(clamped[0].x, clamped[0].behind, color=clamped[1], lw=walks.width, label=f"{clamped[2]}, behind")
        ax.plot(clamped[0].x, clamped[0].ahead, "--", color=clamped[1], lw=walks.width, label=f"{clamped[2]}, ahead")
    ax.set_ylim(0.0, 1.3 * max(float(np.nanmax(walks.clamped.behind)) for walks in both))
    dress(ax, "Tension beside the load", "x of the load (m)", "tension (N)")
    _legend(ax, loc="lower center")


def _hold(ax: Axes, both: tuple[Walks, ...]) -> None:
    for walks in both:
        (clamped, blue, fixed), (free, red, sliding) = walks.each()
        ax.plot(free.x, free.hold / walks.rope.load, color=red, lw=walks.width, label=f"hold force/W, {sliding}")
        ax.plot(clamped.x, clamped.friction, color=blue, lw=walks.width, label=f"friction coefficient needed, {fixed}")
    ax.set_ylim(*STEEPEST)
    dress(ax, "What keeps the load in its place", "x of the load (m)", "hold force/W, coefficient (-)")
    _legend(ax, loc="upper center")


def _slope(ax: Axes, both: tuple[Walks, ...]) -> None:
    for walks in reversed(both):
        for k, (found, colour, name) in reversed(list(enumerate(walks.each()))):
            x, slope = found.path_slope()
            ax.plot(x, np.clip(slope, -50.0, 50.0), color=colour, lw=walks.width + walks.beneath * k, label=name)
    _linear(ax, both[0], slope=True)
    ax.set_ylim(*STEEPEST)
    dress(ax, "Slope of the load's path", "x of the load (m)", "dz/dx (-)")
    _legend(ax, loc="upper center", reverse=True)


def _close_up(ax: Axes, both: tuple[Walks, ...], window: float) -> None:
    span = both[0].rope.span
    for walks in reversed(both):
        for k, (found, colour, name) in reversed(list(enumerate(walks.each()))):
            ax.plot(found.x, found.z, color=colour, lw=walks.width + 0.3 + walks.beneath * k, label=name)
    _linear(ax, both[0])
    if (length := both[0].rope.length) > span:
        x = 0.5 * span + 0.5 * length * np.sin(np.linspace(0.0, 1.57, 400))
        curve = ellipse(span=span, length=length, load=both[0].rope.load, x=x)
        ax.plot(curve.x, curve.z, ":", color=INK, lw=LINE, label="ellipse: no weight, no stretch")
    ax.plot([span], [0.0], "^", color=INK, ms=7, mew=0.0, zorder=4)
    ax.set(xlim=(span - 0.72 * window, span + 0.28 * window), ylim=(-0.52 * window, 0.06 * window))
    ax.set_aspect("equal", adjustable="box")
    dress(ax, "Paths near the right support", "x (m)", "z (m)")
    _legend(ax, loc="upper left", reverse=True)


def _legend(ax: Axes, **options: Any) -> None:
    ax.legend(frameon=True, framealpha=0.6, edgecolor="none", fontsize=NOTE, labelcolor=INK, handlelength=2.2,
              borderpad=0.2, columnspacing=1.4, labelspacing=0.25, **options)  # fmt: skip
