"""Draw where along the span the linear string is off by more than 1, 5 and 20 %, against pre-stress and load.

Deflection under a slow load W on a taut line without weight: exact elastic theory (`ropewalk.theory.rope`, clamped at a
material point), compared with W x (X - x)/(P X), x the position of the load before it loads the line. The parameters
are W/P and the pre-strain P/EA. The load stretches the line, tension and load grow together, and for small slopes

    W/P = (1 + e) sqrt(2 e (P/EA) X^2/(x (X - x)))

makes the linear deflection too large by the part e. Derived here: the tension T = P (1 + e) is that of the added strain
W^2 x (X - x)/(2 T^2 X^2), half the mean square of the slopes W (X - x)/(T X) and W x/(T X).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ropewalk.results.style import BLACK, BLUE, DPI, FAINT, GREEN, INK, LINE, NOTE, THIN, TITLE, dress
from ropewalk.theory.rope import weightless_elastic

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FloatArray = NDArray[np.float64]

ERRORS = (0.01, 0.05, 0.20)
BANDS = ("#F1F7F4", "#FBF3D5", "#F6D5AE", "#E3A58C")  # below 1 %, to 5 %, to 20 %, beyond
PRESTRAINS = (1e-3, 1e-2, 1e-1)
LOADS = (3e-4, 3.0)  # W/P that are drawn
PLACES = np.array([0.005, 0.01, 0.02, 0.035, 0.055, 0.08, 0.12, 0.17, 0.23, 0.3, 0.4, 0.5])  # x/X, half the span
KNOWN = (  # N, N, N: tension, stiffness and load of what one meets
    ("tightrope, 20 kN, EA 10 MN, 800 N", 20e3, 10e6, 800.0, "o"),
    ("contact wire, 20 kN, EA 18 MN, 120 N", 20e3, 18e6, 120.0, "s"),
    ("slack line, 3 kN, EA 60 kN, 700 N", 3e3, 60e3, 700.0, "D"),
)


def linear_excess(*, place: float, load: float, prestrain: float) -> float:
    """Part by which the linear deflection exceeds the exact one under the load.

    Args:
        place: x/X before the line is loaded, between 0 and 1.
        load: W/P.
        prestrain: P/EA.
    """
    length = 1.0 / (1.0 + prestrain)
    exact = weightless_elastic(
        span=1.0, length=length, axial_stiffness=1.0, loads=[(place * length, (0.0, -load * prestrain))]
    )
    return load * place * (1.0 - place) / -float(exact.load_positions[0, 1]) - 1.0


def limit(*, place: float, prestrain: float, error: float) -> float:
    """Largest W/P for which the linear deflection is not further off than ``error``; arguments as above."""
    from scipy.optimize import brentq

    guess = float(np.log(small_slope_limit(place, prestrain, error)))

    def miss(log_load: float) -> float:
        return linear_excess(place=place, load=float(np.exp(log_load)), prestrain=prestrain) - error

    return float(np.exp(brentq(miss, guess - 3.0, guess + 1.0, xtol=1e-4)))


def small_slope_limit(place: float | FloatArray, prestrain: float | FloatArray, error: float) -> Any:
    """The same for small slopes, in closed form."""
    return (1.0 + error) * np.sqrt(2.0 * error * prestrain / (place * (1.0 - place)))


def draw() -> Figure:
    """Compute the limits and draw them."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    figure = Figure(figsize=(10.5, 8.2), dpi=DPI, layout=ConstrainedLayoutEngine(h_pad=0.07))
    title = "How far the linear string goes: where W x (X - x)/(P X) is too large by 1, 5 and 20 %"
    figure.suptitle(title, x=0.01, ha="left", fontsize=TITLE + 1.5, color=INK, fontweight="bold")
    axes = figure.subplots(2, 2)
    for ax, prestrain in zip(axes.flat, PRESTRAINS, strict=False):
        _along_the_span(ax, prestrain)
    _against_prestrain(axes[1, 1])
    note = (
        "quasi-static load W clamped to a taut elastic line without weight, pre-tension P, span X\n"
        "full: exact elastic theory; dashed: W/P = (1 + e) sqrt(2 e (P/EA) X²/(x (X - x))), small slopes"
    )
    figure.supxlabel(note, fontsize=NOTE, color=INK)
    return figure


def _along_the_span(ax: Axes, prestrain: float) -> None:
    places = np.concatenate([PLACES, 1.0 - PLACES[-2::-1]])
    limits = []
    for error in ERRORS:
        half = [limit(place=float(place), prestrain=prestrain, error=error) for place in PLACES]
        limits.append(np.array([*half, *half[-2::-1]]))
    _bands(ax, places, limits)
    for error, edge in zip(ERRORS, limits, strict=True):
        ax.plot(places, small_slope_limit(places, prestrain, error), **_DASHED)
        ax.annotate(f"{100 * error:g} %", (0.5, edge[len(PLACES) - 1]), (0, 2), textcoords="offset points", ha="center",
                    va="bottom", fontsize=NOTE, color=INK)  # fmt: skip
    ax.set(xlim=(0.0, 1.0), ylim=LOADS)
    dress(ax, f"Pre-strain P/EA = {prestrain:g}", "place of the load x/X (-)", "load W/P (-)")


def _against_prestrain(ax: Axes) -> None:
    prestrains = np.geomspace(1e-5, 0.3, 16)
    limits = [
        np.array([limit(place=0.5, prestrain=float(prestrain), error=error) for prestrain in prestrains])
        for error in ERRORS
    ]
    _bands(ax, prestrains, limits)
    for error, edge in zip(ERRORS, limits, strict=True):
        ax.plot(prestrains, small_slope_limit(0.5, prestrains, error), **_DASHED)
        ax.annotate(f"{100 * error:g} %", (prestrains[3], edge[3]), (0, 3), textcoords="offset points", ha="right",
                    va="bottom", fontsize=NOTE, color=INK)  # fmt: skip
    for (name, tension, stiffness, load, marker), colour in zip(KNOWN, (BLUE, GREEN, BLACK), strict=True):
        place: dict[str, Any] = {"marker": marker, "color": colour, "ms": 6, "mec": "white", "ls": "none"}
        ax.plot(tension / stiffness, load / tension, **place, label=name)
    ax.set(xscale="log", xlim=(prestrains[0], prestrains[-1]), ylim=LOADS)
    dress(ax, "Load in the middle", "pre-strain P/EA (-)", "load W/P (-)")
    ax.legend(frameon=True, framealpha=0.7, edgecolor="none", fontsize=NOTE, labelcolor=INK, loc="lower right",
              handlelength=1.2, borderpad=0.3)  # fmt: skip


_DASHED: dict[str, Any] = {"color": FAINT, "lw": THIN, "ls": (0, (4, 2))}


def _bands(ax: Axes, x: FloatArray, limits: list[FloatArray]) -> None:
    ax.set_yscale("log")
    edges = [np.full(x.size, LOADS[0]), *limits, np.full(x.size, LOADS[1])]
    for low, high, colour in zip(edges, edges[1:], BANDS, strict=False):
        ax.fill_between(x, low, np.maximum(low, high), color=colour, lw=0.0)
    for edge in limits:
        ax.plot(x, edge, color=INK, lw=LINE)


if __name__ == "__main__":
    draw().savefig("linear-limits.png")
