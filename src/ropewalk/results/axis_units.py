"""Units on axes: what is drawn in SI units is labelled in those that are shown, without factors such as 1e6."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import Formatter, MaxNLocator

from ropewalk.results import style
from ropewalk.results.display_units import ENGINEERING, DisplayUnit, DisplayUnits, decimals

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

SMALL, LARGE = 0.01, 1e5  # in the unit shown: smaller and larger numbers are labelled with a power of ten
LOW = 0.1  # m: smaller coordinates are labelled as lengths
_LABEL = re.compile(r"(?P<what>.*)\((?P<unit>[^()]+)\)(?P<more>[^()]*)")
_PLACE = re.compile(r"[xyz] |time |load path ")  # coordinates and instants
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class _Marks(MaxNLocator):
    """Marks at round numbers of a unit."""

    def __init__(self, size: float) -> None:
        self._size = size
        super().__init__(nbins="auto", steps=[1, 2, 2.5, 5, 10])

    def tick_values(self, vmin: float, vmax: float) -> Any:
        return self._size * np.asarray(super().tick_values(vmin / self._size, vmax / self._size))


class _Numbers(Formatter):
    """The numbers next to them, as many decimals as tell them apart."""

    def __init__(self, size: float) -> None:
        self.size, self._decimals = size, 0

    def set_locs(self, locs: Any) -> None:
        marks = np.unique(np.asarray(locs, dtype=np.float64)) / self.size
        step = float(np.diff(marks).min()) if marks.size > 1 else float(np.abs(marks).max(initial=1.0)) or 1.0
        places = range(decimals(step, 1), decimals(step, 1) + 3)
        self._decimals = next((d for d in places if abs(round(step, d) - step) < 1e-6 * step), places[0])

    def __call__(self, x: float, pos: Any = None) -> str:
        text = f"{x / self.size:.{self._decimals}f}"
        return text.replace("-", "\N{MINUS SIGN}") if float(text) else "0"


def show_units(figure: Figure, units: DisplayUnits) -> None:
    """Label vertical axes, colour bars and level axes of places, drawn in SI units, in the units to show."""
    for ax in figure.axes:
        if ax.name != "3d" and units.place.size != 1.0 and ax.get_xlabel().endswith("(m)"):
            round_axis(ax.xaxis, units.place.size)
            ax.set_xlabel(f"{ax.get_xlabel()[:-3]}({units.place.symbol})", fontsize=style.LABEL, color=style.INK)
        low, high = ax.get_ylim()
        if ax.name != "3d" and ax.get_yscale() == "linear" and (displayed := unit_of(ax, units)) is not None:
            _label(ax, ax.yaxis, displayed, max(abs(low), abs(high)))


def round_axis(axis: Axis, size: float) -> None:
    """Mark an axis at round numbers of a unit, whose size is given in what is drawn."""
    axis.set_major_locator(_Marks(size))
    axis.set_major_formatter(_Numbers(size))


def displayed_size(axis: Axis) -> float:
    """Size in SI units of the unit that an axis is labelled in."""
    numbers = axis.get_major_formatter()
    return numbers.size if isinstance(numbers, _Numbers) else 1.0


def unit_of(ax: Axes, units: DisplayUnits) -> DisplayUnit | None:
    """The unit in which a vertical axis is shown, None if it is not one of those that can be chosen."""
    found = _LABEL.fullmatch(ax.get_ylabel())
    if found is None or found["unit"] not in ENGINEERING:
        return None
    if _PLACE.match(found["what"]) and not (found["unit"] == "m" and np.abs(ax.get_ylim()).max() < LOW):
        return units.place if found["unit"] == "m" else DisplayUnit(found["unit"], 1.0)
    return units.of(found["unit"], [ax.get_ylim()])


def _label(ax: Axes, axis: Axis, displayed: DisplayUnit, largest: float) -> None:
    found = _LABEL.fullmatch(ax.get_ylabel())
    assert found is not None
    size, symbol = displayed.size, displayed.symbol.replace("^2", "²").replace("*", "·")
    if not _PLACE.match(found["what"]) and not SMALL * size <= largest < LARGE * size and largest > 0.0:
        power = int(np.floor(np.log10(largest / size)))
        size, symbol = size * 10.0**power, f"10{str(power).translate(_RAISED)} {symbol}"
    round_axis(axis, size)
    ax.set_ylabel(f"{found['what']}({symbol}){found['more']}", fontsize=style.LABEL, color=style.INK)
