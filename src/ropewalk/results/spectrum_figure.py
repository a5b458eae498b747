"""Figures of a spectrum: eigenvalues in the complex plane, by size, and how they are damped; shapes of modes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from ropewalk.results import style
from ropewalk.results.spectrum import ROUNDING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ropewalk.results.spectrum import Modes, Spectrum

TICKS = 4  # most powers of ten marked on each side of zero
LINEAR = 0.6  # length of the linear part on each side of zero, in decades
# Damping ratios below this are rounding errors of the eigenvalues.
UNDAMPED = 1e-9
DISPLAYED = 12  # modes
COLUMNS = 3
SMALL = 1e-6  # of the largest displacement: a component that is nowhere larger is not drawn
SIDES = {"x": "along x", "y": "sideways, y", "z": "up, z"}
COMPONENTS = (("x", style.GREEN, ":"), ("y", style.RED, "--"), ("z", style.BLUE, "-"))


def spectrum_figure(spectrum: Spectrum) -> Figure:
    """Draw a spectrum, each line in a colour of its own.

    Left, eigenvalues in the complex plane, both axes linear up to the smallest one and logarithmic beyond. Right, the
    natural frequencies |lambda| / 2 pi in order, and the damping ratios -Re / |lambda|: 0 undamped, 1 where real.

    Args:
        spectrum: of one line or of several.
    """
    fig = Figure(figsize=(11.0, 6.0), dpi=style.DPI, layout="constrained")
    panels: list[Any] = [["plane", "order"], ["plane", "damping"]]
    ax = fig.subplot_mosaic(panels, width_ratios=(1.25, 1.0))
    lines = spectrum.lines or (spectrum,)
    _plane(ax["plane"], spectrum, lines)
    _order(ax["order"], lines)
    _damping(ax["damping"], lines)
    style.lift_titles([ax["plane"], ax["order"]])
    fig.align_ylabels([ax["order"], ax["damping"]])
    fig.suptitle(_headline(spectrum), fontsize=style.TITLE + 1, color=style.INK, x=0.01, ha="left")
    return fig


def _headline(spectrum: Spectrum) -> str:
    parts = [f"{spectrum.name}: {spectrum.character}"]
    if spectrum.smallest_eigenvalue > 0.0:
        parts.append(f"stiffness ratio {spectrum.stiffness_ratio:.4g}")
    if np.isfinite(spectrum.stable_step):
        parts.append(f"stable Verlet step {spectrum.stable_step:.3g} s")
    if not spectrum.complete:
        parts.append("ends of the spectrum only")
    return "; ".join(parts)


def _plane(ax: Axes, spectrum: Spectrum, lines: tuple[Spectrum, ...]) -> None:
    most = 2.0 * (spectrum.largest_eigenvalue or 1.0)
    threshold = 10.0 ** np.floor(np.log10(spectrum.smallest_eigenvalue or 1.0))
    for k, line in enumerate(lines):
        ax.plot(line.eigenvalues.real, line.eigenvalues.imag, **_dots(k), label=line.name)
    is_damped = bool(np.any(spectrum.eigenvalues.real < -UNDAMPED * most))
    left, right = (most if is_damped else threshold), (most if spectrum.unstable else threshold)
    ax.set_xscale("symlog", linthresh=threshold, linscale=LINEAR)
    ax.set_yscale("symlog", linthresh=threshold, linscale=LINEAR)
    ax.set(xlim=(-left, right), ylim=(-most, most))
    for axis, low, high in ((ax.xaxis, left, right), (ax.yaxis, most, most)):
        marks = _decades(threshold, most)
        axis.set_ticks([*(-marks[marks < low])[::-1], 0.0, *marks[marks < high]])
        axis.set_minor_locator(NullLocator())
    ax.axvline(0.0, color=style.FAINT, linewidth=style.THIN)
    ax.axhline(0.0, color=style.FAINT, linewidth=style.THIN)
    if spectrum.unstable:
        ax.axvspan(0.0, right, color=style.RED, alpha=0.08, linewidth=0.0)
    style.dress(ax, "Eigenvalues of J", "real part (1/s)", "imaginary part (rad/s)")
    if len(lines) > 1:
        style.legend(ax)


def _decades(threshold: float, most: float) -> Any:
    """Some powers of ten from well above the linear part on."""
    first, last = round(np.log10(threshold)) + 1, int(np.floor(np.log10(most)))
    step = max(1, -(-(last - first + 1) // TICKS))
    return 10.0 ** np.arange(first, last + 1, step, dtype=float)


def _order(ax: Axes, lines: tuple[Spectrum, ...]) -> None:
    for k, line in enumerate(lines):
        sizes = _upper(line)[0]
        fast = line.complete or 2 * np.arange(sizes.size) < sizes.size
        number = np.arange(1, sizes.size + 1)
        if not line.complete:  # those at the fast end count from there
            number = np.where(fast, number, line.unknowns // 2 - sizes.size + number)
        ax.plot(number, sizes, **_dots(k))
    ax.set(xscale="log", yscale="log")
    style.dress(ax, "Eigenvalues by size", "number (–)", "|λ| / 2π (Hz)")


def _damping(ax: Axes, lines: tuple[Spectrum, ...]) -> None:
    for k, line in enumerate(lines):
        sizes, ratio = _upper(line)
        ax.plot(sizes, ratio, **_dots(k))
    ax.set(xscale="log", ylim=(-0.05, 1.05))
    style.dress(ax, "Damping ratios", "|λ| / 2π (Hz)", "-Re λ / |λ| (–)")


def _upper(line: Spectrum) -> tuple[Any, Any]:
    """Frequencies in Hz and damping ratios of the stable eigenvalues, one of each conjugate pair."""
    values = line.eigenvalues[(line.eigenvalues.imag >= 0.0) & (np.abs(line.eigenvalues) > 0.0)]
    values = values[values.real <= UNDAMPED * np.abs(values)]
    sizes = np.abs(values)
    return sizes / (2.0 * np.pi), -values.real / sizes


def _dots(k: int) -> dict[str, Any]:
    return {
        "linestyle": "none", "marker": "o", "markersize": 3.5, "markeredgewidth": 0.0, "alpha": 0.75,
        "color": style.CYCLE[k % len(style.CYCLE)],
    }  # fmt: skip


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
