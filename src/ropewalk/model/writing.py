"""Scenarios out: YAML that reads back to exactly the same scenario."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from functools import lru_cache
from typing import Any

from ropewalk.errors import Problem, ScenarioError
from ropewalk.model._base import Declaration
from ropewalk.model.scenario import Scenario
from ropewalk.model.stepper import Stepper

_PLAIN = re.compile(r"[A-Za-z](?:[\w ./*^()-]*[\w./*^()-])?|-?\d[\d.e+-]* [A-Za-z1/][\w/*^]*", re.ASCII)
_WORDS = {"true", "false", "null", "yes", "no", "on", "off", "y", "n"}


def dump(scenario: Scenario) -> str:
    """Write a scenario as YAML text with units, defaults included.

    Raises:
        ScenarioError: a speed, a force or a model is a Python object, which no file can hold.
    """
    check_writable(scenario)
    return text_of(tree_of(scenario))


def check_writable(scenario: Scenario) -> None:
    """Refuse what no file can hold.

    Raises:
        ScenarioError: a speed, a force or a model is a Python object.
    """
    problems = [
        Problem(".".join(("loads", name, *key)), wrong, remedy=remedy)
        for name, load in scenario.loads.items()
        for key, wrong, remedy in _unwritable(load)
    ]
    if problems:
        raise ScenarioError(problems)


def text_of(tree: dict[str, Any]) -> str:
    """The YAML text of what `tree_of` gives."""
    return "\n".join(_block(tree, "")) + "\n"


def tree_of(scenario: Scenario) -> dict[str, Any]:
    """All that a file says of a scenario, with units and defaults, in blocks and lists."""
    return scenario.model_dump(mode="json", by_alias=True, exclude_none=True)


def brief(scenario: Scenario) -> str:
    """Write a scenario as YAML text with units, without keys that have their default values.

    Raises:
        ScenarioError: a speed, a force or a model is a Python object, which no file can hold.
    """
    check_writable(scenario)
    short = scenario.model_dump(mode="json", by_alias=True, exclude_none=True, exclude_defaults=True)
    return text_of(_with_kinds(tree_of(scenario), short))


def _with_kinds(whole: Any, short: Any) -> Any:
    """The short tree with the kinds of blocks, which tell readers what they are; lists of blocks are kept whole."""
    if not isinstance(short, dict):
        return whole
    return {key: _with_kinds(each, short.get(key)) for key, each in whole.items() if key in short or key == "kind"}


def save(scenario: Scenario, path: str | os.PathLike[str]) -> None:
    """Write a scenario into a YAML file.

    Raises:
        ScenarioError: a speed, a force or a model is a Python object, which no file can hold.
        OSError: the file cannot be written.
    """
    text = dump(scenario)
    with open(path, "w", encoding="utf-8", newline="\n") as stream:
        stream.write(text)


def _unwritable(block: Declaration) -> Iterator[tuple[tuple[str, ...], str, str]]:
    """Find what a declaration holds that no file can hold: its key, what is wrong, what to do."""
    for name, field in type(block).model_fields.items():
        key, value = field.alias or name, getattr(block, name)
        if isinstance(value, Declaration):
            yield from (((key, *inner), wrong, remedy) for inner, wrong, remedy in _unwritable(value))
        elif isinstance(block, Stepper) and key == "model" and not isinstance(value, str):
            yield (key,), "an object cannot be written", "write its class or function as module:name or file.py:name"
        elif callable(value):
            yield (key,), "a callable cannot be written", "give a table {time, value}"


def _block(tree: dict[str, Any], indent: str) -> list[str]:
    rows = []
    for key, value in tree.items():
        name = key if key == "on" else _inline(key)
        if isinstance(value, dict) and value:
            rows += [f"{indent}{name}:", *_block(value, indent + "  ")]
        else:
            rows.append(f"{indent}{name}: {_inline(value)}")
    return rows


def _inline(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(_inline(entry) for entry in value)}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{_inline(key)}: {_inline(entry)}' for key, entry in value.items())}}}"
    return _text(value) if isinstance(value, str) else json.dumps(value)


@lru_cache(maxsize=4096)
def _text(value: str) -> str:
    """Text, in quotes where it has to be; sweeps write the same again and again."""
    if _PLAIN.fullmatch(value) and value.lower() not in _WORDS:
        return value
    return '"' + "".join(_character(sign) for sign in value) + '"'


def _character(sign: str) -> str:
    if sign in '"\\':
        return f"\\{sign}"
    if sign.isprintable():
        return sign
    code = ord(sign)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"
