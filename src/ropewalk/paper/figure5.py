"""Figure 5: a constant force at 0.9999 of the wave speed on a taut string, by 49 and 149 modes, and exactly.

The exact deflection is a straight line up to the load, `F x / (P (1 + alpha))`, and falls to zero within
`(1 - alpha) c t` ahead of it: a layer of a ten-thousandth of the length, which needs far more modes than 1/(1 - alpha).
The published 49 and 149 modes give half of the deflection under the load.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ropewalk.results.style import BLUE, FAINT, GREEN, INK, LABEL, NOTE, ORANGE, RED, dress
from ropewalk.theory import string

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ALPHA = 0.9999
PLACES = (0.25, 0.5, 0.75, 0.9)
MODES = ((49, RED), (149, ORANGE))
# Everything in units of length L, tension P and force F, so that the deflection is in F L/P.
deflection = partial(string.moving_force, force=1.0, speed=ALPHA, length=1.0, tension=1.0, mass=1.0)
path = partial(string.moving_force_path, force=1.0, speed=ALPHA, length=1.0, tension=1.0, mass=1.0)


def under_load(place: np.ndarray, modes: int | None) -> np.ndarray:
    """Deflection under the load at V t/L = place, in F L/P."""
    t = place / ALPHA
    return np.asarray(path(t) if modes is None else deflection(place, t, modes=modes))


def draw() -> Figure:
    """Compute and draw the shapes and the path of the load."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.5, 7.2), layout="constrained")
    grid = figure.add_gridspec(2, 2, height_ratios=(1.1, 1.0))
    _shapes(figure.add_subplot(grid[0, :]))
    _paths(figure.add_subplot(grid[1, 0]))
    _layer(figure.add_subplot(grid[1, 1]))
    note = f"V = {ALPHA:g} c, c = sqrt(P/rho), string at rest when the force enters; no damping; deflection downwards"
    figure.supxlabel(note, fontsize=NOTE, color=FAINT)
    return figure


def _shapes(ax: Axes) -> None:
    dress(ax, "Shape of the string with the load at x = 0.25, 0.5, 0.75 and 0.9 L", "x/L", "deflection (F L/P)")
    for place in PLACES:
        last = place == PLACES[-1]
        x = np.unique(np.concatenate([np.linspace(0.0, 1.0, 801), place + (1.0 - ALPHA) * np.linspace(-1.0, 1.5, 26)]))
        for modes, colour in MODES:
            w = deflection(x, place / ALPHA, modes=modes)
            ax.plot(x, w, color=colour, lw=0.9, alpha=1.0 if last else 0.55, label=f"{modes} modes" if last else None)
        ax.plot(x, deflection(x, place / ALPHA), color=BLUE, lw=1.7, label="exact" if last else None)
        ax.plot(place, under_load(np.array([place]), None), "o", color=BLUE, ms=5)
    ax.invert_yaxis()
    ax.legend(frameon=False, fontsize=LABEL, loc="lower left")


def _paths(ax: Axes) -> None:
    dress(ax, "Path of the load", "V t/L", "deflection under the load (F L/P)")
    place = np.linspace(0.0, 1.0, 2001)
    for modes, colour in (*MODES, (2000, GREEN)):
        ax.plot(place, under_load(place, modes), color=colour, lw=0.9, label=f"{modes} modes")
    ax.plot(place, under_load(place, None), color=BLUE, lw=1.7, label="exact")
    ax.invert_yaxis()
    ax.legend(frameon=False, fontsize=LABEL, loc="lower left")


def _layer(ax: Axes) -> None:
    place = 0.9
    width = (1.0 - ALPHA) * place / ALPHA
    ahead = np.linspace(-0.5, 1.5, 401) * width
    dress(ax, "Layer ahead of the load at 0.9 L", "distance from the load (L/10 000)", "deflection (F L/P)")
    for modes, colour in (*MODES, (2000, GREEN)):
        ax.plot(ahead * 1e4, deflection(place + ahead, place / ALPHA, modes=modes), color=colour, lw=0.9)
    ax.plot(ahead * 1e4, deflection(place + ahead, place / ALPHA), color=BLUE, lw=1.7)
    slope = -1.0 / (1.0 - ALPHA**2) + 1.0 / (1.0 + ALPHA)
    ax.text(0.97, 0.06, f"slope {slope:.0f} F/P:\nsmall only if F is below\n1/50 000 of P",
            transform=ax.transAxes, ha="right", va="bottom", fontsize=LABEL, color=INK)  # fmt: skip
    ax.invert_yaxis()
