"""Every command, file, script and scenario of the pages works, and prints what the page says."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import blocks  # of this folder: see conftest.py
import pytest
import surroundings

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = {
    page.relative_to(DOCS if page.is_relative_to(DOCS) else ROOT).as_posix(): page
    for page in (*ROOT.glob("*.md"), *sorted(DOCS.rglob("*.md")))
    if page.parent != DOCS / "gallery"
}
WITH_BLOCKS = [name for name, page in PAGES.items() if blocks.blocks(page)]
LANGUAGES = {"shell", "console", "python", "yaml", "text"}
INLINE = re.compile(r"`((?:ropewalk|make) [^`]+)`")
LEFT_OUT = re.compile(r"(?<!\S)(?:\[.*?\]|(?:&&|\|).*)(?!\S)")
PROCESSES = {"ropewalk.sweeps.sweeping.cores": 0, "ropewalk.compare.adequacy.cores": 1}
"""So that all is done in this process, and compiled once."""


def around(name: str) -> blocks.Surroundings:
    every = (getattr(surroundings, table) for table in ("FILES", "CAPTIONS", "PARTS", "SHORTER", "UNSEEN"))
    return blocks.Surroundings(*(given.get(name, {}) for given in every))


@pytest.mark.parametrize("name", WITH_BLOCKS)
def test_a_page_does_what_it_says(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    for cores, so_many in PROCESSES.items():
        monkeypatch.setattr(cores, lambda so_many=so_many: so_many)
    blocks.follow(PAGES[name], tmp_path, around(name))


@pytest.mark.parametrize("name", WITH_BLOCKS)
def test_what_is_not_done_is_listed_with_its_reason(name: str) -> None:
    """Console blocks, and printed text that no command before it prints; and nothing is listed that is not there."""
    told, printed = around(name).unseen, False
    for block in blocks.blocks(PAGES[name]):
        printed = printed or block.language in ("shell", "python")
        if block.language == "console" or (block.language == "text" and not printed):
            assert block.of(told), f"{name}:{block.line}"
    assert unused(told, blocks.blocks(PAGES[name])) == []


def unused(told: dict[str, Any], found: list[blocks.Block]) -> list[str]:
    return [begin for begin in told if not any(block.of({begin: True}) for block in found)]


@pytest.mark.parametrize("name", WITH_BLOCKS)
def test_what_a_page_takes_for_granted_is_asked_for(name: str) -> None:
    found, told = blocks.blocks(PAGES[name]), around(name)
    text = "".join(block.text for block in found)
    assert unused(told.parts | told.captions, [block for block in found if block.language == "yaml"]) == []
    assert [one for one in (*told.files, *told.shorter) if one not in text] == []


@pytest.mark.parametrize("name", WITH_BLOCKS)
def test_code_says_what_it_is(name: str) -> None:
    """By a language that is known here; formulas of the notes are set in."""
    unknown = [f"{name}:{block.line}" for block in blocks.blocks(PAGES[name]) if block.language not in LANGUAGES]
    assert not unknown or name.startswith("notes/")


def test_commands_in_running_text_are_ones_that_there_are() -> None:
    for name, page in PAGES.items():
        for said in INLINE.findall(page.read_text(encoding="utf-8").replace("\n", " ")):
            blocks.parse(LEFT_OUT.sub("", said), f"{name}: {said}")


def test_tables_of_pages_name_pages() -> None:
    for table in ("FILES", "CAPTIONS", "PARTS", "SHORTER", "UNSEEN"):
        assert getattr(surroundings, table).keys() <= set(WITH_BLOCKS), table
