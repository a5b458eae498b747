"""Draw how soft supports, pre-stress and weight reduce the upright end of a path and the driving force there.

A load on a rope that is straight, light and fixed comes to its supports on an upright path (clamped), or runs on beyond
them (frictionless). Section 3 of the paper says that soft supports, pre-stress and weight take that away; here is how
much of each it takes. The supports yield downwards only, by as much as the rope does or more: those that yield along
the rope take tension from it, and its path ends the steeper.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.model.support import Guided
from ropewalk.paper.slow_walk import LoadPath, Rope, way
from ropewalk.results.style import DPI, INK, INSTANTS, LINE, NOTE, TITLE, colours, dress

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ROPE = Rope(span=20.0, length=20.0, axial_stiffness=1e5)
STIFFNESSES = (700.0, 300.0, 200.0)  # N/m
TENSIONS = (300.0, 1000.0, 5000.0)  # N
WEIGHTS = (20.0, 100.0, 500.0)  # N/m
NEAR, BEYOND = 2.0, 0.3  # m before and behind the support that are drawn
STEEPEST = 3.0


@dataclass(frozen=True)
class SoftnessCase:
    """One rope and its two walks."""

    name: str
    clamped: LoadPath
    frictionless: LoadPath


def slider(stiffness: float) -> Guided:
    """A support that yields downwards only, on a spring in N/m."""
    return Guided(along=(0.0, 1.0), stiffness=stiffness)


def family(ropes: dict[str, Rope]) -> list[SoftnessCase]:
    """Both walks on each of the ropes."""
    return [
        SoftnessCase(n, way(rope, "clamped", half=True), way(rope, "frictionless", half=True))
        for n, rope in ropes.items()
    ]


def families() -> dict[str, list[SoftnessCase]]:
    """The ropes of the three columns, from singular to soft."""
    singular = {"fixed, straight, light": ROPE}
    soft = {f"k = {k:g} N/m": replace(ROPE, support=slider(k)) for k in STIFFNESSES}
    taut = {f"P = {P:g} N": replace(ROPE, length=ROPE.span / (1.0 + P / ROPE.axial_stiffness)) for P in TENSIONS}
    heavy = {f"{weight:g} N/m": replace(ROPE, weight=weight) for weight in WEIGHTS}
    return {
        "Supports that yield downwards": family(singular | soft),
        "More pre-stress": family(singular | taut),
        "More weight": family(singular | heavy),
    }


def draw() -> Figure:
    """Compute all walks and draw them."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10.5, 8.8), dpi=DPI, layout="constrained")
    title = "What takes the upright end from a path: soft supports, pre-stress, weight"
    figure.suptitle(title, x=0.01, ha="left", fontsize=TITLE + 1.5, color=INK, fontweight="bold")
    axes = figure.subplots(3, 3, sharex=True, sharey="row", height_ratios=(1.2, 1.0, 1.0))
    for column, (name, cases) in enumerate(families().items()):
        _column(axes[:, column], name, cases)
    labels = ("z above its end (m)", "dz/dx (-)", "hold force/W (-)")
    for ax, label in zip(axes[:, 0], labels, strict=True):
        ax.set_ylabel(label)
    note = (
        f"{ROPE.label()}, changed as said; near the right support, x = {ROPE.span:g} m\n"
        "from top to bottom: path of a clamped load, its slope, and what holds a frictionless load"
    )
    figure.supxlabel(note, fontsize=NOTE, color=INK)
    return figure


def _column(axes: list[Axes], name: str, cases: list[SoftnessCase]) -> None:
    path, slope, hold = axes
    for case, colour in zip(cases, colours(INSTANTS)(np.linspace(0.0, 1.0, len(cases))), strict=True):
        style = {"color": colour, "lw": LINE, "label": case.name}
        path.plot(case.clamped.x, case.clamped.z - case.clamped.z[-1], **style)
        x, steepness = case.clamped.path_slope()
        slope.plot(x, np.clip(steepness, -50.0, 50.0), **style)
        force = case.frictionless.hold / ROPE.load
        hold.plot(case.frictionless.x, force, **style)
    dress(path, name)
    dress(slope)
    dress(hold, x="x of the load (m)")
    path.plot([ROPE.span], [0.0], "^", color=INK, ms=7, mew=0.0, zorder=3)
    path.set(xlim=(ROPE.span - NEAR, ROPE.span + BEYOND), ylim=(-1.25, 0.1))
    slope.set_ylim(0.0, STEEPEST)
    hold.set_ylim(0.0, STEEPEST)
    slope.legend(frameon=False, fontsize=NOTE, labelcolor=INK, loc="upper left")


if __name__ == "__main__":
    draw().savefig("soft-ends.png")
