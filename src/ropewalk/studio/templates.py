"""Scenarios to begin with: the examples of the package, by their titles."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

HERE = Path(__file__).parent
_PLACES = (HERE / "examples", HERE.parents[2] / "examples")  # in a wheel; in a checkout
_TITLE = re.compile(r"^title: *(.+?) *(#.*)?$", re.MULTILINE)


@cache
def templates() -> tuple[dict[str, str], ...]:
    """Names, titles and texts of the examples; none of those that run code of their own."""
    folder = next((place for place in _PLACES if place.is_dir()), None)
    found = []
    for file in sorted(folder.glob("*.yaml")) if folder else ():
        text = file.read_text(encoding="utf-8")
        if not re.search(r"kind: *(stepper|fmu)", text):
            title = _TITLE.search(text)
            found.append({"name": file.name, "title": title[1] if title else file.stem, "text": text})
    return tuple(found)
