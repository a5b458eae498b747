"""A scenario as it was written: plain values, and the line on which each of them stands."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ropewalk.errors import Problem, ScenarioError, did_you_mean, printable

Key = tuple[str, ...]
"""Where a value stands: ("loads", "walker", "force", "1"); indices are text here."""

_BRACKETS, _DEEPEST = re.compile(r"[][{}]"), 100
_LARGEST_FILE = 64_000_000  # bytes; a scenario of this size is a mistake


@dataclass
class Source:
    """Plain values with the place of each key, and the problems met while reading them."""

    name: str
    tree: Any = None
    lines: dict[Key, int] = field(default_factory=dict)
    origins: dict[Key, str] = field(default_factory=dict)  # keys that an override has set
    problems: list[Problem] = field(default_factory=list)
    broken: set[Key] = field(default_factory=set)  # keys whose value is not what was meant: look no further

    def place(self, key: Key) -> tuple[str, int | None]:
        """Find file and line of a key, or of the innermost block around it that is written."""
        for size in range(len(key), -1, -1):
            if key[:size] in self.origins:
                return self.origins[key[:size]], None
            if key[:size] in self.lines:
                return self.name, self.lines[key[:size]]
        return self.name, None

    def problem(self, key: Key, wrong: str, given: str = "", remedy: str = "") -> Problem:
        """Make a problem with its place filled in."""
        file, line = self.place(key)
        return Problem(dotted(key), wrong, given, remedy, file, line)


def copied(tree: Any) -> Any:
    """Copy a tree of blocks and lists; what stands in it cannot change."""
    if isinstance(tree, dict):
        return {name: copied(entry) for name, entry in tree.items()}
    return [copied(entry) for entry in tree] if isinstance(tree, list) else tree


def is_within(key: Key, blocks: set[Key]) -> bool:
    """Whether a key is one of some blocks, or inside of one."""
    return any(key[:size] in blocks for size in range(len(key) + 1)) if blocks else False


def dotted(key: Key) -> str:
    """Write a key as it is named in messages and in overrides: loads.walker.force.1."""
    return printable(".".join(key))


def displayed(value: object) -> str:
    """Write a value as it is quoted in messages: short and printable."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a block"
    try:
        text = repr(value)
    except ValueError:  # an integer of thousands of digits
        return "a very long number"
    return text if len(text) <= 60 else f"{text[:50]}... ({len(text)} characters)"


def syntax_error(name: str, line: int | None, wrong: str, remedy: str = "") -> ScenarioError:
    """Make the error for text that cannot be read at all."""
    return ScenarioError([Problem("", wrong, remedy=remedy, file=name, line=line)])


def too_deep(text: str, name: str) -> ScenarioError:
    """Make the error for blocks within blocks within blocks, at the line where they become too many."""
    depth = 0
    for found in _BRACKETS.finditer(text):
        depth += 1 if found[0] in "[{" else -1
        if depth > _DEEPEST:
            line = text.count("\n", 0, found.start()) + 1
            break
    else:  # as indented lines
        rows = text.splitlines()
        line = 1 + max(range(len(rows)), key=lambda i: len(rows[i]) - len(rows[i].lstrip()), default=0)
    return syntax_error(name, line, "the blocks are nested too deeply", f"nest at most {_DEEPEST} of them")


def read_text(path: str | os.PathLike[str]) -> str:
    """Read a scenario file as text.

    Raises:
        ScenarioError: there is no such file, it cannot be read, or it is not text in UTF-8.
    """
    name = os.fspath(path)
    try:
        with open(path, "rb") as stream:
            data = stream.read(_LARGEST_FILE + 1)
    except FileNotFoundError:
        raise syntax_error(name, None, "no such file", _similar(name)) from None
    except IsADirectoryError:
        raise syntax_error(name, None, "is a folder", "name a scenario file in it") from None
    except PermissionError:
        raise syntax_error(name, None, "cannot be read", "change its permissions (chmod u+r)") from None
    except (OSError, ValueError) as error:
        wrong = getattr(error, "strerror", None) or str(error)
        raise syntax_error(name, None, f"cannot be read: {wrong}", "check the path") from None
    if len(data) > _LARGEST_FILE:
        raise syntax_error(name, None, "is larger than 64 MB", "check that this is a scenario")
    return decode(data, name)


def decode(data: bytes, name: str) -> str:
    """Decode the bytes of a scenario file.

    Raises:
        ScenarioError: the bytes are not text, or not in UTF-8.
    """
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise syntax_error(name, 1, "the text is in UTF-16", "save it as UTF-8")
    zero = data.find(b"\0")
    if zero >= 0:
        line = data.count(b"\n", 0, zero) + 1
        raise syntax_error(name, line, "this is not a text file", "give a scenario in YAML or JSON")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise syntax_error(name, line, "the text is not in UTF-8", "save it as UTF-8") from None


def _similar(name: str) -> str:
    folder = Path(name).parent
    try:
        files = sorted(p.name for p in folder.iterdir() if p.suffix in (".yaml", ".yml", ".json"))
    except OSError:
        return "check the path"
    return did_you_mean(Path(name).name, files, otherwise="check the path")
