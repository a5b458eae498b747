"""Names are words of structural and multibody dynamics, one for each thing, and each thing has one."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections import defaultdict
from pathlib import Path

import pytest

import ropewalk

HOUSE = Path(ropewalk.__file__).parent
FILES = sorted(path for path in HOUSE.rglob("*.py") if "__pycache__" not in path.parts)
_LIST = """
boarding board person guide guides rider riders carrying crowds crowded fleet ghost ghosts bodywork held holding
holdings standing pieces timetable web webs laying building sheets fabric seat seats seated travellers traveller
journey journeys account rung rungs ladder climbing hands sight ride rides ridden riding rider grip grips told shown
foreign foreigner foreigners blow resist attract wing wings hand hands pace strings room rooms climb flows remarks
divided
"""
PRIVATE = set(_LIST.split())
"""Words that say nothing to a stranger, each of which had a word of the field."""
OF_THE_FIELD = {
    **dict.fromkeys(("crowds", "of_crowds", "crowds_in"), "of people on a bridge"),
    "standing_force": "one that does not move",
    "standing_tension": "of webbing between its anchors, as measured",
    **dict.fromkeys(("WebSocket", "WebSocketDisconnect", "WebSocketRoute"), "a connection, RFC 6455"),
    "sight": "as it was called before",
    "rung": "as it was called before",
}
"""Names in which one of them is meant as everybody means it."""


def words(name: str) -> set[str]:
    """The words of an identifier, in small letters."""
    return {word.lower() for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", name)}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(HOUSE).as_posix())
def test_identifiers_are_words_of_the_field(path: Path) -> None:
    found = {
        f"{token.string} ({token.start[0]})"
        for token in tokenize.generate_tokens(io.StringIO(path.read_text("utf-8")).readline)
        if token.type == tokenize.NAME and token.string not in OF_THE_FIELD and words(token.string) & PRIVATE
    }
    assert not found, sorted(found)
    assert not words(path.stem) & PRIVATE


def test_no_class_has_the_name_of_another() -> None:
    """But for `theory`, which stands alone."""
    where = defaultdict(list)
    for path in (path for path in FILES if "theory" not in path.parts):
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.ClassDef):
                where[node.name].append(path.relative_to(HOUSE).as_posix())
    assert not {name: files for name, files in where.items() if len(files) > 1}


SAID = (
    "it is not known", "know forces", "will of their own", "back in time", "has no ladder", "nobody walks",
    "no weight to travel", "answers with [", "somebody else", "slow motion", "stiff line", "foreign", "the web",
    "a rest ", " rung", "the ladder",
)  # fmt: skip
"""What messages said and should not: phrases without the feature as their subject, and private words."""
AS_DATA = {"foreign"}
"""A dimension of results, which hold as written."""


def messages(path: Path) -> set[str]:
    """All texts of a module that are no docstrings; those of f-strings in parts."""
    tree = ast.parse(path.read_text("utf-8"))
    described = {
        id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    return {
        node.value for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in described
    }  # fmt: skip


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(HOUSE).as_posix())
def test_messages_are_technical_english(path: Path) -> None:
    found = {text for text in messages(path) - AS_DATA - OF_THE_FIELD.keys() if any(word in text for word in SAID)}
    assert not found
