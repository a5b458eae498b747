"""The examples that come with the package."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

_HOUSE = Path(__file__).parents[1]
_PLACES = (_HOUSE / "examples", _HOUSE.parents[1] / "examples")  # in a wheel; in a checkout

TITLE = re.compile(r"^title: *(.*?) *$", re.MULTILINE)


@cache
def examples() -> dict[str, str]:
    """Texts of the examples by their names, as `zip-line`; empty if they are not there."""
    folder = next((place for place in _PLACES if place.is_dir()), None)
    files = sorted(folder.glob("*.yaml")) if folder else ()
    return {file.stem: file.read_text(encoding="utf-8") for file in files}


def title_of(text: str) -> str:
    """The title of an example; empty if it has none."""
    found = TITLE.search(text)
    return found[1] if found else ""
