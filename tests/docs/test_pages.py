"""Every command, file and script of the start, the tutorials and the how-tos works, and prints what the page says."""

from __future__ import annotations

from pathlib import Path

import blocks  # of this folder: see conftest.py
import pytest

DOCS = Path(__file__).parent.parent.parent / "docs"
PAGES = [DOCS / "start.md", *sorted((DOCS / "tutorials").glob("*.md")), DOCS / "howto" / "index.md"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(DOCS).as_posix())
def test_a_page_does_what_it_says(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    blocks.follow(page, tmp_path)
