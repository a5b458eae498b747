"""JSON as plain values with line numbers; duplicate keys are reported."""

from __future__ import annotations

import json
import re
from typing import Any

from ropewalk.errors import Problem
from ropewalk.scenario.source import Key, Source, dotted, syntax_error, too_deep

_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[][{}]|[^]["{}\s,:]+')
_LONGEST_INTEGER = 400  # characters; a longer one is infinite


def read_json(text: str, name: str) -> Source:
    """Read JSON text.

    Raises:
        ScenarioError: the text is not JSON; duplicate keys are kept as problems in the source.
    """
    source = Source(name)
    if not text.strip():
        return source
    try:
        source.tree = json.loads(text, object_pairs_hook=_first_values, parse_int=_integer)
    except json.JSONDecodeError as error:
        wrong = f"this is not JSON, column {error.colno}: {error.msg}"
        remedy = "put keys in double quotes, commas between entries, and close all brackets"
        raise syntax_error(name, error.lineno, wrong, remedy) from None
    except RecursionError:
        raise too_deep(text, name) from None
    _note_lines(text, source)
    return source


def _first_values(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    return dict(pairs) if len({name for name, _ in pairs}) == len(pairs) else dict(reversed(pairs))


def _integer(digits: str) -> float:
    return int(digits) if len(digits) <= _LONGEST_INTEGER else float(digits)


def _note_lines(text: str, source: Source) -> None:
    """Note the line of every key and entry of valid JSON, and keys that occur twice in a block."""
    line, counted = 1, 0
    blocks: list[tuple[Key, list[str] | None]] = []  # open ones; names of a block so far, or None for a list
    sizes: list[int] = []  # their numbers of values so far
    for found in _TOKEN.finditer(text):
        token = found[0]
        line, counted = line + text.count("\n", counted, found.start()), found.start()
        if token in "]}":
            blocks.pop()
            sizes.pop()
            continue
        at: Key = ()
        if blocks:
            key, names = blocks[-1]
            if names is not None and len(names) == sizes[-1]:
                _note_key(source, key, json.loads(token), names, line)
                continue
            at = (*key, str(sizes[-1]) if names is None else names[-1])
            sizes[-1] += 1
        source.lines.setdefault(at, line)
        if token in "[{":
            blocks.append((at, [] if token == "{" else None))
            sizes.append(0)


def _note_key(source: Source, block: Key, name: str, names: list[str], line: int) -> None:
    key = (*block, name)
    if name in names:
        wrong, remedy = "the key occurs twice in this block", f"keep one ({source.name}:{source.lines[key]})"
        source.problems.append(Problem(dotted(key), wrong, "", remedy, source.name, line))
    source.lines.setdefault(key, line)
    names.append(name)
