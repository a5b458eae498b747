"""The colours of the page: text contrasts with its ground by at least 4.5 to 1 (WCAG 2, level AA), light and dark."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

STYLE = (Path(__file__).parents[2] / "studio" / "src" / "style.css").read_text(encoding="utf-8")
THEMES = ("light", "dark")
PAIRS = [(text, ground) for text in ("ink", "faint", "accent", "load", "hold", "ghost", "bad")
         for ground in ("panel", "paper", "line")]  # fmt: skip
PAIRS += [("on-accent", "accent"), ("bad", "bad-paper"), ("ink", "bad-paper")]
Colour = tuple[float, ...]


def colours(theme: str) -> dict[str, Colour]:
    """Colours of a theme, red, green and blue from 0 to 1, by the names of their variables."""
    found = {
        name: tuple(int(both[THEMES.index(theme)][k : k + 2], 16) / 255.0 for k in (0, 2, 4))
        for name, *both in re.findall(r"--([\w-]+): light-dark\(#(\w{6}), #(\w{6})\);", STYLE)
    }
    line = tuple(0.08 * a + 0.92 * p for a, p in zip(found["accent"], found["panel"], strict=True))
    return found | {"line": line}  # the current line of the text


def luminance(colour: Colour) -> float:
    """Relative luminance of WCAG 2."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in colour]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: Colour, other: Colour) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("theme", THEMES)
def test_text_can_be_read_in_every_theme(theme: str) -> None:
    of = colours(theme)
    low = {f"{text} on {ground}": contrast(of[text], of[ground]) for text, ground in PAIRS}
    assert {pair: found for pair, found in low.items() if found < 4.5} == {}


def test_black_and_white_have_the_contrast_of_the_standard() -> None:
    assert contrast((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)) == pytest.approx(21.0)
