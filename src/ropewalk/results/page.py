"""The page that a figure stands on: how large it is, and how large lines and letters are on it."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ropewalk.errors import Refused, did_you_mean

INCHES = {"cm": 1.0 / 2.54, "mm": 0.1 / 2.54, "in": 1.0}
NAMED = {"screen": 11.0, "report": 16.0 / 2.54, "journal": 8.8 / 2.54}  # in: widths of the screen, of text, of a column
SCREEN_DPI, PRINT_DPI, PIXEL_DPI = 150, 300, 100
NARROW = 12.0 / 2.54  # in: narrower pages have one column of panels
TALLEST = 24.0 / 2.54  # in: what fits on a sheet of A4
LEAST, MOST = 0.1, 100.0  # in
_SIZE = re.compile(r"(\d+(?:\.\d+)?)\s*[x×]\s*(\d+(?:\.\d+)?)\s*(cm|mm|in|px)?")


@dataclass(frozen=True)
class Page:
    """A size; without a height it is as high as the panels need, on paper up to that of a sheet."""

    width: float  # in
    height: float | None  # in
    dpi: int

    @classmethod
    def of(cls, size: str | None) -> Page:
        """Read a size: `screen` (also None), `report`, `journal`, or as "16x9cm", in cm, mm, in or px.

        Raises:
            Refused: (a ValueError) it is none, or too small or large to draw on.
        """
        name = (size or "screen").strip()
        if name in NAMED:
            return cls(NAMED[name], None, SCREEN_DPI if name == "screen" else PRINT_DPI)
        width, height, unit = read_size(name, "cm")
        inch = 1.0 / PIXEL_DPI if unit == "px" else INCHES[unit]
        if not all(LEAST <= side * inch <= MOST for side in (width, height)):
            raise Refused(f"a figure of {name} cannot be drawn", f"stay within {LEAST:g} to {MOST:g} in")
        return cls(width * inch, height * inch, PIXEL_DPI if unit == "px" else PRINT_DPI)

    @property
    def scale(self) -> float:
        """How large letters are, 1 on a screen: 8 points for labels in a report, 7 in a journal."""
        return min(0.6 + 0.4 * self.width / NAMED["screen"], 1.2)

    @property
    def columns(self) -> int:
        """How many panels stand side by side."""
        return 1 if self.width < NARROW else 2

    def tall(self, wanted: float) -> float:
        """The height in inches, if panels want so much."""
        if self.height is not None:
            return self.height
        return wanted if self.dpi == SCREEN_DPI else min(wanted, TALLEST)


def read_size(text: str, unit: str) -> tuple[float, float, str]:
    """Read width, height and their unit (without one `unit`) from a text such as "16x9cm".

    Raises:
        Refused: (a ValueError) it is no size.
    """
    found = _SIZE.fullmatch(text.strip())
    if found is None:
        remedy = did_you_mean(text, NAMED, otherwise=f"write as 16x9cm or 1280x720px, or {', '.join(NAMED)}")
        raise Refused("expected a size", remedy)
    return float(found[1]), float(found[2]), found[3] or unit
