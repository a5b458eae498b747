"""The figure of mode shapes: the lowest modes of a structure, one panel each."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from ropewalk.results import style
from ropewalk.results.spectrum import ROUNDING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ropewalk.results.mode_names import Modes
    from ropewalk.results.spectrum import Spectrum

DISPLAYED = 12  # modes
COLUMNS = 3
SMALL = 1e-6  # of the largest displacement: a component that is nowhere larger is not drawn
SIDES = {"x": "along x", "y": "sideways, y", "z": "up, z"}
COMPONENTS = (("x", style.GREEN, ":"), ("y", style.RED, "--"), ("z", style.BLUE, "-"))


def mode_figure(spectrum: Spectrum, displayed: int = DISPLAYED) -> Figure:
    """Draw the shapes of the lowest modes over x: displacements up (z), sideways (y) and along (x).

    The largest displacement of a mode is 1; frequency and damping ratio stand above it.

    Args:
        spectrum: with its modes.
        displayed: at most so many.

    Raises:
        ValueError: there are no modes with shapes.
    """
    modes = spectrum.modes
    if modes is None or not len(modes.shape):
        raise ValueError("this spectrum has no mode shapes")
    count = min(displayed, len(modes.shape))
    rows = math.ceil(count / COLUMNS)
    fig = Figure(figsize=(11.0, 1.0 + 1.9 * rows), dpi=style.DPI, layout="constrained")
    axes = fig.subplots(rows, COLUMNS, sharex=True, sharey=True, squeeze=False).ravel()
    drawn: set[str] = set()
    for m, ax in enumerate(axes[:count]):
        drawn |= _mode(ax, modes, m)
        below = m + COLUMNS >= count
        hertz = f"{m + 1}: {modes.frequency[m] / math.tau:.4g} Hz"
        damped = f", damping ratio {modes.ratio[m]:.2g}" if modes.ratio[m] > ROUNDING else ""
        style.dress(ax, hertz + damped, "x (m)" if below else "", "displacement (1)" if m % COLUMNS == 0 else "")
        ax.xaxis.set_tick_params(labelbottom=below)
    for ax in axes[count:]:
        ax.set_visible(False)
    handles = [axes[0].plot([], [], color=c, linestyle=s, label=SIDES[name])[0]
               for name, c, s in COMPONENTS if name in drawn]  # fmt: skip
    fig.legend(handles=handles, loc="outside upper right", ncols=3, fontsize=style.NOTE, frameon=False)
    fig.suptitle(f"Lowest modes of {spectrum.name}", fontsize=style.TITLE + 1, color=style.INK, x=0.01, ha="left")
    return fig


def _mode(ax: Axes, modes: Modes, m: int) -> set[str]:
    """Draw one mode, and say which components of it."""
    names = np.array(modes.line)
    found = set()
    for a, (component, colour, dashes) in enumerate(COMPONENTS):
        if np.abs(modes.shape[m, :, a]).max(initial=0.0) < SMALL:
            continue
        found.add(component)
        for line in dict.fromkeys(modes.line):
            own = np.flatnonzero(names == line)
            ax.plot(
                modes.position[own, 0], modes.shape[m, own, a], color=colour, linestyle=dashes, linewidth=style.THIN
            )
    return found
