"""Messages, summaries and descriptions of keys consist of words of the field, not of private phrases."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

import ropewalk

PACKAGE = Path(ropewalk.__file__).parent
FOLDERS = ("results", "model", "cli", "studio", "scenario")
FILES = sorted(path for folder in FOLDERS for path in (PACKAGE / folder).rglob("*.py"))
PRIVATE = (
    r"told|tells?|says|said|remark(s|ed)?|doubts?|must not be trusted|besides?|turned over|(is|are) missing|"
    r"at rest|to rest|rest shape|slow motion|small motion|all geometry|goes|go on|runs along|travels along|"
    r"comes?|is led|sits|wanted|asked|asks|ways?|strand|rooms?|firm|fade|let off|let go|straighten|tie up|gone|flown|"
    r"swings|wheels in time|foreign|blow|struck|strikes|a place|somebody|of one's own|gives way|"
    r"what|who|whose|of somebody|all over|is looked (at|for)|looks at"
)
PATTERN = re.compile(rf"\b({PRIVATE})\b|^(how|where) ", re.I)
"""Private words and phrases, and clauses that stand for a noun."""
DATA = {"no rest shape"}
"""Values of results that stay as they are."""
NAMED = re.compile(r'`?\bswings\b`?|class="doubt"|\.doubt \{')
"""Choices of keys and names of styles within messages."""
OTHERS = {"studio/lesson.py"}
"""Lessons, a text of their own."""


def texts(path: Path) -> list[tuple[int, str]]:
    """Return the literals of a module that are printed: no docstrings, but those of commands, which are their help."""
    tree = ast.parse(path.read_text("utf-8"))
    docstrings = {
        id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    commands = [
        docstring for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_") and "typer" in ast.unparse(node.args)
        and (docstring := ast.get_docstring(node))
    ]  # fmt: skip
    literals = [
        (node.lineno, node.value) for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings
    ]  # fmt: skip
    return literals + [(1, text) for text in commands]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_messages_have_no_private_words(path: Path) -> None:
    if path.relative_to(PACKAGE).as_posix() in OTHERS:
        return
    found = [
        (line, text) for line, text in texts(path)
        if " " in text.strip() and text not in DATA and PATTERN.search(NAMED.sub("", text))
    ]  # fmt: skip
    assert not found
