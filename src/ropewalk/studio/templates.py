"""Scenarios to begin with: the examples of the package, by their titles."""

from __future__ import annotations

import re
from functools import cache

from ropewalk.scenario.examples import examples, title_of


@cache
def templates() -> tuple[dict[str, str], ...]:
    """Names, titles and texts of the examples; none of those that run code of their own."""
    kept = {name: text for name, text in examples().items() if not re.search(r"kind: *(stepper|fmu)", text)}
    return tuple({"name": f"{name}.yaml", "title": title_of(text) or name, "text": text} for name, text in kept.items())
