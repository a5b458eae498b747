"""Draw a result as `ropewalk show` does, and its first panel alone, for a card: RESULT PICTURE CARD."""

from __future__ import annotations

import sys

import ropewalk
from ropewalk.results.figures import panels_of

SIZE = "12x6cm"
DOTS = 150  # per inch: cards are 270 to 360 points wide

if __name__ == "__main__":
    result, picture, card = sys.argv[1:]
    with ropewalk.open_result(result) as dataset:
        ropewalk.figure(dataset).savefig(picture)
        panels = panels_of(dataset)
        first = "shapes" if "shapes" in panels else panels[0]
        ropewalk.figure(dataset, panels=[first], size=SIZE).savefig(card, dpi=DOTS)
