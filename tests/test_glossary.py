"""The glossary names what is public, all of it and nothing else."""

from __future__ import annotations

import re
from pathlib import Path

import ropewalk

GLOSSARY = Path(__file__).parent.parent / "docs" / "glossary.md"


def test_every_public_name_is_in_the_glossary_and_nothing_else_is() -> None:
    rows = [row.split("|") for row in GLOSSARY.read_text("utf-8").splitlines() if row.startswith("| ")]
    named = {name for row in rows if len(row) == 5 for name in re.findall(r"`(\w+)`", row[3])}
    assert named == set(ropewalk.__all__)


def test_no_term_is_explained_twice() -> None:
    rows = [row.split("|")[1].strip() for row in GLOSSARY.read_text("utf-8").splitlines() if row.startswith("| ")]
    terms = [term.strip() for row in rows if row != "term" for term in row.split(",")]
    assert len(terms) == len(set(terms))
